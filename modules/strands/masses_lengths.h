// Masses, lengths and links.
#pragma once

#include "strand_rows.h"
#include "strands_state.h"

/// Compute masses and lengths from a definition. @return the number of pinned vertices behind roots
int strands_cook_masses( wisp_world* world, wisp_entity strands, const wisp_strand_dynamics_def* def );

/// Compute rest lengths of links over one and over two segments, where the entity has them.
void strands_cook_links( wisp_world* world, wisp_entity strands, const strands_state* state );

/// Return the lane of a vertex, in the user's order: 16 times its group, and the lane in it.
int strands_lane_of( const wisp_strand_topology* topology, int vertex );

/// Return whether the last vertex of a strand lies on its first, at rest.
bool strands_is_loop( const float* rest, int row, int count, int lane );

/// Return the length of the longest strand at rest, m.
float strands_longest( const strands_rows* rows );
