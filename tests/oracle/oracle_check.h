/// Messages of oracles that run out of memory. Oracles link nothing of the engine, so they write their own.
#pragma once

#include "wisp/base.h"

#include <stdarg.h>
#include <stdio.h>

/// Fill `error`, which may be null. @return the status
__attribute__( ( format( printf, 3, 4 ) ) ) static inline wisp_status refuse( wisp_error* error, wisp_status status,
                                                                              const char* format, ... )
{
    if ( error != NULL )
    {
        error->status = status;
        va_list arguments;
        va_start( arguments, format );
        vsnprintf( error->message, sizeof( error->message ), format, arguments );
        va_end( arguments );
    }
    return status;
}
