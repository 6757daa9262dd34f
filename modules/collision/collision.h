/// Collision of surfaces and strands with kinematic bodies, with Coulomb friction. Colliders are planes, spheres, capsules,
/// tapered capsules and boxes in closed form, convex polyhedra, height fields, triangle meshes, and
/// surfaces that deform, such as the skin of a character. They rest or move as the host says.
///
///     wisp_collider_def ball = wisp_default_collider_def();
///     ball.kind = WISP_COLLIDER_SPHERE, ball.radius = 0.5f;
///     wisp_entity collider;
///     wisp_add_collider( world, &ball, &collider );
///     wisp_collision_def collision = wisp_default_collision_def();
///     wisp_set_collision( world, cloth, &collision );        // the cloth collides with all colliders of the world
///     wisp_move_collider( world, collider, pose );           // before a step
#pragma once

#include "wisp/shapes.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_collision_module;

/// Most contacts of a particle. The nearest are kept; wisp_collision_stats counts the rest.
#define WISP_COLLISION_CONTACTS 3

typedef enum wisp_collider_kind
{
    WISP_COLLIDER_PLANE = 0,           ///< the half space y <= 0 of its own frame
    WISP_COLLIDER_SPHERE = 1,          ///< around the origin of its frame
    WISP_COLLIDER_CAPSULE = 2,         ///< along the y axis of its frame
    WISP_COLLIDER_BOX = 3,             ///< around the origin, edges along the axes
    WISP_COLLIDER_MESH = 4,            ///< triangles
    WISP_COLLIDER_TAPERED_CAPSULE = 5, ///< along the y axis of its frame, with two radii
    WISP_COLLIDER_CONVEX = 6,          ///< the convex hull of points
    WISP_COLLIDER_HEIGHT_FIELD = 7,    ///< everything below a grid of heights over the xz plane of its frame
    WISP_COLLIDER_SURFACE = 8,         ///< the triangles of a surface of the world, which deforms
    WISP_COLLIDER_COUNT = 9,
} wisp_collider_kind;

/// A body that surfaces and strands collide with. Fill from wisp_default_collider_def(). Copied; need not outlive the call.
typedef struct wisp_collider_def
{
    uint32_t size; ///< bytes; set by wisp_default_collider_def()
    wisp_collider_kind kind;
    float radius;             ///< m, > 0: sphere, capsule; default 1
    float half_length;        ///< m, >= 0: capsule, tapered capsule: from the centre to that of a cap; default 1
    wisp_vec3 half_extent;    ///< m, each > 0: box; default 1
    const wisp_vec3* points;  ///< [point_count] m: mesh, convex, in the body's frame; at most 1024 of a convex one
    const int32_t* triangles; ///< [triangle_count][3]: mesh, counter-clockwise seen from outside
    int point_count, triangle_count;
    bool double_sided;      ///< mesh: two-sided, without an inside; default false: a solid, whose mesh must be closed
    wisp_transform pose;    ///< default: the identity
    float static_friction;  ///< mu that must be overcome, >= 0, default 0.5
    float kinetic_friction; ///< mu while sliding, 0 .. static_friction, default 0.5
    float thickness;        ///< m, >= 0: added to the thickness of what touches the collider, default 0
    uint32_t layers;        ///< bits; an entity collides with it if its mask has one of them; default 1
    float top_radius;       ///< m, > 0: tapered capsule, of the cap at +y; default 1
    float bottom_radius;    ///< m, > 0: tapered capsule, of the cap at -y; default 1
    const float* heights;   ///< [height_count_z][height_count_x] m: height field, within 1e6 m of 0
    int height_count_x, height_count_z; ///< height field: samples along x and z, 2 .. 8192 each
    float spacing;                      ///< m, > 0: height field: distance of its samples along x and z; default 1
    float restitution;   ///< 0 .. 1: fraction of the approach speed that a vertex leaves with; default 0
    wisp_entity surface; ///< surface: an entity with triangles, such as the skin of a character
    bool
        tracks; ///< mesh, surface: the closest triangle of a vertex is searched once per step and tracked over its neighbours in
    ///< the other substeps, so that what comes near from elsewhere within a step is met at the next; false: it is
    ///< searched in each substep, at several times the cost. Default true. Of the third such collider of the world
    ///< on it is searched
    float
        mass; ///< kg, >= 0: a free body, which what it touches moves: see wisp_reaction. Default 0: it goes where the host says
    wisp_vec3
        inertia; ///< kg m^2, each >= 0: principal moments about the axes of its frame, at whose origin its mass has its
                 ///< centre; default 0: contact does not turn it about that axis
} wisp_collider_def;

WISP_DEFINITION( collider_def );

/// What of a surface collides.
typedef enum wisp_collision_features
{
    WISP_COLLISION_VERTICES =
        0, ///< its vertices: what is thinner than its cells passes between them; segments see wisp_set_collision()
    WISP_COLLISION_ALL = 1, ///< its vertices, edges and triangles; of strands all segments
    WISP_COLLISION_FEATURES_COUNT = 2,
} wisp_collision_features;

/// Add a collider. wisp_remove() removes it.
///
/// A collider may be a surface of the world, whose points move against each other: pin all its vertices and move them
/// by wisp_move_pins() before each step. Between steps its points move along straight lines, and what it touches is pushed
/// and dragged as by a rigid body. Vertices that are not pinned count as moving on with the velocity that they have at the
/// start of the step: cloth and balloons can be colliders for others, which do not push them back. A surface does not collide with
/// itself. It keeps the pose of the world; `pose` is not read. When the surface is removed, nothing collides with it any more.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a value is out of range, a point or an index is wrong, or the mesh of a body is open (the
///         message names it); WISP_NO_MEMORY; WISP_CONFLICT the module is not registered
WISP_API wisp_status wisp_add_collider( wisp_world* world, const wisp_collider_def* def, wisp_entity* out );

/// Move a collider to a pose that it reaches at the end of the next step, along a straight line and the shorter rotation. It
/// pushes and drags what it touches. Detection is continuous: it passes through no particle at any speed. Without another
/// call it rests there.
/// @return WISP_BAD_INPUT the pose is not finite or beyond 1e6 m, or has no rotation; WISP_CONFLICT the entity is no collider, or one that moves
///         with its surface
WISP_API wisp_status wisp_move_collider( wisp_world* world, wisp_entity collider, wisp_transform pose );

/// What surfaces and strands gave to a collider in a step: minus the momentum and angular momentum that its contact gave to their
/// vertices by push, friction and restitution. What only moves a vertex out of an initial overlap gives no momentum.
///
/// A collider with a mass is a free body, whose reaction is always computed. wisp_move_collider() says where it would get without
/// contact. After each substep of the surfaces the impulse of that substep changes its velocity and its way, so that body and cloth move
/// together: the host adds impulse / mass to its velocity and takes the pose over. Surfaces that collide share substeps while there is such
/// a body. A vertex of mass m and the body share each correction as two bodies of the masses m and M m / c do, with M that of the body
/// and c that of all vertices near it (mass splitting, Tonge, Benevolenski, Voroshilov 2012): a light body is not thrown by a heavy
/// cloth. Strands and implicit cloth push it without that.
typedef struct wisp_reaction
{
    wisp_vec3 impulse; ///< N s
    wisp_vec3
        torque_impulse; ///< N m s, about the origin of the collider's frame at the end of the step; with a mass at each substep
    wisp_transform pose; ///< at the end of the step; with a mass where the impulses have moved it
} wisp_reaction;

/// Request the reaction of a collider from the next step on. It costs a body number per contact and two sums in double per
/// block of particles; without a request nothing. A step between two reads is not added to the next.
/// @param requested false cancels the request
/// @return WISP_CONFLICT the entity is no collider; WISP_NO_MEMORY
/// @note Implicit cloth gives the impulses of its solve; what wisp_set_contact() pushes against bodies after it is not counted. With
///       `effective` weights its momentum is not kept, and what friction holds of strains has a resultant (1e-4 of the weight). Strands
///       without dynamics have no momentum and give nothing
WISP_API wisp_status wisp_request_reaction( wisp_world* world, wisp_entity collider, bool requested );

/// Read the reaction of the last step. Sums are made in double in a fixed order, independent of the number of workers.
/// @return WISP_CONFLICT the reaction was not requested. Before the first step it is zero
WISP_API wisp_status wisp_read_reaction( wisp_world* world, wisp_entity collider, wisp_reaction* out );

/// How a surface or strands collide. Fill from wisp_default_collision_def(). Copied.
typedef struct wisp_collision_def
{
    uint32_t size; ///< bytes; set by wisp_default_collision_def()
    float
        thickness; ///< m, the distance that vertices keep; default 0: a quarter of the mean rest length of the edges,
                   ///< of strands the mean rest length of the segments. Of a surface with an external solver: the
                   ///< margin within which a vertex is held.
    ///< A surface has it on both sides. Two bodies that leave less room squeeze it: each presses on a vertex of
    ///< mass m with k d, where d is half of what is missing and k = 5000 m 9.81 m/s^2 / thickness, N/m: at the depth of
    ///< the thickness 5000 weights, 10 kPa on cloth of 0.2 kg/m^2. Friction and reactions are those of this force.
    ///< Bodies that overlap by more than twice the thickness squeeze nothing
    float friction_scale; ///< factor on the friction of the collider, >= 0, default 1
    float
        max_push_out_speed; ///< m/s: speed at which a vertex that starts inside a collider is moved out. It gets no velocity
    ///< (with an external solver: at most this one). Default 0: ten mean edges or segments per
    ///< second
    uint32_t mask; ///< of the layers to collide with, default all
    bool enabled;  ///< default true
    /// surfaces: default WISP_COLLISION_VERTICES. Edges and triangles keep the thickness from spheres, capsules, tapered capsules, boxes
    /// and convex polyhedra, and from the edges and corners of meshes, surfaces and height fields; a plane needs no more than vertices.
    /// Restitution acts on vertices alone
    wisp_collision_features features;
} wisp_collision_def;

WISP_DEFINITION( collision_def );

/// Make a surface or strands collide with the colliders of the world, or replace their definition. Pinned vertices are not
/// moved. Vertices of strands collide, and their segments with bodies that are too thin for vertices: where those would let a
/// segment nearer than 3/4 of the thickness. That is told by the radius of round bodies, and of a mesh by twice its volume over its area;
/// boxes and convex bodies have edges. With WISP_COLLISION_ALL segments meet every body but planes. Strands without dynamics
/// collide by vertices alone.
///
/// Strands without dynamics (ghosts, still strands) are corrected once per step: vertices nearer than the thickness to a
/// collider at the end of the step move out along its normal, without friction, push-out speed or restored lengths. If this
/// module is listed before frozen_hair in the world, frozen hair starts from the corrected positions; otherwise its result
/// is corrected. Strands that get dynamics later are treated so until this call is repeated or a collider is added. Curves
/// follow their source, which collides.
///
/// Surfaces with an external solver (particle.external_solver, such as implicit cloth) are not moved here: their solver
/// receives the two nearest colliders of each vertex. The order of the calls does not matter.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered,
///         or the entity is neither a surface nor strands, or strands that neither rest nor have dynamics nor follow others;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_set_collision( wisp_world* world, wisp_entity participant, const wisp_collision_def* def );

/// Statistics of a surface or of strands at the end of a step, over vertices that are not pinned (of strands without dynamics:
/// not roots). With an external solver vertices may be within the thickness: then penetration is the depth below the surface
/// of the collider, and contacts are vertices within the thickness.
typedef struct wisp_collision_stats
{
    float penetration; ///< m, largest amount by which a vertex is nearer to a collider than the thickness; 0: none
    float thickness;   ///< m, thickness of that contact: its own and that of the collider
    int32_t vertex;    ///< that vertex, the user's order, the lowest of equals; -1: none
    int32_t contacts;  ///< vertices that a collider presses on
    int32_t dropped;   ///< surfaces: contacts beyond WISP_COLLISION_CONTACTS per vertex, which are ignored; not
                       ///< counted with an external solver
} wisp_collision_stats;

/// Request statistics from the next step on. They cost one query per vertex and collider.
/// @param requested false cancels the request
/// @return WISP_CONFLICT the entity has no collision
WISP_API wisp_status wisp_request_collision_stats( wisp_world* world, wisp_entity participant, bool requested );

/// @return WISP_CONFLICT statistics were not requested. Without a collider, or before the first step, vertex is -1
WISP_API wisp_status wisp_read_collision_stats( wisp_world* world, wisp_entity participant,
                                                wisp_collision_stats* out );

WISP_END_C
