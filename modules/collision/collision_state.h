// State of the module: bodies, participants, and their components.
#pragma once

#include "collision.h"

#include "wisp/module/components.h"
#include "wisp/module/collision_mesh.h"
#include "wisp/module/shapes.h"
#include "wisp/module/module.h"

/// Impulse on a body, N s, and torque impulse about the origin of the world, N m s.
typedef double collision_impulse[6];

/// A body. Only the mesh of a surface, its box and its ball change from step to step.
typedef struct collision_body
{
    wisp_entity entity;
    wisp_shape shape;          // unless there is a tree
    wisp_convex* convex;       // of a convex body, or null
    float* heights;            // of a height field, or null
    wisp_collision_mesh* tree; // null for a closed form
    bool follows;              // the mesh is that of a surface, in the world: see collision_surface.c
    wisp_entity surface;       // zero once it was removed
    bool is_coupled;           // it has a mass
    bool tracks;               // the closest triangle is tracked
    int track;                 // where participants keep it; -1: nowhere
    wisp_vec3 *start, *finish; // m, [point_count] of the surface in this step, the user's order
    int point_count;
    float shift; // m, most that a point of the surface moves in this step
    bool double_sided;
    float restitution;
    wisp_vec3
        centre;     // m, of a box and a ball around the body, in its frame; of a half space or a height field its top
    wisp_vec3 half; // m, of the box; infinite for a plane
    float ball_radius;  // m, of a ball around the box
    float tight_radius; // m, of a ball around the points of a mesh, with the same centre
    float inner;        // m, of a closed form: the smallest of its half sizes; infinite for a plane, 0 for a mesh
    float bluntness;    // m, the least radius of a closed form, 0 with edges; twice volume over area of a solid mesh
} collision_body;

/// Return whether kernels compute the closest points of the body.
static inline bool collision_is_closed_form( const collision_body* body )
{
    return body->tree == NULL && body->shape.kind <= WISP_SHAPE_TAPERED_CAPSULE;
}

/// Bodies that participants can meet in this step: see near_bodies.c. Nothing of it is state.
typedef struct collision_nearness
{
    struct collision_near* near;      // [near_count] by the index of the entity; 0: all bodies count
    struct collision_motion* motions; // [body]
    int32_t* listed;                  // bodies
    int32_t* interval;                // [interval_count + 1] first body in it
    wisp_buffer buffers[4];           // of these
    int near_count, interval_count;
    float first_x, per_metre;          // of the intervals
    float widest, most_turn, thickest; // of bodies
} collision_nearness;

/// Bodies and participants in the order in which they were added. Passes walk these lists, so results depend on
/// nothing else.
typedef struct collision_state
{
    wisp_component settings; // collision_settings: the surface, or the strands, collide
    wisp_component active;   // a mark on surfaces, while there is a body: also on those that an external solver moves
    wisp_component strand_contact; // rows of strands, likewise
    wisp_component
        segment_contact;     // the same of the segments behind their vertices, while there is a body that they meet
    wisp_component carried;  // rows of strands without dynamics, likewise
    wisp_component stats;    // wisp_collision_stats
    wisp_component collider; // collision_collider
    wisp_component motion;   // a pose: the body is moved
    wisp_component follower; // a mark: the body is a surface
    wisp_component tracked;  // of particles, while there is a body that is tracked
    wisp_component strand_tracked; // of rows of strands, likewise
    int track_count;               // bodies that are tracked
    wisp_component reaction;       // wisp_reaction of a body that is asked for it
    wisp_component coupled;        // collision_coupled of a body with a mass
    int coupled_count;             // of them
    wisp_component reaction_part;  // of participants while one is: the first of their parts in the sums
    wisp_component contact_body;   // of surfaces likewise: for each contact the place of its body in the list
    wisp_component all_features;   // a mark of surfaces whose edges and triangles collide, and how many have contacts
    wisp_component edge_contacts;  // of their edges, while there is a body
    wisp_component triangle_contacts; // likewise
    wisp_component clearance;         // of their particles, likewise
    wisp_component bounce;            // of surfaces while a body has a restitution: m/s, for each contact
    collision_impulse* sums;          // [part][body], zero between steps; null while no reaction is requested
    size_t sum_count, sum_capacity;
    collision_body* bodies;
    int body_count, body_capacity;
    wisp_entity* participants; // surfaces and strands
    int participant_count, participant_capacity;
    bool has_strands; // there was one with strands
    collision_nearness nearness;
    bool has_iterations; // several per substep
    bool searches_all;   // no particle is left out because a body cannot reach it in the step: for tests
} collision_state;

enum
{
    COLLISION_TRACKS = 2, // bodies whose closest triangle a vertex keeps
};

/// The definition of a participant with the defaults filled in.
typedef struct collision_settings
{
    float thickness, friction, max_push_out_speed;
    uint32_t mask;
    int32_t enabled, stats;
} collision_settings;

/// Poses and material of a body.
typedef struct collision_collider
{
    wisp_transform from, to; // at the start and at the end of the step
    float static_friction, kinetic_friction;
    float thickness;
    uint32_t layers;
} collision_collider;

/// A body with a mass, within a step.
typedef struct collision_coupled
{
    double impulse[6];              // of the step: N s; N m s about its origin in each substep
    wisp_transform before;          // where the last substep ended
    wisp_quat turn;                 // what contact has changed of the pose that the host gave for that time
    wisp_vec3 shift;                // m, likewise
    wisp_vec3 velocity, spin;       // m/s, 1/s: of the step, of that change
    wisp_vec3 inverse_inertia;      // about the axes of its frame, 0: does not turn
    float inverse_mass, most_turns; // the latter the largest of inverse_inertia
    float load;                     // kg, of vertices near it in the substep
    int32_t done, total;            // substeps of the step
} collision_coupled;

_Static_assert( sizeof( collision_coupled ) == 160, "no padding" );

/// Find the state of the module. @return WISP_CONFLICT the module is not registered
wisp_status collision_find_state( wisp_world* world, collision_state** out );
