#include "wisp/module/definition.h"
#include "wisp/module/space.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum
{
    NEIGHBOURS_SLICES = 8, // slices per block
};

size_t wisp_neighbours_bytes( const wisp_neighbours* neighbours )
{
    return wisp_buffer_bytes( neighbours->buffers, WISP_COUNT( neighbours->buffers ) );
}

void wisp_neighbours_release( wisp_neighbours* neighbours, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( neighbours->buffers ); ++i )
    {
        wisp_buffer_release( neighbours->buffers + i, allocator );
    }
    *neighbours = ( wisp_neighbours ){ 0 };
}

// Data that blocks write while others read the search. It has its own cache line to avoid false sharing.
typedef struct neighbour_counts
{
    _Alignas( 64 ) _Atomic size_t entries;
    _Atomic uint64_t capped;
    _Atomic bool starved;
} neighbour_counts;

// Data shared by the blocks of a search.
typedef struct neighbour_search
{
    const wisp_kernels* kernels;
    const wisp_parallel* parallel;
    const wisp_neighbour_query* query;
    wisp_range_search_args args;
    int32_t *begin, *near_length, *length; // [slice]
    int32_t* near_count;                   // [slice][8]
    int32_t* entries;
    size_t capacity; // entries
    neighbour_counts* counts;
} neighbour_search;

// Memory of a worker: lists as the search writes them, and interleaved lists of a block.
typedef struct neighbour_scratch
{
    int32_t *lists, *skin, *packed;
    int stride; // ints from one query's list to the next
} neighbour_scratch;

static bool take_scratch( const neighbour_search* s, int worker, neighbour_scratch* out )
{
    const size_t limit = (size_t)s->query->limit, stride = 2 * limit + WISP_SEARCH_PADDING;
    const size_t lists = WISP_SLICE * stride, skin = WISP_SLICE * ( limit + WISP_SEARCH_PADDING );
    const size_t packed = NEIGHBOURS_SLICES * WISP_SLICE * 2 * limit;
    int32_t* ints = wisp_parallel_scratch( s->parallel, worker, ( lists + skin + packed ) * sizeof( int32_t ) );
    *out = ( neighbour_scratch ){ ints, ints + lists, ints + lists + skin, (int)stride };
    return ints != NULL;
}

// Searches a block.
// @return number of entries of all its slices, stored one after the other in `packed`
static size_t search_slices( neighbour_search* s, const neighbour_scratch* scratch, int begin, int end )
{
    wisp_range_search_result found = { .lists = scratch->lists, .skin = scratch->skin };
    size_t entries = 0;
    for ( int slice = begin; slice < end; ++slice )
    {
        int left = s->query->query_count - slice * WISP_SLICE;
        s->kernels->range_search( &s->args, slice, left < WISP_SLICE ? left : WISP_SLICE, &found );
        s->kernels->interleave( found.lists, scratch->stride, found.count, slice, s->query->rename,
                                scratch->packed + entries * WISP_SLICE );
        memcpy( s->near_count + (size_t)slice * WISP_SLICE, found.near_count, sizeof( found.near_count ) );
        s->near_length[slice] = found.near_length;
        s->length[slice] = found.length;
        entries += (size_t)found.length;
    }
    if ( found.capped > 0 )
    {
        atomic_fetch_add_explicit( &s->counts->capped, (uint64_t)found.capped, memory_order_relaxed );
    }
    return entries;
}

// Copies the lists of a block. Space is reserved in order of completion, so the position of a list depends on
// timing. Its contents do not, and readers access only their own list.
static void search_block( void* context, int begin, int end, int worker )
{
    neighbour_search* s = context;
    neighbour_scratch scratch;
    if ( take_scratch( s, worker, &scratch ) == false )
    {
        atomic_store( &s->counts->starved, true );
        return;
    }
    const size_t entries = search_slices( s, &scratch, begin, end );
    size_t at = atomic_fetch_add_explicit( &s->counts->entries, entries, memory_order_relaxed );
    if ( at + entries > s->capacity )
    {
        return;
    }
    // one copy per slice: a single large copy is slow in some C libraries
    const int32_t* packed = scratch.packed;
    for ( int slice = begin; slice < end; ++slice )
    {
        const size_t ints = (size_t)s->length[slice] * WISP_SLICE;
        s->begin[slice] = (int32_t)at;
        if ( ints > 0 ) // without neighbours there is no destination
        {
            memcpy( s->entries + at * WISP_SLICE, packed, ints * sizeof( int32_t ) );
        }
        packed += ints;
        at += (size_t)s->length[slice];
    }
}

// Computes the number of cells to search on each side, with a margin for rounding.
static int count_cells( float radius, const wisp_grid* grid, int fine )
{
    float cells = ( radius + grid->rounding_margin ) * (float)fine / grid->cell;
    return cells < 1e6f ? (int)ceilf( cells ) : 1000000;
}

static wisp_range_search_args make_args( const wisp_grid* grid, const wisp_neighbour_query* query )
{
    float radius = query->skin_radius > query->near_radius ? query->skin_radius : query->near_radius;
    const int reach = count_cells( radius, grid, 1 );
    wisp_range_search_args args = {
        .x = grid->x,
        .y = grid->y,
        .z = grid->z,
        .owner = grid->owner,
        .cell_begin = grid->cell_begin,
        .cell_reach = { count_cells( radius, grid, grid->subdivisions ), reach, reach },
        .near_radius = query->near_radius,
        .skin_radius = query->skin_radius,
        .limit = query->limit,
        .xyzw = query->xyzw,
        .planar = grid->planar,
    };
    memcpy( args.origin, grid->origin, sizeof( args.origin ) );
    memcpy( args.inverse_cell, grid->inverse_cell, sizeof( args.inverse_cell ) );
    memcpy( args.dims, grid->dims, sizeof( args.dims ) );
    memcpy( args.axis, grid->axis, sizeof( args.axis ) );
    return args;
}

// Searches. The first pass measures and the second fills; if the buffers are large enough, one suffices.
static wisp_status search_until_it_fits( neighbour_search* s, int slices, wisp_buffer* entries )
{
    const size_t entry = WISP_SLICE * sizeof( int32_t );
    for ( ;; )
    {
        s->entries = entries->data;
        s->capacity = entries->size / entry;
        atomic_store( &s->counts->entries, 0 );
        atomic_store( &s->counts->capped, 0 );
        wisp_parallel_for( s->parallel, slices, NEIGHBOURS_SLICES, search_block, s );
        if ( atomic_load( &s->counts->starved ) )
        {
            return WISP_NO_MEMORY;
        }
        size_t used = atomic_load( &s->counts->entries );
        if ( used <= s->capacity )
        {
            return WISP_OK;
        }
        if ( used > INT32_MAX ||
             wisp_buffer_reserve( entries, wisp_parallel_allocator( s->parallel ), used * entry ) == false )
        {
            return WISP_NO_MEMORY;
        }
    }
}

wisp_status wisp_neighbours_build( wisp_neighbours* neighbours, const wisp_parallel* parallel,
                                   const wisp_kernels* kernels, const wisp_grid* grid,
                                   const wisp_neighbour_query* query )
{
    const int slices = query->query_count / WISP_SLICE + ( query->query_count % WISP_SLICE > 0 ? 1 : 0 );
    const size_t rows = (size_t)slices;
    wisp_buffer* places = neighbours->buffers;
    if ( wisp_buffer_reserve( places, wisp_parallel_allocator( parallel ),
                              rows * ( 3 + WISP_SLICE ) * sizeof( int32_t ) ) == false )
    {
        return WISP_NO_MEMORY;
    }
    int32_t* place = places->data;
    neighbour_counts counts = { 0 };
    neighbour_search s = {
        .kernels = kernels,
        .parallel = parallel,
        .query = query,
        .args = make_args( grid, query ),
        .begin = place,
        .near_length = place + rows,
        .length = place + 2 * rows,
        .near_count = place + 3 * rows,
        .counts = &counts,
    };
    WISP_TRY( search_until_it_fits( &s, slices, neighbours->buffers + 1 ) );
    neighbours->slice_count = slices;
    neighbours->near = ( wisp_neighbour_list ){ s.begin, s.near_length, s.entries };
    neighbours->all = ( wisp_neighbour_list ){ s.begin, s.length, s.entries };
    neighbours->near_count = s.near_count;
    neighbours->entries = atomic_load( &counts.entries );
    neighbours->capped = atomic_load( &counts.capped );
    return WISP_OK;
}
