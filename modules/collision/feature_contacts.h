// Contacts of edges and triangles of a surface with the corners and edges of a mesh or a height field.
#pragma once

#include "body_queries.h"
#include "primitive_contacts.h"

/// Return whether a body has edges and corners of its own: a mesh, a surface or a height field.
static inline bool collision_has_features( const collision_body* body )
{
    return body->tree != NULL || body->shape.kind == WISP_SHAPE_HEIGHT_FIELD;
}

/// Find where an edge meets edges of such a body, or a triangle its corners: the two that come first, else the two that are nearest at
/// the end of the path. @param out [COLLISION_PRIMITIVE_CONTACTS] @return how many
int collision_meet_features( const collision_view* view, const primitive_path* path, collision_meeting* out );

/// Find the closest points of an edge and another edge, or of a triangle and a point.
/// @param corners [count] of the primitive, 2 or 3 @param ends of the feature; of a point twice the same
/// @param weights [3] receives those of the corners @param along receives where on the edge, 0 .. 1
/// @return distance, m
double collision_closest_feature( const wisp_vec3* corners, int count, const wisp_vec3 ends[2], float* weights,
                                  float* along );
