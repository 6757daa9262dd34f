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

/// The components, a row each: X( member, "name", table, columns ).
#define STRANDS_COMPONENTS( X )                                                                                      \
    X( settings, "strands.settings", ENTITY, WISP_COLUMN( strands_settings, settings, 1 ) )                          \
    X( head, "strands.head", ENTITY, WISP_COLUMN( strands_head, head, 1 ) )                                          \
    X( damping, "strands.damping", ENTITY, WISP_COLUMN( float, rate, 1 ) ) /* 1/s */                                 \
    X( air, "strands.air", ENTITY, WISP_COLUMN( strands_air, air, 1 ) )                                              \
    X( pins, "strands.pins", ENTITY,                                                                                 \
       WISP_COLUMN( int32_t, count, 1 ) ) /* vertices behind the root that are pinned */                             \
    X( low, "strands.low", STRAND_ROW,                                                                               \
       WISP_COLUMN( float, low, 48 ) ) /* m, what does not fit the digits of the position */                         \
    X( direct, "strands.direct", ENTITY, WISP_COLUMN( strands_direct, direct, 1 ) )                                  \
    X( links, "strands.links", ENTITY, WISP_COLUMN( strands_link, link, 1 ) )                                        \
    X( bend_links, "strands.bend_links", ENTITY, WISP_COLUMN( strands_link, link, 1 ) )                              \
    X( tension, "strands.tension", STRAND_ROW,                                                                       \
       WISP_COLUMN( float, tension, 16 ) ) /* N, of the segment to the next row */                                   \
    X( stretch_link, "strands.stretch_link", STRAND_ROW,                                                             \
       WISP_COLUMN( float, rest, 16 ), /* m, to the next row; 0 or less: no link */                                  \
       WISP_COLUMN( float, lambda, 16 ) /* N s^2, of the substep; only kept with several iterations */ )             \
    X( bend_link, "strands.bend_link", STRAND_ROW,                                                                   \
       WISP_COLUMN( float, rest, 16 ), /* m, to the row after the next; 0 or less: no link */                        \
       WISP_COLUMN( float, lambda, 16 ) )                                                                            \
    X( rod, "strands.rod", STRAND_ROW,                                                                               \
       WISP_COLUMN( float, inverse_length, 16 ), /* 1/m, of the segment to the next row; 0 where there is none */    \
       WISP_COLUMN( float, stiffness, 16 ),      /* N m, EI / L_i, lowered to what a substep can solve */            \
       WISP_COLUMN( float, factor, 48 ),         /* 1/pivot, L(i, i-1), L(i, i-2) */                                 \
       WISP_COLUMN( float, max_tension, 16 ) /* N, bound of the tension at the start of a substep */ )               \
    X( history, "strands.history", STRAND_ROW, WISP_COLUMN( float, displacement, 48 ), /* wisp_strand_history */     \
       WISP_COLUMN( float, before, 48 ), WISP_COLUMN( float, step, 16 ),                                             \
       WISP_COLUMN( float, first_order_factor, 48 ) /* of rods, for substeps by Euler */ )                           \
    X( clamp, "strands.clamp", STRAND_GROUP,                                                                         \
       WISP_COLUMN( float, clamp,                                                                                    \
                    64 ), /* quaternion [4][16], x y z w: frame at rest, z along the direction of growth */          \
       WISP_COLUMN( float, factored, 1 ) /* s, the length of substep of the factors; 0: none */ )                    \
    X( curve, "strands.curve", STRAND_ROW,                                                                           \
       WISP_COLUMN( float, frame, 64 ),           /* quaternion [4][16] of the segment to the next row */            \
       WISP_COLUMN( float, rest, 48 ),            /* k_i in the middle frame of vertex i */                          \
       WISP_COLUMN( float, rest_twist, 32 ),      /* cosine and sine of half the rest twist */                       \
       WISP_COLUMN( float, twist_stiffness, 16 ), /* N m, GJ / L_i */                                                \
       WISP_COLUMN( float, rest_tension, 16 ) /* N, of the segment to the next row, in balance */ )                  \
    X( balance, "strands.balance", STRAND_GROUP,                                                                     \
       WISP_COLUMN( float, balanced, 1 ),  /* s, the length of substep of the rest curvature; 0: none */             \
       WISP_COLUMN( float, fraction, 16 ), /* fraction of gravity that a strand feels */                             \
       WISP_COLUMN( float, held, 16 ) /* fraction of that which its rest shape holds; below 1 it sags */ )           \
    X( good, "strands.last_valid", STRAND_ROW,                                                                       \
       WISP_COLUMN( float, position, 48 ), /* at the end of the last valid step */                                   \
       WISP_COLUMN( float, velocity, 48 ) )                                                                          \
    X( in_bounds, "strands.in_bounds", STRAND_GROUP,                                                                 \
       WISP_COLUMN( int32_t, in_bounds,                                                                              \
                    1 ) ) /* the group was found within bounds at the end of this step; 0 between steps */           \
    X( surface, "strands.surface", ENTITY,                                                                           \
       WISP_COLUMN( wisp_entity, surface, 1 ) ) /* null: it was removed, roots stay */                               \
    X( anchor, "strands.anchor", STRAND_GROUP, WISP_COLUMN( int32_t, triangle, 16 ), /* of the surface */            \
       WISP_COLUMN( float, weight, 48 ),                                             /* [3][16] barycentric */       \
       WISP_COLUMN( float, turn, 64 ),    /* [4][16] rotation of the root relative to the triangle */                \
       WISP_COLUMN( float, corner, 144 ), /* [3 corners][3][16] m, at the end of the step before */                  \
       WISP_COLUMN( float, jump,                                                                                     \
                    64 ) /* [4][16] rotation of a strand that was teleported in this step; zero: it was not */ )     \
    X( grid, "strands.grid", ENTITY, WISP_COLUMN( strands_grid, grid, 1 ) )                                          \
    X( section, "strands.section", ENTITY, WISP_COLUMN( strands_section, section, 1 ) )                              \
    X( closed, "strands.closed", ENTITY, WISP_COLUMN( strands_closed, closed, 1 ) )                                  \
    X( response, "strands.joint_response", STRAND_ROW,                                                               \
       WISP_COLUMN( float, response, 32 ) )                                  /* [2][16], wisp_strand_rod_args */     \
    X( tips, "strands.tips", STRAND_GROUP, WISP_COLUMN( int32_t, hold, 16 ), /* wisp_strand_tip */                   \
       WISP_COLUMN( wisp_transform, from, 16 ), /* at the start of the step, from rest, relative to the root */      \
       WISP_COLUMN( wisp_transform, to, 16 ),   /* at its end */                                                     \
       WISP_COLUMN( wisp_transform, target, 16 ),                                                                    \
       WISP_COLUMN( float, rest, 64 ),   /* quaternion [4][16]: frame at rest */                                     \
       WISP_COLUMN( float, weight, 16 ), /* 1/kg, of a tip that is released */                                       \
       WISP_COLUMN( float, reach, 16 ) /* m, length of the strand */ )                                               \
    X( tip_rows, "strands.tip_rows", STRAND_ROW,                                                                     \
       WISP_COLUMN( float, direction, 48 ) ) /* of a tip whose direction is held, in its row; 0 elsewhere */

typedef struct strands_state
{
    STRANDS_COMPONENTS( WISP_COMPONENT_MEMBER )
    int workspace; // of the grid
    int lent_rows; // workspace of substeps that run pass by pass
    const wisp_registry* registry;
} strands_state;
