/// Strands that move: inextensible by a direct solve, bending and twisting as elastic rods, rooted in a head that moves.
#pragma once

#include "wisp/shapes.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_strands_module;

/// How segments keep their length.
typedef enum wisp_strand_stretch
{
    WISP_STRAND_STRETCH_DIRECT, ///< the whole strand at once: a tridiagonal system a Newton pass, exact
    WISP_STRAND_STRETCH_LINKS,  ///< one sweep of distances an iteration, pbd or xpbd: the cheap and usual choice
    WISP_STRAND_STRETCH_FOLLOW, ///< follow the leader, from the root: exact lengths, wrong momentum (Mueller et al. 2012)
    WISP_STRAND_STRETCH_COUNT,
} wisp_strand_stretch;

/// How strands resist bending.
typedef enum wisp_strand_bend
{
    WISP_STRAND_BEND_ROD,   ///< an elastic rod in SI units, implicit and direct: EI, GJ, rest curvature
    WISP_STRAND_BEND_LINKS, ///< distances between vertices two apart, pbd or xpbd: cheap, straight or as the rest shape
    WISP_STRAND_BEND_NONE, ///< a chain
    WISP_STRAND_BEND_COUNT,
} wisp_strand_bend;

/// Which shape a rod has where nothing acts on it.
typedef enum wisp_strand_rest
{
    WISP_STRAND_REST_SAG_FREE, ///< such that the given shape is in balance under gravity: nothing sags at the start. What
    ///< substeps are too long to hold feels a share of its weight (WISP_COUNT_GRAVITY_SCALED)
    WISP_STRAND_REST_SHAPE,    ///< the given shape itself
    WISP_STRAND_REST_STRAIGHT, ///< straight, without twist
    WISP_STRAND_REST_COUNT,
} wisp_strand_rest;

/// How strands move. Fill from wisp_default_strand_dynamics_def(). Copied; may die after the call.
typedef struct wisp_strand_dynamics_def
{
    wisp_strand_stretch stretch; ///< default direct
    int stretch_passes;          ///< direct: Newton passes an iteration at most, 1 .. 16, default 8: they end early
    float
        stretch_tolerance; ///< direct: of |l/l0 - 1|; a strand that is not within it after the last pass is laid out from
                           ///< the root and counted (WISP_COUNT_STRAND_RESET), 1e-6 .. 1, default 1e-2
    float leader_correction; ///< follow: share of its momentum that the leader gets back, 0 .. 1, default 0.9

    wisp_strand_bend bending; ///< default rod
    float bend_rigidity;      ///< rod: EI, N m^2, 0 .. 1e12, default 8e-9 (a hair of 80 um)
    float twist_rigidity;     ///< rod: GJ, N m^2, 0 .. 1e12, default 6e-9; matters with a rest curvature only
    float
        bend_damping; ///< rod: s, force against the bending's rate over force against the bending, 0 .. 1e3, default 0
    wisp_strand_rest rest; ///< rod; default balanced
    bool clamped;          ///< rod: the root holds the direction of growth, not only the place; default true

    wisp_solver solver;       ///< of links; default xpbd
    float stretch_compliance; ///< links, xpbd: m/N, >= 0, default 0
    float bend_compliance;    ///< links, xpbd: m/N, >= 0, default 0
    float stretch_stiffness;  ///< links, pbd: 0 .. 1, default 1
    float bend_stiffness;     ///< links, pbd: 0 .. 1, default 0.2

    float
        line_density; ///< kg/m, > 0, default 6.5e-6 (a hair of 80 um). A vertex has half the mass of each of its segments
    float vertex_mass;          ///< kg; above 0 every vertex weighs so much instead; default 0
    const float* vertex_masses; ///< [vertex_count] kg, > 0, the user's order, instead of both; default null
    const int32_t* pins; ///< [pin_count] vertices held beside the roots, the user's numbers in the strands' points
    int pin_count;

    wisp_vec3 gravity;      ///< m/s^2, default (0, -9.81, 0)
    float damping;          ///< 1/s, >= 0: how fast motion against the head dies; default 0
    wisp_vec3 wind;         ///< m/s, velocity of the air, default 0
    float air_density;      ///< kg/m^3, default 1.204
    float drag_coefficient; ///< coefficient C_d across a strand, >= 0, default 0: no air
    float diameter;         ///< m, > 0, of a strand in the air, default 8e-5
    float teleport; ///< times the longest strand, > 0: a head that goes farther in a step takes its strands along
                    ///< without giving them a velocity; default 5
    uint32_t cookie;
} wisp_strand_dynamics_def;

WISP_API wisp_strand_dynamics_def wisp_default_strand_dynamics_def( void );

/// Let strands move, or change how they do. They start at rest in the shape they were added with; roots (the first vertex of
/// each strand) are pinned. Strands of one vertex only follow the head.
/// @return WISP_BAD_INPUT a value is out of range, a mass is not above 0 or a pin is out of range (the message names it);
///         WISP_CONFLICT the module is not registered, or the entity has no strands; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_strand_dynamics( wisp_world* world, wisp_entity strands,
                                               const wisp_strand_dynamics_def* def );

/// Change the wind alone; cheap enough for every step. @param wind m/s
/// @return WISP_CONFLICT the strands have no air: give them drag first
WISP_API wisp_status wisp_set_strand_wind( wisp_world* world, wisp_entity strands, wisp_vec3 wind );

/// Carry the head, and the roots with it, so that it is at the pose at the end of the next step: in a straight line, turning
/// the shorter way. The pose takes the shape that the strands were added with to where it is held; a head starts at the
/// origin, not turned. Without another call it stands still from then on.
/// @return WISP_BAD_INPUT the pose is not finite or beyond 1e6 m; WISP_CONFLICT the strands have no dynamics
WISP_API wisp_status wisp_move_strand_head( wisp_world* world, wisp_entity strands, wisp_transform pose );

/// Root every strand in the nearest triangle of a surface (triangle and barycentric weights, taken where both are now), whose
/// motion then carries it: the root stays on the triangle and turns with it. Takes the place of the head.
/// @return WISP_CONFLICT the strands have no dynamics, or the other entity is no surface with triangles; WISP_NO_MEMORY
/// @note When the surface is removed the roots stay where they are.
WISP_API wisp_status wisp_root_strands( wisp_world* world, wisp_entity strands, wisp_entity surface );

/// How strands act on each other: velocity and density on a grid (Petrovic, Henne and Anderson 2005), once a step. Fill from
/// wisp_default_strand_grid_def(). Copied.
typedef struct wisp_strand_grid_def
{
    bool enabled;    ///< default true
    float cell_size; ///< m, > 0: edge of a cell; default 0: twice the mean segment
    float
        friction; ///< 0 .. 1: share of the difference to the mean velocity of the cells around taken away in a step of
                  ///< 1/60 s, default 0.1
    float
        repulsion; ///< m/s^2, >= 0: acceleration down the gradient of density where it is twice the density at rest,
                   ///< default 0
    uint32_t cookie;
} wisp_strand_grid_def;

WISP_API wisp_strand_grid_def wisp_default_strand_grid_def( void );
/// @return WISP_BAD_INPUT a value is out of range; WISP_CONFLICT the strands have no dynamics; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_strand_grid( wisp_world* world, wisp_entity strands, const wisp_strand_grid_def* def );

/// Tension of every segment at the end of the last substep, N, positive where it pulls; the last vertex of a strand has 0.
/// @param tensions [vertex_count] the user's order
/// @return WISP_CONFLICT the strands do not stretch by the direct solve
WISP_API wisp_status wisp_read_strand_tension( wisp_world* world, wisp_entity strands, float* tensions );

WISP_END_C
