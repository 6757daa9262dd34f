/// From a mesh to linked pairs: intermediate data of cooking.
#pragma once

#include "implicit_internal.h"

/// Two linked slots, a < b.
typedef struct implicit_pair
{
    int32_t a, b;
    float area;                          ///< m^2, of the triangles at the edge, or at the diagonal
    float rest;                          ///< m
    float load, ramp, ramp_end, damping; ///< as in wisp_spring_links
} implicit_pair;

typedef struct implicit_cook
{
    wisp_world* world;
    const wisp_allocator* allocator;
    const wisp_fabric* fabric;
    implicit_pair *stretch, *bend; ///< sorted
    int stretch_count, bend_count;
    int32_t* neighbours; ///< [vertex_count] |N| by slot
    int max_neighbours;
    void* blocks[16];
    size_t bytes[16];
    int block_count;
} implicit_cook;

/// Zeroed memory until implicit_cook_release(). @return null without memory
void* implicit_cook_push( implicit_cook* cook, size_t count, size_t size );
void implicit_cook_release( implicit_cook* cook );

/// Fill in pairs, neighbours and coefficients, or refuse with a message.
wisp_status implicit_list_pairs( implicit_cook* cook, const wisp_implicit_cloth_def* def );
/// Fraction of a vertex's mass in its row: 1 over the weight of its forces, or 1.
float implicit_mass_fraction( const implicit_cook* cook, const wisp_implicit_cloth_def* def, int32_t slot );
