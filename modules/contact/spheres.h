// Spheres that stand for surfaces and strands: vertices, and the points of layers.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"
#include "wisp/module/primitives.h"

enum
{
    CONTACT_SPHERE_PACK = 16, // pairs, or spheres, side by side
    CONTACT_SPHERE_ARRAY_COUNT = 17,
};

/// Pairs of spheres, as wisp_point_pair_args has them.
typedef struct contact_sphere_pairs
{
    int count, pack_count;
    int32_t* point_x4[2];
    float *gap, *friction;
    uint16_t* found;
    float *push, *shift; // of near pairs
    wisp_buffer buffers[7];
} contact_sphere_pairs;

typedef struct contact_spheres
{
    int count, pack_count;
    int strayed;             // spheres beyond the motion that the search assumed, in this substep
    int substeps, done;      // of the step from the search on; those that were begun
    float margin;            // factor, below 1 where there were too many pairs
    float largest_cover;     // m
    float common[3];         // m, mean motion of the step
    int32_t ( *parents )[3]; // [sphere] points; null: spheres are the points of the contact mesh
    float ( *weights )[3];   // [sphere] barycentric
    float *start, *now;      // [sphere][4] m, 1/kg; without parents those of the contact mesh
    float* friction;         // [sphere] root of the coefficient
    float* cover;            // [point] m, least distance that it keeps as a sphere
    float* pairs_of;         // [point] how many press on it
    uint32_t *key, *order;   // [2][sphere] places on a curve through space, and spheres in their order
    wisp_point_pack* packs;  // [pack] spheres in that order
    wisp_aabb* boxes;        // [pack]
    wisp_aabb_pairs overlaps;
    int32_t *first, *second;                  // [overlap] packs
    int32_t* pair_count;                      // [overlap] pairs of spheres
    uint16_t ( *found )[CONTACT_SPHERE_PACK]; // [overlap] as wisp_point_list_args has them
    contact_sphere_pairs listed, near;        // in this step, in this substep
    int active_count;
    int32_t* active;    // spheres of near pairs
    uint8_t* is_active; // [sphere] it is one of those
    wisp_buffer buffers[CONTACT_SPHERE_ARRAY_COUNT];
} contact_spheres;

/// Make the spheres of all participants and sort them.
wisp_status contact_make_spheres( const contact_work* work, wisp_error* error );

/// List the pairs of spheres for the rest of the step.
wisp_status contact_list_spheres( const contact_work* work, wisp_error* error );

/// Place the spheres at the start of a substep, count those that left the motion that the search assumed, and find near pairs.
wisp_status contact_begin_spheres( const contact_work* work, wisp_error* error );

/// Push spheres apart that are too near. @param is_last of the substep: recover too
void contact_push_spheres( const contact_work* work, bool is_last );

/// Copy the points of near pairs to the columns of surfaces. @param is_end of the substep: their shifts too
void contact_scatter_spheres( const contact_work* work, bool is_end );

/// Return the smallest distance of a pair over what it keeps.
float contact_least_sphere_gap( const contact_work* work );
