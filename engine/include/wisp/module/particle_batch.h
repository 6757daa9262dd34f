/// Particles of a block: arguments of the kernels for rigid motion, gathering and culling.
#pragma once

#include "wisp/module/shapes.h"

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
    /// [slot] instead of `fraction`; null: that one. Sums then weigh masses by it: what velocities lose has no momentum and no
    /// angular momentum if the rigid motion is the one of those sums.
    const float* fractions;
    float*
        rest; ///< [slot][4] null: none; else what a velocity loses is added to it, with the shift, and the velocity stays
    wisp_vec3 shift; ///< m/s
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

/// Most groups of eight slots in a block.
#define WISP_BATCH_GROUPS 32

/// Particles of a block, as arrays with room for the whole block: groups of eight slots, one after another.
typedef struct wisp_particle_batch
{
    int32_t* slot;   ///< [group] first slot of each group
    uint8_t* moving; ///< [group] a bit for each particle that moves and is finite
    uint8_t* pinned; ///< [group] a bit for each that is finite and does not move
    float* now[3];   ///< m, world position now
    float* old[3];   ///< m, world position at the start of the substep
} wisp_particle_batch;

/// Gather the particles of a block.
typedef struct wisp_gather_args
{
    const float *position, *previous; ///< [slot][4] m: now, with inverse masses; at the start of the substep
    float* search_origin;             ///< [slot][4] out: position, m, and infinity
    uint32_t groups;                  ///< a bit for each group of eight slots that is gathered
    wisp_particle_batch batch;        ///< out
    float *lower, *upper; ///< [3] out, m: bounds of all moving particles, at both times; infinite if none moves
} wisp_gather_args;

/// Shape used to cull particles beyond their reach, in the frame of the body.
typedef enum wisp_cull_shape
{
    WISP_CULL_HALF_SPACE,   ///< below y = 0
    WISP_CULL_BOX,          ///< the box
    WISP_CULL_ROUND,        ///< a sphere or a capsule along y at the origin
    WISP_CULL_BOX_AND_BALL, ///< the part of the box that is in a ball around its centre
} wisp_cull_shape;

/// Transform particles to the frame of a moving body, and cull those out of reach.
typedef struct wisp_cull_args
{
    wisp_particle_batch batch;
    wisp_transform before, after;
    wisp_cull_shape shape;
    wisp_vec3 centre, half;    ///< m, of the box, in the body's frame
    float radius, half_length; ///< m, of the sphere or capsule at the origin of the frame, or of the ball
    float margin;              ///< m; the reach of a particle is this plus its path
    float shift, turn;  ///< m, most that the body's origin moves in the step; most that a point moves besides, in
                        ///< lengths of its distance from there
    float* clearance;   ///< [particle] m, in and out: lowered to the reach of culled particles
    float* free_radius; ///< [particle] m, in and out: lowered to the radius in which a particle may move for the rest
                        ///< of the step without being found; may be 0 or less. May be null
    float *from[3], *to[3]; ///< [candidate] m, out, in the body's frame
    float *path, *reach;    ///< [candidate] m, out
    int32_t* candidates;    ///< out: particles that were not culled
} wisp_cull_args;

/// Find the closest points of a shape. Candidates are as they were culled.
typedef struct wisp_shape_query_args
{
    wisp_shape shape;
    const float *from[3], *to[3]; ///< [candidate] m, in the frame of the shape
    const float *path, *reach;    ///< [candidate] m
    float thickness, shallow;     ///< m; a start that is deeper in the thickness than `shallow` is special
    float* clearance;             ///< [candidate] m, out: distance from the shape if it is near and positive,
                                  ///< infinity if it is near and negative, else the reach
    int32_t* near;                ///< out: candidates within reach, rising
    float *point[3], *normal[3];  ///< [near] m, out, on the surface; unit, outwards
    float *distance, *start;      ///< [near] m, out: at the end of the path; at its start, from the plane, less the
                                  ///< thickness
    int32_t* special; ///< out: places in `near` of those whose path may enter the shape or whose start is deep
} wisp_shape_query_args;

/// Write half spaces and move particles out that start in the thickness. Arrays are padded to a multiple of eight by
/// repeating the last particle.
typedef struct wisp_half_space_rows_args
{
    wisp_transform before, after;       ///< of the body
    float thickness, shallow, recovery; ///< m; `recovery` is the most that a particle is moved out
    float static_friction, kinetic_friction;
    const float *point[3], *normal[3];    ///< [particle] in the frame of the body
    const float *now, *start;             ///< [particle] m, as in wisp_shape_query_args
    float *position, *previous;           ///< [slot][4] m, in and out
    float* rows;                          ///< [row][16] out, of the kernel half_space
    const int32_t *particle_x4, *row_x16; ///< slot times 4, row times 16
} wisp_half_space_rows_args;

enum
{
    WISP_OUTSIDE_SHAPES = 24, ///< most of a call
    WISP_OUTSIDE_SWEEPS = 4,  ///< over several half spaces of a particle
};

/// A shape in closed form in a substep, for eight particles: each lane may have its own. Of shapes that all share only the first lane is read.
typedef struct wisp_shape_lanes
{
    float axis[3][3][8]; ///< [axis][x, y, z] of the shape at the end; a plane and round shapes have but the second
    float at[3][8], was[3][8]; ///< m, its origin at the end and at the start
    float turn[3][3][8];       ///< [row][column] of its rotation in the substep
    /// m: of a box the half extents; else radius, lower and upper end of the centres on the axis, slope and sine as in taper.h
    float size[5][8];
    float shift[8], rate[8]; ///< m; most that its surface moves, and a point besides, in lengths of its distance
    float farther[8];        ///< times path and shift: what is farther from the shape is not reached by the path
    float thickness[8];      ///< m; below 0: the lane has no such shape
    float shallow[8];        ///< m; a start that is less deep in the thickness counts as on the surface
    float recovery[8];       ///< m, the most that a particle is moved out
    float static_friction[8], kinetic_friction[8];
    wisp_shape_kind kind;
    bool turns; ///< else `turn` is not read
} wisp_shape_lanes;

/// Keep particles outside shapes, with friction.
typedef struct wisp_outside_args
{
    float *position, *previous; ///< [slot][4] m, in and out
    const wisp_shape_lanes* shapes;
    int count;
} wisp_outside_args;

/// Tell what particles may meet up to the end of the step, whose shift and rate are those of the shapes.
typedef struct wisp_clear_args
{
    const float *position, *previous; ///< [slot][4] m
    const wisp_shape_lanes* shapes;   ///< [count] no planes
    const bool* blunt;                ///< [count] no primitive gets much nearer to it than its corners
    int first, count;                 ///< number of the first shape, of those that have told before
    float ahead, room;                ///< a particle may get this many times its path away, and `room`, m
    float away;                       ///< m, most that a point of a primitive is away from its nearest corner
    float* place;                     ///< [slot][4] m, out: where it is; minus how far it may get; may be null
    int32_t* words;                   ///< [slot] out: what its corners say of a primitive: see deepest.c
} wisp_clear_args;

/// Edges or triangles on their way from the previous positions to the positions.
typedef struct wisp_primitive_paths
{
    const float *position, *previous; ///< [slot][4] m
    const int32_t* corners;           ///< [primitive][corner_count] slots
    int corner_count;
    const float* place; ///< of near primitives: as in wisp_clear_args; null: of this substep alone
    const int32_t* words;
    float away;
} wisp_primitive_paths;

/// The point of an edge or a triangle that meets a shape.
typedef struct wisp_primitive_meeting
{
    int32_t primitive;
    float time;                           ///< 0 .. 1: when its path was stopped; 1: at its end
    float weights[3];                     ///< of the corners; they sum to 1
    float point[3], normal[3], motion[3]; ///< m: of the surface at the end, away from it, and what it moved
    float
        start; ///< m, signed distance where it starts less the thickness, and less what its corners are along the normal
} wisp_primitive_meeting;

WISP_END_C
