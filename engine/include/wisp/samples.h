/// Points on a triangle mesh, on its edges and inside its triangles, about a spacing apart (BND). A point is a recipe, the
/// numbers of its parents and their weights, which holds while no count changes; where it is, and its normal, are sums
/// over the parents. Points come edge by edge, then triangle by triangle, then line by line: the same for any number of
/// workers, and whether they were sampled in place or anew.
#pragma once

#include "wisp/jobs.h"
#include "wisp/kernels.h"
#include "wisp/space.h"

WISP_BEGIN_C

/// Where points of an edge or of a line stand (BND section 5).
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

/// What to sample and how. The arrays stay the caller's.
typedef struct wisp_samples_job
{
    const float* position; ///< [slot][4] m; 16-byte aligned
    const float* normal;   ///< [slot][4] unit vertex normals, 0 where there is none; null: points get no normals
    const int32_t* edges;  ///< [edge_count][2] slots, from the end that positions are counted from
    int edge_count;
    const int32_t* triangles; ///< [triangle_count][3] slots
    int triangle_count;
    const float* edge_spacing;     ///< [edge_count] m, > 0; null: `spacing` for all
    const float* triangle_spacing; ///< [triangle_count] m; null: `spacing` for all
    float spacing;                 ///< m, > 0, finite
    wisp_spacing policy;
    wisp_rounding rounding;
    /// Counts stay while lengths are within so many spacings of where they would change; 0: exact comparison (X5). A
    /// triangle decides as a whole: its counts are made anew together when its axis changes or one of them must go.
    float hysteresis;
    bool scanline; ///< normals of inner points between those of their line's ends, instead of by the three weights
    int limit;     ///< at most so many points, >= 0; beyond it nothing is sampled anew and `refused` says so

    // What a job remembers from call to call, the caller's state: zero at the first call. It may be put back to that of an
    // earlier call at any time; points are those that belong to it. Lengths are over the spacing.
    float* edge_length;   ///< [edge_count] that the count was made from; 0 without hysteresis, which needs no memory
    int32_t* edge_points; ///< [edge_count]
    float* triangle_extent; ///< [triangle_count][2] base and height that counts were made from; 0 without hysteresis
    int32_t* triangle_axis; ///< [triangle_count] local edge that lines are parallel to
    int32_t* triangle_points; ///< [triangle_count]
} wisp_samples_job;

/// Points. Zero-initialised is empty; arrays belong to it and are valid until the next call.
typedef struct wisp_samples
{
    int count, edge_count; ///< points, and how many of them are on edges: those come first
    const int32_t* begin;  ///< [elements + 1] first point of an edge, or of edge_count of the mesh + a triangle
    const float* quads;    ///< [count][4] m; the fourth is the element as int bits: an edge, or edge_count of the
                           ///< mesh + a triangle. Padded by 8 rows
    const float* normals;  ///< [count][4] unit, the fourth 0; null without
    const int32_t (
        *parents )[4]; ///< [count] slots times 4; the third of an edge's point is its first. The fourth is 0
    const float ( *weights )[4]; ///< [count] sum to 1; the third of an edge's point is 0. The fourth is 0
    int changed_elements;        ///< sampled anew in the last call (case B)
    int skipped_elements;        ///< not sampled: a corner is not finite
    bool refused;                ///< the limit was met: points are those of the counts before
    double wanted;               ///< points that the counts came to, or were estimated to come to
    wisp_buffer buffers[8];
} wisp_samples;

/// Count, scan, fill, place (BND E1..E4, I1..I5, N1, N2, U1, U2). Lengths are measured in double precision. Lines of a triangle
/// run from the first corner of its axis to the second; the lowest of equally short sides is the axis.
/// @param job the edges and triangles of the call before, as long as their numbers are the same: release first where others
///        take their place. A change of anything else is met by sampling anew
/// @return WISP_NO_MEMORY: points are those of the last call
WISP_API wisp_status wisp_samples_update( wisp_samples* samples, const wisp_parallel* parallel,
                                          const wisp_kernels* kernels, const wisp_samples_job* job );
WISP_API void wisp_samples_release( wisp_samples* samples, const wisp_allocator* allocator );

WISP_END_C
