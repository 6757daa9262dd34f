// Narrow phase: from active pairs of clusters to active pairs of primitives.
#pragma once

#include "contact_mesh.h"

/// Find the active pairs of primitives, in any order.
/// @param missed_only only of clusters that have a missed point
wisp_status contact_find_near( const contact_work* work, bool missed_only, wisp_error* error );
