/// Shared by the files of sampling: counts from lengths, state of each element, and the stages of an update.
#pragma once

#include "wisp/module/sampling.h"

enum
{
    SAMPLES_BLOCK = 256, // elements a block of counting and filling, a multiple of 8
};

/// Points of one layer: two of these take turns, so that a layer is there until the next one is complete.
typedef struct samples_points
{
    float* xyzw;
    float* normals;
    int32_t ( *parents )[4];
    float ( *weights )[4];
    float ( *normal_weights )[4];
} samples_points;

/// What one block of elements came to.
typedef struct samples_tally
{
    int64_t points;
    double beyond; // points that were only estimated, because they are too many to be counted
    int changed, skipped;
} samples_tally;

/// What is kept of edges, or of triangles: the state that the caller was last left with, and between which extents counts stay.
/// Arrays end in whole slices of eight.
typedef struct samples_group
{
    int count, first; // elements, and the number of the first one
    int32_t* points;  // [count] the caller's, remembered
    float* extent;    // [count] or [count][2]
    int32_t* axis;    // [count] of triangles
    float* next_extent;
    int32_t* next_axis;
    float *lower, *upper, *low_height, *high_height;
    uint8_t* held; // [slice]
} samples_group;

/// Warm memory of a layer, at the head of its buffer; the arrays lie behind it.
typedef struct samples_memory
{
    samples_group edges, triangles;
    wisp_spacing policy;
    wisp_rounding rounding;
    float hysteresis;
    bool scanline, has_normals;
    bool anew; // what elements are sampled by has changed: nothing that was kept counts
    int turn;  // which of the two layers is in use
    int capacity[2];
    samples_points shown;
    int32_t* begin;   // [elements + 1]
    int32_t* next;    // [elements + 1] counts, then where they begin
    uint8_t* changed; // [elements]
    int32_t ( *pair_x4 )[2][8];
    int32_t ( *corner_x4 )[3][8];
    samples_tally* tallies; // [block]
    int64_t* block_begin;   // [block]
    int32_t* around_begin;  // [edge + 1] triangles around an edge
    int32_t* around;
} samples_memory;

/// What the blocks of an update share.
typedef struct samples_update
{
    const wisp_samples_args* args;
    const wisp_kernels* kernels;
    samples_memory* memory;
    samples_points from, to;
    int edge_blocks, triangle_blocks;
    double most; // points of one element that are still counted
    int count, edge_points;
    _Atomic int unknown; // points without a normal, padding included
} samples_update;

/// How long a triangle's base and height are, over its spacing.
typedef struct samples_extent
{
    int axis; // local edge; lines run from corner `axis` to the next one
    double base, height;
} samples_extent;

// ---- samples_law.c: what a length comes to. Lengths are over the spacing, counts are whole numbers in doubles ----

typedef struct samples_bounds
{
    double lower, upper;
} samples_bounds;

/// Number of spacings in a length, rounded.
double samples_count_of( const wisp_samples_args* args, double length );
/// Points that n gives on a length.
double samples_points_of( const wisp_samples_args* args, double n, double length );
/// Where point i of n stands, as a share of the length.
double samples_fraction( const wisp_samples_args* args, double i, double n, double length );
/// May n stay on this length?
bool samples_may_stay( const wisp_samples_args* args, double n, double length );
/// Lengths between which n, and its points, are the same.
samples_bounds samples_bounds_of( const wisp_samples_args* args, double n, double points );

/// An edge's length over its spacing. @return false: a corner is not finite
bool samples_measure_edge( const wisp_samples_args* args, int edge, double* length );
/// @return false: a corner is not finite
bool samples_measure_triangle( const wisp_samples_args* args, int triangle, samples_extent* out );

/// A triangle's lines one after another: counts come from the extents they are made from, points from those of now.
typedef struct samples_lines
{
    const wisp_samples_args* args;
    double made_base, made_height, base, height;
    double n;    // of lines
    double most; // lines that there are
    // of the line that was last come to
    double k;         // from 1
    double fraction;  // of the height
    double length, m; // over the spacing, and its count
    double points;
} samples_lines;

samples_lines samples_lines_of( const wisp_samples_args* args, const samples_extent* made,
                                const samples_extent* now );
/// Go to the next line with points. @return false behind the last: lines only get shorter
bool samples_next_line( samples_lines* lines );

// ---- samples_count.c ----

/// Count a block of elements; where nothing has changed the caller's state is up to date, elsewhere what it will be is kept.
void samples_count_block( void* context, int begin, int end, int worker );
/// Bounds of an edge or a triangle, from what it is sampled by.
void samples_keep_edge( const samples_update* u, int edge );
void samples_keep_triangle( const samples_update* u, int triangle );

// ---- samples_fill.c ----

/// Fill a block of elements: recipes of those that stay are moved, the others are made.
void samples_fill_block( void* context, int begin, int end, int worker );
/// Weights of a block that depend on lengths or normals.
void samples_weigh_block( void* context, int begin, int end, int worker );
