#include "log.h"

#include "sentence.h"

#include <stdio.h>

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
