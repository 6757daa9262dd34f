// Points between the columns of the participants and the contact mesh.
#pragma once

#include "contact_mesh.h"

/// Gather the positions of all points; at the start of a substep their intersection-free positions too.
void contact_gather( const contact_work* work, bool is_start );

/// Scatter the positions of all points.
/// @param is_end after the last iteration: with the shift, which gives no velocity
/// @param is_final they become the intersection-free positions
void contact_scatter( const contact_work* work, bool is_end, bool is_final );

/// Store the intersection-free positions of a participant in its column.
void contact_keep_participant( const contact_work* work, const contact_participant* participant );

/// Restore the lengths of strands in groups that were pushed since they were gathered, and gather them again.
/// @return m, farthest push along an axis, or 0 if all are small
float contact_restore_lengths( const contact_work* work, const wisp_span* span );
