// Spheres that stand for surfaces and strands: vertices, and the points of layers.
#pragma once

#include "contact_mesh.h"

#include "wisp/module/primitives.h"

/// A vertex of the contact mesh in one of its spheres.
typedef struct contact_share
{
    int32_t sphere;
    float weight;
} contact_share;

enum
{
    CONTACT_SPHERE_PACK = 16, // spheres side by side
    CONTACT_SPHERE_ARRAY_COUNT = 24,
};

typedef struct contact_spheres
{
    int count, pack_count;
    int capacity;                // rows of pairs per pack
    int substeps, done;          // of the step from the search on; those that were begun
    float largest;               // m, distance that two of them keep at most
    int64_t candidates;          // pairs listed, times two
    float common[3];             // m, mean motion of the step
    int32_t ( *parents )[3];     // [sphere] points
    float ( *weights )[3];       // [sphere] barycentric
    float ( *rest )[4];          // [sphere] m; the fourth is the index of the participant
    float ( *traits )[4];        // [sphere] m, half of its thickness; m, least distance; root of the friction; unused
    float ( *motion )[4];        // [sphere] m, predicted for the step; the fourth is how far it may stray from that
    float* middle[3];            // [sphere] m, in the middle of the predicted motion
    float *start, *now;          // [sphere][4] as wisp_point_pair_args has them
    float *push, *shift;         // [sphere][4] likewise
    float* count_of;             // [sphere] pairs that press on it
    int32_t* rows;               // [pack]
    int32_t* other_x4;           // [row][16]
    float* gap;                  // [row][16]
    uint16_t* presses;           // [row]
    float* inverse_mass;         // [point] 1/kg, times the pairs that press on it
    int32_t* share_begin;        // [point + 1]
    contact_share* shares;       // of each point, the spheres that it is in
    uint32_t *cell, *spare_cell; // [sphere] sorted
    int32_t *order, *spare_order; // [sphere] number before the sort
    int32_t ( *from_parents )[3]; // [sphere] before the sort
    float ( *from_weights )[3];   // likewise
    int cells[2];                 // along the first two axes
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
