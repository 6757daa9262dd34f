// Lanes as plain C arrays: the backend of any other processor, and the oracle of the ones with intrinsics.
#pragma once

#include <math.h>

#define LANE_BACKEND "plain"
#define LANE16_REGISTERS 16

typedef struct lane8
{
    float v[8];
} lane8;

typedef struct lane8i
{
    int32_t v[8];
} lane8i;

// All bits of a lane set, or none.
typedef struct lane8m
{
    int32_t v[8];
} lane8m;

// A conversion that does not fit is undefined in C; x86 answers INT32_MIN, so every backend does.
LANE_INLINE int32_t lane_plain_truncate( float a )
{
    return a >= -0x1p31f && a < 0x1p31f ? (int32_t)a : INT32_MIN;
}

// One lane. Constant indices, where a loop would have a variable: the compiler then keeps lanes in registers from the
// start. It takes many times as long over arrays that it has to follow through memory.
#define PLAIN_ONE( number, expression )                                                                              \
    {                                                                                                                \
        enum                                                                                                         \
        {                                                                                                            \
            l = number                                                                                               \
        };                                                                                                           \
        r.v[l] = expression;                                                                                         \
    }

#define PLAIN_EACH( R, parameters, name, expression )                                                                \
    LANE_INLINE R name parameters                                                                                    \
    {                                                                                                                \
        R r;                                                                                                         \
        PLAIN_ONE( 0, expression )                                                                                   \
        PLAIN_ONE( 1, expression )                                                                                   \
        PLAIN_ONE( 2, expression )                                                                                   \
        PLAIN_ONE( 3, expression )                                                                                   \
        PLAIN_ONE( 4, expression )                                                                                   \
        PLAIN_ONE( 5, expression )                                                                                   \
        PLAIN_ONE( 6, expression )                                                                                   \
        PLAIN_ONE( 7, expression )                                                                                   \
        return r;                                                                                                    \
    }

#define PLAIN_FLOAT_2( name, expression ) PLAIN_EACH( lane8, ( lane8 a, lane8 b ), name, expression )
#define PLAIN_INT_2( name, expression ) PLAIN_EACH( lane8i, ( lane8i a, lane8i b ), name, expression )
#define PLAIN_COMPARE( T, name, expression ) PLAIN_EACH( lane8m, ( T a, T b ), name, ( expression ) ? -1 : 0 )
#define PLAIN_MASK_2( name, expression ) PLAIN_EACH( lane8m, ( lane8m a, lane8m b ), name, expression )

PLAIN_EACH( lane8, ( float value ), lane8_set1, value )
PLAIN_EACH( lane8, ( const float* from ), lane8_loadu, from[l] )
PLAIN_EACH( lane8, ( const float* from ), lane8_load, from[l] )
PLAIN_FLOAT_2( lane8_add, a.v[l] + b.v[l] )
PLAIN_FLOAT_2( lane8_sub, a.v[l] - b.v[l] )
PLAIN_FLOAT_2( lane8_mul, a.v[l] * b.v[l] )
PLAIN_FLOAT_2( lane8_div, a.v[l] / b.v[l] )
PLAIN_FLOAT_2( lane8_min, a.v[l] < b.v[l] ? a.v[l] : b.v[l] )
PLAIN_FLOAT_2( lane8_max, a.v[l] > b.v[l] ? a.v[l] : b.v[l] )
PLAIN_EACH( lane8, ( lane8 a ), lane8_sqrt, sqrtf( a.v[l] ) )
PLAIN_EACH( lane8, ( lane8 a ), lane8_floor, floorf( a.v[l] ) )
PLAIN_COMPARE( lane8, lane8_lt, a.v[l] < b.v[l] )
PLAIN_COMPARE( lane8, lane8_le, a.v[l] <= b.v[l] )
PLAIN_COMPARE( lane8, lane8_eq, a.v[l] == b.v[l] )
PLAIN_EACH( lane8, ( lane8m m, lane8 a, lane8 b ), lane8_select, m.v[l] ? a.v[l] : b.v[l] )
PLAIN_EACH( lane8i, ( lane8 a ), lane8_truncate, lane_plain_truncate( a.v[l] ) )
PLAIN_EACH( lane8, ( lane8i a ), lane8_from_int, (float)a.v[l] )

PLAIN_EACH( lane8i, ( int32_t value ), lane8i_set1, value )
PLAIN_EACH( lane8i, ( const int32_t* from ), lane8i_loadu, from[l] )
PLAIN_EACH( lane8i, ( const int32_t* from ), lane8i_load, from[l] )
// Unsigned arithmetic wraps; signed overflow would be undefined.
PLAIN_INT_2( lane8i_add, (int32_t)( (uint32_t)a.v[l] + (uint32_t)b.v[l] ) )
PLAIN_INT_2( lane8i_sub, (int32_t)( (uint32_t)a.v[l] - (uint32_t)b.v[l] ) )
PLAIN_INT_2( lane8i_mul, (int32_t)( (uint32_t)a.v[l] * (uint32_t)b.v[l] ) )
PLAIN_INT_2( lane8i_and, a.v[l] & b.v[l] )
PLAIN_INT_2( lane8i_or, a.v[l] | b.v[l] )
PLAIN_INT_2( lane8i_xor, a.v[l] ^ b.v[l] )
PLAIN_EACH( lane8i, ( lane8i a, int count ), lane8i_shift_left, (int32_t)( (uint32_t)a.v[l] << count ) )
PLAIN_EACH( lane8i, ( lane8i a, int count ), lane8i_shift_right, (int32_t)( (uint32_t)a.v[l] >> count ) )
PLAIN_COMPARE( lane8i, lane8i_eq, a.v[l] == b.v[l] )
PLAIN_COMPARE( lane8i, lane8i_lt, a.v[l] < b.v[l] )
PLAIN_EACH( lane8i, ( lane8m m, lane8i a, lane8i b ), lane8i_select, m.v[l] ? a.v[l] : b.v[l] )
PLAIN_EACH( lane8i, (void), lane8i_iota, l )

PLAIN_MASK_2( lane8m_and, a.v[l] & b.v[l] )
PLAIN_MASK_2( lane8m_or, a.v[l] | b.v[l] )
PLAIN_MASK_2( lane8m_and_not, a.v[l] & ~b.v[l] )
PLAIN_EACH( lane8m, ( lane8m a ), lane8m_not, ~a.v[l] )

#undef PLAIN_ONE
#undef PLAIN_EACH
#undef PLAIN_FLOAT_2
#undef PLAIN_INT_2
#undef PLAIN_COMPARE
#undef PLAIN_MASK_2

LANE_INLINE void lane8_storeu( float* to, lane8 a )
{
    memcpy( to, a.v, sizeof a.v );
}

LANE_INLINE void lane8_store( float* to, lane8 a )
{
    memcpy( to, a.v, sizeof a.v );
}

LANE_INLINE void lane8i_storeu( int32_t* to, lane8i a )
{
    memcpy( to, a.v, sizeof a.v );
}

LANE_INLINE lane8i lane8_cast_int( lane8 a )
{
    lane8i r;
    memcpy( r.v, a.v, sizeof r.v );
    return r;
}

LANE_INLINE lane8 lane8_cast_float( lane8i a )
{
    lane8 r;
    memcpy( r.v, a.v, sizeof r.v );
    return r;
}

LANE_INLINE uint32_t lane8m_bits( lane8m a )
{
    uint32_t bits = 0;
    for ( int l = 0; l < 8; ++l )
    {
        bits |= ( (uint32_t)a.v[l] & 1u ) << l;
    }
    return bits;
}

LANE_INLINE float lane8_sum_ordered( lane8 a )
{
    for ( int half = 4; half > 0; half /= 2 )
    {
        for ( int l = 0; l < half; ++l )
        {
            a.v[l] += a.v[l + half];
        }
    }
    return a.v[0];
}

LANE_INLINE void lane8_transpose_quads( lane8 q[4] )
{
    lane8 from[4] = { q[0], q[1], q[2], q[3] };
    for ( int r = 0; r < 4; ++r )
    {
        for ( int k = 0; k < 4; ++k )
        {
            q[r].v[k] = from[k].v[r];
            q[r].v[k + 4] = from[k].v[r + 4];
        }
    }
}

LANE_INLINE void lane8_load_quads( const float* xyzw, const int32_t* index, lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        memcpy( q[r].v, xyzw + (ptrdiff_t)index[r], 4 * sizeof( float ) );
        memcpy( q[r].v + 4, xyzw + (ptrdiff_t)index[r + 4], 4 * sizeof( float ) );
    }
}

LANE_INLINE void lane8_store_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        memcpy( xyzw + (ptrdiff_t)index[r], q[r].v, 4 * sizeof( float ) );
        memcpy( xyzw + (ptrdiff_t)index[r + 4], q[r].v + 4, 4 * sizeof( float ) );
    }
}

LANE_INLINE void lane8_add_quads( float* xyzw, const int32_t* index, const lane8 q[4] )
{
    for ( int k = 0; k < 32; ++k )
    {
        xyzw[(ptrdiff_t)index[k / 4] + k % 4] += q[k / 4 % 4].v[k / 16 * 4 + k % 4];
    }
}

LANE_INLINE void lane8_spread_xyz( lane8 a, lane8 q[4] )
{
    for ( int r = 0; r < 4; ++r )
    {
        for ( int k = 0; k < 4; ++k )
        {
            q[r].v[k] = k < 3 ? a.v[r] : 0.0f;
            q[r].v[k + 4] = k < 3 ? a.v[r + 4] : 0.0f;
        }
    }
}

// The same number of each quad, four times.
LANE_INLINE lane8 lane8_spread_number( lane8 row, int number )
{
    lane8 out;
    for ( int k = 0; k < 4; ++k )
    {
        out.v[k] = row.v[number];
        out.v[k + 4] = row.v[number + 4];
    }
    return out;
}

#define LANE_WIDE lane16
#define LANE_HALF lane8
#define LANE_HALF_COUNT 8
#include "lane_pair.h"
#undef LANE_WIDE
#undef LANE_HALF
#undef LANE_HALF_COUNT
