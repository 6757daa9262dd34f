// AVX2: lane8 in one 256-bit register, masks as registers whose lanes are all ones or all zeros, lane16 as two lane8.
#pragma once

#include <immintrin.h>

#define LANE_BACKEND "avx2"
#define LANE16_REGISTERS 2

#include "lane_ymm.h"

typedef __m256 lane8m;

LANE_INLINE lane8m lane8_lt( lane8 a, lane8 b )
{
    return _mm256_cmp_ps( a, b, _CMP_LT_OQ );
}

LANE_INLINE lane8m lane8_le( lane8 a, lane8 b )
{
    return _mm256_cmp_ps( a, b, _CMP_LE_OQ );
}

LANE_INLINE lane8m lane8_eq( lane8 a, lane8 b )
{
    return _mm256_cmp_ps( a, b, _CMP_EQ_OQ );
}

LANE_INLINE lane8 lane8_select( lane8m m, lane8 a, lane8 b )
{
    return _mm256_blendv_ps( b, a, m );
}

LANE_INLINE lane8m lane8i_eq( lane8i a, lane8i b )
{
    return _mm256_castsi256_ps( _mm256_cmpeq_epi32( a, b ) );
}

LANE_INLINE lane8m lane8i_lt( lane8i a, lane8i b )
{
    return _mm256_castsi256_ps( _mm256_cmpgt_epi32( b, a ) );
}

LANE_INLINE lane8i lane8i_select( lane8m m, lane8i a, lane8i b )
{
    return _mm256_castps_si256( _mm256_blendv_ps( _mm256_castsi256_ps( b ), _mm256_castsi256_ps( a ), m ) );
}

LANE_INLINE lane8m lane8m_and( lane8m a, lane8m b )
{
    return _mm256_and_ps( a, b );
}

LANE_INLINE lane8m lane8m_or( lane8m a, lane8m b )
{
    return _mm256_or_ps( a, b );
}

LANE_INLINE lane8m lane8m_and_not( lane8m a, lane8m b )
{
    return _mm256_andnot_ps( b, a );
}

LANE_INLINE lane8m lane8m_not( lane8m a )
{
    return _mm256_xor_ps( a, _mm256_castsi256_ps( _mm256_set1_epi32( -1 ) ) );
}

LANE_INLINE uint32_t lane8m_bits( lane8m a )
{
    return (uint32_t)_mm256_movemask_ps( a );
}

// Row m of the table lists the set bits of m, the lowest in the lowest byte: which lanes move to the front.
// The preprocessor folds bits 7..0 into one number: a set bit i shifts a byte in and writes i there.
#define LANE_BIT( m, i ) ( (uint64_t)( m ) >> (i)&1u )
#define LANE_PUSH( m, i, row ) ( ( row ) << ( 8u * LANE_BIT( m, i ) ) | (i)*LANE_BIT( m, i ) )
#define LANE_ROW_HIGH( m ) LANE_PUSH( m, 4u, LANE_PUSH( m, 5u, LANE_PUSH( m, 6u, LANE_PUSH( m, 7u, (uint64_t)0 ) ) ) )
#define LANE_ROW( m )                                                                                                \
    LANE_PUSH( m, 0u, LANE_PUSH( m, 1u, LANE_PUSH( m, 2u, LANE_PUSH( m, 3u, LANE_ROW_HIGH( m ) ) ) ) )
#define LANE_ROWS_4( m ) LANE_ROW( m ), LANE_ROW( m + 1 ), LANE_ROW( m + 2 ), LANE_ROW( m + 3 )
#define LANE_ROWS_16( m ) LANE_ROWS_4( m ), LANE_ROWS_4( m + 4 ), LANE_ROWS_4( m + 8 ), LANE_ROWS_4( m + 12 )
#define LANE_ROWS_64( m ) LANE_ROWS_16( m ), LANE_ROWS_16( m + 16 ), LANE_ROWS_16( m + 32 ), LANE_ROWS_16( m + 48 )

static const uint64_t lane_compress_rows[256] = { LANE_ROWS_64( 0 ), LANE_ROWS_64( 64 ), LANE_ROWS_64( 128 ),
                                                  LANE_ROWS_64( 192 ) };

#undef LANE_BIT
#undef LANE_PUSH
#undef LANE_ROW_HIGH
#undef LANE_ROW
#undef LANE_ROWS_4
#undef LANE_ROWS_16
#undef LANE_ROWS_64

LANE_INLINE int lane8i_compress_store( int32_t* out, lane8i v, uint32_t bits )
{
    __m128i bytes = _mm_loadl_epi64( (const __m128i*)&lane_compress_rows[bits] );
    _mm256_storeu_si256( (__m256i*)out, _mm256_permutevar8x32_epi32( v, _mm256_cvtepu8_epi32( bytes ) ) );
    return __builtin_popcount( bits );
}

#define LANE_WIDE lane16
#define LANE_HALF lane8
#define LANE_HALF_COUNT 8
#include "lane_pair.h"
#undef LANE_WIDE
#undef LANE_HALF
#undef LANE_HALF_COUNT
