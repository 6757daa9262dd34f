/// Variants of a method that a host chooses and the engine computes.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// How pairs of boxes that overlap are found. The choice changes the time and not the result.
typedef enum wisp_pair_search
{
    WISP_PAIR_SEARCH_AUTO = 0,  ///< the search that was measured to be fastest for the number of boxes
    WISP_PAIR_SEARCH_GRID = 1,  ///< uniform grids, one for boxes of about each size
    WISP_PAIR_SEARCH_TREE = 2,  ///< a bounding volume tree; needs Embree, without it the grid is used
    WISP_PAIR_SEARCH_BRUTE = 3, ///< all queries against all boxes, for comparison
    WISP_PAIR_SEARCH_COUNT = 4,
} wisp_pair_search;

/// Search structure of a triangle mesh. All of them give the same results to the last bit.
typedef enum wisp_mesh_search
{
    WISP_MESH_SEARCH_TREE = 0, ///< a bounding volume tree; needs Embree
    WISP_MESH_SEARCH_VOXELS =
        1, ///< a grid of cubes, each with a list of the triangles that touch it (Zhang and Yuen 2000)
    WISP_MESH_SEARCH_COUNT = 2,
} wisp_mesh_search;

/// How the brake reads a change of distance (Kim 2026, eq. 17-18, and other readings of it).
typedef enum wisp_gap
{
    WISP_GAP_ABSOLUTE = 0, ///< |r1 - r0|, a large change brakes
    WISP_GAP_SIGNED = 1,   ///< r1 - r0, equations as printed
    WISP_GAP_REVERSED = 2, ///< r0 - r1 in the printed law
    WISP_GAP_NONE = 3,     ///< no brake
} wisp_gap;

WISP_END_C
