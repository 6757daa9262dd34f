/// Little-endian numbers in files. Bytes are combined one by one: a file may start at any address, and the machine
/// may be big-endian.
#pragma once

#include <string.h>

#include "wisp/base.h"

static inline uint32_t io_get_u16( const unsigned char* bytes )
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8;
}

static inline uint32_t io_get_u32( const unsigned char* bytes )
{
    return io_get_u16( bytes ) | io_get_u16( bytes + 2 ) << 16;
}

static inline float io_get_float( const unsigned char* bytes )
{
    uint32_t bits = io_get_u32( bytes );
    float value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

static inline void io_put_u16( unsigned char* bytes, uint32_t value )
{
    bytes[0] = (unsigned char)( value & 255 );
    bytes[1] = (unsigned char)( value >> 8 & 255 );
}

static inline void io_put_u32( unsigned char* bytes, uint32_t value )
{
    io_put_u16( bytes, value );
    io_put_u16( bytes + 2, value >> 16 );
}

static inline void io_put_float( unsigned char* bytes, float value )
{
    uint32_t bits;
    memcpy( &bits, &value, sizeof bits );
    io_put_u32( bytes, bits );
}

static inline void io_put_vec3( unsigned char* bytes, wisp_vec3 value )
{
    io_put_float( bytes, value.x );
    io_put_float( bytes + 4, value.y );
    io_put_float( bytes + 8, value.z );
}

static inline uint64_t io_get_u64( const unsigned char* bytes )
{
    return io_get_u32( bytes ) | (uint64_t)io_get_u32( bytes + 4 ) << 32;
}

static inline double io_get_double( const unsigned char* bytes )
{
    uint64_t bits = io_get_u64( bytes );
    double value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

static inline void io_put_u64( unsigned char* bytes, uint64_t value )
{
    io_put_u32( bytes, (uint32_t)( value & 0xffffffffu ) );
    io_put_u32( bytes + 4, (uint32_t)( value >> 32 ) );
}

static inline void io_put_double( unsigned char* bytes, double value )
{
    uint64_t bits;
    memcpy( &bits, &value, sizeof bits );
    io_put_u64( bytes, bits );
}

/// Numbers of 4 bytes each, integers or floats.
static inline void io_put_words( unsigned char* bytes, const void* words, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        uint32_t word;
        memcpy( &word, (const unsigned char*)words + 4 * i, sizeof word );
        io_put_u32( bytes + 4 * i, word );
    }
}

static inline void io_get_words( void* words, const unsigned char* bytes, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        const uint32_t word = io_get_u32( bytes + 4 * i );
        memcpy( (unsigned char*)words + 4 * i, &word, sizeof word );
    }
}
