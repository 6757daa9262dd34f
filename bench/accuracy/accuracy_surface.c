#include "accuracy_surface.h"

wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && entrant->halted_at == 0 && status == WISP_OK; ++s )
    {
        status = cloth_settings_step( entrant, 1.0, out, error );
    }
    return status;
}

wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error )
{
    wisp_status status = wisp_world_quality( entrant->world, entrant->entity, out );
    return status == WISP_OK ? WISP_OK : surface_entrant_fail( entrant, status, error );
}

wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error )
{
    wisp_status status = is_looked_at ? wisp_want( entrant->world, entrant->entity, WISP_QUALITY ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : surface_entrant_fail( entrant, status, error );
}
