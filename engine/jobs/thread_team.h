/// Threads that persist from step to step, so that no step waits for them to end.
#pragma once

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

/// Body of a member, until thread_team_rest() returns false. @param member 0 .. count - 1
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
    _Atomic int team, arrived;             ///< members that the system started, 0 until it is known; running members
    _Alignas( 64 ) _Atomic bool requested; // there is work, or soon will be
    _Atomic bool leaving;
    _Atomic int asleep;
} jobs_thread_team;

/// @return cores that this process may run on
int thread_team_cores( void );

/// No thread starts before the first thread_team_call(). @return false if the system has no lock left
bool thread_team_init( jobs_thread_team* thread_team, int count, thread_team_body_fn* body, void* context );
/// End all members, and wait for them.
void thread_team_release( jobs_thread_team* thread_team );

/// Announce work: sleeping members wake up, the others poll for it. Does not wait for members, except in the first
/// call, until all of them run: starting threads hold locks of the libraries, which a process that forks then would
/// keep for good. A forked process has threads of its own from its first call on.
/// @return false while the system starts no thread, so that there are no members; the next call tries again
bool thread_team_call( jobs_thread_team* thread_team );
/// There is no work until the next call.
void thread_team_dismiss( jobs_thread_team* thread_team );

/// For a member without work: spin, then yield, and sleep if there is no call for a while.
/// @param idle number of successive calls without work, 0 after work
/// @return false: end
bool thread_team_rest( jobs_thread_team* thread_team, int* idle );
/// For a thread that waits for the members: spin, then yield.
void thread_team_wait( int* idle );
