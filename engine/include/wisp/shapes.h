/// Poses: rigid transforms of bodies, strands and frames. Lengths are in m, angles in rad. All functions are pure.
///
///     const wisp_transform pose = wisp_transform_make( rotation, translation );
///     const wisp_vec3 placed = wisp_transform_to_world( pose, point );
#pragma once

#include <math.h>

#include "wisp/base.h"

WISP_BEGIN_C

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

/// Return the rotation a after b.
static inline wisp_quat wisp_quat_multiply( wisp_quat a, wisp_quat b )
{
    wisp_quat q = { a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                    a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z };
    return q;
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

WISP_END_C
