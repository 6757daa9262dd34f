/// Neighbour search: a uniform grid by counting sort, and neighbour lists in a fixed order.
#pragma once

#include "wisp/module/jobs.h"
#include "wisp/module/kernels.h"

WISP_BEGIN_C

/// Items sorted by cell. A slot is an item's place in that order: by cell (axis[0] fastest, axis[2] slowest), within a
/// cell by item number. The axis with the fewest cells is fastest, so that the neighbours of a cell lie close by; an axis
/// with a single cell is slowest. Zero-initialised is empty; arrays belong to the grid and stay valid until it is built again.
typedef struct wisp_grid
{
    int count;
    float origin[3];
    float cell;                ///< m, edge along axis[1] and axis[2]
    int subdivisions;          ///< cells along axis[0] are shorter by this factor
    float inverse_cell[3];     ///< 1/m, along x, y, z
    int dims[3];               ///< cells along x, y, z
    int axis[3];               ///< 0, 1, 2 for x, y, z: fastest first. Cell (cx, cy, cz) = c is number
                               ///< (c[axis[2]] dims[axis[1]] + c[axis[1]]) dims[axis[0]] + c[axis[0]]
    float rounding_margin;     ///< m, how far rounding can carry a coordinate across a cell's border
    bool planar;               ///< every z is the same
    bool is_widened;           ///< cells were widened, because the items are too sparse for the given size
    const int32_t* cell_begin; ///< [dims product + 1] first slot
    const int32_t* item;       ///< [slot] item number, padded by 16
    const float *x, *y, *z;    ///< [slot] m, padded by 16
    const int32_t* owner;      ///< [slot], padded by 16
    wisp_buffer buffers[4];
} wisp_grid;

/// Sort items into cells.
/// @param xyzw [count][4] x, y, z in m, finite; owner as int bits
/// @param cell m, > 0: edge of a cell; wider if the grid would need more than 4 cells per item
/// @param fine > 0: cut cells along the fastest axis into this many, fewer if that makes more than 4 cells per item. Runs of
///             cells then fit a radius better; 1: cubes
/// @return WISP_NO_MEMORY
WISP_API wisp_status wisp_grid_build( wisp_grid* grid, const wisp_parallel* parallel, const float* xyzw, int count,
                                      float cell, int fine );
WISP_API void wisp_grid_release( wisp_grid* grid, const wisp_allocator* allocator );
/// @return bytes that it holds
WISP_API size_t wisp_grid_bytes( const wisp_grid* grid );

/// Neighbours of queries in slices of eight: near ones, and behind them in the same list a shell around them that lets the
/// lists be used for a while after the items have moved. Empty lanes of the last slice have their own numbers too, beyond
/// the last query. Zero-initialised is empty.
typedef struct wisp_neighbours
{
    int slice_count;
    wisp_neighbour_list near, all; ///< the same lists: as far as any lane has near ones, and all of them
    const int32_t* near_count;     ///< [slice_count][8] near ones of a lane
    size_t entries;                ///< of all slices, padding included
    uint64_t capped;               ///< queries that ran into the limit
    wisp_buffer buffers[2];
} wisp_neighbours;

/// Points whose neighbours are searched, and the radii.
typedef struct wisp_neighbour_query
{
    const float* xyzw; ///< [query_count][4] x, y, z, owner as int bits
    int query_count;
    float near_radius;     ///< m
    float skin_radius;     ///< m, above the near radius, or 0 for no shell
    int limit;             ///< most near neighbours per query, and most in the shell: the first in slot order
    const int32_t* rename; ///< [slot] number to report for a slot; null: the slot
} wisp_neighbour_query;

/// Find all items of other owners closer than the radii to each query.
/// @return WISP_NO_MEMORY
WISP_API wisp_status wisp_neighbours_build( wisp_neighbours* neighbours, const wisp_parallel* parallel,
                                            const wisp_kernels* kernels, const wisp_grid* grid,
                                            const wisp_neighbour_query* query );
WISP_API void wisp_neighbours_release( wisp_neighbours* neighbours, const wisp_allocator* allocator );
/// @return bytes that it holds
WISP_API size_t wisp_neighbours_bytes( const wisp_neighbours* neighbours );

/// Make room; the contents stay. @return false without memory: the buffer is as it was
WISP_API bool wisp_buffer_reserve( wisp_buffer* buffer, const wisp_allocator* allocator, size_t bytes );
WISP_API void wisp_buffer_release( wisp_buffer* buffer, const wisp_allocator* allocator );
/// @return bytes of some buffers
WISP_API size_t wisp_buffer_bytes( const wisp_buffer* buffers, int count );

WISP_END_C
