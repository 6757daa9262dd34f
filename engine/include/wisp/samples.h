/// Points on a triangle mesh, on its edges and inside its triangles, about a spacing apart (boundary particle paper, see
/// docs/methods.md). A point is a recipe, the numbers of its parents and their weights, which holds while no count changes;
/// where it is, and its normal, are sums over the parents. Points come edge by edge, then triangle by triangle, then line
/// by line: the same for any number of workers, and whether they were sampled in place or anew.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Where points of an edge or of a line stand (boundary particle paper, sections 2.2 and 3.4).
typedef enum wisp_spacing
{
    WISP_SPACING_EVEN,  ///< n parts of equal length, points between them
    WISP_SPACING_EXACT, ///< a spacing apart from the first end on; the last gap is shorter
    WISP_SPACING_COUNT,
} wisp_spacing;

/// How a length over the spacing becomes a count. WISP_ROUND_UP with even spacing: no gap is above the spacing.
typedef enum wisp_rounding
{
    WISP_ROUND_DOWN,
    WISP_ROUND_NEAREST,
    WISP_ROUND_UP,
    WISP_ROUND_COUNT,
} wisp_rounding;

/// Points. Zero-initialised is empty; arrays belong to it and are valid until the next call.
typedef struct wisp_samples
{
    int count, edge_count; ///< points, and how many of them are on edges: those come first
    const int32_t* begin;  ///< [elements + 1] first point of an edge, or of edge_count of the mesh + a triangle
    const float* xyzw;     ///< [count][4] m; the fourth is the element as int bits: an edge, or edge_count of the
                           ///< mesh + a triangle. Padded by 8 rows
    const float* normals;  ///< [count][4] unit, the fourth 0; null without
    const int32_t (
        *parents )[4]; ///< [count] slots times 4; the third of an edge's point is its first. The fourth is 0
    const float ( *weights )[4]; ///< [count] sum to 1; the third of an edge's point is 0. The fourth is 0
    int changed_elements;        ///< sampled anew in the last call (case B)
    int skipped_elements;        ///< not sampled: a corner is not finite
    bool refused;                ///< the limit was met: points are those of the counts before
    double requested;            ///< points that the counts came to, or were estimated to come to
    wisp_buffer buffers[8];
} wisp_samples;

WISP_END_C
