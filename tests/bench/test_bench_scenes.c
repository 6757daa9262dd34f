// The case `scenes`: its rows, and the same bits with one worker and two. Times are not looked at.
#include "bench_tables.h"

#include "program_data.h"
#include "bench.h"
#include "suite.h"

bench_case_fn scenes_bench;

static bool has_row( const wisp_suite* suite, const char* label )
{
    char own[SUITE_MAX_LABEL];
    for ( int i = 0; i < suite->row_count; ++i )
    {
        suite_label( &suite->rows[i], own );
        if ( strcmp( own, label ) == 0 )
        {
            return true;
        }
    }
    return false;
}

TEST( the_suite_of_the_dressed_figure_is_one_row_more_than_its_effects )
{
    wisp_suite suite;
    wisp_error error = { 0 };
    assert_ok( suite_read( WISP_SOURCE_ROOT "/data/suites/character.yaml", &suite, &error ), error );
    assert_int_equal( suite.row_count, 1 + 12 );
    assert_true( has_row( &suite, "figure: base" ) && has_row( &suite, "figure: no self-contact" ) &&
                 has_row( &suite, "figure: no ghosts" ) && has_row( &suite, "figure: no cape" ) );
    int quick = 0;
    for ( int i = 0; i < suite.row_count; ++i )
    {
        quick += !suite.rows[i].is_slow;
    }
    assert_int_equal( quick, 3 );
    assert_false( suite.rows[0].is_slow ); // what all others are compared with
    suite_release( &suite );
}

TEST( every_quick_row_has_the_same_bits_with_one_worker_and_two )
{
    const bench_options quick = { .quick = true, .workers = 2, .seconds = 0.01 };
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( scenes_bench( &quick, &all, &error ), error );
    expect_good( &all );
    const results_table* costs = find_table( &all, "Suite `scenes`: " ); // with a line for each number of workers
    assert_int_equal( costs->row_count, 1 + 2 * 22 );
    int pairs = 0;
    for ( int i = 0; i + 1 < all.row_count; ++i )
    {
        const results_row *one = &all.rows[i], *two = &all.rows[i + 1];
        if ( one->workers == 1 )
        {
            assert_int_equal( two->workers, 2 );
            assert_string_equal( one->variant, two->variant );
            assert_true( one->has_hash && two->has_hash && one->hash == two->hash );
            ++pairs;
        }
    }
    // the rows of the suite, and three loops before and after them
    assert_int_equal( pairs, 22 + 6 );
    assert_int_equal( find_table( &all, "What two workers give" )->row_count, 1 + 6 );
    // tufts have as many vertices as the same strands in one entity
    assert_string_equal( named_cell( costs, row_of( costs, "500 tufts of 20 strands" ), "vertices" ), "120000" );
    assert_string_equal( named_cell( costs, row_of( costs, "10000 strands at once" ), "vertices" ), "120000" );
    assert_string_equal( named_cell( costs, row_of( costs, "crowd, 800 of 8 x 8" ), "vertices" ), "51200" );
    assert_fits_terminal( &all );
    results_free( &all );
}
