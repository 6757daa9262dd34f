/// Collision: surfaces and strands that bodies keep out, with Coulomb friction. Bodies are planes, spheres, capsules and boxes in
/// closed form, and triangle meshes through Embree or voxels; they stand still or move as they are told.
#pragma once

#include "wisp/collision_mesh.h"
#include "wisp/shapes.h"
#include "wisp/wisp.h"

WISP_BEGIN_C

WISP_API extern const wisp_module wisp_collision_module;

/// So many contacts a particle can have at once. The nearest are kept; wisp_collision_stats counts the rest.
#define WISP_COLLISION_CONTACTS 3

typedef enum wisp_collider_kind
{
    WISP_COLLIDER_PLANE,   ///< the half space y <= 0 of its own frame
    WISP_COLLIDER_SPHERE,  ///< around the origin of its frame
    WISP_COLLIDER_CAPSULE, ///< along the y axis of its frame
    WISP_COLLIDER_BOX,     ///< around the origin, edges along the axes
    WISP_COLLIDER_MESH,    ///< triangles; needs Embree unless it is searched by voxels
    WISP_COLLIDER_COUNT,
} wisp_collider_kind;

/// A rigid body that surfaces and strands collide with. Fill from wisp_default_collider_def(). Copied; may die after the call.
typedef struct wisp_collider_def
{
    wisp_collider_kind kind;
    float radius;             ///< m, > 0: sphere, capsule; default 1
    float half_length;        ///< m, >= 0: capsule, from the centre to that of a cap; default 1
    wisp_vec3 half_extent;    ///< m, each > 0: box; default 1
    const wisp_vec3* points;  ///< [point_count] m: mesh, in the body's frame
    const int32_t* triangles; ///< [triangle_count][3]: mesh, counter-clockwise seen from outside
    int point_count, triangle_count;
    bool double_sided; ///< mesh: two-sided, without an inside; default false: a body, whose mesh must be closed
    wisp_mesh_search
        search;            ///< mesh: how triangles are found, which changes the time and not the result; default tree
    float voxel_size;      ///< m, >= 0: mesh that is searched by voxels, their edge; default 0: the mean edge
    wisp_transform pose;   ///< where the body stands; default: at the origin, not turned
    float static_friction; ///< mu that must be overcome, >= 0, default 0.5
    float kinetic_friction; ///< mu while sliding, 0 .. static_friction, default 0.5
    float thickness;        ///< m, >= 0: added to that of what touches the body, default 0
    uint32_t layers;        ///< bits; who collides meets the body if its mask has one of them; default 1
    uint32_t cookie;
} wisp_collider_def;

WISP_API wisp_collider_def wisp_default_collider_def( void );

/// Add a body. wisp_remove() takes it away again.
/// @param out receives the entity, null on failure
/// @return WISP_BAD_INPUT a value is out of range, a point or an index is wrong, or the mesh of a body is open (the
///         message names it); WISP_NO_MEMORY; WISP_CONFLICT the module is not registered, or a tree without Embree
WISP_API wisp_status wisp_add_collider( wisp_world* world, const wisp_collider_def* def, wisp_entity* out );

/// Carry a body so that it is at the pose at the end of the next step: in a straight line, turning the shorter way. What
/// it meets is pushed and dragged along; however fast it is, it passes through no particle. Without another call it
/// stands still from then on.
/// @return WISP_BAD_INPUT the pose is not finite or beyond 1e6 m; WISP_CONFLICT the entity is no collider
WISP_API wisp_status wisp_move_collider( wisp_world* world, wisp_entity collider, wisp_transform pose );

/// How a surface, or strands, collide. Fill from wisp_default_collision_def(). Copied.
typedef struct wisp_collision_def
{
    float
        thickness; ///< m, the distance that vertices keep; default 0: a quarter of the mean rest length of the edges,
                   ///< of strands the mean rest length of the segments. Of a surface that another module solves for:
                   ///< the margin within which a vertex is held
    float friction_scale;     ///< times that of the body, >= 0, default 1
    float max_push_out_speed; ///< m/s: how fast a vertex that begins inside a body is moved out, which gives it no
                              ///< velocity (one that is solved for: no more than this); default 0: ten mean edges, or
                              ///< segments, a second
    uint32_t mask;            ///< of the layers to collide with, default all
    bool enabled;             ///< default true
    uint32_t cookie;
} wisp_collision_def;

WISP_API wisp_collision_def wisp_default_collision_def( void );

/// Let a surface or strands collide with the bodies of the world, or change how they do. Vertices that are pinned are not
/// moved. Strands keep out of bodies vertex by vertex, before their lengths are restored, which may pull a vertex back in by
/// some of the thickness: see wisp_read_collision_stats().
///
/// Strands without dynamics are carried by others (ghosts), or stand still. Once a step, when their place is known, vertices
/// behind the root that are nearer than the thickness to a body, where that is at the end of the step, are moved out along
/// its normal: without friction, push-out speed and memory, and without regard for lengths and paths. Frozen hair begins
/// before and goes on from there if this module comes before its own in the world's list, else it is moved as it looks.
/// Strands that get dynamics later are carried until the call is made again, or a body is added. Curves are drawn
/// afterwards: it is their source that collides.
///
/// Surfaces that another module solves for (component particle.external_solver, like implicit cloth) are not moved here: that module
/// is told of the two nearest bodies of each vertex and answers for them. Whether they become so before this call or after
/// does not matter.
/// @return WISP_BAD_INPUT a value is out of range (the message names it); WISP_CONFLICT the module is not registered,
///         or the entity is neither a surface nor strands, or strands that move by other means than dynamics;
///         WISP_NO_MEMORY
WISP_API wisp_status wisp_set_collision( wisp_world* world, wisp_entity participant, const wisp_collision_def* def );

/// Figures of a surface or of strands at the end of a step, over its vertices that are not pinned; of strands
/// without dynamics, that are not roots. A surface that another module solves for may be within the thickness, so its
/// penetration is how deep a vertex is behind the body's surface itself, and its contacts are vertices within the thickness.
typedef struct wisp_collision_stats
{
    float penetration; ///< m, how much nearer than the thickness a vertex is to a body, at most; 0: none is
    float thickness;   ///< m, to compare it with: its own, and that of the body there
    int32_t vertex;    ///< which one, the user's number, the lowest of equals; -1: none
    int32_t contacts;  ///< vertices that a body presses on
    int32_t dropped;   ///< surfaces: contacts beyond WISP_COLLISION_CONTACTS a vertex, not answered for; not
                       ///< counted of those that another module solves for
} wisp_collision_stats;

/// Ask for figures from the next step on. They cost a query a vertex and body.
/// @return WISP_CONFLICT the entity has no collision
WISP_API wisp_status wisp_request_collision_stats( wisp_world* world, wisp_entity participant, bool requested );

/// @return WISP_CONFLICT nobody asked for them. Without a body, or before the first step, there is nothing: vertex is -1
WISP_API wisp_status wisp_read_collision_stats( wisp_world* world, wisp_entity participant,
                                                wisp_collision_stats* out );

WISP_END_C
