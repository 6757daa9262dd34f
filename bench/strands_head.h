/// A head of hair that is shaken: all of its strands simulated, or a few of them as guides and the others as ghosts.
#pragma once

#include "strands_scene.h"

#include "guide_hair/guide_hair.h"

/// Hanging strands, `side` x `side` roots on the side of a head, each with a length and a wave of its own. Blocks of
/// roots are neighbours.
wisp_status hair_head_make_hair( int side, int vertices, strands_shape* out, wisp_error* error );
/// The means of blocks of 1, 2 x 2 or 4 x 4 strands: guides in the middle of their ghosts.
/// @param ratio ghosts a guide: 1, 4 or 16; the side must be a multiple of the block's
wisp_status hair_head_make_guides( const strands_shape* hair, int ratio, strands_shape* out, wisp_error* error );

typedef struct hair_head_generator
{
    const strands_shape* moving; ///< simulated: all of the hair, or the guides
    const strands_shape* ghosts; ///< null: there are none
    wisp_ghosts_def follow;      ///< targets are filled in
    wisp_strand_dynamics_def dynamics;
    bool shows_moving; ///< the simulated strands can be compared with their ghosts
    int substeps, workers;
} hair_head_generator;

/// The engine's defaults, ten substeps, one worker, no ghosts.
hair_head_generator hair_head_default_generator( const strands_shape* moving );

typedef struct hair_head
{
    wisp_world* world;
    wisp_entity moving, ghosts;
    hair_head_generator generator;
    profile_samples profile;
    int steps;
} hair_head;

wisp_status hair_head_create( const hair_head_generator* generator, hair_head* out, wisp_error* error );
void hair_head_destroy( hair_head* head );

/// Where the shaken head is at a time: from side to side and turning, beginning gently.
wisp_transform hair_head_pose( double seconds );
/// Move the head on and step. @param context the head, as a bench_variant has it
wisp_status hair_head_step( void* context, wisp_error* error );
/// Step with the head going to a pose of the caller's.
wisp_status hair_head_step_to( hair_head* head, wisp_transform pose, wisp_error* error );
wisp_status hair_head_keep_profile( void* context );
/// What is seen: the ghosts, or all strands where there are none; the user's order, valid until the next step.
wisp_status hair_head_points( hair_head* head, const wisp_vec3** points, wisp_error* error );
/// What is simulated; with `shows_moving`, or where there are no ghosts.
wisp_status hair_head_moving_points( hair_head* head, const wisp_vec3** points, wisp_error* error );
/// Velocities of what is simulated, the user's order. @param out [vertices]
void hair_head_moving_velocities( hair_head* head, wisp_vec3* out );
wisp_status hair_head_hash( hair_head* head, uint64_t* hash, wisp_error* error );
