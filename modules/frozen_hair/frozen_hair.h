/// Frozen hair: gives a static groom a frozen appearance in one update, without time integration, collision or fluid. Three
/// stages in this order: freeze (lengths nearly kept, bends limited), align (rotation towards a cursor), clump (neighbours
/// attract, gaps stay). Kim 2026, "A Stiffness-Based Real-Time Appearance Deformation Method for 2D Frozen
/// Hair Without Physical Simulation"; docs/methods.md lists where the paper is ambiguous.
///
///     wisp_frozen_hair_def frozen = wisp_default_frozen_hair_def();
///     frozen.clump_radius = 0.01f;                           // m
///     wisp_set_frozen_hair( world, strands, &frozen );
///     wisp_request( world, strands, WISP_STRAND_POINTS );
///     wisp_command_frozen_hair( world, strands, cursor );    // the next step updates the strands
///     wisp_world_step( world, dt );
#pragma once

#include "wisp/wisp.h"

WISP_BEGIN_C

typedef enum wisp_frozen_base
{
    WISP_FROZEN_BASE_REST = 0, ///< every update starts from the rest shape

    /// Every update starts from the rest shape, random numbers are drawn once for a stroke of any number of commands, and each
    /// strand keeps the direction and intensity of the last command that reached it. Clumping is not fed back.
    WISP_FROZEN_BASE_STROKE = 1,
    WISP_FROZEN_BASE_COUNT = 2,
} wisp_frozen_base;

typedef enum wisp_frozen_update
{
    WISP_FROZEN_UPDATE_HAIR_EVENT = 0, ///< update with each command: the strands are still between commands
    WISP_FROZEN_UPDATE_FRAME = 1,      ///< update in every step, for strands that another module moves
    WISP_FROZEN_UPDATE_COUNT = 2,
} wisp_frozen_update;

/// What keeps gaps between clumps (Kim 2026, eq. 17-19): vertices whose distances to their neighbours change are braked.
typedef enum wisp_gap
{
    WISP_GAP_ABSOLUTE = 0, ///< by |r1 - r0|: a large change brakes
    WISP_GAP_NONE = 1,     ///< no brake
    WISP_GAP_COUNT = 2,
} wisp_gap;

/// Parameters. Fill from wisp_default_frozen_hair_def(). Copied; need not outlive the call.
typedef struct wisp_frozen_hair_def
{
    uint32_t size;             ///< bytes; set by wisp_default_frozen_hair_def()
    bool freeze, align, clump; ///< stages to run; default all

    uint64_t seed;                ///< default 1
    wisp_frozen_base base;        ///< default rest
    wisp_frozen_update update_on; ///< default hair event

    // freeze, eq. 2-7
    float stretch_stiffness;               ///< k_s in [1e-3, 1e12], default 7
    float bend_stiffness;                  ///< k_b in [1e-3, 1e12], default 7
    const float* strand_stretch_stiffness; ///< [strand_count] or null (default): one number for all
    const float* strand_bend_stiffness;    ///< [strand_count] or null
    float max_bend_angle;                  ///< theta_max, rad, in [0, pi], default pi/4

    // align, eq. 8-13
    float intensity;               ///< x in [0, 1], default 0.8
    const float* strand_intensity; ///< [strand_count] or null
    wisp_vec3 cursor;   ///< c, m, target of the first update; default the origin; not read with base stroke. In two
                        ///< dimensions the z of cursors is not read
    float reach;        ///< r, m, >= 0, default 0.15
    bool reach_nearest; ///< any vertex within reach, not only the tip; default false

    // clump, eq. 14-19
    float clump_radius;      ///< h, m, > 0, default 0.01
    int clump_iterations;    ///< K in [0, 1000], default 4; 0 disables the stage
    float clump_step_length; ///< sigma, m, >= 0; default -1: a tenth of the radius
    wisp_gap gap;            ///< default absolute
    float
        min_distance; ///< r_min, m, >= 0: no two vertices come closer in one iteration; default -1: 0.02 of the radius
    float min_lambda;   ///< in [0, 1], default 0
    int max_neighbours; ///< in [1, 4096], default 256: further ones are ignored and counted

    /// m, >= 0; default -1: no limit. With a limit z is depth, as in a picture of layers (2.5D): freezing moves a vertex by at
    /// most this along z from its rest shape, or from the shape that another module moved it to; strands align about the z axis,
    /// to a cursor whose z is not read, and clump along x and y. Layers further apart than twice the limit stay in order.
    /// A segment that is brought back keeps its length by its x and y, unless it is steeper than that. In two dimensions
    /// nothing changes.
    float max_depth_change;
} wisp_frozen_hair_def;

WISP_DEFINITION( frozen_hair_def );

/// Give strands frozen hair, or replace its parameters. The next step makes the first update. A stroke goes on: strands keep
/// their alignment, and only commands change it. A swept strand keeps its intensity, all other parameters act on every strand;
/// another seed gives the stroke other random numbers.
/// @return WISP_BAD_INPUT a parameter is out of its range (the message names it, and the strand of a
///         per-strand value); WISP_CONFLICT the module is not registered in this world
WISP_API wisp_status wisp_set_frozen_hair( wisp_world* world, wisp_entity strands, const wisp_frozen_hair_def* def );

/// Point at a place: the next step updates the strands, with new random numbers unless the base is stroke. One command counts
/// a step: a second one before it replaces the first. @param cursor m, finite
WISP_API wisp_status wisp_command_frozen_hair( wisp_world* world, wisp_entity strands, wisp_vec3 cursor );

/// Begin a stroke: the next step updates the strands with new random numbers, and their alignment is forgotten.
/// @return WISP_CONFLICT the base is not stroke
WISP_API wisp_status wisp_begin_frozen_hair_stroke( wisp_world* world, wisp_entity strands );

/// Repeat an update by its number: the same one from rest gives the same bits. With base stroke it begins a stroke.
/// @param cursor m, finite @param event number of the update, which selects its random numbers
WISP_API wisp_status wisp_replay_frozen_hair( wisp_world* world, wisp_entity strands, wisp_vec3 cursor,
                                              uint64_t event );

/// Statistics of the last update. Always available.
typedef struct wisp_frozen_hair_stats
{
    uint64_t event;       ///< number of the last update, from 0
    uint64_t neighbours;  ///< pairs (vertex, neighbour) within the clump radius before the stage
    uint64_t capped;      ///< vertices whose neighbour list reached the limit
    uint64_t missed;      ///< pairs, both directions, that came near from outside the lists of a search
    uint32_t searches;    ///< neighbour searches of the last update
    uint32_t coarse_grid; ///< 1: cells were wider than the radius, because the scene is sparse
} wisp_frozen_hair_stats;

WISP_API wisp_status wisp_read_frozen_hair_stats( wisp_world* world, wisp_entity strands,
                                                  wisp_frozen_hair_stats* out );

WISP_API extern const wisp_module wisp_frozen_hair_module;

WISP_END_C
