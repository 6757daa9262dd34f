/// Intersections in integers: points with integer coordinates, and results that are computed without rounding and by
/// other equations than the engine's.
#pragma once

#include "support.h"

#include "wisp/module/intersections.h"

__extension__ typedef __int128 wide;

/// A point with whole coordinates, below 2^30 in magnitude and of at most 24 bits, so that they are floats.
typedef struct whole_point
{
    int32_t at[3];
} whole_point;

static inline whole_point whole_random( int a, int b, int range )
{
    return ( whole_point ){ { test_random( a, 3 * b, 2 * range + 1 ) - range,
                              test_random( a, 3 * b + 1, 2 * range + 1 ) - range,
                              test_random( a, 3 * b + 2, 2 * range + 1 ) - range } };
}

static inline void whole_to_floats( whole_point p, float out[3] )
{
    for ( int axis = 0; axis < 3; ++axis )
    {
        out[axis] = (float)p.at[axis];
    }
}

static inline int sign_of( wide value )
{
    return ( value > 0 ) - ( value < 0 );
}

/// The determinant of three columns.
static inline wide whole_determinant( const int64_t u[3], const int64_t v[3], const int64_t w[3] )
{
    return (wide)u[0] * ( (wide)v[1] * w[2] - (wide)v[2] * w[1] ) -
           (wide)v[0] * ( (wide)u[1] * w[2] - (wide)u[2] * w[1] ) +
           (wide)w[0] * ( (wide)u[1] * v[2] - (wide)u[2] * v[1] );
}

static inline void whole_between( whole_point from, whole_point to, int64_t out[3] )
{
    for ( int axis = 0; axis < 3; ++axis )
    {
        out[axis] = (int64_t)to.at[axis] - from.at[axis];
    }
}

static inline int whole_side( whole_point a, whole_point b, whole_point c, whole_point d )
{
    int64_t u[3], v[3], w[3];
    whole_between( a, b, u );
    whole_between( a, c, v );
    whole_between( a, d, w );
    return sign_of( whole_determinant( u, v, w ) );
}

/// Relation of a segment and a triangle.
typedef enum whole_meeting
{
    WHOLE_APART,
    WHOLE_TOUCH, ///< they meet in one point, on the border of one of them
    WHOLE_CROSS, ///< they meet inside both
} whole_meeting;

/// Cramer's rule for p + t (q - p) = a + u (b - a) + v (c - a). Parallel ones count as apart.
static inline whole_meeting whole_meet( whole_point p, whole_point q, whole_point a, whole_point b, whole_point c )
{
    int64_t back[3], ab[3], ac[3], ap[3];
    whole_between( q, p, back );
    whole_between( a, b, ab );
    whole_between( a, c, ac );
    whole_between( a, p, ap );
    wide all = whole_determinant( ab, ac, back );
    if ( all == 0 )
    {
        return WHOLE_APART;
    }
    const int s = sign_of( all );
    const wide u = s * whole_determinant( ap, ac, back ), v = s * whole_determinant( ab, ap, back ),
               t = s * whole_determinant( ab, ac, ap );
    all *= s;
    if ( u > 0 && v > 0 && u + v < all && t > 0 && t < all )
    {
        return WHOLE_CROSS;
    }
    return u >= 0 && v >= 0 && u + v <= all && t >= 0 && t <= all ? WHOLE_TOUCH : WHOLE_APART;
}
