/// Eight doubles at once, for kernels whose results need more digits than a float has: lane8d, with masks lane8dm.
/// As in lane.h, every operation is a single correctly rounded IEEE operation, so every backend gives the same bits.
///
///   lane8d_set1( d )
///   lane8d_widen( lane8 ) lane8d_narrow( a )   exact; round to nearest
///   lane8d_add lane8d_sub lane8d_mul lane8d_div lane8d_sqrt
///   lane8d_abs                                 touches the sign bit only
///   lane8d_lt( a, b )                          -> lane8dm, false if one is NaN
///   lane8d_select( m, a, b )                   m ? a : b
///   lane8d_storeu( double*, a )
///   lane8d_sum_ordered                         -> double; adds lane l and l + half, and again, until one is left
///   lane8dm_bits                               -> uint32_t, bit l is lane l
#pragma once

#include "lane.h"

#include <math.h>

// A register of doubles, and how many of them hold eight.
#if defined( LANE_PLAIN )
#define DOUBLE_REGISTERS 8
typedef double lane_double;
typedef bool lane_double_mask;
#elif defined( LANE_EMULATE_AVX512 ) ||                                                                              \
    ( defined( __AVX512F__ ) && defined( __AVX512VL__ ) && defined( __AVX512BW__ ) && defined( __AVX512DQ__ ) )
#define DOUBLE_REGISTERS 1
#define DOUBLE_AVX512
typedef __m512d lane_double;
typedef __mmask8 lane_double_mask;
#elif defined( __AVX2__ )
#define DOUBLE_REGISTERS 2
#define DOUBLE_AVX2
typedef __m256d lane_double;
typedef __m256d lane_double_mask;
#elif defined( __SSE2__ )
#define DOUBLE_REGISTERS 4
#define DOUBLE_SSE2
typedef __m128d lane_double;
typedef __m128d lane_double_mask;
#else
#define DOUBLE_REGISTERS 8
typedef double lane_double;
typedef bool lane_double_mask;
#endif

typedef struct lane8d
{
    lane_double r[DOUBLE_REGISTERS];
} lane8d;

typedef struct lane8dm
{
    lane_double_mask r[DOUBLE_REGISTERS];
} lane8dm;

#if defined( DOUBLE_AVX512 )

#define DOUBLE_LT( a, b ) _mm512_cmp_pd_mask( a, b, _CMP_LT_OQ )
#define DOUBLE_SELECT( m, a, b ) _mm512_mask_blend_pd( m, b, a )
#define DOUBLE_REGISTER _mm512
#define DOUBLE_BITS( m ) ( uint32_t )( m )

LANE_INLINE lane8d lane8d_widen( lane8 a )
{
    return ( lane8d ){ { _mm512_cvtps_pd( a ) } };
}

LANE_INLINE lane8 lane8d_narrow( lane8d a )
{
    return _mm512_cvtpd_ps( a.r[0] );
}

#elif defined( DOUBLE_AVX2 )

#define DOUBLE_LT( a, b ) _mm256_cmp_pd( a, b, _CMP_LT_OQ )
#define DOUBLE_SELECT( m, a, b ) _mm256_blendv_pd( b, a, m )
#define DOUBLE_REGISTER _mm256
#define DOUBLE_BITS( m ) ( uint32_t ) _mm256_movemask_pd( m )

LANE_INLINE lane8d lane8d_widen( lane8 a )
{
    return ( lane8d ){ { _mm256_cvtps_pd( _mm256_castps256_ps128( a ) ),
                         _mm256_cvtps_pd( _mm256_extractf128_ps( a, 1 ) ) } };
}

LANE_INLINE lane8 lane8d_narrow( lane8d a )
{
    return _mm256_set_m128( _mm256_cvtpd_ps( a.r[1] ), _mm256_cvtpd_ps( a.r[0] ) );
}

#elif defined( DOUBLE_SSE2 )

#define DOUBLE_LT( a, b ) _mm_cmplt_pd( a, b )
#define DOUBLE_SELECT( m, a, b ) _mm_or_pd( _mm_and_pd( m, a ), _mm_andnot_pd( m, b ) )
#define DOUBLE_REGISTER _mm
#define DOUBLE_BITS( m ) ( uint32_t ) _mm_movemask_pd( m )

LANE_INLINE lane8d lane8d_widen( lane8 a )
{
    return ( lane8d ){ { _mm_cvtps_pd( a.lower ), _mm_cvtps_pd( _mm_movehl_ps( a.lower, a.lower ) ),
                         _mm_cvtps_pd( a.upper ), _mm_cvtps_pd( _mm_movehl_ps( a.upper, a.upper ) ) } };
}

LANE_INLINE lane8 lane8d_narrow( lane8d a )
{
    return ( lane8 ){ _mm_movelh_ps( _mm_cvtpd_ps( a.r[0] ), _mm_cvtpd_ps( a.r[1] ) ),
                      _mm_movelh_ps( _mm_cvtpd_ps( a.r[2] ), _mm_cvtpd_ps( a.r[3] ) ) };
}

#else

#define DOUBLE_SET1( a ) ( a )
#define DOUBLE_ADD( a, b ) ( ( a ) + ( b ) )
#define DOUBLE_SUB( a, b ) ( ( a ) - ( b ) )
#define DOUBLE_MUL( a, b ) ( ( a ) * ( b ) )
#define DOUBLE_DIV( a, b ) ( ( a ) / ( b ) )
#define DOUBLE_SQRT( a ) sqrt( a )
#define DOUBLE_ABS( a ) fabs( a )
#define DOUBLE_LT( a, b ) ( ( a ) < ( b ) )
#define DOUBLE_SELECT( m, a, b ) ( ( m ) ? ( a ) : ( b ) )
#define DOUBLE_STORE( to, a ) ( *( to ) = ( a ) )
#define DOUBLE_BITS( m ) ( ( m ) ? 1u : 0u )

LANE_INLINE lane8d lane8d_widen( lane8 a )
{
    float each[8];
    lane8_storeu( each, a );
    lane8d wide;
    for ( int l = 0; l < 8; ++l )
    {
        wide.r[l] = (double)each[l];
    }
    return wide;
}

LANE_INLINE lane8 lane8d_narrow( lane8d a )
{
    float each[8];
    for ( int l = 0; l < 8; ++l )
    {
        each[l] = (float)a.r[l];
    }
    return lane8_loadu( each );
}

#endif

#if defined( DOUBLE_REGISTER )
#define DOUBLE_SET1( a ) LANE_JOIN( DOUBLE_REGISTER, _set1_pd )( a )
#define DOUBLE_ADD( a, b ) LANE_JOIN( DOUBLE_REGISTER, _add_pd )( a, b )
#define DOUBLE_SUB( a, b ) LANE_JOIN( DOUBLE_REGISTER, _sub_pd )( a, b )
#define DOUBLE_MUL( a, b ) LANE_JOIN( DOUBLE_REGISTER, _mul_pd )( a, b )
#define DOUBLE_DIV( a, b ) LANE_JOIN( DOUBLE_REGISTER, _div_pd )( a, b )
#define DOUBLE_SQRT( a ) LANE_JOIN( DOUBLE_REGISTER, _sqrt_pd )( a )
#define DOUBLE_ABS( a ) LANE_JOIN( DOUBLE_REGISTER, _andnot_pd )( DOUBLE_SET1( -0.0 ), a )
#define DOUBLE_STORE( to, a ) LANE_JOIN( DOUBLE_REGISTER, _storeu_pd )( to, a )
#endif

#define DOUBLE_EACH( R, parameters, name, expression )                                                               \
    LANE_INLINE R name parameters                                                                                    \
    {                                                                                                                \
        R result;                                                                                                    \
        for ( int k = 0; k < DOUBLE_REGISTERS; ++k )                                                                 \
        {                                                                                                            \
            result.r[k] = expression;                                                                                \
        }                                                                                                            \
        return result;                                                                                               \
    }

DOUBLE_EACH( lane8d, ( double a ), lane8d_set1, DOUBLE_SET1( a ) )
DOUBLE_EACH( lane8d, ( lane8d a, lane8d b ), lane8d_add, DOUBLE_ADD( a.r[k], b.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8d a, lane8d b ), lane8d_sub, DOUBLE_SUB( a.r[k], b.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8d a, lane8d b ), lane8d_mul, DOUBLE_MUL( a.r[k], b.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8d a, lane8d b ), lane8d_div, DOUBLE_DIV( a.r[k], b.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8d a ), lane8d_sqrt, DOUBLE_SQRT( a.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8d a ), lane8d_abs, DOUBLE_ABS( a.r[k] ) )
DOUBLE_EACH( lane8dm, ( lane8d a, lane8d b ), lane8d_lt, DOUBLE_LT( a.r[k], b.r[k] ) )
DOUBLE_EACH( lane8d, ( lane8dm m, lane8d a, lane8d b ), lane8d_select, DOUBLE_SELECT( m.r[k], a.r[k], b.r[k] ) )

LANE_INLINE void lane8d_storeu( double* to, lane8d a )
{
    for ( int k = 0; k < DOUBLE_REGISTERS; ++k )
    {
        DOUBLE_STORE( to + k * ( 8 / DOUBLE_REGISTERS ), a.r[k] );
    }
}

LANE_INLINE double lane8d_sum_ordered( lane8d a )
{
    double each[8];
    lane8d_storeu( each, a );
    return ( ( each[0] + each[4] ) + ( each[2] + each[6] ) ) + ( ( each[1] + each[5] ) + ( each[3] + each[7] ) );
}

LANE_INLINE uint32_t lane8dm_bits( lane8dm m )
{
    uint32_t bits = 0;
    for ( int k = 0; k < DOUBLE_REGISTERS; ++k )
    {
        bits |= DOUBLE_BITS( m.r[k] ) << ( k * ( 8 / DOUBLE_REGISTERS ) );
    }
    return bits;
}

#undef DOUBLE_EACH
#undef DOUBLE_REGISTER
#undef DOUBLE_SET1
#undef DOUBLE_ADD
#undef DOUBLE_SUB
#undef DOUBLE_MUL
#undef DOUBLE_DIV
#undef DOUBLE_SQRT
#undef DOUBLE_ABS
#undef DOUBLE_LT
#undef DOUBLE_SELECT
#undef DOUBLE_STORE
#undef DOUBLE_BITS
