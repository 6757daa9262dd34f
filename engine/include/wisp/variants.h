/// Variants of a method that a host chooses and the engine computes.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// How pairs of boxes that overlap are found. The choice changes the time and not the result.
typedef enum wisp_pair_search
{
    WISP_PAIR_SEARCH_AUTO,  ///< the search that was measured to be fastest for the number of boxes
    WISP_PAIR_SEARCH_GRID,  ///< uniform grids, one for boxes of about each size
    WISP_PAIR_SEARCH_TREE,  ///< a bounding volume tree; needs Embree, without it the grid is used
    WISP_PAIR_SEARCH_BRUTE, ///< all queries against all boxes, for comparison
    WISP_PAIR_SEARCH_COUNT,
} wisp_pair_search;

/// How the brake reads a change of distance (Kim 2026, eq. 17-18, and other readings of it).
typedef enum wisp_gap
{
    WISP_GAP_ABSOLUTE, ///< |r1 - r0|, a large change brakes
    WISP_GAP_SIGNED,   ///< r1 - r0, equations as printed
    WISP_GAP_REVERSED, ///< r0 - r1 in the printed law
    WISP_GAP_NONE,     ///< no brake
} wisp_gap;

WISP_END_C
