// What the gate finds of slow-downs that are known, on the machine that it runs on.
#include "gate_paired.h"
#include "suite_callgrind.h"

#include <math.h>

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
        const int steps = row->steps > 0 ? row->steps : scene.steps;
        status = gate_slow_find( &scene, steps, turns->isa, out, error );
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
    char cells[8][24];
    bound_rate( t->found, t->trials, &lower, &upper );
    snprintf( cells[0], sizeof cells[0], "%.0f %%", 100.0 * t->slow );
    snprintf( cells[1], sizeof cells[1], isfinite( t->more ) ? "%+.2f %%" : "-", 100.0 * t->more );
    snprintf( cells[2], sizeof cells[2], "%d", t->trials );
    snprintf( cells[3], sizeof cells[3], "%d", t->found );
    snprintf( cells[4], sizeof cells[4], "%.1f %%", 100.0 * t->found / t->trials );
    snprintf( cells[5], sizeof cells[5], "%.1f %%", 100.0 * lower );
    snprintf( cells[6], sizeof cells[6], "%.1f %%", 100.0 * upper );
    snprintf( cells[7], sizeof cells[7], "%d", t->unmeasured );
    results_add_cells(
        out, table,
        ( const char* const[] ){ cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7] } );
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
        status = gate_compare_row( programs, turns, row_count, &check, error );
        t->found += status == WISP_OK && check.pace == PACE_SLOWER ? 1 : 0;
        t->unmeasured += status == WISP_OK && check.pace == PACE_NOT_MEASURABLE ? 1 : 0;
    }
    return status;
}

wisp_status gate_self_test( const wisp_suite* suite, const gate_turns* turns, const gate_self_test_options* options,
                            progress* bar, results* out, wisp_error* error )
{
    static const double slow[] = { 0.0, 0.02, 0.03, 0.05 };
    const char* const header[] = { "slower by", "instructions", "gates of time", "found", "rate",
                                   "from",      "to",           "not measurable" };
    const int table = results_add_table( out, "What the gate finds of itself", WISP_COUNT( header ), header );
    char own[4096];
    gate_slow twice = { 0 };
    double plain = 0.0;
    wisp_status status = gate_own_path( own, sizeof own, error );
    status = status == WISP_OK ? find_twice( suite->rows + turns->row, turns, &twice, error ) : status;
    for ( int k = 0; k < WISP_COUNT( slow ) && status == WISP_OK; ++k )
    {
        const gate_program programs[] = { { .path = own }, { own, lround( slow[k] * (double)twice.loops ) } };
        self_test t = { .slow = slow[k], .more = NAN, .trials = options->trials };
        if ( options->counts_instructions )
        {
            double counted = NAN;
            status = count_instructions( turns, programs + 1, &counted, error );
            plain = k == 0 ? counted : plain;
            t.more = counted / plain - 1.0;
        }
        status = status == WISP_OK ? run_trials( programs, turns, suite->row_count, (double)k / WISP_COUNT( slow ),
                                                 1.0 / WISP_COUNT( slow ), bar, &t, error )
                                   : status;
        if ( status == WISP_OK )
        {
            add_line( &t, table, out );
        }
    }
    if ( status == WISP_OK )
    {
        results_add_note( out, "gate %s: row %s is slowed down; what gates of time find at 0 %% is a false alarm",
                          suite->name, suite->rows[turns->row].name );
    }
    return status;
}
