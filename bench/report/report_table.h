/// A table that scrolls inside its own frame, with a header that stays.
#pragma once

#include "results.h"

/// @param number from 1, for the anchor
void report_put_table( const results_table* table, int number, FILE* stream );
