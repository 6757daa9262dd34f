// Execution of waves: every block once, one block per worker at a time, the same cut for every number of workers.
// Workers only count; the thread of the test checks the counts.
#include "support.h"

#include "jobs.h"

#include <pthread.h>

static const int WORKER_COUNTS[] = { 1, 2, 3, 5, 8, 64 };
static const int WAVE_SIZES[] = { 0, 1, 2, 7, 1000, 100000 };

enum
{
    MAX_BLOCKS = 100000,
    HOST_THREADS = 3,
};

// ---- a host with threads of its own ----

typedef struct thread_host
{
    int calls;
    int max_blocks_of_a_call;
    // of the running call
    wisp_block_fn* run;
    void* context;
    int block_count;
    _Atomic int next;
} thread_host;

typedef struct host_thread
{
    thread_host* host;
    int worker;
} host_thread;

static void* run_host_thread( void* user )
{
    host_thread* thread = user;
    thread_host* host = thread->host;
    for ( int b = atomic_fetch_add( &host->next, 1 ); b < host->block_count; b = atomic_fetch_add( &host->next, 1 ) )
    {
        host->run( host->context, b, thread->worker );
    }
    return NULL;
}

static void thread_host_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    thread_host* host = user;
    host->calls += 1;
    host->max_blocks_of_a_call = block_count > host->max_blocks_of_a_call ? block_count : host->max_blocks_of_a_call;
    host->run = run;
    host->context = context;
    host->block_count = block_count;
    atomic_store( &host->next, 0 );
    host_thread threads[HOST_THREADS];
    pthread_t ids[HOST_THREADS];
    for ( int i = 1; i < HOST_THREADS; ++i )
    {
        threads[i] = ( host_thread ){ host, i };
        pthread_create( ids + i, NULL, run_host_thread, threads + i );
    }
    threads[0] = ( host_thread ){ host, 0 };
    run_host_thread( threads );
    for ( int i = 1; i < HOST_THREADS; ++i )
    {
        pthread_join( ids[i], NULL );
    }
}

// ---- waves with counters ----

typedef struct counted_wave
{
    jobs_pool* pool;
    int* runs; // [block]; two workers on one block would be a race, and a wrong count
    _Atomic int busy[WISP_MAX_WORKERS];
    _Atomic int strangers; // blocks on a worker number that does not exist
    _Atomic int meetings;  // blocks that began while another one ran under the same number
    int wrong_counts;      // blocks that did not run exactly once
    int waves;
    int seed;
} counted_wave;

static void count_block( void* context, int block, int worker )
{
    counted_wave* wave = context;
    if ( worker < 0 || worker >= jobs_workers( wave->pool ) )
    {
        atomic_fetch_add( &wave->strangers, 1 );
        return;
    }
    atomic_fetch_add( &wave->meetings, atomic_exchange( wave->busy + worker, 1 ) );
    wave->runs[block] += 1;
    atomic_store( wave->busy + worker, 0 );
}

static void count_waves( void* context )
{
    counted_wave* wave = context;
    for ( int w = 0; w < wave->waves; ++w )
    {
        int size = WAVE_SIZES[test_random( wave->seed, w, WISP_COUNT( WAVE_SIZES ) )];
        memset( wave->runs, 0, MAX_BLOCKS * sizeof( int ) );
        jobs_run_wave( wave->pool, size, count_block, wave );
        for ( int b = 0; b < MAX_BLOCKS; ++b )
        {
            wave->wrong_counts += wave->runs[b] != ( b < size ? 1 : 0 ) ? 1 : 0;
        }
    }
}

static counted_wave run_counted_waves( int workers, wisp_parallel_for_fn* host, void* host_user, int waves )
{
    counted_wave wave = { .pool = jobs_create( NULL, workers, host, host_user ), .waves = waves, .seed = workers };
    wave.runs = calloc( MAX_BLOCKS, sizeof( int ) );
    assert_non_null( wave.pool );
    assert_non_null( wave.runs );
    jobs_enter( wave.pool, count_waves, &wave );
    free( wave.runs );
    jobs_destroy( wave.pool );
    return wave;
}

// ---- blocks ----

TEST( every_block_of_a_wave_runs_exactly_once )
{
    for ( int i = 0; i < WISP_COUNT( WORKER_COUNTS ); ++i )
    {
        assert_int_equal( run_counted_waves( WORKER_COUNTS[i], NULL, NULL, 60 ).wrong_counts, 0 );
    }
}

TEST( no_two_blocks_run_under_one_worker_number_at_once )
{
    for ( int i = 0; i < WISP_COUNT( WORKER_COUNTS ); ++i )
    {
        counted_wave wave = run_counted_waves( WORKER_COUNTS[i], NULL, NULL, 60 );
        assert_int_equal( wave.strangers, 0 );
        assert_int_equal( wave.meetings, 0 );
    }
}

TEST( a_host_with_threads_runs_every_block_once_and_one_a_worker )
{
    thread_host host = { 0 };
    counted_wave wave = run_counted_waves( HOST_THREADS, thread_host_parallel_for, &host, 60 );
    assert_int_equal( wave.wrong_counts, 0 );
    assert_int_equal( wave.strangers, 0 );
    assert_int_equal( wave.meetings, 0 );
}

// Waves around the largest one that is not run in parts.
static void run_large_waves( void* context )
{
    counted_wave* wave = context;
    enum
    {
        PART = ( 1 << 20 ) - 1
    };
    for ( int size = PART - 1; size <= PART + 1; ++size )
    {
        memset( wave->runs, 0, ( PART + 1 ) * sizeof( int ) );
        jobs_run_wave( wave->pool, size, count_block, wave );
        for ( int b = 0; b < size; ++b )
        {
            wave->wrong_counts += wave->runs[b] != 1 ? 1 : 0;
        }
    }
}

TEST( waves_of_a_million_blocks_run_every_block_once )
{
    counted_wave wave = { .pool = jobs_create( NULL, 3, NULL, NULL ), .runs = calloc( 1 << 20, sizeof( int ) ) };
    assert_non_null( wave.runs );
    jobs_enter( wave.pool, run_large_waves, &wave );
    free( wave.runs );
    jobs_destroy( wave.pool );
    assert_int_equal( wave.wrong_counts, 0 );
}

// The first blocks wait for each other: on one worker neither would end.
typedef struct meeting
{
    _Atomic int arrived;
    _Atomic int given_up;
    jobs_pool* pool;
    int blocks;
} meeting;

static void meet( void* context, int block, int worker )
{
    (void)block, (void)worker;
    meeting* m = context;
    atomic_fetch_add( &m->arrived, 1 );
    double begin = wisp_clock_seconds();
    while ( atomic_load( &m->arrived ) < 2 && wisp_clock_seconds() - begin < 20.0 )
    {
    }
    atomic_fetch_add( &m->given_up, atomic_load( &m->arrived ) < 2 ? 1 : 0 );
}

static void run_meeting( void* context )
{
    meeting* m = context;
    jobs_run_wave( m->pool, m->blocks, meet, m );
}

TEST( two_workers_run_blocks_at_the_same_time )
{
    const int blocks[] = { 2, 1 << 20 }; // the latter in two parts
    for ( int i = 0; i < WISP_COUNT( blocks ); ++i )
    {
        meeting m = { .pool = jobs_create( NULL, 2, NULL, NULL ), .blocks = blocks[i] };
        jobs_enter( m.pool, run_meeting, &m );
        jobs_destroy( m.pool );
        assert_int_equal( m.given_up, 0 );
    }
}

// ---- waves ----

enum
{
    CHAIN_BLOCKS = 997, // prime, so that a stride reaches every block
    CHAIN_WAVES = 300,
};

// Plain memory: only the end of a wave orders its writes before the next wave's reads.
typedef struct chain
{
    jobs_pool* pool;
    int values[2][CHAIN_BLOCKS];
    int from;
} chain;

static void add_one( void* context, int block, int worker )
{
    (void)worker;
    chain* c = context;
    c->values[1 - c->from][block] = c->values[c->from][( block * 31 + 5 ) % CHAIN_BLOCKS] + 1;
}

static void run_chain( void* context )
{
    chain* c = context;
    for ( int w = 0; w < CHAIN_WAVES; ++w )
    {
        jobs_run_wave( c->pool, CHAIN_BLOCKS, add_one, c );
        c->from = 1 - c->from;
    }
}

TEST( a_wave_sees_what_the_wave_before_wrote )
{
    for ( int i = 0; i < WISP_COUNT( WORKER_COUNTS ); ++i )
    {
        chain* c = checked_calloc( 1, sizeof( chain ) );
        c->pool = jobs_create( NULL, WORKER_COUNTS[i], NULL, NULL );
        jobs_enter( c->pool, run_chain, c );
        int wrong = 0;
        for ( int b = 0; b < CHAIN_BLOCKS; ++b )
        {
            wrong += c->values[c->from][b] != CHAIN_WAVES ? 1 : 0;
        }
        jobs_destroy( c->pool );
        free( c );
        assert_int_equal( wrong, 0 );
    }
}

TEST( a_pool_is_entered_a_thousand_times )
{
    chain* c = checked_calloc( 1, sizeof( chain ) );
    c->pool = jobs_create( NULL, 3, NULL, NULL );
    for ( int i = 0; i < 1000; ++i )
    {
        meeting m = { .pool = c->pool, .arrived = 2, .blocks = 2 };
        jobs_enter( c->pool, run_meeting, &m );
        c->values[0][0] += atomic_load( &m.arrived ) == 4 ? 1 : 0;
    }
    int complete = c->values[0][0];
    jobs_destroy( c->pool );
    free( c );
    assert_int_equal( complete, 1000 );
}

TEST( a_wave_outside_an_entered_pool_runs_on_the_caller )
{
    counted_wave wave = { .pool = jobs_create( NULL, 3, NULL, NULL ), .waves = 20, .seed = 1 };
    wave.runs = checked_calloc( MAX_BLOCKS, sizeof( int ) );
    count_waves( &wave );
    free( wave.runs );
    jobs_destroy( wave.pool );
    assert_int_equal( wave.wrong_counts, 0 );
}

static void run_three_waves( void* context )
{
    counted_wave* wave = context;
    jobs_run_wave( wave->pool, 2, count_block, wave );
    jobs_run_wave( wave->pool, 1000, count_block, wave );
    jobs_run_wave( wave->pool, 7, count_block, wave );
}

TEST( a_host_is_called_once_a_wave )
{
    thread_host host = { 0 };
    counted_wave wave = { .pool = jobs_create( NULL, HOST_THREADS, thread_host_parallel_for, &host ) };
    wave.runs = checked_calloc( MAX_BLOCKS, sizeof( int ) );
    jobs_enter( wave.pool, run_three_waves, &wave );
    free( wave.runs );
    jobs_destroy( wave.pool );
    assert_int_equal( host.calls, 3 );
    assert_int_equal( host.max_blocks_of_a_call, 1000 );
}

// ---- loops ----

enum
{
    LOOP_MAX_BLOCKS = 1200,
};

typedef struct loop_cut
{
    const wisp_parallel* parallel;
    int count, grain;
    int begin[LOOP_MAX_BLOCKS], end[LOOP_MAX_BLOCKS], calls[LOOP_MAX_BLOCKS];
    _Atomic int outside;
    _Atomic int workers_used[WISP_MAX_WORKERS];
} loop_cut;

static void note_range( void* context, int begin, int end, int worker )
{
    loop_cut* cut = context;
    int block = begin / cut->grain;
    if ( begin < 0 || end > cut->count || block >= LOOP_MAX_BLOCKS )
    {
        atomic_fetch_add( &cut->outside, 1 );
        return;
    }
    cut->begin[block] = begin;
    cut->end[block] = end;
    cut->calls[block] += 1;
    atomic_fetch_add( cut->workers_used + worker, 1 );
}

static void run_loop( void* context )
{
    loop_cut* cut = context;
    wisp_parallel_for( cut->parallel, cut->count, cut->grain, note_range, cut );
}

static void assert_cut_is_fixed( const loop_cut* cut )
{
    assert_int_equal( cut->outside, 0 );
    for ( int b = 0; b < LOOP_MAX_BLOCKS; ++b )
    {
        int begin = b * cut->grain, end = begin + cut->grain < cut->count ? begin + cut->grain : cut->count;
        assert_int_equal( cut->calls[b], begin < cut->count ? 1 : 0 );
        assert_int_equal( cut->calls[b] == 0 || ( cut->begin[b] == begin && cut->end[b] == end ), 1 );
    }
}

static const struct
{
    int count, grain;
} LOOPS[] = { { 0, 1 }, { 1, 1 }, { 1, 100 }, { 99, 100 }, { 100, 100 }, { 101, 100 }, { 1000, 7 }, { 1193, 1 } };

TEST( a_loop_is_cut_alike_for_every_number_of_workers )
{
    for ( int i = 0; i < WISP_COUNT( WORKER_COUNTS ); ++i )
    {
        jobs_pool* pool = jobs_create( NULL, WORKER_COUNTS[i], NULL, NULL );
        for ( int k = 0; k < WISP_COUNT( LOOPS ); ++k )
        {
            loop_cut cut = { .parallel = jobs_everyone( pool ), .count = LOOPS[k].count, .grain = LOOPS[k].grain };
            jobs_enter( pool, run_loop, &cut );
            assert_cut_is_fixed( &cut );
        }
        jobs_destroy( pool );
    }
}

TEST( a_loop_on_a_hosts_threads_is_cut_the_same_way )
{
    thread_host host = { 0 };
    jobs_pool* pool = jobs_create( NULL, HOST_THREADS, thread_host_parallel_for, &host );
    for ( int k = 0; k < WISP_COUNT( LOOPS ); ++k )
    {
        loop_cut cut = { .parallel = jobs_everyone( pool ), .count = LOOPS[k].count, .grain = LOOPS[k].grain };
        jobs_enter( pool, run_loop, &cut );
        assert_cut_is_fixed( &cut );
    }
    jobs_destroy( pool );
}

TEST( a_loop_of_one_worker_alone_keeps_its_number_and_the_cut )
{
    jobs_pool* pool = jobs_create( NULL, 5, NULL, NULL );
    loop_cut cut = { .parallel = jobs_alone( pool, 3 ), .count = 1000, .grain = 7 };
    jobs_enter( pool, run_loop, &cut );
    jobs_destroy( pool );
    assert_cut_is_fixed( &cut );
    assert_int_equal( cut.workers_used[3], 143 ); // ceil( 1000 / 7 )
}

TEST( a_loop_may_end_at_the_largest_number )
{
    jobs_pool* pool = jobs_create( NULL, 2, NULL, NULL );
    loop_cut cut = { .parallel = jobs_everyone( pool ), .count = INT32_MAX, .grain = 1 << 30 };
    jobs_enter( pool, run_loop, &cut );
    jobs_destroy( pool );
    assert_int_equal( cut.calls[0], 1 );
    assert_int_equal( cut.calls[1], 1 );
    assert_int_equal( cut.end[1], INT32_MAX );
}

// ---- scratch ----

enum
{
    SCRATCH_BYTES = 10000,
    SCRATCH_BLOCKS = 500,
};

typedef struct scratch_use
{
    jobs_pool* pool;
    const wisp_parallel* parallel;
    int blocks;
    _Atomic int missing;    // pieces that were null
    _Atomic int misaligned; // or not aligned to a cache line
    _Atomic int damaged;    // or changed while their block ran
} scratch_use;

// Two pieces per block, filled with the worker's mark; a piece shared with another worker would have the other mark.
static void use_scratch( void* context, int block, int worker )
{
    scratch_use* use = context;
    unsigned char* primitives[2];
    for ( int i = 0; i < 2; ++i )
    {
        primitives[i] = wisp_parallel_scratch( use->parallel, worker, SCRATCH_BYTES );
        atomic_fetch_add( &use->missing, primitives[i] == NULL ? 1 : 0 );
        atomic_fetch_add( &use->misaligned, (uintptr_t)primitives[i] % 64 != 0 ? 1 : 0 );
        if ( primitives[i] != NULL )
        {
            memset( primitives[i], ( 2 * block + i ) % 251, SCRATCH_BYTES );
        }
    }
    for ( int k = 0; k < 2 * SCRATCH_BYTES && primitives[0] != NULL && primitives[1] != NULL; ++k )
    {
        bool same = primitives[k / SCRATCH_BYTES][k % SCRATCH_BYTES] == ( 2 * block + k / SCRATCH_BYTES ) % 251;
        atomic_fetch_add( &use->damaged, same ? 0 : 1 );
    }
}

static void run_scratch_use( void* context )
{
    scratch_use* use = context;
    jobs_run_wave( use->pool, use->blocks, use_scratch, use );
}

static void enter_scratch_use( scratch_use* use, jobs_pool* pool, int blocks )
{
    *use = ( scratch_use ){ .pool = pool, .parallel = jobs_everyone( pool ), .blocks = blocks };
    jobs_enter( pool, run_scratch_use, use );
}

TEST( a_block_has_its_scratch_for_itself )
{
    for ( int i = 0; i < WISP_COUNT( WORKER_COUNTS ); ++i )
    {
        jobs_pool* pool = jobs_create( NULL, WORKER_COUNTS[i], NULL, NULL );
        scratch_use use;
        enter_scratch_use( &use, pool, SCRATCH_BLOCKS );
        jobs_destroy( pool );
        assert_int_equal( use.missing, 0 );
        assert_int_equal( use.misaligned, 0 );
        assert_int_equal( use.damaged, 0 );
    }
}

TEST( warm_scratch_costs_nothing_whoever_warmed_it )
{
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    jobs_pool* pool = jobs_create( &allocator, 3, NULL, NULL );
    scratch_use use;
    enter_scratch_use( &use, pool, 1 ); // a lone block runs on the caller
    int64_t queried = atomic_load( &host.queried );
    for ( int i = 0; i < 20; ++i )
    {
        enter_scratch_use( &use, pool, SCRATCH_BLOCKS );
        assert_int_equal( use.missing + use.damaged, 0 );
    }
    assert_int_equal( atomic_load( &host.queried ), queried );
    jobs_destroy( pool );
    assert_host_memory_is_released( &host );
}

static void run_scratch_inline( void* context )
{
    scratch_use* use = context;
    jobs_run_inline( use->pool, use->blocks, use_scratch, use );
}

TEST( what_the_calling_thread_takes_is_not_kept_for_others )
{
    jobs_pool* pool = jobs_create( NULL, 3, NULL, NULL );
    scratch_use use = { .pool = pool, .parallel = jobs_everyone( pool ), .blocks = 2 };
    size_t of_pool = 0;
    jobs_enter( pool, run_scratch_inline, &use );
    assert_in_range( jobs_memory( pool, &of_pool ), 2 * SCRATCH_BYTES, 3 * SCRATCH_BYTES );
    jobs_destroy( pool );
}

TEST( scratch_without_memory_is_null_and_returns_with_it )
{
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    jobs_pool* pool = jobs_create( &allocator, 2, NULL, NULL );
    scratch_use use;
    test_host_refuse( &host, 1, true );
    enter_scratch_use( &use, pool, SCRATCH_BLOCKS );
    assert_int_equal( use.missing, 2 * SCRATCH_BLOCKS );
    test_host_refuse( &host, 0, false );
    enter_scratch_use( &use, pool, SCRATCH_BLOCKS );
    assert_int_equal( use.missing + use.damaged, 0 );
    jobs_destroy( pool );
    assert_host_memory_is_released( &host );
}

// ---- pools ----

TEST( a_pool_knows_its_workers_and_its_memory )
{
    test_host host = { 0 };
    wisp_allocator allocator = test_host_allocator( &host );
    jobs_pool* pool = jobs_create( &allocator, 5, NULL, NULL );
    assert_non_null( pool );
    assert_int_equal( jobs_workers( pool ), 5 );
    assert_ptr_equal( wisp_parallel_allocator( jobs_alone( pool, 4 ) ), &allocator );
    jobs_destroy( pool );
    assert_host_memory_is_released( &host );
}

TEST( a_pool_without_memory_is_null )
{
    test_host host = { .refuse = 1, .refuse_rest = true };
    wisp_allocator allocator = test_host_allocator( &host );
    assert_null( jobs_create( &allocator, 2, NULL, NULL ) );
    jobs_destroy( NULL );
    assert_host_memory_is_released( &host );
}

TEST( a_default_number_of_workers_is_one_that_a_world_takes )
{
    assert_in_range( jobs_default_workers(), 1, WISP_MAX_WORKERS );
}
