// Interaction of strands on a grid.
#pragma once

#include "strands_state.h"

wisp_pass_fn strands_mix;

size_t strands_grid_workspace_size( void );
void strands_grid_workspace_release( void* workspace, const wisp_allocator* allocator );
size_t strands_grid_workspace_bytes( const void* workspace );
