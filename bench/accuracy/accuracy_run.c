// The case `accuracy`: scenes, the settings of quick runs, and runs.
#include "accuracy/accuracy_parts.h"
#include "interruption.h"
#include "stability/stability_bench.h"
#include "suite_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- quick runs ----

// Selects the settings of a quick run.

// Rank of a setting in its series: 0 is the coarsest.
static int rank_of( const accuracy_scene* scene, int setting, int* series_count )
{
    const accuracy_setting* mine = &scene->settings[setting];
    int rank = 0;
    *series_count = 0;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( strcmp( scene->settings[i].series, mine->series ) == 0 )
        {
            rank += scene->settings[i].parameter > mine->parameter ? 1 : 0;
            ++*series_count;
        }
    }
    return rank;
}

static const char* first_series( const accuracy_scene* scene )
{
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( scene->settings[i].series[0] != '\0' )
        {
            return scene->settings[i].series;
        }
    }
    return "";
}

static bool is_kept( const accuracy_scene* scene, int setting, const char* first )
{
    const char* series = scene->settings[setting].series;
    if ( series[0] == '\0' )
    {
        return true;
    }
    int count;
    const int rank = rank_of( scene, setting, &count );
    return rank == 0 || rank == count / 2 || ( rank == count - 1 && strcmp( series, first ) == 0 );
}

bool accuracy_names_quick( const wisp_suite* suite )
{
    for ( int i = 0; suite && i < suite->row_count; ++i )
    {
        if ( suite->rows[i].is_slow )
        {
            return true;
        }
    }
    return false;
}

void accuracy_thin( accuracy_scene* scene, const wisp_suite* suite, int* numbers )
{
    const char* first = first_series( scene );
    const bool is_named = accuracy_names_quick( suite );

    // All are chosen before any is moved, because ranks refer to all.
    int kept = 0;
    for ( int i = 0; i < scene->setting_count; ++i )
    {
        if ( is_named ? !suite->rows[i].is_slow : is_kept( scene, i, first ) )
        {
            numbers[kept++] = i;
        }
    }
    for ( int k = 0; k < kept; ++k )
    {
        scene->settings[k] = scene->settings[numbers[k]];
    }
    scene->setting_count = kept;
}

// ---- runs ----

// Runs all settings of a scene: once sampled, then in turns for the times.

enum
{
    ROUNDS_MAX = 64,
    SAMPLES_ENOUGH = 4000, // per setting and worker count: more do not improve the statistics
};

/// The times of a setting with a worker count.
typedef struct timed_implementation
{
    double* samples;
    int count, capacity;
    double spent, cost; // s: of all runs, of the last one
} timed_implementation;

typedef struct contest
{
    const accuracy_report* report;
    const bench_options* options;
    accuracy_stats* stats;
    timed_implementation* implementations; // [setting_count][worker_count]
    double begin, end;                     // s on the clock
    double fraction[2];
    results* out;
} contest;

// ---- samples ----

static wisp_status keep( double** samples, int* count, int* capacity, double ms )
{
    if ( *count == *capacity )
    {
        const int longer = *capacity > 0 ? 2 * *capacity : 256;
        double* grown = realloc( *samples, (size_t)longer * sizeof( double ) );
        if ( !grown )
        {
            return WISP_NO_MEMORY;
        }
        *samples = grown;
        *capacity = longer;
    }
    ( *samples )[( *count )++] = ms;
    return WISP_OK;
}

wisp_status accuracy_keep_ms( accuracy_run* run, double ms )
{
    return keep( &run->ms, &run->ms_count, &run->ms_capacity, ms );
}

// The first step of a run makes the plan and fills the caches. It counts only if there is no other.
static wisp_status keep_run( const accuracy_run* run, timed_implementation* to, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = run->ms_count > 1 ? 1 : 0; i < run->ms_count && status == WISP_OK; ++i )
    {
        status = keep( &to->samples, &to->count, &to->capacity, run->ms[i] );
    }
    return status == WISP_OK ? WISP_OK : wisp_fail( error, status, "no memory for the times of a setting" );
}

// ---- a run ----

static accuracy_run empty_run( void )
{
    accuracy_run run = { .error = NAN };
    for ( int i = 0; i < ACCURACY_MEASURES_MAX; ++i )
    {
        run.measures[i] = NAN;
    }
    return run;
}

static void forget_times( accuracy_run* run )
{
    free( run->ms );
    run->ms = NULL;
    run->ms_count = run->ms_capacity = 0;
    profile_samples_free( &run->profile );
}

static void show_progress( const contest* c, int setting, bool is_observed )
{
    const accuracy_scene* scene = c->report->scene;
    char what[256];
    snprintf( what, sizeof( what ), "%s: %s", c->report->entry->name, scene->settings[setting].name );
    const double observed = is_observed ? 0.0 : 1.0 / 3.0;
    const double part = observed + ( is_observed ? 1.0 : 2.0 ) / 3.0 * setting / scene->setting_count;
    const double time = ( wisp_clock_seconds() - c->begin ) / fmax( c->end - c->begin, 1e-9 );
    const double done = fmin( fmax( part, time ), 1.0 );
    bench_progress( c->options, c->fraction[0] + c->fraction[1] * done, what );
}

static wisp_status observe( contest* c, int setting, wisp_error* error )
{
    const accuracy_scene* scene = c->report->scene;
    accuracy_run* seen = &c->stats[setting].seen;
    show_progress( c, setting, true );
    *seen = empty_run();
    wisp_status status = scene->run( scene->context, c->report->numbers[setting], 1, true, seen, error );
    forget_times( seen );
    // a halted run has no error
    seen->error = seen->halted_at > 0 ? NAN : seen->error;
    return status;
}

static void check( const contest* c, int setting, int workers, const accuracy_run* run )
{
    const char *scene = c->report->entry->name, *name = c->report->scene->settings[setting].name;
    const accuracy_run* seen = &c->stats[setting].seen;
    const char* word = bench_workers_word( workers );
    if ( run->halted_at != seen->halted_at )
    {
        results_add_failure(
            c->out,
            "accuracy.%s, %s: with %d %s the run halted at step %d, but the sampled run at step %d (0: never).",
            scene, name, workers, word, run->halted_at, seen->halted_at );
    }
    else if ( run->hash != seen->hash )
    {
        results_add_failure(
            c->out, "accuracy.%s, %s: hash %016llx with %d %s, expected %016llx of the sampled run with one worker.",
            scene, name, (unsigned long long)run->hash, workers, word, (unsigned long long)seen->hash );
    }
}

static wisp_status take_turn( contest* c, int setting, int worker, wisp_error* error )
{
    const accuracy_scene* scene = c->report->scene;
    const int workers = c->report->workers[worker];
    timed_implementation* implementation = &c->implementations[setting * c->report->worker_count + worker];
    accuracy_run run = empty_run();
    const double begin = wisp_clock_seconds();
    wisp_status status = scene->run( scene->context, c->report->numbers[setting], workers, false, &run, error );
    implementation->cost = wisp_clock_seconds() - begin;
    implementation->spent += implementation->cost;
    if ( status == WISP_OK )
    {
        check( c, setting, workers, &run );
        if ( implementation->count == 0 )
        {
            c->stats[setting].profile[worker] = run.profile;
            run.profile = ( profile_samples ){ 0 };
            c->stats[setting].work = run.work;
        }
        status = keep_run( &run, implementation, error );
    }
    forget_times( &run );
    return status;
}

// ---- rounds ----

// A setting that has used its fraction of the time sits out, so that cheap settings do not wait for expensive ones.
static bool has_turn( const contest* c, int setting, int worker, int round, double fraction )
{
    const timed_implementation* implementation = &c->implementations[setting * c->report->worker_count + worker];
    const bool is_halted = c->stats[setting].seen.halted_at > 0;
    return round == 0 || ( !is_halted && implementation->count < SAMPLES_ENOUGH &&
                           implementation->spent + implementation->cost <= fraction );
}

static wisp_status run_round( contest* c, int round, double fraction, bool* has_run, wisp_error* error )
{
    wisp_status status = WISP_OK;
    *has_run = false;
    for ( int i = 0; i < c->report->scene->setting_count; ++i )
    {
        for ( int w = 0; w < c->report->worker_count && status == WISP_OK; ++w )
        {
            if ( has_turn( c, i, w, round, fraction ) && ( round == 0 || wisp_clock_seconds() < c->end ) )
            {
                show_progress( c, i, false );
                status = take_turn( c, i, w, error );
                *has_run = true;
            }
        }
    }
    return status;
}

static wisp_status run_all( contest* c, wisp_error* error )
{
    const int settings = c->report->scene->setting_count;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < settings && status == WISP_OK; ++i )
    {
        status = observe( c, i, error );
    }
    const double left = fmax( c->end - wisp_clock_seconds(), 0.0 );
    const double fraction = left / ( settings * c->report->worker_count );
    bool has_run = true;
    for ( int round = 0; round < ROUNDS_MAX && has_run && status == WISP_OK; ++round )
    {
        status = run_round( c, round, fraction, &has_run, error );
        // Every setting has a sample after the first round: the rest may be missing.
        if ( round > 0 && status == WISP_CONFLICT && interruption_came() )
        {
            status = WISP_OK;
            has_run = false;
        }
    }
    return status;
}

static void conclude( contest* c )
{
    const int worker_count = c->report->worker_count;
    for ( int i = 0; i < c->report->scene->setting_count; ++i )
    {
        for ( int w = 0; w < ACCURACY_WORKERS_MAX; ++w )
        {
            const bool counts = w < worker_count && c->stats[i].seen.halted_at == 0;
            timed_implementation* implementation = counts ? &c->implementations[i * worker_count + w] : NULL;
            c->stats[i].ms[w] =
                stats_summarise( counts ? implementation->samples : NULL, counts ? implementation->count : 0 );
        }
    }
}

// Run each setting once sampled, then timed in turns with every worker count, as long as there is time, at least
// once. A hash that differs from that of the sampled run is a failure in the results.
// @param fraction of the case's progress: where the scene begins and its length
// @param stats [setting_count] receives the results
static wisp_status accuracy_run_settings( const accuracy_report* report, double seconds, const bench_options* options,
                                          const double fraction[2], accuracy_stats* stats, results* out,
                                          wisp_error* error )
{
    const int count = report->scene->setting_count * report->worker_count;
    contest c = { .report = report, .options = options, .stats = stats, .out = out };
    c.begin = wisp_clock_seconds();
    c.end = c.begin + seconds;
    c.fraction[0] = fraction[0];
    c.fraction[1] = fraction[1];
    c.implementations = calloc( (size_t)count, sizeof( timed_implementation ) );
    wisp_status status = c.implementations
                             ? run_all( &c, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "no memory for the times of %d runs", count );
    if ( status == WISP_OK )
    {
        conclude( &c );
    }
    for ( int i = 0; c.implementations && i < count; ++i )
    {
        free( c.implementations[i].samples );
    }
    free( c.implementations );
    return status;
}

// ---- the case ----

// Time of a suite unless the command line limits it. A quick run divides the time of the case, less what expensive scenes take beyond
// their fraction because every setting runs once.
#define SCENE_SECONDS 24.0
#define QUICK_FRACTION 0.75
#define SCENE_SECONDS_QUICK 7.0

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
        const double measured = report->stats[i].seen.error, doubt = accuracy_doubt( report->scene, i );
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
        accuracy_front( report->error, report->min_ms, report->scene->settings, count, report->on_front );
    }
    return WISP_OK;
}

static void write_report( const accuracy_report* report, results* out )
{
    if ( report->entry->suite )
    {
        accuracy_add_counts( report, out );
    }
    accuracy_add_table( report, out );
    accuracy_add_contact( report, out );
    if ( report->entry->suite )
    {
        accuracy_add_costs( report, out );
    }
    accuracy_add_rows( report, out );
    if ( !report->scene->has_no_rivals )
    {
        accuracy_add_headline( report, out );
    }
    if ( !report->scene->has_no_rivals && report->scene->group_count < 2 )
    {
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
                                      : entry->make( entry->subject, options, seconds, &scene, error );
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

wisp_status accuracy_bench_run( const accuracy_entry* entries, int count, double seconds,
                                const bench_options* options, results* out, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < count && status == WISP_OK; ++i )
    {
        const double fraction[2] = { (double)i / count, 1.0 / count };
        status = make_and_run( &entries[i], seconds, options, fraction, out, error );
    }
    return status;
}

wisp_status suite_bench_rows( const wisp_suite* suite, const bench_options* options, results* out, wisp_error* error )
{
    const accuracy_entry entry = { suite->name, suite->title[0] ? suite->title : suite->name, NULL, suite, NULL };
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
        stability_counts tally = { 0 };
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
    const double seconds = options->seconds > 0.0 ? options->seconds
                           : options->quick       ? QUICK_FRACTION * bench_seconds( options )
                                                  : 0.0; // of each suite
    return suite_bench_folder( "accuracy", seconds, options, out, error );
}
