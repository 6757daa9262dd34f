/// Hair on a head that is shaken: guides that are simulated, and ghosts.
#pragma once

#include "strands_scene.h"

#include "guide_hair/guide_hair.h"

typedef struct hair_head_generator
{
    const strands_shape* moving; ///< simulated: all of the hair, or the guides
    const strands_shape* ghosts; ///< null: there are none
    wisp_ghosts_def follow;      ///< targets are filled in
    wisp_strand_dynamics_def dynamics;
    bool shows_moving; ///< the simulated strands can be compared with their ghosts
} hair_head_generator;

/// The engine's defaults, no ghosts.
hair_head_generator hair_head_default_generator( const strands_shape* moving );

typedef struct hair_head
{
    wisp_world* world;
    wisp_entity moving, ghosts;
    hair_head_generator generator;
    int steps;
} hair_head;

wisp_status hair_head_create( const hair_head_generator* generator, hair_head* out, wisp_error* error );
void hair_head_destroy( hair_head* head );

/// Where the shaken head is at a time: from side to side and turning, beginning gently.
wisp_transform hair_head_pose( double seconds );
/// Move the head on and step.
wisp_status hair_head_step( hair_head* head, wisp_error* error );
/// Step with the head going to a pose of the caller's.
wisp_status hair_head_step_to( hair_head* head, wisp_transform pose, wisp_error* error );
/// What is seen: the ghosts, or all strands where there are none; the user's order, valid until the next step.
wisp_status hair_head_points( hair_head* head, const wisp_vec3** points, wisp_error* error );
/// What is simulated; with `shows_moving`, or where there are no ghosts.
wisp_status hair_head_moving_points( hair_head* head, const wisp_vec3** points, wisp_error* error );
/// Velocities of what is simulated, the user's order. @param out [vertices]
void hair_head_moving_velocities( hair_head* head, wisp_vec3* out );
