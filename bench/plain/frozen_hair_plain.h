/// Frozen hair in competent scalar C: one thread, float, an array of points in strand order, a hash grid rebuilt
/// every clumping iteration. The engine is compared with this, and it is not slow on purpose: a repeated run
/// allocates nothing and recomputes nothing that a scalar program would keep.
///
/// Same equations, defaults and random numbers as the oracle in tests/oracle. Fixed here: direction from the mean,
/// reach by the tip, base shape at rest, epsilon 0.
#pragma once

#include "wisp/base.h"

typedef enum plain_hair_blend
{
    PLAIN_HAIR_BLEND_ARC,
    PLAIN_HAIR_BLEND_CHORD,
} plain_hair_blend;

typedef enum plain_hair_gap
{
    PLAIN_HAIR_GAP_ABSOLUTE,
    PLAIN_HAIR_GAP_SIGNED,
    PLAIN_HAIR_GAP_REVERSED,
    PLAIN_HAIR_GAP_NONE,
} plain_hair_gap;

typedef enum plain_hair_gap_reference
{
    PLAIN_HAIR_GAP_REFERENCE_STAGE,
    PLAIN_HAIR_GAP_REFERENCE_ITERATION,
} plain_hair_gap_reference;

/// Start from plain_frozen_hair_default_options().
typedef struct plain_frozen_hair_options
{
    float theta_max;      ///< rad, default pi / 4
    wisp_vec3 cursor;     ///< m
    float cursor_radius;  ///< m, default 0.15
    float clump_radius;   ///< m, h, default 0.01
    int clump_iterations; ///< K, default 4; 0 leaves the clumping out
    float clump_step;     ///< m, sigma, default 0.1 h
    float min_distance;   ///< m, r_min, default 0.02 h
    float lambda_min;     ///< default 0
    float length_floor;   ///< share of the rest length, default 0.05
    int dimension;        ///< 2 or 3, default 3
    plain_hair_blend blend;
    plain_hair_gap gap;
    plain_hair_gap_reference gap_reference;
    bool min_distance_clamp; ///< default on
    bool deform, align;      ///< default on
    uint64_t seed;
    uint64_t event;
} plain_frozen_hair_options;

/// A uniform grid of cells a little wider than h, hashed, filled by counting sort.
typedef struct plain_hair_grid
{
    int bucket_count;    ///< a power of two
    int* bucket_begin;   ///< [bucket_count + 1]
    int* entry_vertex;   ///< [vertex_count], by bucket
    uint64_t* entry_key; ///< [vertex_count], cell of each entry: buckets are shared by cells
    uint64_t* cell_key;  ///< [vertex_count], by vertex
} plain_hair_grid;

typedef struct plain_frozen_hair
{
    plain_frozen_hair_options options; ///< may be changed between runs: cursor, event, seed and all others
    int strand_count;
    int vertex_count;
    int* offsets;             ///< [strand_count + 1]
    int* strand_of;           ///< [vertex_count]
    wisp_vec3* rest;          ///< [vertex_count], m
    float* stretch_stiffness; ///< [strand_count]
    float* bend_stiffness;    ///< [strand_count]
    float* intensity;         ///< [strand_count]
    wisp_vec3* deformed;      ///< [vertex_count], p'
    wisp_vec3* aligned;       ///< [vertex_count], p''
    wisp_vec3* position;      ///< [vertex_count], the result
    wisp_vec3* step;          ///< [vertex_count]
    wisp_vec3* tentative;     ///< [vertex_count]
    plain_hair_grid aligned_grid;
    plain_hair_grid grid;
} plain_frozen_hair;

plain_frozen_hair_options plain_frozen_hair_default_options( void );

/// Copy a strand set and allocate everything that runs need.
/// @param offsets [strand_count + 1], offsets[0] = 0, never falling
/// @param xyz [offsets[strand_count]][3], m; z is 0 with dimension 2, whose grid is flat
/// @param stretch_stiffness, bend_stiffness, intensity [strand_count]; null means 7, 7 and 0.8 for every strand
/// @return false when memory runs out, and then there is nothing to destroy
bool plain_frozen_hair_create( plain_frozen_hair* hair, int strand_count, const int* offsets, const float* xyz,
                               const float* stretch_stiffness, const float* bend_stiffness, const float* intensity,
                               const plain_frozen_hair_options* options );

/// Run one user command, from rest to hair->position. Neighbours within h are exact while coordinates stay below 4000
/// h.
/// @return false, and nothing is run, when a parameter, a stiffness or a coordinate is outside the method's limits
bool plain_frozen_hair_run( plain_frozen_hair* hair );

/// Mean number of vertices of other strands within h of a vertex of p'' of the last run: the density of the scene.
double plain_frozen_hair_mean_neighbours( plain_frozen_hair* hair );

void plain_frozen_hair_destroy( plain_frozen_hair* hair );
