/// The block `copies` of surfaces and strands. Private to this folder.
#pragma once

#include "scene_parts.h"
#include "scene_ranges.h"

/// The fields of a block over an entry that has `copies`.
#define SCENE_COPIES_FIELDS( entry )                                                                                 \
    { "count",                                                                                                       \
      SCENE_WHOLE,                                                                                                   \
      .required = true,                                                                                              \
      .at = offsetof( entry, copies.count ),                                                                         \
      .range = RANGE( 1, WISP_SCENE_MAX_SURFACES ),                                                                  \
      .help = "Number of entries that this one becomes. The first keeps the name, which other entries mean; the "    \
              "others are called `name-2`, `name-3` and so on." },                                                   \
        { "columns", SCENE_WHOLE, .at = offsetof( entry, copies.columns ),                                           \
          .range = RANGE( 0, WISP_SCENE_MAX_SURFACES ),                                                              \
          .help = "Entries in a row of the grid; 0 takes the root of `count`, rounded up." },                        \
    {                                                                                                                \
        "spacing", SCENE_VECTOR, .required = true, .at = offsetof( entry, copies.spacing ), .range = COORDINATE,     \
                                 .unit = METRES,                                                                     \
                                 .help = "Displacement from a column to the next, along x, and from a row to the "   \
                                         "next, along y and z."                                                      \
    }
