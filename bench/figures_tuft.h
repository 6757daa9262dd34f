/// A tuft for the figures of Park and Kim 2024: one target, ghosts around it, seen with and without their weights.
#pragma once

#include "figures_hair.h"
#include "strands_scene.h"

#define TUFT_NODES 10
#define TUFT_STEPS 60
/// Half a rounding of a float at 0.4 m is 1.5e-8 m; sums of a few such numbers stay below this.
#define TUFT_ROUNDING 3e-7

extern const wisp_vec3 tuft_target_colour, tuft_ghost_colour, tuft_line_colour;

/// Ghosts of one target, once as they are and once without any weight: what differs is the sway.
typedef struct tuft
{
    strands_shape target, ghosts;
    hair_head swaying, plain;
} tuft;

/// What is seen after a step. Velocities are of the target, now and a step before.
typedef struct seen
{
    const wisp_vec3 *target, *swaying, *base;
    wisp_vec3 now[TUFT_NODES], before[TUFT_NODES];
} seen;

/// Ghosts at rising distances from the target, each in a direction of its own, farther apart towards the tip.
wisp_status tuft_make( int ghost_count, int ghost_nodes, tuft* t, wisp_error* error );
void tuft_free( tuft* t );
/// Ghosts that only follow.
wisp_ghosts_def tuft_without_weights( void );
wisp_status tuft_enter( tuft* t, const wisp_ghosts_def* follow, wisp_error* error );
wisp_status tuft_advance( tuft* t, seen* s, wisp_error* error );

/// Lines of a shot, besides the target and its ghosts. Zero-initialised: difference lines at their own length, without a bar.
typedef struct tuft_lines
{
    bool
        to_centre; ///< from every ghost to the mean of its group; otherwise from where a ghost would be without weights
                   ///< towards where it is
    float magnified; ///< times that difference lines are drawn; 0 is once
    float bar;       ///< m: a line under the tuft is as long as a difference of this is drawn; 0: none
} tuft_lines;

/// Keep the target, its ghosts and lines, as seen from the root of the target. Lines shorter than their radius are left out: the
/// renderer's round cones have no direction there, and show strokes of a centimetre.
wisp_status tuft_take( const figures_case* page, figures_hair_album* album, const tuft* t, const seen* s,
                       const tuft_lines* lines, wisp_error* error );
/// Mean of the ghosts of the one target at a node. @param points [ghost_count][TUFT_NODES] m
wisp_vec3 tuft_mean( const wisp_vec3* points, int ghost_count, int node );

wisp_vec3 tuft_minus( wisp_vec3 a, wisp_vec3 b );
double tuft_dot( wisp_vec3 a, wisp_vec3 b );
double tuft_length( wisp_vec3 a );
