// The only file that knows OpenMP.
//
// A parallel region in each step would end when its last thread has left it. Where another process holds the core that takes
// several milliseconds: with one such process on two cores, 19 waves of 2.0 ms took 5.7 ms a step. So a thread of the team
// opens one region that lasts, and a step waits for blocks, never for threads (2.0 ms in the same case). Between steps the
// members look for work for about half a millisecond, then sleep.
//
// With one worker, or the host's own loop, there is no team and OpenMP is never called. The first step waits until all threads
// run, because starting threads hold locks of the libraries that a fork() would leave locked in the child. A child gets a
// team of its own at its first step.
#include "crew.h"

#include <omp.h>
#include <sched.h>
#include <unistd.h>

enum
{
    SPINS_BEFORE_YIELD = 4000,
    YIELDS_BEFORE_SLEEP = 500, // about half a millisecond: steps that follow each other at once wake nobody
};

static bool make_lock( jobs_crew* crew )
{
    if ( pthread_mutex_init( &crew->lock, NULL ) != 0 )
    {
        return false;
    }
    if ( pthread_cond_init( &crew->called, NULL ) != 0 )
    {
        pthread_mutex_destroy( &crew->lock );
        return false;
    }
    return true;
}

bool crew_init( jobs_crew* crew, int count, crew_body_fn* body, void* context )
{
    *crew = ( jobs_crew ){ .body = body, .context = context, .count = count };
    return make_lock( crew );
}

// A child of fork() has the memory of its parent and none of its threads, which may have held the lock.
static void forget_threads_of_parent( jobs_crew* crew )
{
    if ( crew->started && crew->process != getpid() )
    {
        crew->started = false;
        atomic_store( &crew->asleep, 0 );
        atomic_store( &crew->team, 0 );
        atomic_store( &crew->arrived, 0 );
        make_lock( crew ); // which needed nothing of the system the first time
    }
}

static void wake_all( jobs_crew* crew )
{
    pthread_mutex_lock( &crew->lock );
    pthread_cond_broadcast( &crew->called );
    pthread_mutex_unlock( &crew->lock );
}

void crew_release( jobs_crew* crew )
{
    forget_threads_of_parent( crew );
    if ( crew->started )
    {
        atomic_store( &crew->leaving, true );
        wake_all( crew );
        pthread_join( crew->leader, NULL );
    }
    pthread_cond_destroy( &crew->called );
    pthread_mutex_destroy( &crew->lock );
}

static void* lead( void* user )
{
    jobs_crew* crew = user;
#pragma omp parallel num_threads( crew->count ) default( none ) shared( crew )
    {
        atomic_store( &crew->team, omp_get_num_threads() );
        atomic_fetch_add( &crew->arrived, 1 );
        crew->body( crew->context, omp_get_thread_num() );
    }
    return NULL;
}

static void start( jobs_crew* crew )
{
    crew->process = getpid();
    crew->started = pthread_create( &crew->leader, NULL, lead, crew ) == 0;
    for ( int idle = 0; crew->started && ( atomic_load( &crew->team ) == 0 ||
                                           atomic_load( &crew->arrived ) < atomic_load( &crew->team ) ); )
    {
        crew_wait( &idle );
    }
}

bool crew_call( jobs_crew* crew )
{
    forget_threads_of_parent( crew );
    atomic_store( &crew->wanted, true );
    if ( crew->started == false )
    {
        start( crew );
    }
    // a member counts itself before it looks whether it is wanted: one of the two sees the other
    else if ( atomic_load( &crew->asleep ) > 0 )
    {
        wake_all( crew );
    }
    return crew->started;
}

void crew_dismiss( jobs_crew* crew )
{
    atomic_store( &crew->wanted, false );
}

static void sleep_until_called( jobs_crew* crew )
{
    pthread_mutex_lock( &crew->lock );
    atomic_fetch_add( &crew->asleep, 1 );
    while ( atomic_load( &crew->wanted ) == false && atomic_load( &crew->leaving ) == false )
    {
        pthread_cond_wait( &crew->called, &crew->lock );
    }
    atomic_fetch_sub( &crew->asleep, 1 );
    pthread_mutex_unlock( &crew->lock );
}

bool crew_rest( jobs_crew* crew, int* idle )
{
    if ( atomic_load_explicit( &crew->leaving, memory_order_acquire ) )
    {
        return false;
    }
    if ( *idle >= SPINS_BEFORE_YIELD + YIELDS_BEFORE_SLEEP &&
         atomic_load_explicit( &crew->wanted, memory_order_relaxed ) == false )
    {
        sleep_until_called( crew );
        *idle = 0;
        return true;
    }
    crew_wait( idle );
    return true;
}

void crew_wait( int* idle )
{
    if ( *idle >= SPINS_BEFORE_YIELD )
    {
        sched_yield();
    }
    *idle += *idle < SPINS_BEFORE_YIELD + YIELDS_BEFORE_SLEEP ? 1 : 0;
}
