/// How deep balloons are in each other, by another way than that of contact: signed distances of the vertices of each from the others.
#pragma once

#include "world_from_scene.h"

typedef struct suite_overlap
{
    double depth; ///< m, how much nearer than the thickness, or how deep in another balloon, a vertex is at most
    double
        missed; ///< fraction of all vertices that are nearer than half of the thickness to another balloon, or in it
    /// m, of the vertices of the first balloon next to the second: how far they are from the line between both centres at most, and the root
    /// mean square of their distances from a plane across it; NaN without them
    double wall_radius, wall_unevenness;
} suite_overlap;

/// Of the balloons of a scene. What is deeper than half of the smallest extent of a balloon counts as that.
/// @return WISP_CONFLICT their points are not requested
wisp_status suite_overlap_find( const scene_world* world, suite_overlap* out, wisp_error* error );
