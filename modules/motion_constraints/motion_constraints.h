/// Motion constraints: each vertex of a surface stays near a target that the host moves, such as its place on the skinned garment,
/// and out of a backstop behind the target (motion and separation constraints of NvCloth, max distance and backstop of Unreal).
///
///     wisp_motion_constraints_def def = wisp_default_motion_constraints_def();
///     def.max_distances = painted;                                               // [vertex_count] m
///     def.backstop_distance = 0.002f;
///     wisp_set_motion_constraints( world, surface, &def );
///     ...
///     wisp_move_motion_targets( world, surface, skinned, NULL );                 // before each step
///     wisp_world_step( world, dt );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_motion_constraints_module;

/// Fill from wisp_default_motion_constraints_def(). Copied; need not outlive the call. Arrays are in the user's order.
typedef struct wisp_motion_constraints_def
{
    uint32_t size; ///< bytes; set by wisp_default_motion_constraints_def()
    bool enabled;  ///< default true; false removes the constraints, and their passes

    const float* max_distances; ///< [vertex_count] m, >= 0; default null: max_distance for all
    float
        max_distance; ///< m from the target, >= 0; 0 holds the vertex at its target; infinite, the default: it is free

    /// [vertex_count] m, >= 0; default null: backstop_distance for all
    const float* backstop_distances;
    float
        backstop_distance; ///< m behind the target along its normal, >= 0; infinite, the default: there is no backstop
    const float* backstop_radii; ///< [vertex_count] m; default null: backstop_radius for all
    /// m, of a sphere whose surface is at the backstop distance, its centre farther behind; 0: no backstop; 1e-6 or more; infinite,
    /// the default: a plane. Where sphere and largest distance exclude each other, the sphere counts
    float backstop_radius;

    wisp_solver solver;        ///< default xpbd
    float distance_compliance; ///< xpbd: m/N, of the largest distance, >= 0, default 0: it is never exceeded
    float backstop_compliance; ///< xpbd: m/N, >= 0, default 0
    float distance_stiffness;  ///< pbd: fraction of the excess that a projection removes, 0 .. 1, default 1
    float backstop_stiffness;  ///< pbd: likewise, 0 .. 1, default 1

    /// [vertex_count] m; default null: targets stay where they are, and are first where the vertices are
    const wisp_vec3* targets;
    const wisp_vec3* normals; ///< [vertex_count] as in wisp_move_motion_targets()
} wisp_motion_constraints_def;

WISP_DEFINITION( motion_constraints_def );

/// Hold the vertices of a surface near targets, or replace the definition. The surface may be cloth of any kind, or a balloon. In a
/// substep the constraints come after those of the cloth and before collision and contact, which have the last word. Pinned vertices
/// are not constrained.
/// @return WISP_BAD_INPUT a number is out of range, or a target or normal is not finite (the message names the vertex);
///         WISP_CONFLICT the module is not registered, or the entity is not a surface; WISP_NO_MEMORY. Nothing changes then
WISP_API wisp_status wisp_set_motion_constraints( wisp_world* world, wisp_entity surface,
                                                  const wisp_motion_constraints_def* def );

/// Move the targets so that they reach these places at the end of the next step, in a straight line. Without another call they rest
/// there. wisp_teleport() moves them with the surface.
/// @param points [vertex_count] m, the user's order
/// @param normals [vertex_count] out of the backstops, of any length, 0: no backstop there; null: those of the triangles at the
///        targets, weighted by area. Ignored if there are no backstops
/// @return WISP_BAD_INPUT a coordinate is not finite, a target is beyond 1e6 m, or a normal is longer than 1e6 (the message names
///         the vertex), and nothing changes; WISP_CONFLICT the surface has no motion constraints
WISP_API wisp_status wisp_move_motion_targets( wisp_world* world, wisp_entity surface, const wisp_vec3* points,
                                               const wisp_vec3* normals );

WISP_END_C
