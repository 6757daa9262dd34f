// Roots on a head.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_move_head, strands_jump, strands_jump_frames, strands_root, strands_hold_pins,
    strands_find_reach;

/// Return the pose of the head after some substeps of this step.
wisp_transform strands_head_pose( wisp_frame* frame, wisp_entity strands, const strands_head* head, int substeps );

/// Check that a pose is within bounds and has a rotation. @param what it is the pose of, for the message
wisp_status strands_check_pose( wisp_world* world, const char* what, wisp_transform pose );

/// Move a strand as a rigid body, with its velocities: from one position of the root to another. Its history ends. Where strands
/// are not solved, velocities become those of the motion.
void strands_turn( wisp_frame* frame, wisp_entity entity, const strands_state* state, int group, int lane,
                   wisp_vec3 from, wisp_vec3 to, wisp_quat turn );

/// Turn the frames of a strand.
void strands_turn_frames( wisp_frame* frame, wisp_entity entity, wisp_component curve, int group, int lane,
                          wisp_quat turn );
