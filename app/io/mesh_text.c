// Lines, words and numbers of untrusted files. Independent of the locale, and needs no zero at the end.
#include "mesh_internal.h"

#include <stdlib.h>
#include <string.h>

enum
{
    SHOWN = 24, // limit of characters of a word in a message
    MAX_EXPONENT_DIGITS = 4,
};

static bool is_blank( char c )
{
    return c == ' ' || c == '\t';
}

static bool is_digit( char c )
{
    return c >= '0' && c <= '9';
}

mesh_word mesh_next_word( mesh_word* line )
{
    size_t begin = 0;
    while ( begin < line->length && is_blank( line->text[begin] ) )
    {
        ++begin;
    }
    size_t end = begin;
    while ( end < line->length && !is_blank( line->text[end] ) )
    {
        ++end;
    }
    mesh_word word = { line->text + begin, end - begin };
    *line = ( mesh_word ){ line->text + end, line->length - end };
    return word;
}

bool mesh_next_line( mesh_word* rest, mesh_word* line )
{
    if ( rest->length == 0 )
    {
        return false;
    }
    size_t end = 0;
    while ( end < rest->length && rest->text[end] != '\n' && rest->text[end] != '\r' )
    {
        ++end;
    }
    *line = ( mesh_word ){ rest->text, end };
    bool is_pair = end + 1 < rest->length && rest->text[end] == '\r' && rest->text[end + 1] == '\n';
    size_t next = end == rest->length ? end : end + ( is_pair ? 2 : 1 );
    *rest = ( mesh_word ){ rest->text + next, rest->length - next };
    return true;
}

bool mesh_word_is( mesh_word word, const char* expected )
{
    return word.length == strlen( expected ) && memcmp( word.text, expected, word.length ) == 0;
}

// ---- numbers ---------------------------------------------------------------------------------------------------

static size_t skip_sign( mesh_word word, size_t at )
{
    return at < word.length && ( word.text[at] == '+' || word.text[at] == '-' ) ? at + 1 : at;
}

static size_t skip_digits( mesh_word word, size_t at )
{
    while ( at < word.length && is_digit( word.text[at] ) )
    {
        ++at;
    }
    return at;
}

bool mesh_word_is_number( mesh_word word )
{
    size_t begin = skip_sign( word, 0 );
    size_t at = skip_digits( word, begin );
    size_t digits = at - begin;
    if ( at < word.length && word.text[at] == '.' )
    {
        size_t end = skip_digits( word, at + 1 );
        digits += end - ( at + 1 );
        at = end;
    }
    if ( digits == 0 )
    {
        return false;
    }
    if ( at < word.length && ( word.text[at] == 'e' || word.text[at] == 'E' ) )
    {
        size_t exponent = skip_sign( word, at + 1 );
        at = skip_digits( word, exponent );
        if ( at == exponent || at - exponent > MAX_EXPONENT_DIGITS )
        {
            return false;
        }
    }
    return at == word.length;
}

double mesh_word_value( mesh_word word )
{
    // strtod needs a zero after the number, and the file has none.
    char text[MESH_WORD_LONGEST + 1] = { 0 };
    memcpy( text, word.text, word.length < MESH_WORD_LONGEST ? word.length : MESH_WORD_LONGEST );
    return strtod( text, NULL );
}

bool mesh_word_is_integer( mesh_word word, int32_t* value )
{
    size_t begin = skip_sign( word, 0 );
    if ( begin == word.length || skip_digits( word, begin ) != word.length )
    {
        return false;
    }
    int64_t sum = 0;
    for ( size_t at = begin; at < word.length; ++at )
    {
        sum = 10 * sum + ( word.text[at] - '0' );
        if ( sum > INT32_MAX )
        {
            return false;
        }
    }
    *value = (int32_t)( word.text[0] == '-' ? -sum : sum );
    return true;
}

// ---- messages -------------------------------------------------------------------------------------------------

mesh_quote mesh_quote_word( mesh_word word )
{
    mesh_quote quote = { { 0 } };
    size_t shown = word.length < SHOWN ? word.length : SHOWN;
    for ( size_t i = 0; i < shown; ++i )
    {
        char c = word.text[i];
        quote.text[i] = (char)( c > ' ' && c <= '~' ? c : '?' );
    }
    if ( shown < word.length )
    {
        memcpy( quote.text + shown, "...", 4 );
    }
    return quote;
}
