// A single lane, lane1, in plain C: the operations that a text written for lanes needs to serve scalars as well.
#pragma once

#include <math.h>

#include "lane.h"

typedef float lane1;
typedef int32_t lane1i;
typedef bool lane1m;

#define ONE( R, parameters, name, expression )                                                                       \
    LANE_INLINE R name parameters                                                                                    \
    {                                                                                                                \
        return expression;                                                                                           \
    }

ONE( lane1, ( float value ), lane1_set1, value )
ONE( lane1, (void), lane1_zero, 0.0f )
ONE( lane1, ( lane1 a, lane1 b ), lane1_add, a + b )
ONE( lane1, ( lane1 a, lane1 b ), lane1_sub, a - b )
ONE( lane1, ( lane1 a, lane1 b ), lane1_mul, a* b )
ONE( lane1, ( lane1 a, lane1 b ), lane1_div, a / b )
ONE( lane1, ( lane1 a, lane1 b ), lane1_min, a < b ? a : b )
ONE( lane1, ( lane1 a, lane1 b ), lane1_max, a > b ? a : b )
ONE( lane1, ( lane1 a ), lane1_sqrt, sqrtf( a ) )
ONE( lane1m, ( lane1 a, lane1 b ), lane1_lt, a < b )
ONE( lane1m, ( lane1 a, lane1 b ), lane1_gt, a > b )
ONE( lane1m, ( lane1 a, lane1 b ), lane1_eq, a == b )
ONE( lane1, ( lane1m m, lane1 a, lane1 b ), lane1_select, m ? a : b )
ONE( lane1, ( lane1i a ), lane1_from_int, (lane1)a )
// INT32_MIN for what does not fit, as in lanes.
ONE( lane1i, ( lane1 a ), lane1_truncate, a >= -0x1p31f && a < 0x1p31f ? (lane1i)a : INT32_MIN )
ONE( lane1i, ( int32_t value ), lane1i_set1, value )
ONE( lane1i, ( lane1i a, lane1i b ), lane1i_add, (lane1i)( (uint32_t)a + (uint32_t)b ) )
ONE( lane1i, ( lane1i a, lane1i b ), lane1i_and, a& b )
ONE( lane1i, ( lane1i a, lane1i b ), lane1i_xor, a ^ b )
ONE( lane1i, ( lane1i a, int count ), lane1i_shift_left, (lane1i)( (uint32_t)a << count ) )
ONE( lane1m, ( lane1i a, lane1i b ), lane1i_eq, a == b )

LANE_INLINE lane1 lane1_mul_add( lane1 a, lane1 b, lane1 c )
{
    lane1 product = a * b;
    return product + c;
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

ONE( lane1, ( lane1 a ), lane1_neg, lane1_cast_float( lane1_cast_int( a ) ^ INT32_MIN ) )
ONE( lane1, ( lane1 a ), lane1_abs, lane1_cast_float( lane1_cast_int( a ) & INT32_MAX ) )

#undef ONE
