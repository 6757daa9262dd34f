// Culling: which particles of a block may be within reach of a body.
#pragma once

#include "particle_contacts.h"

/// Gather the particles that move and are finite. Their contacts are cleared.
void collision_begin_block( const collision_find_args* args, int begin, int end, collision_block* block );

/// Compute the paths relative to a body, and list the particles that may be within reach. All others are surely
/// beyond it.
void collision_cull_block( const wisp_kernels* kernels, const collision_view* view, collision_block* block );
