// Comparisons of settings at equal error and at equal time.
#include "accuracy/accuracy_parts.h"

#include "stats.h"
#include "suite_measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- comparisons of numbers ----

// Below this slope an error is considered constant: half the parameter reduces it by less than an eighth.
#define FLOOR_SLOPE 0.2

// Limit of points per series.
#define SERIES_POINTS_MAX 64

void accuracy_front( const double* error, const double* ms, const accuracy_setting* settings, int count,
                     bool* on_front )
{
    for ( int i = 0; i < count; ++i )
    {
        on_front[i] = isfinite( error[i] ) && isfinite( ms[i] );
        for ( int k = 0; k < count && on_front[i]; ++k )
        {
            const bool is_rival = !settings || settings[k].group == settings[i].group;
            const bool is_better =
                is_rival && error[k] <= error[i] && ms[k] <= ms[i] && ( error[k] < error[i] || ms[k] < ms[i] );
            on_front[i] = !is_better;
        }
    }
}

// ---- order ----

typedef struct series_points
{
    double parameter[SERIES_POINTS_MAX], error[SERIES_POINTS_MAX];
    int count;
} series_points;

// The coarsest first.
static void insert_point( series_points* all, double parameter, double error )
{
    int place = all->count++;
    for ( ; place > 0 && all->parameter[place - 1] < parameter; --place )
    {
        all->parameter[place] = all->parameter[place - 1];
        all->error[place] = all->error[place - 1];
    }
    all->parameter[place] = parameter;
    all->error[place] = error;
}

// Whether the error of a point is clearly smaller than that of every coarser one.
static bool still_falls( const series_points* all, int point )
{
    double least = INFINITY;
    for ( int i = 0; i < point; ++i )
    {
        least = fmin( least, all->error[i] );
    }
    return all->error[point] < least * pow( all->parameter[point] / all->parameter[point - 1], FLOOR_SLOPE );
}

accuracy_order accuracy_observed_order( const double* parameter, const double* error, int count )
{
    series_points all = { .count = 0 };
    for ( int i = 0; i < count && all.count < SERIES_POINTS_MAX; ++i )
    {
        if ( isfinite( error[i] ) && error[i] > 0.0 && isfinite( parameter[i] ) && parameter[i] > 0.0 )
        {
            insert_point( &all, parameter[i], error[i] );
        }
    }
    accuracy_order order = { .used = all.count, .count = all.count };
    while ( order.used > 1 && !still_falls( &all, order.used - 1 ) )
    {
        --order.used;
    }

    for ( int i = 0; i < order.used; ++i )
    {
        all.parameter[i] = log( all.parameter[i] );
        all.error[i] = log( all.error[i] );
    }
    order.slope = stats_fit_line( all.parameter, all.error, order.used ).slope;
    return order;
}

// ---- levels ----

// The round numbers in their order: number 0 is 1, 1 is 2, 2 is 5, 3 is 10, -1 is 0.5.
static double round_number( int number )
{
    static const double mantissas[3] = { 1.0, 2.0, 5.0 };
    const int decade = number >= 0 ? number / 3 : -( ( 2 - number ) / 3 );
    const double mantissa = mantissas[number - 3 * decade];
    // 10^-n is no double, but a division by 10^n rounds once
    return decade >= 0 ? mantissa * pow( 10.0, decade ) : mantissa / pow( 10.0, -decade );
}

static int first_not_below( double value )
{
    int number = 3 * ( (int)floor( log10( value ) ) - 1 );
    while ( round_number( number ) < value )
    {
        ++number;
    }
    return number;
}

int accuracy_levels( const double* values, int count, double* levels )
{
    double least = INFINITY, most = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        if ( isfinite( values[i] ) && values[i] > 0.0 )
        {
            least = fmin( least, values[i] );
            most = fmax( most, values[i] );
        }
    }
    if ( most == 0.0 )
    {
        return 0;
    }
    const int first = first_not_below( least ), last = first_not_below( most );
    const int found = last - first + 1, kept = found < ACCURACY_LEVELS_MAX ? found : ACCURACY_LEVELS_MAX;
    for ( int i = 0; i < kept; ++i )
    {
        const double fraction = kept > 1 ? (double)i / ( kept - 1 ) : 0.0;
        levels[i] = round_number( first + (int)lround( fraction * ( found - 1 ) ) );
    }
    return kept;
}

int accuracy_best_within( const double* cost, const double* limited, double limit, const bool* takes_part, int count )
{
    int best = -1;
    for ( int i = 0; i < count; ++i )
    {
        const bool can = ( !takes_part || takes_part[i] ) && limited[i] <= limit && isfinite( cost[i] );
        if ( can && ( best < 0 || cost[i] < cost[best] ) )
        {
            best = i;
        }
    }
    return best;
}

// ---- summaries ----

// The cheapest settings at equal error, the most accurate ones at equal time, and observed orders.

// ---- at equal error, at equal time ----

/// One of the two tables: the value to minimise, and the limited one.
typedef struct summary
{
    const accuracy_report* report;
    const double *cost, *limited; // [setting_count]
    bool is_by_error;             // true: the error is limited and the time minimised
    bool* takes_part;             // [setting_count] buffer
    // [setting_count] buffers: the best setting of each method within a limit and within the next tighter one, the
    // best method first
    int *best, *tighter;
} summary;

static bool begins_method( const accuracy_scene* scene, int setting )
{
    const char* method = accuracy_method_of( &scene->settings[setting] );
    for ( int i = 0; i < setting; ++i )
    {
        if ( strcmp( accuracy_method_of( &scene->settings[i] ), method ) == 0 )
        {
            return false;
        }
    }
    return true;
}

static int best_of_method( const summary* s, const char* method, double limit )
{
    const accuracy_scene* scene = s->report->scene;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        s->takes_part[i] = strcmp( accuracy_method_of( &scene->settings[i] ), method ) == 0;
    }
    return accuracy_best_within( s->cost, s->limited, limit, s->takes_part, scene->setting_count );
}

// The best setting of every method that stays within the limit, the best first. @return their number
static int rank_methods( const summary* s, double limit, int* best_of_each )
{
    int count = 0;
    for ( int i = 0; i < s->report->scene->setting_count; ++i )
    {
        const char* method = accuracy_method_of( &s->report->scene->settings[i] );
        const int best = begins_method( s->report->scene, i ) ? best_of_method( s, method, limit ) : -1;
        if ( best < 0 )
        {
            continue;
        }
        int place = count++;
        for ( ; place > 0 && s->cost[best_of_each[place - 1]] > s->cost[best]; --place )
        {
            best_of_each[place] = best_of_each[place - 1];
        }
        best_of_each[place] = best;
    }
    return count;
}

static int begin_summary( const summary* s, results* out )
{
    char error[80], title[160];
    accuracy_error_label( s->report->scene, error, sizeof( error ) );
    const char* best = s->is_by_error ? "fastest" : "most accurate";
    results_cells row = { .count = 0 };
    cells_put( &row, "%s, at most\tmethod\t%s setting\t%s\ttimes the %s\t%s\tworkers", s->is_by_error ? error : "ms",
               best, s->is_by_error ? "ms" : error, best, s->is_by_error ? error : "ms" );
    snprintf( title, sizeof( title ), "Accuracy `%s`, at equal %s: the %s setting of every method within it",
              s->report->entry->name, s->is_by_error ? "error" : "time", best );
    return cells_begin_table( &row, title, out );
}

// The worker count of that time: the faster one.
static int workers_of( const accuracy_report* report, int setting )
{
    int fastest = 0;
    for ( int w = 1; w < report->worker_count; ++w )
    {
        fastest = report->ms[w][setting] < report->ms[fastest][setting] ? w : fastest;
    }
    return report->workers[fastest];
}

// @param tighter the next level; a level with the same result as that is left out
static void add_level( const summary* s, double level, double tighter, int table, results* out )
{
    const int count = rank_methods( s, level, s->best ), tighter_count = rank_methods( s, tighter, s->tighter );
    if ( count == tighter_count && memcmp( s->best, s->tighter, (size_t)count * sizeof( int ) ) == 0 )
    {
        return;
    }
    for ( int i = 0; i < count; ++i )
    {
        const int setting = s->best[i];
        results_cells row = { .count = 0 };
        cells_put( &row, "%g\t%s\t%s", level, accuracy_method_of( &s->report->scene->settings[setting] ),
                   s->report->scene->settings[setting].name );
        const double doubt = accuracy_doubt( s->report->scene, setting );
        accuracy_put_error( &row, s->cost[setting], s->is_by_error ? 0.0 : doubt, 3 );
        const double least = s->cost[s->best[0]];
        const bool is_known = least > 0.0 && ( s->is_by_error || !accuracy_is_below( least, doubt ) );
        cells_put( &row, "%.2f", is_known ? s->cost[setting] / least : NAN );
        accuracy_put_error( &row, s->limited[setting], s->is_by_error ? doubt : 0.0, 3 );
        cells_put( &row, "%d", workers_of( s->report, setting ) );
        cells_end_row( &row, table, out );
    }
}

// The loosest limit first.
static void add_summary( const accuracy_report* report, bool is_by_error, results* out )
{
    const int count = report->scene->setting_count;
    const double *error = report->bounded, *ms = report->min_ms;
    summary s = { .report = report,
                  .cost = is_by_error ? ms : error,
                  .limited = is_by_error ? error : ms,
                  .is_by_error = is_by_error,
                  .takes_part = calloc( (size_t)count, sizeof( bool ) ),
                  .best = calloc( (size_t)count, sizeof( int ) ),
                  .tighter = calloc( (size_t)count, sizeof( int ) ) };
    double levels[ACCURACY_LEVELS_MAX];
    // no level is below the doubt
    const int level_count = accuracy_levels( is_by_error ? report->error : ms, count, levels );
    if ( !s.takes_part || !s.best || !s.tighter )
    {
        out->incomplete = true;
    }
    else if ( level_count > 0 )
    {
        const int table = begin_summary( &s, out );
        for ( int k = level_count - 1; k >= 0; --k )
        {
            add_level( &s, levels[k], k > 0 ? levels[k - 1] : 0.0, table, out );
        }
    }
    free( s.takes_part );
    free( s.best );
    free( s.tighter );
}

void accuracy_add_equal_error( const accuracy_report* report, results* out )
{
    add_summary( report, true, out );
}

void accuracy_add_equal_time( const accuracy_report* report, results* out )
{
    add_summary( report, false, out );
}

// ---- orders ----

static accuracy_order order_of( const accuracy_report* report, const char* series, double* parameter, double* error )
{
    int count = 0;
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        if ( strcmp( report->scene->settings[i].series, series ) == 0 )
        {
            parameter[count] = report->scene->settings[i].parameter;
            error[count++] = report->error[i];
        }
    }
    return accuracy_observed_order( parameter, error, count );
}

static void add_order( const accuracy_setting* first, const accuracy_order* order, int table, results* out )
{
    results_cells row = { .count = 0 };
    cells_put( &row, "%s\t%s\t%.2f", first->series, first->parameter_name, order->slope );
    accuracy_put_digits( &row, first->order, 2 );
    cells_put( &row, "%d of %d", order->used, order->count );
    cells_end_row( &row, table, out );
}

static int begin_orders( const accuracy_report* report, results* out )
{
    char title[160];
    snprintf(
        title, sizeof( title ),
        "Accuracy `%s`, observed order: error ~ parameter^order, without points where the error no longer falls",
        report->entry->name );
    return results_begin_table( out, title, "series\twhat goes to 0\tobserved order\tpromised\tpoints used" );
}

void accuracy_add_orders( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    double* parameter = calloc( (size_t)scene->setting_count, sizeof( double ) );
    double* error = calloc( (size_t)scene->setting_count, sizeof( double ) );
    int table = -1;
    out->incomplete = out->incomplete || !parameter || !error;
    for ( int i = 0; parameter && error && i < scene->setting_count; ++i )
    {
        if ( accuracy_begins_series( scene, i ) )
        {
            table = table < 0 ? begin_orders( report, out ) : table;
            const accuracy_order order = order_of( report, scene->settings[i].series, parameter, error );
            add_order( &scene->settings[i], &order, table, out );
        }
    }
    free( parameter );
    free( error );
}

// ---- notes ----

static int front_count( const accuracy_report* report )
{
    int count = 0;
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        count += report->on_front[i];
    }
    return count;
}

// The ends of the front in a line above all tables.
void accuracy_add_headline( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    const int fastest =
        accuracy_best_within( report->min_ms, report->error, INFINITY, report->on_front, scene->setting_count );
    const int best =
        accuracy_best_within( report->error, report->min_ms, INFINITY, report->on_front, scene->setting_count );
    char doubt[64] = "", until[100];
    suite_horizon horizon = { 0 };
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        suite_horizon_add( &horizon, scene->settings[i].until, scene->settings[i].is_cut );
    }
    suite_horizon_text( &horizon, until, sizeof until );
    if ( scene->uncertainty > 0.0 )
    {
        snprintf( doubt, sizeof doubt, "; the reference is uncertain by %s%.2g %s",
                  scene->group_count > 1 ? "up to " : "", scene->uncertainty, scene->error_unit );
    }
    if ( out->headline_count == RESULTS_MAX_HEADLINES || fastest < 0 || best < 0 )
    {
        return;
    }
    if ( scene->group_count > 1 )
    {
        results_add_headline( out,
                              "Accuracy `%s`: %d settings of %d scenes, each compared with its own reference%s%s",
                              report->entry->name, scene->setting_count, scene->group_count, until, doubt );
        return;
    }
    results_add_headline( out, "Accuracy `%s`: from %.3g %s in %.3g ms (%s) to %.3g %s in %.3g ms (%s)%s%s",
                          report->entry->name, report->error[fastest], scene->error_unit, report->min_ms[fastest],
                          scene->settings[fastest].name, report->error[best], scene->error_unit, report->min_ms[best],
                          scene->settings[best].name, until, doubt );
}

// The doubts of all errors beside each other.
static void add_doubts( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    char measures[400] = "";
    for ( int i = 0; i < scene->measure_count; ++i )
    {
        const size_t used = strlen( measures );
        if ( scene->measure_doubts[i] > 0.0 )
        {
            snprintf( measures + used, sizeof measures - used, "; %.60s: %.3g", scene->measure_names[i],
                      scene->measure_doubts[i] );
        }
    }
    results_add_note(
        out,
        "Accuracy `%s`: The reference is uncertain by %s%.3g %s%s. Smaller errors are `below`: they are "
        "not resolved, on no front and in no order.",
        report->entry->name, scene->group_count > 1 ? "up to " : "", scene->uncertainty, scene->error_unit,
        measures );
}

void accuracy_add_notes( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    char error[80];
    accuracy_error_label( scene, error, sizeof( error ) );
    if ( scene->error_name[0] != '\0' )
    {
        results_add_note(
            out,
            "Accuracy `%s`: the error (%s) is measured against %s. Times are medians; the column `timed` "
            "has the number of steps. Halted runs have no error and no times.",
            report->entry->name, error, scene->reference );
    }
    if ( !scene->has_no_rivals )
    {
        results_add_note( out,
                          "Accuracy `%s`, `front`: no other setting is both faster and more accurate; %d of %d are "
                          "on it. Each setting counts with its faster number of workers.",
                          report->entry->name, front_count( report ), scene->setting_count );
    }
    if ( scene->uncertainty > 0.0 )
    {
        add_doubts( report, out );
    }
    if ( report->left_out > 0 )
    {
        results_add_note( out, "%s `%s`: a quick run has %d of %d settings: %s.", accuracy_kind( scene ),
                          report->entry->name, scene->setting_count, scene->setting_count + report->left_out,
                          accuracy_names_quick( report->entry->suite )
                              ? "those that the suite names as quick"
                              : "the coarsest and the middle one of every series, and the finest of the first" );
    }
    for ( int i = 0; i < 2; ++i )
    {
        const char* note = i == 0 ? scene->chaos : scene->note;
        if ( note )
        {
            results_add_note( out, "%s `%s`: %s", accuracy_kind( scene ), report->entry->name, note );
        }
    }
}
