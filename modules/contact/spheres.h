// Spheres that stand for surfaces and strands: vertices, and the points of layers.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/aabb_pairs.h"

#include <string.h>

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
    CONTACT_SPHERE_ARRAY_COUNT = 30,
};

/// Spheres with near pairs, in packs of sixteen, as wisp_point_pair_args has them.
typedef struct contact_near_spheres
{
    int count, pack_count;
    int32_t *own_x4, *begin, *other_x4;
    float *gap, *count_of, *push, *shift;
    uint16_t* presses;
} contact_near_spheres;

typedef struct contact_spheres
{
    int count, pack_count;
    int strayed;             // spheres beyond the motion that the search assumed, in this substep
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
    float *start, *now;          // [sphere][4] as wisp_point_pair_args has them
    int32_t* own_x4;             // [sphere] itself, times 4, as in wisp_point_pair_args
    int32_t *begin, *other_x4;   // as there, of all listed pairs
    float* gap;                  // likewise
    uint16_t* is_near;           // [row] a bit for each pair that is near in this substep
    contact_near_spheres active; // those that have one, and their near pairs
    int32_t* slot;               // [sphere] its place in `active`; -1: it has none
    int32_t* active_points;      // points in active spheres
    int active_point_count;
    uint8_t* is_active;    // [point]
    float* cover;          // [point] m, least distance that it keeps as a sphere
    float* inverse_mass;   // [point] 1/kg, times the pairs that press on it
    int32_t* share_begin;  // [point + 1]
    contact_share* shares; // of each point, the spheres that it is in
    wisp_buffer buffers[CONTACT_SPHERE_ARRAY_COUNT];
} contact_spheres;

/// Make the spheres of all participants and list their pairs for the rest of the step.
wisp_status contact_list_spheres( const contact_work* work, wisp_error* error );

/// Place the spheres at the start of a substep, count those that left the motion that the search assumed, and find near pairs.
wisp_status contact_begin_spheres( const contact_work* work, wisp_error* error );

/// Push spheres apart that are too near. @param is_last of the substep: recover too
void contact_push_spheres( const contact_work* work, bool is_last );

/// Compute the position of a sphere.
static inline void contact_place_sphere( const contact_spheres* s, const float* xyzw, int sphere, float out[3] )
{
    const int32_t* parents = s->parents[sphere];
    const float* weights = s->weights[sphere];
    const float* at = xyzw + (size_t)parents[0] * 4;
    memcpy( out, at, 3 * sizeof( *out ) );
    for ( size_t k = 0; k < 3 && weights[0] != 1.0f; ++k )
    {
        out[k] += weights[1] * ( xyzw[(size_t)parents[1] * 4 + k] - at[k] ) +
                  weights[2] * ( xyzw[(size_t)parents[2] * 4 + k] - at[k] );
    }
}

/// Return the smallest distance of a pair over what it keeps.
float contact_least_sphere_gap( const contact_work* work );
