#include "passes.h"

wisp_status passes_declare( wisp_registry* registry )
{
    // Order of passes in the same stage: prediction, coarse sheets, tethers, near constraints. The state check runs
    // before any derived quantity.
    typedef wisp_status declare_fn( wisp_registry * registry );
    static declare_fn* const ALL[] = { passes_declare_particles,   passes_declare_carry,       passes_declare_levels,
                                       passes_declare_max_speed,   passes_declare_tethers,     passes_declare_uncarry,
                                       passes_declare_constraints, passes_declare_state_check, passes_declare_surface,
                                       passes_declare_instances };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( ALL ) && status == WISP_OK; ++i )
    {
        status = ALL[i]( registry );
    }
    return status;
}
