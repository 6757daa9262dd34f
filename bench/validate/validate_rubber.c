// Spheres of a neo-Hookean skin, filled to several sizes in one world. The pressure that a skin holds at rest is compared with the closed
// form at the size that it has, and that size with the one for its gas. More gas is in every next one, and yet the pressure falls again
// behind the limit point.
#include "validate_balloons.h"

#include "accuracy/scene_tools.h"
#include "balloon_scene.h"
#include "oracle/membrane_oracle.h"
#include "validate_world.h"

#include <math.h>

enum
{
    SIZES = 9,
    LEVELS = 4,
    MAX_SETTINGS = 16,
};

static const double STRETCHES[SIZES] = { 1.1, 1.2, 1.3, 1.4, 1.5, 1.7, 2.0, 2.5, 3.0 };
static const double RADIUS = 0.05, MODULUS = 4e5, THICKNESS = 2e-4; // m, Pa, m: latex
static const double ATMOSPHERE = 101325.0;                          // Pa

enum
{
    FILLING = 60, // steps
    RESTING = 60,
};

typedef struct way
{
    int level, substeps;
    bool by_substeps;
} way;

typedef struct spheres
{
    validate_world world;
    wisp_mesh mesh;
    wisp_fabric* fabric;
} spheres;

static double stiffness( void )
{
    return MODULUS * THICKNESS;
}

// Gas for a stretch, in volumes at atmospheric pressure of the sphere at rest.
static double gas_for( double s )
{
    return s * s * s * ( 1.0 + membrane_oracle_sphere_pressure( stiffness(), RADIUS, s ) / ATMOSPHERE );
}

static wisp_status add_sphere( spheres* own, wisp_error* error )
{
    wisp_world* world = own->world.world;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.fabric = own->fabric;
    surface.points = own->mesh.points;
    surface.area_density = 0.2f;
    surface.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    wisp_membrane_def membrane = wisp_default_membrane_def();
    membrane.shear_modulus = (float)MODULUS;
    membrane.thickness = (float)THICKNESS;
    wisp_balloon_def balloon = wisp_default_balloon_def();
    balloon.buoyancy = false;
    balloon.drag_coefficient = 0.0f;
    wisp_entity sphere;
    wisp_status status = wisp_add_surface( world, &surface, &sphere );
    status = status == WISP_OK ? wisp_set_damping( world, sphere, 20.0f ) : status;
    status = status == WISP_OK ? wisp_set_membrane( world, sphere, &membrane ) : status;
    status = status == WISP_OK ? wisp_set_balloon( world, sphere, &balloon ) : status;
    status = status == WISP_OK ? wisp_request_balloon_stats( world, sphere, true ) : status;
    status = status == WISP_OK
                 ? validate_world_add( &own->world, sphere, WISP_SURFACE_POINTS, own->mesh.vertex_count )
                 : status;
    return status == WISP_OK ? WISP_OK : bench_world_fail( world, status, error );
}

static wisp_status make_spheres( const way* w, int workers, spheres* own, wisp_error* error )
{
    static const wisp_module* const modules[] = { &wisp_membrane_module, &wisp_balloon_module };
    const bench_world_def world = { modules, WISP_COUNT( modules ), workers, w->substeps, 1 };
    wisp_fabric_def fabric = wisp_default_fabric_def();
    fabric.bend_links = false;
    wisp_status status = balloon_mesh_sphere( w->level, (float)RADIUS, &own->mesh, error );
    status = status == WISP_OK ? surface_cook( &own->mesh, fabric, &own->fabric, error ) : status;
    status = status == WISP_OK ? validate_world_create( &world, &own->world, error ) : status;
    for ( int i = 0; i < SIZES && status == WISP_OK; ++i )
    {
        status = add_sphere( own, error );
    }
    return status;
}

static void leave( spheres* own )
{
    validate_world_release( &own->world );
    wisp_fabric_release( own->fabric );
    wisp_mesh_release( &own->mesh );
}

static wisp_status set_gas( spheres* own, double part, wisp_error* error )
{
    wisp_world* world = own->world.world;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < SIZES && status == WISP_OK; ++i )
    {
        const double gas = 1.0 + ( gas_for( STRETCHES[i] ) - 1.0 ) * part;
        status = wisp_set_balloon_gas_ratio( world, own->world.bodies[i].entity, (float)gas );
    }
    return status == WISP_OK ? WISP_OK : bench_world_fail( world, status, error );
}

// They are filled evenly, and then come to rest.
static wisp_status fill( spheres* own, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int step = 1; step <= FILLING && status == WISP_OK; ++step )
    {
        status = set_gas( own, (double)step / FILLING, error );
        status = status == WISP_OK ? validate_world_step( &own->world, 1, out, error ) : status;
    }
    return status == WISP_OK ? validate_world_step( &own->world, RESTING, out, error ) : status;
}

// The top of the parabola through the largest value and its neighbours.
static void find_top( const double x[SIZES], const double y[SIZES], double* top_x, double* top_y )
{
    int k = 1;
    for ( int i = 1; i + 1 < SIZES; ++i )
    {
        k = y[i] > y[k] ? i : k;
    }
    const double a = ( y[k - 1] - y[k] ) / ( x[k - 1] - x[k] ), b = ( y[k + 1] - y[k] ) / ( x[k + 1] - x[k] );
    const double curve = ( b - a ) / ( x[k + 1] - x[k - 1] ), slope = a - curve * ( x[k - 1] - x[k] );
    *top_x = x[k] - slope / ( 2.0 * curve );
    *top_y = y[k] - slope * slope / ( 4.0 * curve );
}

// Measures: the limit point and its pressure, theory of both, and the largest difference of a size from that for its gas.
static wisp_status measure( spheres* own, accuracy_run* out, wisp_error* error )
{
    double stretch[SIZES], pressure[SIZES], sum = 0.0, largest = 0.0;
    for ( int i = 0; i < SIZES; ++i )
    {
        wisp_balloon_stats seen;
        const wisp_status status = wisp_read_balloon_stats( own->world.world, own->world.bodies[i].entity, &seen );
        if ( status != WISP_OK )
        {
            return bench_world_fail( own->world.world, status, error );
        }
        stretch[i] = cbrt( seen.volume / seen.rest_volume );
        pressure[i] = seen.pressure;
        const double wrong = pressure[i] / membrane_oracle_sphere_pressure( stiffness(), RADIUS, stretch[i] ) - 1.0;
        sum += wrong * wrong;
        largest = fmax( largest, fabs( stretch[i] / STRETCHES[i] - 1.0 ) );
    }
    out->error = 100.0 * sqrt( sum / SIZES );
    find_top( stretch, pressure, out->measures, out->measures + 1 );
    out->measures[2] = membrane_oracle_limit_point();
    out->measures[3] = membrane_oracle_sphere_pressure( stiffness(), RADIUS, membrane_oracle_limit_point() );
    out->measures[4] = 100.0 * largest;
    return WISP_OK;
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const way* w = (const way*)context + setting;
    spheres own = { .fabric = NULL };
    wisp_status status = make_spheres( w, workers, &own, error );
    status = status == WISP_OK ? fill( &own, out, error ) : status;
    status = status == WISP_OK ? validate_world_finish( &own.world, out, error ) : status;
    status = status == WISP_OK && is_observed && out->halted_at == 0 ? measure( &own, out, error ) : status;
    leave( &own );
    return status;
}

static void put( accuracy_scene* out, way w )
{
    ( (way*)out->context )[out->setting_count] = w;
    accuracy_setting* s =
        accuracy_put_setting( out, "membrane, %d triangles, %d substeps", 20 << 2 * w.level, w.substeps );
    accuracy_join_series( s, w.by_substeps ? "membrane by substeps" : "membrane by edges",
                          w.by_substeps ? "substep, s" : "edge / R",
                          w.by_substeps ? (double)VALIDATE_STEP / w.substeps : validate_sphere_edge( w.level ), 2.0 );
}

wisp_status validate_rubber( const bench_options* options, double seconds, accuracy_scene* out, wisp_error* error )
{
    (void)seconds;
    *out = ( accuracy_scene ){
        .reference = "p = 2 G / R (1 / s - 1 / s^7), at the stretch s of the volume; nine balloons at rest",
        .error_name = "distance of the pressure",
        .error_unit = "%",
        .measure_names = { "limit point, s", "its pressure, Pa", "theory, s", "theory, Pa", "size for its gas, %" },
        .measure_count = 5,
        .run = run,
    };
    const wisp_status status = accuracy_begin_scene( out, MAX_SETTINGS * sizeof( way ), MAX_SETTINGS, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    static const int substeps[] = { 5, 10, 20, 40, 160 };
    for ( int level = 0; level < ( options->quick ? LEVELS - 1 : LEVELS ); ++level )
    {
        put( out, ( way ){ level, 80, false } );
    }
    for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
    {
        put( out, ( way ){ 2, substeps[i], true } );
    }
    return WISP_OK;
}
