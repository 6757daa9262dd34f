// Eight lanes in one 256-bit register: everything that involves no mask. AVX2 and AVX-512 share it and differ in masks.
#pragma once

typedef __m256 lane8;
typedef __m256i lane8i;

LANE_INLINE lane8 lane8_set1( float value )
{
    return _mm256_set1_ps( value );
}

LANE_INLINE lane8 lane8_load( const float* from )
{
    return _mm256_load_ps( from );
}

LANE_INLINE lane8 lane8_loadu( const float* from )
{
    return _mm256_loadu_ps( from );
}

LANE_INLINE void lane8_store( float* to, lane8 a )
{
    _mm256_store_ps( to, a );
}

LANE_INLINE void lane8_storeu( float* to, lane8 a )
{
    _mm256_storeu_ps( to, a );
}

LANE_INLINE lane8 lane8_add( lane8 a, lane8 b )
{
    return _mm256_add_ps( a, b );
}

LANE_INLINE lane8 lane8_sub( lane8 a, lane8 b )
{
    return _mm256_sub_ps( a, b );
}

LANE_INLINE lane8 lane8_mul( lane8 a, lane8 b )
{
    return _mm256_mul_ps( a, b );
}

LANE_INLINE lane8 lane8_div( lane8 a, lane8 b )
{
    return _mm256_div_ps( a, b );
}

LANE_INLINE lane8 lane8_min( lane8 a, lane8 b )
{
    return _mm256_min_ps( a, b );
}

LANE_INLINE lane8 lane8_max( lane8 a, lane8 b )
{
    return _mm256_max_ps( a, b );
}

LANE_INLINE lane8 lane8_sqrt( lane8 a )
{
    return _mm256_sqrt_ps( a );
}

LANE_INLINE lane8 lane8_floor( lane8 a )
{
    return _mm256_floor_ps( a );
}

LANE_INLINE lane8i lane8_truncate( lane8 a )
{
    return _mm256_cvttps_epi32( a );
}

LANE_INLINE lane8 lane8_from_int( lane8i a )
{
    return _mm256_cvtepi32_ps( a );
}

LANE_INLINE lane8i lane8_cast_int( lane8 a )
{
    return _mm256_castps_si256( a );
}

LANE_INLINE lane8 lane8_cast_float( lane8i a )
{
    return _mm256_castsi256_ps( a );
}

LANE_INLINE float lane8_sum_ordered( lane8 a )
{
    __m128 four = _mm_add_ps( _mm256_castps256_ps128( a ), _mm256_extractf128_ps( a, 1 ) );
    __m128 two = _mm_add_ps( four, _mm_movehl_ps( four, four ) );
    return _mm_cvtss_f32( _mm_add_ss( two, _mm_shuffle_ps( two, two, 1 ) ) );
}

LANE_INLINE lane8i lane8i_set1( int32_t value )
{
    return _mm256_set1_epi32( value );
}

LANE_INLINE lane8i lane8i_load( const int32_t* from )
{
    return _mm256_load_si256( (const __m256i*)from );
}

LANE_INLINE lane8i lane8i_loadu( const int32_t* from )
{
    return _mm256_loadu_si256( (const __m256i*)from );
}

LANE_INLINE void lane8i_storeu( int32_t* to, lane8i a )
{
    _mm256_storeu_si256( (__m256i*)to, a );
}

LANE_INLINE lane8i lane8i_add( lane8i a, lane8i b )
{
    return _mm256_add_epi32( a, b );
}

LANE_INLINE lane8i lane8i_sub( lane8i a, lane8i b )
{
    return _mm256_sub_epi32( a, b );
}

LANE_INLINE lane8i lane8i_mul( lane8i a, lane8i b )
{
    return _mm256_mullo_epi32( a, b );
}

LANE_INLINE lane8i lane8i_and( lane8i a, lane8i b )
{
    return _mm256_and_si256( a, b );
}

LANE_INLINE lane8i lane8i_or( lane8i a, lane8i b )
{
    return _mm256_or_si256( a, b );
}

LANE_INLINE lane8i lane8i_xor( lane8i a, lane8i b )
{
    return _mm256_xor_si256( a, b );
}

LANE_INLINE lane8i lane8i_shift_left( lane8i a, int count )
{
    return _mm256_slli_epi32( a, count );
}

LANE_INLINE lane8i lane8i_shift_right( lane8i a, int count )
{
    return _mm256_srli_epi32( a, count );
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

LANE_INLINE lane8 lane8_spread_first( lane8 row )
{
    return _mm256_permute_ps( row, 0x00 );
}

LANE_INLINE lane8 lane8_spread_second( lane8 row )
{
    return _mm256_permute_ps( row, 0x55 );
}

LANE_INLINE lane8 lane8_spread_third( lane8 row )
{
    return _mm256_permute_ps( row, 0xaa );
}

LANE_INLINE lane8 lane8_spread_last( lane8 row )
{
    return _mm256_permute_ps( row, 0xff );
}

// Row l and lane k change places.
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
