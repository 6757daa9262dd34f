/// Declarations shared by the files of sampling: counts from lengths, state of each element, and the stages of an
/// update.
#pragma once

#include "wisp/module/sampling.h"

enum
{
    SAMPLES_BLOCK = 256, // elements per block of counting and filling, a multiple of 8
};

/// Points of one layer. Two layers alternate, so that the last result stays valid until the next one is complete.
typedef struct samples_points
{
    float* xyzw;
    float* normals;
    int32_t ( *parents )[4];
    float ( *weights )[4];
} samples_points;

/// Totals of one block of elements.
typedef struct samples_counts
{
    int64_t points;
    double beyond; // estimated number of points of elements that have too many to be counted
    int changed, skipped;
} samples_counts;

/// State of edges or of triangles: values of the last update, and the bounds of extents within which counts stay.
/// Arrays are padded to slices of eight.
typedef struct samples_group
{
    int count, first; // number of elements, and index of the first one
    int32_t* points;  // [count] copy of the caller's indices
    float* extent;    // [count] or [count][2]
    int32_t* axis;    // [count] base axis of triangles
    float* next_extent;
    int32_t* next_axis;
    float *lower, *upper, *low_height, *high_height;
    uint8_t* held; // [slice]
} samples_group;

/// Memory of a layer at the start of its buffer, kept between updates; the arrays follow it.
typedef struct samples_memory
{
    samples_group edges, triangles;
    wisp_spacing policy;
    wisp_rounding rounding;
    float hysteresis;
    bool has_normals;
    bool needs_resampling; // sampling parameters have changed, so nothing is reused
    int turn;              // index of the current layer
    int capacity[2];
    samples_points shown;
    int32_t* begin;   // [elements + 1]
    int32_t* next;    // [elements + 1] counts, then first points
    uint8_t* changed; // [elements]
    int32_t ( *pair_x4 )[2][8];
    int32_t ( *corner_x4 )[3][8];
    samples_counts* counts; // [block]
    int64_t* block_begin;   // [block]
    int32_t* around_begin;  // [edge + 1] first triangle at each edge
    int32_t* around;
} samples_memory;

/// Data shared by the blocks of an update.
typedef struct samples_update
{
    const wisp_samples_args* args;
    const wisp_kernels* kernels;
    samples_memory* memory;
    samples_points from, to;
    int edge_blocks, triangle_blocks;
    double most; // maximum number of points of one element that is counted
    int count, edge_points;
    _Atomic int unknown; // number of points without a normal, padding included
} samples_update;

/// Length of a triangle's base and height, divided by its spacing.
typedef struct samples_extent
{
    int axis; // local edge of the base; lines run from corner `axis` to the next corner
    double base, height;
} samples_extent;

// ---- samples.c: counts from lengths. Lengths are divided by the spacing, counts are integers in doubles ----

typedef struct samples_bounds
{
    double lower, upper;
} samples_bounds;

/// Return the number of spacings in a length, rounded.
double samples_count_of( const wisp_samples_args* args, double length );
/// Return the number of points that a count of n gives on a length.
double samples_points_of( const wisp_samples_args* args, double n, double length );
/// Return the position of point i of n, as a fraction of the length.
double samples_fraction( const wisp_samples_args* args, double i, double n, double length );
/// Test whether a length keeps the count n.
bool samples_may_stay( const wisp_samples_args* args, double n, double length );
/// Return the bounds of the length within which n and its points stay the same.
samples_bounds samples_bounds_of( const wisp_samples_args* args, double n, double points );

/// Compute an edge's length divided by its spacing.
/// @return false if a corner is not finite
bool samples_measure_edge( const wisp_samples_args* args, int edge, double* length );
/// Compute the extents of a triangle.
/// @return false if a corner is not finite
bool samples_measure_triangle( const wisp_samples_args* args, int triangle, samples_extent* out );

/// Iterates over the lines of a triangle. Counts use the remembered extents, points the current ones.
typedef struct samples_lines
{
    const wisp_samples_args* args;
    double made_base, made_height, base, height;
    double n;    // number of lines
    double most; // number of lines that exist
    // current line
    double k;         // index, from 1
    double fraction;  // fraction of the height
    double length, m; // divided by the spacing, and its count
    double points;
} samples_lines;

samples_lines samples_lines_of( const wisp_samples_args* args, const samples_extent* made,
                                const samples_extent* now );
/// Advance to the next line with points.
/// @return false after the last: lines only get shorter
bool samples_next_line( samples_lines* lines );

// ---- samples_count.c ----

/// Count a block of elements. The caller's state of unchanged elements stays; the new state of changed ones is
/// stored aside.
void samples_count_block( void* context, int begin, int end, int worker );

/// Fill a block of elements: recipes of unchanged elements are copied, the others are generated.
void samples_fill_block( void* context, int begin, int end, int worker );
/// Compute the weights of a block that depend on lengths or normals.
void samples_weigh_block( void* context, int begin, int end, int worker );
