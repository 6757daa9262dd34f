/// Where messages go: to the host's function, or to stderr.
#pragma once

#include "wisp/base.h"

/// Zero-initialised means no host: warnings and errors go to stderr, one line each, and information goes nowhere.
typedef struct base_log
{
    wisp_log_fn* function;
    void* user; ///< handed to the function as it is
} base_log;

/// Write one message.
/// @param log may be null, which means no host
void base_log_write( const base_log* log, wisp_log_level level, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );
