// Fills a balloon, brings it to rest and releases it.
#include "balloon_flight_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    LEVEL = 1, // 42 vertices
    FILL_STEPS = 60,
    FILL_SUBSTEPS = 640,
};

#define FILL_DAMPING 45.0f
// The outlet is so small that gas is left at the end of the flight; how the jet ends is not part of the scene.
#define OUTLET_AREA 1e-5f

static double length( const double a[3] )
{
    return sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
}

double flight_distance( const flight_path* a, const flight_path* b )
{
    double sum = 0.0;
    for ( int s = 1; s <= FLIGHT_STEPS; ++s )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const double d = a->centre[s][k] - b->centre[s][k];
            sum += d * d / FLIGHT_STEPS;
        }
    }
    return sqrt( sum );
}

// ---- bodies ----

// Fill it in short substeps and let it come to rest.
static wisp_status fill( flight_body* body, wisp_error* error )
{
    balloon_setting setting = balloon_setting_in_vacuum();
    setting.def.gas_ratio = FLIGHT_FILL;
    setting.damping = FILL_DAMPING;
    setting.substeps = FILL_SUBSTEPS;
    setting.iterations = 1;
    setting.seconds = ACCURACY_FRAME;
    surface_implementation implementation = { 0 };
    const wisp_vec3* points = NULL;
    wisp_status status = balloon_implementation_create( body->fabric, &setting, &implementation, error );
    for ( int s = 0; s < FILL_STEPS && status == WISP_OK; ++s )
    {
        status = surface_implementation_step( &implementation, error );
    }
    status = status == WISP_OK ? surface_implementation_points( &implementation, &points, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( body->full, points, (size_t)body->mesh.vertex_count * sizeof( wisp_vec3 ) );
    }
    surface_implementation_destroy( &implementation );
    return status;
}

wisp_status flight_make_body( flight_body* out, wisp_error* error )
{
    const balloon_setting setting = balloon_default_setting();
    *out = ( flight_body ){ .fabric = NULL };
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_PEAR );
    generator.radius = BALLOON_RADIUS;
    generator.level = LEVEL;
    wisp_status status = wisp_mesh_generate( &generator, &out->mesh, error );
    status = status == WISP_OK ? balloon_cook( &out->mesh, &setting, &out->fabric, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    // next to the centre, so that the jet turns the body
    out->outlet = balloon_mesh_extreme( &out->mesh, ( wisp_vec3 ){ 1.0f, 0.5f, 0.2f } );
    out->full = malloc( (size_t)out->mesh.vertex_count * sizeof( wisp_vec3 ) );
    return out->full ? fill( out, error ) : wisp_fail( error, WISP_NO_MEMORY, "no memory for a full balloon" );
}

void flight_free_body( flight_body* body )
{
    wisp_fabric_release( body->fabric );
    wisp_mesh_release( &body->mesh );
    free( body->full );
    *body = ( flight_body ){ .fabric = NULL };
}

// ---- a flight ----

balloon_setting flight_setting( int substeps, int iterations )
{
    balloon_setting setting = balloon_default_setting();
    setting.def.gas_ratio = FLIGHT_FILL;
    setting.def.outlet_count = 1;
    setting.def.outlet_area = OUTLET_AREA;
    setting.def.outlet_open = true;
    setting.substeps = substeps;
    setting.iterations = iterations;
    setting.seconds = ACCURACY_FRAME;
    return setting;
}

// Forces are those of the last substep of each step, integrated by the trapezium rule; the first step uses only its
// own. The remainder is the error of that sum and momentum that the solver adds or removes.
static void close_momentum( const wisp_motion_stats* seen, const wisp_balloon_stats* forces, double before[3],
                            double sum[3], int step, flight_path* path )
{
    double missing[3], now[3];
    for ( int k = 0; k < 3; ++k )
    {
        now[k] = forces->gravity[k] + forces->buoyancy[k] + forces->drag[k] + forces->jet[k];
        sum[k] += (double)ACCURACY_FRAME * ( step == 1 ? now[k] : 0.5 * ( before[k] + now[k] ) );
        before[k] = now[k];
        missing[k] = seen->momentum[k] - sum[k];
    }
    path->impulse_missing = length( missing );
    path->impulse = fmax( path->impulse, length( seen->momentum ) );
}

static wisp_status observe( surface_implementation* implementation, int step, double before[3], double sum[3],
                            flight_path* path, wisp_error* error )
{
    wisp_motion_stats seen = { 0 };
    wisp_balloon_stats forces = { 0 };
    wisp_status status = accuracy_read_motion_stats( implementation, &seen, error );
    status = status == WISP_OK ? balloon_implementation_read( implementation, &forces, error ) : status;
    if ( status == WISP_OK )
    {
        memcpy( path->centre[step], seen.centre, sizeof( seen.centre ) );
        path->speed = length( seen.momentum ) / seen.mass;
        path->spin = length( forces.angular_velocity );
        path->volume = seen.volume;
        close_momentum( &seen, &forces, before, sum, step, path );
    }
    return status;
}

wisp_status flight_fly( const flight_body* body, balloon_setting setting, int workers, accuracy_run* out,
                        flight_path* path, wisp_error* error )
{
    setting.points = body->full;
    setting.def.outlet[0] = body->outlet;
    setting.workers = workers;
    surface_implementation implementation = { 0 };
    wisp_status status = balloon_implementation_create( body->fabric, &setting, &implementation, error );
    if ( status == WISP_OK )
    {
        status = wisp_request_balloon_stats( implementation.world, implementation.entity, path != NULL );
        status = status == WISP_OK ? accuracy_request_motion_stats( &implementation, path != NULL, error )
                                   : bench_world_fail( implementation.world, status, error );
    }
    double before[3] = { 0.0 }, sum[3] = { 0.0 };
    for ( int step = 1; step <= FLIGHT_STEPS && implementation.halted_at == 0 && status == WISP_OK; ++step )
    {
        status = accuracy_step_surface( &implementation, 1, out, error );
        if ( status == WISP_OK && path )
        {
            status = observe( &implementation, step, before, sum, path, error );
        }
    }
    status = status == WISP_OK ? accuracy_end_surface( &implementation, out, error ) : status;
    surface_implementation_destroy( &implementation );
    return status;
}

// ---- the distance to the reference ----

void flight_judge( const flight_path* path, const flight_path* reference, accuracy_run* out )
{
    out->error = 1e3 * flight_distance( path, reference );
    out->measures[0] = path->speed;
    out->measures[1] = 100.0 * ( path->speed / reference->speed - 1.0 );
    out->measures[2] = path->spin;
    out->measures[3] = 100.0 * ( path->volume / reference->volume - 1.0 );
    out->measures[4] = 100.0 * path->impulse_missing / path->impulse;
}
