/// Guide hair: a few strands are simulated, many ghosts follow them, and smooth curves are drawn through them (Park and Kim
/// 2024, "PBD-based Framework for Efficiently Controlling the Movement of Strands in Hair").
///
///     wisp_ghosts_def def = wisp_default_ghosts_def();
///     def.targets = guides;                                  // strands with dynamics
///     wisp_set_ghosts( world, ghosts, &def );                // strands of their own, added with wisp_add_strands()
///     wisp_request( world, ghosts, WISP_STRAND_POINTS );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_guide_hair_module;

/// Elastic weight W (eq. 4), from the directions of the velocity of the target in this and the previous step.
typedef enum wisp_ghost_elastic
{
    WISP_GHOST_ELASTIC_CHANGE = 0, ///< 0.5 - 0.5 cos: 0 for steady motion, 1 for a reversal
    WISP_GHOST_ELASTIC_OFF = 1,    ///< 0
    WISP_GHOST_ELASTIC_COUNT = 2,
} wisp_ghost_elastic;

/// How ghosts follow. Fill from wisp_default_ghosts_def(). Copied. Their offsets turn with the frame of the target's root, which is
/// transported along the target without twist. The sway of a vertex is at most the length of a segment: the ghosts of a group
/// are scaled by one factor, set by the farthest of them, so that they stay apart however fast the head moves. With several
/// targets each ghost has its own. A single ghost of a target keeps its offset.
typedef struct wisp_ghosts_def
{
    uint32_t size;       ///< bytes; set by wisp_default_ghosts_def()
    wisp_entity targets; ///< the guides: strands with dynamics
    int target_count;    ///< targets per ghost, 1 .. 4, weighted by the inverse square of their distance; default 1.
                         ///< If there are fewer targets, all of them
    bool resample;       ///< allow ghosts with another number of vertices than their targets, paired by arc length;
                         ///< default false: they are refused
    wisp_ghost_elastic elastic; ///< default change
    float tip_gain;             ///< k_tip, 0 .. 1e3, default 0.5
    float centre_gain;          ///< k_com, 0 .. 1e3, default 0.5; per distance to the centre at rest
    float time;                 ///< tau, s; default 0: the length of the step
    float spread;               ///< Vbar / v_0 of eq. 2-3, 1e-6 .. 1e6; default 1: off. Sway is added
    bool repair_length;         ///< restore segments to rest length, from the root; default false
    bool between;               ///< keep the data of wisp_ghosts_between(), default false
} wisp_ghosts_def;

WISP_DEFINITION( ghosts_def );

/// Make strands follow others as ghosts, or replace their definition. Ghosts are assigned to targets by eq. 1 in the shapes
/// that both were added with, and keep their offsets. Request WISP_STRAND_POSED of ghosts that also get frozen hair.
/// @return WISP_BAD_INPUT a value is out of range, or node counts differ without `resample` (the message names ghost and
///         target); WISP_CONFLICT the module is not registered, there are no targets, an entity has no strands, the ghosts
///         have dynamics or are targets, or the targets are ghosts; WISP_STALE_ID; WISP_NO_MEMORY
/// @note Targets without a ghost are still simulated. If the targets are removed, the ghosts stay
///       where they are.
WISP_API wisp_status wisp_set_ghosts( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* def );

/// Interpolate ghosts between the last two steps, to draw at a higher rate than the simulation: cubic Hermite curves through
/// both positions, with the velocities of the targets. Ghosts rest before their first step. Frozen hair is not included.
/// @param fraction 0: the previous step, 1: the last step
/// @param points [vertex_count] m, the user's order; unchanged on failure
/// @return WISP_BAD_INPUT the fraction is not in [0, 1]; WISP_CONFLICT the entity has no targets, or `between` is false
WISP_API wisp_status wisp_ghosts_between( wisp_world* world, wisp_entity ghosts, float fraction, wisp_vec3* points );

/// Kind of curve through the vertices of strands.
typedef enum wisp_curve_kind
{
    WISP_CURVE_BEZIER =
        0, ///< eq. 6, coefficient 3, on groups of four vertices that share their ends and the tangents there:
           ///< inner points next to a joint are rotated about it, so that its direction is continuous
    WISP_CURVE_CATMULL_ROM = 1, ///< passes through all vertices, once continuously differentiable
    WISP_CURVE_KIND_COUNT = 2,
} wisp_curve_kind;

/// Smooth curves. Fill from wisp_default_curves_def(). Copied.
typedef struct wisp_curves_def
{
    uint32_t size;        ///< bytes; set by wisp_default_curves_def()
    wisp_entity source;   ///< strands of any kind
    wisp_curve_kind kind; ///< default Catmull-Rom
    int samples;          ///< M, per segment of the curve, 1 .. 64, default 8
} wisp_curves_def;

WISP_DEFINITION( curves_def );

/// Add smooth curves through the vertices of other strands: an entity with strands of its own, whose points are the samples.
/// Strands of one vertex have no curve. A Bezier segment spans three segments of the strand, a Catmull-Rom segment one.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a value is out of range; WISP_CONFLICT the source has no strands or is curves itself, or the
///         module is not registered; WISP_STALE_ID; WISP_NO_MEMORY
/// @note Computed at the end of a step, after all effects on the source, and only if the source changed. If the source is
///       removed, the curves stay.
WISP_API wisp_status wisp_add_curves( wisp_world* world, const wisp_curves_def* def, wisp_entity* out );

WISP_END_C
