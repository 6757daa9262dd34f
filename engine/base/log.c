#include "log.h"

#include "sentence.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

void base_log_write( const base_log* log, wisp_log_level level, const char* format, ... )
{
    bool has_host = log != NULL && log->function != NULL;
    if ( !has_host && level == WISP_LOG_INFO )
    {
        return;
    }

    char sentence[BASE_SENTENCE_CAPACITY];
    va_list arguments;
    va_start( arguments, format );
    base_sentence( sentence, sizeof sentence, format, arguments );
    va_end( arguments );

    if ( has_host )
    {
        log->function( log->user, level, sentence );
    }
    else
    {
        fprintf( stderr, "wisp: %s\n", sentence );
    }
}

// The only state of the process that the engine keeps: an assert can fail where no world is at hand.
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
