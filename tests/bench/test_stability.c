// The case `stability`: every quick row holds or breaks as its suite says, and suites say what their rows are.
#include "bench_tables.h"

#include "stability/stability_bench.h"

#include <math.h>

TEST( what_breaks_without_being_known_fails_and_so_does_what_holds_and_is_known )
{
    static const struct
    {
        stability_check broke;
        int known, failed;
    } cases[] = { { STABILITY_HOLDS, -1, 0 },
                  { STABILITY_ENERGY, STABILITY_ENERGY, 0 },
                  { STABILITY_ENERGY, -1, 1 },
                  { STABILITY_HOLDS, STABILITY_ENERGY, 1 },
                  { STABILITY_STRAIN, STABILITY_ENERGY, 1 } };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        results all = { 0 };
        stability_counts tally = { 0 };
        const suite_outcome outcome = { .verdict = { .check = cases[i].broke } };
        stability_add( stability_begin_table( "t", &all ), "row", &outcome, cases[i].known, &tally, &all );
        assert_int_equal( tally.failed, cases[i].failed );
        assert_int_equal( all.failed, cases[i].failed );
        assert_int_equal( tally.rows, 1 );
        results_free( &all );
    }
}

TEST( every_quick_row_holds_or_breaks_as_its_suite_says )
{
    const bench_options quick = { .quick = true, .workers = 2 };
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( stability_bench( &quick, &all, &error ), error );
    for ( int i = 0; i < all.note_count && all.failed; ++i )
    {
        print_message( "%s\n", all.notes[i] );
    }
    const bool failed = all.failed;
    assert_true( all.row_count > 50 );
    results_free( &all );
    assert_false( failed );
}
