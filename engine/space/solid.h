// Closest points and entries of solids that are more than a few numbers. Coordinates are finite.
#pragma once

#include "wisp/module/double3.h"

#include "wisp/module/shapes.h"

static const double SOLID_NEVER = 2.0; // later than the end of any path

void convex_closest( const wisp_convex* convex, double3 p, wisp_surface_point* s );
/// @param normal of the face, output
/// @return fraction of the path, beyond 1 if it does not enter
double convex_enter( const wisp_convex* convex, double3 from, double3 step, double3* normal );

void height_field_closest( const wisp_height_field* field, double3 p, wisp_surface_point* s );
double height_field_enter( const wisp_height_field* field, double3 from, double3 step, double3* normal );
/// The place of a sample, m. Beyond the border, within the range of int, the heights of the border go on.
double3 height_field_sample( const wisp_height_field* field, int i, int k );
bool height_field_is_solid( const wisp_height_field* field );

/// @return the exact sign of the volume of the tetrahedron a b c d: 1 if d is on the side of the normal (b - a) x (c - a), -1 on
/// the other, 0 in the plane
int space_side_of_plane( const float* a, const float* b, const float* c, const float* d );

/// Closest point of a triangle to p (Ericson 2005, 5.1.5).
double3 closest_on_triangle( double3 p, double3 a, double3 b, double3 c );
