// A build without OpenMP, such as WebAssembly: no member ever starts, and the calling thread runs all blocks.
#include "thread_team.h"

#if !defined( _OPENMP )

int thread_team_cores( void )
{
    return 1;
}

bool thread_team_init( jobs_thread_team* thread_team, int count, thread_team_body_fn* body, void* context )
{
    *thread_team = ( jobs_thread_team ){ .body = body, .context = context, .count = count };
    return true;
}

void thread_team_release( jobs_thread_team* thread_team )
{
    (void)thread_team;
}

bool thread_team_call( jobs_thread_team* thread_team )
{
    (void)thread_team;
    return false;
}

void thread_team_dismiss( jobs_thread_team* thread_team )
{
    (void)thread_team;
}

bool thread_team_rest( jobs_thread_team* thread_team, int* idle )
{
    (void)thread_team;
    (void)idle;
    return false;
}

void thread_team_wait( int* idle )
{
    (void)idle;
}

#endif
