// Moving frames and largest speeds of strands.
#pragma once

#include "strands_state.h"

/// Pass strands.frame: the poses of this step.
wisp_pass_fn strands_move_frame;
/// Pass strands.carry: what strands do not feel of their frame moves their start, and turns velocities and frames.
wisp_pass_fn strands_carry;
/// Pass strands.carry_pins: pinned vertices get velocities without what carries, as the others have them.
wisp_pass_fn strands_carry_pins;
/// Pass strands.max_speed: the largest speed.
wisp_pass_fn strands_limit_speed;

/// Find the velocity field of what carries strands in a substep, at a place. @return false if nothing does
/// @param linear receives m/s @param angular receives rad/s
bool strands_find_carry_velocity( wisp_frame* frame, const wisp_span* span, wisp_vec3 place, wisp_vec3* linear,
                                  wisp_vec3* angular );
