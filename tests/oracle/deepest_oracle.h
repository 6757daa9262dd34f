/// The deepest point of a segment or a triangle in a convex body, in double precision by brute force: samples, then finer ones around
/// the best.
#pragma once

#include "double3.h"

#include "wisp/module/shapes.h"

/// A body in its own frame. A convex polyhedron is given by the triangles of its hull.
typedef struct deepest_oracle_body
{
    wisp_shape_kind kind;
    double radius, half_length, top_radius, bottom_radius;
    double3 half_extent;
    const wisp_vec3* points;  // of a hull
    const int32_t* triangles; // [triangle_count][3] counter-clockwise seen from outside
    int triangle_count;
} deepest_oracle_body;

/// Take over the sizes of a shape that is no convex polyhedron.
deepest_oracle_body deepest_oracle_body_of( const wisp_shape* shape );

/// Signed distance of a point from a body, m; negative inside.
double deepest_oracle_distance( const deepest_oracle_body* body, double3 p );

/// Smallest signed distance of the points of a segment (2 corners) or a triangle (3 corners), m.
/// @param weights receives the weights of the corners of that point; may be null
double deepest_oracle_find( const deepest_oracle_body* body, const double3* corners, int corner_count,
                            double weights[3] );
