// Waves. Worker 0 is the thread that steps and drives; the others, the thread team, wait for waves. A wave is a list
// of blocks, cut into one contiguous range per worker so that a worker gets the same data in every wave. A worker
// that finishes early takes blocks of the others, including those that have not started. Results never depend on
// which worker runs a block.
#include "jobs.h"

#include "arena.h"
#include "thread_team.h"

#include <stdatomic.h>
#include <string.h>

struct wisp_parallel
{
    jobs_pool* pool;
    int worker;
    bool alone;
};

// Epoch, next block and end of a worker's range in one word. The epoch makes a late thief of an old wave fail its
// exchange instead of taking a block of the new one.
enum
{
    JOBS_BLOCK_BITS = 20,
    JOBS_BLOCK_MASK = ( 1 << JOBS_BLOCK_BITS ) - 1,
    JOBS_EPOCH_MASK = ( 1 << ( 64 - 2 * JOBS_BLOCK_BITS ) ) - 1,
};

typedef struct jobs_range
{
    _Alignas( 64 ) _Atomic uint64_t word;
} jobs_range;

// Scratch memory of a worker, and how many blocks deep it is in one.
typedef struct jobs_scratch
{
    _Alignas( 64 ) base_arena arena;
    int depth;
} jobs_scratch;

struct jobs_pool
{
    jobs_range ranges[WISP_MAX_WORKERS];
    _Alignas( 64 ) _Atomic uint32_t epoch;
    _Alignas( 64 ) _Atomic int pending;
    wisp_block_fn* run;
    void* context;
    int first; // block of the wave
    int workers;
    bool has_thread_team;
    bool inside; // the thread team stands by
    jobs_thread_team thread_team;
    wisp_parallel_for_fn* host;
    void* host_user;
    const wisp_allocator* allocator;
    wisp_parallel everyone;
    wisp_parallel alone[WISP_MAX_WORKERS];
    jobs_scratch scratch[WISP_MAX_WORKERS];
};

static uint64_t pack( uint32_t epoch, int next, int end )
{
    return (uint64_t)( epoch & JOBS_EPOCH_MASK ) << ( 2 * JOBS_BLOCK_BITS ) | (uint64_t)next << JOBS_BLOCK_BITS |
           (uint64_t)end;
}

int jobs_workers( const jobs_pool* pool )
{
    return pool->workers;
}

size_t jobs_memory( const jobs_pool* pool, size_t* pool_bytes )
{
    size_t bytes = 0;
    for ( int i = 0; i < WISP_MAX_WORKERS; ++i )
    {
        bytes += base_arena_bytes( &pool->scratch[i].arena );
    }
    *pool_bytes += sizeof( *pool );
    return bytes;
}

int jobs_default_workers( void )
{
    const int count = thread_team_cores();
    return count < 1 ? 1 : ( count > WISP_MAX_WORKERS ? WISP_MAX_WORKERS : count );
}

// A block's scratch memory is released when it ends. Between outermost blocks the arena may grow to the requested
// size.
static void run_scoped( jobs_pool* pool, wisp_block_fn* run, void* context, int block, int worker )
{
    jobs_scratch* scratch = pool->scratch + worker;
    base_arena_mark mark = base_arena_get_mark( &scratch->arena );
    scratch->depth += 1;
    run( context, block, worker );
    scratch->depth -= 1;
    if ( scratch->depth == 0 )
    {
        base_arena_reset( &scratch->arena );
    }
    else
    {
        base_arena_rewind( &scratch->arena, mark );
    }
}

// Any worker may run a block next time, so each needs the same scratch capacity: a repeated step allocates nothing.
static void level_scratch( jobs_pool* pool )
{
    size_t most = 0;
    for ( int i = 0; i < pool->workers; ++i )
    {
        size_t upper = pool->scratch[i].arena.high_water;
        most = upper > most ? upper : most;
    }
    for ( int i = 0; i < pool->workers; ++i )
    {
        base_arena_expect( &pool->scratch[i].arena, most );
        base_arena_reset( &pool->scratch[i].arena );
    }
}

void* wisp_parallel_scratch( const wisp_parallel* parallel, int worker, size_t bytes )
{
    return base_arena_push( &parallel->pool->scratch[worker].arena, bytes, 64 );
}

// Take a block of one worker's range, or -1 if this wave has none left there.
static int take( jobs_range* range, uint32_t epoch )
{
    uint64_t word = atomic_load_explicit( &range->word, memory_order_acquire );
    for ( ;; )
    {
        int next = (int)( word >> JOBS_BLOCK_BITS ) & JOBS_BLOCK_MASK;
        int end = (int)word & JOBS_BLOCK_MASK;
        if ( word >> ( 2 * JOBS_BLOCK_BITS ) != ( epoch & JOBS_EPOCH_MASK ) || next >= end )
        {
            return -1;
        }
        if ( atomic_compare_exchange_weak_explicit( &range->word, &word, pack( epoch, next + 1, end ),
                                                    memory_order_acq_rel, memory_order_acquire ) )
        {
            return next;
        }
    }
}

static void work( jobs_pool* pool, uint32_t epoch, int worker )
{
    // own range first, then the neighbours' in turn
    for ( int i = 0; i < pool->workers; ++i )
    {
        jobs_range* range = pool->ranges + ( worker + i ) % pool->workers;
        for ( int block = take( range, epoch ); block >= 0; block = take( range, epoch ) )
        {
            // A block was taken, so the wave cannot end before it is done: run and context are this wave's.
            run_scoped( pool, pool->run, pool->context, pool->first + block, worker );
            atomic_fetch_sub_explicit( &pool->pending, 1, memory_order_release );
        }
    }
}

// Body of a member of the thread team.
static void stand_by( void* context, int member )
{
    jobs_pool* pool = context;
    uint32_t epoch = 0;
    for ( int idle = 0;; )
    {
        uint32_t now = atomic_load_explicit( &pool->epoch, memory_order_acquire );
        if ( now != epoch )
        {
            epoch = now;
            idle = 0;
            work( pool, epoch, member + 1 );
        }
        else if ( thread_team_rest( &pool->thread_team, &idle ) == false )
        {
            return;
        }
    }
}

jobs_pool* jobs_create( const wisp_allocator* allocator, int workers, wisp_parallel_for_fn* host, void* host_user )
{
    jobs_pool* pool = base_allocate( allocator, sizeof( jobs_pool ), 64 );
    if ( pool == NULL )
    {
        return NULL;
    }
    memset( (void*)pool, 0, sizeof( *pool ) );
    pool->workers = workers;
    pool->host = host;
    pool->host_user = host_user;
    pool->allocator = allocator;
    pool->everyone = ( wisp_parallel ){ .pool = pool };
    for ( int i = 0; i < WISP_MAX_WORKERS; ++i )
    {
        pool->alone[i] = ( wisp_parallel ){ .pool = pool, .worker = i, .alone = true };
        base_arena_init( &pool->scratch[i].arena, allocator, 0 );
    }
    pool->has_thread_team = workers > 1 && host == NULL;
    if ( pool->has_thread_team && thread_team_init( &pool->thread_team, workers - 1, stand_by, pool ) == false )
    {
        base_release( allocator, pool, sizeof( *pool ) );
        return NULL;
    }
    return pool;
}

void jobs_destroy( jobs_pool* pool )
{
    if ( pool != NULL )
    {
        if ( pool->has_thread_team )
        {
            thread_team_release( &pool->thread_team );
        }
        for ( int i = 0; i < WISP_MAX_WORKERS; ++i )
        {
            base_arena_release( &pool->scratch[i].arena );
        }
        base_release( pool->allocator, pool, sizeof( *pool ) );
    }
}

bool jobs_enter( jobs_pool* pool, void ( *driver )( void* context ), void* context )
{
    if ( pool->has_thread_team == false )
    {
        driver( context );
        level_scratch( pool );
        return true;
    }
    const bool has_threads = thread_team_call( &pool->thread_team );
    pool->inside = true;
    driver( context );
    pool->inside = false;
    thread_team_dismiss( &pool->thread_team );
    level_scratch( pool );
    return has_threads;
}

// Callback of a host's own loop.
static void run_host_block( void* context, int block, int worker )
{
    jobs_pool* pool = context;
    run_scoped( pool, pool->run, pool->context, block, worker );
}

void jobs_run_inline( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context )
{
    for ( int block = 0; block < block_count; ++block )
    {
        run_scoped( pool, run, context, block, 0 );
    }
}

// Run blocks [first, first + block_count) on all workers.
static void run_part( jobs_pool* pool, int first, int block_count )
{
    uint32_t epoch = atomic_load_explicit( &pool->epoch, memory_order_relaxed ) + 1;
    pool->first = first;
    atomic_store_explicit( &pool->pending, block_count, memory_order_relaxed );
    for ( int i = 0; i < pool->workers; ++i )
    {
        int begin = (int)( (int64_t)block_count * i / pool->workers );
        int end = (int)( (int64_t)block_count * ( i + 1 ) / pool->workers );
        atomic_store_explicit( &pool->ranges[i].word, pack( epoch, begin, end ), memory_order_release );
    }
    atomic_store_explicit( &pool->epoch, epoch, memory_order_release );

    work( pool, epoch, 0 );
    for ( int idle = 0; atomic_load_explicit( &pool->pending, memory_order_acquire ) > 0; )
    {
        thread_team_wait( &idle );
    }
}

void jobs_run_wave( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context )
{
    if ( block_count <= 1 || ( pool->host == NULL && pool->inside == false ) )
    {
        jobs_run_inline( pool, block_count, run, context );
        return;
    }
    pool->run = run;
    pool->context = context;
    if ( pool->host != NULL )
    {
        pool->host( pool->host_user, block_count, run_host_block, pool );
        return;
    }
    for ( int64_t first = 0; first < block_count; first += JOBS_BLOCK_MASK ) // as many as a range can count
    {
        const int left = block_count - (int)first;
        run_part( pool, (int)first, left < JOBS_BLOCK_MASK ? left : JOBS_BLOCK_MASK );
    }
}

void jobs_run_within( jobs_pool* pool, int block, wisp_block_fn* run, void* context, int worker )
{
    run_scoped( pool, run, context, block, worker );
}

const wisp_parallel* jobs_everyone( const jobs_pool* pool )
{
    return &pool->everyone;
}

const wisp_parallel* jobs_alone( const jobs_pool* pool, int worker )
{
    return pool->alone + worker;
}

const wisp_allocator* wisp_parallel_allocator( const wisp_parallel* parallel )
{
    return parallel->pool->allocator;
}

typedef struct jobs_loop
{
    wisp_range_fn* run;
    void* context;
    int count, grain;
} jobs_loop;

static void run_loop_block( void* context, int block, int worker )
{
    const jobs_loop* loop = context;
    int begin = block * loop->grain;
    int end = loop->count - begin > loop->grain ? begin + loop->grain : loop->count;
    loop->run( loop->context, begin, end, worker );
}

void wisp_parallel_for( const wisp_parallel* parallel, int count, int grain, wisp_range_fn* run, void* context )
{
    WISP_ASSERT( grain > 0 );
    jobs_loop loop = { run, context, count, grain };
    int block_count = count / grain + ( count % grain > 0 ? 1 : 0 );
    if ( parallel->alone == false )
    {
        jobs_run_wave( parallel->pool, block_count, run_loop_block, &loop );
        return;
    }
    for ( int block = 0; block < block_count; ++block )
    {
        run_scoped( parallel->pool, run_loop_block, &loop, block, parallel->worker );
    }
}
