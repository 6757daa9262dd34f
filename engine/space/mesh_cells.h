/// Cells around a mesh that are known to be outside of it during its whole motion. Most queries of closed meshes come from points
/// outside that nothing is near; a cell answers them without a search, and without a ray that tells the side.
///
/// A triangle cannot leave its box over the motion, nor the slab between its farthest corners. Cells that meet no
/// triangle in this sense and that are connected with the outside of the grid through such cells are outside. What is
/// enclosed, or shares a cell with the surface, is not known.
#pragma once

#include "mesh_surface.h"

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
