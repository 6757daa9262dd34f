#include "threads.h"

#include <pthread.h>
#include <stdatomic.h>

typedef struct crew
{
    _Atomic int next; // block that nobody has taken yet
    int block_count;
    wisp_block_fn* run;
    void* context;
} crew;

typedef struct member
{
    crew* crew;
    int worker;
    pthread_t thread;
} member;

static void* work( void* context )
{
    const member* self = context;
    crew* c = self->crew;
    for ( int block = atomic_fetch_add( &c->next, 1 ); block < c->block_count;
          block = atomic_fetch_add( &c->next, 1 ) )
    {
        c->run( c->context, block, self->worker );
    }
    return NULL;
}

void threads_parallel_for( void* user, int block_count, wisp_block_fn* run, void* context )
{
    const int* wanted = user;
    crew c = { .block_count = block_count, .run = run, .context = context };
    member members[WISP_MAX_WORKERS];
    members[0] = ( member ){ .crew = &c };
    int started = 1;
    for ( ; started < *wanted && started < block_count; ++started )
    {
        members[started] = ( member ){ .crew = &c, .worker = started };
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
