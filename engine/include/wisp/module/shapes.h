/// For modules: shapes in closed form (half space, sphere, capsule, tapered capsule, box), convex polyhedra and height fields:
/// closest point, signed distance, and the first time that a moving point meets the surface, in the frame of the body. Times are
/// fractions of a path. All functions but those that make a polyhedron are pure.
///
///     const wisp_shape ball = { .kind = WISP_SHAPE_SPHERE, .radius = 0.5f };
///     wisp_surface_point nearest;
///     if ( wisp_shape_closest( &ball, wisp_transform_to_local( pose, point ), &nearest ) )
///         depth = -nearest.distance;
#pragma once

#include "wisp/shapes.h"

WISP_BEGIN_C

// ---- convex polyhedra: the hull of points, up to a few hundred faces, kept as triangles and their planes ----

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
WISP_API wisp_vec3 wisp_convex_corner( const wisp_convex* convex, int triangle, int corner );

// ---- shapes ----

typedef enum wisp_shape_kind
{
    WISP_SHAPE_PLANE = 0,  ///< the half space y <= 0
    WISP_SHAPE_SPHERE = 1, ///< around the origin
    WISP_SHAPE_CAPSULE =
        2,              ///< all points within the radius of the line from (0, -half_length, 0) to (0, half_length, 0)
    WISP_SHAPE_BOX = 3, ///< around the origin, edges along the axes
    /// the hull of a ball around (0, -half_length, 0) and one around (0, half_length, 0)
    WISP_SHAPE_TAPERED_CAPSULE = 4,
    WISP_SHAPE_CONVEX = 5, ///< a convex polyhedron
    /// below a piecewise linear surface over the xz plane
    WISP_SHAPE_HEIGHT_FIELD = 6,
} wisp_shape_kind;

/// Heights on a grid centred on the y axis: sample (i, k) is at x = (i - (count_x - 1) / 2) spacing and likewise at z. Two
/// triangles per cell join them, split along the diagonal from (i, k) to (i + 1, k + 1). Everything below is inside. Beyond
/// the border the heights of the border go on.
typedef struct wisp_height_field
{
    const float* heights; ///< [count_z][count_x] m, finite
    int count_x, count_z; ///< >= 2
    float spacing;        ///< m, > 0
} wisp_height_field;

/// A solid in its own frame. Sizes that a kind does not have are not read. Sizes of zero are allowed: a point, a line
/// and a flat plate still have a surface, but no inside.
typedef struct wisp_shape
{
    wisp_shape_kind kind;
    float radius;          ///< m, >= 0: sphere, capsule
    float half_length;     ///< m, >= 0: capsule, tapered capsule
    wisp_vec3 half_extent; ///< m, each >= 0: box
    float
        top_radius; ///< m, >= 0: tapered capsule, of the ball at +y; if one ball holds the other, only that one counts
    float bottom_radius;            ///< m, >= 0: tapered capsule, of the ball at -y
    const wisp_convex* convex;      ///< convex
    wisp_height_field height_field; ///< height field
} wisp_shape;

/// The point of a surface that is closest to a query point.
typedef struct wisp_surface_point
{
    wisp_vec3 point;  ///< m, the closest one on the surface
    wisp_vec3 normal; ///< unit, outward: the direction in which the distance grows
    float distance;   ///< m, negative inside
} wisp_surface_point;

/// Closest point, outward normal and signed distance. Where several points are equally close (the centre of a sphere,
/// the axis of a capsule, the middle planes of a box) the normal is a fixed one of theirs: +y for a sphere, +x for a
/// capsule, of a tapered capsule the one in the half plane of +x, for a box the first axis and its positive side, and for a convex
/// polyhedron or a height field the first face.
/// @param p m, in the shape's frame
/// @return false if the point or a size is not finite, or a size negative: the surface is then infinitely far away
WISP_API bool wisp_shape_closest( const wisp_shape* shape, wisp_vec3 p, wisp_surface_point* surface );

/// First intersection of a path with a surface.
typedef struct wisp_shape_hit
{
    wisp_vec3 point;  ///< m, on the surface
    wisp_vec3 normal; ///< unit, outward
    float time;       ///< in [0, 1], fraction of the path
} wisp_shape_hit;

/// Cast a point along a straight path and find where it first meets the surface from outside. Touching counts; sliding along
/// the surface, leaving it, and paths that start inside do not. A path from a signed distance of 0 or more, as
/// wisp_shape_closest() gives it, to a negative one always meets the surface: rounding opens no gap.
/// @param from, to m, in the shape's frame. For a moving body `from` is taken into the frame by the old pose and `to` by
///        the new one.
/// @return false if there is no such time, or if anything is not finite or a size negative
WISP_API bool wisp_shape_cast( const wisp_shape* shape, wisp_vec3 from, wisp_vec3 to, wisp_shape_hit* hit );

WISP_END_C
