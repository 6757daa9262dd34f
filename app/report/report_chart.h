/// A chart as a card of the page: title, axes, series with markers and lines, a key below, a caption.
#pragma once

#include "results.h"

/// @param number from 1, for the anchor
void report_put_chart( const results_chart* chart, int number, FILE* stream );
