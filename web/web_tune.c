// The search of `wisp tune`, on the machine that shows the page.
#include "web.h"

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
/// @param error m @param length s of simulated time, 0: the default @param limit s of wall time
/// @param configuration [setting count] receives the index of a value for each setting of the scene
/// @param out [5] 1 if the target is met, ms per step, error in m, runs, 1 if the search ended early
WEB_API int web_tune( const char* path, double error, double length, double limit, int* configuration, double* out )
{
    const binding_tune_def def = { .error = error, .limit = limit, .workers = 1, .progress = report };
    binding_scene* scene = NULL;
    binding_reference* reference = NULL;
    binding_reference_info info;
    tune_result found = { 0 };
    wisp_status status = binding_scene_read( path, &scene, &web_error );
    status = status == WISP_OK ? binding_reference_open( scene, length, NULL, NULL, &reference, &info, &web_error )
                               : status;
    status = status == WISP_OK ? binding_tune( reference, &def, &found, &web_error ) : status;
    for ( int k = 0; status == WISP_OK && k < binding_parameter_count( scene ); ++k )
    {
        configuration[k] = found.configuration[k];
    }
    out[0] = found.meets_target;
    out[1] = found.achieved.ms;
    out[2] = found.achieved.error;
    out[3] = found.run_count;
    out[4] = found.stopped_early;
    tune_release( &found );
    binding_reference_close( reference );
    binding_scene_close( scene );
    return status == WISP_OK;
}
