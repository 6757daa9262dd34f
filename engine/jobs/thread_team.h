/// Threads that stay from step to step, so that no step waits for them to leave it.
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/// What a member does until thread_team_rest() sends it home. @param member 0 .. count - 1
typedef void thread_team_body_fn( void* context, int member );

typedef struct jobs_thread_team
{
    thread_team_body_fn* body;
    void* context;
    int count;
    bool started;
    long process; ///< that started it
    pthread_t leader;
    pthread_mutex_t lock;
    pthread_cond_t called;
    _Atomic int team, arrived;             ///< members that the system gave, 0 until it is known; those that run
    _Alignas( 64 ) _Atomic bool requested; // there is, or soon will be, something to do
    _Atomic bool leaving;
    _Atomic int asleep;
} jobs_thread_team;

/// No thread begins before the first thread_team_call(). @return false if the system has no lock left
bool thread_team_init( jobs_thread_team* thread_team, int count, thread_team_body_fn* body, void* context );
/// Send everybody home, and wait for it.
void thread_team_release( jobs_thread_team* thread_team );

/// There is something to do soon: who sleeps is woken, the rest looks for it all the time. Waits for nobody but at
/// the first call, until all members run: threads that are starting hold locks of the libraries, which a process that forks then
/// would take along for good. A forked process has threads of its own from its first call on.
/// @return false while the system starts no thread, so that there are no members; the next call tries again
bool thread_team_call( jobs_thread_team* thread_team );
/// There is nothing to do until the next call.
void thread_team_dismiss( jobs_thread_team* thread_team );

/// By a member that finds nothing to do: spin, then let others run, and sleep if nobody calls for a while.
/// @param idle how often in a row, 0 after something was done
/// @return false: go home
bool thread_team_rest( jobs_thread_team* thread_team, int* idle );
/// By whoever waits for the members: spin, then let others run.
void thread_team_wait( int* idle );
