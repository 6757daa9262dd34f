#include "report_data.h"

#include <stdbool.h>
#include <string.h>

#define REPLACEMENT "\xef\xbf\xbd"

// Bytes of the character at the start of a text; 0 where it is not UTF-8.
static int character_size( const unsigned char* s )
{
    static const unsigned least[5] = { 0, 0, 0x80, 0x800, 0x10000 };
    int size = s[0] < 0x80 ? 1 : s[0] >> 5 == 6 ? 2 : s[0] >> 4 == 14 ? 3 : s[0] >> 3 == 30 ? 4 : 0;
    unsigned code = size > 1 ? s[0] & ( 0xffu >> ( size + 1 ) ) : s[0];
    for ( int i = 1; i < size; ++i )
    {
        // A text that ends early has a zero here, which is no continuation.
        if ( s[i] >> 6 != 2 )
        {
            return 0;
        }
        code = code << 6 | ( s[i] & 0x3fu );
    }
    bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    return size > 1 && ( code < least[size] || is_surrogate || code > 0x10ffff ) ? 0 : size;
}

// Neither HTML nor XML can represent these, not even by number.
static bool is_forbidden( const char* c, int size )
{
    bool is_control = size == 1 && ( ( (unsigned char)*c < 0x20 && !strchr( "\t\n", *c ) ) || *c == 0x7f );
    bool is_no_character = size == 3 && memcmp( c, "\xef\xbf", 2 ) == 0 && (unsigned char)c[2] >= 0xbe;
    return size == 0 || is_control || is_no_character;
}

static void put_character( const char* c, int size, FILE* stream )
{
    switch ( *c )
    {
        case '&':
            fputs( "&amp;", stream );
            break;
        case '<':
            fputs( "&lt;", stream );
            break;
        case '>':
            fputs( "&gt;", stream );
            break;
        case '"':
            fputs( "&quot;", stream );
            break;
        case '\'':
            fputs( "&#39;", stream );
            break;
        default:
            fwrite( c, 1, (size_t)size, stream );
            break;
    }
}

// Backticks mark code in notes, which are Markdown. @param has_code write them as <code>; else they are left out
static void put_text( const char* text, bool has_code, FILE* stream )
{
    bool is_open = false;
    while ( *text )
    {
        if ( *text == '`' )
        {
            const bool ends = is_open || strchr( text + 1, '`' ) != NULL;
            fputs( has_code && ends ? ( is_open ? "</code>" : "<code>" ) : "", stream );
            is_open = ends && !is_open;
            ++text;
            continue;
        }
        int size = character_size( (const unsigned char*)text );
        if ( is_forbidden( text, size ) )
        {
            fputs( REPLACEMENT, stream );
        }
        else
        {
            put_character( text, size, stream );
        }
        text += size > 0 ? size : 1;
    }
}

void report_put_text( const char* text, FILE* stream )
{
    put_text( text, false, stream );
}

void report_put_prose( const char* text, FILE* stream )
{
    put_text( text, true, stream );
}
