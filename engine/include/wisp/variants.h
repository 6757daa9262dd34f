/// Variants of a method that a host chooses and the engine computes.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

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
