// Fixed steps from any frame time.
#include "world_blend.h"

#include <math.h>

enum
{
    MAX_STEPS = 8, // of one call; a host that needs more would fall ever further behind
};

// Compiling before the last step keeps the layout of the kept points.
static wisp_status make_step( wisp_world* world, float dt, bool is_last, wisp_before_step_fn* before_step,
                              void* user )
{
    if ( before_step != NULL )
    {
        before_step( user, world );
    }
    if ( is_last && wisp_world_plan_passes( world ) < 0 )
    {
        return world->error.status;
    }
    if ( is_last && world_keep_points( world ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "advance: out of memory for the points of a step" );
    }
    return wisp_world_step( world, dt );
}

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
    const double pending = world->clock.pending + (double)seconds, due = floor( pending / (double)dt + ROUNDING );
    const int steps = due < MAX_STEPS ? (int)due : MAX_STEPS;
    for ( int i = 0; i < steps; ++i )
    {
        const wisp_status status = make_step( world, dt, i + 1 == steps, before_step, user );
        if ( status != WISP_OK )
        {
            world->clock.pending = pending - i * (double)dt; // due in the next call
            return status;
        }
    }
    world->clock.pending = fmax( pending - due * (double)dt, 0.0 );
    world_count_cut( world, (double)seconds, ( due - steps ) * (double)dt );
    world_blend_points( world, (float)( world->clock.pending / (double)dt ) );
    return WISP_OK;
}
