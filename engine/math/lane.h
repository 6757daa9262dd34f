/// Eight and sixteen floats at once: lane8 and lane16, with int32 lanes (lane8i, lane16i) and masks (lane8m, lane16m).
/// This header and the lane_*.h files it includes are the one place with intrinsics.
///
/// Every operation gives the same bits on every backend: each is a single correctly rounded IEEE operation, or a
/// fixed sequence of them. (Only which NaN comes out of arithmetic on NaNs is left open.) That holds when the
/// compiler does not fuse a multiplication with an addition: build with -ffp-contract=off.
///
/// For P = lane8 or lane16, Pi = lane8i or lane16i, Pm = lane8m or lane16m, l a lane:
///
///   P_set1( f ) P_zero()              the same number in every lane
///   P_load P_store                    aligned to 32 bytes (lane8) or 64 bytes (lane16); P_loadu P_storeu: to 4 bytes
///   P_add P_sub P_mul P_div P_sqrt    IEEE, round to nearest
///   P_mul_add( a, b, c )              a * b + c with two roundings, never fused
///   P_min P_max                       a < b ? a : b and a > b ? a : b: the second operand if one is NaN
///   P_neg P_abs P_floor               neg and abs touch the sign bit only; floor keeps -0
///   P_lt P_le P_gt P_ge P_eq          -> Pm, false if one is NaN
///   P_select( m, a, b )               m ? a : b
///   P_truncate                        -> Pi, towards zero; INT32_MIN for NaN and for what does not fit
///   P_from_int( i )                   -> P, nearest
///   P_cast_int P_cast_float           the same bits seen as the other type: P -> Pi and Pi -> P
///   P_sum_ordered                     -> float; adds lane l and l + half, and again, until one is left
///   Pi_set1 Pi_load Pi_loadu Pi_storeu
///   Pi_add Pi_sub Pi_mul              modulo 2^32
///   Pi_and Pi_or Pi_xor
///   Pi_shift_left Pi_shift_right      by a constant in 0..31; right fills with zeros
///   Pi_eq Pi_lt                       -> Pm, signed
///   Pi_select( m, a, b )              m ? a : b
///   Pi_iota()                         0, 1, 2 ...
///   Pm_and Pm_or Pm_not Pm_and_not    and_not( a, b ) is a & ~b
///   Pm_any Pm_all                     -> bool
///   Pm_bits                           -> uint32_t, bit l is lane l
///   Pm_first( n )                     the lanes l < n; n may be negative or beyond the last lane
///
/// and for eight lanes only
///
///   lane8_load_xyz( quads, index, &x, &y, &z )          lane l gets quads[index[l] + 0..2], index a multiple of 4
///   lane8_load_xyzw( quads, index, &x, &y, &z, &w )     likewise with w
///   lane8_store_xyzw( quads, index, x, y, z, w )        quads[index[l] ..] gets lane l of x, y, z, w
///   lane8_load_xyzw_contiguous( quads, &x, &y, &z, &w ) lane l gets quad l
///   lane8_store_xyzw_contiguous( quads, x, y, z, w )    quad l gets lane l of x, y, z, w
///   lane8_load_quads( quads, index, q )                 four rows: q[r] holds the quads of lanes r and r + 4
///   lane8_store_quads( quads, index, q )
///   lane8_add_quads( quads, index, q )                  adds to rows in the order of lanes; a row may occur twice
///   lane8_transpose_quads( q )                          rows to x, y, z, w in lanes, and back
///   lane8_spread_xyz( a, q )                            rows: lane r of a three times and 0, lane r + 4 likewise
///   lane8_spread_first( row ), _second, _third, _last   that number of each quad, four times
///   lane8i_compress_store( out, v, bits )               -> how many; packs the lanes whose bits are set in front, in
///                                                       lane order; bits < 256; out has room for eight, the rest may be overwritten
///
///   lane8i_transpose( rows )                            rows is lane8i[8]: row l and lane k change places
///   lane8_compress_store( out, v, bits )                the same of floats
///   lane8_sum_doubles( v )                              -> double; adds the lanes in their order, as doubles
///
/// and for sixteen lanes only
///
///   lane16_join( low, high ) lane16i_join( low, high )  of two eights
///
/// Quads are aligned to 16 bytes. They are read by whole 128-bit loads and transposed in registers, which was
/// measured to be faster than gathers.
///
/// LANE_PLAIN forces the backend without intrinsics. LANE_EMULATE_AVX512 compiles the AVX-512 backend over SIMDe,
/// so that its source is tested on a processor that does not have it.
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

// Lanes are worth their name only in registers, so every operation is inlined. Not so under a sanitizer, where each
// carries its checks along and one file would compile for minutes; nor without optimisation, for the debugger's sake.
#if defined( __has_feature )
#define LANE_HAS_FEATURE( name ) __has_feature( name )
#else
#define LANE_HAS_FEATURE( name ) 0
#endif
#if defined( __SANITIZE_ADDRESS__ ) || defined( __SANITIZE_THREAD__ ) || LANE_HAS_FEATURE( address_sanitizer ) ||    \
    LANE_HAS_FEATURE( thread_sanitizer )
#define LANE_INLINE static __attribute__( ( noinline, unused ) )
#elif defined( __OPTIMIZE__ )
#define LANE_INLINE static inline __attribute__( ( always_inline ) )
#else
#define LANE_INLINE static inline
#endif

#define LANE_JOIN_NOW( a, b ) a##b
#define LANE_JOIN( a, b ) LANE_JOIN_NOW( a, b )

#if defined( LANE_PLAIN )
#include "lane_plain.h"
#elif defined( LANE_EMULATE_AVX512 )
#include "lane_avx512.h"
#elif defined( __AVX512F__ ) && defined( __AVX512VL__ ) && defined( __AVX512BW__ ) && defined( __AVX512DQ__ )
#include "lane_avx512.h"
#elif defined( __AVX2__ )
#include "lane_avx2.h"
#elif defined( __SSE2__ )
#include "lane_sse2.h"
#else
#include "lane_plain.h"
#endif

// Backends without wide shuffles transpose and pack through memory.
#if !defined( LANE_TRANSPOSES_IN_REGISTERS )
LANE_INLINE void lane8i_transpose( lane8i rows[8] )
{
    int32_t from[8][8], to[8][8];
    for ( int l = 0; l < 8; ++l )
    {
        lane8i_storeu( from[l], rows[l] );
    }
    for ( int l = 0; l < 8; ++l )
    {
        for ( int k = 0; k < 8; ++k )
        {
            to[k][l] = from[l][k];
        }
    }
    for ( int l = 0; l < 8; ++l )
    {
        rows[l] = lane8i_loadu( to[l] );
    }
}
#endif

#if !defined( LANE_COMPRESSES_IN_REGISTERS )
LANE_INLINE int lane8i_compress_store( int32_t* out, lane8i v, uint32_t bits )
{
    int32_t values[8];
    lane8i_storeu( values, v );
    int count = 0;
    for ( int l = 0; l < 8; ++l )
    {
        out[count] = values[l];
        count += (int)( bits >> l & 1u );
    }
    return count;
}
#endif

LANE_INLINE lane8 lane8_spread_first( lane8 row )
{
    return lane8_spread_number( row, 0 );
}

LANE_INLINE lane8 lane8_spread_second( lane8 row )
{
    return lane8_spread_number( row, 1 );
}

LANE_INLINE lane8 lane8_spread_third( lane8 row )
{
    return lane8_spread_number( row, 2 );
}

LANE_INLINE lane8 lane8_spread_last( lane8 row )
{
    return lane8_spread_number( row, 3 );
}

LANE_INLINE double lane8_sum_doubles( lane8 v )
{
    float each[8];
    lane8_storeu( each, v );
    double sum = 0.0;
    for ( int l = 0; l < 8; ++l )
    {
        sum += (double)each[l];
    }
    return sum;
}

LANE_INLINE int lane8_compress_store( float* out, lane8 v, uint32_t bits )
{
    int32_t packed[8];
    const int count = lane8i_compress_store( packed, lane8_cast_int( v ), bits );
    memcpy( out, packed, sizeof( packed ) );
    return count;
}

LANE_INLINE void lane8_load_xyzw( const float* xyzw, const int32_t* index, lane8* x, lane8* y, lane8* z, lane8* w )
{
    lane8 q[4];
    lane8_load_quads( xyzw, index, q );
    lane8_transpose_quads( q );
    *x = q[0];
    *y = q[1];
    *z = q[2];
    *w = q[3];
}

LANE_INLINE void lane8_load_xyz( const float* xyzw, const int32_t* index, lane8* x, lane8* y, lane8* z )
{
    lane8 w;
    lane8_load_xyzw( xyzw, index, x, y, z, &w );
}

LANE_INLINE void lane8_store_xyzw( float* xyzw, const int32_t* index, lane8 x, lane8 y, lane8 z, lane8 w )
{
    lane8 q[4] = { x, y, z, w };
    lane8_transpose_quads( q );
    lane8_store_quads( xyzw, index, q );
}

static const int32_t lane_quad_iota[8] = { 0, 4, 8, 12, 16, 20, 24, 28 };

LANE_INLINE void lane8_store_xyzw_contiguous( float* xyzw, lane8 x, lane8 y, lane8 z, lane8 w )
{
    lane8_store_xyzw( xyzw, lane_quad_iota, x, y, z, w );
}

LANE_INLINE void lane8_load_xyzw_contiguous( const float* xyzw, lane8* x, lane8* y, lane8* z, lane8* w )
{
    lane8_load_xyzw( xyzw, lane_quad_iota, x, y, z, w );
}

#define LANE_P lane8
#define LANE_COUNT 8
#include "lane_derived.h"
#undef LANE_P
#undef LANE_COUNT

#define LANE_P lane16
#define LANE_COUNT 16
#include "lane_derived.h"
#undef LANE_P
#undef LANE_COUNT
