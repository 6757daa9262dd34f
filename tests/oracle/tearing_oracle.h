/// Tearing of flat sheets in plain double precision, by angles and search: which triangles leave a vertex.
#pragma once

#include <stdbool.h>
#include <stdint.h>

/// A mesh that is flat at rest, with consistent winding.
typedef struct tearing_oracle_mesh
{
    const double ( *rest )[2];    ///< [vertex] m
    const int32_t ( *corner )[3]; ///< [triangle_count]
    int triangle_count;
} tearing_oracle_mesh;

/// N/m, of an edge that is pulled by a force: f l / (A_1 + A_2).
double tearing_oracle_tension( const tearing_oracle_mesh* mesh, int a, int b, double force );

typedef struct tearing_oracle_cut
{
    bool is_possible;
    bool is_inside; ///< no edge at the vertex is open
    int ends[2];    ///< of the edges that are cut; -1: one only
    double cost;    ///< mean |cos| of the angles between the edges that are cut and the pulled one
} tearing_oracle_cut;

/// Whether no edge at a vertex is open. A vertex at the rim that ends an edge that is cut has triangles on both sides of it, which part.
bool tearing_oracle_is_inside( const tearing_oracle_mesh* mesh, int vertex );
/// Cut the triangles at a vertex, which all hang together there, across the edge to a neighbour.
/// @param leaves [triangle_count] receives which triangles leave the vertex
tearing_oracle_cut tearing_oracle_cut_at( const tearing_oracle_mesh* mesh, int vertex, int neighbour, bool* leaves );
