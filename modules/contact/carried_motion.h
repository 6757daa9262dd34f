// How pinned points carry a participant along: what is left of a displacement that is cut.
#pragma once

#include "contact_mesh.h"

/// Compute `carries` for this substep, and if it is set `carried` of all points of the contact mesh.
void contact_find_carried( const contact_work* work );
