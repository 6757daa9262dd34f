/// What the files of this folder share.
#pragma once

#include "strands.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <math.h>

/// Bound of each coordinate of positions, m, and velocities, m/s, as the guard of particles has it.
#define STRANDS_BOUND 1e6f

/// A definition that was checked, as passes read it. Presence of the other components says which passes there are.
typedef struct strands_settings
{
    wisp_vec3 gravity;    // m/s^2
    float bend_rigidity;  // N m^2
    float twist_rigidity; // N m^2
    float bend_damping;   // s
    float teleport;       // m, a root that goes farther in a step takes its strands along
    int32_t rest;         // wisp_strand_rest
    int32_t clamped;
} strands_settings;

typedef struct strands_direct
{
    int32_t passes;
    float tolerance;
    int32_t has_rod; // which pulls with the tension first
} strands_direct;

/// How links answer; compliance in m/N counts where xpbd is not 0.
typedef struct strands_link
{
    int32_t xpbd;
    float stiffness, compliance;
} strands_link;

typedef struct strands_head
{
    wisp_rigid from, to; // at the start and at the end of the step
    wisp_rigid target;   // at the end of the next one
    int32_t jumped;      // the strands went along at once: the pose is `to` from the first substep on
    int32_t stands;      // it does not move in this step: roots are where it holds them already
} strands_head;

typedef struct strands_air
{
    wisp_vec3 wind; // m/s
    float drag;     // kg/m^2: 1/2 density C_d diameter
} strands_air;

typedef struct strands_grid
{
    float cell;         // m
    float friction;     // in a step of 1/60 s
    float repulsion;    // m/s^2
    float rest_density; // kg/m^3, mean over the mass at rest; 0: not known yet
} strands_grid;

#define STRANDS_SETTINGS( X ) X( strands_settings, settings, 1 )
#define STRANDS_HEAD( X ) X( strands_head, head, 1 )
#define STRANDS_DAMPING( X ) X( float, rate, 1 ) /* 1/s */
#define STRANDS_AIR( X ) X( strands_air, air, 1 )
#define STRANDS_PINS( X ) X( int32_t, count, 1 )  /* vertices behind the root that are held */
#define STRANDS_FAULT( X ) X( int32_t, fault, 1 ) /* the guard put the entity back in this step */
#define STRANDS_DIRECT( X ) X( strands_direct, direct, 1 )
#define STRANDS_LINKS( X ) X( strands_link, link, 1 )
#define STRANDS_FOLLOW( X ) X( float, share, 1 )
#define STRANDS_BEND_LINKS( X ) X( strands_link, link, 1 )
#define STRANDS_TENSION( X ) X( float, tension, 16 ) /* N, of the segment to the next row */
#define STRANDS_STRETCH_LINK( X )                                                                                    \
    X( float, rest, 16 )   /* m, to the next row; 0 or less: no link */                                              \
    X( float, lambda, 16 ) /* N s^2, of the substep; only kept with several iterations */
#define STRANDS_BEND_LINK( X )                                                                                       \
    X( float, rest, 16 ) /* m, to the row after the next; 0 or less: no link */                                      \
    X( float, lambda, 16 )
#define STRANDS_ROD( X )                                                                                             \
    X( float, inverse_length, 16 ) /* 1/m, of the segment to the next row; 0 where there is none */                  \
    X( float, stiffness, 16 )      /* N m, EI / L_i, lowered where single precision could not solve for it */        \
    X( float, factor, 48 )         /* 1/pivot, L(i, i-1), L(i, i-2) */                                               \
    X( float, most_tension, 16 )   /* N, weight of what is behind the segment: a substep begins with no more */
#define STRANDS_CLAMP( X )                                                                                           \
    X( float, clamp, 64 )   /* quaternion [4][16], x y z w: frame at rest, z along the direction of growth */        \
    X( float, factored, 1 ) /* s, the substep that the factors are for; 0: none */
#define STRANDS_CURVE( X )                                                                                           \
    X( float, frame, 64 )                               /* quaternion [4][16] of the segment to the next row */      \
    X( float, rest, 48 )                                /* k_i in the middle frame of vertex i */                    \
    X( float, rest_twist, 32 )                          /* cosine and sine of half the rest twist */                 \
    X( float, twist_stiffness, 16 )                     /* N m, GJ / L_i */                                          \
    X( float, rest_tension, 16 )                        /* N, of the segment to the next row, in balance */
#define STRANDS_STRAIGHT( X ) X( int32_t, straight, 1 ) /* the rod does without frames */
#define STRANDS_BALANCE( X )                                                                                         \
    X( float, balanced, 1 ) /* s, the substep that the rest curvature is for; 0: none */                             \
    X( float, share, 16 )   /* of its weight that a strand holds, and feels */
#define STRANDS_GOOD( X )                                                                                            \
    X( float, position, 48 ) /* at the end of the last step that was finite and within bounds */                     \
    X( float, velocity, 48 )
#define STRANDS_SEEN( X )                                                                                            \
    X( int32_t, seen, 1 ) /* the group was found within bounds where the step ended: 0 between steps */
#define STRANDS_SURFACE( X ) X( wisp_entity, surface, 1 ) /* null: it was removed, roots stay */
#define STRANDS_ANCHOR( X )                                                                                          \
    X( int32_t, slot, 48 )  /* [3][16] corners of the triangle, slots of the surface's fabric */                     \
    X( float, weight, 48 )  /* [3][16] barycentric */                                                                \
    X( float, turn, 64 )    /* [4][16] from the triangle's frame to the root's rotation */                           \
    X( float, corner, 144 ) /* [3 corners][3][16] m, at the end of the step before */                                \
    X( float, jump, 64 )    /* [4][16] rotation of a strand that went along at once in this step; zero: it did not */
#define STRANDS_GRID( X ) X( strands_grid, grid, 1 )

/// One line a component: X( member, "name", table, column list )
#define STRANDS_COMPONENTS( X )                                                                                      \
    X( settings, "strands.settings", WISP_TABLE_ENTITY, STRANDS_SETTINGS )                                           \
    X( head, "strands.head", WISP_TABLE_ENTITY, STRANDS_HEAD )                                                       \
    X( damping, "strands.damping", WISP_TABLE_ENTITY, STRANDS_DAMPING )                                              \
    X( air, "strands.air", WISP_TABLE_ENTITY, STRANDS_AIR )                                                          \
    X( pins, "strands.pins", WISP_TABLE_ENTITY, STRANDS_PINS )                                                       \
    X( fault, "strands.fault", WISP_TABLE_ENTITY, STRANDS_FAULT )                                                    \
    X( direct, "strands.direct", WISP_TABLE_ENTITY, STRANDS_DIRECT )                                                 \
    X( links, "strands.links", WISP_TABLE_ENTITY, STRANDS_LINKS )                                                    \
    X( follow, "strands.follow", WISP_TABLE_ENTITY, STRANDS_FOLLOW )                                                 \
    X( bend_links, "strands.bend_links", WISP_TABLE_ENTITY, STRANDS_BEND_LINKS )                                     \
    X( tension, "strands.tension", WISP_TABLE_STRAND_ROW, STRANDS_TENSION )                                          \
    X( stretch_link, "strands.stretch_link", WISP_TABLE_STRAND_ROW, STRANDS_STRETCH_LINK )                           \
    X( bend_link, "strands.bend_link", WISP_TABLE_STRAND_ROW, STRANDS_BEND_LINK )                                    \
    X( rod, "strands.rod", WISP_TABLE_STRAND_ROW, STRANDS_ROD )                                                      \
    X( clamp, "strands.clamp", WISP_TABLE_STRAND_GROUP, STRANDS_CLAMP )                                              \
    X( curve, "strands.curve", WISP_TABLE_STRAND_ROW, STRANDS_CURVE )                                                \
    X( straight, "strands.straight", WISP_TABLE_ENTITY, STRANDS_STRAIGHT )                                           \
    X( balance, "strands.balance", WISP_TABLE_STRAND_GROUP, STRANDS_BALANCE )                                        \
    X( good, "strands.good", WISP_TABLE_STRAND_ROW, STRANDS_GOOD )                                                   \
    X( seen, "strands.seen", WISP_TABLE_STRAND_GROUP, STRANDS_SEEN )                                                 \
    X( surface, "strands.surface", WISP_TABLE_ENTITY, STRANDS_SURFACE )                                              \
    X( anchor, "strands.anchor", WISP_TABLE_STRAND_GROUP, STRANDS_ANCHOR )                                           \
    X( grid, "strands.grid", WISP_TABLE_ENTITY, STRANDS_GRID )

typedef struct strands_state
{
#define STRANDS_MEMBER( member, name, table, columns ) wisp_component member;
    STRANDS_COMPONENTS( STRANDS_MEMBER )
#undef STRANDS_MEMBER
    int workspace;       // of the grid
    wisp_entity* rooted; // strands that are rooted in a surface, in the order they came
    int rooted_count, rooted_capacity;
} strands_state;

/// Columns of strands between steps or in a pass: what cooking and measuring need.
typedef struct strands_rows
{
    const wisp_strand_topology* topology;
    const float* rest;   // [row][3][16]
    const float* weight; // [row][16]
    const float* length; // [row][16]
} strands_rows;

static inline size_t strands_scalar( int row, int lane )
{
    return (size_t)row * WISP_LANES + (size_t)lane;
}

static inline size_t strands_vector( int row, int lane )
{
    return (size_t)row * 3 * WISP_LANES + (size_t)lane;
}

static inline size_t strands_quat( int row, int lane )
{
    return (size_t)row * 4 * WISP_LANES + (size_t)lane;
}

static inline wisp_vec3 strands_get( const float* rows, int row, int lane )
{
    const float* p = rows + strands_vector( row, lane );
    return ( wisp_vec3 ){ p[0], p[WISP_LANES], p[2 * WISP_LANES] };
}

static inline void strands_put( float* rows, int row, int lane, wisp_vec3 v )
{
    float* p = rows + strands_vector( row, lane );
    p[0] = v.x;
    p[WISP_LANES] = v.y;
    p[2 * WISP_LANES] = v.z;
}

static inline wisp_quat strands_get_quat( const float* rows, int row, int lane )
{
    const float* q = rows + strands_quat( row, lane );
    return ( wisp_quat ){ q[0], q[WISP_LANES], q[2 * WISP_LANES], q[3 * WISP_LANES] };
}

static inline void strands_put_quat( float* rows, int row, int lane, wisp_quat q )
{
    float* p = rows + strands_quat( row, lane );
    p[0] = q.x;
    p[WISP_LANES] = q.y;
    p[2 * WISP_LANES] = q.z;
    p[3 * WISP_LANES] = q.w;
}

/// a after b.
static inline wisp_quat strands_quat_multiply( wisp_quat a, wisp_quat b )
{
    return (
        wisp_quat ){ a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
                     a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z };
}

static inline wisp_quat strands_quat_back( wisp_quat q )
{
    return ( wisp_quat ){ -q.x, -q.y, -q.z, q.w };
}

static inline wisp_vec3 strands_sub( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline wisp_vec3 strands_add( wisp_vec3 a, wisp_vec3 b )
{
    return ( wisp_vec3 ){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline float strands_norm( wisp_vec3 v )
{
    return sqrtf( v.x * v.x + v.y * v.y + v.z * v.z );
}

/// The module is registered, the entity alive, with strands that have dynamics.
wisp_status strands_find( wisp_world* world, wisp_entity strands, strands_state** state );
strands_rows strands_rows_of( wisp_world* world, wisp_entity strands );
/// The same inside a pass.
strands_rows strands_rows_in( wisp_frame* frame, wisp_entity strands );

// ---- cooking (strands_cook.c) ----

/// Masses and lengths from a definition. @return vertices behind the root that are held
int strands_cook_masses( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* def );
/// Rest lengths of links over one and over two segments.
void strands_cook_links( wisp_world* world, wisp_entity strands, const strands_state* state );
/// Clamps and inverse lengths of rods.
void strands_cook_rods( wisp_world* world, wisp_entity strands, const strands_state* state );
/// m, the longest strand at rest.
float strands_longest( const strands_rows* rows );
/// A frame turned by the smallest rotation that takes its z axis along e; without a length it stays.
wisp_quat strands_carry_frame( wisp_quat q, wisp_vec3 e );
/// Frames of a group by the smallest rotations from the clamps outward.
void strands_lay_group( const wisp_strand_topology* topology, const float* position, const float* clamp,
                        const float* root, float* frame, int group );
/// INPUT: factors of M + (dt^2 + damping dt) K, and the stiffness that single precision bears.
bool strands_factor_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_factor( wisp_frame* frame, const wisp_span* span, void* user );

/// L_i, m: what bends at vertex i.
double strands_reach( const strands_rows* rows, int row, int i, int lane );
/// The sharpest turn |t_k - t_{k-1}| of the rest shape at vertex i and its neighbours, which bounds the stiffness of a curled rod.
double strands_sharpest_turn( const strands_rows* rows, int row, int i, int count, int lane );
/// Is the bound on a curl below the one of single precision?
bool strands_is_curl( double turn );

// ---- rest shapes (strands_balance.c) ----

/// INPUT: rest curvature and twist.
bool strands_balance_is_due( wisp_frame* frame, wisp_entity entity, void* user );
void strands_balance_rest( wisp_frame* frame, const wisp_span* span, void* user );

// ---- passes (strands_passes.c, strands_root.c, strands_grid.c, strands_figures.c) ----

wisp_pass_fn strands_move_head, strands_jump, strands_jump_frames, strands_root, strands_hold_pins;
wisp_pass_fn strands_anchor, strands_anchor_frames;
wisp_pass_fn strands_damp, strands_damp_anchored, strands_blow, strands_predict, strands_bend;
wisp_pass_fn strands_bend_curved, strands_bend_link, strands_link_rows, strands_follow, strands_stretch,
    strands_read_velocity;
wisp_pass_fn strands_guard, strands_mend_tension, strands_mend_frames;
wisp_pass_fn strands_mix;
wisp_pass_fn strands_take_quality, strands_hand_out_strain, strands_hand_out_speed;
/// All passes of strands with direct lengths, with or without links that bend them (strands_substeps.c).
wisp_joined_fn strands_substeps;

/// What passes hand to kernels, with the columns of the entity of a span.
wisp_strand_motion_job strands_motion_job( wisp_frame* frame, const wisp_span* span, const strands_state* state );
wisp_strand_link_job strands_bend_link_job( wisp_frame* frame, const wisp_span* span, const strands_state* state );
wisp_strand_stretch_job strands_stretch_job( wisp_frame* frame, const wisp_span* span, const strands_state* state );
/// Memory of a worker, so many floats a row of the longest group, which is the first one: groups stand in the order of falling
/// length. @return null without memory; the step fails with a sentence
float* strands_scratch( wisp_frame* frame, const wisp_span* span, int floats );
void strands_count_laid( wisp_frame* frame, int laid );

/// Take a strand along as a rigid body, with its velocities: from one place of the root to another.
void strands_turn( wisp_frame* frame, wisp_entity entity, int group, int lane, wisp_vec3 from, wisp_vec3 to,
                   wisp_quat turn );
void strands_turn_frames( wisp_frame* frame, wisp_entity entity, wisp_component curve, int group, int lane,
                          wisp_quat turn );
/// Pose of the head after so many substeps of this step.
wisp_rigid strands_head_pose( wisp_frame* frame, const strands_head* head, int substeps );
bool strands_is_faulty( wisp_frame* frame, wisp_entity entity, void* user );

/// Strands and surfaces that go: roots stay where they are.
void strands_entity_removed( void* state, wisp_world* world, wisp_entity entity );

size_t strands_grid_workspace_size( void );
void strands_grid_workspace_release( void* workspace, const wisp_allocator* allocator );
