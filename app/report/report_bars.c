#include "report_bars.h"

#include "report_axis.h"
#include "report_drawing.h"
#include "report_text.h"

#include <math.h>

// ---- range of the bars ----

typedef struct bar_range
{
    bool is_log;
    double lower, upper; ///< all bars are between; without logarithms 0 is, too
    int count;
} bar_range;

static bar_range find_range( const results_chart* chart )
{
    bar_range range = { .is_log = chart->y_log };
    double least = INFINITY, most = -INFINITY;
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            double y = chart->series[s].points[i].y;
            if ( report_axis_takes( range.is_log, y ) )
            {
                least = fmin( least, y );
                most = fmax( most, y );
                ++range.count;
            }
        }
    }
    if ( range.count > 0 && range.is_log )
    {
        // The smallest bar must be visible as well.
        range.lower = pow( 10.0, ceil( log10( least ) ) - 1.0 );
        range.upper = most;
    }
    else if ( range.count > 0 )
    {
        range.lower = fmin( least, 0.0 );
        range.upper = least == 0.0 && most == 0.0 ? 1.0 : fmax( most, 0.0 );
    }
    return range;
}

static double fraction( const bar_range* range, double value )
{
    return range->is_log ? log( value / range->lower ) / log( range->upper / range->lower )
                         : ( value - range->lower ) / ( range->upper - range->lower );
}

// ---- lines ----

static const results_point* find_point( const results_series* series, double x )
{
    for ( int i = 0; i < series->count; ++i )
    {
        if ( series->points[i].x == x )
        {
            return &series->points[i];
        }
    }
    return NULL;
}

static void put_bar( const results_chart* chart, const bar_range* range, int series, const results_point* point,
                     FILE* stream )
{
    fputs( "<td class=\"bar\">", stream );
    if ( report_axis_takes( range->is_log, point->y ) )
    {
        double from = range->is_log ? 0.0 : fraction( range, 0.0 ), to = fraction( range, point->y );
        fputs( "<svg class=\"", stream );
        report_put_series_class( series, stream );
        fputs( "\" width=\"100%\" height=\"14\"><rect class=\"bar\" height=\"14\" x=\"", stream );
        report_put_fixed( 100.0 * fmin( from, to ), 2, stream );
        fputs( "%\" width=\"", stream );
        report_put_fixed( 100.0 * fabs( to - from ), 2, stream );
        fputs( "%\">", stream );
        report_put_tooltip( chart, series, point, stream );
        fputs( "</rect></svg>", stream );
    }
    fputs( point->is_marked ? "</td><td class=\"n marked\">" : "</td><td class=\"n\">", stream );
    report_put_short( point->y, stream );
    fputs( "</td>", stream );
}

// One name with the bars of all series that have a value there.
static void put_group( const results_chart* chart, const bar_range* range, const results_point* first, FILE* stream )
{
    int bars = 0;
    for ( int s = 0; s < chart->series_count; ++s )
    {
        bars += find_point( &chart->series[s], first->x ) != NULL;
    }
    bool is_begun = false;
    for ( int s = 0; s < chart->series_count; ++s )
    {
        const results_point* point = find_point( &chart->series[s], first->x );
        if ( !point )
        {
            continue;
        }
        fputs( is_begun ? "<tr>" : "<tr class=\"first\">", stream );
        if ( !is_begun )
        {
            fprintf( stream, "<th scope=\"rowgroup\" rowspan=\"%d\">", bars );
            report_put_text( first->label, stream );
            fputs( "</th>", stream );
        }
        put_bar( chart, range, s, point, stream );
        fputs( "</tr>\n", stream );
        is_begun = true;
    }
}

void report_put_bars( const results_chart* chart, FILE* stream )
{
    bar_range range = find_range( chart );
    if ( range.count == 0 || chart->series[0].count == 0 )
    {
        fputs( "<p class=\"empty\">There is nothing to draw.</p>\n", stream );
        return;
    }
    fputs( "<table class=\"bars\">\n<tr><th>", stream );
    report_put_text( chart->x_label, stream );
    fputs( "</th><th colspan=\"2\">", stream );
    report_put_text( chart->y_label, stream );
    fputs( range.is_log ? " <span>logarithmic</span></th></tr>\n" : "</th></tr>\n", stream );
    for ( int i = 0; i < chart->series[0].count; ++i )
    {
        put_group( chart, &range, &chart->series[0].points[i], stream );
    }
    fputs( "</table>\n", stream );
    if ( chart->series_count > 1 )
    {
        report_put_key( chart, stream );
    }
}
