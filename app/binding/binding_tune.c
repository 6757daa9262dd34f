// The search of `wisp tune`.
#include "binding_internal.h"

#include "tune_scene.h"

wisp_status binding_tune( const binding_scene* scene, const binding_tune_def* def, wisp_tune_result* out,
                          wisp_error* error )
{
    *out = ( wisp_tune_result ){ 0 };
    wisp_scene changing;
    wisp_status status = binding_scene_again( scene, &changing, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    tune_parameters parameters;
    const tune_scene_def search = {
        .scene = &changing,
        .parameters = &parameters,
        .world = { .workers = def->workers, .isa = def->isa, .log = def->log, .log_user = def->user },
        .error = def->error,
        .budget_ms = def->budget_ms,
        .seconds = def->seconds,
        .limit = def->limit,
        .progress = def->progress,
        .progress_user = def->user,
        .go_on = def->go_on,
        .go_on_user = def->user,
    };
    tune_scene_info info;
    status = tune_parameters_find( &changing, &parameters, error );
    status = status == WISP_OK ? tune_scene_search( &search, out, &info, error ) : status;
    wisp_scene_release( &changing );
    return status;
}
