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

// What the blocks of a search share. Blocks take room for their entries as they come, so where a list lies depends on
// chance; what it holds does not, and nothing reads anything but its own list.
typedef struct neighbour_search
{
    const wisp_kernels* kernels;
    wisp_range_search_job job;
    int query_count;
    int32_t *slice_begin, *slice_length, *entries;
    int32_t* scratch;
    size_t scratch_stride; // ints a worker
    size_t capacity;       // entries
    _Atomic size_t used;
    _Atomic uint64_t capped;
} neighbour_search;

static void search_slices( void* context, int begin, int end, int worker )
{
    neighbour_search* s = context;
    int32_t* packed = s->scratch + (size_t)worker * s->scratch_stride;
    int32_t* lists = packed + s->scratch_stride / 2;
    int capped = 0;
    for ( int slice = begin; slice < end; ++slice )
    {
        int left = s->query_count - slice * WISP_SLICE;
        int length = s->kernels->range_search( &s->job, slice, left < WISP_SLICE ? left : WISP_SLICE, packed, lists,
                                               &capped );
        size_t at = atomic_fetch_add_explicit( &s->used, (size_t)length, memory_order_relaxed );
        s->slice_begin[slice] = (int32_t)at;
        s->slice_length[slice] = length;
        if ( at + (size_t)length <= s->capacity )
        {
            memcpy( s->entries + at * WISP_SLICE, packed, (size_t)length * WISP_SLICE * sizeof( int32_t ) );
        }
    }
    atomic_fetch_add_explicit( &s->capped, (uint64_t)capped, memory_order_relaxed );
}

static wisp_range_search_job make_job( const wisp_grid* grid, const wisp_neighbour_query* query )
{
    // as many cells to each side as a neighbour may be away, rounding included
    float cells = ( query->radius + grid->slack ) / grid->cell;
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
        .reach = cells < 1e6f ? (int)ceilf( cells ) : 1000000,
        .radius = query->radius,
        .limit = query->limit,
        .quads = query->quads,
    };
    return job;
}

wisp_status wisp_neighbours_build( wisp_neighbours* neighbours, const wisp_parallel* parallel,
                                   const wisp_kernels* kernels, const wisp_grid* grid, const wisp_neighbour_query* query )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( parallel );
    int slices = query->query_count / WISP_SLICE + ( query->query_count % WISP_SLICE > 0 ? 1 : 0 );
    size_t list = (size_t)( query->limit + WISP_SLICE ) * WISP_SLICE;
    size_t workers = (size_t)wisp_parallel_workers( parallel );
    wisp_buffer* b = neighbours->buffers;
    if ( wisp_buffer_reserve( b + 0, allocator, (size_t)slices * sizeof( int32_t ) ) == false ||
         wisp_buffer_reserve( b + 1, allocator, (size_t)slices * sizeof( int32_t ) ) == false ||
         wisp_buffer_reserve( b + 2, allocator, 2 * list * workers * sizeof( int32_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    neighbour_search s = {
        .kernels = kernels,
        .job = make_job( grid, query ),
        .query_count = query->query_count,
        .slice_begin = b[0].data,
        .slice_length = b[1].data,
        .scratch = b[2].data,
        .scratch_stride = 2 * list,
    };
    for ( ;; )
    {
        s.entries = b[3].data;
        s.capacity = b[3].size / ( WISP_SLICE * sizeof( int32_t ) );
        atomic_store( &s.used, 0 );
        atomic_store( &s.capped, 0 );
        wisp_parallel_for( parallel, slices, NEIGHBOURS_GRAIN, search_slices, &s );
        size_t used = atomic_load( &s.used );
        if ( used <= s.capacity )
        {
            break;
        }
        // the first search measures, the second fills; a warm buffer needs one
        if ( used > INT32_MAX ||
             wisp_buffer_reserve( b + 3, allocator, used * WISP_SLICE * sizeof( int32_t ) ) == false )
        {
            return WISP_NO_MEMORY;
        }
    }
    neighbours->slice_count = slices;
    neighbours->slice_begin = s.slice_begin;
    neighbours->slice_length = s.slice_length;
    neighbours->entries = s.entries;
    neighbours->entry_count = atomic_load( &s.used );
    neighbours->capped = atomic_load( &s.capped );
    return WISP_OK;
}
