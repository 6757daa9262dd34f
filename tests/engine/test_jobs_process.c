// Threads and processes: none is started where none is asked for, and a process that never met a thread may fork.
// This program starts workers in its children only.
#include "support.h"

#include "jobs.h"

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

// Run in a child and hand its exit status back; a child that hangs is ended by its alarm.
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
    int most_threads;
} watched_waves;

static void run_watched_waves( void* context )
{
    watched_waves* watched = context;
    for ( int i = 0; i < 20; ++i )
    {
        jobs_run_wave( watched->pool, 50, watch_threads, &watched->most_threads );
    }
}

static int most_threads( int workers, wisp_parallel_for_fn* host, void* host_user )
{
    watched_waves watched = { jobs_create( NULL, workers, host, host_user ), 0 };
    jobs_enter( watched.pool, run_watched_waves, &watched );
    jobs_destroy( watched.pool );
    int after = thread_count();
    return after > watched.most_threads ? after : watched.most_threads;
}

static int threads_of_one_worker( void )
{
    return most_threads( 1, NULL, NULL );
}

static int threads_of_a_host( void )
{
    return most_threads( HOST_WORKERS, serial_host_parallel_for, NULL );
}

static int threads_of_two_workers( void )
{
    return most_threads( 2, NULL, NULL );
}

static void one_worker_never_starts_a_thread( void** state )
{
    (void)state;
    assert_int_equal( exit_of_child( threads_of_one_worker ), 1 );
}

static void a_hosts_own_loop_never_starts_a_thread_of_ours( void** state )
{
    (void)state;
    assert_int_equal( exit_of_child( threads_of_a_host ), 1 );
}

static void two_workers_are_two_threads( void** state )
{
    (void)state;
    assert_int_equal( exit_of_child( threads_of_two_workers ), 2 );
}

// Hash of strands after a step with so many workers; 0 where something failed.
static uint64_t hash_after_a_step( int workers )
{
    wisp_world_def def = wisp_default_world_def();
    def.workers = workers;
    wisp_world* world = NULL;
    uint64_t hash = 0;
    if ( wisp_world_create( &def, &world, NULL ) == WISP_OK )
    {
        wisp_entity strands = test_add_strands( world, 500, 8 );
        bool stepped = wisp_want( world, strands, WISP_STRAND_POINTS ) == WISP_OK;
        stepped = stepped && wisp_world_step( world, 0.01f ) == WISP_OK;
        hash = stepped ? wisp_world_hash( world ) : 0;
    }
    wisp_world_destroy( world );
    return hash;
}

static uint64_t hash_of_parent;

static int step_with_three_workers( void )
{
    return hash_after_a_step( 3 ) == hash_of_parent ? 0 : 1;
}

static void a_process_that_ran_one_worker_may_fork_and_its_child_may_run_three( void** state )
{
    (void)state;
    hash_of_parent = hash_after_a_step( 1 );
    assert_true( hash_of_parent != 0 );

    assert_int_equal( exit_of_child( step_with_three_workers ), 0 );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( one_worker_never_starts_a_thread ),
        cmocka_unit_test( a_hosts_own_loop_never_starts_a_thread_of_ours ),
        cmocka_unit_test( two_workers_are_two_threads ),
        cmocka_unit_test( a_process_that_ran_one_worker_may_fork_and_its_child_may_run_three ),
    };
    return cmocka_run_group_tests_name( "jobs and processes", tests, NULL, NULL );
}
