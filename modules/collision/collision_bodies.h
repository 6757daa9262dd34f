// Bodies: their list, and their poses in a substep.
#pragma once

#include "collision_state.h"

#include "wisp/module/sleep.h"

/// Return a number for a body that stays from step to step, is not 0, and differs between a million entities.
static inline int32_t collision_body_name( wisp_entity entity )
{
    const uint32_t name = ( entity.index + ( entity.generation << 20 ) ) & INT32_MAX;
    return name != 0 ? (int32_t)name : 1;
}

/// A body in one substep, with the thickness and friction of a pair of body and participant.
typedef struct collision_view
{
    const collision_body* body;
    wisp_transform before, after; // at the start and at the end of the substep
    float thickness;              // m, sum of both
    float static_friction, kinetic_friction;
    float begin, end; // the same of a surface, as times of its motion in the step
    float shift;      // m, most that the body's origin, or a point of a surface, moves in the step
    float turn;       // most that a point of the body moves besides, in lengths of its distance from the origin
    float restitution;
} collision_view;

/// Iterate over the bodies that the span's entity collides with in its substep. Start with *next = 0.
/// @return false behind the last
bool collision_next( wisp_frame* frame, const wisp_span* span, const collision_state* state, int* next,
                     collision_view* out );

/// Compute bounds of the motion of a rigid body in a step: shift and turn of its view.
void collision_set_motion( const collision_collider* collider, collision_view* view );

/// Return whether segments of strands meet a body. They do not where vertices at the thickness h from a surface of radius r keep
/// segments at 3/4 of it or more: ( r + h )^2 - L^2 / 4 >= ( r + 3 h / 4 )^2.
/// @param longest m, of the segments; infinite: they meet it in any case
static inline bool collision_meets_segments( const collision_body* body, float thickness, float longest )
{
    const bool has_sides = body->tree != NULL || body->shape.kind != WISP_SHAPE_PLANE;
    return has_sides && longest * longest > thickness * ( 2.0f * body->bluntness + 1.75f * thickness );
}

/// Return the most that a point of a surface moves in the substep, m; 0 for a rigid body, whose points move with their frame.
static inline float collision_surface_shift( const collision_view* view )
{
    return view->body->follows ? view->shift * ( view->end - view->begin ) : 0.0f;
}

/// Check that points are within range, and compute the bounds of a body around them.
wisp_status collision_check_points( wisp_world* world, const wisp_collider_def* d );
void collision_measure_points( const wisp_collider_def* d, collision_body* body );

// solid_bodies.c
wisp_status collision_make_convex( wisp_world* world, const wisp_collider_def* d, collision_body* body );
wisp_status collision_make_height_field( wisp_world* world, const wisp_collider_def* d, collision_body* body );

/// Free the mesh, hull, heights or points of a body.
void collision_release_body( const wisp_allocator* allocator, collision_body* body );
/// Return the bytes of its hull, heights or points.
size_t collision_body_bytes( const collision_body* body );

/// Remove a body from the list and free what it owns.
/// @param forgotten receives the body @return whether it was there
bool collision_forget_body( collision_state* state, const wisp_allocator* allocator, wisp_entity entity,
                            collision_body* forgotten );

/// Return twice the volume within a mesh over its area, m: the radius of a rod, the width of a plate, two thirds of the radius of a ball.
float collision_bluntness( const wisp_vec3* points, const int32_t* triangles, int count );

/// As wisp_sleep_hooks.surroundings: the bodies within reach of an entity's bounds.
bool collision_surroundings( const void* state, wisp_world* world, wisp_entity entity,
                             const wisp_sleep_bounds* bounds, uint64_t* hash );

// ---- bodies that are surfaces of the world ----

/// Build the mesh of a surface, at the points where it is.
/// @return WISP_BAD_INPUT the mesh is open or faces inwards; WISP_CONFLICT the entity is no surface; WISP_STALE_ID;
///         WISP_NO_MEMORY
wisp_status collision_make_surface( wisp_world* world, const wisp_collider_def* def, collision_body* body );

/// Have the body follow its surface, and the surface move.
wisp_status collision_follow_surface( wisp_world* world, const collision_state* state, wisp_entity body,
                                      wisp_entity surface );

/// Free the points of a body, if it has any.
void collision_release_points( const wisp_allocator* allocator, collision_body* body );
/// Return the bytes of one of its two arrays of points.
static inline size_t collision_points_bytes( const collision_body* body )
{
    return (size_t)body->point_count * sizeof( wisp_vec3 );
}

/// Bodies of a surface that is about to be removed collide with nothing.
void collision_forget_surface( collision_state* state, wisp_entity surface );
