// Which bodies a participant can meet in a step.
#pragma once

#include "collision_bodies.h"

/// A participant in a step: a box, and the bodies that come near it.
typedef struct collision_near
{
    wisp_vec3 lower, upper; // m, in its rows
    wisp_vec3 offset;       // m, from the coordinates of the host to those of its rows
    bool is_there;          // else it asks all bodies
    int first, count;       // of collision_state.listed
    int around;             // of them, behind the others: they reach nothing in the box
    float nearest_around;   // m, the least distance of those from the box in the step
    float beyond;           // m, no other body gets nearer to the box in the step
    float free;             // m, within which a particle in the box may move without being found by one of them
} collision_near;

/// Find the bodies that each participant can meet in this step, in a world with many. Without memory all count.
void collision_list_near( void* memory, wisp_frame* frame, const wisp_allocator* allocator );
void collision_release_near( collision_state* state, const wisp_allocator* allocator );
size_t collision_near_bytes( const collision_state* state );

/// A walk over the bodies that points within a box can meet, in their order.
typedef struct collision_walk
{
    const collision_near* near; // null: all bodies
    int next;                   // body of the list of the world, or place in the list of the participant
    float lower[3], upper[3];   // m, of the host
    float free;                 // m, as of collision_near, also for bodies that were passed as too far
    float passed;               // m, the least distance of those bodies
    int last;                   // body at that distance that was gone back to
} collision_walk;

/// @param lower, upper m, in rows of the entity: where points are in the substep, at its start too
collision_walk collision_begin_walk( const collision_state* state, wisp_entity entity, wisp_vec3 lower,
                                     wisp_vec3 upper );
/// Go on to the next body that may be as near to the box as a reach and twice the thickness.
bool collision_walk_on( wisp_frame* frame, const wisp_span* span, const collision_state* state, collision_walk* walk,
                        float reach, collision_view* view );
/// Go back to the nearest body that was passed, and on to farther ones, as far as a limit.
bool collision_walk_back( wisp_frame* frame, const wisp_span* span, const collision_state* state,
                          collision_walk* walk, float limit, collision_view* view );
/// Whether no other body follows.
static inline bool collision_walk_ends( const collision_state* state, const collision_walk* walk )
{
    return walk->next >= ( walk->near != NULL ? walk->near->count - walk->near->around : state->body_count );
}
