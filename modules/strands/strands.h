/// Strands that move: inextensible by a direct solve, bending and twisting as elastic rods (Bergou et al. 2008, 2010), with
/// roots on a moving head or on a surface.
///
///     wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();  // human hair that starts without sagging
///     wisp_set_strand_dynamics( world, strands, &dynamics );
///     ...
///     wisp_move_strand_head( world, strands, pose );                          // before each step
///     wisp_world_step( world, dt );
#pragma once

#include "wisp/shapes.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_strands_module;

/// How segments keep their length.
typedef enum wisp_strand_stretch
{
    WISP_STRAND_STRETCH_DIRECT = 0, ///< the whole strand at once: one tridiagonal system per Newton pass, exact
    WISP_STRAND_STRETCH_LINKS = 1, ///< one sweep of distance constraints per iteration, pbd or xpbd: cheap and common
    WISP_STRAND_STRETCH_COUNT = 2,
} wisp_strand_stretch;

/// How strands resist bending.
typedef enum wisp_strand_bend
{
    WISP_STRAND_BEND_ROD = 0, ///< an elastic rod in SI units, implicit and direct: EI, GJ, rest curvature
    WISP_STRAND_BEND_LINKS =
        1, ///< distances between vertices two apart, pbd or xpbd: cheap, straight or as the rest shape
    WISP_STRAND_BEND_NONE = 2, ///< a chain
    WISP_STRAND_BEND_COUNT = 3,
} wisp_strand_bend;

/// Shape of a rod without load.
typedef enum wisp_strand_rest
{
    WISP_STRAND_REST_SAG_FREE =
        0, ///< computed so that the given shape is in equilibrium under gravity and does not sag at the
           ///< start. If substeps are too long for that, gravity is scaled down
           ///< (WISP_COUNT_GRAVITY_SCALED)
    WISP_STRAND_REST_SHAPE = 1,    ///< the given shape itself
    WISP_STRAND_REST_STRAIGHT = 2, ///< straight, without twist
    WISP_STRAND_REST_COUNT = 3,
} wisp_strand_rest;

/// How strands move. Fill from wisp_default_strand_dynamics_def(). Copied; need not outlive the call.
typedef struct wisp_strand_dynamics_def
{
    uint32_t size;               ///< bytes; set by wisp_default_strand_dynamics_def()
    wisp_strand_stretch stretch; ///< default direct
    int stretch_passes;          ///< direct: most Newton passes per iteration, 1 .. 16, default 8; they end early
    float
        stretch_tolerance; ///< direct: of |l/l0 - 1|, 1e-6 .. 1, default 1e-2. A strand outside of it after the last pass
                           ///< is reset to rest lengths from the root and counted (WISP_COUNT_STRAND_RESET)
    /// Default Euler. BDF2 needs direct lengths. A strand makes a substep by Euler where BDF2 has nothing to look back on: the
    /// first one, one in which it is pushed, reset or turned too fast, the one after that, the one after a jump of its
    /// root or another length of substep. All but the first are counted (WISP_COUNT_FIRST_ORDER).
    wisp_integrator integrator;

    wisp_strand_bend bending; ///< default rod
    float bend_rigidity;      ///< rod: EI, N m^2, 0 .. 1e12, default 8e-9 (a hair of 80 um)
    float twist_rigidity;     ///< rod: GJ, N m^2, 0 .. 1e12, default 6e-9; has an effect with rest curvature, an
                              ///< elliptic section, or a tip whose direction is held
    float
        bend_damping; ///< rod: s, ratio of the force against bending rate to that against bending, 0 .. 1e3, default 0
    wisp_strand_rest rest; ///< rod; default sag-free
    bool clamped;          ///< rod: the root holds its direction as well as its position; default true

    wisp_solver solver;       ///< of links; default xpbd
    float stretch_compliance; ///< links, xpbd: m/N, >= 0, default 0
    float bend_compliance;    ///< links, xpbd: m/N, >= 0, default 0
    float stretch_stiffness;  ///< links, pbd: 0 .. 1, default 1
    float bend_stiffness;     ///< links, pbd: 0 .. 1, default 0.2

    float
        line_density; ///< kg/m, > 0, default 6.5e-6 (a hair of 80 um). A vertex has half the mass of each of its segments
    float vertex_mass;          ///< kg; above 0 it is the mass of every vertex; default 0
    const float* vertex_masses; ///< [vertex_count] kg, > 0, the user's order, in place of both; default null
    const int32_t* pins;        ///< [pin_count] vertices held in addition to the roots, in the user's order
    int pin_count;

    wisp_vec3 gravity;      ///< m/s^2, default (0, -9.81, 0)
    float damping;          ///< 1/s, >= 0: decay rate of motion relative to the head; default 3: at rest within 4 s
    wisp_vec3 wind;         ///< m/s, velocity of the air, default 0
    float air_density;      ///< kg/m^3, default 1.204
    float drag_coefficient; ///< coefficient C_d across a strand, >= 0, default 0: no air
    float diameter;         ///< m, > 0, of a strand in the air, default 8e-5
    float teleport;         ///< times the longest strand, > 0: a head that moves farther in a step moves its strands
                            ///< without giving them velocity; default 5
    float
        edgewise_rigidity; ///< rod: EI of an elliptic section or a ribbon against bending in the plane of its width,
                           ///< N m^2, 1 .. 1e5 times bend_rigidity, which is that against bending across its flat
                           ///< side. Default 0: circular
    wisp_vec3 flat_normal; ///< rod: direction across the flat side at the root; what it has along the strand is left
                           ///< out. Default 0: any direction. With edgewise_rigidity only
    float natural_twist;   ///< rod: rad/m, -1e5 .. 1e5, rotation of the section along the strand without load, beyond
                           ///< that of frames without twist; default 0. With edgewise_rigidity only
    bool free_roots;       ///< roots are free, in place and direction; default false. Without sag-free rods
    /// Every strand is a loop without ends, that moves freely: its last vertex lies on its first and is the same one, and it
    /// bends and twists there as anywhere else. Default false. With direct lengths, by Euler, without bend links, sag-free
    /// rods and sections. Hold vertices by `pins`. The mass of the joint is that of the first vertex.
    bool closed;
    float closing_twist; ///< rod: rad, -1e4 .. 1e4, twist of a closed strand: how far one end was turned against the
                         ///< other before they were joined; default 0. With `closed` only
} wisp_strand_dynamics_def;

WISP_DEFINITION( strand_dynamics_def );

/// Make strands move, or replace their definition. They start at rest in the shape they were added with; roots (the first vertex of
/// each strand) are pinned. Strands of one vertex only follow the head.
/// @return WISP_BAD_INPUT a value is out of range, a mass is not above 0, a pin is out of range, BDF2 has other than
///         direct lengths, or a strand is to be closed and is no loop of at least four vertices (the message names it);
///         WISP_CONFLICT the module is not registered, the entity has no strands, or roots are to be free that are on a
///         surface or whose tips are held; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_strand_dynamics( wisp_world* world, wisp_entity strands,
                                               const wisp_strand_dynamics_def* def );

/// Change only the wind; cheap enough for every step. The first call gives strands without drag a coefficient of 1.
/// @param wind m/s, at most 1e5
/// @return WISP_BAD_INPUT it is not finite or too large; WISP_CONFLICT the strands have no dynamics; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_strand_wind( wisp_world* world, wisp_entity strands, wisp_vec3 wind );

/// Change only gravity. A sag-free rest shape stays that of the gravity in the definition, so strands sag under more and rise under
/// less. @param gravity m/s^2, at most 1e6
/// @return WISP_BAD_INPUT it is not finite or too large; WISP_CONFLICT the strands have no dynamics
WISP_API wisp_status wisp_set_strand_gravity( wisp_world* world, wisp_entity strands, wisp_vec3 gravity );

/// Move the head, and the roots with it, to a pose that it reaches at the end of the next step, along a straight line and the
/// shorter rotation. The pose is relative to the shape that the strands were added with; a head starts at the identity.
/// Without another call the head rests there.
/// @return WISP_BAD_INPUT the pose is not finite or beyond 1e6 m; WISP_CONFLICT the strands have no dynamics
WISP_API wisp_status wisp_move_strand_head( wisp_world* world, wisp_entity strands, wisp_transform pose );

/// Attach the root of every strand to the nearest triangle of a surface, at the present positions of both. The root then moves
/// and rotates with its triangle. Replaces the head.
/// @return WISP_CONFLICT the strands have no dynamics, their roots are free, or the other entity is no surface with triangles; WISP_NO_MEMORY
/// @note If the surface is removed, the roots stay where they are.
WISP_API wisp_status wisp_root_strands( wisp_world* world, wisp_entity strands, wisp_entity surface );

/// How the tip of a strand, its last vertex, is held.
typedef enum wisp_strand_tip
{
    WISP_STRAND_TIP_FREE = 0,
    WISP_STRAND_TIP_PINNED = 1,  ///< its position
    WISP_STRAND_TIP_GUIDED = 2,  ///< its direction and twist; it slides freely
    WISP_STRAND_TIP_CLAMPED = 3, ///< both
    WISP_STRAND_TIP_COUNT = 4,
} wisp_strand_tip;

/// Hold or release the tip of a strand, from the next step on. A tip is held where it is at present, relative to the motion
/// of its root. A strand whose last vertex lies on its first is a loop: its tip is clamped to the frame of its root, so that
/// the joint bends and twists as any other vertex. As the root is held, the lengths of a loop are the same tridiagonal
/// system as those of a strand between two ends. Holds stay if the dynamics are replaced.
/// @param strand in the user's order
/// @return WISP_BAD_INPUT there is no such strand, it has one vertex, or the hold is unknown; WISP_CONFLICT the strands have no
///         dynamics, their roots are free, or a direction is to be held and they do not bend as rods; WISP_NO_MEMORY
/// @note A tip that is held farther from its root than the strand is long stretches the strand, which is counted once per
///       step (WISP_COUNT_STRETCHED).
WISP_API wisp_status wisp_hold_strand_tip( wisp_world* world, wisp_entity strands, int strand, wisp_strand_tip hold );

/// Move the tip of a strand to a pose that it reaches at the end of the next step, along a straight line and the shorter
/// rotation. Less than half a turn per step adds up to any number of turns.
/// @param pose from the tip at rest, relative to the motion of its root (with a head: to the head): displacement in m, and
///        rotation about the tip itself
/// @return WISP_BAD_INPUT there is no such strand, or the pose is not finite or beyond 1e6 m; WISP_CONFLICT the strands have
///         no dynamics, or the tip is free
WISP_API wisp_status wisp_move_strand_tip( wisp_world* world, wisp_entity strands, int strand, wisp_transform pose );

/// Interaction between strands: velocity and density on a grid (Petrovic, Henne and Anderson 2005), once per step. Fill from
/// wisp_default_strand_grid_def(). Copied.
typedef struct wisp_strand_grid_def
{
    uint32_t size;   ///< bytes; set by wisp_default_strand_grid_def()
    bool enabled;    ///< default true
    float cell_size; ///< m, > 0: edge of a cell; default 0: twice the mean segment
    float
        friction; ///< 0 .. 1: fraction of the difference to the mean velocity of the cells around that is removed in a step of
                  ///< 1/60 s, default 0.1
    float
        repulsion; ///< m/s^2, >= 0: acceleration down the gradient of density where it is twice the density at rest,
                   ///< default 0
} wisp_strand_grid_def;

WISP_DEFINITION( strand_grid_def );
/// @return WISP_BAD_INPUT a value is out of range; WISP_CONFLICT the strands have no dynamics; WISP_NO_MEMORY
WISP_API wisp_status wisp_set_strand_grid( wisp_world* world, wisp_entity strands, const wisp_strand_grid_def* def );

/// Read the tension of every segment at the end of the last substep.
/// @param tensions [vertex_count] N, the user's order, positive where it pulls; 0 for the last vertex of a strand
/// @return WISP_CONFLICT the strands do not stretch by the direct solve
WISP_API wisp_status wisp_read_strand_tension( wisp_world* world, wisp_entity strands, float* tensions );

/// How far rods hold their shape under gravity. A strand whose rest shape would turn by more than a quarter against its load is
/// too soft for it and sags. The turn grows with the cube of the length and falls with the rigidity.
typedef struct wisp_strand_hold
{
    int32_t sagging;     ///< strands that are too soft; 0 before the first step, and with another rest than sag-free
    float max_length;    ///< m, at which the softest strand would hold its shape; its own length if it does
    float bend_rigidity; ///< N m^2, with which the softest strand would hold its shape
} wisp_strand_hold;

/// Read it as of the last step. @return WISP_CONFLICT the strands have no dynamics, or do not bend as rods
WISP_API wisp_status wisp_read_strand_hold( wisp_world* world, wisp_entity strands, wisp_strand_hold* out );

WISP_END_C
