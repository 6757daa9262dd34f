/// Small meshes for the tests of cloth and balloons, made from scratch, and the topology of a mesh: its edges and its
/// bend pairs. Triangles are counter-clockwise seen from outside.
#pragma once

#include "double3.h"

#include <stdbool.h>

typedef struct balloon_mesh
{
    int vertex_count, triangle_count;
    double3* positions; ///< [vertex_count], m
    int* triangles;     ///< [3 * triangle_count]
} balloon_mesh;

// Functions that make meshes. Each returns false when memory runs out; then nothing needs to be destroyed.

bool balloon_mesh_two_triangles( balloon_mesh* mesh, double edge ); ///< open, equilateral, flat, share the edge 0 1
bool balloon_mesh_tetrahedron( balloon_mesh* mesh, double edge );   ///< regular, V = edge^3 / (6 sqrt 2)
bool balloon_mesh_cube( balloon_mesh* mesh, double edge );          ///< twelve triangles, a corner at the origin

/// Two tetrahedra that share a triangle which is not a face: the edges of that triangle have three common neighbours.
bool balloon_mesh_bipyramid( balloon_mesh* mesh, double edge );

/// 20 * 4^level triangles, vertices on the sphere.
bool balloon_mesh_icosphere( balloon_mesh* mesh, int level, double radius );

/// An icosphere drawn out to one side and dented: closed, genus 0, no symmetry. Replaces the scanned figure of the
/// paper.
bool balloon_mesh_pear( balloon_mesh* mesh, int level, double radius );

/// A torus about the y axis, genus 1: around * across * 2 triangles.
bool balloon_mesh_torus( balloon_mesh* mesh, int around, int across, double radius, double tube );

/// Both meshes in one, the second moved.
bool balloon_mesh_join( balloon_mesh* mesh, const balloon_mesh* a, const balloon_mesh* b, double3 move_b );

void balloon_mesh_destroy( balloon_mesh* mesh );

/// Find the vertex farthest along a direction. Ties go to the lowest index.
int balloon_mesh_farthest( const balloon_mesh* mesh, double3 direction );

/// One edge and the vertices opposite to it.
typedef struct balloon_mesh_edge
{
    int a, b;        ///< a < b
    int uses;        ///< triangles at the edge: 1 open edge, 2 interior, more than 2 non-manifold
    int triangle[2]; ///< the first two, in ascending order; -1 when there is none
    int opposite[2]; ///< their third vertices; -1 when there is none
} balloon_mesh_edge;

/// The edges of a mesh in ascending order of (a, b), and how many are open.
typedef struct balloon_mesh_topology
{
    int edge_count;
    balloon_mesh_edge* edges;
    int* triangle_edge; ///< [3 * triangle_count], the edge from corner k to k + 1
    int border_count;   ///< edges with one triangle: the mesh is open
} balloon_mesh_topology;

/// @return false when memory runs out; then nothing needs to be destroyed
bool balloon_mesh_build_topology( const balloon_mesh* mesh, balloon_mesh_topology* topology );

void balloon_mesh_destroy_topology( balloon_mesh_topology* topology );

/// Structural springs: every edge once.
/// @param pairs receives [2 * edge_count]
/// @return number of pairs
int balloon_mesh_structural_pairs( const balloon_mesh_topology* topology, int* pairs );

/// Bend springs: the two vertices across every edge of exactly two faces (from the faces, not from common
/// neighbours).
/// @param pairs receives at most [2 * edge_count]
/// @return number of pairs
int balloon_mesh_bend_pairs( const balloon_mesh_topology* topology, int* pairs );

/// Close every hole with a fan of real triangles around a new vertex at the mean of its border (`allow_open`). New
/// vertices and triangles follow the old ones.
/// @param hub receives [vertex_count of the open mesh] the new vertex of the border that the vertex is on, -1
///        elsewhere
/// @return false when a border is not a set of simple loops, or when memory runs out; then nothing needs to be destroyed
bool balloon_mesh_cap( const balloon_mesh* mesh, balloon_mesh* capped, int* hub );

/// Volume with every hole closed by a fan around the mean of its border vertices (`allow_open`).
/// @return false when a border is not a set of simple loops, or when memory runs out
bool balloon_mesh_capped_volume( const balloon_mesh* mesh, double* volume );
