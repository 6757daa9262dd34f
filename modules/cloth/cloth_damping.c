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

static float lost_by( wisp_frame* frame, wisp_entity entity, const cloth_state* state )
{
    const float rate = *(float*)wisp_frame_column( frame, entity, state->damping, 0 );
    return rate * wisp_frame_dt( frame, entity );
}

void cloth_damp( wisp_frame* frame, const wisp_span* span, void* user )
{
    const cloth_state* state = user;
    const wisp_fabric* fabric = wisp_frame_fabric( frame, span->entity );
    const float lost = lost_by( frame, span->entity, state );
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

bool cloth_damps_evenly( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)user;
    return wisp_frame_has( frame, entity, WISP_MAP_INTERNAL_DAMPING ) == false;
}

void cloth_damp_crowd( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user )
{
    (void)span;
    wisp_rigid_args args[WISP_INSTANCE_LANES] = { { 0 } };
    for ( int lane = 0; lane < WISP_INSTANCE_LANES; ++lane )
    {
        const float lost = lost_by( frame, crowd->entities[lane], user );
        args[lane].fraction = lost / ( 1.0f + lost );
    }
    wisp_approach_rigid_motions( wisp_frame_kernels( frame ), crowd, args );
}
