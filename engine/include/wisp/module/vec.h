/// For modules: vectors of three floats and rotations of them. Rotations take sine and cosine, so that the caller decides where the
/// angle comes from.
///
///     const wisp_vec3 normal = wisp_v3_cross( wisp_v3_sub( b, a ), wisp_v3_sub( c, a ) );
#pragma once

#include <float.h>
#include <math.h>

#include "wisp/base.h"

WISP_BEGIN_C

static inline wisp_vec3 wisp_v3( float x, float y, float z )
{
    wisp_vec3 v = { x, y, z };
    return v;
}

/// Load three floats that follow each other.
static inline wisp_vec3 wisp_v3_load( const float* p )
{
    return wisp_v3( p[0], p[1], p[2] );
}

static inline wisp_vec3 wisp_v3_add( wisp_vec3 a, wisp_vec3 b )
{
    return wisp_v3( a.x + b.x, a.y + b.y, a.z + b.z );
}

static inline wisp_vec3 wisp_v3_sub( wisp_vec3 a, wisp_vec3 b )
{
    return wisp_v3( a.x - b.x, a.y - b.y, a.z - b.z );
}

static inline wisp_vec3 wisp_v3_scale( wisp_vec3 a, float s )
{
    return wisp_v3( a.x * s, a.y * s, a.z * s );
}

/// a + s b
static inline wisp_vec3 wisp_v3_mul_add( wisp_vec3 a, float s, wisp_vec3 b )
{
    return wisp_v3( a.x + s * b.x, a.y + s * b.y, a.z + s * b.z );
}

static inline float wisp_v3_dot( wisp_vec3 a, wisp_vec3 b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline wisp_vec3 wisp_v3_cross( wisp_vec3 a, wisp_vec3 b )
{
    return wisp_v3( a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x );
}

static inline float wisp_v3_length( wisp_vec3 a )
{
    return sqrtf( wisp_v3_dot( a, a ) );
}

/// The direction of v, or the fallback when v has none in single precision: shorter than 1.1e-19 or longer than
/// 1.8e19, where the square leaves the range of normal floats, or not a number.
static inline wisp_vec3 wisp_v3_normalize_or( wisp_vec3 v, wisp_vec3 fallback )
{
    float squared = wisp_v3_dot( v, v );
    return squared >= FLT_MIN && squared <= FLT_MAX ? wisp_v3_scale( v, 1.0f / sqrtf( squared ) ) : fallback;
}

/// Turn v about a unit axis (Rodrigues): cos v + (1 - cos) (axis . v) axis + sin axis x v.
static inline wisp_vec3 wisp_v3_rotate( wisp_vec3 axis, float sine, float cosine, wisp_vec3 v )
{
    wisp_vec3 along = wisp_v3_scale( axis, ( 1.0f - cosine ) * wisp_v3_dot( axis, v ) );
    return wisp_v3_mul_add( wisp_v3_mul_add( along, cosine, v ), sine, wisp_v3_cross( axis, v ) );
}

WISP_END_C
