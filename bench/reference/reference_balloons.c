// A full balloon is released: the flight of the oracle, and for `balloon_meshes` that of the engine on its finest
// mesh.
#include "accuracy_references.h"
#include "converge.h"

#include "accuracy/balloon_flight_run.h"
#include "oracle/balloon_oracle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
    FLIGHT_SUBSTEPS = 40960, // of each 1/60 s
};

#define FLIGHT_TOLERANCE 1e-4 // m

static double3 widen( wisp_vec3 p )
{
    return double3_make( (double)p.x, (double)p.y, (double)p.z );
}

static void observe( const balloon_oracle* oracle, int step, flight_path* out )
{
    double3 momentum = { 0.0, 0.0, 0.0 }, centre = momentum;
    for ( int i = 0; i < oracle->vertex_count; ++i )
    {
        const double fraction = oracle->mass[i] / oracle->total_mass;
        centre = double3_add( centre, double3_scale( fraction, oracle->x[i] ) );
        momentum = double3_add( momentum, double3_scale( fraction, oracle->v[i] ) );
    }
    out->centre[step][0] = centre.x;
    out->centre[step][1] = centre.y;
    out->centre[step][2] = centre.z;
    out->speed = double3_length( momentum );
    out->spin = double3_length( oracle->omega );
    out->volume = balloon_oracle_present_volume( oracle );
}

static wisp_status make_oracle( const flight_body* body, int substeps, balloon_oracle* out, wisp_error* error )
{
    const int count = body->mesh.vertex_count;
    double3* points = calloc( (size_t)count, sizeof( double3 ) );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a balloon in double precision" );
    }
    for ( int i = 0; i < count; ++i )
    {
        points[i] = widen( body->mesh.points[i] );
    }
    const balloon_mesh mesh = { count, body->mesh.triangle_count, points, body->mesh.triangles };
    const balloon_setting setting = flight_setting( substeps, 1 );
    balloon_oracle_options options = balloon_oracle_default_options();
    options.dt = (double)ACCURACY_FRAME;
    options.substeps = setting.substeps;
    options.iterations = setting.iterations;
    options.outlet_area = (double)setting.def.outlet_area;
    options.outlet_open = true;
    const wisp_status status =
        balloon_oracle_create_from_mesh( &mesh, (double)setting.area_density, body->outlet, &options, out, error );
    free( points );
    if ( status == WISP_OK )
    {
        out->gas_volume = (double)setting.def.gas_ratio * out->rest_volume;
        for ( int i = 0; i < count; ++i )
        {
            out->x[i] = widen( body->full[i] );
        }
    }
    return status;
}

static wisp_status fly( void* context, int substeps, double* numbers, wisp_error* error )
{
    balloon_oracle oracle;
    flight_path path = { .speed = NAN };
    const wisp_status status = make_oracle( context, substeps, &oracle, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int step = 1; step <= FLIGHT_STEPS; ++step )
    {
        balloon_oracle_step( &oracle );
        observe( &oracle, step, &path );
    }
    flight_put_path( &path, numbers );
    balloon_oracle_destroy( &oracle );
    return WISP_OK;
}

wisp_status reference_of_balloon_flight( accuracy_reference* out, wisp_error* error )
{
    flight_body body;
    wisp_status status = flight_make_body( FLIGHT_LEVEL, &body, error );
    status = status == WISP_OK ? flight_fill_body( &body, FLIGHT_FILL_SUBSTEPS, error ) : status;
    if ( status == WISP_OK )
    {
        *out = flight_reference( &body );
        snprintf( out->reference, sizeof( out->reference ), "the same flight in double precision" );
        snprintf(
            out->layout, sizeof( out->layout ),
            "float64 [%d steps][x, y, z] of the centre, m; speed, m/s, spin, rad/s, and volume, m3, in the end; "
            "[%d vertices][x, y, z], m: the full balloon that is let go",
            FLIGHT_STEPS, body.mesh.vertex_count );
        snprintf( out->solver, sizeof( out->solver ),
                  "the balloon's equations one by one, xpbd, one iteration (tests/oracle/balloon_oracle.h); substeps "
                  "are of 1/60 s" );
        snprintf( out->precision, sizeof( out->precision ), "double" );
        const converge_plan plan = { .run = fly,
                                     .context = &body,
                                     .unit = "substeps",
                                     .substeps = FLIGHT_SUBSTEPS,
                                     .compared = 3 * FLIGHT_STEPS,
                                     .dimension = 3,
                                     .converging = FLIGHT_NUMBERS,
                                     .tolerance = FLIGHT_TOLERANCE };
        status = converge( &plan, out, error );
    }
    for ( int i = 0; i < body.mesh.vertex_count && status == WISP_OK; ++i )
    {
        double* to = out->numbers + FLIGHT_NUMBERS + 3 * i;
        to[0] = (double)body.full[i].x;
        to[1] = (double)body.full[i].y;
        to[2] = (double)body.full[i].z;
    }
    flight_free_body( &body );
    return status;
}

// ---- meshes ----

// The engine's flight, and its distance from the oracle, which has the same substeps in double precision and another
// order of links.
static wisp_status fly_engine( flight_body* body, int pace, double* numbers, double* distance, wisp_error* error )
{
    double other[FLIGHT_NUMBERS];
    accuracy_run times = { .error = NAN };
    flight_path path = { .speed = NAN };
    wisp_status status = flight_fly( body, flight_setting( flight_paces[pace], 1 ), 1, &times, &path, error );
    if ( status == WISP_OK && times.halted_at != 0 )
    {
        status = wisp_fail( error, WISP_CONFLICT, "the finest mesh was halted at step %d", times.halted_at );
    }
    status = status == WISP_OK ? fly( body, flight_paces[pace], other, error ) : status;
    if ( status == WISP_OK )
    {
        const flight_path oracle = flight_take_path( other );
        flight_put_path( &path, numbers );
        *distance = flight_distance( &path, &oracle );
        fprintf( stderr, "balloon_meshes: with %d substeps the oracle is %.3g mm away\n", flight_paces[pace],
                 1e3 * *distance );
    }
    free( times.ms );
    return status;
}

static wisp_status fly_paces( flight_body* body, accuracy_reference* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    out->numbers = calloc( (size_t)out->number_count, sizeof( double ) );
    if ( !out->numbers )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d numbers", out->number_count );
    }
    for ( int pace = 0; pace < FLIGHT_PACES && status == WISP_OK; ++pace )
    {
        double distance = NAN;
        status = fly_engine( body, pace, out->numbers + pace * FLIGHT_NUMBERS, &distance, error );
        out->uncertainty = fmax( out->uncertainty, distance );
        out->substeps = flight_paces[pace];
    }
    return status;
}

wisp_status reference_of_balloon_meshes( accuracy_reference* out, wisp_error* error )
{
    flight_body body;
    wisp_status status = flight_make_body( FLIGHT_MESHES_LEVEL, &body, error );
    status = status == WISP_OK ? flight_fill_body( &body, FLIGHT_MESHES_FILL, error ) : status;
    if ( status == WISP_OK )
    {
        *out = flight_meshes_reference( &body );
        snprintf( out->reference, sizeof( out->reference ),
                  "the engine itself on a mesh of %d vertices, at the same substeps", body.mesh.vertex_count );
        snprintf( out->solver, sizeof( out->solver ),
                  "the engine, xpbd, one iteration, %d and %d substeps of 1/60 s, filled with %d", flight_paces[0],
                  flight_paces[1], FLIGHT_MESHES_FILL );
        snprintf( out->precision, sizeof( out->precision ), "float" );
        snprintf(
            out->converged, sizeof( out->converged ),
            "in nothing but its mesh: short substeps do not damp so fine a skin, and every doubling of them "
            "moves its "
            "path again. The uncertainty is how far the oracle is at the same substeps, in double precision and with "
            "its links in another order" );
        snprintf( out->layout, sizeof( out->layout ),
                  "float64 [with %d and %d substeps]: [%d steps][x, y, z] of the centre, m; speed, m/s, spin, rad/s, "
                  "and volume, m3, in the end",
                  flight_paces[0], flight_paces[1], FLIGHT_STEPS );
        status = fly_paces( &body, out, error );
    }
    flight_free_body( &body );
    return status;
}
