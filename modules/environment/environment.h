/// Environment: temperature and wetness drive the stiffness of strands through a monotone curve (named as future work by Kim 2026).
///
///   ice = wetness * s( (freezing - temperature) / span ),  s the smooth step, clamped
///   k   = curve( ice )
///
/// The curve passes through control points by monotone cubic interpolation (Fritsch and Carlson 1980), so colder or
/// wetter hair is never softer if the points rise.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

#define WISP_ENVIRONMENT_MAX_POINTS 8

/// Parameters. Fill from wisp_default_environment_def(). Copied.
typedef struct wisp_environment_def
{
    float temperature_celsius;                    ///< degrees Celsius, default -10
    float wetness;                                ///< in [0, 1], default 1
    float freezing_celsius;                       ///< degrees Celsius where ice begins, default 0
    float span;                                   ///< kelvin below freezing until all water is ice, > 0, default 10
    int point_count;                              ///< 2 .. WISP_ENVIRONMENT_MAX_POINTS, default 2
    float ice[WISP_ENVIRONMENT_MAX_POINTS];       ///< strictly rising from 0 to 1
    float stiffness[WISP_ENVIRONMENT_MAX_POINTS]; ///< rising or falling throughout, in [1e-3, 1e12]; default 1 -> 20
    uint32_t cookie;
} wisp_environment_def;

WISP_API wisp_environment_def wisp_default_environment_def( void );

/// Stiffness at a temperature and a wetness: what the pass writes for every strand. Pure.
WISP_API float wisp_environment_stiffness( const wisp_environment_def* def, float temperature, float wetness );

/// Put strands into a environment, or change it. Stiffness is written at the next step; a look changes with its command.
/// @return WISP_BAD_INPUT a value is out of range or the curve is not monotone; WISP_CONFLICT module not registered
WISP_API wisp_status wisp_set_environment( wisp_world* world, wisp_entity strands, const wisp_environment_def* def );

WISP_API extern const wisp_module wisp_environment_module;

WISP_END_C
