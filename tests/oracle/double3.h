/// Three doubles and the few operations that oracles and their tests need.
#pragma once

#include "wisp/base.h"

#include <math.h>

typedef struct double3
{
    double x, y, z;
} double3;

static inline double3 double3_make( double x, double y, double z )
{
    double3 v = { x, y, z };
    return v;
}

static inline double3 double3_from( const float* v )
{
    return double3_make( (double)v[0], (double)v[1], (double)v[2] );
}

static inline double3 double3_widen( wisp_vec3 v )
{
    return double3_from( &v.x );
}

static inline double3 double3_add( double3 a, double3 b )
{
    return double3_make( a.x + b.x, a.y + b.y, a.z + b.z );
}

static inline double3 double3_sub( double3 a, double3 b )
{
    return double3_make( a.x - b.x, a.y - b.y, a.z - b.z );
}

static inline double3 double3_scale( double s, double3 a )
{
    return double3_make( s * a.x, s * a.y, s * a.z );
}

/// a + s b
static inline double3 double3_add_scaled( double3 a, double s, double3 b )
{
    return double3_add( a, double3_scale( s, b ) );
}

/// (1-t) a + t b, which is a and b to the last bit at the ends.
static inline double3 double3_blend( double3 a, double3 b, double t )
{
    return double3_add_scaled( double3_scale( 1.0 - t, a ), t, b );
}

static inline double double3_dot( double3 a, double3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline double3 double3_cross( double3 a, double3 b )
{
    return double3_make( a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x );
}

static inline double double3_length( double3 a )
{
    return sqrt( double3_dot( a, a ) );
}

static inline double3 double3_unit( double3 a )
{
    return double3_scale( 1.0 / double3_length( a ), a );
}

static inline double double3_distance( double3 a, double3 b )
{
    return double3_length( double3_sub( a, b ) );
}

/// Angle between two vectors by atan2, accurate near 0 and near pi where an arc cosine is not.
static inline double double3_angle( double3 a, double3 b )
{
    return atan2( double3_length( double3_cross( a, b ) ), double3_dot( a, b ) );
}
