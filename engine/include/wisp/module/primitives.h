/// Points, edges and triangles that are looked at together: which of them are near others, and how near they may come.
#pragma once

#include "wisp/base.h"

WISP_BEGIN_C

/// A closed box. One that is empty (low above high) or not finite overlaps nothing.
typedef struct wisp_aabb
{
    float lower[3], upper[3]; ///< m
} wisp_aabb;

/// Up to eight primitives of one kind: points, edges or triangles. 64-byte aligned.
typedef struct wisp_primitive_pack
{
    float centre[3][8];      ///< m
    float edge_vector[3][8]; ///< m, from the middle to the first corner; not of a point
    int32_t point_x4[2][8];  ///< points times 4; a point has one
    int32_t item
        [8]; ///< what the primitive is called, >= 0; -1: there is none in this lane, whose points are any that there are
    int32_t third_x4[8];              ///< of a triangle the third point times 4
    float other_edge_vector[2][3][8]; ///< m, of a triangle: to the second and the third corner
    float normal[3][8];               ///< unit, of a triangle; 0 where twice its area is below 1e-15 m^2
    float rounded[8];                 ///< m, of a triangle, how far from its plane a corner is
} wisp_primitive_pack;

/// So many jobs are done at once at most, each with so many rows of either side.
enum
{
    WISP_PRIMITIVE_BATCH = 8,
    WISP_PRIMITIVE_PACKS = 3,
};

/// Pairs of primitives: what they are of, what they are called, and their points times 4 as wisp_closest_args has them. Room for
/// 8 more than are put.
typedef struct wisp_primitive_pairs
{
    int32_t *of, *first, *second;
    int32_t* point_x4[4];
} wisp_primitive_pairs;

/// Which primitives of some rows are so near primitives of others that they may be within a distance.
typedef struct wisp_primitive_near_args
{
    const wisp_primitive_pack *queries, *rows;
    int query_rows, row_count;
    const wisp_aabb *query_box, *box; ///< around all primitives of the queries, and of the rows
    float within;                     ///< m
    float seen;                       ///< m, >= within: what is farther from the others' box is not looked at
    float* least; ///< [8] in and out: lowered to how far those are apart at least that are looked at and not found, m
    bool is_own;  ///< of edges: queries are the rows, a pair is named by the one that is called less
    int32_t number; ///< what its pairs are said to be of
} wisp_primitive_near_args;

/// Two sets of points, and directions along which they may be apart. The lists of points are padded to eights.
typedef struct wisp_separating_axis_args
{
    const float* xyzw;          ///< [point][4] m
    const int32_t* point_x4[2]; ///< of either set, points times 4
    int count[2];               ///< multiples of 8
    float along[3][3];          ///< of any length above 1e-15; what is shorter tells nothing
} wisp_separating_axis_args;

/// How much nearer the sides of pairs may come, at most: no more than two of their points.
typedef struct wisp_approach_args
{
    const float* ahead;         ///< [point][4] m: where it goes, give or take the fourth
    const int32_t* point_x4[4]; ///< [pair] as wisp_primitive_pairs has them
    bool are_edges;             ///< the first side has two points, else one
    float* closing;             ///< [pair] out, m
} wisp_approach_args;

/// Where points go, quads. Arrays have room for the last eight.
typedef struct wisp_displacement_args
{
    const float *before, *now; ///< [point][4] m
    float common[3];           ///< m, that all of them go together
    float fraction, spare;     ///< of what a point goes beside that, and m
    float* way;                ///< [point][4] m; the fourth is share and spare of it
} wisp_displacement_args;

/// Pairs of which it is known how far their sides are from something, less what they came nearer since. Sides are sets of points;
/// a way of one is the middle of where its points go, and, fourth, how far from it any of them goes at most. Arrays of pairs
/// are padded to eights.
typedef struct wisp_separation_args
{
    const float *gone, *ways;      ///< [side][4] m: what is to be counted, null if it is already; what may come
    const int32_t *first, *second; ///< [pair] sides
    float* slack;                  ///< [pair] in and out, m
    int32_t* due;                  ///< [pair] out: those that may use up their slack, in front
} wisp_separation_args;

WISP_END_C
