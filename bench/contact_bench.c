// The case `contact`: the suites in data/suites/contact, of what accuracy costs, and how balloons press on each other (extensions, not in
// the papers).
#include "contact_bench.h"

#include "rows_chart.h"
#include "suite/suite_folder.h"

#include <math.h>
#include <string.h>

// From this time in seconds on, the cloth folds on a fine mesh, too.
#define FINE_SECONDS 240.0

// ---- what contact promises ----

/// The most that a value of some rows may be.
typedef struct promise
{
    const char *suite, *beginning, *value; ///< of the rows' name, of their variant, of the error; "": all variants
    double most;
} promise;

static const promise promises[] = {
    { "suite.cost", "exact, margin=", "max_intersections", 0.0 },
    { "suite.motion", "ball", "max_intersections", 0.0 },
    { "suite.motion", "a quarter", "max_intersections", 0.0 },
    { "suite.motion", "half", "max_intersections", 0.0 },
    { "suite.motion", "its pace", "max_intersections", 0.0 },
    { "suite.motion", "twice", "max_intersections", 0.0 },
    { "suite.fine", "exact", "max_intersections", 0.0 },
    { "suite.pair", "exact", "max_overlap_mm", 1.5 }, // a hundredth of the radius
    { "suite.stack", "exact", "max_overlap_mm", 1.5 },
    { "suite.cost", "", "halted_at_step", 0.0 },
    { "suite.motion", "", "halted_at_step", 0.0 },
    { "suite.pair", "", "halted_at_step", 0.0 },
    { "suite.stack", "", "halted_at_step", 0.0 },
    { "suite.fine", "", "halted_at_step", 0.0 },
    // each row gives one side what it takes from the other; sums of a hundred thousand products in double remain
    { "suite.pair", "", "net_impulse_N_s", 1e-9 },
    { "suite.stack", "", "net_impulse_N_s", 1e-9 },
};

static void check_promise( const promise* p, const results_row* row, results* out )
{
    const double value = rows_error( row, p->value );
    if ( strcmp( row->name, p->suite ) == 0 && strncmp( row->variant, p->beginning, strlen( p->beginning ) ) == 0 &&
         value > p->most )
    {
        results_add_failure( out, "Contact, %s, %s, %d %s: %s is %.3g, expected at most %g.", row->name, row->variant,
                             row->workers, bench_workers_word( row->workers ), p->value, value, p->most );
    }
}

void contact_check_suites( int first_row, results* out )
{
    for ( int i = first_row; i < out->row_count; ++i )
    {
        for ( int k = 0; k < WISP_COUNT( promises ); ++k )
        {
            check_promise( &promises[k], &out->rows[i], out );
        }
    }
}

// ---- suites ----

static double mean_ms_of( const results_row* row )
{
    for ( int i = 0; i < row->stages.count; ++i )
    {
        if ( strcmp( row->stages.items[i].name, "mean" ) == 0 )
        {
            return row->stages.items[i].value;
        }
    }
    return NAN;
}

static double intersected_steps_of( const results_row* row )
{
    return rows_error( row, "steps_with_intersections" );
}

static void add_chart( int workers, int first_row, results* out )
{
    rows_chart_add( &( rows_chart ){ .first_row = first_row,
                                     .name = "suite.cost",
                                     .workers = workers,
                                     .title = "Contact, the cost of accuracy: a cloth that folds on itself",
                                     .x_label = "ms per step, mean",
                                     .y_label = "steps that end with intersections",
                                     .caption = "Ringed: no other way is both faster and more accurate.",
                                     .x = mean_ms_of,
                                     .y = intersected_steps_of,
                                     .y_linear = true,
                                     .is_front = true },
                    out );
}

bench_case_fn contact_bench;

wisp_status contact_bench( const bench_options* options, results* out, wisp_error* error )
{
    const int first_row = out->row_count;
    // the last one is left out where there is not enough time
    static const char* const names[] = { "cost", "motion", "pair", "stack", "fine" };
    const bool is_fine = bench_seconds( options ) >= FINE_SECONDS;
    const wisp_status status = suite_bench_names( "contact", names, WISP_COUNT( names ) - ( is_fine ? 0 : 1 ),
                                                  0.6 * bench_seconds( options ), options, out, error );
    if ( status == WISP_OK )
    {
        contact_check_suites( first_row, out );
        add_chart( options->workers > 1 ? options->workers : 1, first_row, out );
    }
    if ( status == WISP_OK && !is_fine )
    {
        results_add_note( out, "Contact: the fine cloth, data/suites/contact/fine.yaml, needs --seconds %g.",
                          FINE_SECONDS );
    }
    return status;
}
