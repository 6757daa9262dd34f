// How pinned points carry a participant along: what is left of a displacement that is cut.
#pragma once

#include "contact_mesh.h"

/// Compute `carries`, and `carried` of all points of the contact mesh for this substep, relative to `common`.
void contact_find_carried( const contact_work* work );
