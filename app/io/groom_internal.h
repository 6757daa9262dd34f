/// What the groom files share and nobody else sees.
#pragma once

#include <string.h>

#include "groom.h"

enum
{
    GROOM_THICKNESS = 1,
    GROOM_TRANSPARENCY = 2,
    GROOM_COLOUR = 4,
};

/// Allocate the arrays, contents undefined.
/// @param columns GROOM_THICKNESS, GROOM_TRANSPARENCY and GROOM_COLOUR, or-ed
/// @return WISP_NO_MEMORY and an empty groom
wisp_status groom_allocate( wisp_groom* groom, int strand_count, int vertex_count, int columns, const char* name,
                            wisp_error* error );

/// Malformed or not finite: what readers and writers refuse. wisp_groom_check() asks for more.
wisp_status groom_check_finite( const wisp_groom* groom, const char* name, wisp_error* error );

/// 2 when every z is zero, else 3.
int groom_dimension_of( const wisp_groom* groom );

// Both formats are little-endian. Bytes are put together one by one: a file may start at any address, and the machine
// that reads it may be big-endian.

static inline uint32_t groom_get_u16( const unsigned char* bytes )
{
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8;
}

static inline uint32_t groom_get_u32( const unsigned char* bytes )
{
    return groom_get_u16( bytes ) | groom_get_u16( bytes + 2 ) << 16;
}

static inline float groom_get_float( const unsigned char* bytes )
{
    uint32_t bits = groom_get_u32( bytes );
    float value;
    memcpy( &value, &bits, sizeof value );
    return value;
}

static inline wisp_vec3 groom_get_vec3( const unsigned char* bytes )
{
    return ( wisp_vec3 ){ groom_get_float( bytes ), groom_get_float( bytes + 4 ), groom_get_float( bytes + 8 ) };
}

static inline void groom_put_u16( unsigned char* bytes, uint32_t value )
{
    bytes[0] = (unsigned char)( value & 255 );
    bytes[1] = (unsigned char)( value >> 8 & 255 );
}

static inline void groom_put_u32( unsigned char* bytes, uint32_t value )
{
    groom_put_u16( bytes, value );
    groom_put_u16( bytes + 2, value >> 16 );
}

static inline void groom_put_float( unsigned char* bytes, float value )
{
    uint32_t bits;
    memcpy( &bits, &value, sizeof bits );
    groom_put_u32( bytes, bits );
}

static inline void groom_put_vec3( unsigned char* bytes, wisp_vec3 value )
{
    groom_put_float( bytes, value.x );
    groom_put_float( bytes + 4, value.y );
    groom_put_float( bytes + 8, value.z );
}
