#include "report_text.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define REPLACEMENT "\xef\xbf\xbd"
#define THIN_SPACE "\xe2\x80\x89"
#define DOT "\xc2\xb7"
#define MINUS "\xe2\x88\x92"

// ---- text ----

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

int report_text_length( const char* text )
{
    int count = 0;
    for ( ; *text; ++count )
    {
        int size = character_size( (const unsigned char*)text );
        text += size > 0 ? size : 1;
    }
    return count;
}

// ---- numbers ----

void report_put_fixed( double value, int digits, FILE* stream )
{
    char text[400];
    snprintf( text, sizeof( text ), "%.*f", digits, value );

    // A host may have set a locale whose point is a comma, or several bytes.
    const char* point = localeconv()->decimal_point;
    char* found = strstr( text, point );
    if ( digits > 0 && found )
    {
        *found = '\0';
        fprintf( stream, "%s.%s", text, found + strlen( point ) );
    }
    else
    {
        fputs( text, stream );
    }
}

// 10 with raised digits, as people write it.
static void raise( int exponent, char* out, size_t size )
{
    static const char* const raised[10] = { "\xe2\x81\xb0", "\xc2\xb9",     "\xc2\xb2",     "\xc2\xb3",
                                            "\xe2\x81\xb4", "\xe2\x81\xb5", "\xe2\x81\xb6", "\xe2\x81\xb7",
                                            "\xe2\x81\xb8", "\xe2\x81\xb9" };
    char digits[16];
    snprintf( digits, sizeof( digits ), "%d", exponent );
    size_t used = (size_t)snprintf( out, size, "10" );
    for ( const char* c = digits; *c && used < size; ++c )
    {
        used += (size_t)snprintf( out + used, size - used, "%s", *c == '-' ? "\xe2\x81\xbb" : raised[*c - '0'] );
    }
}

// Without trailing zeros, which would suggest a higher accuracy.
static void put_trimmed( double value, int digits, FILE* stream )
{
    char text[64];
    snprintf( text, sizeof( text ), "%.*f", digits, value );
    int needed = digits;
    for ( size_t length = strlen( text ); needed > 0 && text[length - 1] == '0'; --length )
    {
        --needed;
    }
    report_put_fixed( value, needed, stream );
}

void report_put_short( double value, FILE* stream )
{
    if ( !isfinite( value ) )
    {
        fputc( '-', stream );
        return;
    }
    // Rounded first, because rounding may add a digit before the point.
    char text[40], power[48];
    snprintf( text, sizeof( text ), "%.3e", value );
    char* mark = strchr( text, 'e' );
    int exponent = (int)strtol( mark + 1, NULL, 10 );
    if ( exponent >= -4 && exponent < 7 )
    {
        put_trimmed( value, exponent < 3 ? 3 - exponent : 0, stream );
        return;
    }
    *mark = '\0';
    raise( exponent, power, sizeof( power ) );
    put_trimmed( strtod( text, NULL ), 3, stream );
    fprintf( stream, DOT "%s", power );
}

// Digits with a point before the last ones, in groups of three before it.
static void write_plain( long long n, int exponent, char* out, size_t size )
{
    char digits[40];
    unsigned long long magnitude = n < 0 ? 0ull - (unsigned long long)n : (unsigned long long)n;
    int behind = exponent < 0 ? -exponent : 0;
    int length = snprintf( digits, sizeof( digits ), "%0*llu", behind + 1, magnitude );
    for ( ; exponent > 0; --exponent )
    {
        digits[length++] = '0';
    }
    while ( behind > 0 && digits[length - 1] == '0' )
    {
        --length;
        --behind;
    }
    int before = length - behind;
    size_t used = (size_t)snprintf( out, size, "%s", n < 0 ? MINUS : "" );
    for ( int i = 0; i < length && used < size; ++i )
    {
        bool is_group = i > 0 && i < before && before > 4 && ( before - i ) % 3 == 0;
        const char* gap = i == before ? "." : is_group ? THIN_SPACE : "";
        used += (size_t)snprintf( out + used, size - used, "%s%c", gap, digits[i] );
    }
}

void report_decimal( long long n, int exponent, int power, char* out, size_t size )
{
    if ( power == 0 || n == 0 )
    {
        write_plain( n, n == 0 ? 0 : exponent, out, size );
        return;
    }
    char factor[64] = "", raised[48];
    raise( power, raised, sizeof( raised ) );
    write_plain( n, exponent - power, factor, sizeof( factor ) );
    bool is_one = strcmp( factor, "1" ) == 0 || strcmp( factor, MINUS "1" ) == 0;
    factor[strlen( factor ) - ( is_one ? 1 : 0 )] = '\0';
    snprintf( out, size, "%s%s%s", factor, is_one ? "" : DOT, raised );
}
