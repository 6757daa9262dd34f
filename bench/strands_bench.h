/// What the case `strands` claims of its suites.
#pragma once

#include "bench_options.h"

/// Say whether a million vertices take as little time as is claimed. @param first_row of the suites
void strands_claim_million( int first_row, results* out );
