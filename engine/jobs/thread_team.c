// The only file that uses OpenMP.
//
// A parallel region in each step would end when its last thread has left it. Where another process holds the core that takes
// several milliseconds: with one such process on two cores, 19 waves of 2.0 ms took 5.7 ms a step. So a thread of the team
// opens one region that lasts, and a step waits for blocks, never for threads (2.0 ms in the same case). Between steps the
// members look for work for about half a millisecond, then sleep.
//
// With one worker, or the host's own loop, there is no team and OpenMP is never called. The first step waits until all threads
// run, because starting threads hold locks of the libraries that a fork() would leave locked in the child. A child gets a
// team of its own at its first step.
#include "thread_team.h"

#if defined( _OPENMP )

#include <omp.h>
#include <sched.h>
#include <unistd.h>

enum
{
    SPINS_BEFORE_YIELD = 4000,
    YIELDS_BEFORE_SLEEP = 500, // about half a millisecond: consecutive steps need no wake-up
};

int thread_team_cores( void )
{
    cpu_set_t set;
    return sched_getaffinity( 0, sizeof( set ), &set ) == 0 ? CPU_COUNT( &set ) : 1;
}

static bool make_lock( jobs_thread_team* thread_team )
{
    if ( pthread_mutex_init( &thread_team->lock, NULL ) != 0 )
    {
        return false;
    }
    if ( pthread_cond_init( &thread_team->called, NULL ) != 0 )
    {
        pthread_mutex_destroy( &thread_team->lock );
        return false;
    }
    return true;
}

bool thread_team_init( jobs_thread_team* thread_team, int count, thread_team_body_fn* body, void* context )
{
    *thread_team = ( jobs_thread_team ){ .body = body, .context = context, .count = count };
    return make_lock( thread_team );
}

// A child of fork() has the memory of its parent and none of its threads, which may have held the lock.
static void forget_threads_of_parent( jobs_thread_team* thread_team )
{
    if ( thread_team->started && thread_team->process != getpid() )
    {
        thread_team->started = false;
        atomic_store( &thread_team->asleep, 0 );
        atomic_store( &thread_team->team, 0 );
        atomic_store( &thread_team->arrived, 0 );
        make_lock( thread_team ); // which needed nothing of the system the first time
    }
}

static void wake_all( jobs_thread_team* thread_team )
{
    pthread_mutex_lock( &thread_team->lock );
    pthread_cond_broadcast( &thread_team->called );
    pthread_mutex_unlock( &thread_team->lock );
}

void thread_team_release( jobs_thread_team* thread_team )
{
    forget_threads_of_parent( thread_team );
    if ( thread_team->started )
    {
        atomic_store( &thread_team->leaving, true );
        wake_all( thread_team );
        pthread_join( thread_team->leader, NULL );
    }
    pthread_cond_destroy( &thread_team->called );
    pthread_mutex_destroy( &thread_team->lock );
}

static void* lead( void* user )
{
    jobs_thread_team* thread_team = user;
#pragma omp parallel num_threads( thread_team->count ) default( none ) shared( thread_team )
    {
        atomic_store( &thread_team->team, omp_get_num_threads() );
        atomic_fetch_add( &thread_team->arrived, 1 );
        thread_team->body( thread_team->context, omp_get_thread_num() );
    }
    return NULL;
}

static void start( jobs_thread_team* thread_team )
{
    thread_team->process = getpid();
    thread_team->started = pthread_create( &thread_team->leader, NULL, lead, thread_team ) == 0;
    for ( int idle = 0;
          thread_team->started && ( atomic_load( &thread_team->team ) == 0 ||
                                    atomic_load( &thread_team->arrived ) < atomic_load( &thread_team->team ) ); )
    {
        thread_team_wait( &idle );
    }
}

bool thread_team_call( jobs_thread_team* thread_team )
{
    forget_threads_of_parent( thread_team );
    atomic_store( &thread_team->requested, true );
    if ( thread_team->started == false )
    {
        start( thread_team );
    }
    // a member counts itself before it reads `requested`, so one of the two reads the other's write
    else if ( atomic_load( &thread_team->asleep ) > 0 )
    {
        wake_all( thread_team );
    }
    return thread_team->started;
}

void thread_team_dismiss( jobs_thread_team* thread_team )
{
    atomic_store( &thread_team->requested, false );
}

static void sleep_until_called( jobs_thread_team* thread_team )
{
    pthread_mutex_lock( &thread_team->lock );
    atomic_fetch_add( &thread_team->asleep, 1 );
    while ( atomic_load( &thread_team->requested ) == false && atomic_load( &thread_team->leaving ) == false )
    {
        pthread_cond_wait( &thread_team->called, &thread_team->lock );
    }
    atomic_fetch_sub( &thread_team->asleep, 1 );
    pthread_mutex_unlock( &thread_team->lock );
}

bool thread_team_rest( jobs_thread_team* thread_team, int* idle )
{
    if ( atomic_load_explicit( &thread_team->leaving, memory_order_acquire ) )
    {
        return false;
    }
    if ( *idle >= SPINS_BEFORE_YIELD + YIELDS_BEFORE_SLEEP &&
         atomic_load_explicit( &thread_team->requested, memory_order_relaxed ) == false )
    {
        sleep_until_called( thread_team );
        *idle = 0;
        return true;
    }
    thread_team_wait( idle );
    return true;
}

void thread_team_wait( int* idle )
{
    if ( *idle >= SPINS_BEFORE_YIELD )
    {
        sched_yield();
    }
    *idle += *idle < SPINS_BEFORE_YIELD + YIELDS_BEFORE_SLEEP ? 1 : 0;
}

#endif
