/// Horizontal bars: a line for each name, with a bar for every series.
#pragma once

#include "results.h"

void report_put_bars( const results_chart* chart, FILE* stream );
