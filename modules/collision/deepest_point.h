// The deepest point of a segment or a triangle in a convex body, in the frame of the body.
#pragma once

#include "collision_vectors.h"

#include "wisp/module/shapes.h"

/// The point of a primitive with the smallest signed distance.
typedef struct collision_deepest
{
    float weights[3];           // of the corners; they sum to 1
    wisp_surface_point surface; // of the body, closest to the point
} collision_deepest;

/// Return a lower bound of the signed distance of the points of a segment or a triangle, m, from the tangent planes at its corners;
/// -INFINITY if one is not finite. @param corner receives the smallest signed distance of a corner
float collision_bound_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float* corner );

/// Find the deepest point of a segment (2 corners) or a triangle (3 corners).
/// @param tolerance m, by which its signed distance may be above the smallest one, where rounding allows it
/// @return false if a corner is not finite
bool collision_find_deepest( const wisp_shape* shape, const wisp_vec3* corners, int corner_count, float tolerance,
                             collision_deepest* out );
