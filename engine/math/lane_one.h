// A single lane, lane1, in plain C: the operations that a text written for lanes needs to serve scalars as well.
#pragma once

#include <math.h>

#include "lane.h"

typedef float lane1;
typedef int32_t lane1i;
typedef bool lane1m;

LANE_INLINE lane1 lane1_set1( float value )
{
    return value;
}

LANE_INLINE lane1 lane1_zero( void )
{
    return 0.0f;
}

LANE_INLINE lane1 lane1_add( lane1 a, lane1 b )
{
    return a + b;
}

LANE_INLINE lane1 lane1_sub( lane1 a, lane1 b )
{
    return a - b;
}

LANE_INLINE lane1 lane1_mul( lane1 a, lane1 b )
{
    return a * b;
}

LANE_INLINE lane1 lane1_div( lane1 a, lane1 b )
{
    return a / b;
}

LANE_INLINE lane1 lane1_mul_add( lane1 a, lane1 b, lane1 c )
{
    lane1 product = a * b;
    return product + c;
}

LANE_INLINE lane1 lane1_sqrt( lane1 a )
{
    return sqrtf( a );
}

LANE_INLINE lane1 lane1_min( lane1 a, lane1 b )
{
    return a < b ? a : b;
}

LANE_INLINE lane1 lane1_max( lane1 a, lane1 b )
{
    return a > b ? a : b;
}

LANE_INLINE lane1m lane1_lt( lane1 a, lane1 b )
{
    return a < b;
}

LANE_INLINE lane1m lane1_gt( lane1 a, lane1 b )
{
    return a > b;
}

LANE_INLINE lane1m lane1_eq( lane1 a, lane1 b )
{
    return a == b;
}

LANE_INLINE lane1 lane1_select( lane1m m, lane1 a, lane1 b )
{
    return m ? a : b;
}

LANE_INLINE lane1i lane1_cast_int( lane1 a )
{
    lane1i bits;
    memcpy( &bits, &a, sizeof bits );
    return bits;
}

LANE_INLINE lane1 lane1_cast_float( lane1i a )
{
    lane1 value;
    memcpy( &value, &a, sizeof value );
    return value;
}

LANE_INLINE lane1 lane1_neg( lane1 a )
{
    return lane1_cast_float( lane1_cast_int( a ) ^ INT32_MIN );
}

LANE_INLINE lane1 lane1_abs( lane1 a )
{
    return lane1_cast_float( lane1_cast_int( a ) & INT32_MAX );
}

// INT32_MIN for what does not fit, as in lanes.
LANE_INLINE lane1i lane1_truncate( lane1 a )
{
    return a >= -0x1p31f && a < 0x1p31f ? (lane1i)a : INT32_MIN;
}

LANE_INLINE lane1 lane1_from_int( lane1i a )
{
    return (lane1)a;
}

LANE_INLINE lane1i lane1i_set1( int32_t value )
{
    return value;
}

LANE_INLINE lane1i lane1i_add( lane1i a, lane1i b )
{
    return (lane1i)( (uint32_t)a + (uint32_t)b );
}

LANE_INLINE lane1i lane1i_and( lane1i a, lane1i b )
{
    return a & b;
}

LANE_INLINE lane1i lane1i_xor( lane1i a, lane1i b )
{
    return a ^ b;
}

LANE_INLINE lane1i lane1i_shift_left( lane1i a, int count )
{
    return (lane1i)( (uint32_t)a << count );
}

LANE_INLINE lane1m lane1i_eq( lane1i a, lane1i b )
{
    return a == b;
}
