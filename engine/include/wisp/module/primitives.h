/// Points, edges and triangles in packs of eight: arguments of the kernels that find near pairs and bound their approach.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// Axis-aligned bounding box, closed. One that is empty (lower above upper) or not finite overlaps nothing.
typedef struct wisp_aabb
{
    float lower[3], upper[3]; ///< m
} wisp_aabb;

/// Up to eight primitives of one kind: points, edges or triangles. 64-byte aligned.
typedef struct wisp_primitive_pack
{
    float centre[3][8];      ///< m
    float edge_vector[3][8]; ///< m, from the centre to the first corner; unused for points
    int32_t point_x4[2][8];  ///< points times 4; a point has one
    int32_t item[8];     ///< number of the primitive, >= 0; -1: an empty lane, whose points are arbitrary valid ones
    int32_t third_x4[8]; ///< triangles: third point times 4
    float other_edge_vector[2][3][8]; ///< m, triangles: from the centre to the second and the third corner
    float normal[3][8];               ///< triangles: unit; 0 if twice the area is below 1e-15 m^2
    float rounding[8];                ///< m, triangles: distance of the corners from the rounded plane
} wisp_primitive_pack;

/// Most arguments of one kernel call, and most packs of each side of one.
enum
{
    WISP_PRIMITIVE_BATCH = 8,
    WISP_PRIMITIVE_PACKS = 3,
};

/// Pairs of primitives: their cluster pair, their numbers, and their points times 4 as in wisp_closest_args. Arrays have room
/// for 8 more than are written.
typedef struct wisp_primitive_pairs
{
    int32_t *id, *first, *second;
    int32_t* point_x4[4];
} wisp_primitive_pairs;

/// Find primitive pairs that may be closer than `max_distance`.
typedef struct wisp_primitive_near_args
{
    const wisp_primitive_pack *queries, *packs;
    int query_pack_count, pack_count;
    const wisp_aabb *query_aabb, *box; ///< bounds of all primitives of the queries, and of the packs
    float max_distance;                ///< m
    float cull_distance;               ///< m, >= max_distance: primitives farther from the other AABB are skipped
    float*
        min_distance; ///< [8] m, in and out: lowered to a bound of the distance of tested pairs that are not reported
    bool is_self;     ///< edges: queries are the packs themselves; a pair is reported once, by its lower number
    int32_t cluster;  ///< cluster pair that is written with the pairs
} wisp_primitive_near_args;

/// Two sets of points, and candidate separating axes. The lists of points are padded to a multiple of 8.
typedef struct wisp_separating_axis_args
{
    const float* xyzw;          ///< [point][4] m
    const int32_t* point_x4[2]; ///< points of each set times 4
    int count[2];               ///< multiples of 8
    float axis[3][3];           ///< of any length above 1e-15; shorter ones are ignored
} wisp_separating_axis_args;

/// Bound how much the sides of pairs can approach: the largest approach of two of their points.
typedef struct wisp_approach_args
{
    const float* predicted;     ///< [point][4] m: predicted displacement, and its uncertainty
    const int32_t* point_x4[4]; ///< [pair] as in wisp_primitive_pairs
    bool are_edges;             ///< the first side has two points, else one
    float* max_approach;        ///< [pair] out, m
} wisp_approach_args;

/// Displacements of points. Arrays are padded to a multiple of 8.
typedef struct wisp_displacement_args
{
    const float *before, *now;     ///< [point][4] m
    float common_displacement[3];  ///< m, common displacement of all points
    float relative_margin, margin; ///< uncertainty: fraction of the rest of the displacement, plus a margin in m
    float* displacement;           ///< [point][4] m; the fourth is the uncertainty
} wisp_displacement_args;

/// Pairs with a cached bound of their separation, minus their approach since. Sides are sets of points; the displacement of a
/// side is that of its centre, and in the fourth component the largest deviation of a point from it. Arrays of pairs are
/// padded to a multiple of 8.
typedef struct wisp_separation_args
{
    const float *moved,
        *predicted; ///< [side][4] m: displacement to subtract, null if already done; predicted displacement
    const int32_t *first, *second; ///< [pair] sides
    float* separation_bound;       ///< [pair] in and out, m
    int32_t* active;               ///< [pair] out: active pairs first, whose bound may fall below zero
} wisp_separation_args;

/// Sixteen points on straight paths through a step. 64-byte aligned.
typedef struct wisp_point_pack
{
    float at[3][16], motion[3][16]; ///< m, in the middle of the path; from its start to its end
    float rest[3][16];              ///< m
    float stray[16];                ///< m, how far it may be from its path
    float reach[16]; ///< m, half of the most that it keeps, with stray and half of its path beside the common one
    float half[16], cover[16]; ///< m: a pair keeps the sum of halves, and at least the larger cover
    float group[16];           ///< those of one group are neighbours if they are near at rest
    int32_t point_x4[16];      ///< times 4
} wisp_point_pack;

/// Points that may meet in a step: packs against packs. The last pack may have lanes behind the last point.
typedef struct wisp_point_list_args
{
    wisp_point_pack* packs;
    int point_count;
    const float *start, *now;            ///< [point][4] m, of a substep
    wisp_aabb* boxes;                    ///< [pack] out of predict_points: what its points reach
    float common[3];                     ///< m, mean motion in a step
    float substeps;                      ///< of the step
    float stray_by_gap, stray_by_motion; ///< parts of what a point keeps, and of its motion beside the common one
    float largest_cover;                 ///< m
    float neighbours;                    ///< gaps
    const int32_t *first, *second;       ///< [pair] packs; both may be the same
    uint16_t ( *found )[16]; ///< [pair] out: for each point of the first pack a bit for each of the second
    int32_t* count;          ///< [pair] out: how many bits are set
} wisp_point_list_args;

/// Pairs of points that keep distances, in packs of sixteen. A lane without a pair has any points and the gap 0.
typedef struct wisp_point_pair_args
{
    const float *start, *now;    ///< [point][4] m, at the start of the substep, and now
    const int32_t* point_x4[2];  ///< [pair] points, times 4
    const float *gap, *friction; ///< [pair] m, to keep; coefficient
    float reach;                 ///< of find_near_pairs: pairs within this many gaps are near
    float recovery;              ///< gaps by which pairs that start nearer than theirs may part
    uint16_t* found;             ///< [pack] out: a bit for each pair that is found
    float *push,
        *shift; ///< [pair][4] m, out of push_points for pairs that are found: correction of the first point, recovery
} wisp_point_pair_args;

WISP_END_C
