/// Samples of a pixel: points of a (0,2)-sequence (Sobol 1967), scrambled by pixel and purpose with the hash of Burley
/// 2020, "Practical Hash-based Owen Scrambling". Every power of two of them is stratified in all ways at once, and a
/// point is a pure function of pixel, sample and purpose.
#pragma once

#include "wisp/module/random.h"

#include <math.h>

/// The use of a pair of numbers. Two uses never share their scrambling.
typedef enum sampler_purpose
{
    SAMPLER_PIXEL,
    SAMPLER_LIGHT,
    SAMPLER_SKY,
    SAMPLER_MIRROR,
    SAMPLER_PURPOSES,
} sampler_purpose;

/// The samples of one pixel.
typedef struct sampler
{
    uint32_t order[SAMPLER_PURPOSES], x[SAMPLER_PURPOSES], y[SAMPLER_PURPOSES];
    uint32_t mask; ///< a power of two that holds all samples, less one
} sampler;

/// A place in the unit square.
typedef struct sampler_point
{
    float x, y;
} sampler_point;

static inline sampler sampler_of_pixel( wisp_random_key key, int column, int row, int sample_count )
{
    sampler out = { .mask = 1 };
    while ( out.mask < (uint32_t)sample_count )
    {
        out.mask *= 2;
    }
    out.mask -= 1;
    for ( uint32_t purpose = 0; purpose < SAMPLER_PURPOSES; ++purpose )
    {
        uint64_t a = wisp_random_bits( key, (uint32_t)column, (uint32_t)row, 2 * purpose );
        uint64_t b = wisp_random_bits( key, (uint32_t)column, (uint32_t)row, 2 * purpose + 1 );
        out.order[purpose] = (uint32_t)( a >> 32 );
        out.x[purpose] = (uint32_t)a;
        out.y[purpose] = (uint32_t)b;
    }
    return out;
}

static inline uint32_t sampler_reverse( uint32_t v )
{
    v = ( ( v >> 1 ) & 0x55555555u ) | ( ( v & 0x55555555u ) << 1 );
    v = ( ( v >> 2 ) & 0x33333333u ) | ( ( v & 0x33333333u ) << 2 );
    v = ( ( v >> 4 ) & 0x0F0F0F0Fu ) | ( ( v & 0x0F0F0F0Fu ) << 4 );
    return __builtin_bswap32( v );
}

/// Each bit is flipped by a hash of the bits below it: Owen's scrambling of a number whose bits are reversed.
static inline uint32_t sampler_scramble( uint32_t v, uint32_t seed )
{
    v += seed;
    v ^= v * 0x6c50b47cu;
    v ^= v * 0xb82f1e52u;
    v ^= v * 0xc7afe638u;
    v ^= v * 0x8d22f6e6u;
    return v;
}

/// The second coordinate of the sequence with its bits reversed: Pascal's triangle, modulo two.
static inline uint32_t sampler_second( uint32_t index )
{
    uint32_t out = 0;
    for ( uint32_t column = 1; index != 0; index >>= 1, column ^= column << 1 )
    {
        out ^= index & 1u ? column : 0u;
    }
    return out;
}

/// Point `sample` of a pixel. In both coordinates below one.
static inline sampler_point sampler_at( const sampler* s, int sample, sampler_purpose purpose )
{
    // The low bits of a scramble depend on nothing above them, so the mask leaves a permutation of the samples.
    uint32_t index = sampler_scramble( (uint32_t)sample, s->order[purpose] ) & s->mask;
    uint32_t x = sampler_reverse( sampler_scramble( index, s->x[purpose] ) );
    uint32_t y = sampler_reverse( sampler_scramble( sampler_second( index ), s->y[purpose] ) );
    return ( sampler_point ){ (float)( x >> 8 ) * 0x1p-24f, (float)( y >> 8 ) * 0x1p-24f };
}
