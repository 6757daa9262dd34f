/// Threads that stay from step to step, so that no step waits for them to leave it.
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/// What a member does until crew_rest() sends it home. @param member 0 .. count - 1
typedef void crew_body_fn( void* context, int member );

typedef struct jobs_crew
{
    crew_body_fn* body;
    void* context;
    int count;
    bool started;
    long process; ///< that started it
    pthread_t leader;
    pthread_mutex_t lock;
    pthread_cond_t called;
    _Atomic int team, arrived;          ///< members that the system gave, 0 until it is known; those that run
    _Alignas( 64 ) _Atomic bool wanted; // there is, or soon will be, something to do
    _Atomic bool leaving;
    _Atomic int asleep;
} jobs_crew;

/// No thread begins before the first crew_call(). @return false if the system has no lock left
bool crew_init( jobs_crew* crew, int count, crew_body_fn* body, void* context );
/// Send everybody home, and wait for it.
void crew_release( jobs_crew* crew );

/// There is something to do soon: who sleeps is woken, the rest looks for it all the time. Waits for nobody but at
/// the first call, until all members run: threads that are starting hold locks of the libraries, which a process that forks then
/// would take along for good. A forked process has threads of its own from its first call on.
/// @return false while the system starts no thread, so that there are no members; the next call tries again
bool crew_call( jobs_crew* crew );
/// There is nothing to do until the next call.
void crew_dismiss( jobs_crew* crew );

/// By a member that finds nothing to do: spin, then let others run, and sleep if nobody calls for a while.
/// @param idle how often in a row, 0 after something was done
/// @return false: go home
bool crew_rest( jobs_crew* crew, int* idle );
/// By whoever waits for the members: spin, then let others run.
void crew_wait( int* idle );
