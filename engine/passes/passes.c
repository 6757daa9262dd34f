#include "passes.h"

wisp_status passes_declare( wisp_registry* registry )
{
    // The order of equals: particles are predicted, far constraints pull, then near ones; the guard looks at the result
    // before anybody derives something from it.
    typedef wisp_status declare_fn( wisp_registry * registry );
    static declare_fn* const ALL[] = { passes_declare_particles, passes_declare_far, passes_declare_constraints,
                                       passes_declare_state_check, passes_declare_surface };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( ALL ) && status == WISP_OK; ++i )
    {
        status = ALL[i]( registry );
    }
    return status;
}
