/// Where the memory of a run goes.
#pragma once

#include "results.h"

#include "wisp/wisp.h"

/// A table of the parts of a world's memory, of fabrics, and of Embree.
void run_memory_report( const wisp_world* world, int vertices, results* out );
/// Sums by kind, for machines.
void run_memory_put( const wisp_world* world, results_values* out );
