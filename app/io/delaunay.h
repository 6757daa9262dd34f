/// The Delaunay triangulation of the inside of an outline, in integers. Every predicate (side of a line, inside a
/// circle) is exact, so that no rounding can reverse a triangle, and the same points give the same triangles on every
/// machine.
///
/// Private to this folder.
#pragma once

#include "wisp/base.h"

enum
{
    DELAUNAY_SIDE = 1 << 26, // positions of the lattice along x and along y
};

/// A position on the lattice, both numbers in 0 .. DELAUNAY_SIDE - 1.
typedef struct delaunay_point
{
    int32_t x, y;
} delaunay_point;

/// Bring points to the lattice: the longer side of their bounding box becomes the whole of it.
/// @param coordinates [count][2] x and y
/// @param out [count]
/// @param name of the points in messages
/// @return WISP_BAD_INPUT a coordinate is not finite, or all points are one
wisp_status delaunay_snap( const double* coordinates, int count, delaunay_point* out, const char* name,
                           wisp_error* error );

/// Index of a position on Hilbert's curve. Positions that are near on the curve are near in the plane; two positions
/// never have the same index.
uint64_t delaunay_curve( delaunay_point place );

/// Number of triangles in an outline of `outline_count` points with `count` points in all (Euler).
static inline int delaunay_triangle_count( int count, int outline_count )
{
    return 2 * count - outline_count - 2;
}

/// Fill an outline with triangles whose corners are all the points. No point is inside the circle around a triangle,
/// unless the outline separates the two (constrained Delaunay; Chew 1989). Where four points are cocircular, the
/// order of the points on Hilbert's curve decides.
/// @param points [count] the outline, counter-clockwise, and then the points inside of it
/// @param outline_count >= 3
/// @param triangles [delaunay_triangle_count( count, outline_count )][3] receives indices, counter-clockwise;
///                  undefined on failure
/// @param name of the points in messages
/// @return WISP_BAD_INPUT too few points, a point off the lattice, two at one position, an outline that runs
///        clockwise, crosses itself or passes through a point, or a point outside of it: the message names the
///        points;
///         WISP_NO_MEMORY
wisp_status delaunay_fill( const delaunay_point* points, int count, int outline_count, int32_t* triangles,
                           const char* name, wisp_error* error );
