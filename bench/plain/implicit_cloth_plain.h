/// Cloth by an implicit step in scalar C: springs in the order of the mesh, a matrix of 3 x 3 blocks in compressed
/// rows that is assembled in every step, conjugate gradients with the inverted blocks of its diagonal. One thread,
/// float, sums of products in double. The engine is compared with this on the same scene.
#pragma once

#include "wisp/base.h"

typedef struct plain_spring
{
    int a, b;
    bool bends;    ///< resists compression, like an arc; otherwise resists stretch
    float rest;    ///< m
    int to_a_of_b; ///< blocks of the matrix: row a, column b
    int to_b_of_a;
} plain_spring;

/// Material and solver parameters: the engine's wisp_implicit_cloth_def without its switches.
typedef struct plain_implicit_material
{
    float stretch_stiffness;     ///< k_s, N/m
    float bend_stiffness;        ///< k_b, N m^2
    float compression_stiffness; ///< c_b, N/m
    float damping;               ///< k_d, N s/m
    float area_density;          ///< kg/m^2
    wisp_vec3 gravity;           ///< m/s^2
    float tolerance;             ///< of a solve: its residual relative to that of zero velocity
} plain_implicit_material;

typedef struct plain_block
{
    float m[3][3];
} plain_block;

typedef struct plain_implicit_cloth
{
    plain_implicit_material material;
    int vertex_count;
    wisp_vec3* vectors; ///< the memory of all vectors below
    wisp_vec3 *position, *velocity;
    float* mass; ///< kg, m |N| / max |N|
    bool* pinned;

    plain_spring* springs; ///< edges, then diagonals
    int spring_count, edge_count;

    int* row_begin;       ///< [vertex_count + 1]
    int* column;          ///< of each block, ascending within a row, including the diagonal
    int* diagonal;        ///< [vertex_count] the block of a row's own column
    plain_block* block;   ///< [row_begin[vertex_count]] kg
    plain_block* inverse; ///< [vertex_count] of the diagonal blocks, 1/kg

    wisp_vec3* change; ///< m/s, of the last step: the next one starts from it
    wisp_vec3 *right, *residual, *direction, *product, *search;
    int iterations; ///< of the last step
    int64_t iterations_all;
    bool is_solved; ///< the last step ended at its tolerance
} plain_implicit_cloth;

/// @param triangles [triangle_count][3]
/// @return false without memory
bool plain_implicit_cloth_create( plain_implicit_cloth* cloth, const wisp_vec3* points, int vertex_count,
                                  const int32_t* triangles, int triangle_count,
                                  const plain_implicit_material* material );
void plain_implicit_cloth_destroy( plain_implicit_cloth* cloth );
void plain_implicit_cloth_pin( plain_implicit_cloth* cloth, int vertex );
void plain_implicit_cloth_step( plain_implicit_cloth* cloth, float seconds );
