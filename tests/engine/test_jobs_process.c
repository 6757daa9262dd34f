// Threads and processes: no thread is started unless requested, and a process without threads may fork. This program
// starts workers in its children only.
#include "support.h"

#include "jobs.h"

#include <dirent.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <sys/wait.h>
#include <unistd.h>

enum
{
    HOST_WORKERS = 3,
};

static void serial_host_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    (void)user;
    for ( int b = block_count - 1; b >= 0; --b )
    {
        run( context, b, b % HOST_WORKERS );
    }
}

static int thread_count( void )
{
    FILE* status = fopen( "/proc/self/status", "r" );
    char line[256];
    int count = -1;
    while ( status != NULL && fgets( line, sizeof( line ), status ) != NULL )
    {
        count = strncmp( line, "Threads:", 8 ) == 0 ? atoi( line + 8 ) : count;
    }
    if ( status != NULL )
    {
        fclose( status );
    }
    return count;
}

// Run in a child and return its exit status; a child that hangs is ended by its alarm.
static int exit_of_child( int ( *run )( void ) )
{
    fflush( NULL );
    pid_t child = fork();
    assert_true( child >= 0 );
    if ( child == 0 )
    {
        alarm( 60 );
        _exit( run() );
    }
    int status = 0;
    assert_int_equal( waitpid( child, &status, 0 ), child );
    return WIFEXITED( status ) ? WEXITSTATUS( status ) : 128 + WTERMSIG( status );
}

static void watch_threads( void* context, int block, int worker )
{
    (void)block, (void)worker;
    int now = thread_count(), *most = context;
    *most = now > *most ? now : *most;
}

typedef struct watched_waves
{
    jobs_pool* pool;
    int max_threads;
} watched_waves;

static void run_watched_waves( void* context )
{
    watched_waves* watched = context;
    for ( int i = 0; i < 20; ++i )
    {
        jobs_run_wave( watched->pool, 50, watch_threads, &watched->max_threads );
    }
}

static int max_threads( int workers, wisp_parallel_for_fn* host, void* host_user )
{
    watched_waves watched = { jobs_create( NULL, workers, host, host_user ), 0 };
    jobs_enter( watched.pool, run_watched_waves, &watched );
    jobs_destroy( watched.pool );
    int after = thread_count();
    return after > watched.max_threads ? after : watched.max_threads;
}

static int threads_of_one_worker( void )
{
    return max_threads( 1, NULL, NULL );
}

static int threads_of_a_host( void )
{
    return max_threads( HOST_WORKERS, serial_host_parallel_for, NULL );
}

static int threads_of_two_workers( void )
{
    return max_threads( 2, NULL, NULL );
}

TEST( one_worker_never_starts_a_thread )
{
    assert_int_equal( exit_of_child( threads_of_one_worker ), 1 );
}

TEST( a_hosts_own_loop_never_starts_a_thread_of_ours )
{
    assert_int_equal( exit_of_child( threads_of_a_host ), 1 );
}

TEST( two_workers_are_two_threads )
{
    assert_int_equal( exit_of_child( threads_of_two_workers ), 2 );
}

// Hash of strands after a step with this number of workers; 0 after a failure.
static uint64_t hash_after_a_step( int workers )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = workers;
    SCOPED( destroy_local ) wisp_world* world = NULL;
    uint64_t hash = 0;
    if ( wisp_world_create( &def, &world, NULL ) == WISP_OK )
    {
        wisp_entity strands = test_add_strands( world, 500, 8 );
        bool stepped = wisp_request( world, strands, WISP_STRAND_POINTS ) == WISP_OK;
        stepped = stepped && wisp_world_step( world, 0.01f ) == WISP_OK;
        hash = stepped ? wisp_world_hash( world ) : 0;
    }
    return hash;
}

static uint64_t hash_of_parent;

static int step_with_three_workers( void )
{
    return hash_after_a_step( 3 ) == hash_of_parent ? 0 : 1;
}

TEST( a_process_that_ran_one_worker_may_fork_and_its_child_may_run_three )
{
    hash_of_parent = hash_after_a_step( 1 );
    assert_true( hash_of_parent != 0 );

    assert_int_equal( exit_of_child( step_with_three_workers ), 0 );
}

// ---- between steps ----

// Sleeping threads of this process.
static int sleeping_threads( void )
{
    DIR* tasks = opendir( "/proc/self/task" );
    int count = 0;
    for ( struct dirent* task; tasks != NULL && ( task = readdir( tasks ) ) != NULL; )
    {
        char path[300], line[512] = "";
        snprintf( path, sizeof( path ), "/proc/self/task/%s/stat", task->d_name );
        FILE* file = fopen( path, "r" );
        bool read = file != NULL && fgets( line, sizeof( line ), file ) != NULL;
        const char* behind_name = read ? strrchr( line, ')' ) : NULL;
        count += behind_name != NULL && strncmp( behind_name, ") S", 3 ) == 0 ? 1 : 0;
        if ( file != NULL )
        {
            fclose( file );
        }
    }
    if ( tasks != NULL )
    {
        closedir( tasks );
    }
    return count;
}

// The system starts, ends and suspends threads in its own time; if it never does, the alarm of exit_of_child() fires.
static void wait_until( int ( *count )( void ), int requested )
{
    while ( count() != requested )
    {
        usleep( 1000 );
    }
}

// Two blocks that wait for each other: on one worker neither would end.
static void meet( void* context, int block, int worker )
{
    (void)block, (void)worker;
    _Atomic int* arrived = context;
    atomic_fetch_add( arrived, 1 );
    while ( atomic_load( arrived ) < 2 )
    {
        sched_yield();
    }
}

typedef struct meeting
{
    jobs_pool* pool;
    _Atomic int arrived;
} meeting;

static void run_meeting( void* context )
{
    meeting* m = context;
    atomic_store( &m->arrived, 0 );
    jobs_run_wave( m->pool, 2, meet, &m->arrived );
}

static int sleep_and_wake( void )
{
    meeting m = { .pool = jobs_create( NULL, 3, NULL, NULL ) };
    const int threads = thread_count();
    for ( int round = 0; round < 3; ++round )
    {
        jobs_enter( m.pool, run_meeting, &m );
        wait_until( thread_count, 3 );
        wait_until( sleeping_threads, 2 );
    }
    jobs_destroy( m.pool );
    wait_until( thread_count, 1 );
    return threads == 1 ? 0 : 1;
}

static void do_nothing( void* context )
{
    (void)context;
}

// Threads that are still starting would hold locks of the libraries while this process forks.
static int threads_behind_the_first_step( void )
{
    jobs_pool* pool = jobs_create( NULL, 8, NULL, NULL );
    jobs_enter( pool, do_nothing, NULL );
    const int threads = thread_count();
    jobs_destroy( pool );
    return threads;
}

static void step_another( void* context )
{
    jobs_enter( context, do_nothing, NULL );
}

// Pools that step in turn, and at last one inside the step of another.
static int threads_of_many_pools( void )
{
    jobs_pool* pools[10];
    for ( int i = 0; i < WISP_COUNT( pools ); ++i )
    {
        pools[i] = jobs_create( NULL, 3, NULL, NULL );
        jobs_enter( pools[i], do_nothing, NULL );
    }
    const int in_turn = thread_count();
    jobs_enter( pools[0], step_another, pools[1] );
    const int nested = thread_count();
    for ( int i = 0; i < WISP_COUNT( pools ); ++i )
    {
        jobs_destroy( pools[i] );
    }
    wait_until( thread_count, 1 );
    return 10 * in_turn + nested;
}

TEST( pools_that_step_in_turn_share_a_team_and_others_have_one_each )
{
    assert_int_equal( exit_of_child( threads_of_many_pools ), 35 );
}

TEST( all_threads_run_when_the_first_step_ends )
{
    assert_int_equal( exit_of_child( threads_behind_the_first_step ), 8 );
}

TEST( workers_sleep_between_steps_wake_for_the_next_and_end_with_their_pool )
{
    assert_int_equal( exit_of_child( sleep_and_wake ), 0 );
}

// ---- worlds in two processes ----

static wisp_world* world_of_parent;

static int step_world_of_parent( void )
{
    bool same = wisp_world_step( world_of_parent, 0.01f ) == WISP_OK;
    same = same && wisp_world_hash( world_of_parent ) == hash_of_parent;
    wait_until( thread_count, 3 );
    wisp_world_destroy( world_of_parent );
    wait_until( thread_count, 1 );
    return same ? 0 : 1;
}

// The parent has threads, just started. Its child, which has none of them, advances the same world one step beyond
// the hash; then the parent does the same.
static int fork_with_three_workers( void )
{
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 1;
    for ( int pass = 0; pass < 2; ++pass, def.workers = 3 )
    {
        if ( wisp_world_create( &def, &world_of_parent, NULL ) != WISP_OK )
        {
            return 2;
        }
        wisp_entity strands = test_add_strands( world_of_parent, 500, 8 );
        bool stepped = wisp_request( world_of_parent, strands, WISP_STRAND_POINTS ) == WISP_OK &&
                       wisp_world_step( world_of_parent, 0.01f ) == WISP_OK;
        if ( pass == 0 )
        {
            stepped = stepped && wisp_world_step( world_of_parent, 0.01f ) == WISP_OK;
            hash_of_parent = wisp_world_hash( world_of_parent );
            wisp_world_destroy( world_of_parent );
        }
        if ( stepped == false )
        {
            return 3;
        }
    }
    return exit_of_child( step_world_of_parent ) == 0 && step_world_of_parent() == 0 ? 0 : 1;
}

TEST( a_process_with_workers_may_fork_and_both_step_the_world )
{
    for ( int i = 0; i < 20; ++i ) // failures at the start of threads are random
    {
        assert_int_equal( exit_of_child( fork_with_three_workers ), 0 );
    }
}

// ---- without threads ----

static int warnings;

static void count_warnings( void* user, wisp_log_level level, const char* message )
{
    (void)user;
    warnings += level == WISP_LOG_WARNING && strstr( message, "no thread" ) != NULL ? 1 : 0;
}

// The system cannot start threads whose stacks exceed the address space.
static int step_without_threads( void )
{
    pthread_attr_t attributes;
    pthread_attr_init( &attributes );
    if ( pthread_attr_setstacksize( &attributes, (size_t)1 << 50 ) != 0 ||
         pthread_setattr_default_np( &attributes ) != 0 )
    {
        return 4;
    }
    wisp_world_def def = wisp_default_world_def();
    def.substeps = 1;
    def.workers = 3;
    def.log = count_warnings;
    wisp_world* world = NULL;
    if ( wisp_world_create( &def, &world, NULL ) != WISP_OK )
    {
        return 3;
    }
    wisp_entity strands = test_add_strands( world, 500, 8 );
    bool same = wisp_request( world, strands, WISP_STRAND_POINTS ) == WISP_OK &&
                wisp_world_step( world, 0.01f ) == WISP_OK && wisp_world_hash( world ) == hash_of_parent &&
                wisp_world_step( world, 0.01f ) == WISP_OK;
    const int threads = thread_count();
    wisp_world_destroy( world );
    return same && threads == 1 && warnings == 1 ? 0 : 1;
}

TEST( a_system_that_starts_no_thread_is_told_of_once_and_steps_are_the_same )
{
    hash_of_parent = hash_after_a_step( 1 );
    assert_int_equal( exit_of_child( step_without_threads ), 0 );
}
