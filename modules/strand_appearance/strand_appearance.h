/// Strand appearance: width and colour per vertex for stylised export (future work in Kim 2026). Width and colour run from
/// root to tip. Computed only if WISP_POINT_WIDTH or WISP_POINT_COLOUR is requested.
///
///     wisp_strand_appearance_def appearance = wisp_default_strand_appearance_def();
///     wisp_set_strand_appearance( world, strands, &appearance );
///     wisp_request( world, strands, WISP_POINT_COLOUR );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

/// Width and colour. Fill from wisp_default_strand_appearance_def(). Copied.
typedef struct wisp_strand_appearance_def
{
    uint32_t size;                     ///< bytes; set by wisp_default_strand_appearance_def()
    float root_width, tip_width;       ///< m, >= 0, defaults 80e-6 and 20e-6
    wisp_vec3 root_colour, tip_colour; ///< linear, in [0, 1]; defaults dark brown and brown
    float colour_bias; ///< b in (0, 1): colour weight is t / ((1/b - 2)(1 - t) + 1) (Schlick 1994), t = 0 at the root
                       ///< and 1 at the tip; default 0.5 is linear
} wisp_strand_appearance_def;

WISP_DEFINITION( strand_appearance_def );

/// Compute width and colour of one vertex, with the bits of the components, for those who need them without a world.
/// @param t 0 at the root, 1 at the tip; of vertex i of n: i / (n - 1), or 0 if n is 1
/// @param width, colour either may be null
WISP_API void wisp_strand_appearance_at( const wisp_strand_appearance_def* def, float t, float* width,
                                         wisp_vec3* colour );

/// Give strands an appearance, or replace it.
/// @return WISP_BAD_INPUT a value is out of range; WISP_CONFLICT module not registered, or the entity has no strands
WISP_API wisp_status wisp_set_strand_appearance( wisp_world* world, wisp_entity strands,
                                                 const wisp_strand_appearance_def* def );

WISP_API extern const wisp_module wisp_strand_appearance_module;

WISP_END_C
