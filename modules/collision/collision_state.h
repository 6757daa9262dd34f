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
    uint32_t layers;
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

/// The components, a row each: X( member, "name", table, columns ).
#define COLLISION_COMPONENTS( X )                                                                                    \
    X( settings, "collision.settings", ENTITY,                                                                       \
       WISP_COLUMN( collision_settings, settings, 1 ) ) /* of participants */                                        \
    X( active, "collision.active", ENTITY,                                                                           \
       WISP_COLUMN( int32_t, active, 1 ) )                     /* 1: there is a body, and it is enabled */           \
    X( strand_contact, "collision.strand_contact", STRAND_ROW, /* while there is a body, as what follows */          \
       WISP_COLUMN( float, pushed, 16 ),   /* m, normal correction of this substep; below 0: of the last one */      \
       WISP_COLUMN( float, depth, 16 ),    /* m, depth that a vertex may keep in this iteration */                   \
       WISP_COLUMN( float, left, 16 ),     /* m, depth that it kept */                                               \
       WISP_COLUMN( float, friction, 48 ), /* m, sum of what friction removed in this substep */                     \
       WISP_COLUMN( float, body, 16 ),     /* number of the body that pushed; -1: several */                         \
       WISP_COLUMN( float, last, 16 ) /* m, pushed in the last substep */ )                                          \
    X( segment_contact, "collision.segment_contact", STRAND_ROW,                                                     \
       /* of the segments behind vertices: the same, and */ WISP_COLUMN( float, pushed, 16 ),                        \
       WISP_COLUMN( float, depth, 16 ), WISP_COLUMN( float, left, 16 ), WISP_COLUMN( float, friction, 48 ),          \
       WISP_COLUMN( float, body, 16 ), WISP_COLUMN( float, last, 16 ),                                               \
       WISP_COLUMN( float, turn, 16 ) /* m, push of the last iteration */ )                                          \
    X( posed, "collision.carried", STRAND_ROW,                                                                       \
       WISP_COLUMN( uint32_t, moved, 1 ) ) /* a bit for each lane that moved */                                      \
    X( stats, "collision.stats", ENTITY, WISP_COLUMN( wisp_collision_stats, stats, 1 ) )                             \
    X( collider, "collision.collider", ENTITY, WISP_COLUMN( collision_collider, collider, 1 ) )                      \
    X( motion, "collision.motion", ENTITY,                                                                           \
       WISP_COLUMN( wisp_transform, target, 1 ) ) /* at the end of the next step */                                  \
    X( follower, "collision.follower", ENTITY, WISP_COLUMN( int32_t, follows, 1 ) ) /* the body is a surface */      \
    X( tracked, "collision.tracked", PARTICLE,                                                                       \
       WISP_COLUMN( int32_t, triangle, COLLISION_TRACKS ), /* closest; -1: none was near */                          \
       WISP_COLUMN( float, free, COLLISION_TRACKS ),       /* m, distance of `origin` at least */                    \
       WISP_COLUMN( wisp_vec3, origin, COLLISION_TRACKS ) /* m, in the frame of the body */ )                        \
    X( strand_tracked, "collision.strand_tracked", STRAND_ROW,                                                       \
       WISP_COLUMN( int32_t, triangle, 16 * COLLISION_TRACKS ),                                                      \
       /* [body][lane] */ WISP_COLUMN( float, free, 16 * COLLISION_TRACKS ),                                         \
       WISP_COLUMN( float, origin, 48 * COLLISION_TRACKS ) /* [body][x, y, z][lane] */ )                             \
    X( reaction, "collision.reaction", ENTITY, WISP_COLUMN( wisp_reaction, reaction, 1 ) ) /* of a body */           \
    X( coupled, "collision.coupled", ENTITY,                                                                         \
       WISP_COLUMN( collision_coupled, coupled, 1 ) ) /* of a body with a mass */                                    \
    X( reaction_part, "collision.reaction_part", ENTITY,                                                             \
       WISP_COLUMN( int32_t, first, 1 ) ) /* of their parts in the sums */                                           \
    X( contact_body, "collision.contact_body", PARTICLE,                                                             \
       WISP_COLUMN( int32_t, body, WISP_COLLISION_CONTACTS ) ) /* in the list */                                     \
    X( bounce, "collision.bounce", PARTICLE, WISP_COLUMN( float, bounce, WISP_COLLISION_CONTACTS ) ) /* m/s */       \
    X( all_features, "collision.all_features", ENTITY, WISP_COLUMN( int32_t, active_edges, 1 ),                      \
       /* those with contacts in this substep */ WISP_COLUMN( int32_t, active_triangles, 1 ),                        \
       WISP_COLUMN( int32_t, near_edges, 1 ),                                                                        \
       /* those that may have some in this step */ WISP_COLUMN( int32_t, near_triangles, 1 ),                        \
       WISP_COLUMN( float, longest, 1 ), /* m, somewhat more than the longest edge at rest */                        \
       WISP_COLUMN( float, pace, 1 ) /* times how far a particle may get in the step: its longest path */ )          \
    X( edge_contacts, "collision.edge_contacts", EDGE, WISP_COLUMN( int32_t, found, 1 ),                             \
       /* contacts, those left out included */ WISP_COLUMN( int32_t, active, 1 ), /* a list: those with contacts */  \
       WISP_COLUMN( int32_t, near, 1 ), /* a list: those that may have some in this step */                          \
       WISP_COLUMN( collision_primitive_contact, contacts, COLLISION_PRIMITIVE_CONTACTS ) )                          \
    X( triangle_contacts, "collision.triangle_contacts", TRIANGLE, /* likewise */ WISP_COLUMN( int32_t, found, 1 ),  \
       WISP_COLUMN( int32_t, active, 1 ), WISP_COLUMN( int32_t, near, 1 ),                                           \
       WISP_COLUMN( collision_primitive_contact, contacts, COLLISION_PRIMITIVE_CONTACTS ) )                          \
    X( clearance, "collision.clearance", PARTICLE, WISP_COLUMN( int32_t, words, 1 ),                                 \
       /* as in wisp_clear_args */ WISP_COLUMN( float, place, 4 ) )

/// Bodies and participants in the order in which they were added. Passes walk these lists, so results depend on
/// nothing else.
typedef struct collision_state
{
    COLLISION_COMPONENTS( WISP_COMPONENT_MEMBER )
    int track_count;   // bodies that are tracked
    int coupled_count; // of them
    bool has_trees, has_bouncy, wants_reactions;
    uint32_t stored_layers;  // of bodies whose contacts are stored
    collision_impulse* sums; // [part][body], zero between steps; null while no reaction is requested
    size_t sum_count, sum_capacity;
    collision_body* bodies;
    int body_count, body_capacity;
    const wisp_registry* registry; // of participants: surfaces and strands with settings
    bool has_strands;              // there was one with strands
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

// ---- participants: surfaces and strands that collide ----

/// Attach the components of contact to a participant that is enabled, while there is a body; detach them from others.
wisp_status collision_update_participant( wisp_world* world, const collision_state* state, wisp_entity participant );
/// The same of all, with what is noted of the bodies. Without memory nothing changes.
wisp_status collision_update_components( wisp_world* world, collision_state* state );
/// The same when one body came or went, which changes nothing for most participants.
wisp_status collision_update_for( wisp_world* world, collision_state* state, const collision_body* body );

/// Go on to the next participant, by index. @param participant null before the first one
static inline bool collision_next_participant( const collision_state* state, wisp_entity* participant )
{
    return wisp_next_entity( state->registry, state->settings, participant );
}

// ---- passes, each in the file that is named ----

wisp_pass_fn collision_update_poses;                                                // collision_bodies.c
wisp_pass_fn collision_follow;                                                      // collision_surface.c
wisp_pass_fn collision_find;                                                        // contact_generation.c
wisp_pass_fn collision_project;                                                     // contact_projection.c
wisp_pass_fn collision_keep_outside;                                                // closed_forms.c
wisp_pass_fn collision_find_primitives;                                             // primitive_contacts.c
wisp_pass_fn collision_project_primitives;                                          // primitive_projection.c
wisp_pass_fn collision_sense;                                                       // contact_input.c
wisp_pass_fn collision_bounce_off;                                                  // restitution.c
wisp_pass_fn collision_gather_impulses, collision_share_contacts;                   // reaction.c
wisp_pass_fn collision_couple, collision_read_reactions;                            // reaction.c
wisp_pass_fn collision_touch_strands, collision_part_strands;                       // strand_contacts.c
wisp_pass_fn collision_keep_out;                                                    // posed_strands.c
wisp_pass_fn collision_measure, collision_measure_strands, collision_measure_posed; // collision_stats.c
/// As wisp_pass.run_crowd, closed_forms.c.
void collision_keep_crowd_outside( wisp_frame* frame, const wisp_crowd* crowd, const wisp_span* span, void* user );
/// As wisp_state_hooks.lines, collision_lines.c.
void collision_add_lines( const void* state, wisp_world* world, wisp_entity entity, wisp_line_kind kind,
                          wisp_line_list* list );
