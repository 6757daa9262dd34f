/// A mesh with adjacency: the triangles at each point, and surface normals at points.
#pragma once

#include "mesh_triangle.h"

#include "wisp/module/collision_mesh.h"

typedef struct mesh_surface
{
    wisp_allocator allocator;
    int point_count, triangle_count;
    float* xyzw;              ///< [point_count][4] x, y, z, 0; of a mesh that deforms at the end of its motion
    float* start;             ///< [point_count][4] at its start; null for a rigid mesh
    int32_t* triangles;       ///< [triangle_count][3]
    float lower[3], upper[3]; ///< m, bounds of all points, of start and end
    double largest;           ///< m, maximum magnitude of a coordinate
    int32_t* ring_begin;      ///< [point_count + 1]
    int32_t* ring;            ///< [3 triangle_count] triangles at each point, in increasing order
    wisp_vec3*
        corner_normals; ///< [point_count] angle-weighted; null for a mesh that deforms, where they are computed on
                        ///< demand because few are used before the points change
    size_t bytes;
} mesh_surface;

/// Check and copy a mesh. The surface is zero after a failure.
wisp_status mesh_surface_build( mesh_surface* surface, const wisp_collision_mesh_def* def,
                                const wisp_allocator* allocator, wisp_error* error );
void mesh_surface_release( mesh_surface* surface );

/// Check that all points are finite and within range. The message gives the first that is not.
wisp_status mesh_surface_check_points( const wisp_vec3* points, int count, wisp_error* error );
/// Set the points at the end, and of a mesh that deforms at the start of a motion.
void mesh_surface_set_points( mesh_surface* surface, const wisp_vec3* start, const wisp_vec3* end );

int mesh_surface_count_open_edges( const mesh_surface* surface );
int mesh_surface_count_flat_triangles( const mesh_surface* surface );

/// Return the corners of a triangle at a time in [0, 1] of the motion. A rigid mesh has one place.
static inline triangle_corners mesh_surface_triangle( const mesh_surface* surface, int32_t triangle, double time )
{
    triangle_corners t = triangle_load( surface->xyzw, surface->triangles, triangle );
    if ( surface->start != NULL && time < 1.0 )
    {
        const triangle_corners from = triangle_load( surface->start, surface->triangles, triangle );
        for ( int k = 0; k < 3; ++k )
        {
            t.at[k] = double3_mul_add( double3_scale( from.at[k], 1.0 - time ), time, t.at[k] );
        }
    }
    return t;
}

/// Compute the box of a triangle, over its whole motion.
void mesh_surface_box( const mesh_surface* surface, int32_t triangle, float lower[3], float upper[3] );

/// Return the angle-weighted normal at a point, at a time of the motion.
double3 mesh_surface_corner_normal( const mesh_surface* surface, int32_t point, double time );

/// Complete a result with sign and normal of the feature nearest to p at a time of the motion.
void mesh_surface_describe( const mesh_surface* surface, int32_t triangle, double time,
                            const triangle_nearest* nearest, double3 p, wisp_mesh_nearest* out );

// ---- cells around a mesh that are known to be outside of it during its whole motion ----

// Most queries of closed meshes come from points
// outside that nothing is near; a cell answers them without a search, and without a ray that tells the side.
//
// A triangle cannot leave its box over the motion, nor the slab between its farthest corners. Cells that meet no
// triangle in this sense and that are connected with the outside of the grid through such cells are outside. What is
// enclosed, or shares a cell with the surface, is not known.

typedef struct mesh_cells
{
    int capacity;          ///< words of each set of cells
    int size[3];           ///< cells along the axes; 0: nothing is known
    int words;             ///< of a row along x
    float origin[3], edge; ///< m
    float inverse;         ///< 1 / edge
    uint64_t* outside;     ///< [z][y][words] a bit for each x
    uint64_t* taken;       ///< the same: it may have a part of the surface
} mesh_cells;

wisp_status mesh_cells_create( mesh_cells* cells, const mesh_surface* surface, wisp_error* error );
/// Zero cells are allowed.
void mesh_cells_release( mesh_cells* cells, const mesh_surface* surface );
size_t mesh_cells_bytes( const mesh_cells* cells );

/// Forget what is known.
void mesh_cells_empty( mesh_cells* cells );

/// Fill the cells for the points of a surface. @param parallel null: the calling thread
void mesh_cells_fill( mesh_cells* cells, const mesh_surface* surface, const wisp_parallel* parallel );

/// Return `near` if a point is outside and the surface stays farther than that in the whole motion, 0 if it is outside and
/// no more is known, and else -1.
float mesh_cells_clearance( const mesh_cells* cells, wisp_vec3 point, float near );
