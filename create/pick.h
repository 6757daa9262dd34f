/// What lies under a mouse, or near a point. Nothing has to be requested.
///
///     wisp_hit hit;
///     if ( wisp_pick( world, cloth, eye, far_point, 0.0f, &hit ) == WISP_OK && hit.vertex >= 0 )
///         wisp_pin( world, cloth, &hit.vertex, 1 );                    // and wisp_move_pins() with the mouse
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

typedef struct wisp_hit
{
    int32_t vertex;   ///< the nearest one of what was found, in the user's order; -1: nothing
    int32_t triangle; ///< the user's; -1 of strands
    wisp_vec3 point;  ///< m, on the triangle or the strand
    float distance;   ///< m, from `from` to the point
} wisp_hit;

/// Find the first triangle or strand on the way from one point to another, or, if both are one point, the nearest one around it, as
/// they were after the last step. It looks at all of the entity.
/// @param from, to m, relative to the origin of the entity, as its views are
/// @param radius m, >= 0: how far strands may be beside the way, and anything from a single point. Triangles are hit without it
/// @return WISP_BAD_INPUT a number is not finite, or the radius is negative; WISP_CONFLICT it is neither a surface nor strands that move
WISP_API wisp_status wisp_pick( wisp_world* world, wisp_entity entity, wisp_vec3 from, wisp_vec3 to, float radius,
                                wisp_hit* out );

WISP_END_C
