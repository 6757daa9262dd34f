/// The vocabulary that modules share. A component that only one module touches lives in that module.
#pragma once

#include "wisp/wisp.h"

/// So many bodies a particle can touch at once in particle.contacts.
#define WISP_MAX_PARTICLE_CONTACTS 2
/// So many half spaces a particle can be held in at once in particle.half_spaces.
#define WISP_MAX_HALF_SPACES 3

/// One line a component: X( enumerator, "name", table, column list )
#define WISP_SHARED_COMPONENTS( X )                                                                                  \
    X( STRAND_REST, "strand.rest", WISP_TABLE_STRAND_ROW )                                                           \
    X( STRAND_POSITION, "strand.position", WISP_TABLE_STRAND_ROW )                                                   \
    X( STRAND_STIFFNESS, "strand.stiffness", WISP_TABLE_STRAND_GROUP )                                               \
    X( STRAND_VELOCITY, "strand.velocity", WISP_TABLE_STRAND_ROW )                                                   \
    X( STRAND_PREVIOUS, "strand.previous", WISP_TABLE_STRAND_ROW )                                                   \
    X( STRAND_INVERSE_MASS, "strand.inverse_mass", WISP_TABLE_STRAND_ROW )                                           \
    X( STRAND_LENGTH, "strand.length", WISP_TABLE_STRAND_ROW )                                                       \
    X( STRAND_ROOT, "strand.root", WISP_TABLE_STRAND_GROUP )                                                         \
    X( STRAND_POSED, "strand.posed", WISP_TABLE_STRAND_ROW )                                                         \
    X( STRAND_POINTS, "strand.points", WISP_TABLE_POINT )                                                            \
    X( POINT_WIDTH, "point.width", WISP_TABLE_POINT )                                                                \
    X( POINT_COLOUR, "point.colour", WISP_TABLE_POINT )                                                              \
    X( PARTICLE_POSITION, "particle.position", WISP_TABLE_PARTICLE )                                                 \
    X( PARTICLE_VELOCITY, "particle.velocity", WISP_TABLE_PARTICLE )                                                 \
    X( PARTICLE_PREVIOUS, "particle.previous", WISP_TABLE_PARTICLE )                                                 \
    X( PARTICLE_TARGET, "particle.target", WISP_TABLE_PARTICLE )                                                     \
    X( LINK_OWN, "link.own", WISP_TABLE_LINK )                                                                       \
    X( PARTICLE_MASS, "particle.mass", WISP_TABLE_ENTITY )                                                           \
    X( PARTICLE_GRAVITY, "particle.gravity", WISP_TABLE_ENTITY )                                                     \
    X( PARTICLE_DAMPING, "particle.damping", WISP_TABLE_ENTITY )                                                     \
    X( PARTICLE_EXTERNAL_SOLVER, "particle.external_solver", WISP_TABLE_ENTITY )                                     \
    X( PARTICLE_CONTACTS, "particle.contacts", WISP_TABLE_PARTICLE )                                                 \
    X( PARTICLE_HALF_SPACES, "particle.half_spaces", WISP_TABLE_PARTICLE )                                           \
    X( LINK_STIFFNESS, "link.stiffness", WISP_TABLE_ENTITY )                                                         \
    X( LINK_COMPLIANCE, "link.compliance", WISP_TABLE_ENTITY )                                                       \
    X( LINK_LAMBDA, "link.lambda", WISP_TABLE_LINK )                                                                 \
    X( LINK_LIMIT, "link.limit", WISP_TABLE_ENTITY )                                                                 \
    X( LINK_FOLDS, "link.folds", WISP_TABLE_ENTITY )                                                                 \
    X( HINGE_REST, "hinge.rest", WISP_TABLE_HINGE )                                                                  \
    X( HINGE_COTANGENT, "hinge.cotangent", WISP_TABLE_HINGE )                                                        \
    X( HINGE_STIFFNESS, "hinge.stiffness", WISP_TABLE_HINGE )                                                        \
    X( HINGE_FOLDS, "hinge.folds", WISP_TABLE_ENTITY )                                                               \
    X( SURFACE_TETHERS, "surface.tethers", WISP_TABLE_ENTITY )                                                       \
    X( SURFACE_LEVELS, "surface.levels", WISP_TABLE_ENTITY )                                                         \
    X( LEVEL_MASS, "level.mass", WISP_TABLE_LEVEL_ROW )                                                              \
    X( LEVEL_COMPLIANCE, "level.compliance", WISP_TABLE_LEVEL_LINK )                                                 \
    X( LEVEL_MOTION, "level.motion", WISP_TABLE_COARSEST_ROW )                                                       \
    X( SURFACE_POINTS, "surface.points", WISP_TABLE_POINT )                                                          \
    X( SURFACE_NORMALS, "surface.normals", WISP_TABLE_POINT )                                                        \
    X( POINT_STRAIN, "point.strain", WISP_TABLE_POINT )                                                              \
    X( POINT_SPEED, "point.speed", WISP_TABLE_POINT )                                                                \
    X( MOTION_STATS, "entity.motion_stats", WISP_TABLE_ENTITY )                                                      \
    X( PARTICLE_FRAME, "particle.frame", WISP_TABLE_ENTITY )                                                         \
    X( PARTICLE_UNCARRIED, "particle.uncarried", WISP_TABLE_PARTICLE )                                               \
    X( PARTICLE_MAX_SPEED, "particle.max_speed", WISP_TABLE_ENTITY )                                                 \
    X( MAP_AREA_DENSITY, "map.area_density", WISP_TABLE_PARTICLE )                                                   \
    X( MAP_STRETCH_COMPLIANCE, "map.stretch_compliance", WISP_TABLE_EDGE )                                           \
    X( MAP_STRETCH_STIFFNESS, "map.stretch_stiffness", WISP_TABLE_EDGE )                                             \
    X( MAP_BEND_COMPLIANCE, "map.bend_compliance", WISP_TABLE_EDGE )                                                 \
    X( MAP_BEND_STIFFNESS, "map.bend_stiffness", WISP_TABLE_EDGE )                                                   \
    X( MAP_BEND_RIGIDITY, "map.bend_rigidity", WISP_TABLE_TRIANGLE )                                                 \
    X( MAP_DAMPING, "map.damping", WISP_TABLE_PARTICLE )                                                             \
    X( MAP_INTERNAL_DAMPING, "map.internal_damping", WISP_TABLE_PARTICLE )                                           \
    X( MAP_DRAG, "map.drag_coefficient", WISP_TABLE_PARTICLE )                                                       \
    X( MAP_LIFT, "map.lift_coefficient", WISP_TABLE_PARTICLE )                                                       \
    X( LINK_CONSTANT, "link.constant", WISP_TABLE_LINK )                                                             \
    X( HINGE_CONSTANT, "hinge.constant", WISP_TABLE_HINGE )                                                          \
    X( LEVEL_CONSTANT, "level.constant", WISP_TABLE_LEVEL_LINK )                                                     \
    X( MAP_COLLISION_THICKNESS, "map.collision_thickness", WISP_TABLE_PARTICLE )                                     \
    X( MAP_COLLISION_FRICTION, "map.collision_friction", WISP_TABLE_PARTICLE )                                       \
    X( MAP_CONTACT_THICKNESS, "map.contact_thickness", WISP_TABLE_PARTICLE )                                         \
    X( MAP_CONTACT_FRICTION, "map.contact_friction", WISP_TABLE_PARTICLE )                                           \
    X( PARTICLE_CONTACT_IMPULSES, "particle.contact_impulses", WISP_TABLE_PARTICLE )                                 \
    X( SURFACE_ELASTIC, "surface.elastic", WISP_TABLE_ENTITY )                                                       \
    X( SURFACE_VIRIAL, "surface.virial", WISP_TABLE_ENTITY )                                                         \
    X( STRAND_REACH, "strand.reach", WISP_TABLE_ENTITY )

#define WISP_STRAND_REST_COLUMNS( X ) X( float, rest, 48 )         /* m, [3][16] a row, as the user gave it */
#define WISP_STRAND_POSITION_COLUMNS( X ) X( float, position, 48 ) /* m, [3][16] a row */
#define WISP_STRAND_STIFFNESS_COLUMNS( X )                                                                           \
    X( float, stretch, 16 ) /* k_s, no unit: 1/k is the relative change of length allowed */                         \
    X( float, bend, 16 )    /* k_b, no unit: 1/k is the share of the largest angle allowed */
#define WISP_STRAND_VELOCITY_COLUMNS( X ) X( float, velocity, 48 ) /* m/s, [3][16] a row */
/// Means nothing between steps: neither snapshots nor hashes hold it.
#define WISP_STRAND_PREVIOUS_COLUMNS( X )                                                                            \
    X( float, previous, 48 ) /* m, position at the start of the substep */                                           \
    X( float, segment, 48 )  /* m, from the next vertex to this one, as strands have solved it */                    \
    X( float, speed, 16 )    /* m^2/s^2, squared, as predicted */
#define WISP_STRAND_INVERSE_MASS_COLUMNS( X ) X( float, inverse_mass, 16 ) /* 1/kg; 0: pinned, or not a vertex */
#define WISP_STRAND_LENGTH_COLUMNS( X ) X( float, length, 16 ) /* m, > 0: of the segment to the next row; 0: none */
#define WISP_STRAND_ROOT_COLUMNS( X )                                                                                \
    X( float, position, 48 ) /* m, [3][16] a group: where roots are at the end of the substep */                     \
    X( float, rotation, 64 ) /* quaternion [4][16], x y z w: how roots are turned from rest */                       \
    X( float, low, 48 )      /* m, what does not fit the digits of the position */
/* A pass that writes it reads STRAND_POSITION too: it then runs before the appearance, which starts from it. */
#define WISP_STRAND_POSED_COLUMNS( X )                                                                               \
    X( float, posed, 48 ) /* m, [3][16] a row: where motion has taken the rest shape, before appearance changes it */
/// Bounds that no vertex leaves in this step, whatever the forces.
#define WISP_STRAND_REACH_COLUMNS( X )                                                                               \
    X( float, bounds, 6 )  /* m, lower and upper corner */                                                           \
    X( int32_t, known, 1 ) /* 1: there are such bounds */                                                            \
    X( int32_t, apart, 1 ) /* 1: nothing comes near them, so that the strands run their substeps on their own */
#define WISP_STRAND_POINTS_COLUMNS( X ) X( wisp_vec3, points, 1 ) /* m, the user's order */
#define WISP_POINT_WIDTH_COLUMNS( X ) X( float, width, 1 )        /* m, diameter */
#define WISP_POINT_COLOUR_COLUMNS( X ) X( wisp_vec3, colour, 1 )  /* linear red, green, blue in [0, 1] */

// Rows of particles follow the slots of the entity's fabric, rows of links and hinges its schedules.
#define WISP_PARTICLE_POSITION_COLUMNS( X )                                                                          \
    X( float, position, 4 ) /* x, y, z in m; inverse mass in 1/kg, 0 is pinned */
#define WISP_PARTICLE_VELOCITY_COLUMNS( X ) X( float, velocity, 4 ) /* x, y, z in m/s; 0 */
#define WISP_PARTICLE_PREVIOUS_COLUMNS( X ) X( float, previous, 4 ) /* m, position at the start of the substep; any */
#define WISP_PARTICLE_TARGET_COLUMNS( X )                                                                            \
    X( float, target, 4 ) /* m, of a pinned particle; 1 where it counts, else 0 */
#define WISP_PARTICLE_MASS_COLUMNS( X )                                                                              \
    X( float, area_density, 1 )                                       /* kg/m^2 */                                   \
    X( float, vertex_mass, 1 )                                        /* kg, above 0 it counts instead */
#define WISP_PARTICLE_GRAVITY_COLUMNS( X ) X( wisp_vec3, gravity, 1 ) /* m/s^2 */
#define WISP_PARTICLE_DAMPING_COLUMNS( X ) X( float, rate, 1 )        /* 1/s: v <- v / (1 + rate dt) */
#define WISP_PARTICLE_EXTERNAL_SOLVER_COLUMNS( X )                                                                   \
    X( int32_t, external,                                                                                            \
       1 ) /* 1: a module moves the particles: gravity, targets, damping and velocities are its business */
// Bodies that a solver of velocities must know of: the nearest, whoever they are, for one substep.
#define WISP_PARTICLE_CONTACTS_COLUMNS( X )                                                                          \
    X( int32_t, body, WISP_MAX_PARTICLE_CONTACTS ) /* a name that stays from step to step, 0: none from here on */   \
    X( float, plane,                                                                                                 \
       4 * WISP_MAX_PARTICLE_CONTACTS ) /* unit normal out of the body; m, gap when the substep begins */            \
    X( float, motion,                                                                                                \
       4 * WISP_MAX_PARTICLE_CONTACTS ) /* m/s, of the body's surface there; m, margin in which it touches */        \
    X( float, friction, 3 * WISP_MAX_PARTICLE_CONTACTS ) /* static, kinetic; m/s, how fast depth is undone at most */
/// What a solver of velocities gave to the bodies of particle.contacts in the substep. Exists while somebody asks for it, who clears
/// `body` again.
#define WISP_PARTICLE_CONTACT_IMPULSES_COLUMNS( X )                                                                  \
    X( int32_t, body, WISP_MAX_PARTICLE_CONTACTS )      /* as in particle.contacts; 0: none */                       \
    X( float, impulse, 3 * WISP_MAX_PARTICLE_CONTACTS ) /* N s, on the body */                                       \
    X( float, point, 3 ) /* m, where it acts: the particle at the start of the substep */
// Half spaces that a particle has to stay in for one substep, such as those outside bodies. Rows are those of the kernel half_space.
#define WISP_PARTICLE_HALF_SPACES_COLUMNS( X )                                                                       \
    X( int32_t, count, 1 ) /* found; at most WISP_MAX_HALF_SPACES are stored */                                      \
    X( float, found, 4 )   /* m, where they were found; the distance from there that is clear */                     \
    X( float, row, 16 * WISP_MAX_HALF_SPACES )
#define WISP_LINK_STIFFNESS_COLUMNS( X )                                                                             \
    X( float, alike, 2 ) /* pbd, of edges and of bend links: share of the error, in [0, 1] */
#define WISP_LINK_COMPLIANCE_COLUMNS( X ) X( float, alike, 2 ) /* xpbd, of edges and of bend links: m/N */
/// Exists where edges differ, then the first of `alike` is below 0, or where maps multiply them.
#define WISP_LINK_OWN_COLUMNS( X ) X( float, own, 1 ) /* stiffness or compliance of each link */
/// Exists with several iterations only: with one it is always read as 0.
#define WISP_LINK_LAMBDA_COLUMNS( X ) X( float, lambda, 1 ) /* N s^2, of the substep */
#define WISP_LINK_LIMIT_COLUMNS( X )                                                                                 \
    X( float, minimum, 1 ) /* times the rest length */                                                               \
    X( float, maximum, 1 )
/// Bend links that are too short give way to their hinges.
#define WISP_LINK_FOLDS_COLUMNS( X )                                                                                 \
    X( float, rigidity, 1 ) /* N m, of those hinges */                                                               \
    X( int32_t, count, 1 )  /* of groups of links with such hinges, in the last search */                            \
    X( int32_t, wait, 1 )   /* passes until the next search */
/// Sharp folds of cloth without bend links are opened by their hinges too.
#define WISP_HINGE_FOLDS_COLUMNS( X ) WISP_LINK_FOLDS_COLUMNS( X )
#define WISP_HINGE_REST_COLUMNS( X ) X( float, angle, 1 ) /* rad, between the normals */
/// Groups [4][8]: c_i of the bending energy 1/2 k |sum c_i x_i|^2 / A, A the area of both triangles.
#define WISP_HINGE_COTANGENT_COLUMNS( X ) X( float, weight, 4 )
#define WISP_HINGE_STIFFNESS_COLUMNS( X ) X( float, stiffness, 1 ) /* pbd, in [0, 1] */
#define WISP_SURFACE_TETHERS_COLUMNS( X ) X( float, slack, 1 )     /* times the rest distance, >= 1 */
/// Coarse sheets that carry a surface. Whoever changes masses, or velocities from outside, calls wisp_world_restart_levels().
#define WISP_SURFACE_LEVELS_COLUMNS( X )                                                                             \
    X( int32_t, substeps, 1 ) /* of the coarsest sheet in a substep of the surface */                                \
    X( int32_t, passes, 1 )   /* over its links in each of them */                                                   \
    X( int32_t, state, 1 )    /* 0: masses have to be found; 1: no history, the next substep is Euler's; 2: BDF2 */  \
    X( int32_t, pins, 1 )     /* most pins between the rows of a level; found with the masses */                     \
    X( float, forced, 3 )     /* m/s^2, within a substep: mean acceleration by the forces */                         \
    X( float, drift, 3 )      /* m/s, mean velocity when a substep ends, of a surface that nothing pins */
#define WISP_LEVEL_MASS_COLUMNS( X ) X( float, inverse_mass, 1 )     /* 1/kg; 0: pinned */
#define WISP_LEVEL_COMPLIANCE_COLUMNS( X ) X( float, compliance, 1 ) /* m/N */
#define WISP_LEVEL_MOTION_COLUMNS( X )                                                                               \
    X( float, velocity, 4 ) /* m/s, of the surface when a substep ends; within one, of the sheet */                  \
    X( float, change, 4 )   /* m/s^2, of the velocity in the last substep of the sheet, by its length */             \
    X( float, lag, 4 )      /* m/s^2, of the mean velocity of that substep behind the one at its end, likewise */    \
    X( float, mean, 4 )     /* m/s, within a substep: of the sheet in the substep of the surface */                  \
    X( float, before, 4 )   /* m/s, mean velocity of the surface in its last substep */
/// Triangles have a strain energy (elastic_triangles.h), and there are no links that stretch.
#define WISP_SURFACE_ELASTIC_COLUMNS( X )                                                                            \
    X( float, stiffness, 1 )                                    /* N/m, shear modulus times thickness */             \
    X( int32_t, tension_field, 1 )                              /* 1: triangles hold no compression */
#define WISP_SURFACE_VIRIAL_COLUMNS( X ) X( double, virial, 1 ) /* J, sum of x . dE/dx when the substep begins */
/// The last valid state too: where vertices were when a step ended that was finite and within bounds.
#define WISP_SURFACE_POINTS_COLUMNS( X ) X( wisp_vec3, points, 1 )   /* m, the user's order */
#define WISP_SURFACE_NORMALS_COLUMNS( X ) X( wisp_vec3, normals, 1 ) /* unit, area weighted; 0 where they cancel */
#define WISP_POINT_STRAIN_COLUMNS( X ) X( float, strain, 1 ) /* largest |l/l0 - 1| of the edges at the vertex */
#define WISP_POINT_SPEED_COLUMNS( X ) X( float, speed, 1 )   /* m/s */
#define WISP_MOTION_STATS_COLUMNS( X ) X( wisp_motion_stats, motion_stats, 1 )
/// A frame of reference that moves. What particles do not feel of its motion carries them along.
#define WISP_PARTICLE_FRAME_COLUMNS( X )                                                                             \
    X( wisp_transform, pose, 3 ) /* at the start and the end of the step; at the end of the next one */              \
    X( float, felt, 2 )          /* fraction of its displacement and of its rotation, in [0, 1] */                   \
    X( int32_t, moves, 1 )       /* 1: in this step */
/// Means nothing between substeps.
#define WISP_PARTICLE_UNCARRIED_COLUMNS( X )                                                                         \
    X( float, position, 4 ) /* m, at the start of the substep, before the frame carried it; any */
#define WISP_PARTICLE_MAX_SPEED_COLUMNS( X ) X( float, speed, 1 ) /* m/s */

// Maps (maps.h): factors on a constant of an effect, by slot, by edge of the fabric or by triangle. Rows of dummies are 1.
#define WISP_MAP_AREA_DENSITY_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_STRETCH_COMPLIANCE_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_STRETCH_STIFFNESS_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_BEND_COMPLIANCE_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_BEND_STIFFNESS_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_BEND_RIGIDITY_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_DAMPING_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_INTERNAL_DAMPING_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_DRAG_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_LIFT_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_COLLISION_THICKNESS_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_COLLISION_FRICTION_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_CONTACT_THICKNESS_COLUMNS( X ) X( float, factor, 1 )
#define WISP_MAP_CONTACT_FRICTION_COLUMNS( X ) X( float, factor, 1 )
/// Coefficients of links, hinges and links of coarse sheets as the effect has set them, where maps multiply them.
#define WISP_LINK_CONSTANT_COLUMNS( X )                                                                              \
    X( float, constant, 1 )                                                                                          \
    X( int32_t, edge, 1 ) /* whose factor counts: of a bend link the one that it crosses; -1 pads */
#define WISP_HINGE_CONSTANT_COLUMNS( X ) WISP_LINK_CONSTANT_COLUMNS( X )
#define WISP_LEVEL_CONSTANT_COLUMNS( X ) X( float, constant, 1 )
