// Small vectors. Lanes are rows of sixteen strands.
#pragma once

#include "wisp/module/module.h"
#include "wisp/module/vec.h"

#include <math.h>

static inline void collision_store( float* to, wisp_vec3 v )
{
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
}

/// Is the way between the origins of two entities not zero? What is made of vertices is then too far apart to touch.
static inline bool collision_is_apart( wisp_vec3 between )
{
    return between.x != 0.0f || between.y != 0.0f || between.z != 0.0f;
}

// For numbers that are not NaN. fminf() and fmaxf() are calls, because they handle NaN.
static inline float collision_smaller( float a, float b )
{
    return a < b ? a : b;
}

static inline float collision_larger( float a, float b )
{
    return a > b ? a : b;
}

/// Grow a box to hold a point.
static inline void collision_widen( wisp_vec3* lower, wisp_vec3* upper, wisp_vec3 p )
{
    *lower = ( wisp_vec3 ){ collision_smaller( p.x, lower->x ), collision_smaller( p.y, lower->y ),
                            collision_smaller( p.z, lower->z ) };
    *upper = ( wisp_vec3 ){ collision_larger( p.x, upper->x ), collision_larger( p.y, upper->y ),
                            collision_larger( p.z, upper->z ) };
}

/// Return whether a point is finite and within the range of queries.
static inline bool collision_is_finite( wisp_vec3 v )
{
    return fabsf( v.x ) <= 1e9f && fabsf( v.y ) <= 1e9f && fabsf( v.z ) <= 1e9f;
}

/// Load one lane of a row of sixteen vertices.
static inline wisp_vec3 collision_load_lane( const float* x )
{
    return ( wisp_vec3 ){ x[0], x[WISP_LANES], x[2 * WISP_LANES] };
}

static inline void collision_store_lane( float* x, wisp_vec3 v )
{
    x[0] = v.x;
    x[WISP_LANES] = v.y;
    x[2 * WISP_LANES] = v.z;
}

/// Whether a point of a body is finite, and where contacts can be computed.
static inline bool collision_is_in_range( wisp_vec3 p )
{
    return fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f;
}
