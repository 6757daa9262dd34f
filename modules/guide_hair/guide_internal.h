/// Components of the module, and data cooked when ghosts or curves are added.
#pragma once

#include "guide_hair.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

// ---- memory of one cooked thing ----

enum
{
    GUIDE_MAX_BLOCKS = 32,
    GUIDE_ROW = 3 * WISP_LANES, // floats of a row of strands
};

/// Blocks that are released together.
typedef struct guide_memory
{
    const wisp_allocator* allocator;
    void* blocks[GUIDE_MAX_BLOCKS];
    size_t bytes[GUIDE_MAX_BLOCKS];
    int count;
    bool failed; // an allocation failed
} guide_memory;

/// A zeroed block, 64-byte aligned, of at least one element. @return null without memory, which sets `failed`
void* guide_take( guide_memory* memory, size_t count, size_t element );
void guide_give_back( guide_memory* memory );

// ---- points in double precision, for cooking ----

typedef struct guide_point
{
    double x, y, z;
} guide_point;

static inline guide_point guide_widen( wisp_vec3 p )
{
    return ( guide_point ){ (double)p.x, (double)p.y, (double)p.z };
}

static inline guide_point guide_sub( guide_point a, guide_point b )
{
    return ( guide_point ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

/// a + s b
static inline guide_point guide_mul_add( guide_point a, double s, guide_point b )
{
    return ( guide_point ){ a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static inline double guide_dot( guide_point a, guide_point b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// The rest shape of an entity in the user's order.
typedef struct guide_shape
{
    const wisp_strand_topology* topology;
    wisp_vec3* points; // [vertex_count]
} guide_shape;

/// @return false without memory
bool guide_read_shape( wisp_world* world, wisp_entity strands, guide_memory* memory, guide_shape* shape );

static inline int guide_vertices( const guide_shape* shape, int strand )
{
    return shape->topology->offsets[strand + 1] - shape->topology->offsets[strand];
}

static inline const wisp_vec3* guide_strand( const guide_shape* shape, int strand )
{
    return shape->points + shape->topology->offsets[strand];
}

// ---- resampling (guide_curves.c) ----

/// A point of a strand as a sum of its vertices, whose numbers may repeat.
typedef struct guide_stencil
{
    int vertex[4];
    double weight[4];
} guide_stencil;

/// Normalised arc length of every vertex, 0 at the root and 1 at the tip; by number where a strand has no length.
void guide_arc( const wisp_vec3* points, int count, double* arc );
/// The Catmull-Rom point at a normalised arc length.
guide_stencil guide_spline_stencil( const wisp_vec3* points, int count, double arc );
guide_point guide_gather( const guide_stencil* stencil, const wisp_vec3* points );

// ---- ghosts ----

/// Lane = guide: a target as one group of ghosts follows it. Without resampling these are the lanes of the targets.
typedef struct guide_lanes
{
    int group_count, row_count;
    const int32_t* group_row;  // [group_count + 1]
    const int32_t* lane_count; // [group][16] nodes
    int32_t* lane_node;        // [group][16] float of the table where the root's quads begin
    float* cap;                // [row][16] m, rest length of the target's segment there
    float* reach;              // [row][16] centre weight of the farthest ghost there
    // resampled only
    int32_t* source;      // [row][4][16] float of the targets' rows where a vertex is
    float* weight;        // [row][4][16]
    int32_t* source_lane; // [group][16] float of the targets' roots; -1 in an empty lane
    float* rest;          // [row][3][16] m
    float* position;      // [row][3][16], and so on: of this step
    float *velocity, *before;
    float* root; // [group][4][16]
} guide_lanes;

/// Sources of velocities of ghosts that are drawn between steps (guide_curves.c).
typedef struct guide_sources
{
    int32_t* lane_from; // [group][link][16] float of the guides' rows where the target's root is; -1 in an empty lane
} guide_sources;

/// Ghosts and their targets. All but the table is constant.
typedef struct guide_follower
{
    guide_memory memory;
    wisp_entity ghosts;
    wisp_entity targets; // null once they are removed
    int link_count, stride;
    bool resampled, is_between;
    guide_lanes guides;
    float* table;          // [nodes + 1][stride], the last node belongs to empty lanes and stays 0
    int32_t* lane_node;    // [group][link][16] of the ghosts
    float* lane_fraction;  // [group][link][16]
    float* centre_scale;   // [group][16]
    float* offset;         // [row][link][3][16]
    float* length;         // [row][16] m, of the segment that ends in the row; null: lengths are not repaired
    int32_t* target;       // [strand] the first target of every ghost
    guide_sources sources; // drawn between steps only
} guide_follower;

/// Cook ghosts. @param out receives a follower of its own memory, null on failure
wisp_status guide_cook( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* def, guide_follower** out );
void guide_follower_release( void* follower, const wisp_allocator* allocator );

/// A group of ghosts, or a target that other groups blend in.
typedef struct guide_group
{
    int target, node_count;
    int first_node; // of the table
    int size;       // ghosts
    int next;       // group of the same target, -1
    int lane;       // of the guides
    double largest; // m, max |y - c| at rest
} guide_group;

/// One node of a group at rest.
typedef struct guide_node
{
    guide_point first, sum; // of the ghosts: the first, and differences to it
    guide_point centre;     // their mean
    guide_point anchor;     // origin of offsets
    guide_point rest;       // the target there
    double arc;             // normalised, sum over the ghosts
    double cap;             // m, of the target's segment there
    double farthest;        // m, max |y - c| of the ghosts there
    bool is_spread;         // two ghosts differ
    guide_stencil stencil;  // resampled only
} guide_node;

/// Groups while they are cooked (guide_cook.c).
typedef struct guide_groups
{
    const guide_shape *ghosts, *targets;
    const wisp_ghosts_def* def;
    int links;
    const int32_t* target; // [ghost][links]
    guide_group* groups;
    int group_count, node_count;
    guide_node* nodes;
    int32_t* of_target; // [target] first group
    int32_t* group;     // [ghost][links]
} guide_groups;

// ---- curves ----

typedef struct guide_drawing
{
    guide_memory memory;
    wisp_entity curves;
    wisp_entity source; // null once it is removed
    int samples;
    bool shares_ends;
    float* weight;          // [samples][4]
    int32_t* lane_row;      // [group][16]
    int32_t* lane_vertices; // [group][16]
} guide_drawing;

// ---- the module in one world ----

/// Settings of ghosts, as the passes read them.
typedef struct guide_settings
{
    float time; // s, 0: the step
    float tip_gain;
    int32_t is_elastic;
} guide_settings;

/// The components, a row each: X( member, "name", table, columns ).
#define GUIDE_COMPONENTS( X )                                                                                        \
    X( settings, "guide_hair.settings", ENTITY, WISP_COLUMN( guide_settings, settings, 1 ) )                         \
    X( repair, "guide_hair.repair", ENTITY, WISP_COLUMN( uint32_t, repairs, 1 ) )                                    \
    X( table, "guide_hair.table", ENTITY,                                                                            \
       WISP_COLUMN( uint64_t, steps, 1 ) ) /* of targets: how often it was filled */                                 \
    X( before, "guide_hair.before", STRAND_ROW,                                                                      \
       WISP_COLUMN( float, before, 48 ) ) /* m/s, [3][16] a row: the velocity a step before */                       \
    X( drawn, "guide_hair.drawn", ENTITY,                                                                            \
       WISP_COLUMN( uint64_t, changes, 1 ) ) /* of sources: how often their place was written */                     \
    X( curves, "guide_hair.curves", ENTITY,                                                                          \
       WISP_COLUMN( uint64_t, drawn, 1 ) ) /* the source's changes when it was drawn */                              \
    X( between, "guide_hair.between", STRAND_ROW,                                                                    \
       WISP_COLUMN( float, place_before, 48 ),    /* m, [3][16] a row: where motion had the ghosts a step before */  \
       WISP_COLUMN( float, place, 48 ),           /* m, and now */                                                   \
       WISP_COLUMN( float, velocity_before, 48 ), /* m/s, of their targets' nodes a step before */                   \
       WISP_COLUMN( float, velocity, 48 ) /* m/s, and now */ )                                                       \
    X( interval, "guide_hair.interval", ENTITY,                                                                      \
       WISP_COLUMN( float, seconds, 1 ) ) /* from the step before to the last one */                                 \
    X( held, "guide_hair.carried", STRAND_ROW,                                                                       \
       WISP_COLUMN( float, local, 48 ) ) /* m, [3][16] a row: relative to the root of the first target */            \
    X( carrier, "guide_hair.carrier", STRAND_GROUP,                                                                  \
       WISP_COLUMN( int32_t, lane, 16 ) ) /* float of that root's position in those of the targets; -1: none */

typedef struct guide_state
{
    GUIDE_COMPONENTS( WISP_COMPONENT_MEMBER )
    wisp_component detail;   // of entities whose level of detail was set
    wisp_objects* followers; // guide_follower, of ghosts
    wisp_objects* drawings;  // guide_drawing, of curves
} guide_state;

/// The same, unless the targets are removed.
const guide_follower* guide_active_follower( const guide_state* state, wisp_entity ghosts );
/// Release targets without ghosts and sources without curves.
void guide_let_go( wisp_world* world, const guide_state* state, wisp_entity entity );
void guide_drawing_release( void* drawing, const wisp_allocator* allocator );

/// guide_passes.c
wisp_pass_fn guide_run_targets, guide_run_ghosts, guide_run_lengths, guide_run_update_poses;
bool guide_ghosts_are_due( wisp_frame* frame, wisp_entity entity, void* user );

/// guide_passes.c
wisp_pass_fn guide_run_held;
bool guide_held_is_due( wisp_frame* frame, wisp_entity entity, void* user );
/// As the hooks of wisp_detail_hooks.
bool guide_has_coarse( const void* state, const wisp_world* world, wisp_entity entity );
wisp_status guide_prepare_detail( const void* state, wisp_world* world, wisp_entity entity );
void guide_detail_changed( const void* state, wisp_world* world, wisp_entity entity, wisp_detail from,
                           wisp_detail to );

/// guide_curves.c
/// @return false without memory
bool guide_cook_sources( guide_follower* follower, const guide_groups* groups );
/// Set the state of ghosts that do not move.
void guide_begin_between( wisp_world* world, const guide_state* state, const guide_follower* follower );
wisp_pass_fn guide_run_between;
bool guide_between_is_due( wisp_frame* frame, wisp_entity entity, void* user );

/// guide_curves.c
wisp_pass_fn guide_run_source, guide_run_curves;
bool guide_curves_are_due( wisp_frame* frame, wisp_entity entity, void* user );
