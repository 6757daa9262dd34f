// Tables and charts of a scene.
#include "accuracy/accuracy_parts.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

// ---- labels ----

const char* accuracy_kind( const accuracy_scene* scene )
{
    return scene->error_name[0] ? "Accuracy" : "Suite";
}

static const char* accuracy_ms_name( const accuracy_scene* scene )
{
    return scene->ms_name[0] ? scene->ms_name : "step";
}

void accuracy_error_label( const accuracy_scene* scene, char* text, int size )
{
    snprintf( text, (size_t)size, scene->error_unit[0] ? "%s, %s" : "%s", scene->error_name, scene->error_unit );
}

// "2 workers"
static void accuracy_workers_label( int workers, char* text, int size )
{
    snprintf( text, (size_t)size, "%d %s", workers, bench_workers_word( workers ) );
}

void accuracy_put_digits( results_cells* row, double value, int digits )
{
    const double size = fabs( value );
    if ( !isfinite( value ) || size == 0.0 )
    {
        cells_put( row, "%.0f", value );
    }
    else if ( size < 1e-4 || size >= 1e7 )
    {
        cells_put( row, "%.*e", digits - 1, value );
    }
    else
    {
        const int behind = digits - 1 - (int)floor( log10( size ) );
        cells_put( row, "%.*f", behind > 0 ? behind : 0, value );
    }
}

double accuracy_doubt( const accuracy_scene* scene, int setting )
{
    const double own = scene->settings[setting].doubt;
    return own > 0.0 ? own : scene->uncertainty;
}

double accuracy_measure_doubt( const accuracy_scene* scene, int setting, int measure )
{
    const double* own = scene->settings[setting].measure_doubts;
    return ( own ? own : scene->measure_doubts )[measure];
}

bool accuracy_is_below( double error, double doubt )
{
    return doubt > 0.0 && fabs( error ) <= doubt;
}

void accuracy_put_error( results_cells* row, double error, double doubt, int digits )
{
    if ( accuracy_is_below( error, doubt ) )
    {
        cells_put( row, "below" );
    }
    else
    {
        accuracy_put_digits( row, error, digits );
    }
}

const char* accuracy_method_of( const accuracy_setting* setting )
{
    return setting->method[0] ? setting->method : setting->series[0] ? setting->series : setting->name;
}

bool accuracy_begins_series( const accuracy_scene* scene, int setting )
{
    const accuracy_setting* settings = scene->settings;
    bool begins = settings[setting].series[0] != '\0';
    for ( int i = 0; i < setting && begins; ++i )
    {
        begins = strcmp( settings[i].series, settings[setting].series ) != 0;
    }
    return begins;
}

// ---- tables ----

// The table of all settings of a scene, and the same as rows for machines.

// ---- for readers ----

static int begin_table( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    results_cells row = { .count = 0 };
    char label[80], workers[24];
    cells_put( &row, "setting" );
    for ( int w = 0; w < report->worker_count; ++w )
    {
        accuracy_workers_label( report->workers[w], workers, sizeof( workers ) );
        cells_put( &row, "%s ms", workers );
    }
    if ( scene->paper_ms != NULL )
    {
        cells_put( &row, "FPS\tpaper, ms\tpaper, FPS" );
    }
    accuracy_error_label( scene, label, sizeof( label ) );
    if ( scene->error_name[0] != '\0' )
    {
        cells_put( &row, "%s", label );
    }
    for ( int i = 0; i < scene->measure_count - scene->contact_measures; ++i )
    {
        cells_put( &row, "%s", scene->measure_names[i] );
    }
    cells_put( &row, "timed" );
    if ( !scene->has_no_rivals )
    {
        cells_put( &row, "front" );
    }
    cells_put( &row, "hash" );
    char title[160];
    snprintf( title, sizeof( title ), "%s `%s`: %s, ms per %s", accuracy_kind( scene ), report->entry->name,
              report->entry->title, accuracy_ms_name( scene ) );
    return cells_begin_table( &row, title, out );
}

static void put_times( const accuracy_report* report, const accuracy_stats* f, results_cells* row )
{
    for ( int w = 0; w < report->worker_count; ++w )
    {
        if ( f->seen.halted_at > 0 )
        {
            cells_put( row, "halted at step %d", f->seen.halted_at );
        }
        else
        {
            accuracy_put_digits( row, f->ms[w].median, 3 );
        }
    }
}

// The steps in the times, of the worker count that has fewer.
static int timed_steps( const accuracy_report* report, const accuracy_stats* f )
{
    const int first = f->ms[0].count, last = f->ms[report->worker_count - 1].count;
    return first < last ? first : last;
}

static void add_line( const accuracy_report* report, int setting, int table, results* out )
{
    const accuracy_stats* f = &report->stats[setting];
    results_cells row = { .count = 0 };
    cells_put( &row, "%s", report->scene->settings[setting].name );
    put_times( report, f, &row );
    if ( report->scene->paper_ms != NULL )
    {
        const double paper = report->scene->paper_ms[setting];
        accuracy_put_digits( &row, 1e3 / f->ms[report->worker_count - 1].median, 3 );
        accuracy_put_digits( &row, paper > 0.0 ? paper : NAN, 3 );
        accuracy_put_digits( &row, paper > 0.0 ? 1e3 / paper : NAN, 3 );
    }
    if ( report->scene->error_name[0] != '\0' )
    {
        accuracy_put_error( &row, f->seen.error, accuracy_doubt( report->scene, setting ), 4 );
    }
    for ( int i = 0; i < report->scene->measure_count - report->scene->contact_measures; ++i )
    {
        accuracy_put_error( &row, f->seen.measures[i], accuracy_measure_doubt( report->scene, setting, i ), 4 );
    }
    cells_put( &row, "%d", timed_steps( report, f ) );
    if ( !report->scene->has_no_rivals )
    {
        cells_put( &row, "%s", report->on_front[setting] ? "front" : "" );
    }
    cells_put( &row, "%016llx", (unsigned long long)f->seen.hash );
    cells_end_row( &row, table, out );
}

void accuracy_add_table( const accuracy_report* report, results* out )
{
    const int table = begin_table( report, out );
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        add_line( report, i, table, out );
    }
}

// @return -1: the scene does not measure it
static int find_measure( const accuracy_scene* scene, const char* name )
{
    int i = scene->measure_count - 1;
    while ( i >= 0 && strcmp( scene->measure_names[i], name ) != 0 )
    {
        --i;
    }
    return i;
}

static void put_measure( const accuracy_report* report, int setting, const char* name, results_cells* row )
{
    const int m = find_measure( report->scene, name );
    if ( m >= 0 )
    {
        accuracy_put_error( row, report->stats[setting].seen.measures[m],
                            accuracy_measure_doubt( report->scene, setting, m ), 4 );
    }
}

static void add_count( const accuracy_report* report, int setting, int worker, int table, results* out )
{
    const accuracy_scene* scene = report->scene;
    const accuracy_stats* f = &report->stats[setting];
    results_cells row = { .count = 0 };
    cells_put( &row, "%s\t%d\t%.0f\t%.0f\t%.0f", scene->settings[setting].name, report->workers[worker],
               f->work.strands, f->work.vertices, f->work.substeps );
    accuracy_put_digits( &row, f->ms[worker].median, 3 );
    accuracy_put_digits( &row, f->ms[worker].p90, 3 );
    accuracy_put_digits( &row, 1e3 / f->ms[worker].median, 3 );
    if ( scene->error_name[0] )
    {
        accuracy_put_error( &row, f->seen.error, accuracy_doubt( scene, setting ), 4 );
        put_measure( report, setting, "largest distance, mm", &row );
        accuracy_put_digits( &row, accuracy_doubt( scene, setting ), 3 );
        accuracy_put_digits( &row, scene->settings[setting].until, 3 );
    }
    put_measure( report, setting, "stretch max, %", &row );
    cells_put( &row, "%.0f", f->work.bytes );
    if ( !scene->has_no_rivals )
    {
        cells_put( &row, "%s", report->on_front[setting] ? "front" : "" );
    }
    cells_end_row( &row, table, out );
}

void accuracy_add_counts( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    results_cells header = { .count = 0 };
    char title[160];
    cells_put( &header, "setting\tworkers\tstrands\tvertices\tsubsteps\tms\tms, p90\tFPS" );
    if ( scene->error_name[0] )
    {
        cells_put( &header, "error, %s", scene->error_unit );
        if ( find_measure( scene, "largest distance, mm" ) >= 0 )
        {
            cells_put( &header, "largest, mm" );
        }
        cells_put( &header, "doubt, %s\tuntil, s", scene->error_unit );
    }
    if ( find_measure( scene, "stretch max, %" ) >= 0 )
    {
        cells_put( &header, "stretch max, %%" );
    }
    cells_put( &header, "bytes" );
    if ( !scene->has_no_rivals )
    {
        cells_put( &header, "front" );
    }
    snprintf( title, sizeof title, "%s `%s`: %s; size, time and error of a %s", accuracy_kind( scene ),
              report->entry->name, report->entry->title, accuracy_ms_name( scene ) );
    const int table = cells_begin_table( &header, title, out );
    for ( int i = 0; i < scene->setting_count * report->worker_count; ++i )
    {
        add_count( report, i / report->worker_count, i % report->worker_count, table, out );
    }
}

void accuracy_add_contact( const accuracy_report* report, results* out )
{
    const accuracy_scene* scene = report->scene;
    const int first = scene->measure_count - scene->contact_measures;
    results_cells header = { .count = 0 };
    char title[160];
    if ( scene->contact_measures == 0 )
    {
        return;
    }
    cells_put( &header, "setting" );
    for ( int m = first; m < scene->measure_count; ++m )
    {
        cells_put( &header, "%s", scene->measure_names[m] );
    }
    snprintf( title, sizeof title, "%s `%s`: contact", accuracy_kind( scene ), report->entry->name );
    const int table = cells_begin_table( &header, title, out );
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        results_cells row = { .count = 0 };
        cells_put( &row, "%s", scene->settings[i].name );
        for ( int m = first; m < scene->measure_count; ++m )
        {
            accuracy_put_digits( &row, report->stats[i].seen.measures[m], 4 );
        }
        cells_end_row( &row, table, out );
    }
}

// ---- what a vertex costs ----

static double ns_per_vertex( const accuracy_stats* f, int worker )
{
    return 1e6 * f->ms[worker].median / ( f->work.vertices * f->work.substeps );
}

static double speed_up( const accuracy_report* report, const accuracy_stats* f )
{
    return report->worker_count > 1 ? f->ms[0].median / f->ms[report->worker_count - 1].median : NAN;
}

void accuracy_add_costs( const accuracy_report* report, results* out )
{
    results_cells header = { .count = 0 };
    char title[160], workers[24];
    cells_put( &header, "setting\tbytes / vertex\tspeed-up" );
    for ( int w = 0; w < report->worker_count; ++w )
    {
        accuracy_workers_label( report->workers[w], workers, sizeof workers );
        cells_put( &header, "%s: mean ms\tlongest\tmean / first\tns / vertex, substep", workers );
    }
    snprintf( title, sizeof title, "%s `%s`: cost per vertex, and spread of times", accuracy_kind( report->scene ),
              report->entry->name );
    const int table = cells_begin_table( &header, title, out );
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        const accuracy_stats* f = &report->stats[i];
        results_cells row = { .count = 0 };
        cells_put( &row, "%s\t%.0f\t%.2f", report->scene->settings[i].name, f->work.bytes / f->work.vertices,
                   speed_up( report, f ) );
        for ( int w = 0; w < report->worker_count; ++w )
        {
            accuracy_put_digits( &row, f->ms[w].mean, 3 );
            accuracy_put_digits( &row, f->ms[w].maximum, 3 );
            cells_put( &row, "%.2f", f->ms[w].mean / report->stats[0].ms[w].mean );
            accuracy_put_digits( &row, ns_per_vertex( f, w ), 3 );
        }
        cells_end_row( &row, table, out );
    }
}

// ---- for machines ----

// "distance to the reference, mm" becomes the value "distance_to_the_reference_mm".
static void value_name( const char* label, char* name, int size )
{
    int length = 0;
    for ( const char* c = label; *c != '\0' && length < size - 8; ++c )
    {
        if ( isalnum( (unsigned char)*c ) )
        {
            name[length++] = *c;
        }
        else if ( *c == '%' )
        {
            length += snprintf( name + length, (size_t)( size - length ), "percent" );
        }
        else if ( length > 0 && name[length - 1] != '_' )
        {
            name[length++] = '_';
        }
    }
    length -= length > 0 && name[length - 1] == '_';
    name[length] = '\0';
}

static void put_finite( results_values* values, const char* label, double value )
{
    if ( isfinite( value ) )
    {
        char name[64];
        value_name( label, name, sizeof( name ) );
        results_put( values, name, value );
    }
}

// An error whose value says nothing is marked by another one.
static void put_error( results_values* values, const char* label, double error, double doubt )
{
    char marked[96];
    put_finite( values, label, error );
    if ( accuracy_is_below( error, doubt ) )
    {
        snprintf( marked, sizeof marked, "%.80s, below", label );
        put_finite( values, marked, 1.0 );
    }
}

static void add_row( const accuracy_report* report, int setting, int worker, results* out )
{
    const accuracy_scene* scene = report->scene;
    const accuracy_setting* what = &scene->settings[setting];
    const accuracy_stats* f = &report->stats[setting];
    char text[80];
    snprintf( text, sizeof( text ), "%s.%s", scene->error_name[0] ? "accuracy" : "suite", report->entry->name );
    results_row* row = results_add_row( out, text, what->name );
    if ( !row )
    {
        return;
    }
    if ( what->series[0] )
    {
        put_finite( &row->size, what->parameter_name, what->parameter );
    }
    if ( f->work.vertices > 0.0 )
    {
        results_put( &row->size, "strands", f->work.strands );
        results_put( &row->size, "vertices", f->work.vertices );
        results_put( &row->size, "substeps", f->work.substeps );
        results_put( &row->size, "bytes", f->work.bytes );
    }
    row->workers = report->workers[worker];
    results_put_times( row, &f->ms[worker] );
    snprintf( row->error_reference, sizeof( row->error_reference ), "%s", scene->reference );
    accuracy_error_label( scene, text, sizeof( text ) );
    if ( scene->error_name[0] != '\0' )
    {
        put_error( &row->error, text, f->seen.error, accuracy_doubt( scene, setting ) );
    }
    if ( what->until > 0.0 )
    {
        snprintf( text, sizeof text, "doubt, %s", scene->error_unit );
        put_finite( &row->error, text, accuracy_doubt( scene, setting ) );
        results_put( &row->error, "until_s", what->until );
    }
    for ( int i = 0; i < scene->measure_count; ++i )
    {
        put_error( &row->error, scene->measure_names[i], f->seen.measures[i],
                   accuracy_measure_doubt( scene, setting, i ) );
    }
    if ( f->seen.halted_at > 0 )
    {
        results_put( &row->error, "halted_at_step", f->seen.halted_at );
    }
    row->hash = f->seen.hash;
    row->has_hash = true;
    put_finite( &row->stages, "mean", f->ms[worker].mean );
    put_finite( &row->stages, "longest", f->ms[worker].maximum );
    profile_samples profile = f->profile[worker];
    for ( int i = 0; i < profile.pass_count && i + 2 < RESULTS_MAX_VALUES; ++i )
    {
        results_put( &row->stages, profile.passes[i].name, 1e3 * profile_samples_median( &profile, i ) );
    }
}

void accuracy_add_rows( const accuracy_report* report, results* out )
{
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        for ( int w = 0; w < report->worker_count; ++w )
        {
            add_row( report, i, w, out );
        }
    }
}

// ---- passes ----

enum
{
    PASSES_SHOWN = 8,
};

// Sum the medians of a pass over all settings, ms.
static double weight_of( const accuracy_report* report, const char* name )
{
    double sum = 0.0;
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        profile_samples profile = report->stats[i].profile[0];
        for ( int p = 0; p < profile.pass_count; ++p )
        {
            sum += strcmp( profile.passes[p].name, name ) == 0 ? 1e3 * profile_samples_median( &profile, p ) : 0.0;
        }
    }
    return sum;
}

// Find the passes that take most of the time. @return their number
static int choose_passes( const accuracy_report* report, const char* names[PASSES_SHOWN] )
{
    double weights[PASSES_SHOWN];
    int count = 0;
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        const profile_samples* profile = &report->stats[i].profile[0];
        for ( int p = 0; p < profile->pass_count; ++p )
        {
            const char* name = profile->passes[p].name;
            bool is_known = false;
            for ( int k = 0; k < count; ++k )
            {
                is_known = is_known || strcmp( names[k], name ) == 0;
            }
            const double weight = is_known ? 0.0 : weight_of( report, name );
            int place = is_known ? PASSES_SHOWN : count;
            while ( place > 0 && place <= count && weights[place - 1] < weight )
            {
                --place;
            }
            if ( place >= PASSES_SHOWN )
            {
                continue;
            }
            count += count < PASSES_SHOWN ? 1 : 0;
            for ( int k = count - 1; k > place; --k )
            {
                names[k] = names[k - 1];
                weights[k] = weights[k - 1];
            }
            names[place] = name;
            weights[place] = weight;
        }
    }
    return count;
}

static void add_passes_of( const accuracy_report* report, int setting, int worker, const char* const* names,
                           int count, int table, results* out )
{
    profile_samples profile = report->stats[setting].profile[worker];
    double all = 0.0, shown = 0.0;
    results_cells row = { .count = 0 };
    cells_put( &row, "%s", report->scene->settings[setting].name );
    for ( int k = 0; k < count; ++k )
    {
        double ms = NAN;
        for ( int p = 0; p < profile.pass_count; ++p )
        {
            ms = strcmp( profile.passes[p].name, names[k] ) == 0 ? 1e3 * profile_samples_median( &profile, p ) : ms;
        }
        shown += isfinite( ms ) ? ms : 0.0;
        accuracy_put_digits( &row, ms, 3 );
    }
    for ( int p = 0; p < profile.pass_count; ++p )
    {
        all += 1e3 * profile_samples_median( &profile, p );
    }
    accuracy_put_digits( &row, fmax( all - shown, 0.0 ), 3 );
    cells_end_row( &row, table, out );
}

static void add_pass_table( const accuracy_report* report, const char* const* names, int count, int worker,
                            results* out )
{
    results_cells header = { .count = 0 };
    cells_put( &header, "setting" );
    for ( int k = 0; k < count; ++k )
    {
        cells_put( &header, "%s", names[k] );
    }
    cells_put( &header, "all others" );
    char title[160], workers[24];
    accuracy_workers_label( report->workers[worker], workers, sizeof workers );
    snprintf( title, sizeof title, "%s `%s`: ms of a step by pass, %s", accuracy_kind( report->scene ),
              report->entry->name, worker == 0 ? "one worker" : workers );
    const int table = cells_begin_table( &header, title, out );
    for ( int i = 0; i < report->scene->setting_count; ++i )
    {
        add_passes_of( report, i, worker, names, count, table, out );
    }
}

void accuracy_add_passes( const accuracy_report* report, results* out )
{
    const char* names[PASSES_SHOWN];
    const int count = choose_passes( report, names );
    for ( int w = 0; w < report->worker_count && count > 0; ++w )
    {
        add_pass_table( report, names, count, w, out );
    }
}

// ---- charts ----

// Charts of the tables: error against time, and error against what tends to 0.

static void add_point( const accuracy_report* report, int setting, double x, int chart, int series, results* out )
{
    const bool is_below = accuracy_is_below( report->bounded[setting], accuracy_doubt( report->scene, setting ) );
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
                  " Points called `below` stand at the doubt of their reference, %s%.3g %s.",
                  report->scene->group_count > 1 ? "up to " : "", report->scene->uncertainty,
                  report->scene->error_unit );
    }
}

// ---- error against time ----

// The line that a setting is on: its series, its scene if there are several, or that of all others.
static const char* line_of( const accuracy_scene* scene, int setting )
{
    const accuracy_setting* s = &scene->settings[setting];
    return s->series[0] ? s->series : scene->group_count > 1 ? s->method : "other settings";
}

static void add_line_from( const accuracy_report* report, int first, int chart, results* out )
{
    const accuracy_scene* scene = report->scene;
    const char* name = line_of( scene, first );
    bool begins = true;
    for ( int i = 0; i < first; ++i )
    {
        begins = begins && strcmp( line_of( scene, i ), name ) != 0;
    }
    const bool is_joined = scene->settings[first].series[0] || scene->group_count > 1;
    const int series = begins ? results_add_series( out, chart, name, is_joined ) : -1;
    for ( int i = first; i < scene->setting_count && begins; ++i )
    {
        if ( strcmp( line_of( scene, i ), name ) == 0 )
        {
            add_point( report, i, report->min_ms[i], chart, series, out );
        }
    }
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
        add_line_from( report, i, chart, out );
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
