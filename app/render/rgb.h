/// Colours: vectors with a componentwise product.
#pragma once

#include "vec.h"

static inline wisp_vec3 rgb_mul( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x * b.x, a.y * b.y, a.z * b.z };
}

static inline wisp_vec3 rgb_grey( float level )
{
    return ( wisp_vec3 ){ level, level, level };
}

/// a at share 0, b at share 1.
static inline wisp_vec3 rgb_mix( wisp_vec3 a, wisp_vec3 b, float fraction )
{
    return v3_mul_add( v3_scale( a, 1.0f - fraction ), fraction, b );
}

static inline float rgb_largest( wisp_vec3 a )
{
    return fmaxf( a.x, fmaxf( a.y, a.z ) );
}

static inline float clamp01( float value )
{
    return fminf( 1.0f, fmaxf( 0.0f, value ) );
}

/// 0 below low, 1 above high, smooth between.
static inline float smooth_step( float lower, float upper, float value )
{
    float t = clamp01( ( value - lower ) / ( upper - lower ) );
    return t * t * ( 3.0f - 2.0f * t );
}
