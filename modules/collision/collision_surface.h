// Bodies that are surfaces of the world.
#pragma once

#include "collision_bodies.h"

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
