// SIMDe in place of immintrin.h, so that lane_avx512.h runs, slowly, on any processor. Only for tests.
// GCC needs -Wno-psabi beside it: every function is inlined, so how 64-byte arguments travel concerns nobody.
#pragma once

#ifndef SIMDE_ENABLE_NATIVE_ALIASES
#define SIMDE_ENABLE_NATIVE_ALIASES
#endif
#include <simde/x86/avx512.h>

// SIMDe brings complex.h along, whose I is too short a name to lose.
#undef I

// What lane_avx512.h uses and SIMDe 0.7.4 does not have, or has only when the compiler already does.

#undef __mmask8
#undef __mmask16
#define __mmask8 simde__mmask8
#define __mmask16 simde__mmask16

LANE_INLINE __m512i lane_simde_cvttps( __m512 a )
{
    float from[16];
    int32_t to[16];
    _mm512_storeu_ps( from, a );
    for ( int l = 0; l < 16; ++l )
    {
        to[l] = from[l] >= -0x1p31f && from[l] < 0x1p31f ? (int32_t)from[l] : INT32_MIN;
    }
    return _mm512_loadu_si512( to );
}

LANE_INLINE __m512 lane_simde_cvtepi32( __m512i a )
{
    int32_t from[16];
    float to[16];
    _mm512_storeu_si512( from, a );
    for ( int l = 0; l < 16; ++l )
    {
        to[l] = (float)from[l];
    }
    return _mm512_loadu_ps( to );
}

LANE_INLINE __m512d lane_simde_cvtps_pd( __m256 a )
{
    float from[8];
    double to[8];
    _mm256_storeu_ps( from, a );
    for ( int l = 0; l < 8; ++l )
    {
        to[l] = (double)from[l];
    }
    return _mm512_loadu_pd( to );
}

LANE_INLINE __m256 lane_simde_cvtpd_ps( __m512d a )
{
    double from[8];
    float to[8];
    _mm512_storeu_pd( from, a );
    for ( int l = 0; l < 8; ++l )
    {
        to[l] = (float)from[l];
    }
    return _mm256_loadu_ps( to );
}

LANE_INLINE __mmask8 lane_simde_bits( __m256i all_or_none )
{
    return (__mmask8)_mm256_movemask_ps( _mm256_castsi256_ps( all_or_none ) );
}

#undef _mm512_cvtps_pd
#undef _mm512_cvtpd_ps
#define _mm512_cvtps_pd( a ) lane_simde_cvtps_pd( a )
#define _mm512_cvtpd_ps( a ) lane_simde_cvtpd_ps( a )
#undef _mm512_cvttps_epi32
#undef _mm512_cvtepi32_ps
#undef _mm256_cmpeq_epi32_mask
#undef _mm256_cmpgt_epi32_mask
#define _mm512_cvttps_epi32( a ) lane_simde_cvttps( a )
#define _mm512_cvtepi32_ps( a ) lane_simde_cvtepi32( a )
#define _mm256_cmpeq_epi32_mask( a, b ) lane_simde_bits( _mm256_cmpeq_epi32( a, b ) )
#define _mm256_cmpgt_epi32_mask( a, b ) lane_simde_bits( _mm256_cmpgt_epi32( a, b ) )
