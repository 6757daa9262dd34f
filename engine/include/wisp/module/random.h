/// Counter-based random numbers: a pure function of (seed, stream, event) and of the element's three coordinates.
/// There is no generator state, so the order of execution and the number of threads cannot change a number.
///
/// The hash is pcg4d (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering"): 32-bit operations only, so
/// that sixteen lanes draw at once. lane_random.h holds the same function in lanes, bit for bit.
#pragma once

#include "wisp/base.h"

/// (seed, stream, event) mixed once, outside any loop.
typedef struct wisp_random_key
{
    uint32_t word[4];
} wisp_random_key;

/// The finaliser of splitmix64 (Steele, Lea, Flood 2014).
static inline uint64_t wisp_random_mix( uint64_t z )
{
    z = ( z ^ ( z >> 30 ) ) * 0xbf58476d1ce4e5b9u;
    z = ( z ^ ( z >> 27 ) ) * 0x94d049bb133111ebu;
    return z ^ ( z >> 31 );
}

static inline wisp_random_key wisp_random_make_key( uint64_t seed, uint64_t stream, uint64_t event )
{
    const uint64_t golden = 0x9e3779b97f4a7c15u;
    uint64_t a = wisp_random_mix( seed + golden );
    a = wisp_random_mix( a ^ ( stream + golden ) );
    a = wisp_random_mix( a ^ ( event + golden ) );
    uint64_t b = wisp_random_mix( a + golden );
    wisp_random_key key = { { (uint32_t)( a >> 32 ), (uint32_t)a, (uint32_t)( b >> 32 ), (uint32_t)b } };
    return key;
}

/// 64 random bits of element (a, b, c), for instance (strand, vertex, iteration).
static inline uint64_t wisp_random_bits( wisp_random_key key, uint32_t a, uint32_t b, uint32_t c )
{
    uint32_t x = ( a ^ key.word[0] ) * 1664525u + 1013904223u;
    uint32_t y = ( b ^ key.word[1] ) * 1664525u + 1013904223u;
    uint32_t z = ( c ^ key.word[2] ) * 1664525u + 1013904223u;
    uint32_t w = key.word[3] * 1664525u + 1013904223u;
    x += y * w;
    y += z * x;
    z += x * y;
    w += y * z;
    x ^= x >> 16;
    y ^= y >> 16;
    z ^= z >> 16;
    w ^= w >> 16;
    x += y * w;
    y += z * x;
    return ( (uint64_t)x << 32 ) | y;
}

/// Uniform in [0, 1), 53 bits.
static inline double wisp_random_unit( wisp_random_key key, uint32_t a, uint32_t b, uint32_t c )
{
    return (double)( wisp_random_bits( key, a, b, c ) >> 11 ) * 1.1102230246251565e-16; // 2^-53
}

/// Uniform in [0, 1), the top 24 bits of wisp_random_unit(): lower than it by less than 2^-24.
static inline float wisp_random_unit_float( wisp_random_key key, uint32_t a, uint32_t b, uint32_t c )
{
    return (float)( wisp_random_bits( key, a, b, c ) >> 40 ) * 5.9604644775390625e-8f; // 2^-24
}
