#include "wisp/base.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

// The only state of the process that the engine keeps: an assert can fail without a world.
static _Atomic( wisp_assert_fn* ) assert_handler;

static bool print_and_abort( const char* condition, const char* file, int line )
{
    fprintf( stderr, "wisp: %s:%d: assertion failed: %s\n", file, line, condition );
    return true;
}

void wisp_set_assert_handler( wisp_assert_fn* handler )
{
    atomic_store( &assert_handler, handler );
}

void wisp_assert_failed( const char* condition, const char* file, int line )
{
    wisp_assert_fn* handler = atomic_load( &assert_handler );
    if ( handler == NULL )
    {
        handler = print_and_abort;
    }
    if ( handler( condition, file, line ) )
    {
        abort();
    }
}
