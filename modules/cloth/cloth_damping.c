// Damping that does not touch rigid motion (Mueller et al. 2007, section 3.5): it reduces the
// difference between a velocity and the rigid motion with the same momentum and angular momentum.
#include "cloth_internal.h"

// What each velocity loses in this substep. @return null without memory
static const float* list_fractions( wisp_frame* frame, const wisp_span* span, float lost, const float* factor )
{
    const int count = wisp_frame_fabric( frame, span->entity )->slot_count;
    float* fractions =
        wisp_parallel_scratch( wisp_frame_parallel( frame, span ), span->worker, (size_t)count * sizeof( float ) );
    if ( fractions == NULL )
    {
        wisp_frame_fail( frame, WISP_NO_MEMORY, "out of memory for the damping of %d particles", count );
        return NULL;
    }
    for ( int slot = 0; slot < count; ++slot )
    {
        const float own = lost * factor[slot];
        fractions[slot] = own / ( 1.0f + own );
    }
    return fractions;
}

void cloth_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float rate = *(float*)wisp_frame_column( frame, span->entity, state->damping, 0 );
    const float lost = rate * wisp_frame_dt( frame, span->entity );
    wisp_rigid_args args = {
        .position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 ),
        .fraction = lost / ( 1.0f + lost ),
    };
    const float* factor = wisp_frame_column( frame, span->entity, WISP_MAP_INTERNAL_DAMPING, 0 );
    if ( factor != NULL )
    {
        args.fractions = list_fractions( frame, span, lost, factor );
        if ( args.fractions == NULL )
        {
            return;
        }
    }
    wisp_approach_rigid_motion( wisp_frame_kernels( frame ), wisp_frame_parallel( frame, span ), fabric, &args );
}
