/// Components of the module, and parameters as the passes read them.
#pragma once

#include "frozen_hair.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"
#include "wisp/module/space.h"

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

// ---- one run of the clump stage, and its memory ----

enum
{
    CLUMP_GRAIN = 1024, // slots a block of a copying loop
    CLUMP_SLICES = 32,  // slices a block of a summing loop
    CLUMP_GROUPS = 8,   // groups of strands a block
};

typedef struct clump_workspace
{
    wisp_grid grid, moved_grid;
    wisp_neighbours lists, moved_lists, stray_lists;
    wisp_buffer items;    // quads in the user's order, and where strands begin
    wisp_buffer slots;    // everything by slot
    wisp_buffer slices;   // everything by slice
    wisp_buffer measured; // r0 and g(r0) an entry
    wisp_buffer most;     // largest displacement a block
    wisp_buffer strays;   // vertices that have left their search margin, and their slots
    wisp_buffer late_pairs, late_lists;
} clump_workspace;

// One run of the stage.
typedef struct clump_run
{
    const wisp_parallel* parallel;
    const wisp_kernels* kernels;
    const wisp_strand_topology* strands;
    const frozen_clump* params;
    clump_workspace* w;
    wisp_frozen_hair_stats* report;
    float* position; // [row][3][16]
    int count, slices;
    float skin;           // m
    float* item_quads;    // [item][4]
    int32_t* root_lane;   // [strand] row * 16 + lane of vertex 0; the next vertex is a row further
    int32_t* slot_vertex; // [slot] index in the strand
    float *current, *tentative, *next, *spare; // [slot][4]
    float* displacement;                       // [slice][3][8]
    uint8_t* needs_search;                     // [slice] a bit a lane
    float* most;                               // [block]
    wisp_reference_pairs measured;

    // the lists in use
    const wisp_grid* grid;
    const int32_t* rename; // [slot of the grid] slot; null: the same
    const wisp_neighbours* lists;
    const float* searched;    // [slot][4] where the lists were made
    float moved;              // m, of any vertex since then
    wisp_neighbour_list late; // pairs within the radius that the lists lack
    wisp_adhesion_args args;
} clump_run;

/// Make the lists of the reference shape. @return WISP_NO_MEMORY
wisp_status clump_search( clump_run* run );
