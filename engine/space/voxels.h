/// Search by voxels: a grid of cubes over the box of a mesh, each with a list of the triangles that touch it (Zhang
/// and Yuen 2000). A point query visits its own voxel and then rings around it, until nothing nearer is possible. A
/// path visits the voxels that it crosses.
#pragma once

#include "alloc.h"
#include "mesh_search.h"

/// Voxels along the edge of a block. One mask per block marks the voxels that have triangles.
#define VOXELS_BLOCK 4

/// Zero-initialise, then set the requested values. All coordinates are doubles: float rounding of large coordinates
/// would be as wide as small voxels.
typedef struct voxels
{
    double size_queried; ///< m; 0: mean edge length
    size_t max_bytes;    ///< 0: no limit
    double lower[3];     ///< m, lower corner of the first voxel
    double size;         ///< m, edge of a voxel
    double per_metre;    ///< 1/m, voxels per metre
    double widening;     ///< m, more than the rounding error: a triangle is listed in all voxels within this distance
    int count[3];        ///< voxels along each axis
    int blocks[3];
    int voxel_count, block_count, build_count;
    bool coarse;        ///< voxels are larger than requested
    wisp_buffer begins; ///< int32_t [voxel_count + 1]
    wisp_buffer lists;  ///< int32_t, triangles of each voxel in increasing order
    wisp_buffer masks;  ///< uint64_t [block_count], one bit per voxel that has a triangle
} voxels;

/// Rebuild the lists for a surface.
/// @return WISP_NO_MEMORY the lists are invalid until a build succeeds; a build for the previous surface always
/// does
wisp_status voxels_build( voxels* v, const mesh_surface* surface, wisp_error* error );
void voxels_release( voxels* v, const wisp_allocator* allocator );

/// Return the size of lists and masks in bytes.
size_t voxels_bytes( const voxels* v );

void voxels_find_closest( const voxels* v, mesh_closest* search );
void voxels_find_intersection( const voxels* v, mesh_cast* search );

/// Return the voxel of a coordinate along an axis; clamped to the grid.
static inline int voxels_at( const voxels* v, int axis, double x )
{
    double at = ( x - v->lower[axis] ) * v->per_metre, last = (double)( v->count[axis] - 1 );
    return at > 0.0 ? (int)( at < last ? at : last ) : 0;
}

static inline int32_t voxels_number( const voxels* v, int x, int y, int z )
{
    return ( z * v->count[1] + y ) * v->count[0] + x;
}
