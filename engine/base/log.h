/// Destination of messages: the host's function, or stderr.
#pragma once

#include "wisp/base.h"

/// Zero-initialised means no host: warnings and errors go to stderr, one line each, and information goes nowhere.
typedef struct base_log
{
    wisp_log_fn* function;
    void* user; ///< passed to the function unchanged
} base_log;

/// Write one message.
/// @param log may be null, which means no host
void base_log_write( const base_log* log, wisp_log_level level, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// Bytes of the longest message, including its zero.
#define BASE_MESSAGE_CAPACITY 512

/// Check one value as the member `name` of a definition is checked.
/// @param of what the value belongs to, such as "vertex", and its number, for the message; null: nothing
wisp_status base_check_value( const wisp_fields* fields, const char* name, const char* of, int number,
                              const void* value, wisp_error* error );
