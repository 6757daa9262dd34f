// Components of the module, each column listed once, and its state.
#pragma once

#include "strands.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

/// Bound of each coordinate of positions, m, and velocities, m/s, the same as that of particles.
#define STRANDS_BOUND 1e6f

/// The checked definition. The presence of the other components decides which passes there are.
typedef struct strands_settings
{
    wisp_vec3 gravity;    // m/s^2
    float bend_rigidity;  // N m^2
    float twist_rigidity; // N m^2
    float bend_damping;   // s
    float teleport;       // m, a root that moves farther in a step teleports its strands
    int32_t rest;         // wisp_strand_rest
    int32_t clamped;
    int32_t is_free; // roots are
} strands_settings;

typedef struct strands_direct
{
    int32_t passes;
    float tolerance;
    int32_t has_rod; // a rod has applied tension before
} strands_direct;

/// Material of links: compliance in m/N where xpbd is not 0, else stiffness.
typedef struct strands_link
{
    int32_t xpbd;
    float stiffness, compliance;
} strands_link;

typedef struct strands_section
{
    float flatness;   // sqrt( 1 - EI / EI_edgewise ); settings have EI_edgewise
    float twist;      // rad/m, natural
    wisp_vec3 normal; // of the flat side at the root, at rest; 0: any
} strands_section;

/// Strands that are closed.
typedef struct strands_closed
{
    float twist; // rad
} strands_closed;

/// How the head takes its strands along as rigid bodies in a step.
enum
{
    STRANDS_JUMPED = 1,
    STRANDS_CARRIED = 2, ///< they are not solved
    STRANDS_STOPPED = 3, ///< the same, and the head has stopped
};

typedef struct strands_head
{
    wisp_transform from, to; // at the start and at the end of the step
    wisp_transform target;   // at the end of the next one
    int32_t jumped;          // 0, or how strands go along: the pose is then `to` from the first substep on
    int32_t is_still;        // it does not move in this step, so roots are in place
} strands_head;

typedef struct strands_air
{
    wisp_vec3 wind; // m/s
    float drag;     // kg/m^2: 1/2 density C_d diameter
} strands_air;

typedef struct strands_grid
{
    float cell;         // m
    float friction;     // per 1/60 s
    float repulsion;    // m/s^2
    float rest_density; // kg/m^3, mean over the mass at rest; 0: not computed yet
} strands_grid;

#define STRANDS_SETTINGS( X ) X( strands_settings, settings, 1 )
#define STRANDS_HEAD( X ) X( strands_head, head, 1 )
#define STRANDS_DAMPING( X ) X( float, rate, 1 ) /* 1/s */
#define STRANDS_AIR( X ) X( strands_air, air, 1 )
#define STRANDS_PINS( X ) X( int32_t, count, 1 ) /* vertices behind the root that are pinned */
#define STRANDS_LOW( X ) X( float, low, 48 )     /* m, what does not fit the digits of the position */
#define STRANDS_DIRECT( X ) X( strands_direct, direct, 1 )
#define STRANDS_LINKS( X ) X( strands_link, link, 1 )
#define STRANDS_BEND_LINKS( X ) X( strands_link, link, 1 )
#define STRANDS_TENSION( X ) X( float, tension, 16 ) /* N, of the segment to the next row */
#define STRANDS_STRETCH_LINK( X )                                                                                    \
    X( float, rest, 16 )   /* m, to the next row; 0 or less: no link */                                              \
    X( float, lambda, 16 ) /* N s^2, of the substep; only kept with several iterations */
#define STRANDS_BEND_LINK( X )                                                                                       \
    X( float, rest, 16 ) /* m, to the row after the next; 0 or less: no link */                                      \
    X( float, lambda, 16 )
#define STRANDS_HISTORY( X )                                                                                         \
    X( float, displacement, 48 ) /* wisp_strand_history */                                                           \
    X( float, before, 48 )                                                                                           \
    X( float, step, 16 )                                                                                             \
    X( float, first_order_factor, 48 ) /* of rods, for substeps by Euler */
#define STRANDS_ROD( X )                                                                                             \
    X( float, inverse_length, 16 ) /* 1/m, of the segment to the next row; 0 where there is none */                  \
    X( float, stiffness, 16 )      /* N m, EI / L_i, lowered to what a substep can solve */                          \
    X( float, factor, 48 )         /* 1/pivot, L(i, i-1), L(i, i-2) */                                               \
    X( float, max_tension, 16 )    /* N, bound of the tension at the start of a substep */
#define STRANDS_CLAMP( X )                                                                                           \
    X( float, clamp, 64 )   /* quaternion [4][16], x y z w: frame at rest, z along the direction of growth */        \
    X( float, factored, 1 ) /* s, the length of substep of the factors; 0: none */
#define STRANDS_CURVE( X )                                                                                           \
    X( float, frame, 64 )           /* quaternion [4][16] of the segment to the next row */                          \
    X( float, rest, 48 )            /* k_i in the middle frame of vertex i */                                        \
    X( float, rest_twist, 32 )      /* cosine and sine of half the rest twist */                                     \
    X( float, twist_stiffness, 16 ) /* N m, GJ / L_i */                                                              \
    X( float, rest_tension, 16 )    /* N, of the segment to the next row, in balance */
#define STRANDS_BALANCE( X )                                                                                         \
    X( float, balanced, 1 )  /* s, the length of substep of the rest curvature; 0: none */                           \
    X( float, fraction, 16 ) /* fraction of gravity that a strand feels */                                           \
    X( float, held, 16 )     /* fraction of that which its rest shape holds; below 1 it sags */
#define STRANDS_GOOD( X )                                                                                            \
    X( float, position, 48 ) /* at the end of the last valid step */                                                 \
    X( float, velocity, 48 )
#define STRANDS_IN_BOUNDS( X )                                                                                       \
    X( int32_t, in_bounds, 1 ) /* the group was found within bounds at the end of this step; 0 between steps */
#define STRANDS_SURFACE( X ) X( wisp_entity, surface, 1 ) /* null: it was removed, roots stay */
#define STRANDS_ANCHOR( X )                                                                                          \
    X( int32_t, slot, 48 )  /* [3][16] corners of the triangle, as slots of the surface */                           \
    X( float, weight, 48 )  /* [3][16] barycentric */                                                                \
    X( float, turn, 64 )    /* [4][16] rotation of the root relative to the triangle */                              \
    X( float, corner, 144 ) /* [3 corners][3][16] m, at the end of the step before */                                \
    X( float, jump, 64 )    /* [4][16] rotation of a strand that was teleported in this step; zero: it was not */
#define STRANDS_GRID( X ) X( strands_grid, grid, 1 )
#define STRANDS_SECTION( X ) X( strands_section, section, 1 )
#define STRANDS_TIPS( X )                                                                                            \
    X( int32_t, hold, 16 )        /* wisp_strand_tip */                                                              \
    X( wisp_transform, from, 16 ) /* at the start of the step, from rest, relative to the root */                    \
    X( wisp_transform, to, 16 )   /* at its end */                                                                   \
    X( wisp_transform, target, 16 )                                                                                  \
    X( float, rest, 64 )   /* quaternion [4][16]: frame at rest */                                                   \
    X( float, weight, 16 ) /* 1/kg, of a tip that is released */                                                     \
    X( float, reach, 16 )  /* m, length of the strand */
#define STRANDS_CLOSED( X ) X( strands_closed, closed, 1 )
#define STRANDS_RESPONSE( X ) X( float, response, 32 ) /* [2][16], wisp_strand_rod_args */
#define STRANDS_TIP_ROWS( X )                                                                                        \
    X( float, direction, 48 ) /* of a tip whose direction is held, in its row; 0 elsewhere */

/// One line a component: X( member, "name", table, column list )
#define STRANDS_COMPONENTS( X )                                                                                      \
    X( settings, "strands.settings", WISP_TABLE_ENTITY, STRANDS_SETTINGS )                                           \
    X( head, "strands.head", WISP_TABLE_ENTITY, STRANDS_HEAD )                                                       \
    X( damping, "strands.damping", WISP_TABLE_ENTITY, STRANDS_DAMPING )                                              \
    X( air, "strands.air", WISP_TABLE_ENTITY, STRANDS_AIR )                                                          \
    X( pins, "strands.pins", WISP_TABLE_ENTITY, STRANDS_PINS )                                                       \
    X( low, "strands.low", WISP_TABLE_STRAND_ROW, STRANDS_LOW )                                                      \
    X( direct, "strands.direct", WISP_TABLE_ENTITY, STRANDS_DIRECT )                                                 \
    X( links, "strands.links", WISP_TABLE_ENTITY, STRANDS_LINKS )                                                    \
    X( bend_links, "strands.bend_links", WISP_TABLE_ENTITY, STRANDS_BEND_LINKS )                                     \
    X( tension, "strands.tension", WISP_TABLE_STRAND_ROW, STRANDS_TENSION )                                          \
    X( stretch_link, "strands.stretch_link", WISP_TABLE_STRAND_ROW, STRANDS_STRETCH_LINK )                           \
    X( bend_link, "strands.bend_link", WISP_TABLE_STRAND_ROW, STRANDS_BEND_LINK )                                    \
    X( rod, "strands.rod", WISP_TABLE_STRAND_ROW, STRANDS_ROD )                                                      \
    X( history, "strands.history", WISP_TABLE_STRAND_ROW, STRANDS_HISTORY )                                          \
    X( clamp, "strands.clamp", WISP_TABLE_STRAND_GROUP, STRANDS_CLAMP )                                              \
    X( curve, "strands.curve", WISP_TABLE_STRAND_ROW, STRANDS_CURVE )                                                \
    X( balance, "strands.balance", WISP_TABLE_STRAND_GROUP, STRANDS_BALANCE )                                        \
    X( good, "strands.last_valid", WISP_TABLE_STRAND_ROW, STRANDS_GOOD )                                             \
    X( in_bounds, "strands.in_bounds", WISP_TABLE_STRAND_GROUP, STRANDS_IN_BOUNDS )                                  \
    X( surface, "strands.surface", WISP_TABLE_ENTITY, STRANDS_SURFACE )                                              \
    X( anchor, "strands.anchor", WISP_TABLE_STRAND_GROUP, STRANDS_ANCHOR )                                           \
    X( grid, "strands.grid", WISP_TABLE_ENTITY, STRANDS_GRID )                                                       \
    X( section, "strands.section", WISP_TABLE_ENTITY, STRANDS_SECTION )                                              \
    X( closed, "strands.closed", WISP_TABLE_ENTITY, STRANDS_CLOSED )                                                 \
    X( response, "strands.joint_response", WISP_TABLE_STRAND_ROW, STRANDS_RESPONSE )                                 \
    X( tips, "strands.tips", WISP_TABLE_STRAND_GROUP, STRANDS_TIPS )                                                 \
    X( tip_rows, "strands.tip_rows", WISP_TABLE_STRAND_ROW, STRANDS_TIP_ROWS )

typedef struct strands_state
{
#define STRANDS_MEMBER( member, name, table, columns ) wisp_component member;
    STRANDS_COMPONENTS( STRANDS_MEMBER )
#undef STRANDS_MEMBER
    int workspace;       // of the grid
    int lent_rows;       // workspace of substeps that run pass by pass
    wisp_entity* rooted; // strands that are rooted in a surface, in the order of calls
    int rooted_count, rooted_capacity;
} strands_state;
