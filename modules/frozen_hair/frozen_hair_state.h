/// Components of the module, and parameters as the passes read them.
#pragma once

#include "frozen_hair.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

/// Every entity with frozen hair.
typedef struct frozen_settings
{
    uint64_t seed;
    int32_t base;     // wisp_frozen_base
    int32_t event;    // wisp_frozen_update
    uint32_t pending; // an update waits
    uint64_t next;    // event number of the next update
    float cursor[3];  // of the next command, m
    uint32_t points;  // the update that waits is a command: strands turn towards the cursor
} frozen_settings;

/// The update that the stages run.
typedef struct frozen_event
{
    uint64_t number; // of the random numbers
    float cursor[3]; // m
    uint32_t points; // no: with base stroke, strands only keep their turns
} frozen_event;

typedef struct frozen_freeze
{
    float bend_angle_max; // rad
} frozen_freeze;

typedef struct frozen_align
{
    float reach; // m
    int32_t reach_nearest;
} frozen_align;

/// With base stroke.
typedef struct frozen_stroke
{
    uint64_t number; // of the random numbers
    float turn[4];   // quaternion x y z w: how the moved strands are turned as a whole
} frozen_stroke;

/// With a limit of depth.
typedef struct frozen_depth
{
    float max_change; // m, >= 0
} frozen_depth;

typedef struct frozen_clump
{
    float radius, step, distance_min, lambda_min; // m, m, m, 1
    int32_t iterations, brakes, neighbour_limit;
} frozen_clump;

/// The components, a row each: X( member, "name", table, columns ).
#define FROZEN_COMPONENTS( X )                                                                                       \
    X( settings, "frozen_hair.settings", ENTITY, WISP_COLUMN( frozen_settings, settings, 1 ) )                       \
    X( event, "frozen_hair.event", ENTITY, WISP_COLUMN( frozen_event, event, 1 ) )                                   \
    X( freeze, "frozen_hair.freeze", ENTITY, WISP_COLUMN( frozen_freeze, freeze, 1 ) )                               \
    X( align, "frozen_hair.align", ENTITY, WISP_COLUMN( frozen_align, align, 1 ) )                                   \
    X( stroke, "frozen_hair.stroke", ENTITY, WISP_COLUMN( frozen_stroke, stroke, 1 ) )                               \
    X( swept, "frozen_hair.swept", STRAND_GROUP,                                                                     \
       WISP_COLUMN( float, swept, 64 ) ) /* [4][16] last turn of a strand (wisp_strand_align_args) */                \
    X( clump, "frozen_hair.clump", ENTITY, WISP_COLUMN( frozen_clump, clump, 1 ) )                                   \
    X( intensity, "frozen_hair.intensity", STRAND_GROUP,                                                             \
       WISP_COLUMN( float, intensity, 16 ) ) /* x in [0, 1], lane = strand */                                        \
    X( report, "frozen_hair.stats", ENTITY, WISP_COLUMN( wisp_frozen_hair_stats, report, 1 ) )                       \
    X( depth, "frozen_hair.depth", ENTITY, WISP_COLUMN( frozen_depth, depth, 1 ) )

/// Component numbers in one world.
typedef struct frozen_state
{
    FROZEN_COMPONENTS( WISP_COMPONENT_MEMBER )
    int workspace; // of the clump stage
} frozen_state;

/// Random streams of the paper's symbols.
enum
{
    FROZEN_STREAM_LENGTH = 1, // eta
    FROZEN_STREAM_ANGLE,      // xi
    FROZEN_STREAM_GAP,        // zeta
    FROZEN_STREAM_AXIS,
};

/// How moved strands are turned as a whole (frozen_hair_module.c).
wisp_pass_fn frozen_find_turn;

/// Bring frozen vertices back to their depth (frozen_hair_module.c).
wisp_pass_fn frozen_limit_depth;

/// The third stage (clump.c).
wisp_pass_fn frozen_clump_run;
size_t frozen_clump_workspace_size( void );
void frozen_clump_workspace_release( void* workspace, const wisp_allocator* allocator );
size_t frozen_clump_workspace_bytes( const void* workspace );
