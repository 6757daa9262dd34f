/// Where surfaces and strands start. Private to this folder.
#pragma once

#include "scene_ranges.h"

#include <stddef.h>

static const scene_choice SCENE_STARTS[] = {
    { "rest", "as it was placed" },
    { "random", "every vertex at random in a cube as wide as all of it" },
    { "plane", "in the level plane through its centre" },
    { "point", "all at its centre" },
    { "inside_out", "reflected in its centre, or in the point above it at the height of its pins" },
    { "twisted", "turned about the vertical, from nothing at the top to `turns` at the bottom" },
    { NULL, NULL },
};

#define SCENE_START_FIELDS( entry )                                                                                  \
    { "shape", SCENE_CHOICE, .at = offsetof( entry, start.shape ), .choices = SCENE_STARTS,                          \
      .help = "Where vertices start." },                                                                             \
        { "scale", SCENE_VECTOR, .at = offsetof( entry, start.scale ), .range = RANGE( -1000, 1000 ),                \
          .help = "Factors along x, y and z about the centre, before the shape." },                                  \
        { "turns", SCENE_NUMBER, .at = offsetof( entry, start.turns ), .range = RANGE( -1000, 1000 ),                \
          .help = "Full turns, with `shape: twisted`." },                                                            \
        { "shake",                                                                                                   \
          SCENE_NUMBER,                                                                                              \
          .at = offsetof( entry, start.shake ),                                                                      \
          .range = RANGE( 0, 1e6 ),                                                                                  \
          .unit = METRES,                                                                                            \
          .help = "Largest displacement along each axis, at random, after the shape." },                             \
    {                                                                                                                \
        "seed", SCENE_SEED, .at = offsetof( entry, start.seed ), .help = "Seed of random places and of `shake`."     \
    }

/// Defaults of a start.
static inline wisp_scene_start scene_default_start( void )
{
    return ( wisp_scene_start ){ .scale = { 1.0f, 1.0f, 1.0f }, .turns = 1.0f, .seed = 1 };
}
