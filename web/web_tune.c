// The search of `wisp tune`, on the machine that shows the page.
#include "web.h"

#include "tune_scene.h"

// clang-format off
EM_JS( int, web_tune_progress, ( int runs, int max_runs ), {
    return Module["tuneProgress"] && Module["tuneProgress"]( runs, max_runs ) === false ? 0 : 1;
} )
// clang-format on

static bool report( void* user, int run_count, int max_runs )
{
    (void)user;
    return web_tune_progress( run_count, max_runs ) != 0;
}

/// Find the cheapest settings within an error. Runs for as long as `limit` allows.
/// @param error m @param seconds s of simulated time, 0: the default @param limit s of wall time
/// @param configuration [setting count] receives the index of a value for each setting of the scene
/// @param out [5] 1 if the target is met, ms per step, error in m, runs, 1 if the search ended early
WEB_API int web_tune( const char* path, double error, double seconds, double limit, int* configuration, double* out )
{
    wisp_scene scene;
    tune_parameters settings;
    if ( !web_scene_load( path, &scene ) )
    {
        return 0;
    }
    const tune_scene_def def = { .scene = &scene,
                                 .parameters = &settings,
                                 .world = { .workers = 1 },
                                 .error = error,
                                 .seconds = seconds,
                                 .limit = limit,
                                 .progress = report };
    wisp_tune_result found = { 0 };
    tune_scene_info info;
    wisp_status status = tune_parameters_find( &scene, &settings, &web_error );
    status = status == WISP_OK ? tune_scene_search( &def, &found, &info, &web_error ) : status;
    for ( int k = 0; status == WISP_OK && k < settings.count; ++k )
    {
        configuration[k] = found.configuration[k];
    }
    out[0] = found.meets_target;
    out[1] = found.achieved.ms;
    out[2] = found.achieved.error;
    out[3] = found.run_count;
    out[4] = found.stopped_early;
    wisp_tune_release( &found );
    wisp_scene_release( &scene );
    return status == WISP_OK;
}
