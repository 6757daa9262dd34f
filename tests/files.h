/// Files that tests write and read.
#pragma once

#include "unit.h"

#include <stdbool.h>
#include <unistd.h>

static inline bool exists( const char* path )
{
    return access( path, F_OK ) == 0;
}

static inline void write_bytes( const char* path, const void* bytes, size_t size )
{
    FILE* file = fopen( path, "wb" );
    assert_non_null( file );
    assert_int_equal( fwrite( bytes, 1, size, file ), size );
    assert_int_equal( fclose( file ), 0 );
}

static inline void write_text( const char* path, const char* text )
{
    write_bytes( path, text, strlen( text ) );
}

/// @return zero-terminated, for free()
static inline void* read_bytes( const char* path, size_t* size )
{
    FILE* file = fopen( path, "rb" );
    if ( file == NULL )
    {
        fail_msg( "%s: missing", path );
    }
    fseek( file, 0, SEEK_END );
    *size = (size_t)ftell( file );
    rewind( file );
    char* bytes = checked_malloc( *size + 1 );
    assert_int_equal( fread( bytes, 1, *size, file ), *size );
    bytes[*size] = 0;
    fclose( file );
    return bytes;
}

/// Read a file that is shorter than `size`, as a text.
static inline void read_text( const char* path, char* out, size_t size )
{
    size_t length = 0;
    char* text = read_bytes( path, &length );
    assert_true( length < size );
    memcpy( out, text, length + 1 );
    free( text );
}
