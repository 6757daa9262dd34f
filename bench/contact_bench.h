/// The case `contact`: what finding pairs costs, what accuracy costs, and how balloons press on each other
/// (extensions, not in the papers).
#pragma once

#include "bench_options.h"
#include "contact_comparison.h"

#define CONTACT_SIZES_MAX 4

/// Sizes and steps. contact_default_plan() has those of the case; tests have smaller ones.
typedef struct contact_plan
{
    int sheet_sides[CONTACT_SIZES_MAX], sphere_levels[CONTACT_SIZES_MAX], size_count; ///< of what is searched, rising
    double max_brute;     ///< boxes compared by brute force at the most; beyond it, only a sample asks
    double query_seconds; ///< about how long times of queries are taken
    /// That one way may take; it ends earlier where it would take longer.
    double fold_seconds, motion_seconds, balloon_seconds;
    int fold_side, fold_steps;                      ///< of the cloth
    int balloon_level, balloon_steps;               ///< of pair and stack
    int picture_side, picture_level, picture_steps; ///< of what pictures show
    int picture_pixels;
    contact_teams teams;
    const bench_options* options; ///< for progress and pictures
} contact_plan;

/// Below 600 seconds the cloth has 24 vertices a side and not 64, and balloons are a level coarser; below 40 seconds
/// it has 16 and balloons are another level coarser, runs are shorter, of what is searched the largest size is left
/// out, the next one is smaller, and brute force stops earlier.
contact_plan contact_default_plan( const bench_options* options );

/// All tables of a plan.
wisp_status contact_bench_run( const contact_plan* plan, results* out, wisp_error* error );

typedef wisp_status contact_fn( const contact_plan* plan, results* out, wisp_error* error );

contact_fn contact_queries;  ///< grid, tree and brute force on the same boxes
contact_fn contact_price;    ///< a folding cloth by features, guard, spacing and margin: what is missed, against cost
contact_fn contact_motion;   ///< the same cloth over a ball that rests, and that swings slowly or fast
contact_fn contact_balloons; ///< a pair pressed together, a stack in a box
contact_fn contact_pictures; ///< both, and the cloth, if there is a folder for it
