/// The case `balloon`: the suites in data/suites/balloon, and what their rows must keep.
#pragma once

#include "bench_options.h"

/// Add claims of cost per vertex, and fail where a volume is wrong. @param first_row of the suites
void balloon_conclude( int first_row, int workers, results* out );
