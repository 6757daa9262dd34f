/// Edges and corners of a mesh that stick out, and their search by boxes.
#pragma once

#include "mesh_bvh.h"

/// Sine of the angle between the normals of two faces up to which they count as one plane.
#define MESH_FEATURES_PLANE 0.01

typedef struct mesh_features
{
    mesh_bvh boxes; ///< of a mesh whose search has none; else zero
    uint8_t*
        candidates; ///< [triangle_count] bits 0 .. 2: edges, 3 .. 5: corners that the triangle stands for; null: not built
} mesh_features;

/// @param needs_boxes build a hierarchy of boxes too
/// @param surface must not move in memory while the features exist
wisp_status mesh_features_build( mesh_features* features, const mesh_surface* surface, bool needs_boxes,
                                 wisp_error* error );
void mesh_features_release( mesh_features* features, const mesh_surface* surface );
size_t mesh_features_bytes( const mesh_features* features, const mesh_surface* surface );

/// As wisp_collision_mesh_find_features().
int mesh_features_find( const mesh_features* features, const mesh_bvh* boxes, const float lower[3],
                        const float upper[3], bool corners, int32_t* out, int capacity );

/// As wisp_collision_mesh_feature() and wisp_collision_mesh_sides().
wisp_mesh_feature mesh_features_place( const mesh_surface* surface, int32_t feature, bool is_corner, float begin,
                                       float end );
wisp_mesh_sides mesh_features_sides( const mesh_surface* surface, int32_t feature, bool is_corner, double time );
