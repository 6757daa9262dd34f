#include "wisp/space.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum
{
    NEIGHBOURS_GRAIN = 16, // slices a block
};

void wisp_neighbours_release( wisp_neighbours* neighbours, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( neighbours->buffers ); ++i )
    {
        wisp_buffer_release( neighbours->buffers + i, allocator );
    }
    *neighbours = ( wisp_neighbours ){ 0 };
}

// Entries of one kind of list. Blocks take room as they come, so where a list lies depends on chance; what it holds does
// not, and nothing reads anything but its own list.
typedef struct neighbour_pool
{
    int32_t *begin, *length, *entries;
    size_t capacity; // entries
    _Atomic size_t used;
} neighbour_pool;

// What the blocks of a search share.
typedef struct neighbour_search
{
    const wisp_kernels* kernels;
    wisp_range_search_job job;
    const int32_t* rename;
    int query_count;
    neighbour_pool near, shell;
    const wisp_parallel* parallel;
    size_t list; // ints from a query's list to the next one
    _Atomic uint64_t capped;
    _Atomic bool starved;
} neighbour_search;

enum
{
    NEIGHBOURS_SCRATCH_LISTS = 2, // near and shell
};

static void keep( neighbour_search* s, neighbour_pool* pool, int slice, int32_t* lists, const int* counts,
                  int length )
{
    size_t at = atomic_fetch_add_explicit( &pool->used, (size_t)length, memory_order_relaxed );
    pool->begin[slice] = (int32_t)at;
    pool->length[slice] = length;
    if ( at + (size_t)length <= pool->capacity )
    {
        s->kernels->interleave( lists, (int)s->list, counts, slice, s->rename, pool->entries + at * WISP_SLICE );
    }
}

static void search_slices( void* context, int begin, int end, int worker )
{
    neighbour_search* s = context;
    size_t lists = s->list * WISP_SLICE;
    int32_t* scratch =
        wisp_parallel_scratch( s->parallel, worker, NEIGHBOURS_SCRATCH_LISTS * lists * sizeof( int32_t ) );
    if ( scratch == NULL )
    {
        atomic_store( &s->starved, true );
        return;
    }
    wisp_range_search_result found = { .near = scratch, .shell = scratch + lists };
    for ( int slice = begin; slice < end; ++slice )
    {
        int left = s->query_count - slice * WISP_SLICE;
        s->kernels->range_search( &s->job, slice, left < WISP_SLICE ? left : WISP_SLICE, &found );
        keep( s, &s->near, slice, found.near, found.near_count, found.near_length );
        keep( s, &s->shell, slice, found.shell, found.shell_count, found.shell_length );
    }
    atomic_fetch_add_explicit( &s->capped, (uint64_t)found.capped, memory_order_relaxed );
}

// As many cells to each side as a neighbour may be away, rounding included.
static int count_cells( float radius, const wisp_grid* grid, int fine )
{
    float cells = ( radius + grid->slack ) * (float)fine / grid->cell;
    return cells < 1e6f ? (int)ceilf( cells ) : 1000000;
}

static wisp_range_search_job make_job( const wisp_grid* grid, const wisp_neighbour_query* query )
{
    float radius = query->shell_radius > query->near_radius ? query->shell_radius : query->near_radius;
    const int reach = count_cells( radius, grid, 1 );
    wisp_range_search_job job = {
        .x = grid->x,
        .y = grid->y,
        .z = grid->z,
        .owner = grid->owner,
        .cell_begin = grid->cell_begin,
        .reach = { count_cells( radius, grid, grid->fine ), reach, reach },
        .near_radius = query->near_radius,
        .shell_radius = query->shell_radius,
        .limit = query->limit,
        .quads = query->quads,
        .planar = grid->planar,
    };
    memcpy( job.origin, grid->origin, sizeof( job.origin ) );
    memcpy( job.inverse_cell, grid->inverse_cell, sizeof( job.inverse_cell ) );
    memcpy( job.dims, grid->dims, sizeof( job.dims ) );
    memcpy( job.axis, grid->axis, sizeof( job.axis ) );
    return job;
}

// Empty a pool for the next try.
static void empty( neighbour_pool* pool, int32_t* entries, size_t capacity )
{
    pool->entries = entries;
    pool->capacity = capacity;
    atomic_store( &pool->used, 0 );
}

// The first search measures, the second fills; warm buffers need one.
static wisp_status search_until_it_fits( neighbour_search* s, const wisp_parallel* parallel, int slices,
                                         wisp_buffer* near, wisp_buffer* shell )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    const size_t entry = WISP_SLICE * sizeof( int32_t );
    for ( ;; )
    {
        empty( &s->near, near->data, near->size / entry );
        empty( &s->shell, shell->data, shell->size / entry );
        atomic_store( &s->capped, 0 );
        wisp_parallel_for( parallel, slices, NEIGHBOURS_GRAIN, search_slices, s );
        if ( atomic_load( &s->starved ) )
        {
            return WISP_NO_MEMORY;
        }
        size_t near_used = atomic_load( &s->near.used ), shell_used = atomic_load( &s->shell.used );
        if ( near_used <= s->near.capacity && shell_used <= s->shell.capacity )
        {
            return WISP_OK;
        }
        if ( near_used > INT32_MAX || shell_used > INT32_MAX ||
             wisp_buffer_reserve( near, allocator, near_used * entry ) == false ||
             wisp_buffer_reserve( shell, allocator, shell_used * entry ) == false )
        {
            return WISP_NO_MEMORY;
        }
    }
}

wisp_status wisp_neighbours_build( wisp_neighbours* neighbours, const wisp_parallel* parallel,
                                   const wisp_kernels* kernels, const wisp_grid* grid,
                                   const wisp_neighbour_query* query )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    int slices = query->query_count / WISP_SLICE + ( query->query_count % WISP_SLICE > 0 ? 1 : 0 );
    size_t list = (size_t)query->limit + WISP_SEARCH_SLACK;
    wisp_buffer* places = neighbours->buffers;
    if ( wisp_buffer_reserve( places, allocator, 4 * (size_t)slices * sizeof( int32_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    int32_t* place = places->data;
    neighbour_search s = {
        .kernels = kernels,
        .job = make_job( grid, query ),
        .rename = query->rename,
        .query_count = query->query_count,
        .near = { .begin = place, .length = place + slices },
        .shell = { .begin = place + 2 * (size_t)slices, .length = place + 3 * (size_t)slices },
        .parallel = parallel,
        .list = list,
    };
    wisp_status status =
        search_until_it_fits( &s, parallel, slices, neighbours->buffers + 1, neighbours->buffers + 2 );
    if ( status != WISP_OK )
    {
        return status;
    }
    neighbours->slice_count = slices;
    neighbours->near = ( wisp_neighbour_list ){ s.near.begin, s.near.length, s.near.entries };
    neighbours->shell = ( wisp_neighbour_list ){ s.shell.begin, s.shell.length, s.shell.entries };
    neighbours->near_entries = atomic_load( &s.near.used );
    neighbours->shell_entries = atomic_load( &s.shell.used );
    neighbours->capped = atomic_load( &s.capped );
    return WISP_OK;
}
