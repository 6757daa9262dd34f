// The flight of `balloon_flight` on finer meshes, against a stored flight on a still finer mesh at the same substeps.
// No order is expected: a finer mesh is stiffer than the substeps resolve, so two errors partly cancel. More substeps
// give no reference either: they no longer damp a fine skin, whose ringing moves the path by a centimetre.
#include "balloon_flight_run.h"

#include <math.h>
#include <stdlib.h>

enum
{
    LEVELS = 3,
    FIRST_LEVEL = 1, // 42, 162, 642 vertices
};

typedef struct mesh_scene
{
    flight_body bodies[LEVELS];
    flight_path reference[FLIGHT_PACES];
} mesh_scene;

static wisp_status run( void* context, int index, int workers, bool is_observed, accuracy_run* out,
                        wisp_error* error )
{
    const mesh_scene* scene = context;
    const int pace = index / LEVELS, level = index % LEVELS;
    flight_path path = { .speed = NAN };
    wisp_status status = flight_fly( &scene->bodies[level], flight_setting( flight_paces[pace], 1 ), workers, out,
                                     is_observed ? &path : NULL, error );
    if ( status == WISP_OK && is_observed && out->halted_at == 0 )
    {
        flight_judge( &path, &scene->reference[pace], out );
    }
    return status;
}

static void add_settings( accuracy_scene* out )
{
    const mesh_scene* scene = out->context;
    for ( int pace = 0; pace < FLIGHT_PACES; ++pace )
    {
        for ( int level = 0; level < LEVELS; ++level )
        {
            char series[48];
            snprintf( series, sizeof( series ), "%d x 1", flight_paces[pace] );
            accuracy_setting* setting = accuracy_put_setting(
                out, "%d vertices, %d x 1", scene->bodies[level].mesh.vertex_count, flight_paces[pace] );
            // the edge of an icosahedron of radius 1 is 1.05, and every level halves it
            accuracy_join_series( setting, series, "edge, m",
                                  1.05 * (double)BALLOON_RADIUS / ( 1 << ( level + FIRST_LEVEL ) ), NAN );
        }
    }
}

// The start of the reference's mesh is one of its facts; nothing flies on it here.
static wisp_status read_reference( mesh_scene* scene, accuracy_scene* out, wisp_error* error )
{
    flight_body finest = { .fabric = NULL };
    accuracy_reference reference = { .numbers = NULL };
    wisp_status status = flight_make_body( FLIGHT_MESHES_LEVEL, &finest, error );
    if ( status == WISP_OK )
    {
        const accuracy_reference requested = flight_meshes_reference( &finest );
        status = accuracy_reference_read( accuracy_reference_folder(), &requested, &reference, error );
    }
    if ( status == WISP_OK )
    {
        accuracy_describe_reference( &reference, 1e3, out );
        for ( int pace = 0; pace < FLIGHT_PACES; ++pace )
        {
            scene->reference[pace] = flight_take_path( reference.numbers + pace * FLIGHT_NUMBERS );
        }
    }
    accuracy_reference_free( &reference );
    flight_free_body( &finest );
    return status;
}

static void destroy( void* context )
{
    mesh_scene* scene = context;
    for ( int level = 0; level < LEVELS; ++level )
    {
        flight_free_body( &scene->bodies[level] );
    }
    free( scene );
}

wisp_status accuracy_balloon_meshes( const bench_options* options, double seconds, accuracy_scene* out,
                                     wisp_error* error )
{
    (void)options;
    (void)seconds; // its meshes are its subject
    *out = ( accuracy_scene ){
        .error_name = "distance of the centre's path",
        .error_unit = "mm",
        .measure_names = FLIGHT_MEASURES,
        .measure_count = FLIGHT_MEASURE_COUNT,
        .has_no_rivals = true,
        .settings = calloc( FLIGHT_PACES * LEVELS, sizeof( accuracy_setting ) ),
        .context = calloc( 1, sizeof( mesh_scene ) ),
        .run = run,
        .destroy = destroy,
    };
    wisp_status status = WISP_OK;
    if ( !out->settings || !out->context )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the settings of balloon_meshes" );
    }
    mesh_scene* scene = out->context;
    for ( int level = 0; level < LEVELS && status == WISP_OK; ++level )
    {
        flight_body* body = &scene->bodies[level];
        status = flight_make_body( FIRST_LEVEL + level, body, error );
        status = status == WISP_OK ? flight_fill_body( body, FLIGHT_MESHES_FILL, error ) : status;
    }
    status = status == WISP_OK ? read_reference( scene, out, error ) : status;
    if ( status != WISP_OK )
    {
        if ( scene )
        {
            destroy( scene );
        }
        free( out->settings );
        *out = ( accuracy_scene ){ .setting_count = 0 };
        return status;
    }
    add_settings( out );
    return WISP_OK;
}
