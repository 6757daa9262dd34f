/// For modules: vectors in double precision, for geometry with float inputs. Differences of floats are exact or nearly so, and their
/// squares neither overflow nor underflow.
#pragma once

#include <float.h>
#include <math.h>

#include "wisp/base.h"

WISP_BEGIN_C

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
    return double3_make( (double)v.x, (double)v.y, (double)v.z );
}

static inline wisp_vec3 double3_narrow( double3 v )
{
    wisp_vec3 narrow = { (float)v.x, (float)v.y, (float)v.z };
    return narrow;
}

static inline double3 double3_add( double3 a, double3 b )
{
    return double3_make( a.x + b.x, a.y + b.y, a.z + b.z );
}

static inline double3 double3_sub( double3 a, double3 b )
{
    return double3_make( a.x - b.x, a.y - b.y, a.z - b.z );
}

/// From one point to another.
static inline double3 double3_between( wisp_vec3 a, wisp_vec3 b )
{
    return double3_sub( double3_widen( b ), double3_widen( a ) );
}

static inline double3 double3_scale( double3 a, double s )
{
    return double3_make( a.x * s, a.y * s, a.z * s );
}

/// Compute a + s b.
static inline double3 double3_mul_add( double3 a, double s, double3 b )
{
    return double3_make( a.x + s * b.x, a.y + s * b.y, a.z + s * b.z );
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

/// Normalise v, or return zero if it has no direction.
static inline double3 double3_unit_or_zero( double3 v )
{
    double squared = double3_dot( v, v );
    return double3_scale( v, squared > 0.0 ? 1.0 / sqrt( squared ) : 0.0 );
}

WISP_END_C
