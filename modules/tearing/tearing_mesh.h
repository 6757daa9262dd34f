/// A mesh whose vertices split: triangles by slot, and which corners are at each vertex.
#pragma once

#include "wisp/module/module.h"

typedef struct tearing_mesh
{
    const wisp_fabric* fabric;
    int32_t* triangles;   ///< [triangle_count][3] slots
    int32_t* parents;     ///< [slot_count] of which slot of the fabric a vertex is a copy; itself
    int32_t *begin, *end; ///< [slot_count] corners of a vertex
    int32_t* corner;  ///< [3 triangle_count] 3 times triangle, and which corner; of a vertex in the order of its fans
    uint8_t* touched; ///< [slot_count] 1: near a split
    int spare_begin;  ///< vertices of the user below this one are in use
    void* memory;
    size_t bytes;
} tearing_mesh;

/// Consecutive corners of a vertex: corner i spans from spoke i to spoke i + 1.
typedef struct tearing_fan
{
    int32_t begin, end; ///< among the corners of the mesh
    bool is_closed;     ///< the last spoke is the first one
} tearing_fan;

/// @return false without memory
bool tearing_mesh_create( const wisp_fabric* fabric, const wisp_allocator* allocator, tearing_mesh* out );
void tearing_mesh_release( tearing_mesh* mesh, const wisp_allocator* allocator );

/// Put the corners of a vertex from `begin` on in the order of their next fan, and return that: open fans first, those with the lowest
/// triangle first.
tearing_fan tearing_next_fan( const tearing_mesh* mesh, int32_t vertex, int32_t begin );
/// @return the vertex at spoke `i` of a fan, 0 .. its triangles
int32_t tearing_spoke( const tearing_mesh* mesh, tearing_fan fan, int i );
/// @return how many fans the triangles of a vertex are
int tearing_count_fans( const tearing_mesh* mesh, int32_t vertex );

/// @return how many vertices are in no triangle
int tearing_count_spares( const tearing_mesh* mesh );
/// Move corners [begin, end) of a vertex to a new one, of which there is one left. They are at one end of its corners.
/// @return the new vertex
int32_t tearing_move_corners( tearing_mesh* mesh, int32_t vertex, int32_t begin, int32_t end );
