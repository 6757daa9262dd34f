/// The case `balloon`: the suites in data/suites/balloon, and what their rows must keep.
#pragma once

#include "bench_options.h"
#include "cells.h"

/// Add cost per vertex, its chart and claims, and fail where a volume is wrong. @param first_row of the suites
void balloon_conclude( int first_row, int workers, results* out );
