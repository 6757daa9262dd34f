// Measure the cost of the accuracy of a step (extension, not in Noh and Jung): the suites in data/suites/figures, and what their rows
// must keep.
#include "figures_drape.h"

#include "rows_chart.h"
#include "suite/suite_folder.h"

#include <math.h>
#include <string.h>

#define SUITE_SECONDS 2.0 // of both: errors are the same in every run

// @return mm, NaN: there is no such row
static double value_of( const results* all, const char* suite, const char* variant, const char* value )
{
    for ( int i = 0; i < all->row_count; ++i )
    {
        if ( strcmp( all->rows[i].name, suite ) == 0 && strcmp( all->rows[i].variant, variant ) == 0 )
        {
            return rows_error( &all->rows[i], value );
        }
    }
    return NAN;
}

#define DISTANCE "RMS_distance_to_the_reference_mm"

static double to_fine( const results* all, const char* variant )
{
    return value_of( all, "accuracy.step", variant, DISTANCE );
}

static double to_exact( const results* all, const char* variant )
{
    return value_of( all, "accuracy.tolerance", variant, DISTANCE );
}

// The default tolerance, 1e-4, should not be what limits a step. Tighter ones differ by roundings of floats.
static void check_tolerance( figures_case* page )
{
    static const char* const rows[] = { "euler, 0.01 s, tolerance=1e-2", "euler, 0.01 s, tolerance=1e-3",
                                        "euler, 0.01 s, tolerance=1e-4", "euler, 0.01 s, tolerance=1e-5",
                                        "euler, 0.01 s, tolerance=1e-6" };
    double exact[WISP_COUNT( rows )], most = 0.0;
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        exact[i] = to_exact( page->out, rows[i] );
        most = i < 2 || exact[i] <= most ? most : exact[i]; // a NaN stays
    }
    const double own = to_fine( page->out, rows[4] );
    figures_add( page, "Accuracy (extension)", "tolerance of a solve from 1e-2 to 1e-6, step 0.01 s",
                 "from 1e-4 on a solve adds less than a hundredth of the step's own error",
                 most < 0.01 * own && exact[2] < exact[0], "%.2f, %.3f, %.3f, %.3f, %.3f mm against %.1f mm",
                 exact[0], exact[1], exact[2], exact[3], exact[4], own );
}

static void check_solves( figures_case* page )
{
    const double fine[] = { to_fine( page->out, "euler, 0.01 s, tolerance=1e-6" ),
                            to_fine( page->out, "euler, 0.01 s, tolerance 1e-6, newton_iterations=2" ),
                            to_fine( page->out, "euler, 0.01 s, tolerance 1e-6, newton_iterations=4" ) };
    figures_add( page, "Accuracy (extension)", "1, 2 and 4 solves per step, step 0.01 s, tolerance 1e-6",
                 "the second helps, the fourth changes less than a tenth of that",
                 fine[1] < fine[0] && fabs( fine[2] - fine[1] ) < 0.1 * ( fine[0] - fine[1] ),
                 "%.2f, %.2f, %.2f mm from the fine run", fine[0], fine[1], fine[2] );
}

// Quick runs have the coarsest and the middle step of each series. What BDF2 leaves to Euler is no step of its own.
static void check_steps( figures_case* page )
{
    const results* all = page->out;
    const double euler[] = { to_fine( all, "euler, dt=0.02" ), to_fine( all, "euler, dt=0.005" ) };
    const double bdf2[] = { to_fine( all, "bdf2, dt=0.01" ), to_fine( all, "bdf2, dt=0.0025" ) };
    const double order1 = log2( euler[0] / euler[1] ) / 2.0, order2 = log2( bdf2[0] / bdf2[1] ) / 2.0;
    const double left = value_of( all, "accuracy.step", "bdf2, dt=0.01", "left_to_euler" ) +
                        value_of( all, "accuracy.step", "bdf2, dt=0.0025", "left_to_euler" );
    figures_add(
        page, "Accuracy (extension)", "steps of 0.02 to 0.0025 s, Euler and BDF2",
        "errors fall with orders near 1 and 2 (above 0.9 and 1.7); BDF2 is nearer and leaves no step to Euler",
        left == 0.0 && bdf2[0] < to_fine( all, "euler, 0.01 s, tolerance=1e-4" ) && bdf2[1] < euler[1] &&
            order1 > 0.9 && order2 > 1.7,
        "orders %.2f and %.2f; %.2f to %.3f mm, and %.3f to %.3f mm; %.0f left", order1, order2, euler[0], euler[1],
        bdf2[0], bdf2[1], left );
}

wisp_status figures_hang_accuracy( figures_case* page, wisp_error* error )
{
    static const char* const names[] = { "step", "tolerance" };
    const bench_options options = { .quick = page->quick, .workers = 1 };
    const wisp_status status =
        suite_bench_names( "figures", names, WISP_COUNT( names ), SUITE_SECONDS, &options, page->out, error );
    if ( status == WISP_OK )
    {
        check_tolerance( page );
        check_solves( page );
        check_steps( page );
    }
    return status;
}
