// Runs all settings of a scene: once sampled, then in turns for the times.
#include "accuracy_parts.h"

#include "interruption.h"

#include <math.h>
#include <stdlib.h>

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

wisp_status accuracy_run_settings( const accuracy_report* report, double seconds, const bench_options* options,
                                   const double fraction[2], accuracy_stats* stats, results* out, wisp_error* error )
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
