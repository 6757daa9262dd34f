/// Environment: temperature and wetness set the stiffness of strands through a monotone curve (future work in Kim 2026).
///
///   ice = wetness * s( (freezing - temperature) / span ),  s the clamped smooth step
///   k   = curve( ice )
///
/// The curve passes through control points by monotone cubic interpolation (Fritsch and Carlson 1980), so colder or
/// wetter hair is never softer if the points ascend.
///
///     wisp_environment_def winter = wisp_default_environment_def();
///     winter.temperature_celsius = -15.0f, winter.wetness = 0.8f;
///     wisp_set_environment( world, strands, &winter );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

#define WISP_ENVIRONMENT_MAX_POINTS 8

/// Temperature, wetness and stiffness curve. Fill from wisp_default_environment_def(). Copied.
typedef struct wisp_environment_def
{
    uint32_t size;                          ///< bytes; set by wisp_default_environment_def()
    float temperature_celsius;              ///< degrees Celsius, default -10
    float wetness;                          ///< in [0, 1], default 1
    float freezing_celsius;                 ///< degrees Celsius where ice begins, default 0
    float span;                             ///< kelvin below freezing until all water is ice, > 0, default 10
    int point_count;                        ///< 2 .. WISP_ENVIRONMENT_MAX_POINTS, default 2
    float ice[WISP_ENVIRONMENT_MAX_POINTS]; ///< strictly ascending from 0 to 1
    float stiffness
        [WISP_ENVIRONMENT_MAX_POINTS]; ///< ascending or descending throughout, in [1e-3, 1e12]; default 1 to 20
} wisp_environment_def;

WISP_DEFINITION( environment_def );

/// @return the stiffness at a temperature and a wetness, which the pass writes for every strand. Pure
WISP_API float wisp_environment_stiffness( const wisp_environment_def* def, float temperature, float wetness );

/// Put strands into an environment, or replace it. Stiffness is written in the next step; frozen hair shows it with its next
/// update.
/// @return WISP_BAD_INPUT a value is out of range or the curve is not monotone; WISP_CONFLICT module not registered, or no strands
WISP_API wisp_status wisp_set_environment( wisp_world* world, wisp_entity strands, const wisp_environment_def* def );

WISP_API extern const wisp_module wisp_environment_module;

WISP_END_C
