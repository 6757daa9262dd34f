// Charts of the tables: error against time, and error against what tends to 0.
#include "accuracy_labels.h"
#include "accuracy_parts.h"

#include <math.h>
#include <string.h>

static void add_point( const accuracy_report* report, int setting, double x, int chart, int series, results* out )
{
    const bool is_below = accuracy_is_below( report->bounded[setting], report->scene->uncertainty );
    results_point point = { .x = x, .y = report->bounded[setting] };
    point.is_marked = report->on_front[setting];
    snprintf( point.label, sizeof( point.label ), is_below ? "%.180s: below" : "%.191s",
              report->scene->settings[setting].name );
    results_add_point( out, chart, series, point );
}

static void make_logarithmic( const accuracy_report* report, results* out, int chart, const char* caption )
{
    results_chart* made = results_chart_at( out, chart );
    if ( made )
    {
        made->x_log = made->y_log = true;
        snprintf( made->caption, sizeof( made->caption ), "%s", caption );
    }
    if ( made && report->scene->uncertainty > 0.0 )
    {
        const size_t used = strlen( made->caption );
        snprintf( made->caption + used, sizeof( made->caption ) - used,
                  " Points called `below` stand at the doubt of the reference, %.3g %s.", report->scene->uncertainty,
                  report->scene->error_unit );
    }
}

// ---- error against time ----

// Settings of a name in their order; the empty name stands for settings outside any series.
static void add_times_of( const accuracy_report* report, const char* series_name, int chart, int series,
                          results* out )
{
    const double* ms = report->min_ms;
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        if ( strcmp( report->scene->settings[i].series, series_name ) == 0 )
        {
            add_point( report, i, ms[i], chart, series, out );
        }
    }
}

static bool has_loner( const accuracy_scene* scene )
{
    bool has = false;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        has = has || scene->settings[i].series[0] == '\0';
    }
    return has;
}

static void add_time_chart( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    char title[160], error[80], x_label[64];
    accuracy_error_label( scene, error, sizeof( error ) );
    snprintf( title, sizeof( title ), "Accuracy `%s`: error against time", report->entry->name );
    snprintf( x_label, sizeof( x_label ), "ms per %s", accuracy_ms_name( scene ) );
    const int chart = results_add_chart( out, title, x_label, error );
    make_logarithmic( report, out, chart,
                      "Lower is more accurate, further left is faster. Each setting has its faster worker count. "
                      "Marked: the Pareto front, where no other setting is both faster and more accurate." );
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( accuracy_begins_series( scene, i ) )
        {
            const char* name = scene->settings[i].series;
            add_times_of( report, name, chart, results_add_series( out, chart, name, true ), out );
        }
    }
    if ( has_loner( scene ) )
    {
        add_times_of( report, "", chart, results_add_series( out, chart, "other settings", false ), out );
    }
}

// ---- error against what tends to 0 ----

// The next point of a series below a parameter: lines are drawn from coarse to fine. -1: none
static int next_finer( const accuracy_scene* scene, const char* series, int before )
{
    int next = -1;
    const double parameter = before < 0 ? INFINITY : scene->settings[before].parameter;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        const accuracy_setting* s = &scene->settings[i];
        const bool follows = s->parameter < parameter || ( s->parameter == parameter && i > before );
        if ( strcmp( s->series, series ) == 0 && follows &&
             ( next < 0 || s->parameter > scene->settings[next].parameter ) )
        {
            next = i;
        }
    }
    return next;
}

static bool begins_parameter( const accuracy_scene* scene, int setting )
{
    bool begins = accuracy_begins_series( scene, setting );
    for ( int i = 0; i < setting && begins; ++i )
    {
        begins = !scene->settings[i].series[0] ||
                 strcmp( scene->settings[i].parameter_name, scene->settings[setting].parameter_name ) != 0;
    }
    return begins;
}

// Series of different parameters have separate axes.
static void add_parameter_chart( const accuracy_report* report, const char* parameter_name, results* out )
{
    const accuracy_scene* scene = report->scene;
    char title[160], error[80];
    accuracy_error_label( scene, error, sizeof( error ) );
    snprintf( title, sizeof( title ), "Accuracy `%s`: error against %s", report->entry->name, parameter_name );
    const int chart = results_add_chart( out, title, parameter_name, error );
    make_logarithmic( report, out, chart,
                      "Slope 1 is first order: half the parameter, half the error. A line that turns flat has "
                      "reached an error that does not depend on this parameter. Marked: the Pareto front." );
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        const accuracy_setting* first = &scene->settings[i];
        if ( !accuracy_begins_series( scene, i ) || strcmp( first->parameter_name, parameter_name ) != 0 )
        {
            continue;
        }
        const int series = results_add_series( out, chart, first->series, true );
        for ( int k = next_finer( scene, first->series, -1 ); k >= 0; k = next_finer( scene, first->series, k ) )
        {
            add_point( report, k, scene->settings[k].parameter, chart, series, out );
        }
    }
}

void accuracy_add_charts( const accuracy_report* report, results* out )
{
    if ( !report->scene->has_no_rivals )
    {
        add_time_chart( report, out );
    }
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        if ( begins_parameter( report->scene, i ) )
        {
            add_parameter_chart( report, report->scene->settings[i].parameter_name, out );
        }
    }
}
