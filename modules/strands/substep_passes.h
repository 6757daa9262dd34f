// The passes of a substep, and the arguments of their kernels.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_extrapolate, strands_damp, strands_damp_anchored, strands_drag, strands_predict, strands_bend;
wisp_pass_fn strands_bend_curved;
wisp_pass_fn strands_bend_link, strands_link_rows, strands_stretch, strands_read_velocity;

/// Size of a worker's memory of where rows between passes are.
size_t strands_lent_rows_size( void );

/// Fill the arguments of kernels with the columns of a span's entity, without those between the passes of a substep.
wisp_strand_motion_args strands_motion_args( wisp_frame* frame, const wisp_span* span, const strands_state* state );
wisp_strand_link_args strands_bend_link_args( wisp_frame* frame, const wisp_span* span, const strands_state* state );
wisp_strand_stretch_args strands_stretch_args( wisp_frame* frame, const wisp_span* span, const strands_state* state );

/// The same, without scratch memory.
wisp_strand_rod_args strands_rod_args( wisp_frame* frame, const wisp_span* span, const strands_state* state,
                                       bool has_frames );

/// Let a substep of curled rods start with the tension of the rest shape.
void strands_begin_with_rest_tension( wisp_frame* frame, const wisp_span* span, const strands_state* state );

/// Return scratch memory of a worker: so many floats per row of the longest group, which is the first.
/// @return null without memory; the step fails with a message
float* strands_scratch( wisp_frame* frame, const wisp_span* span, int floats );

/// Count strands with history that made a substep by Euler.
void strands_count_first_order( wisp_frame* frame, int strands );

/// Count strands that were reset to their rest lengths.
void strands_count_reset( wisp_frame* frame, int laid );
