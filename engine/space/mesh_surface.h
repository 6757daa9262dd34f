/// A mesh with its neighbourhoods: which triangles meet at a point, and the direction of the surface there.
#pragma once

#include "mesh_triangle.h"

#include "wisp/collision_mesh.h"

typedef struct mesh_surface
{
    wisp_allocator allocator;
    int point_count, triangle_count;
    float* xyzw;              ///< [point_count][4] x, y, z, 0
    int32_t* triangles;       ///< [triangle_count][3]
    float lower[3], upper[3]; ///< m, box around all points
    double largest;           ///< m, coordinate
    int32_t* ring_begin;      ///< [point_count + 1]
    int32_t* ring;            ///< [3 triangle_count] triangles around a point, ascending
    wisp_vec3*
        corner_normals; ///< [point_count] angle-weighted; null for a mesh that deforms, where they are computed
                        ///< when asked for: most never are before the points move again
    size_t bytes;
} mesh_surface;

/// Check and copy a mesh. A failed call leaves the surface zero.
wisp_status mesh_surface_build( mesh_surface* surface, const wisp_collision_mesh_def* def,
                                const wisp_allocator* allocator, wisp_error* error );
void mesh_surface_release( mesh_surface* surface );

/// Check that all points are finite and within range. The message names the first that is not.
wisp_status mesh_surface_check_points( const wisp_vec3* points, int count, wisp_error* error );
void mesh_surface_set_points( mesh_surface* surface, const wisp_vec3* points );

/// Update bounds and largest coordinate after points were written.
void mesh_surface_find_extent( mesh_surface* surface );

int mesh_surface_count_open_edges( const mesh_surface* surface );
int mesh_surface_count_flat_triangles( const mesh_surface* surface );

/// Complete an answer: sign and normal of the nearest feature to p.
void mesh_surface_describe( const mesh_surface* surface, int32_t triangle, const triangle_nearest* nearest, double3 p,
                            wisp_mesh_nearest* out );
