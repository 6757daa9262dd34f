// Displacement limit: no pair passes its separating plane.
#pragma once

#include "contact_mesh.h"

typedef struct contact_limit
{
    float* fraction; // [point] fraction of its displacement that is left
    wisp_buffer buffer;
} contact_limit;

/// Make room for the points of the contact mesh.
/// @return false without memory
bool contact_reserve_limit( const contact_work* work );

/// Cut displacements until no separating plane is passed.
/// @return the number of points that were cut
int contact_limit_displacements( const contact_work* work );

/// Cut the displacements of all free points to the mean of all points.
void contact_hold( const contact_work* work );
