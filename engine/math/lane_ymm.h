// Eight lanes in one 256-bit register: everything that involves no mask. AVX2 and AVX-512 share it and differ in masks.
#pragma once

typedef __m256 lane8;
typedef __m256i lane8i;

#define LANE_P lane8
#define LANE_REGISTER _mm256
#define LANE_INTEGERS si256
#include "lane_register.h"
#undef LANE_P
#undef LANE_REGISTER
#undef LANE_INTEGERS

#define lane8i_shift_left( a, count ) _mm256_slli_epi32( a, count )
#define lane8i_shift_right( a, count ) _mm256_srli_epi32( a, count )

LANE_INLINE lane8 lane8_floor( lane8 a )
{
    return _mm256_floor_ps( a );
}

LANE_INLINE float lane8_sum_ordered( lane8 a )
{
    __m128 four = _mm_add_ps( _mm256_castps256_ps128( a ), _mm256_extractf128_ps( a, 1 ) );
    __m128 two = _mm_add_ps( four, _mm_movehl_ps( four, four ) );
    return _mm_cvtss_f32( _mm_add_ss( two, _mm_shuffle_ps( two, two, 1 ) ) );
}

LANE_INLINE lane8i lane8i_mul( lane8i a, lane8i b )
{
    return _mm256_mullo_epi32( a, b );
}

LANE_INLINE lane8i lane8i_iota( void )
{
    return _mm256_setr_epi32( 0, 1, 2, 3, 4, 5, 6, 7 );
}

// Within each 128-bit half: four quads in, their x, y, z and w out; applied twice it is the identity.
LANE_INLINE void lane8_transpose_quads( lane8 q[4] )
{
    lane8 xy01 = _mm256_unpacklo_ps( q[0], q[1] );
    lane8 xy23 = _mm256_unpacklo_ps( q[2], q[3] );
    lane8 zw01 = _mm256_unpackhi_ps( q[0], q[1] );
    lane8 zw23 = _mm256_unpackhi_ps( q[2], q[3] );
    q[0] = _mm256_shuffle_ps( xy01, xy23, _MM_SHUFFLE( 1, 0, 1, 0 ) );
    q[1] = _mm256_shuffle_ps( xy01, xy23, _MM_SHUFFLE( 3, 2, 3, 2 ) );
    q[2] = _mm256_shuffle_ps( zw01, zw23, _MM_SHUFFLE( 1, 0, 1, 0 ) );
    q[3] = _mm256_shuffle_ps( zw01, zw23, _MM_SHUFFLE( 3, 2, 3, 2 ) );
}

LANE_INLINE void lane8_load_quads( const float* xyzw, const int32_t* index, lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        __m128 lower = _mm_load_ps( xyzw + (ptrdiff_t)index[r] );
        __m128 upper = _mm_load_ps( xyzw + (ptrdiff_t)index[r + 4] );
        q[r] = _mm256_insertf128_ps( _mm256_castps128_ps256( lower ), upper, 1 );
    }
}

LANE_INLINE void lane8_store_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        _mm_store_ps( xyzw + (ptrdiff_t)index[r], _mm256_castps256_ps128( q[r] ) );
        _mm_store_ps( xyzw + (ptrdiff_t)index[r + 4], _mm256_extractf128_ps( q[r], 1 ) );
    }
}

LANE_INLINE void lane8_add_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int l = 0; l < 8; ++l )
    {
        float* to = xyzw + (ptrdiff_t)index[l];
        const __m128 quad = l < 4 ? _mm256_castps256_ps128( q[l % 4] ) : _mm256_extractf128_ps( q[l % 4], 1 );
        _mm_store_ps( to, _mm_add_ps( _mm_load_ps( to ), quad ) );
    }
}

// Bytes move within their half; a negative number makes a zero.
LANE_INLINE void lane8_spread_xyz( lane8 a, lane8 q[4] )
{
    const __m256i bytes = _mm256_castps_si256( a );
    const __m256i first =
        _mm256_setr_epi32( 0x03020100, 0x03020100, 0x03020100, -1, 0x03020100, 0x03020100, 0x03020100, -1 );
    for ( int r = 0; r < 4; ++r )
    {
        const __m256i from = _mm256_or_si256( first, _mm256_set1_epi32( 0x04040404 * r ) );
        q[r] = _mm256_castsi256_ps( _mm256_shuffle_epi8( bytes, from ) );
    }
}

// A number of each quad, four times.
#define lane8_spread_number( row, number ) _mm256_permute_ps( row, 0x55 * ( number ) )

#define LANE_COMPRESSES_IN_REGISTERS
#define LANE_TRANSPOSES_IN_REGISTERS
LANE_INLINE void lane8i_transpose( lane8i rows[8] )
{
    lane8i pairs[8], fours[8];
    for ( int i = 0; i < 4; ++i )
    {
        pairs[2 * i] = _mm256_unpacklo_epi32( rows[2 * i], rows[2 * i + 1] );
        pairs[2 * i + 1] = _mm256_unpackhi_epi32( rows[2 * i], rows[2 * i + 1] );
    }
    for ( int i = 0; i < 2; ++i )
    {
        fours[4 * i] = _mm256_unpacklo_epi64( pairs[4 * i], pairs[4 * i + 2] );
        fours[4 * i + 1] = _mm256_unpackhi_epi64( pairs[4 * i], pairs[4 * i + 2] );
        fours[4 * i + 2] = _mm256_unpacklo_epi64( pairs[4 * i + 1], pairs[4 * i + 3] );
        fours[4 * i + 3] = _mm256_unpackhi_epi64( pairs[4 * i + 1], pairs[4 * i + 3] );
    }
    for ( int i = 0; i < 4; ++i )
    {
        rows[i] = _mm256_permute2x128_si256( fours[i], fours[i + 4], 0x20 );
        rows[i + 4] = _mm256_permute2x128_si256( fours[i], fours[i + 4], 0x31 );
    }
}
