// Contact generation: one block of particles against its bodies, in the order of the bodies.
#pragma once

#include "particle_contacts.h"

/// Add the contacts of a block with one body.
void collision_meet( const collision_find_args* args, const collision_view* view, collision_block* block );

/// Load the contacts of particles that two bodies squeeze: see squeeze.c.
void collision_squeeze( const collision_find_args* args, const collision_block* block );

/// Return the correction with which two contacts begin the substep that squeeze something of a thickness of `both` by a depth, m.
float collision_squeeze_load( float dt, float oppose, float depth, float both );
