#include "accuracy_surface.h"

wisp_status accuracy_end_surface( surface_implementation* implementation, accuracy_run* out, wisp_error* error )
{
    out->halted_at = implementation->halted_at;
    return surface_implementation_hash( implementation, &out->hash, error );
}

wisp_status accuracy_step_surface( surface_implementation* implementation, int steps, accuracy_run* out,
                                   wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int s = 0; s < steps && implementation->halted_at == 0 && status == WISP_OK; ++s )
    {
        status = accuracy_time_step( surface_implementation_step, implementation, out, error );
    }
    return status;
}

wisp_status accuracy_read_motion_stats( surface_implementation* implementation, wisp_motion_stats* out,
                                        wisp_error* error )
{
    wisp_status status = wisp_read_motion_stats( implementation->world, implementation->entity, out );
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}

wisp_status accuracy_request_motion_stats( surface_implementation* implementation, bool is_observed,
                                           wisp_error* error )
{
    wisp_status status =
        is_observed ? wisp_request( implementation->world, implementation->entity, WISP_MOTION_STATS ) : WISP_OK;
    return status == WISP_OK ? WISP_OK : bench_world_fail( implementation->world, status, error );
}
