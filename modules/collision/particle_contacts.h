// Contacts of particles, and blocks of particles that are culled together.
#pragma once

#include "collision_bodies.h"

enum
{
    COLLISION_BLOCK = WISP_PARTICLE_BLOCK,
};

/// A half space that a particle must stay in for a substep, and the accumulated corrections. A row of the kernel
/// half_space.
typedef struct collision_contact
{
    float point[3];                 // m, on the body, at the end of the substep
    float normal[3];                // unit, away from the body
    float motion[3];                // m, displacement of the body's surface in the substep
    float gap;                      // m, to keep along the normal
    float normal_correction;        // m, accumulated, >= 0: the normal impulse
    float tangential_correction[3]; // m, accumulated: the friction impulse
    float static_friction, kinetic_friction;
} collision_contact;

/// A block of particles as arrays of coordinates, for kernels that cull.
typedef struct collision_block
{
    int count;                     // of particles that move and are finite
    int32_t slot[COLLISION_BLOCK]; // of each of them
    float now[3][COLLISION_BLOCK]; // m, in the world
    float old[3][COLLISION_BLOCK]; // m, in the world, at the start of the substep
    wisp_vec3 lower, upper;        // m, of all paths, before a body moved anything
    float clear[COLLISION_BLOCK];  // m, within this distance there is no body without a contact
    // seen from one body, in its frame
    float from[3][COLLISION_BLOCK], to[3][COLLISION_BLOCK];
    float path[COLLISION_BLOCK], reach[COLLISION_BLOCK]; // m
    int32_t candidates[COLLISION_BLOCK];                 // in the block: those that may be within reach
    int candidate_count;
} collision_block;

/// Columns of the participant whose contacts are found.
typedef struct collision_find_args
{
    const wisp_kernels* kernels;
    float *position, *previous; // [slot][4]
    int32_t* count;             // [slot] contacts found
    float* found;               // [slot][4] m, where they were found; the distance that is clear
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    float recovery; // m, in this substep
} collision_find_args;
