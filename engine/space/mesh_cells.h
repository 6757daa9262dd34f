/// Cells around a mesh that are known to be outside of it during its whole motion. Most queries of closed meshes come from points
/// outside that nothing is near; a cell answers them without a search, and without a ray that tells the side.
///
/// The surface cannot leave the boxes of its triangles over the motion. Cells that no such box meets and that are connected with
/// the outside of the grid through such cells are outside. What is enclosed, or shares a cell with the surface, is not known.
#pragma once

#include "mesh_surface.h"

enum
{
    MESH_CELLS_MAX = 64, // along an axis: a row along x is the bits of one number
};

typedef struct mesh_cells
{
    int capacity;          ///< cells along an axis
    int size[3];           ///< of them used; 0: nothing is known
    float origin[3], edge; ///< m
    float inverse;         ///< 1 / edge
    uint64_t* outside;     ///< [z][y] a bit for each x
    uint64_t* apart;       ///< the same: no cell around it has a part of the surface
    uint64_t* taken;       ///< the same: it may have a part of the surface
} mesh_cells;

wisp_status mesh_cells_create( mesh_cells* cells, const mesh_surface* surface, wisp_error* error );
/// Zero cells are allowed.
void mesh_cells_release( mesh_cells* cells, const mesh_surface* surface );
size_t mesh_cells_bytes( const mesh_cells* cells );

/// Fill the cells for the points of a surface.
void mesh_cells_fill( mesh_cells* cells, const mesh_surface* surface );

/// Return a lower bound of the distance of a point from the surface in the whole motion, m, if the point is outside; else -1.
float mesh_cells_clearance( const mesh_cells* cells, wisp_vec3 point );
