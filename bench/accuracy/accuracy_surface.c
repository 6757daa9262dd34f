#include "accuracy_surface.h"

wisp_status accuracy_time_surface( surface_entrant* entrant, double scale, accuracy_run* out, wisp_error* error )
{
    const wisp_status status = accuracy_time_step( surface_entrant_step, entrant, out, error );
    if ( status == WISP_OK )
    {
        out->ms[out->ms_count - 1] *= scale;
    }
    return status;
}

wisp_status accuracy_end_surface( surface_entrant* entrant, accuracy_run* out, wisp_error* error )
{
    out->halted_at = entrant->halted_at;
    return surface_entrant_hash( entrant, &out->hash, error );
}

wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && entrant->halted_at == 0 && status == WISP_OK; ++s )
    {
        status = accuracy_time_surface( entrant, 1.0, out, error );
    }
    return status;
}

wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error )
{
    wisp_status status = wisp_world_quality( entrant->world, entrant->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( entrant->world, status, error );
}

wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error )
{
    wisp_status status = is_looked_at ? wisp_want( entrant->world, entrant->entity, WISP_QUALITY ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : bench_world_fail( entrant->world, status, error );
}
