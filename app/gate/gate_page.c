#include "gate_page.h"

#include "report.h"

#include <math.h>
#include <stdio.h>

enum
{
    MAX_PASS_CHARTS = 12, ///< rows whose passes are drawn
    MAX_BARS = 24,        ///< passes of a row, the largest
};

static const char* const sides[] = { "before", "after" };

// Add a line of bars, before and after, in millions.
static void add_bars( results* out, int chart, const int series[2], int line, const char* label, double before,
                      double after )
{
    const double values[] = { before, after };
    for ( int side = 0; side < 2; ++side )
    {
        results_point point = { .x = line, .y = 1e-6 * values[side] };
        snprintf( point.label, sizeof point.label, "%.191s", label );
        results_add_point( out, chart, series[side], point );
    }
}

static int begin_chart( results* out, const char* title, int series[2] )
{
    const int number = results_add_chart( out, title, "", "million instructions" );
    for ( int side = 0; side < 2; ++side )
    {
        series[side] = results_add_series( out, number, sides[side], false );
    }
    results_chart* chart = results_chart_at( out, number );
    if ( chart )
    {
        chart->is_bars = true;
    }
    return number;
}

static bool is_counted( const gate_row_check* check )
{
    return check->base && isfinite( check->base->measured.values[SUITE_INSTRUCTIONS] ) &&
           isfinite( check->now.values[SUITE_INSTRUCTIONS] );
}

static double growth_of( const gate_row_check* check )
{
    return check->now.values[SUITE_INSTRUCTIONS] / check->base->measured.values[SUITE_INSTRUCTIONS];
}

static void add_rows_chart( const wisp_suite* suite, const gate_row_check* checks, results* out )
{
    int series[2], line = 0;
    const int chart = begin_chart( out, "Instructions of all steps, before and after", series );
    for ( int i = 0; i < suite->row_count; ++i )
    {
        if ( is_counted( checks + i ) )
        {
            char label[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2];
            gate_row_label( suite->rows + i, label, sizeof label );
            add_bars( out, chart, series, line++, label, checks[i].base->measured.values[SUITE_INSTRUCTIONS],
                      checks[i].now.values[SUITE_INSTRUCTIONS] );
        }
    }
}

// The largest pass that is not done. @return -1: there is none
static int next_pass( const suite_measurement* now, const bool* is_done )
{
    int next = -1;
    for ( int i = 0; i < now->pass_count; ++i )
    {
        if ( !is_done[i] && now->passes[i].instructions > 0.0 &&
             ( next < 0 || now->passes[i].instructions > now->passes[next].instructions ) )
        {
            next = i;
        }
    }
    return next;
}

static void add_pass_chart( const suite_row* row, const gate_row_check* check, results* out )
{
    char title[160], label[SUITE_MAX_NAME + SUITE_MAX_VARIANT + 2];
    bool is_done[SUITE_MAX_PASSES] = { false };
    int series[2], line = 0;
    gate_row_label( row, label, sizeof label );
    snprintf( title, sizeof title, "%.140s, by pass", label );
    const int chart = begin_chart( out, title, series );
    for ( int i = next_pass( &check->now, is_done ); i >= 0 && line < MAX_BARS;
          i = next_pass( &check->now, is_done ) )
    {
        const suite_pass* pass = &check->now.passes[i];
        add_bars( out, chart, series, line++, pass->name,
                  gate_pass_instructions( &check->base->measured, pass->name ), pass->instructions );
        is_done[i] = true;
    }
}

// Passes of the rows that changed most, either way.
static void add_pass_charts( const wisp_suite* suite, const gate_row_check* checks, results* out )
{
    bool is_done[SUITE_MAX_ROWS] = { false };
    for ( int drawn = 0; drawn < MAX_PASS_CHARTS; ++drawn )
    {
        int next = -1;
        for ( int i = 0; i < suite->row_count; ++i )
        {
            if ( !is_done[i] && is_counted( checks + i ) &&
                 ( next < 0 || fabs( log( growth_of( checks + i ) ) ) > fabs( log( growth_of( checks + next ) ) ) ) )
            {
                next = i;
            }
        }
        if ( next < 0 )
        {
            return;
        }
        is_done[next] = true;
        add_pass_chart( suite->rows + next, checks + next, out );
    }
}

wisp_status gate_write_page( const wisp_suite* suite, const gate_row_check* checks, results* report, const char* path,
                             wisp_error* error )
{
    char what[SUITE_MAX_NAME + 16];
    const report_run run = { .what = what, .how = report->options };
    bool has_counts = false;
    for ( int i = 0; i < suite->row_count; ++i )
    {
        has_counts = has_counts || is_counted( checks + i );
    }
    snprintf( what, sizeof what, "gate %s", suite->name );
    if ( has_counts )
    {
        add_rows_chart( suite, checks, report );
        add_pass_charts( suite, checks, report );
    }
    return report_write_file( report, &run, path, error );
}
