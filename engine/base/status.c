#include "sentence.h"

#include "wisp/base.h"

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
