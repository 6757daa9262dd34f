// Culling: which particles of a block may be within reach of a body.
#pragma once

#include "particle_contacts.h"

/// Gather the particles that may touch a body in this substep. Their contacts are cleared.
void collision_begin_block( const collision_find_args* args, int begin, int end, collision_block* block );

/// Compute the paths relative to a body, and list the particles that may be within reach. All others are surely
/// beyond it.
void collision_cull_block( const collision_find_args* args, const collision_view* view, collision_block* block );

/// Note that a body is at this distance from the box of the block, in m, which is beyond its reach.
void collision_skip_block( const collision_view* view, float apart, collision_block* block );

/// Store the distances that are clear, and which groups are settled.
void collision_end_block( const collision_find_args* args, const collision_block* block );
