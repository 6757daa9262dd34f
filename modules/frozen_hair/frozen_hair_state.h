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

#define FROZEN_SETTINGS_COLUMNS( X ) X( frozen_settings, settings, 1 )
#define FROZEN_EVENT_COLUMNS( X ) X( frozen_event, event, 1 )
#define FROZEN_FREEZE_COLUMNS( X ) X( frozen_freeze, freeze, 1 )
#define FROZEN_ALIGN_COLUMNS( X ) X( frozen_align, align, 1 )
#define FROZEN_STROKE_COLUMNS( X ) X( frozen_stroke, stroke, 1 )
#define FROZEN_SWEPT_COLUMNS( X ) X( float, swept, 64 ) /* [4][16] last turn of a strand (wisp_strand_align_args) */
#define FROZEN_CLUMP_COLUMNS( X ) X( frozen_clump, clump, 1 )
#define FROZEN_DEPTH_COLUMNS( X ) X( frozen_depth, depth, 1 )
#define FROZEN_INTENSITY_COLUMNS( X ) X( float, intensity, 16 ) /* x in [0, 1], lane = strand */
#define FROZEN_STATS_COLUMNS( X ) X( wisp_frozen_hair_stats, report, 1 )

/// One line a component: X( member, "name", table, column list )
#define FROZEN_COMPONENTS( X )                                                                                       \
    X( settings, "frozen_hair.settings", WISP_TABLE_ENTITY, FROZEN_SETTINGS_COLUMNS )                                \
    X( event, "frozen_hair.event", WISP_TABLE_ENTITY, FROZEN_EVENT_COLUMNS )                                         \
    X( freeze, "frozen_hair.freeze", WISP_TABLE_ENTITY, FROZEN_FREEZE_COLUMNS )                                      \
    X( align, "frozen_hair.align", WISP_TABLE_ENTITY, FROZEN_ALIGN_COLUMNS )                                         \
    X( stroke, "frozen_hair.stroke", WISP_TABLE_ENTITY, FROZEN_STROKE_COLUMNS )                                      \
    X( swept, "frozen_hair.swept", WISP_TABLE_STRAND_GROUP, FROZEN_SWEPT_COLUMNS )                                   \
    X( clump, "frozen_hair.clump", WISP_TABLE_ENTITY, FROZEN_CLUMP_COLUMNS )                                         \
    X( intensity, "frozen_hair.intensity", WISP_TABLE_STRAND_GROUP, FROZEN_INTENSITY_COLUMNS )                       \
    X( report, "frozen_hair.stats", WISP_TABLE_ENTITY, FROZEN_STATS_COLUMNS )                                        \
    X( depth, "frozen_hair.depth", WISP_TABLE_ENTITY, FROZEN_DEPTH_COLUMNS )

/// Component numbers in one world.
typedef struct frozen_state
{
#define FROZEN_MEMBER( member, name, table, columns ) wisp_component member;
    FROZEN_COMPONENTS( FROZEN_MEMBER )
#undef FROZEN_MEMBER
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
