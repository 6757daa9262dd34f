#include "reference_bytes.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint64_t reference_checksum( const unsigned char* bytes, size_t size )
{
    uint64_t hash = 0xcbf29ce484222325ull;
    for ( size_t i = 0; i < size; ++i )
    {
        hash = ( hash ^ bytes[i] ) * 0x100000001b3ull;
    }
    return hash;
}

// ---- numbers in and out, the lowest byte first ----

uint64_t reference_take( const unsigned char** at, int size )
{
    uint64_t value = 0;
    for ( int i = 0; i < size; ++i )
    {
        value |= (uint64_t)( *at )[i] << ( 8 * i );
    }
    *at += size;
    return value;
}

double reference_take_double( const unsigned char** at )
{
    const uint64_t bits = reference_take( at, 8 );
    double value;
    memcpy( &value, &bits, sizeof( value ) );
    return value;
}

void reference_put( unsigned char** at, int size, uint64_t value )
{
    for ( int i = 0; i < size; ++i )
    {
        *( *at )++ = (unsigned char)( value >> ( 8 * i ) );
    }
}

void reference_put_double( unsigned char** at, double value )
{
    uint64_t bits;
    memcpy( &bits, &value, sizeof( bits ) );
    reference_put( at, 8, bits );
}

// ---- files ----

wisp_status reference_read_bytes( const char* path, size_t room, unsigned char** bytes, size_t* size,
                                  wisp_error* error )
{
    *bytes = NULL;
    *size = 0;
    FILE* file = fopen( path, "rb" );
    if ( !file )
    {
        return wisp_fail( error, WISP_IO_ERROR, "%s: %s", path, strerror( errno ) );
    }
    wisp_status status = WISP_OK;
    size_t capacity = 0;
    while ( status == WISP_OK && *size == capacity && capacity < room )
    {
        const size_t longer = capacity == 0 ? (size_t)1 << 16 : 2 * capacity;
        capacity = longer < room ? longer : room;
        unsigned char* grown = realloc( *bytes, capacity );
        if ( !grown )
        {
            status = wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the file", path );
            break;
        }
        *bytes = grown;
        *size += fread( *bytes + *size, 1, capacity - *size, file );
    }
    if ( status == WISP_OK && ferror( file ) )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "%s: could not be read", path );
    }
    fclose( file );
    return status;
}

wisp_status reference_write_bytes( const char* path, const void* bytes, size_t size, wisp_error* error )
{
    FILE* file = fopen( path, "wb" );
    bool good = file && fwrite( bytes, 1, size, file ) == size;
    good = file && fclose( file ) == 0 && good;
    return good ? WISP_OK : wisp_fail( error, WISP_IO_ERROR, "%s: could not be written", path );
}

wisp_status reference_check_beginning( const unsigned char* bytes, size_t size, int head, int tail, const char* name,
                                       wisp_error* error )
{
    if ( size < (size_t)( head + tail ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: %zu bytes are too few for a reference, its head alone has %d",
                          name, size, head );
    }
    if ( memcmp( bytes, REFERENCE_MAGIC, REFERENCE_MAGIC_SIZE ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 0: this is no reference file", name );
    }
    return WISP_OK;
}
