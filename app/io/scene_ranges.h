/// Ranges and units that several tables share. Private to this folder.
///
/// Ranges are those that the modules, the makers of grooms and meshes, and the engine accept: what a scene lets through,
/// they take.
#pragma once

#include "scene_parts.h"

#include <stddef.h>

#define RANGE( from, to )                                                                                            \
    {                                                                                                                \
        ( from ), ( to )                                                                                             \
    }
#define UNIT_RANGE RANGE( 0, 1 )
#define COORDINATE RANGE( -1e6, 1e6 )
#define SIZE RANGE( 1e-6, 1e6 )
#define TIME RANGE( 0, 1e6 )
#define DT_FACTOR RANGE( 0.001, 1000 )
#define FROZEN_STIFFNESS RANGE( 1e-3, 1e12 )
#define ANY_MASS RANGE( 1e-12, 1e12 )

// Vectors whose length is bounded: each part is at most the bound over the square root of three.
#define ACCELERATION RANGE( -5e5, 5e5 )
#define VELOCITY RANGE( -5e5, 5e5 )
#define WIND RANGE( -5e4, 5e4 )

// Units.
#define METRES "m"
#define DEGREES "degrees"
#define SECONDS "s"
#define SPEEDS "m/s"
#define TURNS "rad/s"
#define ACCELERATIONS "m/s^2"
#define DENSITIES "kg/m^2"
#define MASSES "kg"
#define FLOWS "m^3/s"
#define RATES "1/s"

// What is said more than once.
#define SCENE_COLLIDES "{} where the scene has colliders, else false"

// ---- scene detail ----

/// Names of the levels.
extern const scene_choice SCENE_DETAIL_LEVELS[];
#define SCENE_DETAIL_CHOICES .choices = SCENE_DETAIL_LEVELS, .constants = "WISP_DETAIL_"

/// Refuse a level that the entry has nothing for. @param node of the key
wisp_status scene_check_surface_detail( scene_reader* r, const text_node* node, const wisp_scene_surface* s,
                                        wisp_detail level );
wisp_status scene_check_strands_detail( scene_reader* r, const text_node* node, const wisp_scene_strands* s,
                                        wisp_detail level );

// ---- scene start ----

static const scene_choice SCENE_STARTS[] = {
    { "rest", "as it was placed" },
    { "random", "every vertex at random in a cube as wide as all of it" },
    { "plane", "in the level plane through its centre" },
    { "point", "all at its centre" },
    { "inside_out", "reflected in its centre, or in the point above it at the height of its pins" },
    { "twisted", "turned about the vertical, from nothing at the top to `turns` at the bottom" },
    { NULL, NULL },
};

// Of a block over a wisp_scene_start.
#define SCENE_START_FIELDS                                                                                           \
    { "shape", SCENE_CHOICE, .at = offsetof( wisp_scene_start, shape ), .choices = SCENE_STARTS,                     \
      .help = "Where vertices start." },                                                                             \
        { "scale", SCENE_VECTOR, .at = offsetof( wisp_scene_start, scale ), .range = RANGE( -1000, 1000 ),           \
          .help = "Factors along x, y and z about the centre, before the shape." },                                  \
        { "turns", SCENE_NUMBER, .at = offsetof( wisp_scene_start, turns ), .range = RANGE( -1000, 1000 ),           \
          .help = "Full turns, with `shape: twisted`." },                                                            \
        { "shake",                                                                                                   \
          SCENE_NUMBER,                                                                                              \
          .at = offsetof( wisp_scene_start, shake ),                                                                 \
          .range = RANGE( 0, 1e6 ),                                                                                  \
          .unit = METRES,                                                                                            \
          .help = "Largest displacement along each axis, at random, after the shape." },                             \
    {                                                                                                                \
        "seed", SCENE_SEED, .at = offsetof( wisp_scene_start, seed ),                                                \
                            .help = "Seed of random places and of `shake`."                                          \
    }

/// Defaults of a start.
static inline wisp_scene_start scene_default_start( void )
{
    return ( wisp_scene_start ){ .scale = { 1.0f, 1.0f, 1.0f }, .turns = 1.0f, .seed = 1 };
}

// ---- scene copies ----

static const scene_field SCENE_COPIES_FIELDS[] = {
    { "count", SCENE_WHOLE, .required = true, .at = offsetof( wisp_scene_copies, count ),
      .range = RANGE( 1, WISP_SCENE_MAX_SURFACES ),
      .help = "Number of entries that this one becomes. The first keeps the name, which other entries mean; the "
              "others are called `name-2`, `name-3` and so on." },
    { "columns", SCENE_WHOLE, .at = offsetof( wisp_scene_copies, columns ),
      .range = RANGE( 0, WISP_SCENE_MAX_SURFACES ),
      .help = "Entries in a row of the grid; 0 takes the root of `count`, rounded up, and one line where `spacing` "
              "is along x alone or has no x." },
    { "spacing", SCENE_VECTOR, .required = true, .at = offsetof( wisp_scene_copies, spacing ), .range = COORDINATE,
      .unit = METRES,
      .help = "Displacement from a column to the next, along x, and from a row to the next, along y and z." },
};

// ---- scene names ----

/// Of an entry, which begins as scene_entry does.
#define SCENE_NAME_FIELD                                                                                             \
    {                                                                                                                \
        "name", SCENE_CUSTOM, .required = true, .read = scene_read_name,                                             \
                              .help = "Unique among strands, surfaces, colliders and seams.",                        \
                              .form = "1 to 64 of the characters A-Z a-z 0-9 _ -"                                    \
    }

// ---- scene pins ----

#define SCENE_PIN_AT( start, member ) ( ( start ) + offsetof( wisp_scene_pins, member ) )

/// The fields of a block over a struct in which a wisp_scene_pins starts at `start`.
#define SCENE_PIN_FIELDS( start )                                                                                    \
    { "pins",                                                                                                        \
      SCENE_ENTRIES,                                                                                                 \
      .at = SCENE_PIN_AT( start, vertices ),                                                                         \
      .of = &SCENE_VERTICES,                                                                                         \
      .help = "Vertices that are held, as the file or the generator numbers them.",                                  \
      .form = "list of vertices",                                                                                    \
      .initial = "none" },                                                                                           \
        { "pin_box",                                                                                                 \
          SCENE_ENTRIES,                                                                                             \
          .at = SCENE_PIN_AT( start, boxes ),                                                                        \
          .of = &SCENE_PIN_BOXES,                                                                                    \
          .help = "Holds all vertices that start inside; a box without a vertex is refused.",                        \
          .form = "{min, max} or a list of them",                                                                    \
          .initial = "none" },                                                                                       \
        { "pin_nearest",                                                                                             \
          SCENE_ENTRIES,                                                                                             \
          .at = SCENE_PIN_AT( start, nearest ),                                                                      \
          .of = &SCENE_PIN_PLACES,                                                                                   \
          .help = "Holds the vertex that starts nearest to each point.",                                             \
          .form = "list of points [x, y, z]",                                                                        \
          .initial = "none" },                                                                                       \
        { "pin_keyframes",                                                                                           \
          SCENE_ENTRIES,                                                                                             \
          .at = SCENE_PIN_AT( start, path ),                                                                         \
          .of = &SCENE_PIN_PATH,                                                                                     \
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
