#include "report_chart.h"

#include "report_axis.h"
#include "report_bars.h"
#include "report_drawing.h"
#include "report_labels.h"
#include "report_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- axes ----

typedef struct chart_frame
{
    const results_chart* chart;
    report_axis x, y;
    int drawn, left_out;
} chart_frame;

static bool is_drawn( const results_chart* chart, const results_point* point )
{
    return report_axis_takes( chart->x_log, point->x ) && report_axis_takes( chart->y_log, point->y );
}

static chart_frame find_frame( const results_chart* chart )
{
    chart_frame frame = { .chart = chart };
    double x[2] = { INFINITY, -INFINITY }, y[2] = { INFINITY, -INFINITY };
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            const results_point* point = &chart->series[s].points[i];
            if ( !is_drawn( chart, point ) )
            {
                ++frame.left_out;
                continue;
            }
            ++frame.drawn;
            x[0] = fmin( x[0], point->x );
            x[1] = fmax( x[1], point->x );
            y[0] = fmin( y[0], point->y );
            y[1] = fmax( y[1], point->y );
        }
    }
    if ( frame.drawn > 0 )
    {
        frame.x = report_axis_make( x[0], x[1], chart->x_log );
        frame.y = report_axis_make( y[0], y[1], chart->y_log );
    }
    return frame;
}

static double place_x( const chart_frame* frame, double value )
{
    double width = REPORT_CHART_WIDTH - REPORT_CHART_LEFT - REPORT_CHART_RIGHT;
    return REPORT_CHART_LEFT + width * report_axis_place( &frame->x, value );
}

static double place_y( const chart_frame* frame, double value )
{
    double height = REPORT_CHART_HEIGHT - REPORT_CHART_TOP - REPORT_CHART_BOTTOM;
    return REPORT_CHART_HEIGHT - REPORT_CHART_BOTTOM - height * report_axis_place( &frame->y, value );
}

static void put_pair( const char* before, double x, const char* between, double y, const char* after, FILE* stream )
{
    fputs( before, stream );
    report_put_fixed( x, 2, stream );
    fputs( between, stream );
    report_put_fixed( y, 2, stream );
    fputs( after, stream );
}

static void put_tick_label( const char* class_name, double x, double y, const char* label, FILE* stream )
{
    if ( label[0] )
    {
        fprintf( stream, "<text class=\"%s\"", class_name );
        put_pair( " x=\"", x, "\" y=\"", y, "\">", stream );
        report_put_text( label, stream );
        fputs( "</text>\n", stream );
    }
}

// Of the letters on a narrow screen, where they are largest.
#define TICK_CHARACTER_WIDTH 9.5

// Whether a label below the axis stays clear of the existing labels.
static bool has_room( const chart_frame* frame, int tick, const bool* is_shown )
{
    const report_axis* axis = &frame->x;
    for ( int i = 0; i < axis->tick_count; ++i )
    {
        int characters = report_text_length( axis->ticks[i].label ) + report_text_length( axis->ticks[tick].label );
        double gap = fabs( place_x( frame, axis->ticks[i].value ) - place_x( frame, axis->ticks[tick].value ) );
        if ( is_shown[i] && gap < 0.5 * TICK_CHARACTER_WIDTH * ( characters + 1 ) )
        {
            return false;
        }
    }
    return true;
}

// Powers of ten are placed first.
static void choose_labels( const chart_frame* frame, bool* is_shown )
{
    for ( int minor = 0; minor < 2; ++minor )
    {
        for ( int i = 0; i < frame->x.tick_count; ++i )
        {
            const report_tick* tick = &frame->x.ticks[i];
            if ( tick->label[0] && tick->is_major == ( minor == 0 ) )
            {
                is_shown[i] = has_room( frame, i, is_shown );
            }
        }
    }
}

static void put_x_axis( const chart_frame* frame, FILE* stream )
{
    const double bottom = REPORT_CHART_HEIGHT - REPORT_CHART_BOTTOM;
    bool is_shown[REPORT_TICKS_MAX] = { false };
    choose_labels( frame, is_shown );
    for ( int i = 0; i < frame->x.tick_count; ++i )
    {
        const report_tick* tick = &frame->x.ticks[i];
        double x = place_x( frame, tick->value );
        fputs( tick->label[0] ? "<path class=\"grid-line\"" : "<path class=\"grid-line minor\"", stream );
        put_pair( " d=\"M", x, " ", REPORT_CHART_TOP, "V", stream );
        report_put_fixed( bottom, 2, stream );
        fputs( "\"/>\n", stream );
        put_tick_label( "tick x", x, bottom + 18.0, is_shown[i] ? tick->label : "", stream );
    }
}

static void put_y_axis( const chart_frame* frame, FILE* stream )
{
    for ( int i = 0; i < frame->y.tick_count; ++i )
    {
        const report_tick* tick = &frame->y.ticks[i];
        double y = place_y( frame, tick->value );
        fputs( tick->label[0] ? "<path class=\"grid-line\"" : "<path class=\"grid-line minor\"", stream );
        put_pair( " d=\"M", REPORT_CHART_LEFT, " ", y, "H", stream );
        report_put_fixed( REPORT_CHART_WIDTH - REPORT_CHART_RIGHT, 2, stream );
        fputs( "\"/>\n", stream );
        put_tick_label( "tick y", REPORT_CHART_LEFT - 8.0, y + 4.0, tick->label, stream );
    }
}

// ---- points ----

// A missing point interrupts the line: the values in between were not measured.
static void put_line( const chart_frame* frame, int number, FILE* stream )
{
    const results_series* series = &frame->chart->series[number];
    bool is_running = false, has_begun = false;
    for ( int i = 0; series->is_joined && i < series->count; ++i )
    {
        const results_point* point = &series->points[i];
        if ( !is_drawn( frame->chart, point ) )
        {
            is_running = false;
            continue;
        }
        if ( !has_begun )
        {
            fputs( "<path class=\"line ", stream );
            report_put_series_class( number, stream );
            fputs( "\" d=\"", stream );
            has_begun = true;
        }
        put_pair( is_running ? "L" : "M", place_x( frame, point->x ), " ", place_y( frame, point->y ), "", stream );
        is_running = true;
    }
    fputs( has_begun ? "\"/>\n" : "", stream );
}

static void put_point( const chart_frame* frame, int number, const results_point* point, FILE* stream )
{
    double x = place_x( frame, point->x ), y = place_y( frame, point->y );
    fputs( "<g class=\"point ", stream );
    report_put_series_class( number, stream );
    fputs( "\">", stream );
    if ( point->is_marked )
    {
        put_pair( "<circle class=\"ring\" cx=\"", x, "\" cy=\"", y, "\" r=\"9\"/>", stream );
    }
    fprintf( stream, "<use href=\"#m%d\"", report_marker_of( number ) );
    put_pair( " x=\"", x, "\" y=\"", y, "\"/>", stream );
    report_put_tooltip( frame->chart, number, point, stream );
    fputs( "</g>\n", stream );
}

// Names of marked points only: these are the important ones.
static void put_names( const chart_frame* frame, FILE* stream )
{
    report_place* places = calloc( (size_t)frame->drawn, sizeof( report_place ) );
    int count = 0;
    for ( int s = 0; places && s < frame->chart->series_count; ++s )
    {
        for ( int i = 0; i < frame->chart->series[s].count; ++i )
        {
            const results_point* point = &frame->chart->series[s].points[i];
            if ( is_drawn( frame->chart, point ) )
            {
                bool is_named = point->is_marked && point->label[0];
                places[count++] = ( report_place ){ place_x( frame, point->x ), place_y( frame, point->y ),
                                                    is_named ? point->label : NULL, s };
            }
        }
    }
    // Without memory the tooltips still have the names.
    if ( places )
    {
        report_put_labels( places, count, stream );
    }
    free( places );
}

static void put_drawing( const chart_frame* frame, FILE* stream )
{
    const results_chart* chart = frame->chart;
    fprintf( stream, "<svg class=\"plot\" viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"", REPORT_CHART_WIDTH,
             REPORT_CHART_HEIGHT );
    report_put_text( chart->title, stream );
    fputs( "\">\n", stream );
    put_x_axis( frame, stream );
    put_y_axis( frame, stream );
    for ( int s = 0; s < chart->series_count; ++s )
    {
        put_line( frame, s, stream );
    }
    for ( int s = 0; s < chart->series_count; ++s )
    {
        for ( int i = 0; i < chart->series[s].count; ++i )
        {
            if ( is_drawn( chart, &chart->series[s].points[i] ) )
            {
                put_point( frame, s, &chart->series[s].points[i], stream );
            }
        }
    }
    put_names( frame, stream );
    fputs( "</svg>\n", stream );
}

// ---- the card ----

static void put_axis_label( const char* class_name, const char* label, bool is_log, FILE* stream )
{
    if ( label[0] )
    {
        fprintf( stream, "<p class=\"%s\">", class_name );
        report_put_text( label, stream );
        fputs( is_log ? " <span>logarithmic</span></p>\n" : "</p>\n", stream );
    }
}

static void put_plot( const results_chart* chart, FILE* stream )
{
    chart_frame frame = find_frame( chart );
    if ( frame.drawn == 0 )
    {
        fputs( "<p class=\"empty\">There is nothing to draw.</p>\n", stream );
    }
    else
    {
        put_axis_label( "axis y", chart->y_label, chart->y_log, stream );
        put_drawing( &frame, stream );
        put_axis_label( "axis x", chart->x_label, chart->x_log, stream );
        report_put_key( chart, stream );
    }
    if ( frame.left_out > 0 )
    {
        fprintf(
            stream, "<p class=\"left-out\">%d point%s no place on these axes, for want of a finite value%s.</p>\n",
            frame.left_out, frame.left_out == 1 ? " has" : "s have", chart->x_log || chart->y_log ? " above 0" : "" );
    }
}

void report_put_chart( const results_chart* chart, int number, FILE* stream )
{
    fprintf( stream, "<figure class=\"card\" id=\"chart-%d\">\n<figcaption><h3>", number );
    report_put_text( chart->title, stream );
    fputs( "</h3></figcaption>\n", stream );
    if ( chart->is_bars )
    {
        report_put_bars( chart, stream );
    }
    else
    {
        put_plot( chart, stream );
    }
    if ( chart->caption[0] )
    {
        fputs( "<p class=\"caption\">", stream );
        report_put_text( chart->caption, stream );
        fputs( "</p>\n", stream );
    }
    fputs( "</figure>\n", stream );
}
