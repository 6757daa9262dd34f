// The case `accuracy`: its scenes one after another, each with a fraction of the time.
#include "accuracy_parts.h"

#include "accuracy_compare.h"
#include "accuracy_labels.h"
#include "program_data.h"
#include "stability/stability_suite.h"
#include "suite/suite_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ACCURACY_SCENE( name, title, function ) accuracy_scene_fn function;
#define ACCURACY_SUITE( name, title )
#include "scenes.inc"
#undef ACCURACY_SCENE
#undef ACCURACY_SUITE

// The last item only keeps the table from being empty.
#define ACCURACY_SUITE( name, title ) { name, title, NULL, NULL },
#define ACCURACY_SCENE( name, title, function ) { name, title, function, NULL },
static const accuracy_entry all_entries[] = {
#include "scenes.inc"
    { NULL, NULL, NULL, NULL },
};
#undef ACCURACY_SCENE
#undef ACCURACY_SUITE

// Time of a scene unless the command line limits the case.
#define SCENE_SECONDS 24.0
// A quick run divides the time of the case, less what expensive scenes take beyond their fraction because every
// setting runs once. A scene that is chosen alone is limited to the second number.
#define QUICK_FRACTION 0.75
#define SCENE_SECONDS_QUICK 7.0

const accuracy_entry* accuracy_entries( int* count )
{
    *count = WISP_COUNT( all_entries ) - 1;
    return all_entries;
}

// ---- a scene ----

static void free_report( accuracy_report* report )
{
    for ( int w = 0; w < ACCURACY_WORKERS_MAX; ++w )
    {
        free( report->ms[w] );
    }
    free( report->on_front );
    free( report->error );
    free( report->bounded );
    free( report->min_ms );
}

// The columns that are compared, and their front.
static wisp_status fill_report( accuracy_report* report, wisp_error* error )
{
    const int count = report->scene->setting_count;
    report->error = calloc( (size_t)count, sizeof( double ) );
    report->bounded = calloc( (size_t)count, sizeof( double ) );
    report->min_ms = calloc( (size_t)count, sizeof( double ) );
    report->on_front = calloc( (size_t)count, sizeof( bool ) );
    bool has_room = report->error && report->bounded && report->min_ms && report->on_front;
    for ( int w = 0; w < report->worker_count; ++w )
    {
        report->ms[w] = calloc( (size_t)count, sizeof( double ) );
        has_room = has_room && report->ms[w];
    }
    if ( !has_room )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory to compare %d settings", count );
    }
    for ( int i = 0; i < count; ++i )
    {
        const double measured = report->stats[i].seen.error, doubt = report->scene->uncertainty;
        const bool is_below = accuracy_is_below( measured, doubt );
        report->error[i] = is_below ? NAN : measured;
        report->bounded[i] = is_below ? doubt : measured;
        report->min_ms[i] = NAN;
        for ( int w = 0; w < report->worker_count; ++w )
        {
            report->ms[w][i] = report->stats[i].ms[w].median;
            report->min_ms[i] = fmin( report->min_ms[i], report->ms[w][i] );
        }
    }
    if ( !report->scene->has_no_rivals )
    {
        accuracy_front( report->error, report->min_ms, count, report->on_front );
    }
    return WISP_OK;
}

static void write_report( const accuracy_report* report, results* out )
{
    accuracy_add_table( report, out );
    accuracy_add_contact( report, out );
    if ( report->entry->suite )
    {
        accuracy_add_costs( report, out );
        accuracy_add_times( report, out );
    }
    accuracy_add_rows( report, out );
    if ( !report->scene->has_no_rivals )
    {
        accuracy_add_headline( report, out );
        accuracy_add_equal_error( report, out );
        accuracy_add_equal_time( report, out );
    }
    if ( report->scene->error_name[0] != '\0' )
    {
        accuracy_add_orders( report, out );
    }
    accuracy_add_passes( report, out );
    if ( report->scene->error_name[0] != '\0' )
    {
        accuracy_add_charts( report, out );
    }
    accuracy_add_notes( report, out );
}

static wisp_status run_scene( accuracy_report* report, double seconds, const bench_options* options,
                              const double fraction[2], results* out, wisp_error* error )
{
    const int count = report->scene->setting_count;
    accuracy_stats* stats = calloc( (size_t)count, sizeof( accuracy_stats ) );
    if ( !stats )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for the figures of %d settings", count );
    }
    report->stats = stats;
    wisp_status status = accuracy_run_settings( report, seconds, options, fraction, stats, out, error );
    status = status == WISP_OK ? fill_report( report, error ) : status;
    if ( status == WISP_OK )
    {
        write_report( report, out );
    }
    free_report( report );
    for ( int i = 0; i < count; ++i )
    {
        for ( int w = 0; w < ACCURACY_WORKERS_MAX; ++w )
        {
            profile_samples_free( &stats[i].profile[w] );
        }
    }
    free( stats );
    return status;
}

// The settings, before any of them runs.
static wisp_status choose_and_run( accuracy_report* report, accuracy_scene* scene, double seconds,
                                   const bench_options* options, const double fraction[2], results* out,
                                   wisp_error* error )
{
    const int all = scene->setting_count;
    int* numbers = calloc( (size_t)all, sizeof( int ) );
    if ( !numbers )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory to choose of %d settings", all );
    }
    for ( int i = 0; i < all; ++i )
    {
        numbers[i] = i;
    }
    if ( options->quick )
    {
        accuracy_thin( scene, report->entry->suite, numbers );
    }
    report->numbers = numbers;
    report->left_out = all - scene->setting_count;
    const wisp_status status = run_scene( report, seconds, options, fraction, out, error );
    free( numbers );
    return status;
}

static wisp_status make_and_run( const accuracy_entry* entry, double seconds, const bench_options* options,
                                 const double fraction[2], results* out, wisp_error* error )
{
    accuracy_scene scene = { .setting_count = 0 };
    accuracy_report report = { .entry = entry, .scene = &scene, .workers = { 1, options->workers } };
    report.worker_count = options->workers > 1 ? 2 : 1;
    char what[100];
    snprintf( what, sizeof( what ), "%s: the reference", entry->name );
    bench_progress( options, fraction[0], what );
    const double begin = wisp_clock_seconds();
    wisp_status status = entry->suite ? suite_study_make( entry->suite, options, &scene, error )
                                      : entry->make( options, seconds, &scene, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    WISP_ASSERT( scene.setting_count > 0 && scene.measure_count <= ACCURACY_MEASURES_MAX );
    const double left = seconds - ( wisp_clock_seconds() - begin );
    status = choose_and_run( &report, &scene, left, options, fraction, out, error );
    if ( scene.destroy )
    {
        scene.destroy( scene.context );
    }
    free( scene.settings );
    return status;
}

// A scene without a function is a suite among the project's data.
static wisp_status run_entry( const accuracy_entry* entry, double seconds, const bench_options* options,
                              const double fraction[2], results* out, wisp_error* error )
{
    if ( entry->make || entry->suite )
    {
        return make_and_run( entry, seconds, options, fraction, out, error );
    }
    char inner[128], path[1024];
    wisp_suite suite;
    snprintf( inner, sizeof inner, "suites/accuracy/%s.yaml", entry->name );
    program_data_path( inner, path, sizeof path );
    wisp_status status = suite_read( path, &suite, error );
    const accuracy_entry read = { entry->name, entry->title, NULL, &suite };
    status = status == WISP_OK ? make_and_run( &read, seconds, options, fraction, out, error ) : status;
    suite_release( &suite );
    return status;
}

wisp_status accuracy_bench_run( const accuracy_entry* entries, int count, double seconds,
                                const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const double fraction[2] = { (double)i / count, 1.0 / count };
        status = run_entry( &entries[i], seconds, options, fraction, out, error );
    }
    return status;
}

wisp_status suite_bench_rows( const wisp_suite* suite, const bench_options* options, results* out, wisp_error* error )
{
    const accuracy_entry entry = { suite->name, suite->title[0] ? suite->title : suite->name, NULL, suite };
    const double seconds = options->seconds > 0.0 ? options->seconds
                           : options->quick       ? SCENE_SECONDS_QUICK
                                                  : SCENE_SECONDS;
    return accuracy_bench_run( &entry, 1, seconds, options, out, error );
}

wisp_status suite_bench( const char* path, const bench_options* options, results* out, wisp_error* error )
{
    wisp_suite suite;
    wisp_status status = suite_read( path, &suite, error );
    if ( status == WISP_OK && suite.has_checks )
    {
        stability_tally tally = { 0 };
        status = stability_bench_suite( &suite, options, &tally, out, error );
        stability_note( &tally, suite.name, out );
    }
    else if ( status == WISP_OK )
    {
        status = suite_bench_rows( &suite, options, out, error );
    }
    suite_release( &suite );
    return status;
}

wisp_status accuracy_bench( const bench_options* options, results* out, wisp_error* error )
{
    accuracy_entry chosen[WISP_COUNT( all_entries )];
    int count, chosen_count = 0;
    const accuracy_entry* entries = accuracy_entries( &count );
    for ( int i = 0; i < count; ++i )
    {
        if ( options->scenes == 0 || ( options->scenes >> i & 1 ) )
        {
            chosen[chosen_count++] = entries[i];
        }
    }
    const double fraction = bench_seconds( options ) / ( chosen_count > 0 ? chosen_count : 1 );
    const double each = options->seconds > 0.0 ? fraction
                        : options->quick       ? fmin( QUICK_FRACTION * fraction, SCENE_SECONDS_QUICK )
                                               : SCENE_SECONDS;
    return accuracy_bench_run( chosen, chosen_count, each, options, out, error );
}
