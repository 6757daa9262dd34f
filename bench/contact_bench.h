/// What the case `contact` promises of its suites.
#pragma once

#include "bench_options.h"

/// Fail where rows of the suites are not what contact promises. @param first_row of the suites
void contact_check_suites( int first_row, results* out );
