// Overlapping pairs of boxes. Blocks of queries append their lists to a pool; the lists are then
// joined in the order of the queries.
#include "box_search.h"

#include "alloc.h"

#include "wisp/module/definition.h"

#include <string.h>

enum
{
    QUERIES_GRAIN = 128,
    JOIN_GRAIN = 1024,
    POOL_CHUNK = 1024,                                           // entries that a block reserves at a time
    MAX_WAITING = 32,                                            // lists waiting to be sorted
    ROOM_SHARED = WISP_MAX_SHARED_AABBS + 2 * BOX_FOUND_PADDING, // entries per list where several queries run at once
    ROOM_WAITING = 128,                                          // entries per waiting list, on average
    MAX_RANKED = 96,                                             // longer lists are sorted faster by radix sort
    MAX_INSERTED = 24,
    DIGIT = 8,
    DIGITS = 1 << DIGIT,
};

enum
{
    BUFFER_BEGIN,
    BUFFER_ITEM,
    BUFFER_POOL,
    BUFFER_PLACE,
    BUFFER_GRID,                     // and the three after it
    BUFFER_COOKIE = BUFFER_GRID + 4, // the grid itself, reused by later calls
};

// Entries of lists. The position of a list depends on timing; its contents and the total size do not.
typedef struct pair_pool
{
    int32_t* entries;
    size_t capacity;
    _Atomic size_t used;
} pair_pool;

// Data shared by the blocks of a search.
typedef struct pair_search
{
    const wisp_aabb_args* args;
    const wisp_parallel* parallel;
    const wisp_aabb* queries;
    int query_count;
    box_grid grid;
    const int32_t* order; // of the queries; null: as given
    int order_count;
    pair_pool pool;
    size_t* place;  // [query] start of its list in the pool
    int32_t* begin; // [query + 1] while searching: length of the previous query's list
    int32_t* item;
    _Atomic uint64_t tested;
    _Atomic bool starved;
} pair_search;

// ---- sorting ----

static void order_by_insertion( const int32_t* items, int count, int32_t* out )
{
    for ( int i = 0; i < count; ++i )
    {
        int32_t item = items[i];
        int at = i;
        for ( ; at > 0 && out[at - 1] > item; --at )
        {
            out[at] = out[at - 1];
        }
        out[at] = item;
    }
}

// Radix sort, lowest digit first. Items and scratch alternate, and the last pass writes to `out`.
static void order_by_digits( int32_t* items, int count, int32_t below, int32_t* scratch, int32_t* out )
{
    int32_t *from = items, *to = scratch;
    for ( int shift = 0; shift < 32; shift += DIGIT )
    {
        bool is_last = shift + DIGIT >= 31 || below >> ( shift + DIGIT ) == 0;
        int32_t* target = is_last ? out : to;
        int32_t begin[DIGITS + 1] = { 0 };
        for ( int i = 0; i < count; ++i )
        {
            ++begin[( from[i] >> shift & ( DIGITS - 1 ) ) + 1];
        }
        for ( int d = 0; d < DIGITS; ++d )
        {
            begin[d + 1] += begin[d];
        }
        for ( int i = 0; i < count; ++i )
        {
            target[begin[from[i] >> shift & ( DIGITS - 1 )]++] = from[i];
        }
        if ( is_last )
        {
            return;
        }
        to = from;
        from = target;
    }
}

static void sort_list( const pair_search* s, int32_t* items, int count, int32_t* scratch, int32_t* out )
{
    const wisp_kernels* kernels = s->args->kernels;
    if ( kernels != NULL && count <= MAX_RANKED )
    {
        kernels->sort_items( items, count, out );
    }
    else if ( count <= MAX_INSERTED )
    {
        order_by_insertion( items, count, out );
    }
    else
    {
        order_by_digits( items, count, s->args->box_count, scratch, out );
    }
}

// ---- queries ----

typedef struct pool_chunk
{
    size_t at, end;
} pool_chunk;

// Reserves a list, possibly beyond the capacity of the pool.
static size_t reserve_entries( pair_pool* pool, pool_chunk* chunk, size_t count )
{
    if ( chunk->end - chunk->at < count + BOX_FOUND_PADDING )
    {
        size_t size = count + BOX_FOUND_PADDING > POOL_CHUNK ? count + BOX_FOUND_PADDING : POOL_CHUNK;
        chunk->at = atomic_fetch_add_explicit( &pool->used, size, memory_order_relaxed );
        chunk->end = chunk->at + size;
    }
    size_t at = chunk->at;
    chunk->at += count;
    return at;
}

// A list that waits to be sorted.
typedef struct found_list
{
    int32_t* items;
    int query, count;
} found_list;

// State of one block of a search. Lists are sorted some time after they were found. The sorting method depends on
// the length, so sorting at once would stall on a mispredicted branch.
typedef struct pair_block
{
    pair_search* search;
    int32_t* area;    // memory of waiting lists
    int32_t* next;    // start of the next list
    int32_t* full;    // no list may start at or beyond this
    int32_t* scratch; // for sorting
    pool_chunk chunk;
    box_question question;
    int waiting_count;
    found_list waiting[MAX_WAITING + WISP_SLICE];
} pair_block;

static void filter_list( pair_block* b, found_list* list )
{
    const wisp_aabb_args* args = b->search->args;
    if ( args->filter != NULL && list->count > 0 )
    {
        list->count = args->filter( args->filter_context, list->query, list->items, list->count );
    }
}

static void keep_lists( pair_block* b )
{
    pair_search* s = b->search;
    for ( int i = 0; i < b->waiting_count; ++i )
    {
        found_list* list = b->waiting + i;
        filter_list( b, list );
        size_t count = (size_t)list->count, at = reserve_entries( &s->pool, &b->chunk, count );
        if ( at + count + BOX_FOUND_PADDING <= s->pool.capacity )
        {
            sort_list( s, list->items, list->count, b->scratch, s->pool.entries + at );
        }
        s->place[list->query] = at;
        s->begin[list->query + 1] = list->count;
    }
    b->waiting_count = 0;
    b->next = b->area;
}

// Runs several queries at once.
// @return false if the grid needs them one by one
static bool query_together( pair_block* b, const int32_t* queries, int count )
{
    const pair_search* s = b->search;
    box_question* q = &b->question;
    const bool is_self = s->args->queries == NULL;
    q->group.count = count;
    q->group.found[0] = b->next;
    for ( int l = 0; l < count; ++l )
    {
        memcpy( q->group.box[l], s->queries + queries[l], sizeof( wisp_aabb ) );
        q->group.above[l] = is_self ? queries[l] : -1;
        q->group.found_count[l] = 0;
    }
    if ( !box_grid_find( &s->grid, q ) )
    {
        return false;
    }
    for ( int l = 0; l < count; ++l )
    {
        found_list list = { q->group.found[l], queries[l], q->group.found_count[l] };
        b->next = list.items + list.count + BOX_FOUND_PADDING;
        b->waiting[b->waiting_count++] = list;
    }
    return true;
}

static void query_group( pair_block* b, const int32_t* queries, int count )
{
    bool is_done = query_together( b, queries, count );
    for ( int l = 0; l < count && !is_done; ++l )
    {
        query_together( b, queries + l, 1 );
        if ( b->next >= b->full )
        {
            keep_lists( b );
        }
    }
    if ( b->next >= b->full || b->waiting_count >= MAX_WAITING )
    {
        keep_lists( b );
    }
}

static int find_group_end( const pair_search* s, int first, int end )
{
    int last = first + 1;
    if ( s->order != NULL )
    {
        // boxes of one cell visit the same cells
        const int32_t* cell_of = s->grid.cell_of;
        const int32_t cell = cell_of[s->order[first]];
        end = end < first + WISP_SLICE ? end : first + WISP_SLICE;
        while ( last < end && cell_of[s->order[last]] == cell )
        {
            ++last;
        }
    }
    return last;
}

static void search_queries( void* context, int begin, int end, int worker )
{
    pair_search* s = context;
    pair_block b = { .search = s };
    const size_t boxes = (size_t)s->args->box_count + 2 * BOX_FOUND_PADDING, shared = WISP_SLICE * ROOM_SHARED;
    const size_t room = boxes > shared ? boxes : shared, area = room + MAX_WAITING * ROOM_WAITING;
    b.area = b.next = wisp_parallel_scratch( s->parallel, worker, ( area + boxes ) * sizeof( int32_t ) );
    if ( b.area == NULL )
    {
        atomic_store( &s->starved, true );
        return;
    }
    b.full = b.area + ( area - room );
    b.scratch = b.area + area;
    for ( int i = begin, last; i < end; i = last )
    {
        last = find_group_end( s, i, end );
        if ( s->order != NULL )
        {
            query_group( &b, s->order + i, last - i );
        }
        else if ( box_is_valid( s->queries + i ) )
        {
            query_group( &b, &( int32_t ){ i }, 1 );
        }
    }
    keep_lists( &b );
    atomic_fetch_add_explicit( &s->tested, b.question.tested, memory_order_relaxed );
}

// ---- joining lists ----

static void join_lists( void* context, int begin, int end, int worker )
{
    (void)worker;
    const pair_search* s = context;
    for ( int first = begin, last; first < end; first = last )
    {
        // consecutive lists are copied together
        size_t place = s->place[first];
        size_t count = (size_t)( s->begin[first + 1] - s->begin[first] );
        for ( last = first + 1; last < end && s->place[last] == place + count; ++last )
        {
            count += (size_t)( s->begin[last + 1] - s->begin[last] );
        }
        if ( count > 0 )
        {
            memcpy( s->item + s->begin[first], s->pool.entries + place, count * sizeof( int32_t ) );
        }
    }
}

static uint64_t count_pairs( const pair_search* s )
{
    uint64_t pairs = 0;
    for ( int i = 0; i < s->query_count; ++i )
    {
        pairs += (uint64_t)s->begin[i + 1];
    }
    return pairs;
}

static wisp_status search_once( pair_search* s, wisp_buffer* pool )
{
    s->pool.entries = pool->data;
    s->pool.capacity = pool->size / sizeof( int32_t );
    atomic_store( &s->pool.used, 0 );
    atomic_store( &s->tested, 0 );
    // boxes without a query have no list
    memset( s->begin, 0, ( (size_t)s->query_count + 1 ) * sizeof( int32_t ) );
    for ( int i = 0; i < s->query_count; ++i )
    {
        s->place[i] = 0;
    }
    wisp_parallel_for( s->parallel, s->order_count, QUERIES_GRAIN, search_queries, s );
    return atomic_load( &s->starved ) ? WISP_NO_MEMORY : WISP_OK;
}

static wisp_status check_limit( const wisp_aabb_args* args, uint64_t pairs, wisp_error* error )
{
    uint64_t limit = args->limit > 0 && args->limit < INT32_MAX ? args->limit : INT32_MAX;
    if ( pairs > limit )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "boxes: got %llu overlapping pairs, expected at most %llu",
                          (unsigned long long)pairs, (unsigned long long)limit );
    }
    return WISP_OK;
}

static wisp_status fail_memory( const wisp_aabb_args* args, wisp_error* error )
{
    return wisp_fail( error, WISP_NO_MEMORY, "out of memory to find pairs among %d boxes", args->box_count );
}

// Joins the lists. The first search measures and the second fills; if the buffers are large enough, one suffices.
static wisp_status search_pairs_until_they_fit( pair_search* s, wisp_aabb_pairs* pairs, wisp_error* error )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( s->parallel );
    wisp_buffer* pool = pairs->buffers + BUFFER_POOL;
    uint64_t count = 0;
    for ( bool fits = false; !fits; )
    {
        if ( search_once( s, pool ) != WISP_OK )
        {
            return fail_memory( s->args, error );
        }
        count = count_pairs( s );
        WISP_TRY( check_limit( s->args, count, error ) );
        size_t used = atomic_load( &s->pool.used );
        fits = used <= s->pool.capacity;
        if ( !fits && !wisp_buffer_reserve( pool, allocator, used * sizeof( int32_t ) ) )
        {
            return fail_memory( s->args, error );
        }
    }
    if ( !wisp_buffer_reserve( pairs->buffers + BUFFER_ITEM, allocator, (size_t)count * sizeof( int32_t ) ) )
    {
        return fail_memory( s->args, error );
    }
    s->item = pairs->buffers[BUFFER_ITEM].data;
    for ( int i = 0; i < s->query_count; ++i )
    {
        s->begin[i + 1] += s->begin[i];
    }
    wisp_parallel_for( s->parallel, s->query_count, JOIN_GRAIN, join_lists, s );
    pairs->pair_count = (size_t)count;
    return WISP_OK;
}

// ---- complete search ----

static bool make_grid( pair_search* s, wisp_aabb_pairs* pairs, const wisp_allocator* allocator )
{
    wisp_buffer* made = pairs->buffers + BUFFER_COOKIE;
    if ( s->args->reuse )
    {
        WISP_ASSERT( made->data != NULL && s->args->queries != NULL );
        memcpy( &s->grid, made->data, sizeof( s->grid ) );
        return true;
    }
    if ( wisp_buffer_reserve( made, allocator, sizeof( s->grid ) ) == false ||
         box_grid_build( &s->grid, pairs->buffers + BUFFER_GRID, s->parallel, s->args ) != WISP_OK )
    {
        return false;
    }
    memcpy( made->data, &s->grid, sizeof( s->grid ) );
    return true;
}

static wisp_status prepare_pairs( pair_search* s, wisp_aabb_pairs* pairs, wisp_error* error )
{
    const wisp_allocator* allocator = wisp_parallel_allocator( s->parallel );
    const size_t count = (size_t)s->query_count;
    if ( !wisp_buffer_reserve( pairs->buffers + BUFFER_BEGIN, allocator, ( count + 1 ) * sizeof( int32_t ) ) ||
         !wisp_buffer_reserve( pairs->buffers + BUFFER_PLACE, allocator, count * sizeof( size_t ) ) )
    {
        return fail_memory( s->args, error );
    }
    s->begin = pairs->buffers[BUFFER_BEGIN].data;
    s->place = pairs->buffers[BUFFER_PLACE].data;
    s->order_count = s->query_count;
    if ( make_grid( s, pairs, allocator ) == false )
    {
        return fail_memory( s->args, error );
    }
    if ( s->args->queries == NULL )
    {
        // queries that are the boxes themselves run in slot order, since their neighbours are then in cache
        s->order = s->grid.stream.item;
        s->order_count = s->grid.slot_count;
    }
    return WISP_OK;
}

static void forget( wisp_aabb_pairs* pairs )
{
    pairs->query_count = 0;
    pairs->pair_count = 0;
    pairs->begin = NULL;
    pairs->item = NULL;
    pairs->tested = 0;
}

wisp_status wisp_aabb_pairs_find( wisp_aabb_pairs* pairs, const wisp_parallel* parallel, const wisp_aabb_args* args,
                                  wisp_error* error )
{
    WISP_ASSERT( args->box_count >= 0 && ( args->queries == NULL || args->query_count >= 0 ) );
    pair_search s = {
        .args = args,
        .parallel = parallel,
        .queries = args->queries != NULL ? args->queries : args->boxes,
        .query_count = args->queries != NULL ? args->query_count : args->box_count,
    };
    forget( pairs );
    WISP_TRY( prepare_pairs( &s, pairs, error ) );
    WISP_TRY( search_pairs_until_they_fit( &s, pairs, error ) );
    pairs->query_count = s.query_count;
    pairs->begin = s.begin;
    pairs->item = s.item;
    pairs->tested = atomic_load( &s.tested );
    return WISP_OK;
}

void wisp_aabb_pairs_release( wisp_aabb_pairs* pairs, const wisp_allocator* allocator )
{
    for ( int i = 0; i < WISP_COUNT( pairs->buffers ); ++i )
    {
        wisp_buffer_release( pairs->buffers + i, allocator );
    }
    *pairs = ( wisp_aabb_pairs ){ 0 };
}

size_t wisp_aabb_pairs_bytes( const wisp_aabb_pairs* pairs )
{
    return wisp_buffer_bytes( pairs->buffers, WISP_COUNT( pairs->buffers ) );
}
