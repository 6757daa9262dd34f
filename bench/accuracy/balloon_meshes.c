// The flight of `balloon_flight` on finer meshes, against that on the finest at the same substeps. No order is promised: a finer
// mesh is stiffer than the same substeps can follow, so that two errors fall against each other.
#include "balloon_flight_run.h"

#include <math.h>
#include <stdlib.h>

enum
{
    LEVELS = 4,
    FIRST_LEVEL = 1, // 42, 162, 642, 2562 vertices; the finest is the truth
    TRUTH = LEVELS - 1,
    PACES = 2,
    FILL_SUBSTEPS = 10,
};

static const int paces[PACES] = { 10, 40 }; // substeps

typedef struct mesh_scene
{
    flight_body bodies[LEVELS];
    flight_path truth[PACES];
} mesh_scene;

static wisp_status run( void* context, int index, int workers, bool is_looked_at, accuracy_run* out,
                        wisp_error* error )
{
    const mesh_scene* scene = context;
    const int pace = index / TRUTH, level = index % TRUTH;
    flight_path path = { .speed = NAN };
    wisp_status status = flight_fly( &scene->bodies[level], flight_setting( paces[pace], 1 ), workers, out,
                                     is_looked_at ? &path : NULL, error );
    if ( status == WISP_OK && is_looked_at && out->halted_at == 0 )
    {
        flight_judge( &path, &scene->truth[pace], out );
    }
    return status;
}

static void add_settings( accuracy_scene* out )
{
    const mesh_scene* scene = out->context;
    for ( int pace = 0; pace < PACES; ++pace )
    {
        for ( int level = 0; level < TRUTH; ++level )
        {
            char series[48];
            snprintf( series, sizeof( series ), "%d x 1", paces[pace] );
            accuracy_setting* setting = accuracy_put_setting( out, "%d vertices, %d x 1",
                                                              scene->bodies[level].mesh.vertex_count, paces[pace] );
            // the edge of an icosahedron of radius 1 is 1.05, and every level halves it
            accuracy_join_series( setting, series, "edge, m",
                                  1.05 * (double)BALLOON_RADIUS / ( 1 << ( level + FIRST_LEVEL ) ), NAN );
        }
    }
}

static wisp_status fly_truth( mesh_scene* scene, int pace, wisp_error* error )
{
    accuracy_run unused = { .error = NAN };
    wisp_status status =
        flight_fly( &scene->bodies[TRUTH], flight_setting( paces[pace], 1 ), 1, &unused, &scene->truth[pace], error );
    if ( status == WISP_OK && unused.halted_at != 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "the finest mesh of balloon_meshes was halted at step %d",
                            unused.halted_at );
    }
    free( unused.ms );
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
    (void)seconds; // its meshes are what it is about
    *out = ( accuracy_scene ){
        .truth = "the finest mesh, 2562 vertices, at the same substeps",
        .error_name = "distance of the centre's path",
        .error_unit = "mm",
        .measure_names = FLIGHT_MEASURES,
        .measure_count = FLIGHT_MEASURE_COUNT,
        .has_no_rivals = true,
        .settings = calloc( PACES * TRUTH, sizeof( accuracy_setting ) ),
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
        status = flight_make_body( FIRST_LEVEL + level, FILL_SUBSTEPS, &scene->bodies[level], error );
    }
    for ( int pace = 0; pace < PACES && status == WISP_OK; ++pace )
    {
        status = fly_truth( scene, pace, error );
    }
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
