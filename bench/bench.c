// What all cases share: their table, their options, and times by turns.
#include "bench.h"

#include "interruption.h"
#include "machine.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- cases ----

// Every case's function, then the table of them, from the one list.
#define BENCH_CASE( name, purpose, function ) bench_case_fn function;
#include "cases.inc"
#undef BENCH_CASE

// Run a case and say in one line how it went.
static wisp_status run_case( const char* name, bench_case_fn* run, const bench_options* options, results* out,
                             wisp_error* error )
{
    const int first_note = out->note_count, first_table = out->table_count, first_row = out->row_count;
    const int first_claim = out->claim_count, first_met = out->claims_met;
    const wisp_status status = run( options, out, error );
    int failures = 0;
    for ( int i = first_note; i < out->note_count; ++i )
    {
        failures += strncmp( out->notes[i], "FAILED", 6 ) == 0 ? 1 : 0;
    }
    char checks[64] = "all checks passed", claims[100] = "";
    if ( failures > 0 )
    {
        snprintf( checks, sizeof( checks ), "%d checks FAILED", failures );
    }
    if ( out->claim_count > first_claim )
    {
        snprintf( claims, sizeof( claims ), "; %d of %d claims of speed are met on this machine",
                  out->claims_met - first_met, out->claim_count - first_claim );
    }
    if ( status == WISP_OK )
    {
        results_add_headline( out, "%s: %s%s; %d measurements in %d tables.", name, checks, claims,
                              out->row_count - first_row, out->table_count - first_table );
    }
    return status;
}

#define BENCH_CASE( name, purpose, function )                                                                        \
    static wisp_status run_##function( const bench_options* options, results* out, wisp_error* error )               \
    {                                                                                                                \
        return run_case( name, function, options, out, error );                                                      \
    }
#include "cases.inc"
#undef BENCH_CASE

#define BENCH_CASE( name, purpose, function ) { name, purpose, run_##function },
static const bench_case all_cases[] = {
#include "cases.inc"
};
#undef BENCH_CASE

const bench_case* bench_cases( int* count )
{
    *count = WISP_COUNT( all_cases );
    return all_cases;
}

// ---- options ----

bench_options bench_default_options( void )
{
    return ( bench_options ){ .workers = 2 };
}

double bench_seconds( const bench_options* options )
{
    return options->seconds > 0.0 ? options->seconds : options->quick ? 18.0 : 85.0;
}

const char* bench_workers_word( int workers )
{
    return workers == 1 ? "worker" : "workers";
}

void bench_progress( const bench_options* options, double fraction, const char* what )
{
    if ( options->progress )
    {
        options->progress( options->progress_user, fraction, what );
    }
}

// ---- variants that are timed in turns ----

// Steps of a turn together take about this long: long enough to leave the previous variant's cache behind, short
// enough that a disturbance of a second hits every variant. Beside a variant whose single step takes much longer, a
// turn may take this share of it.
#define SHORT_TURN_MS 10.0
#define TURN_FRACTION 0.25
#define TURN_STEPS_MAX 32

static wisp_status time_variant( bench_variant* variant, double* ms, wisp_error* error )
{
    double start = wisp_clock_seconds();
    wisp_status status = variant->step( variant->context, error );
    *ms = 1e3 * ( wisp_clock_seconds() - start );
    return status;
}

// The first step pays for buffers and page faults; only the second says what a step costs.
static wisp_status warm_up( bench_variant* variant, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < 2 && status == WISP_OK && variant->warm_ms <= 0.0; ++i )
    {
        double ms;
        status = time_variant( variant, &ms, error );
        variant->warm_ms = i > 0 ? ms : 0.0;
    }
    return status;
}

static void choose_turns( bench_variant* variants, int count )
{
    double turn_ms = SHORT_TURN_MS;
    for ( int i = 0; i < count; ++i )
    {
        turn_ms = fmax( turn_ms, TURN_FRACTION * variants[i].warm_ms );
    }
    for ( int i = 0; i < count; ++i )
    {
        double steps = turn_ms / fmax( variants[i].warm_ms, 1e-6 );
        variants[i].turn_steps = (int)fmin( fmax( steps, 1.0 ), TURN_STEPS_MAX );
    }
}

static wisp_status take_turn( bench_variant* variant, int samples_max, wisp_error* error )
{
    double ms;
    if ( variant->turn_steps > 1 && variant->warm_ms < SHORT_TURN_MS )
    {
        wisp_status status = time_variant( variant, &ms, error );
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    for ( int i = 0; i < variant->turn_steps && variant->sample_count < samples_max; ++i )
    {
        const double cpu_start = machine_cpu_seconds();
        wisp_status status = time_variant( variant, &ms, error );
        variant->cpu_seconds += machine_cpu_seconds() - cpu_start;
        variant->wall_seconds += 1e-3 * ms;
        if ( status == WISP_OK && variant->after )
        {
            status = variant->after( variant->context );
        }
        if ( status != WISP_OK )
        {
            return status;
        }
        variant->samples[variant->sample_count++] = ms;
    }
    return WISP_OK;
}

static bool all_have( const bench_variant* variants, int count, int samples )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( variants[i].sample_count < samples )
        {
            return false;
        }
    }
    return true;
}

wisp_status bench_interleave( bench_variant* variants, int count, const bench_effort* effort, wisp_error* error )
{
    double start = wisp_clock_seconds();
    for ( int i = 0; i < count; ++i )
    {
        variants[i].sample_count = 0;
        variants[i].wall_seconds = variants[i].cpu_seconds = 0.0;
        variants[i].samples = malloc( (size_t)effort->samples_max * sizeof( double ) );
        wisp_status status = variants[i].samples ? warm_up( &variants[i], error )
                                                 : wisp_fail( error, WISP_NO_MEMORY, "no memory for the samples" );
        if ( status != WISP_OK )
        {
            return status;
        }
    }
    choose_turns( variants, count );
    for ( int round = 0; !all_have( variants, count, effort->samples_max ); ++round )
    {
        if ( round >= effort->rounds_min && wisp_clock_seconds() - start > effort->seconds )
        {
            break;
        }
        for ( int i = 0; i < count; ++i )
        {
            wisp_status status = interruption_check( error );
            status = status == WISP_OK ? take_turn( &variants[i], effort->samples_max, error ) : status;
            if ( status != WISP_OK )
            {
                return status;
            }
        }
    }
    return WISP_OK;
}

stats_summary bench_summarise( bench_variant* variant )
{
    stats_summary out = stats_summarise( variant->samples, variant->sample_count );
    out.cpu_fraction = variant->wall_seconds > 0.0 ? variant->cpu_seconds / variant->wall_seconds : NAN;
    return out;
}

void bench_free_samples( bench_variant* variants, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        free( variants[i].samples );
        variants[i].samples = NULL;
        variants[i].sample_count = 0;
    }
}
