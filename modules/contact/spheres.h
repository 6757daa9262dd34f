// Spheres that stand for surfaces and strands: vertices, and the points of layers.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"

/// A vertex of the contact mesh in one of its spheres.
typedef struct contact_share
{
    int32_t sphere;
    float weight;
} contact_share;

enum
{
    CONTACT_SPHERE_PACK = 16,  // spheres side by side
    CONTACT_SPHERE_GRAIN = 32, // packs of a task
    CONTACT_SPHERE_ARRAY_COUNT = 25,
};

typedef struct contact_spheres
{
    int count, pack_count;
    int substeps, done;      // of the step from the search on; those that were begun
    float common[3];         // m, mean motion of the step
    float largest_cover;     // m
    float margin;            // factor, below 1 where there were too many pairs
    int32_t ( *parents )[3]; // [sphere] points
    float ( *weights )[3];   // [sphere] barycentric
    float ( *rest )[4];      // [sphere] m; the fourth is the index of the participant
    float (
        *traits )[4]; // [sphere] m, half of its thickness; m, least distance; root of the friction; 1: it is pinned
    float ( *motion )[4]; // [sphere] m, predicted for the step; the fourth is how far it may stray from that
    float ( *middle )[3]; // [sphere] m, in the middle of that motion
    wisp_aabb* boxes;     // [sphere] around it
    wisp_aabb_pairs overlaps;
    float *start, *now, *push, *shift;     // [sphere][4] as wisp_point_pair_args has them
    float* count_of;                       // [sphere] pairs that press on it
    int32_t *begin, *near_count;           // [pack + 1], [pack] as there
    int32_t *other_x4, *near;              // [row][16], [row] likewise
    float* gap;                            // [row][16] likewise
    uint16_t* presses;                     // [row] likewise
    int32_t *active_packs, *active_points; // packs with a near pair in this substep; points in their spheres
    int active_pack_count, active_point_count;
    uint8_t* is_active;    // [point]
    float* cover;          // [point] m, least distance that it keeps as a sphere
    float* inverse_mass;   // [point] 1/kg, times the pairs that press on it
    int32_t* share_begin;  // [point + 1]
    contact_share* shares; // of each point, the spheres that it is in
    wisp_buffer buffers[CONTACT_SPHERE_ARRAY_COUNT];
} contact_spheres;

/// Make the spheres of all participants and list their pairs for the rest of the step.
wisp_status contact_list_spheres( const contact_work* work, wisp_error* error );

/// Place the spheres at the start of a substep, and count those that left the motion that the search assumed.
void contact_begin_spheres( const contact_work* work );

/// Push spheres apart that are too near. @param is_last of the substep: recover too
void contact_push_spheres( const contact_work* work, bool is_last );

/// Compute the position of a sphere.
void contact_place_sphere( const contact_spheres* s, const float* xyzw, int sphere, float out[3] );

/// Return the smallest distance of a pair over what it keeps.
float contact_least_sphere_gap( const contact_work* work );
