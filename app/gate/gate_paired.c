// A round starts two processes of A and one of B on one processor, which run the row by turns of a few milliseconds: A B A' A B A',
// and in its second half A' B A A' B A. What slows the machine down for longer than that slows all of them down, a linear drift
// cancels, and each of them finds the caches as another process left them. Each turn's
// place in the row has its median of B over A over all runs of the row, and a round's figure is their mean, weighted by time, so that
// what is slow in a few steps alone counts. A row is slower if the rounds say so beyond what is allowed, by an exact test that flips
// signs (Fisher 1935), at a level that is shared by all rows (Holm 1979).
#include "gate_paired.h"

#include "interruption.h"
#include "stats.h"
#include "suite_measure.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum
{
    LEAST_ROUNDS = 4,
    MORE_ROUNDS = 4, // behind the first one at which a row can be slower
    MOST_ROUNDS = 23,
    LEAST_RUNS = 6, // of the row by each process in a round
    MOST_RUNS = 200,
};

static const double ROUND_SECONDS = 0.25; // of each process
static const double TURN_SECONDS = 0.005;
static const double ALLOWED = 0.02;    // slow-down
static const double LEVEL = 0.005;     // of false alarms, of all rows together
static const double MOST_NOISE = 0.05; // of one program against itself

// ---- statistics ----

double gate_sign_flip( const double* values, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += values[i];
    }
    long at_least = 0;
    for ( long signs = 0; signs < 1L << count; ++signs )
    {
        double flipped = 0.0;
        for ( int i = 0; i < count; ++i )
        {
            flipped += signs >> i & 1 ? -values[i] : values[i];
        }
        at_least += flipped >= sum - 1e-12 * fabs( sum ) ? 1 : 0;
    }
    return (double)at_least / (double)( 1L << count );
}

static double mean_of( const double* values, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += values[i];
    }
    return sum / count;
}

static double deviation_of( const double* values, int count )
{
    const double mean = mean_of( values, count );
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += ( values[i] - mean ) * ( values[i] - mean );
    }
    return sqrt( sum / ( count - 1 ) );
}

// What the rounds say. @param ratios logarithms of new over old @param own of old over old
static void judge( const double* ratios, const double* own, int count, gate_pair_check* out )
{
    // Student's t at 97.5 % with 3 to 22 degrees of freedom
    static const double T[MOST_ROUNDS - LEAST_ROUNDS + 1] = { 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262,
                                                              2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120,
                                                              2.110, 2.101, 2.093, 2.086, 2.080, 2.074 };
    const double half = T[count - LEAST_ROUNDS] * deviation_of( ratios, count ) / sqrt( count );
    double beyond[MOST_ROUNDS];
    for ( int i = 0; i < count; ++i )
    {
        beyond[i] = ratios[i] - log1p( ALLOWED );
    }
    out->rounds = count;
    out->slower = mean_of( ratios, count );
    out->lower = out->slower - half;
    out->upper = out->slower + half;
    out->noise = deviation_of( own, count );
    out->p = out->upper < log1p( ALLOWED ) ? 1.0 : gate_sign_flip( beyond, count );
}

// ---- rounds ----

// How a round divides the row: `places` turns of up to `steps` steps, `runs` times.
typedef struct round_shape
{
    int steps, places, runs;
} round_shape;

// A turn of each process.
static wisp_status time_turn( gate_process processes[3], const gate_turns* turns, int steps, bool is_reversed,
                              gate_turn out[3], wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int k = 0; k < 3 && status == WISP_OK; ++k )
    {
        const int who = is_reversed ? 2 - k : k;
        status = gate_process_turn( processes + who, turns, steps, out + who, error );
    }
    return status == WISP_OK && out[0].steps != out[1].steps
               ? wisp_fail( error, WISP_BAD_INPUT, "%s: made %d steps of row %d of %s, expected %d",
                            processes[0].program->path, out[0].steps, turns->row, turns->suite, out[1].steps )
               : status;
}

static round_shape shape_of( const gate_turn* whole )
{
    const double seconds = 1e-9 * whole->ns;
    const int steps = (int)fmin( fmax( ceil( whole->steps * TURN_SECONDS / seconds ), 1.0 ), whole->steps );
    const int runs = (int)fmin( fmax( ROUND_SECONDS / seconds, LEAST_RUNS ), MOST_RUNS );
    return ( round_shape ){ steps, ( whole->steps + steps - 1 ) / steps, runs + runs % 2 };
}

// @param ratios, owns [places][runs] logarithms of new over old and old over old; weights [places] ns
static wisp_status time_turns( gate_process processes[3], const gate_turns* turns, const round_shape* shape,
                               double* ratios, double* owns, double* weights, wisp_error* error )
{
    for ( int i = 0; i < shape->runs * shape->places; ++i )
    {
        const int run = i / shape->places, place = i % shape->places, at = place * shape->runs + run;
        gate_turn t[3] = { { 0 } };
        WISP_TRY( time_turn( processes, turns, shape->steps, 2 * run >= shape->runs, t, error ) );
        ratios[at] = log( t[1].ns ) - 0.5 * log( t[0].ns * t[2].ns );
        owns[at] = log( t[2].ns / t[0].ns );
        weights[place] += t[0].ns + t[2].ns;
    }
    return WISP_OK;
}

// The mean over places of their medians, weighted by time.
static double weigh( double* values, const double* weights, const round_shape* shape )
{
    double sum = 0.0, all = 0.0;
    for ( int place = 0; place < shape->places; ++place )
    {
        sum += weights[place] * stats_summarise( values + (size_t)place * (size_t)shape->runs, shape->runs ).median;
        all += weights[place];
    }
    return sum / all;
}

static wisp_status measure_round( gate_process processes[3], const gate_turns* turns, double* ratio, double* own,
                                  wisp_error* error )
{
    gate_turn whole[3] = { { 0 } };
    wisp_status status = time_turn( processes, turns, INT_MAX, false, whole, error ); // warms up
    if ( status != WISP_OK )
    {
        return status;
    }
    const round_shape shape = shape_of( whole );
    const size_t count = (size_t)shape.places * (size_t)shape.runs;
    double* values = calloc( 2 * count + (size_t)shape.places, sizeof *values );
    if ( values == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "gate: out of memory for %zu times", 3 * count );
    }
    double *owns = values + count, *weights = owns + count;
    status = time_turns( processes, turns, &shape, values, owns, weights, error );
    if ( status == WISP_OK )
    {
        *ratio = weigh( values, weights, &shape );
        *own = weigh( owns, weights, &shape );
    }
    free( values );
    return status;
}

// @param ratio of new over old, own of old over old: logarithms
static wisp_status run_round( const gate_program programs[2], const gate_turns* turns, double* ratio, double* own,
                              wisp_error* error )
{
    static const int who[] = { 0, 1, 0 };
    gate_process processes[3] = { { .to = -1 }, { .to = -1 }, { .to = -1 } };
    wisp_status status = WISP_OK;
    for ( int k = 0; k < 3 && status == WISP_OK; ++k )
    {
        status = gate_process_begin( programs + who[k], turns, processes + k, error );
    }
    status = status == WISP_OK ? measure_round( processes, turns, ratio, own, error ) : status;
    for ( int k = 0; k < 3; ++k )
    {
        gate_process_end( processes + k );
    }
    return status;
}

// The exact test of n rounds has no p below 2^-n. This many are needed for one that half of the level allows a row.
static int first_look( int row_count )
{
    return (int)ceil( log2( 2.0 * row_count / LEVEL ) );
}

// Half of the level is for rows that all rounds of a first look agree about, the other half for those that need more of them.
static wisp_status compare_rounds( const gate_program programs[2], const gate_turns* turns, int row_count,
                                   gate_pair_check* out, wisp_error* error )
{
    double ratios[MOST_ROUNDS], own[MOST_ROUNDS];
    const int look = first_look( row_count ), most = look + MORE_ROUNDS;
    wisp_status status = WISP_OK;
    for ( int round = 0; round < most && status == WISP_OK; ++round )
    {
        status = run_round( programs, turns, ratios + round, own + round, error );
        if ( round + 1 >= LEAST_ROUNDS && status == WISP_OK )
        {
            judge( ratios, own, round + 1, out );
            const bool is_fine = out->upper < log1p( ALLOWED ); // stopping early here raises no false alarm
            const bool is_slower = round + 1 == look && out->noise <= MOST_NOISE && out->p <= 0.5 * LEVEL / row_count;
            out->pace = is_fine ? PACE_FINE : is_slower ? PACE_SLOWER : PACE_DOUBT;
            if ( out->pace != PACE_DOUBT )
            {
                break;
            }
        }
    }
    return status;
}

static void decide( int count, int row_count, gate_pair_check* checks )
{
    double p[SUITE_MAX_ROWS] = { 0.0 };
    bool is_slower[SUITE_MAX_ROWS] = { false };
    for ( int i = 0; i < count; ++i )
    {
        const bool is_measurable = checks[i].pace != PACE_DOUBT || checks[i].noise <= MOST_NOISE;
        checks[i].pace = is_measurable ? checks[i].pace : PACE_NOT_MEASURABLE;
        p[i] = checks[i].pace == PACE_DOUBT ? checks[i].p : NAN;
    }
    stats_holm( p, count, row_count, 0.5 * LEVEL, is_slower );
    for ( int i = 0; i < count; ++i )
    {
        checks[i].pace = is_slower[i] ? PACE_SLOWER : checks[i].pace;
    }
}

// The path of this program.
static wisp_status own_path( char* out, size_t size, wisp_error* error )
{
    const ssize_t length = readlink( "/proc/self/exe", out, size - 1 );
    out[length > 0 ? length : 0] = '\0';
    return length > 0 ? WISP_OK
                      : wisp_fail( error, WISP_IO_ERROR, "gate: this program was not found: %s", strerror( errno ) );
}

// Compare one row as one of a gate of `row_count` rows, which share the level of false alarms.
static wisp_status compare_row( const gate_program programs[2], const gate_turns* turns, int row_count,
                                gate_pair_check* out, wisp_error* error )
{
    *out = ( gate_pair_check ){ 0 };
    const wisp_status status = compare_rounds( programs, turns, row_count, out, error );
    decide( 1, row_count, out );
    return status;
}

wisp_status gate_compare_programs( wisp_suite* suite, const char* old_program, gate_turns turns, progress* bar,
                                   gate_pair_check* out, wisp_error* error )
{
    const int all = suite->row_count;
    char own[4096];
    wisp_status status = own_path( own, sizeof own, error );
    const gate_program programs[] = { { .path = old_program }, { .path = own } };
    for ( int i = 0; i < suite->row_count && status == WISP_OK; ++i )
    {
        turns.row = i;
        progress_show( bar, (double)i / all, suite->rows[i].name );
        status = compare_rounds( programs, &turns, all, out + i, error );
        if ( status != WISP_OK && interruption_came() )
        {
            suite->row_count = i;
            status = WISP_OK;
        }
    }
    if ( status == WISP_OK )
    {
        decide( suite->row_count, all, out );
    }
    return status;
}

// ---- the report ----

void gate_report_pairs( const wisp_suite* suite, const gate_pair_check* checks, results* out )
{
    static const char* const names[PACE_COUNT] = { "as fast", "in doubt", "not measurable", "slower" };
    const int table =
        results_begin_table( out, "Time against the other program", "row\tverdict\ttime\tfrom\tto\tnoise\trounds" );
    int counts[PACE_COUNT] = { 0 };
    for ( int i = 0; i < suite->row_count; ++i )
    {
        const gate_pair_check* c = checks + i;
        results_add_line( out, table, "%s%s%s\t%s\t%+.1f %%\t%+.1f %%\t%+.1f %%\t%.1f %%\t%d", suite->rows[i].name,
                          suite->rows[i].variant[0] ? ", " : "", suite->rows[i].variant, names[c->pace],
                          100.0 * expm1( c->slower ), 100.0 * expm1( c->lower ), 100.0 * expm1( c->upper ),
                          100.0 * c->noise, c->rounds );
        counts[c->pace] += 1;
        results_row* row = results_add_row( out, suite->rows[i].name, suite->rows[i].variant );
        if ( row != NULL )
        {
            results_put( &row->size, "is_slower", c->pace == PACE_SLOWER ? 1.0 : 0.0 );
            results_put( &row->size, "is_as_fast", c->pace == PACE_FINE ? 1.0 : 0.0 );
            results_put( &row->size, "ratio", exp( c->slower ) );
            results_put( &row->size, "ratio_lower", exp( c->lower ) );
            results_put( &row->size, "ratio_upper", exp( c->upper ) );
            results_put( &row->size, "noise", c->noise );
            results_put( &row->size, "rounds", c->rounds );
            results_put( &row->size, "p", c->p );
        }
    }
    const char* verdict = counts[PACE_SLOWER] > 0                                ? "regression"
                          : counts[PACE_DOUBT] + counts[PACE_NOT_MEASURABLE] > 0 ? "inconclusive"
                                                                                 : "pass";
    char line[200];
    snprintf( line, sizeof line, "gate %.80s: time: %s: %d rows", suite->name, verdict, suite->row_count );
    for ( int i = 0; i < PACE_COUNT; ++i )
    {
        results_append_count( line, sizeof line, counts[i], names[i] );
    }
    results_add_headline( out, "%s", line );
}

// ---- the test of the gate itself ----

// What the gate finds of slow-downs that are known, on the machine that it runs on.

// Bounds of a rate of 95 % (Wilson 1927).
static void bound_rate( int found, int trials, double* lower, double* upper )
{
    const double z = 1.96, n = trials, rate = found / n, centre = rate + z * z / ( 2.0 * n );
    const double half = z * sqrt( rate * ( 1.0 - rate ) / n + z * z / ( 4.0 * n * n ) );
    *lower = fmax( 0.0, ( centre - half ) / ( 1.0 + z * z / n ) );
    *upper = fmin( 1.0, ( centre + half ) / ( 1.0 + z * z / n ) );
}

// How much work after each step doubles the time.
static wisp_status find_twice( const suite_row* row, const gate_turns* turns, gate_slow* out, wisp_error* error )
{
    wisp_scene scene;
    wisp_status status = suite_scene( row, &scene, error );
    if ( status == WISP_OK )
    {
        status = gate_slow_find( &scene, turns->isa, out, error );
        wisp_scene_release( &scene );
    }
    return status;
}

static wisp_status count_instructions( const gate_turns* turns, const gate_program* program, double* out,
                                       wisp_error* error )
{
    char slow[32];
    suite_measurement m = { 0 };
    snprintf( slow, sizeof slow, "--slow=%ld", program->loops );
    const suite_count_options options = { .step = program->loops > 0 ? slow : NULL };
    const wisp_status status = suite_count_instructions( turns->suite, turns->row, &options, &m, error );
    *out = m.values[SUITE_INSTRUCTIONS];
    return status;
}

// What was found of one slow-down.
typedef struct self_test
{
    double slow; // fraction
    double more; // instructions, fraction; NaN: not counted
    int trials, found, unmeasured;
} self_test;

static void add_line( const self_test* t, int table, results* out )
{
    double lower, upper;
    bound_rate( t->found, t->trials, &lower, &upper );
    char more[24];
    snprintf( more, sizeof more, isfinite( t->more ) ? "%+.2f %%" : "-", 100.0 * t->more );
    results_add_line( out, table, "%.0f %%\t%s\t%d\t%d\t%.1f %%\t%.1f %%\t%.1f %%\t%d", 100.0 * t->slow, more,
                      t->trials, t->found, 100.0 * t->found / t->trials, 100.0 * lower, 100.0 * upper,
                      t->unmeasured );
}

static wisp_status run_trials( const gate_program programs[2], const gate_turns* turns, int row_count, double done,
                               double part, progress* bar, self_test* t, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int i = 0; i < t->trials && status == WISP_OK; ++i )
    {
        gate_pair_check check;
        char what[64];
        snprintf( what, sizeof what, "%.0f %% slower, gate %d of %d", 100.0 * t->slow, i + 1, t->trials );
        progress_show( bar, done + part * i / t->trials, what );
        status = compare_row( programs, turns, row_count, &check, error );
        t->found += status == WISP_OK && check.pace == PACE_SLOWER ? 1 : 0;
        t->unmeasured += status == WISP_OK && check.pace == PACE_NOT_MEASURABLE ? 1 : 0;
    }
    return status;
}

wisp_status gate_self_test( const wisp_suite* suite, const gate_turns* turns, const gate_self_test_options* options,
                            progress* bar, results* out, wisp_error* error )
{
    static const double slow[] = { 0.0, 0.02, 0.03, 0.05 };
    const int table =
        results_begin_table( out, "What the gate finds of itself",
                             "slower by\tinstructions\tgates of time\tfound\trate\tfrom\tto\tnot measurable" );
    char own[4096];
    gate_slow twice = { 0 };
    double plain = 0.0;
    WISP_TRY( own_path( own, sizeof own, error ) );
    WISP_TRY( find_twice( suite->rows + turns->row, turns, &twice, error ) );
    for ( int k = 0; k < WISP_COUNT( slow ); ++k )
    {
        const gate_program programs[] = { { .path = own }, { own, lround( slow[k] * (double)twice.loops ) } };
        self_test t = { .slow = slow[k], .more = NAN, .trials = options->trials };
        if ( options->counts_instructions )
        {
            double counted = NAN;
            WISP_TRY( count_instructions( turns, programs + 1, &counted, error ) );
            plain = k == 0 ? counted : plain;
            t.more = counted / plain - 1.0;
        }
        WISP_TRY( run_trials( programs, turns, suite->row_count, (double)k / WISP_COUNT( slow ),
                              1.0 / WISP_COUNT( slow ), bar, &t, error ) );
        add_line( &t, table, out );
    }
    results_add_note( out, "gate %s: row %s is slowed down; what gates of time find at 0 %% is a false alarm",
                      suite->name, suite->rows[turns->row].name );
    return WISP_OK;
}
