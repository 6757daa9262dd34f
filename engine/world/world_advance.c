// Fixed steps from any frame time.
#include "world_blend.h"

#include <math.h>

enum
{
    MAX_STEPS = 8, // of one call; a host that needs more would fall ever further behind
};

wisp_status wisp_world_advance( wisp_world* world, float seconds, float dt, wisp_before_step_fn* before_step,
                                void* user )
{
    WISP_TRY( wisp_world_begin( world ) );
    if ( !( seconds >= 0.0f && seconds < 1e6f ) || !( dt > 0.0f && dt < 1e6f ) )
    {
        return wisp_world_fail(
            world, WISP_BAD_INPUT,
            "advance: got %g s in steps of %g s, expected a time of at least 0 and a step above 0", (double)seconds,
            (double)dt );
    }
    const double ROUNDING = 1e-6; // of a step
    double pending = world->clock.pending + (double)seconds;
    const double due = floor( pending / (double)dt + ROUNDING );
    const int steps = due < MAX_STEPS ? (int)due : MAX_STEPS;
    world_count_cut( world, (double)seconds, ( due - steps ) * (double)dt );
    pending = fmax( pending - due * (double)dt, 0.0 );
    world->clock.pending = pending;
    for ( int i = 0; i < steps; ++i )
    {
        if ( before_step != NULL )
        {
            before_step( user, world );
        }
        // Compiling first keeps the layout of the kept points.
        const bool is_last = i + 1 == steps;
        if ( is_last && wisp_world_plan_passes( world ) < 0 )
        {
            return world->error.status;
        }
        if ( is_last && world_keep_points( world ) == false )
        {
            return wisp_world_fail( world, WISP_NO_MEMORY, "advance: out of memory for the points of a step" );
        }
        const wisp_status status = wisp_world_step( world, dt );
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    world_blend_points( world, (float)( pending / (double)dt ) );
    return WISP_OK;
}
