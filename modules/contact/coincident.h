// Surfaces that start in one place, where nothing says which of them lies above.
#pragma once

#include "constraints.h"

/// Part participants whose primitives start in one place, by a tenth of their distance and along the normals of the earlier one, in
/// the order of their numbers. One that has pins stays. The recovery does the rest. Rows have to be found again.
void contact_part_coincident( const contact_work* work );
