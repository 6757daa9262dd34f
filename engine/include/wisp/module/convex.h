/// For modules: convex polyhedra of up to a few hundred faces. A convex polyhedron is the hull of points, kept as triangles and
/// their planes, and queried through wisp/shapes.h by a shape of kind WISP_SHAPE_CONVEX that points to it.
#pragma once

#include "wisp/shapes.h"

WISP_BEGIN_C

/// Most points that a hull is made of.
#define WISP_CONVEX_MAX_POINTS 1024

/// Opaque, immutable.
typedef struct wisp_convex wisp_convex;

/// Compute the convex hull of points. A point that is less than a millionth of the largest extent outside of the hull of the
/// others counts as on it.
/// @param points [count] m, finite, within 1e9 m of 0; not kept
/// @param allocator may be null; copied
/// @param out receives the hull, null on failure
/// @return WISP_BAD_INPUT fewer than 4 or more than WISP_CONVEX_MAX_POINTS points, one is not finite, or they lie in a plane;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_convex_create( const wisp_vec3* points, int count, const wisp_allocator* allocator,
                                         wisp_convex** out, wisp_error* error );
/// Null is allowed.
WISP_API void wisp_convex_release( wisp_convex* convex );
WISP_API size_t wisp_convex_bytes( const wisp_convex* convex );
/// @param triangles receives [triangles][3] indices into the points, counter-clockwise seen from outside. Valid as long as
///        the hull
/// @return number of triangles
WISP_API int wisp_convex_triangles( const wisp_convex* convex, const int32_t** triangles );

WISP_END_C
