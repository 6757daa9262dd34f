// Closed forms of balloons: lift, the pressure of a sphere, outflow of gas.
#include "closed_forms.h"

#include "balloon_reference.h"

#include "oracle/balloon_oracle.h"
#include "oracle/balloon_theory.h"

#include <math.h>
#include <stdlib.h>

static const double PI = 3.14159265358979323846;

double closed_sphere_edge( int level )
{
    return 1.0514622242382672 / ( 1 << level ); // of an icosahedron; on a sphere the links are a little longer
}

/// A balloon and its data.
typedef struct sphere_run
{
    wisp_mesh mesh;
    wisp_fabric* fabric;
    surface_implementation implementation;
    wisp_vec3* points; // start positions
    int32_t* pins;     // all vertices
} sphere_run;

static wisp_status make_sphere( int level, double radius, sphere_run* out, wisp_error* error )
{
    const balloon_setting setting = balloon_default_setting();
    wisp_status status = balloon_mesh_sphere( level, (float)radius, &out->mesh, error );
    return status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
}

// The sphere s times as large, with the numbers of all its vertices.
static wisp_status stretch_sphere( sphere_run* sphere, double s, wisp_error* error )
{
    const int count = sphere->mesh.vertex_count;
    sphere->points = balloon_scaled_points( &sphere->mesh, s );
    sphere->pins = malloc( (size_t)count * sizeof( int32_t ) );
    if ( !sphere->points || !sphere->pins )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a stretched sphere" );
    }
    for ( int i = 0; i < count; ++i )
    {
        sphere->pins[i] = i;
    }
    return WISP_OK;
}

static wisp_status fly_sphere( closed_run* run, balloon_setting setting, int steps, sphere_run* sphere,
                               wisp_balloon_stats* seen, wisp_error* error )
{
    setting.points = sphere->points;
    setting.workers = run->workers;
    setting.seconds = ACCURACY_FRAME;
    surface_implementation* implementation = &sphere->implementation;
    wisp_status status = balloon_implementation_create( sphere->fabric, &setting, implementation, error );
    if ( status == WISP_OK && !run->is_observed )
    {
        status = wisp_request_balloon_stats( implementation->world, implementation->entity, false );
        status = status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
    }
    status = status == WISP_OK ? accuracy_step_surface( implementation, steps, run->out, error ) : status;
    status = status == WISP_OK ? accuracy_end_surface( implementation, run->out, error ) : status;
    return status == WISP_OK && run->is_observed ? balloon_implementation_read( implementation, seen, error )
                                                 : status;
}

static void leave( sphere_run* sphere )
{
    surface_implementation_destroy( &sphere->implementation );
    wisp_fabric_release( sphere->fabric );
    wisp_mesh_release( &sphere->mesh );
    free( sphere->points );
    free( sphere->pins );
}

// ( rho_air V - rho_He V ) g with the densities of the references, 1.225 and 0.1786 kg/m^3.
wisp_status closed_lift( closed_run* run, wisp_error* error )
{
    const double air = 1.225, helium = 0.1786, radius = run->first;
    balloon_setting setting = balloon_default_setting();
    setting.gravity = ( wisp_vec3 ){ 0.0f, (float)-CLOSED_GRAVITY, 0.0f };
    const double molar = 8.314462618 * (double)setting.def.temperature / (double)setting.def.atmospheric_pressure;
    setting.def.air_molar_mass = (float)( air * molar );
    setting.def.gas_molar_mass = (float)( helium * molar );
    sphere_run sphere = { .fabric = NULL };
    wisp_balloon_stats seen = { 0 };
    wisp_status status = make_sphere( run->parameter, radius, &sphere, error );
    status = status == WISP_OK ? fly_sphere( run, setting, 2, &sphere, &seen, error ) : status;
    run->measured = seen.buoyancy[1];
    run->reference = ( air - helium ) * 4.0 / 3.0 * PI * radius * radius * radius * CLOSED_GRAVITY;
    leave( &sphere );
    return status;
}

// p = 2 sigma / R, held in place so that only the pressure is tested. The limit of fine meshes is off by about 1 %,
// because the triangles of an icosphere are never all equilateral.
wisp_status closed_sphere( closed_run* run, wisp_error* error )
{
    const double e = run->first;
    balloon_setting setting = balloon_setting_in_vacuum();
    sphere_run sphere = { .fabric = NULL };
    wisp_balloon_stats seen = { 0 };
    wisp_status status = make_sphere( run->parameter, (double)BALLOON_RADIUS, &sphere, error );
    status = status == WISP_OK ? stretch_sphere( &sphere, 1.0 + e, error ) : status;
    setting.pins = sphere.pins;
    setting.pin_count = sphere.mesh.vertex_count;
    status = status == WISP_OK ? fly_sphere( run, setting, 2, &sphere, &seen, error ) : status;
    const balloon_theory_sphere theory = { .radius = (double)BALLOON_RADIUS,
                                           .edge_stiffness = (double)setting.def.edge_stiffness,
                                           .bend_link_stiffness = (double)setting.def.bend_link_stiffness };
    run->measured = seen.pressure;
    run->reference = balloon_theory_sphere_pressure( &theory, 1.0 + e );
    leave( &sphere );
    return status;
}

// An icosahedron, for which the closed form is exact, starts in balance and empties through a small hole. The jet's
// force is 2 A dp, but the gas can be measured directly.
wisp_status closed_emptying( closed_run* run, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = 1.2f;
    setting.def.outlet_count = 1;
    setting.def.outlet_area = 1e-5f;
    setting.def.outlet_open = true;
    setting.def.spin = WISP_BALLOON_SPIN_NONE;
    setting.damping = 5.0f;
    setting.substeps = run->parameter;
    setting.iterations = 1;
    sphere_run sphere = { .fabric = NULL };
    wisp_balloon_stats seen = { 0 };
    wisp_status status = make_sphere( 0, (double)BALLOON_RADIUS, &sphere, error );
    if ( status == WISP_OK )
    {
        const balloon_equilibrium begin = balloon_equilibrium_of( sphere.fabric, &setting.def, true );
        status = stretch_sphere( &sphere, begin.scale, error );
        const int steps = (int)lrint( run->first / (double)ACCURACY_FRAME );
        status = status == WISP_OK ? fly_sphere( run, setting, steps, &sphere, &seen, error ) : status;
        run->measured = (double)setting.def.gas_ratio * seen.rest_volume - seen.target_volume;
        run->reference = begin.volume * ( (double)setting.def.gas_ratio -
                                          balloon_fill_after( sphere.fabric, &setting.def, run->first ) );
    }
    leave( &sphere );
    return status;
}
