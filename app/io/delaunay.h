/// The Delaunay triangulation of what lies inside an outline, in whole numbers. Every question that decides (which side
/// of a line, inside a circle or not) is answered exactly, so that no rounding can turn a triangle over, and the same
/// points give the same triangles on every machine.
///
/// Private to this folder.
#pragma once

#include "wisp/base.h"

enum
{
    DELAUNAY_SIDE = 1 << 26, // places of the lattice along x and along y
};

/// A place of the lattice, both numbers in 0 .. DELAUNAY_SIDE - 1.
typedef struct delaunay_point
{
    int32_t x, y;
} delaunay_point;

/// Bring points to the lattice: the longer side of their bounding box becomes the whole of it.
/// @param coordinates [count][2] x and y
/// @param out [count]
/// @param name what messages call the points
/// @return WISP_BAD_INPUT a coordinate is not finite, or all points are one
wisp_status delaunay_snap( const double* coordinates, int count, delaunay_point* out, const char* name,
                           wisp_error* error );

/// How far along Hilbert's curve a place lies. Places that are near on the curve are near in the plane; two places are
/// never the same number.
uint64_t delaunay_curve( delaunay_point place );

/// How many triangles fill an outline of `outline_count` points that holds `count` points in all (Euler).
static inline int delaunay_triangle_count( int count, int outline_count )
{
    return 2 * count - outline_count - 2;
}

/// Fill an outline with triangles whose corners are all the points. No point lies inside the circle around a triangle,
/// unless the outline stands between the two (constrained Delaunay; Chew 1989). Where four points lie on a circle, the
/// order of the points on Hilbert's curve decides.
/// @param points [count] the outline, counter-clockwise, and then the points inside of it
/// @param outline_count >= 3
/// @param triangles [delaunay_triangle_count( count, outline_count )][3] receives indices, counter-clockwise;
///                  undefined on failure
/// @param name what messages call the points
/// @return WISP_BAD_INPUT too few points, a point off the lattice, two at one place, an outline that runs clockwise,
///         crosses itself or passes through a point, or a point outside of it: the message names the points;
///         WISP_NO_MEMORY
wisp_status delaunay_fill( const delaunay_point* points, int count, int outline_count, int32_t* triangles,
                           const char* name, wisp_error* error );
