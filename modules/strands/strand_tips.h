// Tips that are held.
#pragma once

#include "strands_state.h"

/// Pass strands.tip_targets: the poses of this step.
wisp_pass_fn strands_move_tips;
/// Pass strands.tips: positions of tips; before the prediction, as pinned vertices.
wisp_pass_fn strands_hold_tips;
/// Pass strands.tip_frames: frames and directions of tips.
wisp_pass_fn strands_turn_tips;

/// Return whether the direction of any tip is held.
bool strands_guides_tips( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Compute frames at rest, lengths and inverse masses of tips from a new definition, if any are held.
void strands_cook_tips( wisp_world* world, wisp_entity strands, const strands_state* state );
