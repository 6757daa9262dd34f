/// Guide hair: a few strands move, many ghosts follow them (Park and Kim 2024, "PBD-based Framework for Efficiently Controlling the
/// Movement of Strands in Hair"), and smooth curves are drawn through them.
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_guide_hair_module;

/// The elastic weight W of eq. 4, from the directions of the target's velocity now and a step before.
typedef enum wisp_ghost_elastic
{
    WISP_GHOST_ELASTIC_CHANGE, ///< 0.5 - 0.5 cos: 0 for steady motion, 1 for a reversal
    WISP_GHOST_ELASTIC_COSINE, ///< 0.5 + 0.5 cos
    WISP_GHOST_ELASTIC_DOT,    ///< 0.5 v . v0 + 0.5, m^2/s^2 as printed and not bounded: for comparison only
    WISP_GHOST_ELASTIC_OFF,    ///< 0
    WISP_GHOST_ELASTIC_COUNT,
} wisp_ghost_elastic;

/// Which rotation a ghost's offset takes with its target.
typedef enum wisp_ghost_frame
{
    WISP_GHOST_FRAME_OFF,      ///< none: offsets keep their direction in the world (printed)
    WISP_GHOST_FRAME_ROOT,     ///< that of the target's root
    WISP_GHOST_FRAME_PARALLEL, ///< that of the root, carried along the target by the smallest rotations
    WISP_GHOST_FRAME_COUNT,
} wisp_ghost_frame;

/// How ghosts follow. Fill from wisp_default_ghosts_def(). Copied.
typedef struct wisp_ghosts_def
{
    wisp_entity targets; ///< strands that move: the guides
    int target_count;    ///< 1 .. 4 targets a ghost, weighted by the inverse square of their distance; default 1.
                         ///< Where there are fewer targets, all of them
    bool resample;       ///< ghosts may have another number of vertices than their targets, paired by arc length;
                         ///< default false: such ghosts are refused
    wisp_ghost_elastic elastic; ///< default change
    float tip_gain;             ///< k_tip, 0 .. 1e3, default 0.5
    float centre_gain;          ///< k_com, 0 .. 1e3, default 0.5; of the distance to the centre at rest
    float time;                 ///< tau, s; default 0: the step. The printed form has 1
    bool capped;                ///< no vertex sways farther than a segment is long; default true
    bool keep_offset;           ///< a lone ghost keeps its offset although it is its own centre; default true
    float spread;               ///< Vbar / v_0 of eq. 2-3, 1e-6 .. 1e6; default 1: off. Sway comes on top
    bool repair_length;         ///< segments at rest length again, root first; default false
    wisp_ghost_frame frame;     ///< default parallel
    bool feedback; ///< the place after the sway is where the next step begins, and the mean of a group is
                   ///< tracked: sway that all share is undone, what differs adds up. Default false. Needs
                   ///< frame off and one target. The spread, unless 1, is then held with the sway in it
    bool between;  ///< keep what wisp_ghosts_between() needs, default false
    uint32_t cookie;
} wisp_ghosts_def;

WISP_API wisp_ghosts_def wisp_default_ghosts_def( void );

/// Let strands follow others as ghosts: assigned by eq. 1 where both are at rest (their shape as added), offsets kept. Or
/// follow others, or in another way. Ghosts write their place, and `strand.posed` too where that is wanted: want it of
/// ghosts that get an appearance on top, such as frozen hair.
/// @return WISP_BAD_INPUT a value is out of range, or node counts differ without `resample` (the message names ghost and
///         target); WISP_CONFLICT the module is not registered, there are no targets, an entity has no strands, the ghosts
///         move by themselves or are followed, or the targets follow others; WISP_STALE_ID; WISP_NO_MEMORY
/// @note Targets without a ghost are still simulated; how many there are is in the report. When the targets are removed the
///       ghosts stay where they are.
WISP_API wisp_status wisp_set_ghosts( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* def );

/// Where ghosts are between the last two steps, for drawing at a higher rate than steps are made: cubic Hermite
/// curves through both places, with the velocities of the targets' nodes. Ghosts stand still before their first step, and
/// an appearance on top is not in it.
/// @param fraction 0 the step before, 1 the last step
/// @param points [vertex_count], the user's order; untouched on failure
/// @return WISP_BAD_INPUT the fraction is not in [0, 1]; WISP_CONFLICT the entity has never followed targets, or
///         not with `between`
WISP_API wisp_status wisp_ghosts_between( wisp_world* world, wisp_entity ghosts, float fraction, wisp_vec3* points );

typedef struct wisp_ghosts_stats
{
    int ghost_count, target_count;
    int empty_targets;   ///< targets that won no ghost
    int largest_group;   ///< ghosts of one target
    int collapsed_nodes; ///< nodes behind the roots where all ghosts of a group of several coincide: no way to spread
} wisp_ghosts_stats;

WISP_API wisp_status wisp_read_ghosts_stats( wisp_world* world, wisp_entity ghosts, wisp_ghosts_stats* out );

/// The target of every ghost, the nearest of several; -1 of a ghost without vertices. @param targets [ghost_count]
WISP_API wisp_status wisp_read_ghost_targets( wisp_world* world, wisp_entity ghosts, int32_t* targets );

/// How curves run through the vertices of strands.
typedef enum wisp_curve_kind
{
    WISP_CURVE_BEZIER,      ///< eq. 6 on groups of four that share their ends, coefficient 3
    WISP_CURVE_CATMULL_ROM, ///< once continuously differentiable
    WISP_CURVE_KIND_COUNT,
} wisp_curve_kind;

/// Fill from wisp_default_curves_def(). Copied.
typedef struct wisp_curves_def
{
    wisp_entity source;   ///< strands of any kind
    wisp_curve_kind kind; ///< default Catmull-Rom
    int samples;          ///< M, a segment of the curve, 1 .. 64, default 8
    uint32_t cookie;
} wisp_curves_def;

WISP_API wisp_curves_def wisp_default_curves_def( void );

/// Add smooth curves through the vertices of other strands: an entity with strands of its own, whose points are the samples.
/// Strands of one vertex have no curve. A Bezier segment spans three segments of the strand, a Catmull-Rom segment one.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a value is out of range; WISP_CONFLICT the source has no strands or is curves itself, or the
///         module is not registered; WISP_STALE_ID; WISP_NO_MEMORY
/// @note Drawn at the end of a step, behind whatever changes the look of the source, and only where the source has changed.
///       When the source is removed the curves stay.
WISP_API wisp_status wisp_add_curves( wisp_world* world, const wisp_curves_def* def, wisp_entity* out );

WISP_END_C
