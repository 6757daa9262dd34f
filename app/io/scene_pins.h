/// The keys of vertices that are held together: a surface's own pins, and those of a group.
#pragma once

#include "scene_ranges.h"

#define SCENE_PIN_AT( start, member ) ( ( start ) + offsetof( wisp_scene_pins, member ) )

/// The fields of a block over a struct in which a wisp_scene_pins starts at `start`.
#define SCENE_PIN_FIELDS( start )                                                                                    \
    { "pins",                                                                                                        \
      SCENE_CUSTOM,                                                                                                  \
      .at = ( start ),                                                                                               \
      .read = scene_read_pins,                                                                                       \
      .help = "Vertices that are held, as the file or the generator numbers them.",                                  \
      .form = "list of vertices",                                                                                    \
      .initial = "none" },                                                                                           \
        { "pin_box",                                                                                                 \
          SCENE_CUSTOM,                                                                                              \
          .at = ( start ),                                                                                           \
          .read = scene_read_pin_box,                                                                                \
          .help = "Holds all vertices that start inside; a box without a vertex is refused.",                        \
          .form = "{min, max} or a list of them",                                                                    \
          .initial = "none" },                                                                                       \
        { "pin_nearest",                                                                                             \
          SCENE_CUSTOM,                                                                                              \
          .at = ( start ),                                                                                           \
          .read = scene_read_pin_nearest,                                                                            \
          .help = "Holds the vertex that starts nearest to each point.",                                             \
          .form = "list of points [x, y, z]",                                                                        \
          .initial = "none" },                                                                                       \
        { "pin_keyframes",                                                                                           \
          SCENE_CUSTOM,                                                                                              \
          .at = SCENE_PIN_AT( start, path ),                                                                         \
          .read = scene_read_pin_path,                                                                               \
          .help = "Displacement of all these pins from where they started, or from where an event held them.",       \
          .form = "list of keyframes {time, translate, rotate}",                                                     \
          .initial = "none" },                                                                                       \
        { "pin_pivot",                                                                                               \
          SCENE_VECTOR,                                                                                              \
          .at = SCENE_PIN_AT( start, pivot ),                                                                        \
          .range = COORDINATE,                                                                                       \
          .unit = METRES,                                                                                            \
          .given = SCENE_PIN_AT( start, has_pivot ),                                                                 \
          .help = "Point that the keyframes rotate about.",                                                          \
          .initial = "the centre of the pins" },                                                                     \
    {                                                                                                                \
        "attach_pins", SCENE_CUSTOM,                                                                                 \
            .read = scene_read_later_name, .form = "name of a surface", .initial = "none",                           \
            .help = "Surface that all these pins go along with, each at the point that is closest to it "            \
                    "at the start."                                                                                  \
    }
