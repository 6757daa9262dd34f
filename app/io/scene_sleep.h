/// The block that tells when an entry sleeps.
#pragma once

#include "scene_ranges.h"

/// The fields of a block over an entry that has `sleep`.
#define SCENE_SLEEP_FIELDS( entry )                                                                                  \
    { "max_speed",                                                                                                   \
      SCENE_NUMBER,                                                                                                  \
      .at = offsetof( entry, sleep.max_speed ),                                                                      \
      .range = RANGE( 0, 1e6 ),                                                                                      \
      .unit = SPEEDS,                                                                                                \
      .help = "Speed, of the displacement over a step, that no vertex may exceed." },                                \
        { "seconds",     SCENE_NUMBER,    .at = offsetof( entry, sleep.seconds ),                                    \
          .range = TIME, .unit = SECONDS, .help = "Simulated time for which all vertices must be slower." },         \
    {                                                                                                                \
        "enabled", SCENE_SWITCH, .at = offsetof( entry, sleep.enabled ), .help = "`false`: it never sleeps."         \
    }
