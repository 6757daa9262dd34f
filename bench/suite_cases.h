/// What cases claim of their suites.
#pragma once

#include "bench.h"

/// Add claims of cost per vertex, and fail where a volume is wrong. @param first_row of the suites
void balloon_conclude( int first_row, int workers, results* out );

/// Fail where rows of the suites are not what contact promises. @param first_row of the suites
void contact_check_suites( int first_row, results* out );

/// Say whether a million vertices take as little time as is claimed. @param first_row of the suites
void strands_claim_million( int first_row, results* out );
