/// Particles of a block: arguments of the kernels for rigid motion, gathering and culling.
#pragma once

#include "wisp/shapes.h"

WISP_BEGIN_C

/// Particles about a point that moves, and the rigid motion that they are brought nearer to. Pinned ones count for nothing and
/// keep their velocity.
typedef struct wisp_rigid_args
{
    const float* position;      ///< [slot][4] m
    float* velocity;            ///< [slot][4] m/s, the fourth is 0
    wisp_vec3 origin;           ///< m
    wisp_vec3 linear_velocity;  ///< m/s, of the origin
    float inverse_mass;         ///< 1/kg, above 0, of the particle whose mass is the unit of the sums, m1
    wisp_vec3 angular_velocity; ///< rad/s; sums ignore it
    float fraction;             ///< of its difference from the rigid motion that a velocity loses; sums ignore it
} wisp_rigid_args;

/// With r from the origin and u less its drift. The terms of a few hundred particles are added as floats.
typedef struct wisp_rigid_sums
{
    double mass;                ///< m1
    double moment[3];           ///< m1 m, m r
    double momentum[3];         ///< m1 m/s, m u
    double angular_momentum[3]; ///< m1 m^2/s, m r x u
    double xx, yy, zz;          ///< m1 m^2, m r r
    double xy, xz, yz;
} wisp_rigid_sums;

/// Moving particles of a block, as arrays with room for the whole block.
typedef struct wisp_particle_batch
{
    int32_t* slot; ///< slot of each particle
    float* now[3]; ///< m, world position now
    float* old[3]; ///< m, world position at the start of the substep
} wisp_particle_batch;

/// Gather the moving particles of a block.
typedef struct wisp_gather_args
{
    const float *position, *previous; ///< [slot][4] m: now, with inverse masses; at the start of the substep
    float* search_origin;             ///< [slot][4] out: position, m, and infinity
    wisp_particle_batch batch;        ///< out
    float *lower, *upper; ///< [3] out, m: bounds of all moving particles, at both times; infinite if none moves
} wisp_gather_args;

/// Shape used to cull particles beyond their reach, in the frame of the body.
typedef enum wisp_cull_shape
{
    WISP_CULL_HALF_SPACE, ///< below y = 0
    WISP_CULL_BOX,        ///< the box
    WISP_CULL_ROUND,      ///< the box, and a sphere or a capsule along y at its centre
} wisp_cull_shape;

/// Transform particles to the frame of a moving body, and cull those out of reach.
typedef struct wisp_cull_args
{
    wisp_particle_batch batch;
    wisp_transform before, after;
    wisp_cull_shape shape;
    wisp_vec3 centre, half;    ///< m, of the box, in the body's frame
    float radius, half_length; ///< m, of the sphere or capsule at the origin of the frame
    float margin;              ///< m; the reach of a particle is this plus its path
    float *from[3], *to[3];    ///< m, out, in the body's frame
    float *path, *reach;       ///< m, out
    float* clearance;          ///< m, in and out: lowered to the reach of culled particles
    int32_t* candidates;       ///< out: particles that were not culled
} wisp_cull_args;

WISP_END_C
