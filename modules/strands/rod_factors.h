// Stiffness and factors of rods.
#pragma once

#include "strand_rows.h"
#include "strands_state.h"

/// Compute clamps, inverse lengths and bounds of the tension.
void strands_cook_rods( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Have the factors of rods computed again, because the tip of the strand in a lane is held in another way.
void strands_refactor( wisp_world* world, wisp_entity strands, const strands_state* state, int lane );

/// Pass strands.factor: factors of M + (dt^2 + damping dt) K, due when the length of a substep changes.
bool strands_factor_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_factor( wisp_frame* frame, const wisp_span* span, void* user );

/// Return L_i, m: the length that bends at vertex i.
double strands_bend_length( const strands_rows* rows, int row, int i, int lane );

/// Return the sharpest turn |t_k - t_{k-1}| of the rest shape at vertex i and its neighbours.
double strands_sharpest_turn( const strands_rows* rows, int row, int i, int count, int lane );

/// Return whether the bound of a curl is below that of single precision.
bool strands_is_curl( double turn );
