#include "contact_fold.h"

#include <stdlib.h>

wisp_status contact_comparison_fold( const contact_plan* plan, contact_comparison comparison, contact_write_fn* write,
                                     results* out, wisp_error* error )
{
    contact_scene scene;
    contact_run* runs = calloc( (size_t)comparison.way_count, sizeof( *runs ) );
    wisp_status status = runs != NULL
                             ? contact_make_cloth( plan->fold_side, &scene, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for %d ways", comparison.way_count );
    if ( status == WISP_OK )
    {
        comparison.scene = &scene;
        comparison.enter = contact_enter_fold;
        comparison.steps = plan->fold_steps;
        comparison.teams = &plan->teams;
        comparison.options = plan->options;
        status = contact_comparison_run( &comparison, runs, error );
        if ( status == WISP_OK )
        {
            write( &comparison, runs, out );
        }
        contact_scene_free( &scene );
    }
    free( runs );
    return status;
}
