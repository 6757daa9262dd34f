// Waves. Worker 0 is the thread that steps and drives; the others, the thread team, wait for waves. A wave is a list
// of blocks, cut into one contiguous range per worker so that a worker gets the same data in every wave. A worker
// that finishes early takes blocks of the others, including those that have not started. Results never depend on
// which worker runs a block.
//
// Teams belong to the process, and a step takes one that no other step has. So a hundred worlds that step in turn have
// one team, and worlds that step side by side one each. With a team a world, those between steps spin on the cores of
// the one that steps.
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
    size_t of_any; // bytes, the most that a block took which any worker may run
    int depth;
} jobs_scratch;

// A thread team and its wave. A late member reads nothing else, so the world of an old wave may be gone.
typedef struct jobs_team
{
    jobs_range ranges[WISP_MAX_WORKERS];
    _Alignas( 64 ) _Atomic uint32_t epoch;
    _Alignas( 64 ) _Atomic int pending;
    jobs_pool* pool; // that the wave is of
    wisp_block_fn* run;
    void* context;
    int first; // block of the wave
    int workers;
    _Atomic bool taken;
    jobs_thread_team threads;
} jobs_team;

enum
{
    JOBS_TEAMS = 16, // more steps at the same time than this run on their own threads alone
};

static jobs_team teams[JOBS_TEAMS];
static _Atomic int pools_with_teams; // the last one to go ends all threads

struct jobs_pool
{
    int workers;
    jobs_team* team; // null outside of jobs_enter()
    wisp_block_fn* run;
    void* context;
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

// Run a block of a wave, and note what it takes above what its worker has in use.
static void run_shared( jobs_pool* pool, wisp_block_fn* run, void* context, int block, int worker )
{
    jobs_scratch* scratch = pool->scratch + worker;
    const size_t before = scratch->arena.high_water, used = scratch->arena.requested;
    scratch->arena.high_water = used;
    run_scoped( pool, run, context, block, worker );
    const size_t most = scratch->arena.high_water;
    scratch->of_any = most - used > scratch->of_any ? most - used : scratch->of_any;
    base_arena_expect( &scratch->arena, before );
}

// Any worker may run such a block next time, so each has scratch memory for it: a repeated step allocates nothing.
static void level_scratch( jobs_pool* pool )
{
    size_t most = 0;
    for ( int i = 0; i < pool->workers; ++i )
    {
        most = pool->scratch[i].of_any > most ? pool->scratch[i].of_any : most;
    }
    for ( int i = 0; i < pool->workers; ++i )
    {
        jobs_scratch* scratch = pool->scratch + i;
        base_arena_expect( &scratch->arena, most );
        base_arena_reset( &scratch->arena );
        // what the host cannot give is forgotten
        scratch->of_any = scratch->of_any < scratch->arena.high_water ? scratch->of_any : scratch->arena.high_water;
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

static void work( jobs_team* team, uint32_t epoch, int worker )
{
    // own range first, then the neighbours' in turn
    for ( int i = 0; i < team->workers; ++i )
    {
        jobs_range* range = team->ranges + ( worker + i ) % team->workers;
        for ( int block = take( range, epoch ); block >= 0; block = take( range, epoch ) )
        {
            // A block was taken, so the wave cannot end before it is done: run and context are this wave's.
            run_shared( team->pool, team->run, team->context, team->first + block, worker );
            atomic_fetch_sub_explicit( &team->pending, 1, memory_order_release );
        }
    }
}

// Body of a member of the thread team.
static void stand_by( void* context, int member )
{
    jobs_team* team = context;
    uint32_t epoch = 0;
    for ( int idle = 0;; )
    {
        uint32_t now = atomic_load_explicit( &team->epoch, memory_order_acquire );
        if ( now != epoch )
        {
            epoch = now;
            idle = 0;
            work( team, epoch, member + 1 );
        }
        else if ( thread_team_rest( &team->threads, &idle ) == false )
        {
            return;
        }
    }
}

static bool try_to_take( jobs_team* team )
{
    return atomic_load( &team->taken ) == false && atomic_exchange( &team->taken, true ) == false;
}

// Take a team that no step has: one with as many workers, or else one without threads, or else any, whose threads end.
// @return null if there is none
static jobs_team* take_team( int workers )
{
    for ( int pass = 0; pass < 3 * JOBS_TEAMS; ++pass )
    {
        jobs_team* team = teams + pass % JOBS_TEAMS;
        if ( try_to_take( team ) == false )
        {
            continue;
        }
        const int had = team->workers;
        const bool fits = pass >= 2 * JOBS_TEAMS || had == ( pass < JOBS_TEAMS ? workers : 0 );
        if ( fits && had != workers )
        {
            had > 0 ? thread_team_release( &team->threads ) : (void)0;
            team->workers = thread_team_init( &team->threads, workers - 1, stand_by, team ) ? workers : 0;
        }
        if ( fits && team->workers == workers )
        {
            return team;
        }
        atomic_store( &team->taken, false );
    }
    return NULL;
}

static void end_teams( void )
{
    for ( jobs_team* team = teams; team < teams + JOBS_TEAMS; ++team )
    {
        if ( try_to_take( team ) )
        {
            team->workers > 0 ? thread_team_release( &team->threads ) : (void)0;
            team->workers = 0;
            atomic_store( &team->taken, false );
        }
    }
}

static bool has_team( const jobs_pool* pool )
{
    return pool->workers > 1 && pool->host == NULL;
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
    atomic_fetch_add( &pools_with_teams, has_team( pool ) ? 1 : 0 );
    return pool;
}

void jobs_destroy( jobs_pool* pool )
{
    if ( pool != NULL )
    {
        if ( has_team( pool ) && atomic_fetch_sub( &pools_with_teams, 1 ) == 1 )
        {
            end_teams();
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
    jobs_team* team = has_team( pool ) ? take_team( pool->workers ) : NULL;
    const bool has_threads = team == NULL || thread_team_call( &team->threads );
    pool->team = team;
    driver( context );
    pool->team = NULL;
    if ( team != NULL )
    {
        thread_team_dismiss( &team->threads );
        atomic_store( &team->taken, false );
    }
    level_scratch( pool );
    return has_threads;
}

// Callback of a host's own loop.
static void run_host_block( void* context, int block, int worker )
{
    jobs_pool* pool = context;
    run_shared( pool, pool->run, pool->context, block, worker );
}

void jobs_run_inline( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context )
{
    for ( int block = 0; block < block_count; ++block )
    {
        run_scoped( pool, run, context, block, 0 );
    }
}

// Run blocks [first, first + block_count) on all workers.
static void run_part( jobs_team* team, int first, int block_count )
{
    uint32_t epoch = atomic_load_explicit( &team->epoch, memory_order_relaxed ) + 1;
    team->first = first;
    atomic_store_explicit( &team->pending, block_count, memory_order_relaxed );
    for ( int i = 0; i < team->workers; ++i )
    {
        int begin = (int)( (int64_t)block_count * i / team->workers );
        int end = (int)( (int64_t)block_count * ( i + 1 ) / team->workers );
        atomic_store_explicit( &team->ranges[i].word, pack( epoch, begin, end ), memory_order_release );
    }
    atomic_store_explicit( &team->epoch, epoch, memory_order_release );

    work( team, epoch, 0 );
    for ( int idle = 0; atomic_load_explicit( &team->pending, memory_order_acquire ) > 0; )
    {
        thread_team_wait( &idle );
    }
}

void jobs_run_wave( jobs_pool* pool, int block_count, wisp_block_fn* run, void* context )
{
    jobs_team* team = pool->team;
    if ( block_count <= 1 || ( pool->host == NULL && team == NULL ) )
    {
        for ( int block = 0; block < block_count; ++block )
        {
            ( pool->workers > 1 ? run_shared : run_scoped )( pool, run, context, block, 0 );
        }
        return;
    }
    if ( pool->host != NULL )
    {
        pool->run = run;
        pool->context = context;
        pool->host( pool->host_user, block_count, run_host_block, pool );
        return;
    }
    team->pool = pool;
    team->run = run;
    team->context = context;
    for ( int64_t first = 0; first < block_count; first += JOBS_BLOCK_MASK ) // as many as a range can count
    {
        const int left = block_count - (int)first;
        run_part( team, (int)first, left < JOBS_BLOCK_MASK ? left : JOBS_BLOCK_MASK );
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
