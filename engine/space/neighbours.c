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
    int query_count;
    neighbour_pool near, shell;
    const wisp_parallel* parallel;
    size_t list; // ints of a packed list
    _Atomic uint64_t capped;
    _Atomic bool starved;
} neighbour_search;

enum
{
    NEIGHBOURS_SCRATCH_LISTS = 4, // near and shell, packed; both again, a list a query
};

static void keep( neighbour_pool* pool, int slice, const int32_t* packed, int length )
{
    size_t at = atomic_fetch_add_explicit( &pool->used, (size_t)length, memory_order_relaxed );
    pool->begin[slice] = (int32_t)at;
    pool->length[slice] = length;
    if ( at + (size_t)length <= pool->capacity && length > 0 )
    {
        memcpy( pool->entries + at * WISP_SLICE, packed, (size_t)length * WISP_SLICE * sizeof( int32_t ) );
    }
}

static void search_slices( void* context, int begin, int end, int worker )
{
    neighbour_search* s = context;
    int32_t* scratch =
        wisp_parallel_scratch( s->parallel, worker, NEIGHBOURS_SCRATCH_LISTS * s->list * sizeof( int32_t ) );
    if ( scratch == NULL )
    {
        atomic_store( &s->starved, true );
        return;
    }
    wisp_range_search_result found = { .near = scratch,
                                       .shell = scratch + s->list,
                                       .scratch = scratch + 2 * s->list };
    for ( int slice = begin; slice < end; ++slice )
    {
        int left = s->query_count - slice * WISP_SLICE;
        s->kernels->range_search( &s->job, slice, left < WISP_SLICE ? left : WISP_SLICE, &found );
        keep( &s->near, slice, found.near, found.near_length );
        keep( &s->shell, slice, found.shell, found.shell_length );
    }
    atomic_fetch_add_explicit( &s->capped, (uint64_t)found.capped, memory_order_relaxed );
}

static wisp_range_search_job make_job( const wisp_grid* grid, const wisp_neighbour_query* query )
{
    // as many cells to each side as a neighbour may be away, rounding included
    float radius = query->shell_radius > query->near_radius ? query->shell_radius : query->near_radius;
    float cells = ( radius + grid->slack ) / grid->cell;
    wisp_range_search_job job = {
        .x = grid->x,
        .y = grid->y,
        .z = grid->z,
        .owner = grid->owner,
        .rename = query->rename,
        .cell_begin = grid->cell_begin,
        .origin = { grid->origin[0], grid->origin[1], grid->origin[2] },
        .inverse_cell = grid->inverse_cell,
        .dims = { grid->dims[0], grid->dims[1], grid->dims[2] },
        .axis = { grid->axis[0], grid->axis[1], grid->axis[2] },
        .reach = cells < 1e6f ? (int)ceilf( cells ) : 1000000,
        .near_radius = query->near_radius,
        .shell_radius = query->shell_radius,
        .limit = query->limit,
        .quads = query->quads,
        .planar = grid->planar,
    };
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
    size_t list = (size_t)( query->limit + WISP_SEARCH_SLACK ) * WISP_SLICE;
    wisp_buffer* places = neighbours->buffers;
    if ( wisp_buffer_reserve( places, allocator, 4 * (size_t)slices * sizeof( int32_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    int32_t* place = places->data;
    neighbour_search s = {
        .kernels = kernels,
        .job = make_job( grid, query ),
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
