// Passes and hooks of strands that files beside the substep define.
#pragma once

#include "strands_state.h"

#include "wisp/module/sleep.h"

// fused_substeps.c: all substeps in one pass
wisp_fused_fn strands_substeps;

// rest_curvature.c: rest curvature and twist of curled rods
/// Pass strands.rest, due when the length of a substep changes: the stiffness that a substep can solve depends on it.
bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user );

// state_check.c: the check of the state at the end of a step
wisp_pass_fn strands_guard;

// strand_detail.c: strands on the way to a level of detail at which they are not solved
wisp_pass_fn strands_slow;

/// Whether the strands come to rest in this step.
bool strands_slow_is_due( wisp_frame* frame, wisp_entity strands, void* user );

// strand_grid.c: interaction on a grid
wisp_pass_fn strands_mix;

size_t strands_grid_workspace_size( void );
void strands_grid_workspace_release( void* workspace, const wisp_allocator* allocator );
size_t strands_grid_workspace_bytes( const void* workspace );

// strand_sleep.c: what sleep has to know
/// As wisp_sleep_hooks.surroundings: the surface that strands are rooted in has to sleep.
bool strands_surroundings( const void* state, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                           uint64_t* hash );
/// As wisp_sleep_hooks.rested: strands forget how they moved.
void strands_rested( const void* state, wisp_world* world, wisp_entity entity );

// strands_stats.c: statistics
wisp_pass_fn strands_compute_motion_stats, strands_scatter_strain, strands_scatter_speed;
