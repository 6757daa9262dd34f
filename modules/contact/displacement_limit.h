// Displacement limit: no pair passes its separating plane.
#pragma once

#include "contact_mesh.h"

typedef struct contact_limit
{
    float* fraction; // [point] fraction of its displacement that is left, beyond what is carried
    bool carries;    // some point is carried
    float*
        carried; // [point][4] m: displacement that a cut leaves, relative to the common one; unset unless one is carried
    uint8_t* is_driven; // [point] 1: pushed ahead of pinned points in this substep, and not cut
    uint8_t* changed;   // [point] CONTACT_CHANGED bits: its displacement changed, so its constraints are tested again
    bool is_again;      // a call before has tested the constraints of this substep
    int64_t tests;      // of constraints, in this step
    float* drive;       // [point] m: displacement of the pinned point that drives it; unset unless it is driven
    float* cut;         // [point] smallest cut of its pairs in a round
    wisp_buffer buffers[6];
} contact_limit;

/// Make room for the points of the contact mesh.
/// @return false without memory
bool contact_reserve_limit( const contact_work* work );

/// Begin a substep: no point is driven.
void contact_begin_limit( const contact_work* work );

/// Shorten the displacements of free points to what the lists reach.
/// @return the number of points that went farther
int contact_stay_in_reach( const contact_work* work );

/// Cut displacements, and push what pinned points drive into, until no separating plane is passed.
/// @return the number of points that were cut or pushed
int contact_limit_displacements( const contact_work* work );

/// Cut the displacements of all free points to the mean of all points.
void contact_hold( const contact_work* work );

/// Compute `carries` for this substep, and if it is set `carried` of all points of the contact mesh.
void contact_find_carried( const contact_work* work );
