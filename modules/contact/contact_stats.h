// Statistics of a step.
#pragma once

#include "contact_mesh.h"

/// Add the impulses of the constraints of a substep.
void contact_sum_impulses( const contact_work* work );

/// Complete the statistics at the end of a step: counts, the smallest gap, and intersections if requested.
void contact_fill_stats( const contact_work* work, bool counts_intersections );
