/// Deterministic trigonometry of one float. lane_trig.h holds the same functions in lanes, bit for bit.
/// Angles are in radians.
#pragma once

#include "lane_one.h"

#define LANE_P lane1
#include "trig_text.h"
#undef LANE_P

/// Largest |x| for which trig_sincos() keeps its bound.
#define TRIG_SINCOS_RANGE 10000.0f

/// Bounds on the absolute error, measured against double precision: over every float in range for the first (9.39e-8),
/// over 4e8 random pairs for the second (2.67e-7). test_math.c measures a part of them again.
#define TRIG_SINCOS_ERROR 1.0e-7f
#define TRIG_ATAN2_ERROR 3.0e-7f

/// Sine and cosine, each within TRIG_SINCOS_ERROR for |x| <= TRIG_SINCOS_RANGE. Farther out the angle is lost but both
/// stay in [-1, 1]; NaN gives NaN.
static inline void trig_sincos( float x, float* sine, float* cosine )
{
    lane1_sincos( x, sine, cosine );
}

/// Angle of (x, y) in [-pi, pi], within TRIG_ATAN2_ERROR for |x|, |y| < 1e38; NaN gives NaN.
/// (0, 0) gives 0, whatever the signs of the zeros; y = -0 lies below the axis.
static inline float trig_atan2( float y, float x )
{
    return lane1_atan2( y, x );
}
