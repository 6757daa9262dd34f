/// A chart as a card of the page: title, axes, series with markers and lines, a key below, a caption.
#pragma once

#include "results.h"

/// The drawing's own coordinates; a page scales it to the available space.
enum
{
    REPORT_CHART_WIDTH = 560,
    REPORT_CHART_HEIGHT = 340,
    REPORT_CHART_LEFT = 56,
    REPORT_CHART_RIGHT = 16,
    REPORT_CHART_TOP = 14,
    REPORT_CHART_BOTTOM = 30,
};

/// Colours in the stylesheet, and shapes in report_put_markers().
#define REPORT_COLOURS 8

/// The shapes that charts refer to, once per page.
void report_put_markers( FILE* stream );
/// @param number from 1, for the anchor
void report_put_chart( const results_chart* chart, int number, FILE* stream );

// ---- shared by kinds of charts ----

/// Classes of a series: its colour, and dashes from the ninth on, whose colour is used twice.
void report_put_series_class( int series, FILE* stream );
/// The names of all series next to their markers and lines.
void report_put_key( const results_chart* chart, FILE* stream );
/// The tooltip of a point.
void report_put_tooltip( const results_chart* chart, int series, const results_point* point, FILE* stream );
