/// Checks of an oracle's input. Oracles link nothing of the engine, so these write their own messages.
#pragma once

#include "double3.h"

#include <stdarg.h>
#include <stdbool.h>
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

/// False for a NaN.
static inline bool is_within( double value, double lower, double upper )
{
    return value >= lower && value <= upper;
}

static inline bool is_coordinate( double3 p )
{
    return is_within( p.x, -1e6, 1e6 ) && is_within( p.y, -1e6, 1e6 ) && is_within( p.z, -1e6, 1e6 );
}

/// A value and its limits.
typedef struct oracle_limit
{
    const char* name;
    double value, lower, upper;
} oracle_limit;

/// Reject the first value beyond its limits.
static inline wisp_status oracle_check_limits( const oracle_limit* limits, int count, wisp_error* error )
{
    for ( int n = 0; n < count; ++n )
    {
        const oracle_limit l = limits[n];
        if ( !is_within( l.value, l.lower, l.upper ) )
        {
            return refuse( error, WISP_BAD_INPUT, "%s is %g, must be in [%g, %g]", l.name, l.value, l.lower,
                           l.upper );
        }
    }
    return WISP_OK;
}
