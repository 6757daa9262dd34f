#include "log.h"

#include "wisp/base.h"
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- sentences ----

// Bytes of a UTF-8 character by its first byte; 1 for anything that cannot start one.
static size_t character_size( unsigned char first )
{
    return first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : first >= 0xc0 ? 2 : 1;
}

// The length without a last character whose end was cut off.
static size_t whole_characters( const char* text, size_t length )
{
    size_t start = length;
    while ( start > 0 && length - start < 3 && ( (unsigned char)text[start - 1] & 0xc0 ) == 0x80 )
    {
        --start;
    }
    if ( start == 0 )
    {
        return length;
    }
    size_t needed = character_size( (unsigned char)text[start - 1] );
    return needed > 1 && start - 1 + needed > length ? start - 1 : length;
}

// Format into out: zero-terminated, no line break and no other control character (each becomes a space; those at the
// end go), cut at the end if longer, never in the middle of a UTF-8 character. The arguments may point into out.
// @param capacity bytes of out with the zero, 1..BASE_MESSAGE_CAPACITY
static void base_message( char* out, size_t capacity, const char* format, va_list arguments )
{
    WISP_ASSERT( capacity > 0 && capacity <= BASE_MESSAGE_CAPACITY );

    // Formatted into a separate buffer, so that a message may quote the one it replaces.
    char text[BASE_MESSAGE_CAPACITY];
    int requested = vsnprintf( text, capacity, format, arguments );
    if ( requested < 0 )
    {
        requested = snprintf( text, capacity, "the message could not be formatted" );
    }
    size_t length = (size_t)requested < capacity ? (size_t)requested : whole_characters( text, capacity - 1 );

    // One line, whatever a file name may contain.
    for ( size_t k = 0; k < length; ++k )
    {
        text[k] = (unsigned char)text[k] < ' ' || text[k] == 127 ? ' ' : text[k];
    }
    while ( length > 0 && text[length - 1] == ' ' )
    {
        --length;
    }
    memcpy( out, text, length );
    out[length] = '\0';
}

// ---- assertions ----

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

// ---- log ----

void base_log_write( const base_log* log, wisp_log_level level, const char* format, ... )
{
    bool has_host = log != NULL && log->function != NULL;
    if ( !has_host && level == WISP_LOG_INFO )
    {
        return;
    }

    char message[BASE_MESSAGE_CAPACITY];
    va_list arguments;
    va_start( arguments, format );
    base_message( message, sizeof message, format, arguments );
    va_end( arguments );

    if ( has_host )
    {
        log->function( log->user, level, message );
    }
    else
    {
        fprintf( stderr, "wisp: %s\n", message );
    }
}

// ---- status ----

_Static_assert( sizeof( ( (wisp_error*)0 )->message ) <= BASE_MESSAGE_CAPACITY, "a message fits" );

const char* wisp_version( void )
{
    return WISP_VERSION_STRING;
}

const char* wisp_status_name( wisp_status status )
{
    switch ( status )
    {
        case WISP_OK:
            return "ok";
        case WISP_NO_MEMORY:
            return "out of memory";
        case WISP_BAD_INPUT:
            return "bad input";
        case WISP_STALE_ID:
            return "stale id";
        case WISP_CONFLICT:
            return "conflict";
        case WISP_IO_ERROR:
            return "io error";
    }

    // A host may still pass a number without an enumerator.
    return "unknown status";
}

wisp_status wisp_fail( wisp_error* error, wisp_status status, const char* format, ... )
{
    if ( error != NULL )
    {
        error->status = status;
        va_list arguments;
        va_start( arguments, format );
        base_message( error->message, sizeof error->message, format, arguments );
        va_end( arguments );
    }
    return status;
}
