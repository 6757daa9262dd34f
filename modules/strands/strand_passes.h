// Passes and hooks of strands that files beside the substep define.
#pragma once

#include "strand_rows.h"
#include "strands_state.h"

#include "wisp/module/sleep.h"

// fused_substeps.c: all substeps in one pass
wisp_fused_fn strands_substeps;

// rest_curvature.c: rest curvature and twist of curled rods
/// Pass strands.rest, due when the length of a substep changes: the stiffness that a substep can solve depends on it.
bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user );

// strands_definition.c: the check of the state at the end of a step
wisp_pass_fn strands_guard;

// strands_calls.c: strands on the way to a level of detail at which they are not solved
wisp_pass_fn strands_slow;

/// Whether the strands come to rest in this step.
bool strands_slow_is_due( wisp_frame* frame, wisp_entity strands, void* user );

// strand_grid.c: interaction on a grid
wisp_pass_fn strands_mix;

size_t strands_grid_workspace_size( void );
void strands_grid_workspace_release( void* workspace, const wisp_allocator* allocator );
size_t strands_grid_workspace_bytes( const void* workspace );

// strands_calls.c: what sleep has to know
/// As wisp_sleep_hooks.surroundings: the surface that strands are rooted in has to sleep.
bool strands_surroundings( const void* state, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                           uint64_t* hash );
/// As wisp_sleep_hooks.rested: strands forget how they moved.
void strands_rested( const void* state, wisp_world* world, wisp_entity entity );

// strands_stats.c: statistics
wisp_pass_fn strands_compute_motion_stats, strands_scatter_strain, strands_scatter_speed;

// ---- frames that move ----

// Moving frames and largest speeds of strands.

/// Pass strands.frame: the poses of this step.
wisp_pass_fn strands_move_frame;
/// Pass strands.carry: what strands do not feel of their frame moves their start, and turns velocities and frames.
wisp_pass_fn strands_add_frame_motion;
/// Pass strands.carry_pins: pinned vertices get velocities without what carries, as the others have them.
wisp_pass_fn strands_subtract_frame_motion;
/// Pass strands.max_speed: the largest speed.
wisp_pass_fn strands_limit_speed;

/// Find the velocity field of what carries strands in a substep, at a place. @return false if nothing does
/// @param linear receives m/s @param angular receives rad/s
bool strands_find_frame_velocity( wisp_frame* frame, const wisp_span* span, wisp_vec3 place, wisp_vec3* linear,
                                  wisp_vec3* angular );

// ---- tips that are held ----

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

// ---- masses, lengths and links ----

/// Compute masses and lengths from a definition. @return the number of pinned vertices behind roots
int strands_cook_masses( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* def );

/// Compute rest lengths of links over one and over two segments, where the entity has them.
void strands_cook_links( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Return the lane of a vertex, in the user's order: 16 times its group, and the lane in it.
int strands_lane_of( const wisp_strand_topology* topology, int vertex );

/// Return whether the last vertex of a strand lies on its first, at rest.
bool strands_is_loop( const float* rest, int row, int count, int lane );

/// Return the length of the longest strand at rest, m.
float strands_longest( const strands_rows* rows );

// ---- definition of strands ----

/// Find the state of the module for an entity. @return WISP_CONFLICT the module is not registered, or the entity has no
/// strands with dynamics; WISP_STALE_ID it does not exist
wisp_status strands_find( wisp_world* world, wisp_entity strands, strands_state** state );

/// Lay the frames of rods along the present shape, with their natural twist.
void strands_make_frames( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Mark rest curvature as outdated; the next step computes it.
void strands_reset_rest( wisp_world* world, wisp_entity strands, const strands_state* state );

// ---- head roots ----

// Roots on a head.

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

// ---- surface roots ----

// Roots on a surface.

wisp_pass_fn strands_anchor, strands_anchor_frames;

/// Handle removed entities: roots of a removed surface stay in place.
void strands_entity_removed( void* state, wisp_world* world, wisp_entity entity );
/// Handle teleports: strands go along with their head, or with the surface that they are rooted in.
wisp_status strands_teleported( void* state, wisp_world* world, wisp_entity entity,
                                const wisp_teleport_motion* teleport, bool* is_moved );

// ---- substep passes ----

// The passes of a substep, and the arguments of their kernels.

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

// ---- stiffness and factors of rods ----

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

// ---- frames of rods ----

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

// ---- closed rods: stiffness and factors of a ring, and its shape at rest ----

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
