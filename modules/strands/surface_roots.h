// Roots on a surface.
#pragma once

#include "strands_state.h"

typedef struct strands_triangle
{
    wisp_vec3 corner[3];
} strands_triangle;

wisp_pass_fn strands_anchor, strands_anchor_frames;

/// Return the point of a triangle with barycentric coordinates.
wisp_vec3 strands_point_of( const strands_triangle* t, const float weights[3] );

/// Compute the frame of a triangle. @return false without an area
bool strands_triangle_frame( const strands_triangle* t, wisp_quat* out );

/// Store the corners of a root's triangle in its column.
void strands_put_corners( float* corner, int group, int lane, const strands_triangle* t );

/// Handle removed entities: roots of a removed surface stay in place.
void strands_entity_removed( void* state, wisp_world* world, wisp_entity entity );
/// As wisp_state_hooks.triangles_changed: roots go with their triangles.
wisp_status strands_triangles_changed( void* memory, wisp_world* world, wisp_entity surface,
                                       const wisp_fabric* before );

/// Handle teleports: strands go along with their head, or with the surface that they are rooted in.
wisp_status strands_teleported( void* state, wisp_world* world, wisp_entity entity,
                                const wisp_teleport_motion* teleport, bool* is_moved );
