// Pairs whose closest points are those of another pair.
#pragma once

#include "primitive_pairs.h"

/// Compute `reach` of the pairs of a batch: the gap, or where a pair repeats another one what the displacement limit keeps.
void contact_find_reaches( const contact_work* work, contact_kind kind, contact_batch* batch, int count );
