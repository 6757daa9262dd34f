/// The grid of boxes. It reports boxes that overlap a query in any order. Lists are sorted afterwards, so pairs do not depend on
/// the number of workers.
#pragma once

#include "wisp/module/aabb_pairs.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

enum
{
    BOX_GRAIN = 2048,      // boxes per block in loops that take a few nanoseconds per box
    BOX_FOUND_PADDING = 8, // entries after the last one that a wide store may write
};

/// Test whether a box can overlap another one; false if a coordinate is not finite.
static inline bool box_is_valid( const wisp_aabb* box )
{
    bool is_valid = true;
    for ( int k = 0; k < 3; ++k )
    {
        is_valid &= box->lower[k] <= box->upper[k] && box->lower[k] >= -FLT_MAX && box->upper[k] <= FLT_MAX;
    }
    return is_valid;
}

/// Some queries that run together, and the boxes that overlap each of them.
typedef struct box_question
{
    wisp_aabb_group group;
    uint64_t tested; ///< number of boxes compared
} box_question;

enum
{
    MAX_BOX_LEVELS = 12,
};

/// Boxes of similar size, by the cell of their lower corner.
typedef struct box_level
{
    float origin[3], inverse[3]; ///< m, 1/m; cell sizes differ between axes
    float end[3];                ///< m, maximum of the lower corners; the origin is their minimum
    float extent[3];             ///< m, maximum box extent, rounded up
    float last[3];               ///< last cell along each axis
    int dims[3], axis[3];        ///< axis[0] is the fastest in memory, axis[2] the slowest
    int stride[3];               ///< distance in memory between cells that are adjacent along x, y, z
    int64_t cell_count;
    int32_t cell_first; ///< index of the level's first cell among the cells of all levels
} box_level;

/// Return the cell of a coordinate along an axis. Clamps before the conversion to an integer, since a query may be anywhere.
static inline int box_cell_along( const box_level* level, float coordinate, int axis )
{
    float cell = ( coordinate - level->origin[axis] ) * level->inverse[axis];
    cell = cell > 0.0f ? cell : 0.0f;
    return (int)( cell < level->last[axis] ? cell : level->last[axis] );
}

typedef struct box_grid
{
    wisp_aabb_stream stream; ///< slots, sorted by level, cell and box index
    const int32_t* begin;    ///< [cells of all levels + 1] first slot
    const int32_t* cell_of;  ///< [box] -1 if the box overlaps nothing
    int slot_count, level_count;
    box_level levels[MAX_BOX_LEVELS];
    const wisp_kernels* kernels; ///< may be null
} box_grid;

/// @param buffers array of four
wisp_status box_grid_build( box_grid* grid, wisp_buffer* buffers, const wisp_parallel* parallel,
                            const wisp_aabb_args* args );
/// Run several queries.
/// @return false without a result if too many boxes would be compared at once: run them one by one
bool box_grid_find( const box_grid* grid, box_question* question );
