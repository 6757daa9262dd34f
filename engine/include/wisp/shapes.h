/// Shapes in closed form (half space, sphere, capsule, tapered capsule, box), convex polyhedra and height fields: closest point,
/// signed distance, and the first time that a moving point meets the surface, in the frame of the body. Rigid transforms lead into that frame. Lengths are in m, angles in
/// rad, times are fractions of a path. All functions are pure.
///
///     const wisp_transform pose = wisp_transform_make( rotation, translation );
///     const wisp_shape ball = { .kind = WISP_SHAPE_SPHERE, .radius = 0.5f };
///     wisp_surface_point nearest;
///     if ( wisp_shape_closest( &ball, wisp_transform_to_local( pose, point ), &nearest ) )
///         depth = -nearest.distance;
#pragma once

#include <math.h>

#include "wisp/base.h"

WISP_BEGIN_C

// ---- poses ----

/// A rotation as a unit quaternion, w its real part.
typedef struct wisp_quat
{
    float x, y, z, w;
} wisp_quat;

/// A rigid transform: a point p of the body is at rotation p + translation in the world.
typedef struct wisp_transform
{
    wisp_quat rotation;    ///< unit length, ensured by wisp_transform_make()
    wisp_vec3 translation; ///< m
} wisp_transform;

/// Make a transform with a rotation of unit length. A quaternion that is zero or not finite means no rotation.
static inline wisp_transform wisp_transform_make( wisp_quat rotation, wisp_vec3 translation )
{
    double x = (double)rotation.x, y = (double)rotation.y, z = (double)rotation.z, w = (double)rotation.w;
    double squared = x * x + y * y + z * z + w * w;
    wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, translation };
    if ( squared > 0.0 && squared < (double)INFINITY )
    {
        double scale = 1.0 / sqrt( squared );
        pose.rotation.x = (float)( x * scale );
        pose.rotation.y = (float)( y * scale );
        pose.rotation.z = (float)( z * scale );
        pose.rotation.w = (float)( w * scale );
    }
    return pose;
}

/// Rotate v by a unit quaternion: v + 2 w (q x v) + 2 q x (q x v).
static inline wisp_vec3 wisp_quat_rotate( wisp_quat q, wisp_vec3 v )
{
    float tx = 2.0f * ( q.y * v.z - q.z * v.y );
    float ty = 2.0f * ( q.z * v.x - q.x * v.z );
    float tz = 2.0f * ( q.x * v.y - q.y * v.x );
    wisp_vec3 turned = { v.x + q.w * tx + ( q.y * tz - q.z * ty ), v.y + q.w * ty + ( q.z * tx - q.x * tz ),
                         v.z + q.w * tz + ( q.x * ty - q.y * tx ) };
    return turned;
}

static inline wisp_vec3 wisp_quat_inverse_rotate( wisp_quat q, wisp_vec3 v )
{
    wisp_quat inverse = { -q.x, -q.y, -q.z, q.w };
    return wisp_quat_rotate( inverse, v );
}

/// Transform a point of the body to the world. For directions use wisp_quat_rotate( pose.rotation, v ).
static inline wisp_vec3 wisp_transform_to_world( wisp_transform pose, wisp_vec3 body_point )
{
    wisp_vec3 p = wisp_quat_rotate( pose.rotation, body_point );
    p.x += pose.translation.x;
    p.y += pose.translation.y;
    p.z += pose.translation.z;
    return p;
}

/// Transform a point of the world to the frame of the body.
static inline wisp_vec3 wisp_transform_to_local( wisp_transform pose, wisp_vec3 world_point )
{
    wisp_vec3 p = { world_point.x - pose.translation.x, world_point.y - pose.translation.y,
                    world_point.z - pose.translation.z };
    return wisp_quat_inverse_rotate( pose.rotation, p );
}

/// Interpolate between two transforms along the shorter rotation; a time of 0 or less gives `from`, of 1 or more `to`. The
/// axis is exact. The angle follows the normalised line between the quaternions: within 0.02 degrees of uniform for poses
/// 20 degrees apart, within 2 degrees at 90.
static inline wisp_transform wisp_transform_interpolate( wisp_transform from, wisp_transform to, float time )
{
    if ( !( time > 0.0f ) )
    {
        return from;
    }
    if ( time >= 1.0f )
    {
        return to;
    }
    wisp_quat a = from.rotation, b = to.rotation;
    float old = 1.0f - time, dot = a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
    float turn = dot < 0.0f ? -time : time; // q and -q are the same rotation
    wisp_quat q = { old * a.x + turn * b.x, old * a.y + turn * b.y, old * a.z + turn * b.z, old * a.w + turn * b.w };
    wisp_vec3 p = { old * from.translation.x + time * to.translation.x,
                    old * from.translation.y + time * to.translation.y,
                    old * from.translation.z + time * to.translation.z };
    return wisp_transform_make( q, p );
}

/// Mean velocity of a point of the body between two poses, m/s: its displacement over dt, as in a position-based step.
/// @param dt s; 0 gives no velocity
static inline wisp_vec3 wisp_transform_velocity( wisp_transform from, wisp_transform to, float dt,
                                                 wisp_vec3 body_point )
{
    wisp_vec3 a = wisp_transform_to_world( from, body_point ), b = wisp_transform_to_world( to, body_point );
    float scale = dt > 0.0f ? 1.0f / dt : 0.0f;
    wisp_vec3 velocity = { scale * ( b.x - a.x ), scale * ( b.y - a.y ), scale * ( b.z - a.z ) };
    return velocity;
}

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
    float bottom_radius;              ///< m, >= 0: tapered capsule, of the ball at -y
    const struct wisp_convex* convex; ///< convex: see wisp/module/convex.h
    wisp_height_field height_field;   ///< height field
} wisp_shape;

/// Check that the kind exists and that its sizes are finite and not negative.
/// @return WISP_BAD_INPUT with a message that names the size
WISP_API wisp_status wisp_shape_check( const wisp_shape* shape, wisp_error* error );

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
