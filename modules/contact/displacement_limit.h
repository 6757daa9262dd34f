// Displacement limit: no pair passes its separating plane.
#pragma once

#include "contact_mesh.h"

typedef struct contact_limit
{
    uint8_t* changed; // [point] bits: its displacement changed, so its constraints are tested again
    bool is_again;    // a call before has tested the constraints of this substep
    int64_t tests;    // of constraints, in this step
    wisp_buffer buffers[1];
} contact_limit;

/// Make room for the points of the contact mesh.
/// @return false without memory
bool contact_reserve_limit( const contact_work* work );

/// Begin a substep: no point is moved.
void contact_begin_limit( const contact_work* work );

/// Shorten the displacements of free points to what the lists reach.
/// @return the number of points that went farther
int contact_stay_in_reach( const contact_work* work );

/// Move points until no pair has passed its separating plane.
/// @return the number of points that were moved
int contact_limit_displacements( const contact_work* work );

/// Put all free points back, but for the mean displacement of all.
void contact_hold( const contact_work* work );
