// The baseline of every x86-64: lane4 in one 128-bit register, lane8 as two of them, lane16 as four.
// lane4 is a building block of this file and no part of lane.h's promise.
#pragma once

#include <emmintrin.h>

#define LANE_BACKEND "sse2"
#define LANE16_REGISTERS 4

typedef __m128 lane4;
typedef __m128i lane4i;
typedef __m128 lane4m; // all bits of a lane set, or none

#define LANE_P lane4
#define LANE_REGISTER _mm
#define LANE_INTEGERS si128
#include "lane_register.h"
#undef LANE_P
#undef LANE_REGISTER
#undef LANE_INTEGERS

#define lane4i_shift_left( a, count ) _mm_slli_epi32( a, count )
#define lane4i_shift_right( a, count ) _mm_srli_epi32( a, count )

LANE_INLINE lane4m lane4_lt( lane4 a, lane4 b )
{
    return _mm_cmplt_ps( a, b );
}

LANE_INLINE lane4m lane4_le( lane4 a, lane4 b )
{
    return _mm_cmple_ps( a, b );
}

LANE_INLINE lane4m lane4_eq( lane4 a, lane4 b )
{
    return _mm_cmpeq_ps( a, b );
}

LANE_INLINE lane4 lane4_select( lane4m m, lane4 a, lane4 b )
{
    return _mm_or_ps( _mm_and_ps( m, a ), _mm_andnot_ps( m, b ) );
}

// SSE2 cannot round to an integral float. Below 2^23 truncation goes through int32 and is put right for negative
// fractions; from there on (and for NaN) a float is its own floor. The sign bit is carried over for the sake of -0.
LANE_INLINE lane4 lane4_floor( lane4 a )
{
    const lane4 sign_bit = _mm_set1_ps( -0.0f );
    lane4 truncated = _mm_cvtepi32_ps( _mm_cvttps_epi32( a ) );
    lane4 below = _mm_sub_ps( truncated, _mm_and_ps( _mm_cmplt_ps( a, truncated ), _mm_set1_ps( 1.0f ) ) );
    lane4 is_small = _mm_cmplt_ps( _mm_andnot_ps( sign_bit, a ), _mm_set1_ps( 0x1p23f ) );
    return lane4_select( is_small, _mm_or_ps( below, _mm_and_ps( sign_bit, a ) ), a );
}

LANE_INLINE float lane4_sum_ordered( lane4 a )
{
    lane4 two = _mm_add_ps( a, _mm_movehl_ps( a, a ) );
    return _mm_cvtss_f32( _mm_add_ss( two, _mm_shuffle_ps( two, two, 1 ) ) );
}

// SSE2 multiplies only lanes 0 and 2, to 64 bits; the odd lanes are brought there and the low halves put back.
LANE_INLINE lane4i lane4i_mul( lane4i a, lane4i b )
{
    lane4i even = _mm_mul_epu32( a, b );
    lane4i odd = _mm_mul_epu32( _mm_srli_epi64( a, 32 ), _mm_srli_epi64( b, 32 ) );
    lane4i even_low = _mm_shuffle_epi32( even, _MM_SHUFFLE( 0, 0, 2, 0 ) );
    lane4i odd_low = _mm_shuffle_epi32( odd, _MM_SHUFFLE( 0, 0, 2, 0 ) );
    return _mm_unpacklo_epi32( even_low, odd_low );
}

LANE_INLINE lane4m lane4i_eq( lane4i a, lane4i b )
{
    return _mm_castsi128_ps( _mm_cmpeq_epi32( a, b ) );
}

LANE_INLINE lane4m lane4i_lt( lane4i a, lane4i b )
{
    return _mm_castsi128_ps( _mm_cmplt_epi32( a, b ) );
}

LANE_INLINE lane4i lane4i_select( lane4m m, lane4i a, lane4i b )
{
    return _mm_castps_si128( lane4_select( m, _mm_castsi128_ps( a ), _mm_castsi128_ps( b ) ) );
}

LANE_INLINE lane4i lane4i_iota( void )
{
    return _mm_setr_epi32( 0, 1, 2, 3 );
}

LANE_INLINE lane4m lane4m_and( lane4m a, lane4m b )
{
    return _mm_and_ps( a, b );
}

LANE_INLINE lane4m lane4m_or( lane4m a, lane4m b )
{
    return _mm_or_ps( a, b );
}

LANE_INLINE lane4m lane4m_and_not( lane4m a, lane4m b )
{
    return _mm_andnot_ps( b, a );
}

LANE_INLINE lane4m lane4m_not( lane4m a )
{
    return _mm_xor_ps( a, _mm_castsi128_ps( _mm_set1_epi32( -1 ) ) );
}

LANE_INLINE uint32_t lane4m_bits( lane4m a )
{
    return (uint32_t)_mm_movemask_ps( a );
}

#define LANE_WIDE lane8
#define LANE_HALF lane4
#define LANE_HALF_COUNT 4
#include "lane_pair.h"
#undef LANE_WIDE
#undef LANE_HALF
#undef LANE_HALF_COUNT

#define LANE_WIDE lane16
#define LANE_HALF lane8
#define LANE_HALF_COUNT 8
#include "lane_pair.h"
#undef LANE_WIDE
#undef LANE_HALF
#undef LANE_HALF_COUNT

// Four quads in, their x, y, z and w out; applied twice it is the identity.
LANE_INLINE void lane4_transpose( lane4 q[4] )
{
    lane4 xy01 = _mm_unpacklo_ps( q[0], q[1] );
    lane4 xy23 = _mm_unpacklo_ps( q[2], q[3] );
    lane4 zw01 = _mm_unpackhi_ps( q[0], q[1] );
    lane4 zw23 = _mm_unpackhi_ps( q[2], q[3] );
    q[0] = _mm_movelh_ps( xy01, xy23 );
    q[1] = _mm_movehl_ps( xy23, xy01 );
    q[2] = _mm_movelh_ps( zw01, zw23 );
    q[3] = _mm_movehl_ps( zw23, zw01 );
}

LANE_INLINE void lane8_transpose_quads( lane8 q[4] )
{
    lane4 lower[4] = { q[0].lower, q[1].lower, q[2].lower, q[3].lower };
    lane4 upper[4] = { q[0].upper, q[1].upper, q[2].upper, q[3].upper };
    lane4_transpose( lower );
    lane4_transpose( upper );
    for ( int r = 0; r < 4; ++r )
    {
        q[r] = ( lane8 ){ lower[r], upper[r] };
    }
}

LANE_INLINE void lane8_load_quads( const float* xyzw, const int32_t* index, lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        q[r].lower = _mm_load_ps( xyzw + (ptrdiff_t)index[r] );
        q[r].upper = _mm_load_ps( xyzw + (ptrdiff_t)index[r + 4] );
    }
}

LANE_INLINE void lane8_store_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        _mm_store_ps( xyzw + (ptrdiff_t)index[r], q[r].lower );
        _mm_store_ps( xyzw + (ptrdiff_t)index[r + 4], q[r].upper );
    }
}

LANE_INLINE void lane8_add_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int l = 0; l < 8; ++l )
    {
        float* to = xyzw + (ptrdiff_t)index[l];
        _mm_store_ps( to, _mm_add_ps( _mm_load_ps( to ), l < 4 ? q[l % 4].lower : q[l % 4].upper ) );
    }
}

// A number of each quad, four times.
#define lane8_spread_number( row, number )                                                                           \
    ( lane8 )                                                                                                        \
    {                                                                                                                \
        _mm_shuffle_ps( ( row ).lower, ( row ).lower, 0x55 * ( number ) ),                                           \
            _mm_shuffle_ps( ( row ).upper, ( row ).upper, 0x55 * ( number ) )                                        \
    }

LANE_INLINE void lane8_spread_xyz( lane8 a, lane8 q[4] )
{
    const lane4 xyz = _mm_castsi128_ps( _mm_setr_epi32( -1, -1, -1, 0 ) );
    q[0] = lane8_spread_number( a, 0 );
    q[1] = lane8_spread_number( a, 1 );
    q[2] = lane8_spread_number( a, 2 );
    q[3] = lane8_spread_number( a, 3 );
    for ( int r = 0; r < 4; ++r )
    {
        q[r] = ( lane8 ){ _mm_and_ps( q[r].lower, xyz ), _mm_and_ps( q[r].upper, xyz ) };
    }
}
