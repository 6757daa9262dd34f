/// Readers of the text and of the numbers in recordings for other programs, written from the descriptions of the formats.
#pragma once

#include "record_fixture.h"

static inline uint32_t get_u32( const unsigned char* bytes )
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static inline float get_float( const unsigned char* bytes )
{
    uint32_t bits = get_u32( bytes );
    float value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

static inline void assert_bits( float found, float expected )
{
    assert_memory_equal( &found, &expected, sizeof found );
}

static inline void assert_point( const float* found, wisp_vec3 expected )
{
    assert_bits( found[0], expected.x );
    assert_bits( found[1], expected.y );
    assert_bits( found[2], expected.z );
}

static inline int count_of( const char* text, const char* words )
{
    int count = 0;
    for ( const char* at = strstr( text, words ); at != NULL; at = strstr( at + 1, words ) )
    {
        ++count;
    }
    return count;
}

// Every element that opens closes, in order; attributes are quoted. Texts here hold no other angle brackets.
static inline void assert_xml( const char* text )
{
    char open[16][32];
    int depth = 0;
    assert_int_equal( strncmp( text, "<?xml version=\"1.0\"?>", 21 ), 0 );
    for ( const char* at = strchr( text + 21, '<' ); at != NULL; at = strchr( at + 1, '<' ) )
    {
        const char* end = strchr( at, '>' );
        assert_non_null( end );
        int quotes = 0;
        for ( const char* c = at; c < end; ++c )
        {
            quotes += *c == '"';
        }
        assert_int_equal( quotes % 2, 0 );
        char name[32] = { 0 };
        bool closing = at[1] == '/';
        assert_int_equal( sscanf( at + 1 + closing, "%31[A-Za-z]", name ), 1 );
        if ( closing )
        {
            assert_true( depth > 0 );
            assert_string_equal( open[--depth], name );
        }
        else if ( end[-1] != '/' )
        {
            assert_true( depth < 16 );
            strcpy( open[depth++], name );
        }
    }
    assert_int_equal( depth, 0 );
}

static inline int base64_value( char c )
{
    static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char* found = strchr( letters, c );
    assert_true( c != 0 && found != NULL );
    return (int)( found - letters );
}

// The numbers of an array, 4 bytes each, whose stream starts with their size in 8 bytes.
static inline int decode_array( const char* text, const char* name, unsigned char* bytes, size_t room )
{
    char words[64];
    snprintf( words, sizeof words, "Name=\"%s\"", name );
    const char* at = strstr( text, words );
    assert_non_null( at );
    at = strchr( at, '>' ) + 1;
    unsigned char stream[4096];
    size_t size = 0;
    for ( ; *at != '<'; at += 4 )
    {
        int filled = 2 + ( at[2] != '=' ) + ( at[3] != '=' ) - 1;
        int group = base64_value( at[0] ) << 18 | base64_value( at[1] ) << 12;
        group |= at[2] != '=' ? base64_value( at[2] ) << 6 : 0;
        group |= at[3] != '=' ? base64_value( at[3] ) : 0;
        for ( int i = 0; i < filled; ++i )
        {
            assert_true( size < sizeof stream );
            stream[size++] = (unsigned char)( group >> ( 16 - 8 * i ) & 255 );
        }
    }
    assert_true( size >= 8 && size - 8 <= room );
    assert_int_equal( get_u32( stream ), size - 8 );
    assert_int_equal( get_u32( stream + 4 ), 0 );
    memcpy( bytes, stream + 8, size - 8 );
    return (int)( ( size - 8 ) / 4 );
}

static inline void assert_numbers( const char* text, const char* name, const int32_t* expected, int count )
{
    unsigned char bytes[256];
    assert_int_equal( decode_array( text, name, bytes, sizeof bytes ), count );
    for ( int i = 0; i < count; ++i )
    {
        assert_int_equal( get_u32( bytes + 4 * i ), expected[i] );
    }
}

static inline void assert_vtp_points( const char* text, const wisp_vec3* expected, int count )
{
    unsigned char bytes[256];
    assert_int_equal( decode_array( text, "Points", bytes, sizeof bytes ), 3 * count );
    for ( int v = 0; v < count; ++v )
    {
        const unsigned char* at = bytes + 12 * v;
        const float point[] = { get_float( at ), get_float( at + 4 ), get_float( at + 8 ) };
        assert_point( point, expected[v] );
    }
}

// Brackets of all kinds close in order; quoted text does not count.
static inline void assert_balanced( const char* text )
{
    char open[64];
    int depth = 0;
    bool quoted = false;
    for ( const char* c = text; *c != 0; ++c )
    {
        quoted = *c == '"' ? !quoted : quoted;
        if ( !quoted && strchr( "([{", *c ) != NULL )
        {
            assert_true( depth < 64 );
            open[depth++] = *c;
        }
        else if ( !quoted && strchr( ")]}", *c ) != NULL )
        {
            assert_true( depth > 0 );
            char expected = *c == ')' ? '(' : *c == ']' ? '[' : '{';
            assert_int_equal( open[--depth], expected );
        }
    }
    assert_int_equal( depth, 0 );
    assert_false( quoted );
}
