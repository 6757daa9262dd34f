/// The least distance of the triangles of two meshes, in double precision: search by thirds of convex functions, and crossings of
/// edges with triangles.
#pragma once

#include "double3.h"

/// Distance of the closest points of two segments, m.
double mesh_gap_oracle_segments( const double3 a[2], const double3 b[2] );
/// Distance of a point from a triangle, m.
double mesh_gap_oracle_triangle( const double3 t[3], double3 p );
/// Whether a segment crosses a triangle.
bool mesh_gap_oracle_crosses( const double3 segment[2], const double3 t[3] );

/// A mesh.
typedef struct mesh_gap_oracle_mesh
{
    const double3* points;
    const int32_t* triangles; // [triangle_count][3]
    int triangle_count;
} mesh_gap_oracle_mesh;

/// @return m; -1 if a triangle of one crosses one of the other
double mesh_gap_oracle_find( const mesh_gap_oracle_mesh* a, const mesh_gap_oracle_mesh* b );
