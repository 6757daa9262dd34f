/// Formatting of the one-line messages of errors and logs.
#pragma once

#include <stdarg.h>
#include <stddef.h>

/// Format into out: zero-terminated, no line break and no other control character (each becomes a space; those at the
/// end go), cut at the end if longer, never in the middle of a UTF-8 character. The arguments may point into out.
/// @param capacity bytes of out with the zero, 1..BASE_MESSAGE_CAPACITY
void base_message( char* out, size_t capacity, const char* format, va_list arguments )
    __attribute__( ( format( printf, 3, 0 ) ) );

/// Bytes of the longest message, including its zero.
#define BASE_MESSAGE_CAPACITY 512
