/// Three doubles and the few operations that the frozen hair oracle and its tests need.
#pragma once

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

static inline double double3_distance( double3 a, double3 b )
{
    return double3_length( double3_sub( a, b ) );
}

/// Angle between two vectors by atan2, accurate near 0 and near pi where an arc cosine is not.
static inline double double3_angle( double3 a, double3 b )
{
    return atan2( double3_length( double3_cross( a, b ) ), double3_dot( a, b ) );
}
