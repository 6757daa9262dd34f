/// Particles of a block, all at once: their rigid motion, and where bodies see them. What the kernels in wisp/module/kernels.h of these
/// names go by.
#pragma once

#include "wisp/shapes.h"

WISP_BEGIN_C

/// Particles about a point that moves, and the rigid motion that they are brought nearer to. Pinned ones count for nothing and
/// keep their velocity.
typedef struct wisp_rigid_args
{
    const float* position; ///< [slot][4] m
    float* velocity;       ///< [slot][4] m/s, the fourth is 0
    wisp_vec3 origin;      ///< m
    wisp_vec3 drift;       ///< m/s, of the origin
    float inverse_mass;    ///< 1/kg, above 0, of the particle whose mass is the unit of the sums, m1
    wisp_vec3 turning;     ///< rad/s; sums do not look at it
    float fraction;        ///< of what a velocity differs from the rigid motion, that is taken from it; likewise
} wisp_rigid_args;

/// With r from the origin and u less its drift. The terms of a few hundred particles are added as floats.
typedef struct wisp_rigid_sums
{
    double mass;        ///< m1
    double moment[3];   ///< m1 m, m r
    double momentum[3]; ///< m1 m/s, m u
    double angular[3];  ///< m1 m^2/s, m r x u
    double xx, yy, zz;  ///< m1 m^2, m r r
    double xy, xz, yz;
} wisp_rigid_sums;

/// Particles of a block that move, as arrays. Arrays have room for all of the block.
typedef struct wisp_particle_batch
{
    int32_t* slot; ///< of each of them
    float* now[3]; ///< m, in the world
    float* old[3]; ///< m, likewise, when the substep began
} wisp_particle_batch;

/// Who of a block moves.
typedef struct wisp_gather_args
{
    const float *position, *previous;   ///< [slot][4] m, now with inverse masses, and when the substep began
    float* place;                       ///< [slot][4] out: where it is, m, and infinity
    wisp_particle_batch particle_batch; ///< out
    float *lower, *upper;               ///< [3] out, m: of all that move, then and now; infinite without any
} wisp_gather_args;

/// What is left out of a look at a body, as it sees the particles: whatever is farther than its reach.
typedef enum wisp_cull_shape
{
    WISP_CULL_HALF_SPACE, ///< below y = 0
    WISP_CULL_BOX,        ///< the box
    WISP_CULL_ROUND,      ///< the box, and a ball or a capsule along y in its middle
} wisp_cull_shape;

/// Particles as a body sees them that goes from a pose to another.
typedef struct wisp_cull_args
{
    wisp_particle_batch particle_batch;
    wisp_transform before, after;
    wisp_cull_shape bound;
    wisp_vec3 centre, half;    ///< m, of the box, in the body's frame
    float radius, half_length; ///< m, of what is round, about the frame's origin
    float margin;              ///< m; a particle's reach is that and its path
    float *from[3], *to[3];    ///< m, out, in the body's frame
    float *path, *reach;       ///< m, out
    float* clear;              ///< m, in and out: lowered to the reach of who is left out
    int32_t* queried;          ///< out: who is not
} wisp_cull_args;

WISP_END_C
