// Figures 8 to 11 and section 3.3 of Noh and Jung in short runs: every check of the page is met, and can fail.
#include "bench_tables.h"

#include "figures_drape.h"

static const bench_options quick = { .quick = true, .workers = 1 };

static void run_quickly( figures_fn* experiment, results* out )
{
    figures_fn* const experiments[] = { experiment };
    wisp_error error = { 0 };
    assert_ok( figures_run( experiments, 1, &quick, out, &error ), error );
}

TEST( a_free_cloth_never_rises_above_its_least_energy )
{
    results all = { 0 };
    run_quickly( figures_free_flight, &all );
    expect_good( &all );
    const results_table* table = find_table( &all, "Noh and Jung 3.3" );
    assert_int_equal( table->row_count, 1 + 6 );
    int bdf2 = 0;
    for ( int row = 1; row < table->row_count; ++row )
    {
        bdf2 += strcmp( named_cell( table, row, "integrator" ), "BDF2" ) == 0 ? 1 : 0;
        assert_true( atof( named_cell( table, row, "growth %" ) ) <= 1.0 );
        // the guard costs little: the paper's single solve is what most steps make
        assert_true( atof( named_cell( table, row, "solves" ) ) < 1.5 );
    }
    assert_int_equal( bdf2, 2 );
    assert_string_equal( named_cell( table, 1, "k_d N s/m" ), "0" );
    results_free( &all );
}

TEST( cloth_on_a_ball_meets_what_the_figures_show )
{
    results all = { 0 };
    run_quickly( figures_drape, &all );
    expect_good( &all );
    results_free( &all );
}
