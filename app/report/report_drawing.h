/// What kinds of charts share: coordinates of a drawing, markers, names of series, tooltips.
#pragma once

#include "results.h"

/// The drawing's own coordinates; a page scales it to the room that there is.
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

/// The shapes that charts refer to, once a page.
void report_put_markers( FILE* stream );
/// The shape of a series. From the ninth series on colours come again, with other shapes.
int report_marker_of( int series );
/// Classes of a series: its colour, and dashes from the ninth on, whose colour is another's too.
void report_put_series_class( int series, FILE* stream );
/// The names of all series beside their markers and lines.
void report_put_key( const results_chart* chart, FILE* stream );
/// The text that a reader sees who points at a point.
void report_put_tooltip( const results_chart* chart, int series, const results_point* point, FILE* stream );
