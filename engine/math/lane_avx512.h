// AVX-512 (F, VL, BW, DQ): lane16 in one 512-bit register, lane8 in a 256-bit one, masks in mask registers.
#pragma once

#if defined( LANE_EMULATE_AVX512 )
#include "lane_simde.h"
#else
#include <immintrin.h>
#endif

#define LANE_BACKEND "avx512"
#define LANE16_REGISTERS 1

#include "lane_ymm.h"

typedef __mmask8 lane8m;

// Compressing in a register and storing all of it is many times faster on some processors than vpcompressd to memory.
LANE_INLINE int lane8i_compress_store( int32_t* out, lane8i v, uint32_t bits )
{
    _mm256_storeu_si256( (__m256i*)out, _mm256_maskz_compress_epi32( (__mmask8)bits, v ) );
    return __builtin_popcount( bits );
}

typedef __m512 lane16;
typedef __m512i lane16i;
typedef __mmask16 lane16m;

#define LANE_P lane16
#define LANE_REGISTER _mm512
#define LANE_INTEGERS si512
#include "lane_register.h"
#undef LANE_P
#undef LANE_REGISTER
#undef LANE_INTEGERS

LANE_INLINE lane16 lane16_join( lane8 lower, lane8 upper )
{
    return _mm512_insertf32x8( _mm512_castps256_ps512( lower ), upper, 1 );
}

LANE_INLINE lane16i lane16i_join( lane8i lower, lane8i upper )
{
    return _mm512_inserti32x8( _mm512_castsi256_si512( lower ), upper, 1 );
}

LANE_INLINE lane16 lane16_floor( lane16 a )
{
    return _mm512_floor_ps( a );
}

LANE_INLINE float lane16_sum_ordered( lane16 a )
{
    lane8 lower = _mm512_castps512_ps256( a );
    lane8 upper = _mm256_castpd_ps( _mm512_extractf64x4_pd( _mm512_castps_pd( a ), 1 ) );
    return lane8_sum_ordered( _mm256_add_ps( lower, upper ) );
}

LANE_INLINE lane16i lane16i_mul( lane16i a, lane16i b )
{
    return _mm512_mullo_epi32( a, b );
}

// Macros, because the instruction holds the count and an unoptimised function would pass it as a variable.
#define lane16i_shift_left( a, count ) _mm512_slli_epi32( a, count )
#define lane16i_shift_right( a, count ) _mm512_srli_epi32( a, count )

LANE_INLINE lane16i lane16i_iota( void )
{
    return _mm512_setr_epi32( 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 );
}

// Mask registers are plain unsigned integers, so one text serves both widths.
#define MASK_RESULT( R, parameters, name, expression )                                                               \
    LANE_INLINE R name parameters                                                                                    \
    {                                                                                                                \
        return (R)( expression );                                                                                    \
    }

#define MASKS( P, register )                                                                                         \
    MASK_RESULT( P##m, ( P a, P b ), P##_lt, register##_cmp_ps_mask( a, b, _CMP_LT_OQ ) )                            \
    MASK_RESULT( P##m, ( P a, P b ), P##_le, register##_cmp_ps_mask( a, b, _CMP_LE_OQ ) )                            \
    MASK_RESULT( P##m, ( P a, P b ), P##_eq, register##_cmp_ps_mask( a, b, _CMP_EQ_OQ ) )                            \
    MASK_RESULT( P, ( P##m m, P a, P b ), P##_select, register##_mask_blend_ps( m, b, a ) )                          \
    MASK_RESULT( P##m, ( P##i a, P##i b ), P##i_eq, register##_cmpeq_epi32_mask( a, b ) )                            \
    MASK_RESULT( P##m, ( P##i a, P##i b ), P##i_lt, register##_cmpgt_epi32_mask( b, a ) )                            \
    MASK_RESULT( P##i, ( P##m m, P##i a, P##i b ), P##i_select, register##_mask_blend_epi32( m, b, a ) )             \
    MASK_RESULT( P##m, ( P##m a, P##m b ), P##m_and, ( a ) & ( b ) )                                                 \
    MASK_RESULT( P##m, ( P##m a, P##m b ), P##m_or, ( a ) | ( b ) )                                                  \
    MASK_RESULT( P##m, ( P##m a, P##m b ), P##m_and_not, a & ~b )                                                    \
    MASK_RESULT( P##m, ( P##m a ), P##m_not, ~a )                                                                    \
    MASK_RESULT( uint32_t, ( P##m a ), P##m_bits, a )

MASKS( lane8, _mm256 )
MASKS( lane16, _mm512 )

#undef MASKS
#undef MASK_RESULT
