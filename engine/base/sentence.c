#include "sentence.h"

#include "wisp/base.h"

#include <stdio.h>
#include <string.h>

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

void base_message( char* out, size_t capacity, const char* format, va_list arguments )
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
