/// Instances of one fabric side by side, one per lane: arguments of their kernels.
#pragma once

#include "wisp/fabric.h"

WISP_BEGIN_C

/// Surfaces that move together.
#define WISP_INSTANCE_LANES 16

/// Particles and links of surfaces with the same fabric and the same stiffness. Arithmetic is that of the kernels of single
/// surfaces, link by link in the cooked order, so bits are the same.
typedef struct wisp_instances_args
{
    int slot_count;
    float* position; ///< [slot][4][lane] x, y, z in m, inverse mass in 1/kg
    float* velocity; ///< [slot][3][lane] m/s; null: positions alone, for links
    float* previous; ///< [slot][3][lane] m, position at the start of the substep

    /// Rows of the surfaces: lane l begins at column + offset[l].
    float *position_column, *velocity_column, *previous_column; ///< [slot][4]
    int32_t offset[WISP_INSTANCE_LANES];                        ///< in floats, multiples of 4

    const float* area; ///< [slot] m^2
    uint32_t pinned;   ///< bits of lanes with a pinned vertex that has an area

    float dt;                                    ///< s
    float acceleration[3 * WISP_INSTANCE_LANES]; ///< [3][lane] m/s^2
    float keep[WISP_INSTANCE_LANES];             ///< fraction of a velocity that damping leaves
    bool accelerates, damps;

    int link_count;             ///< padding included
    const int32_t *a_x4, *b_x4; ///< [link] slots of the ends times 4; the same one pads
    const uint8_t* bends;       ///< [link / 8] bits of bend links
    const float* rest;          ///< [link] m
    bool is_compliant;          ///< xpbd, else pbd
    const float* own;           ///< [link] fraction of the error removed, or compliance in m/N
    float alike[2];             ///< without `own`: of edges and of bend links
    float inverse_dt2;          ///< 1/s^2
} wisp_instances_args;

/// Air on instances: as of wisp_strip_air_args, a surface a lane.
typedef struct wisp_instances_air_args
{
    float* sum; ///< [slot][4][lane] zero
    wisp_strips strips;
    float wind[3 * WISP_INSTANCE_LANES];
    float density[WISP_INSTANCE_LANES], drag[WISP_INSTANCE_LANES], lift[WISP_INSTANCE_LANES];
} wisp_instances_air_args;

/// A crowd of instances whose rows are in lanes, for passes that run in them.
typedef struct wisp_crowd
{
    const wisp_instances_args* args;
    const wisp_entity* entities; ///< [WISP_INSTANCE_LANES]; those from `count` on repeat the first one
    int count;
    uint32_t* left; ///< bits of lanes: a pass sets those of surfaces that have to run alone in this step
} wisp_crowd;

WISP_END_C
