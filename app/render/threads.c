#include "threads.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct thread_team
{
    _Atomic int next; // next block to run
    int block_count;
    wisp_block_fn* run;
    void* context;
} thread_team;

typedef struct member
{
    thread_team* thread_team;
    int worker;
    pthread_t thread;
} member;

static void* work( void* context )
{
    const member* self = context;
    thread_team* c = self->thread_team;
    for ( int block = atomic_fetch_add( &c->next, 1 ); block < c->block_count;
          block = atomic_fetch_add( &c->next, 1 ) )
    {
        c->run( c->context, block, self->worker );
    }
    return NULL;
}

void threads_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    const int* requested = user;
    thread_team c = { .block_count = block_count, .run = run, .context = context };
    member members[WISP_MAX_WORKERS];
    members[0] = ( member ){ .thread_team = &c };
    int started = 1;
    for ( ; started < *requested && started < block_count; ++started )
    {
        members[started] = ( member ){ .thread_team = &c, .worker = started };
        if ( pthread_create( &members[started].thread, NULL, work, &members[started] ) != 0 )
        {
            break;
        }
    }
    work( &members[0] );
    for ( int k = 1; k < started; ++k )
    {
        pthread_join( members[k].thread, NULL );
    }
}
