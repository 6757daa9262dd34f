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

/// Points that keep distances, in packs of sixteen. A pack has as many rows of pairs as its point with the most; a lane without a pair
/// has any other point and the gap 0.
typedef struct wisp_point_pair_args
{
    const float* start;      ///< [point][4] m, where the substep starts; the fourth is the root of friction
    const float* now;        ///< [point][4] m; the fourth is 1/kg
    const int32_t* own_x4;   ///< [pack][16] points, times 4
    const int32_t* begin;    ///< [pack + 1] first row of pairs
    const int32_t* other_x4; ///< [row][16] the other points, times 4
    const float* gap;        ///< [row][16] m, to keep
    float reach;             ///< of find_near_pairs: pairs within this many gaps are near
    float recovery;          ///< gaps by which pairs that start nearer than theirs may part
    uint16_t* found;         ///< [row] a bit for each pair that is found
    float* count;            ///< [pack][16] out of find_pressing_points: pairs of a point
    float *push, *shift;     ///< [pack][16][4] kg m, out: corrections, recovery; the fourth sums lengths
} wisp_point_pair_args;

WISP_END_C
