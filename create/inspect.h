/// What a host sees of an entity without views: lines for its own renderer, and what lies under its mouse. Nothing has to be requested.
///
///     wisp_line lines[4096];
///     int count = wisp_draw_lines( world, cloth, lines, 4096 );     // may be more than there is room for
///     wisp_pick hit;
///     if ( wisp_pick_entity( world, cloth, eye, far_point, 0.0f, &hit ) == WISP_OK && hit.vertex >= 0 )
///         wisp_pin( world, cloth, &hit.vertex, 1 );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

typedef enum wisp_line_kind
{
    WISP_LINE_LINK = 0, ///< an edge of a surface, a segment of a strand; value: strain l/l0 - 1
    WISP_LINE_PIN = 1,  ///< three lines across a pinned vertex; value: 0
    WISP_LINE_CONTACT =
        2, ///< from a vertex along the normal out of a body, of surfaces with contact; value: m, the gap
} wisp_line_kind;

typedef struct wisp_line
{
    wisp_vec3 from, to; ///< m
    wisp_line_kind kind;
    float value;
} wisp_line;

/// List the lines of a surface or of strands as they are now. Pins are half a mean edge long.
/// @param out [capacity]; may be null with capacity 0
/// @return the number of lines, which may exceed `capacity`; -1 if it is neither, with a message
WISP_API int wisp_draw_lines( wisp_world* world, wisp_entity entity, wisp_line* out, int capacity );

typedef struct wisp_pick
{
    int32_t vertex;   ///< the nearest one of what was found, in the user's order; -1: nothing
    int32_t triangle; ///< the user's; -1 of strands
    wisp_vec3 point;  ///< m, on the triangle or the strand
    float distance;   ///< m, from `from` to the point
} wisp_pick;

/// Find the first triangle or strand on the way from one point to another, or, if both are one point, the nearest one around it.
/// It looks at all of the entity: a millisecond for 100 000 triangles.
/// @param radius m, >= 0: how far strands may be beside the way, and anything from a single point. Triangles are hit without it
/// @return WISP_BAD_INPUT a number is not finite, or the radius is negative; WISP_CONFLICT it is neither a surface nor strands
WISP_API wisp_status wisp_pick_entity( wisp_world* world, wisp_entity entity, wisp_vec3 from, wisp_vec3 to,
                                       float radius, wisp_pick* out );

WISP_END_C
