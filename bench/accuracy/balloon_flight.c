// A full balloon without symmetry is released: jet, spin, drag and buoyancy. The path of its centre is compared with
// a flight of the oracle, which solves the same equations in double precision. The engine cannot be the reference: the
// displacement by gravity in such a short substep is below the rounding of a float. Every flight starts from the same
// shape, a balloon at rest, filled at small substeps. A start out of balance would ring, for a time that depends only
// on the substep.
#include "balloon_flight_run.h"

#include <math.h>
#include <stdlib.h>

enum
{
    USUAL_SUBSTEPS = 10,
    ORDERLY_SUBSTEPS = 20,
    FINEST_SUBSTEPS = 160,
    REFERENCE_SUBSTEPS = 5120,
    SETTINGS_MAX = 40,
};

typedef struct flight_scene
{
    flight_body body;
    flight_path reference;
    balloon_setting settings[SETTINGS_MAX];
} flight_scene;

// ---- settings ----

static void add( accuracy_scene* scene, int substeps, int iterations, const char* name )
{
    flight_scene* own = scene->context;
    own->settings[scene->setting_count] = flight_setting( substeps, iterations );
    accuracy_put_setting( scene, "%s", name );
}

// Forces are evaluated at the beginning of a substep and velocities from the positions at its end: first order,
// provided that the skin relaxes within a substep. Coarser substeps are therefore outside the series.
static void add_substeps( accuracy_scene* scene )
{
    static const int substeps[] = { 5, USUAL_SUBSTEPS, 20, 40, 80, FINEST_SUBSTEPS };
    static const int iterations[] = { 1, 4 };
    for ( int k = 0; k < WISP_COUNT( iterations ); ++k )
    {
        for ( int i = 0; i < WISP_COUNT( substeps ); ++i )
        {
            char series[48], name[64];
            snprintf( series, sizeof( series ), "kick, max drag, n x %d", iterations[k] );
            snprintf( name, sizeof( name ), "kick, max drag, %d x %d", substeps[i], iterations[k] );
            add( scene, substeps[i], iterations[k], name );
            accuracy_setting* setting = &scene->settings[scene->setting_count - 1];
            snprintf( setting->method, sizeof( setting->method ), "%s", series );
            accuracy_join_series( setting, substeps[i] >= ORDERLY_SUBSTEPS ? series : "", "substep, s",
                                  (double)ACCURACY_FRAME / substeps[i], 1.0 );
        }
    }
}

// ---- runs ----

static wisp_status run( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const flight_scene* scene = context;
    flight_path path = { .speed = NAN };
    wisp_status status =
        flight_fly( &scene->body, scene->settings[index], workers, out, is_observed ? &path : NULL, error );
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        flight_judge( &path, &scene->reference, out );
    }
    return status;
}

// ---- the reference ----

static wisp_status make_reference( flight_scene* own, accuracy_scene* out, wisp_error* error )
{
    flight_path coarser = { .speed = NAN };
    wisp_status status = flight_fly_oracle( &own->body, REFERENCE_SUBSTEPS, &own->reference, error );
    status = status == WISP_OK ? flight_fly_oracle( &own->body, REFERENCE_SUBSTEPS / 2, &coarser, error ) : status;
    if ( status == WISP_OK )
    {
        snprintf( out->reference, sizeof( out->reference ), "the same flight in double precision, with %d substeps",
                  REFERENCE_SUBSTEPS );
        out->uncertainty = 1e3 * flight_distance( &coarser, &own->reference );
    }
    return status;
}

// ---- the scene ----

static void destroy( void* context )
{
    flight_scene* scene = context;
    flight_free_body( &scene->body );
    free( scene );
}

wisp_status accuracy_balloon_flight( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds; // it is fast
    *out = ( accuracy_scene ){
        .note = "other forms of drag, spin and pressure give other flights; their error is the difference of the "
                "model. Momentum closes up to forces evaluated once per step and float rounding.",
        .error_name = "distance of the centre's path",
        .error_unit = "mm",
        .measure_names = FLIGHT_MEASURES,
        .measure_count = FLIGHT_MEASURE_COUNT,
        .settings = calloc( SETTINGS_MAX, sizeof( accuracy_setting ) ),
        .context = calloc( 1, sizeof( flight_scene ) ),
        .run = run,
        .destroy = destroy,
    };
    wisp_status status = WISP_OK;
    if ( !out->settings || !out->context )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the settings of balloon_flight" );
    }
    flight_scene* scene = out->context;
    status = status == WISP_OK ? flight_make_body( &scene->body, error ) : status;
    status = status == WISP_OK ? make_reference( scene, out, error ) : status;
    if ( status != WISP_OK )
    {
        if ( out->context )
        {
            destroy( out->context );
        }
        free( out->settings );
        *out = ( accuracy_scene ){ .setting_count = 0 };
        return status;
    }
    add_substeps( out );
    return WISP_OK;
}
