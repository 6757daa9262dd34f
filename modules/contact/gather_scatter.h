// Points between the columns of the participants and the contact mesh.
#pragma once

#include "contact_mesh.h"

/// Gather the positions of all points; at the start of a substep their intersection-free positions too.
void contact_gather( const contact_work* work, bool is_start );

/// Scatter the positions of all points; after the last iteration they become the intersection-free positions.
void contact_scatter( const contact_work* work, bool is_end );

/// Store the intersection-free positions of a participant in its column.
void contact_keep_participant( const contact_work* work, const contact_participant* participant );
