/// Strands in scalar C: an array of float3, one strand after another on one thread, root pinned. They keep their
/// length by a sweep of distances or by the tridiagonal system of the whole strand, and bend by distances between
/// vertices two apart. The engine is compared with this on the same scene.
#pragma once

#include "wisp/base.h"

#define PLAIN_STRAND_VERTICES_MAX 256

typedef enum plain_strand_stretch
{
    PLAIN_STRAND_SWEEP,       ///< one sweep of distances from the root to the tip
    PLAIN_STRAND_TRIDIAGONAL, ///< Newton passes, each the tridiagonal system J W J^T dlambda = -C
} plain_strand_stretch;

typedef struct plain_strands
{
    int strand_count, vertices; ///< all strands have this number of vertices
    wisp_vec3* position;        ///< [strand_count][vertices] m
    wisp_vec3* previous;        ///< m
    wisp_vec3* velocity;        ///< m/s
    float* inverse_mass;        ///< 1/kg, 0 is pinned
    float* length;              ///< m, from a vertex to the next
    float* pair;                ///< m, from a vertex to the second next
    wisp_vec3 gravity;          ///< m/s^2
    float bend_compliance;      ///< m/N
    bool bends;
    plain_strand_stretch stretch;
    int passes; ///< of the tridiagonal system, >= 1
    int substeps;
} plain_strands;

/// Make strands at rest in the given shape. A vertex has half the mass of each of its segments; roots are pinned.
/// @param points [strand_count][vertices] @param vertices 2 .. PLAIN_STRAND_VERTICES_MAX @param line_density kg/m
/// @return false without memory, or with another number of vertices
bool plain_strands_create( plain_strands* strands, const wisp_vec3* points, int strand_count, int vertices,
                           float line_density );
void plain_strands_destroy( plain_strands* strands );

/// One step of substeps: predict, bend, stretch, velocity.
void plain_strands_step( plain_strands* strands, float seconds );
