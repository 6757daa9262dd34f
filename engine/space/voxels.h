/// Search by voxels: a grid of cubes over the box of a mesh, each with a list of the triangles that touch it (Zhang and
/// Yuen 2000). A query for a point visits its own voxel and then those around it, ring by ring, until nothing
/// nearer is possible; a path visits the voxels that it crosses.
#pragma once

#include "alloc.h"
#include "mesh_search.h"

/// So many voxels of an edge make a block, of which a mask tells which voxels have triangles.
#define VOXELS_BLOCK 4

/// Zero-initialise, then say what is asked for. Everything is double: single roundings of large coordinates would be
/// as wide as small voxels.
typedef struct voxels
{
    double size_queried; ///< m; 0: the mean edge
    size_t max_bytes;    ///< 0: no limit
    double lower[3];     ///< m, where the first voxel begins
    double size;         ///< m, edge of a voxel
    double per_metre;    ///< voxels, the inverse
    double
        widening; ///< m: triangles are in the lists of all voxels that are so near, more than all roundings come to
    int count[3]; ///< voxels along each axis
    int blocks[3];
    int voxel_count, block_count, build_count;
    bool coarse;        ///< larger than asked for
    wisp_buffer begins; ///< int32_t [voxel_count + 1]
    wisp_buffer lists;  ///< int32_t, triangles of one voxel after another, ascending in each
    wisp_buffer masks;  ///< uint64_t [block_count], a bit for each voxel that has a triangle
} voxels;

/// List the triangles of a surface again.
/// @return WISP_NO_MEMORY the lists are of no use until a build succeeds, which one of the surface they were last built
///         for does
wisp_status voxels_build( voxels* v, const mesh_surface* surface, wisp_error* error );
void voxels_release( voxels* v, const wisp_allocator* allocator );

/// Bytes of the lists and masks.
size_t voxels_bytes( const voxels* v );

void voxels_find_closest( const voxels* v, mesh_closest* search );
void voxels_find_intersection( const voxels* v, mesh_cast* search );

/// The voxel of a coordinate along an axis; what is outside belongs to the first or the last.
static inline int voxels_at( const voxels* v, int axis, double x )
{
    double at = ( x - v->lower[axis] ) * v->per_metre, last = (double)( v->count[axis] - 1 );
    return at > 0.0 ? (int)( at < last ? at : last ) : 0;
}

static inline int32_t voxels_number( const voxels* v, int x, int y, int z )
{
    return ( z * v->count[1] + y ) * v->count[0] + x;
}
