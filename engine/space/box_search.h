/// Shared by all searches of boxes. A search proposes boxes for one query, in any order; lists are sorted afterwards, so that pairs
/// depend neither on the search nor on the number of workers.
#pragma once

#include "wisp/module/aabb_pairs.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>

enum
{
    BOX_GRAIN = 2048,      // boxes a block, where each costs a few nanoseconds
    BOX_FOUND_PADDING = 8, // entries behind the last one that a wide store may touch
};

/// Is a box one that can overlap another? False where a number is not finite.
static inline bool box_is_valid( const wisp_aabb* box )
{
    bool is_valid = true;
    for ( int k = 0; k < 3; ++k )
    {
        is_valid &= box->lower[k] <= box->upper[k] && box->lower[k] >= -FLT_MAX && box->upper[k] <= FLT_MAX;
    }
    return is_valid;
}

/// A few questions at once: for each of some queries, the boxes that overlap it.
typedef struct box_question
{
    wisp_aabb_group group;
    uint64_t tested; ///< boxes compared
} box_question;

// ---- the grid ----

enum
{
    MAX_BOX_LEVELS = 12,
};

/// Boxes of about one size, by the cell of their low corner.
typedef struct box_level
{
    float origin[3], inverse[3]; ///< m, 1/m: a cell's edge differs from axis to axis
    float end[3];                ///< m, the last low corner; the origin is the first
    float extent[3];             ///< m, of the largest box, rounded up
    float last[3];               ///< cell along each axis
    int dims[3], axis[3];        ///< axis[0] is the one whose cells lie side by side, axis[2] the slowest
    int stride[3];               ///< from one cell to the next along x, y, z
    int64_t cell_count;
    int32_t cell_first; ///< of the cells of all levels
} box_level;

typedef struct box_grid
{
    wisp_aabb_stream stream; ///< slots: by level, cell, number
    const int32_t* begin;    ///< [cells of all levels + 1] first slot
    const int32_t* cell_of;  ///< [box] -1 for one that overlaps nothing
    int slot_count, level_count;
    box_level levels[MAX_BOX_LEVELS];
    const wisp_kernels* kernels; ///< may be null
} box_grid;

/// @param buffers four of them
wisp_status box_grid_build( box_grid* grid, wisp_buffer* buffers, const wisp_parallel* parallel,
                            const wisp_aabb_args* args );
/// @return false if several queries would be compared with too many boxes at once, and nothing was found: ask one by one
bool box_grid_find( const box_grid* grid, box_question* question );

// ---- the tree ----

/// Take the boxes over: refit, or build. @return WISP_CONFLICT in a library without Embree
wisp_status box_tree_update( struct wisp_aabb_tree** tree, const wisp_allocator* allocator,
                             const wisp_aabb_args* args, wisp_error* error );
/// One query. Thread-safe.
void box_tree_find( const struct wisp_aabb_tree* tree, box_question* question );
/// Cost of the queries since the last update, which tells whether the search has decayed.
void box_tree_note( struct wisp_aabb_tree* tree, uint64_t tested, uint64_t answers );
void box_tree_counts( const struct wisp_aabb_tree* tree, int* build_count, int* refit_count );
size_t box_tree_bytes( const struct wisp_aabb_tree* tree );
/// Null is allowed.
void box_tree_release( struct wisp_aabb_tree* tree, const wisp_allocator* allocator );
/// Can this library make one?
bool box_tree_exists( void );
