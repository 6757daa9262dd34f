/// Tearing: cloth splits along edges of its mesh where an edge is pulled by more than a strength.
///
///     // The mesh ends with 50 vertices that are in no triangle: as many times it can split.
///     wisp_set_cloth( world, surface, &cloth );                       // by xpbd
///     wisp_tearing_def tearing = wisp_default_tearing_def();
///     tearing.strength = 200.0f;                                      // N/m
///     wisp_set_tearing( world, surface, &tearing );
///     ...
///     wisp_tearing_stats stats;
///     wisp_read_tearing_stats( world, surface, &stats );              // stats.split_count
///     wisp_read_triangles( world, surface, triangles, triangle_count );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_tearing_module;

/// Fill from wisp_default_tearing_def(). Copied; need not outlive the call.
typedef struct wisp_tearing_def
{
    uint32_t size; ///< bytes; set by wisp_default_tearing_def()
    /// N/m, of a strip per width, as a tensile test of a fabric gives it; > 0, default infinite: it never tears. The tension of an edge
    /// is its force by the width that it stands for, f l / (A_1 + A_2), with its rest length and the rest areas of its triangles
    float strength;
    /// [vertex_count] factors on the strength, the user's order, 0 .. 1e6; an edge has the mean of its ends. Default null: 1
    const float* factors;
    int max_splits; ///< in a step, 1 .. 1e6, default 64: bounds what a step costs
} wisp_tearing_def;

WISP_DEFINITION( tearing_def );

/// Let a cloth tear, or change how it tears. The force of an edge is -lambda / h^2, with the multiplier of its link (Macklin, Mueller,
/// Chentanez 2016, eq. 17-18) in the last substep of a step. Where an edge is pulled by more than the strength, the step ends with a
/// split: one of its ends becomes two vertices, along the edges of the mesh that are nearest to the perpendicular of the pulled one in
/// the rest shape (after Mueller et al. 2006, section 4.4). The edge with the largest tension by its strength is first, and edges near
/// a split wait for the next step. A vertex that joins two parts by a point only is split as well. Pinned vertices never split.
///
/// The new vertex is one of those that are in no triangle, the lowest first; when all are in use the cloth no longer tears. It has the
/// place, velocity and map values of the old one, and both have the mass of their triangles. Triangles keep their number and order:
/// read them with wisp_read_triangles(). The surface no longer shares its fabric. Instances and snapshots of it are of the torn surface;
/// a snapshot from before a tear is refused by wisp_world_restore().
///
/// Works with bending of all kinds, maps, pins, attachments of its pins, collision and contact. It needs xpbd, masses by area_density and
/// a manifold mesh, and is refused with coarse sheets, tethers, motion constraints, boundary particles and balloons, which
/// must not be set later either. Rows of what was attached or sewn to a vertex stay with the old vertex.
/// @param def null: it does not tear from now on
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered, the entity is not a
///         surface, or is one that does not tear (the message says why); WISP_STALE_ID; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_tearing( wisp_world* world, wisp_entity surface, const wisp_tearing_def* def );

typedef struct wisp_tearing_stats
{
    int split_count; ///< vertices that were split so far
    int spare_count; ///< vertices in no triangle that are left
    int over_count;  ///< edges above their strength in the last step
    float max_load;  ///< largest tension by its strength in the last step; 1 is where it tears
} wisp_tearing_stats;

/// @return WISP_CONFLICT the surface does not tear; WISP_STALE_ID
WISP_API wisp_status wisp_read_tearing_stats( wisp_world* world, wisp_entity surface, wisp_tearing_stats* out );

WISP_END_C
