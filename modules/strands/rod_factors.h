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

// ---- rod frames ----

// Frames of rods.

/// Turn a frame by the smallest rotation that takes its z axis along e. Without a length it stays.
wisp_quat strands_transport_frame( wisp_quat q, wisp_vec3 e );

/// Turn a frame about its z axis. @param angle rad
wisp_quat strands_twist_frame( wisp_quat q, double angle );

/// Return the natural twist at vertex i of a strand of `count` vertices, rad. @param twist rad/m
double strands_natural_twist( const float* length, int row, int i, int count, int lane, double twist );

/// Add lines for the axes of frames: those of segments, or of clamps where segments have none. As wisp_state_hooks.lines.
void strands_add_frames( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                         wisp_line_list* list );

/// Lay the frames of a group from the clamps outward, with their natural twist.
/// @param length [row][16] m @param twist rad/m
void strands_make_frames_of_group( const wisp_strand_topology* topology, const float* position, const float* clamp,
                                   const float* root, const float* length, float twist, float* frame, int group );

// ---- closed rods ----

// Rods that are closed: stiffness and factors of a ring, and its shape at rest.

/// Bound of dt^2 EI / (m l^3), and of the same times the fourth power of the turn at a vertex of a curled rod.
static const double STRANDS_MAX_STIFFNESS = 6e4, STRANDS_MAX_CURLED = 0.08;

/// What the factors of a closed rod are made from.
typedef struct closed_factor_args
{
    const strands_rows* rows;
    const strands_settings* settings;
    float *stiffness, *factor, *response; // columns
    double dt;                            // s, of a substep
    double* work;                         // [2 * vertices]
} closed_factor_args;
