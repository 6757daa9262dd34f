/// Checksums of damaged recordings made right, so that what they protect is read. From the description of the format.
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

static inline void put_number( unsigned char* bytes, int at, int width, uint64_t value )
{
    for ( int i = 0; i < width; ++i )
    {
        bytes[at + i] = (unsigned char)( value >> 8 * i & 255 );
    }
}

static inline uint64_t bad_recording_get( const unsigned char* bytes, size_t at )
{
    uint64_t value = 0;
    for ( size_t i = 0; i < 8; ++i )
    {
        value |= (uint64_t)bytes[at + i] << 8 * i;
    }
    return value;
}

/// Words of eight bytes, the last one filled up with zeros.
static inline uint64_t bad_recording_checksum( uint64_t seed, const unsigned char* bytes, size_t size )
{
    uint64_t hash = seed ^ ( (uint64_t)size * 0x9e3779b97f4a7c15u );
    for ( size_t at = 0; at < size; at += 8 )
    {
        unsigned char word[8] = { 0 };
        memcpy( word, bytes + at, size - at < 8 ? size - at : 8 );
        hash = ( hash ^ bad_recording_get( word, 0 ) ) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return hash;
}

/// Make every checksum of any bytes right, as far as their header says where they are.
static inline void bad_recording_seal( unsigned char* bytes, size_t size )
{
    if ( size < 48 )
    {
        return;
    }
    uint64_t header = bad_recording_get( bytes, 16 ), frame = bad_recording_get( bytes, 24 );
    if ( header < 48 || header > size || frame < 16 )
    {
        return;
    }
    size_t at = (size_t)header;
    uint64_t seed = bad_recording_checksum( 0, bytes, at - 8 );
    put_number( bytes + at - 8, 0, 8, seed );
    for ( ; frame <= size - at; at += (size_t)frame )
    {
        size_t end = (size_t)frame - 8;
        put_number( bytes + at + end, 0, 8, bad_recording_checksum( seed, bytes + at, end ) );
    }
    if ( size - at == 24 )
    {
        put_number( bytes + at + 16, 0, 8, bad_recording_checksum( seed, bytes + at, 16 ) );
    }
}
