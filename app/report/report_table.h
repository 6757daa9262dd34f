/// A table that scrolls inside its own frame, with a fixed header.
#pragma once

#include "results.h"

/// @param number from 1, for the anchor
void report_put_table( const results_table* table, int number, FILE* stream );
