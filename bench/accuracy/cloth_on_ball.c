// The comparison's cloth falls onto a ball: scene, reference in double precision and solvers are those of `cloth
// --compare`.
#include "accuracy_surface.h"

#include "compare_bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct ball_scene
{
    compare_scene scene;
    compare_reference reference;
    compare_plan plan; // whose variants are the settings
    wisp_fabric* fabric;
    wisp_vec3* start;
} ball_scene;

/// Buffers of a sample.
typedef struct ball_observation
{
    double *points, *velocities; // [vertex_count][3]
    wisp_vec3* read;             // [vertex_count]
    double sum;                  // m^2, of the mean square distances
} ball_observation;

// ---- a sample ----

static void free_observation( ball_observation* observation )
{
    free( observation->points );
    free( observation->velocities );
    free( observation->read );
}

static wisp_status make_observation( const ball_scene* own, ball_observation* out, wisp_error* error )
{
    const size_t n = (size_t)own->reference.vertex_count;
    *out = ( ball_observation ){ .points = calloc( n, 3 * sizeof( double ) ),
                                 .velocities = calloc( n, 3 * sizeof( double ) ),
                                 .read = calloc( n, sizeof( wisp_vec3 ) ) };
    return out->points && out->velocities && out->read
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory to observe %zu vertices", n );
}

static void widen( const wisp_vec3* from, int count, double* to )
{
    for ( int i = 0; i < count; ++i )
    {
        to[3 * i] = (double)from[i].x;
        to[3 * i + 1] = (double)from[i].y;
        to[3 * i + 2] = (double)from[i].z;
    }
}

static wisp_status observe_path( const ball_scene* own, int number, surface_implementation* implementation,
                                 ball_observation* observation, wisp_error* error )
{
    const wisp_vec3* points;
    const int count = own->reference.vertex_count;
    const wisp_status status = surface_implementation_points( implementation, &points, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    widen( points, count, observation->points );
    const float* reference = own->reference.points + (size_t)number * 3 * (size_t)count;
    for ( int i = 0; i < 3 * count; ++i )
    {
        const double off = observation->points[i] - (double)reference[i];
        observation->sum += off * off / count;
    }
    return WISP_OK;
}

static void measure( const ball_scene* own, surface_implementation* implementation, ball_observation* observation,
                     accuracy_run* out )
{
    surface_implementation_velocities( implementation, observation->read );
    widen( observation->read, own->reference.vertex_count, observation->velocities );
    const compare_observation seen = compare_observe( &own->scene, observation->points, observation->velocities );
    const compare_observation* reference =
        &own->reference.observations[own->scene.physics.observation_count - 1].observation;
    out->error = 1e3 * sqrt( observation->sum / ( own->scene.physics.observation_count - 1 ) );
    out->measures[0] = 1e3 * ( seen.hem - reference->hem );
    out->measures[1] = 1e2 * seen.strain;
    out->measures[2] = 1e3 * ( seen.energy - reference->energy );
}

// ---- a run ----

// Times are per frame, whatever the length of a step, and only of steps while the cloth is on the ball.
static wisp_status go_on( surface_implementation* implementation, bool is_timed, accuracy_run* out,
                          wisp_error* error )
{
    const double seconds = (double)implementation->generator.seconds;
    const int steps = (int)lround( (double)COMPARE_OBSERVATION_SECONDS / seconds );
    wisp_status status = WISP_OK;
    for ( int k = 0; k < steps && status == WISP_OK; ++k )
    {
        status = is_timed ? accuracy_time_surface( implementation, (double)COMPARE_FRAME / seconds, out, error )
                          : surface_implementation_step( implementation, error );
    }
    return status;
}

static wisp_status fall( const ball_scene* own, surface_implementation* implementation, bool is_observed,
                         accuracy_run* out, wisp_error* error )
{
    const compare_physics* physics = &own->scene.physics;
    ball_observation observation = { .sum = 0.0 };
    wisp_status status = is_observed ? make_observation( own, &observation, error ) : WISP_OK;
    for ( int number = 1; number < physics->observation_count && status == WISP_OK; ++number )
    {
        status = go_on( implementation, number > physics->timed_observation, out, error );
        status = status == WISP_OK && is_observed ? observe_path( own, number, implementation, &observation, error )
                                                  : status;
    }
    if ( status == WISP_OK && is_observed )
    {
        measure( own, implementation, &observation, out );
    }
    free_observation( &observation );
    return status == WISP_OK ? accuracy_end_surface( implementation, out, error ) : status;
}

static wisp_status run( void* context, int setting, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const ball_scene* own = context;
    surface_implementation implementation;
    wisp_status status = compare_enter( &own->scene, own->fabric, &own->plan.variants[setting], own->start, workers,
                                        &implementation, error );
    if ( status == WISP_OK )
    {
        status = fall( own, &implementation, is_observed, out, error );
        surface_implementation_destroy( &implementation );
    }
    return status;
}

// ---- settings ----

// A variant belongs to the series of its name without the parameter.
static void add_setting( accuracy_scene* scene, const compare_variant* variant )
{
    accuracy_setting* setting = accuracy_put_setting( scene, "%s", variant->name );
    char series[48];
    if ( variant->method == COMPARE_IMPLICIT )
    {
        snprintf( series, sizeof( series ), "implicit %s, %g, %d", variant->bdf2 ? "BDF2" : "Euler",
                  (double)variant->tolerance, variant->repeats );
        accuracy_join_series( setting, series, "step, s", 1.0 / variant->rate, variant->bdf2 ? 2.0 : 1.0 );
        snprintf( setting->method, sizeof( setting->method ), "implicit %s", variant->bdf2 ? "BDF2" : "Euler" );
        return;
    }
    if ( variant->method == COMPARE_PBD )
    {
        snprintf( series, sizeof( series ), "pbd, stiffness %g", (double)variant->stiffness );
    }
    else
    {
        snprintf( series, sizeof( series ), "xpbd" );
    }
    // neither converges to the model of Noh and Jung
    accuracy_join_series( setting, series, "step, s", (double)COMPARE_FRAME / variant->substeps, NAN );
    snprintf( setting->method, sizeof( setting->method ), "%s", compare_method_names[variant->method] );
}

// ---- the scene ----

static void destroy( void* context )
{
    ball_scene* own = context;
    wisp_fabric_release( own->fabric );
    compare_reference_free( &own->reference );
    compare_scene_free( &own->scene );
    free( own->start );
    free( own );
}

static wisp_status take_start( ball_scene* own, wisp_error* error )
{
    const int count = own->reference.vertex_count;
    own->start = calloc( (size_t)count, sizeof( wisp_vec3 ) );
    if ( !own->start )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d vertices", count );
    }
    for ( int i = 0; i < count; ++i )
    {
        const float* p = own->reference.points + 3 * (size_t)i;
        own->start[i] = ( wisp_vec3 ){ p[0], p[1], p[2] };
    }
    return WISP_OK;
}

static wisp_status fill( ball_scene* own, wisp_error* error )
{
    char path[1024];
    snprintf( path, sizeof( path ), "%s/%s.reference", own->plan.folder, compare_physics_of( COMPARE_DRAPE ).name );
    wisp_status status = compare_scene_make( COMPARE_DRAPE, TRIANGLE_VERTICES, &own->scene, error );
    status = status == WISP_OK ? compare_reference_read( path, &own->reference, error ) : status;
    status = status == WISP_OK ? compare_reference_check( &own->reference, &own->scene, path, error ) : status;
    status = status == WISP_OK ? compare_cook( &own->scene, &own->fabric, error ) : status;
    return status == WISP_OK ? take_start( own, error ) : status;
}

static void describe( const ball_scene* own, accuracy_scene* out )
{
    double square = 0.0;
    const int observations = own->scene.physics.observation_count;
    for ( int k = 1; k < observations; ++k )
    {
        square += own->reference.observations[k].uncertainty * own->reference.observations[k].uncertainty /
                  ( observations - 1 );
    }
    out->uncertainty = 1e3 * sqrt( square );
    snprintf(
        out->reference, sizeof( out->reference ),
        "%s in double precision, %g steps per second, each by Newton's method, at %d samples from %.2f to %.2f s",
        own->reference.order > 1.5 ? "BDF2" : "implicit Euler", own->reference.rate, observations - 1,
        (double)COMPARE_OBSERVATION_SECONDS, (double)COMPARE_OBSERVATION_SECONDS * ( observations - 1 ) );
}

wisp_status accuracy_cloth_on_ball( const bench_options* options, double seconds, accuracy_scene* out,
                                    wisp_error* error )
{
    (void)seconds;
    *out = ( accuracy_scene ){
        .note =
            "the reference is implicit; edges of xpbd and pbd also resist compression and converge to another cloth. "
            "Names give substeps per frame, or rate, integrator, tolerance and solves. pbd has no SI stiffness.",
        .error_name = "RMS distance to the reference",
        .error_unit = "mm",
        .ms_name = "frame of 1/60 s",
        .measure_names = { "hem above the reference's, mm", "strain, %", "energy above the reference's, mJ" },
        .measure_count = 3,
        .settings = calloc( COMPARE_VARIANTS_MAX, sizeof( accuracy_setting ) ),
        .context = calloc( 1, sizeof( ball_scene ) ),
        .run = run,
        .destroy = destroy
    };
    if ( !out->settings || !out->context )
    {
        free( out->settings );
        free( out->context );
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for a cloth on a ball" );
    }
    ball_scene* own = out->context;
    own->plan = compare_default_plan( options );
    const wisp_status status = fill( own, error );
    if ( status != WISP_OK )
    {
        destroy( own );
        free( out->settings );
        return status;
    }
    for ( int i = 0; i < own->plan.variant_count; ++i )
    {
        add_setting( out, &own->plan.variants[i] );
    }
    describe( own, out );
    return WISP_OK;
}
