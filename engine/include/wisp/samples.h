/// Points on a triangle mesh, on its edges and inside its triangles, about a spacing apart (boundary particle paper, see
/// docs/methods.md). A point is a barycentric embedding: the numbers of its parents and their weights, which stay while the
/// number of points of its element stays. Its position and its normal are sums over the parents. Points are listed edge by
/// edge, then triangle by triangle, then line by line, in the same order for any number of workers.
///
/// boundary.h gives a surface such points: wisp_read_boundary() returns them after a step.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// How points are placed along an edge or a line (boundary particle paper, sections 2.2 and 3.4).
typedef enum wisp_spacing
{
    WISP_SPACING_EVEN = 0,  ///< n parts of equal length, points between them
    WISP_SPACING_EXACT = 1, ///< one spacing apart, from the first end; the last interval is shorter
    WISP_SPACING_COUNT = 2,
} wisp_spacing;

/// How length / spacing is rounded to a count. With WISP_ROUND_UP and even spacing no interval exceeds the spacing.
typedef enum wisp_rounding
{
    WISP_ROUND_DOWN = 0,
    WISP_ROUND_NEAREST = 1,
    WISP_ROUND_UP = 2,
    WISP_ROUND_COUNT = 3,
} wisp_rounding;

/// Sampled points. Zero-initialised is empty. The struct owns its arrays; they are valid until the next call.
typedef struct wisp_samples
{
    int count, edge_count; ///< points, and how many of them are on edges; those come first
    const int32_t* begin;  ///< [elements + 1] first point of an edge, or of edge_count of the mesh + a triangle
    const float* xyzw;     ///< [count][4] m; the fourth is the element as int bits: an edge, or edge_count of the
                           ///< mesh + a triangle. Padded by 8 rows
    const float* normals;  ///< [count][4] unit, the fourth 0; null if normals are off
    const int32_t (
        *parents )[4]; ///< [count] slots times 4; the third of an edge's point is its first. The fourth is 0
    const float ( *weights )[4]; ///< [count] sum to 1; the third of an edge's point is 0. The fourth is 0
    int changed_elements;        ///< resampled in the last call
    int skipped_elements;        ///< not sampled: a corner is not finite
    bool refused;                ///< the limit was reached: the points are those of the previous counts
    double requested;            ///< points that the counts would give, or an estimate
    wisp_buffer buffers[8];
} wisp_samples;

WISP_END_C
