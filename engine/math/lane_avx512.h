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

LANE_INLINE lane8m lane8_lt( lane8 a, lane8 b )
{
    return _mm256_cmp_ps_mask( a, b, _CMP_LT_OQ );
}

LANE_INLINE lane8m lane8_le( lane8 a, lane8 b )
{
    return _mm256_cmp_ps_mask( a, b, _CMP_LE_OQ );
}

LANE_INLINE lane8m lane8_eq( lane8 a, lane8 b )
{
    return _mm256_cmp_ps_mask( a, b, _CMP_EQ_OQ );
}

LANE_INLINE lane8 lane8_select( lane8m m, lane8 a, lane8 b )
{
    return _mm256_mask_blend_ps( m, b, a );
}

LANE_INLINE lane8m lane8i_eq( lane8i a, lane8i b )
{
    return _mm256_cmpeq_epi32_mask( a, b );
}

LANE_INLINE lane8m lane8i_lt( lane8i a, lane8i b )
{
    return _mm256_cmpgt_epi32_mask( b, a );
}

LANE_INLINE lane8i lane8i_select( lane8m m, lane8i a, lane8i b )
{
    return _mm256_mask_blend_epi32( m, b, a );
}

// Compressing in a register and storing all of it is many times faster on some processors than vpcompressd to memory.
LANE_INLINE int lane8i_compress_store( int32_t* out, lane8i v, uint32_t bits )
{
    _mm256_storeu_si256( (__m256i*)out, _mm256_maskz_compress_epi32( (__mmask8)bits, v ) );
    return __builtin_popcount( bits );
}

typedef __m512 lane16;
typedef __m512i lane16i;
typedef __mmask16 lane16m;

LANE_INLINE lane16 lane16_join( lane8 lower, lane8 upper )
{
    return _mm512_insertf32x8( _mm512_castps256_ps512( lower ), upper, 1 );
}

LANE_INLINE lane16i lane16i_join( lane8i lower, lane8i upper )
{
    return _mm512_inserti32x8( _mm512_castsi256_si512( lower ), upper, 1 );
}

LANE_INLINE lane16 lane16_set1( float value )
{
    return _mm512_set1_ps( value );
}

LANE_INLINE lane16 lane16_load( const float* from )
{
    return _mm512_load_ps( from );
}

LANE_INLINE lane16 lane16_loadu( const float* from )
{
    return _mm512_loadu_ps( from );
}

LANE_INLINE void lane16_store( float* to, lane16 a )
{
    _mm512_store_ps( to, a );
}

LANE_INLINE void lane16_storeu( float* to, lane16 a )
{
    _mm512_storeu_ps( to, a );
}

LANE_INLINE lane16 lane16_add( lane16 a, lane16 b )
{
    return _mm512_add_ps( a, b );
}

LANE_INLINE lane16 lane16_sub( lane16 a, lane16 b )
{
    return _mm512_sub_ps( a, b );
}

LANE_INLINE lane16 lane16_mul( lane16 a, lane16 b )
{
    return _mm512_mul_ps( a, b );
}

LANE_INLINE lane16 lane16_div( lane16 a, lane16 b )
{
    return _mm512_div_ps( a, b );
}

LANE_INLINE lane16 lane16_min( lane16 a, lane16 b )
{
    return _mm512_min_ps( a, b );
}

LANE_INLINE lane16 lane16_max( lane16 a, lane16 b )
{
    return _mm512_max_ps( a, b );
}

LANE_INLINE lane16 lane16_sqrt( lane16 a )
{
    return _mm512_sqrt_ps( a );
}

LANE_INLINE lane16 lane16_floor( lane16 a )
{
    return _mm512_floor_ps( a );
}

LANE_INLINE lane16m lane16_lt( lane16 a, lane16 b )
{
    return _mm512_cmp_ps_mask( a, b, _CMP_LT_OQ );
}

LANE_INLINE lane16m lane16_le( lane16 a, lane16 b )
{
    return _mm512_cmp_ps_mask( a, b, _CMP_LE_OQ );
}

LANE_INLINE lane16m lane16_eq( lane16 a, lane16 b )
{
    return _mm512_cmp_ps_mask( a, b, _CMP_EQ_OQ );
}

LANE_INLINE lane16 lane16_select( lane16m m, lane16 a, lane16 b )
{
    return _mm512_mask_blend_ps( m, b, a );
}

LANE_INLINE lane16i lane16_truncate( lane16 a )
{
    return _mm512_cvttps_epi32( a );
}

LANE_INLINE lane16 lane16_from_int( lane16i a )
{
    return _mm512_cvtepi32_ps( a );
}

LANE_INLINE lane16i lane16_cast_int( lane16 a )
{
    return _mm512_castps_si512( a );
}

LANE_INLINE lane16 lane16_cast_float( lane16i a )
{
    return _mm512_castsi512_ps( a );
}

LANE_INLINE float lane16_sum_ordered( lane16 a )
{
    lane8 lower = _mm512_castps512_ps256( a );
    lane8 upper = _mm256_castpd_ps( _mm512_extractf64x4_pd( _mm512_castps_pd( a ), 1 ) );
    return lane8_sum_ordered( _mm256_add_ps( lower, upper ) );
}

LANE_INLINE lane16i lane16i_set1( int32_t value )
{
    return _mm512_set1_epi32( value );
}

LANE_INLINE lane16i lane16i_load( const int32_t* from )
{
    return _mm512_load_si512( from );
}

LANE_INLINE lane16i lane16i_loadu( const int32_t* from )
{
    return _mm512_loadu_si512( from );
}

LANE_INLINE void lane16i_storeu( int32_t* to, lane16i a )
{
    _mm512_storeu_si512( to, a );
}

LANE_INLINE lane16i lane16i_add( lane16i a, lane16i b )
{
    return _mm512_add_epi32( a, b );
}

LANE_INLINE lane16i lane16i_sub( lane16i a, lane16i b )
{
    return _mm512_sub_epi32( a, b );
}

LANE_INLINE lane16i lane16i_mul( lane16i a, lane16i b )
{
    return _mm512_mullo_epi32( a, b );
}

LANE_INLINE lane16i lane16i_and( lane16i a, lane16i b )
{
    return _mm512_and_si512( a, b );
}

LANE_INLINE lane16i lane16i_or( lane16i a, lane16i b )
{
    return _mm512_or_si512( a, b );
}

LANE_INLINE lane16i lane16i_xor( lane16i a, lane16i b )
{
    return _mm512_xor_si512( a, b );
}

// Macros, because the instruction holds the count and an unoptimised function would pass it as a variable.
#define lane16i_shift_left( a, count ) _mm512_slli_epi32( a, count )
#define lane16i_shift_right( a, count ) _mm512_srli_epi32( a, count )

LANE_INLINE lane16m lane16i_eq( lane16i a, lane16i b )
{
    return _mm512_cmpeq_epi32_mask( a, b );
}

LANE_INLINE lane16m lane16i_lt( lane16i a, lane16i b )
{
    return _mm512_cmpgt_epi32_mask( b, a );
}

LANE_INLINE lane16i lane16i_select( lane16m m, lane16i a, lane16i b )
{
    return _mm512_mask_blend_epi32( m, b, a );
}

LANE_INLINE lane16i lane16i_iota( void )
{
    return _mm512_setr_epi32( 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15 );
}

// Mask registers are plain unsigned integers, so the logic of both widths is one text.
#define MASK_LOGIC( M )                                                                                              \
    LANE_INLINE M M##_and( M a, M b )                                                                                \
    {                                                                                                                \
        return (M)( a & b );                                                                                         \
    }                                                                                                                \
    LANE_INLINE M M##_or( M a, M b )                                                                                 \
    {                                                                                                                \
        return (M)( a | b );                                                                                         \
    }                                                                                                                \
    LANE_INLINE M M##_and_not( M a, M b )                                                                            \
    {                                                                                                                \
        return (M)( a & ~b );                                                                                        \
    }                                                                                                                \
    LANE_INLINE M M##_not( M a )                                                                                     \
    {                                                                                                                \
        return (M)~a;                                                                                                \
    }                                                                                                                \
    LANE_INLINE uint32_t M##_bits( M a )                                                                             \
    {                                                                                                                \
        return a;                                                                                                    \
    }

MASK_LOGIC( lane8m )
MASK_LOGIC( lane16m )

#undef MASK_LOGIC
