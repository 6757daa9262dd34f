// The case of strands: what is claimed of a million vertices, and figures of hair.
#include "bench_tables.h"

#include "figures_bench.h"
#include "suite_cases.h"

static const bench_options quick = { .quick = true, .seconds = 1.0, .workers = 2 };

TEST( a_million_vertices_are_held_to_their_claims )
{
    results all = { 0 };
    results_row* row = results_add_row( &all, "accuracy.million", "1 : 16" );
    row->workers = 2;
    row->ms_median = 6.0;
    results_put( &row->stages, "guide_hair.targets", 1.0 );
    results_put( &row->stages, "guide_hair.ghosts", 2.0 );
    results_put( &row->stages, "strands.stretch", 3.0 );
    strands_claim_million( 0, &all );
    assert_int_equal( all.note_count, 2 );
    assert_non_null( strstr( all.notes[0], "not met" ) );
    assert_non_null( strstr( all.notes[1], "Measured 3 ms: met" ) );
    results_free( &all );
}

TEST( the_stats_of_guide_hair_are_met )
{
    static figures_fn* const ghosts[] = {
        figures_ghost_centre, figures_ghost_sway,   figures_ghost_block,   figures_ghost_apart,
        figures_ghost_curves, figures_ghost_spread, figures_ghost_pairing,
    };
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( figures_run( ghosts, WISP_COUNT( ghosts ), &quick, &all, &error ), error );
    expect_good( &all );
    assert_int_equal( all.tables[0].row_count, 1 + WISP_COUNT( ghosts ) );
    results_free( &all );
}

TEST( the_figures_of_frozen_hair_are_met_and_drawn )
{
    static figures_fn* const frozen[] = { figures_frozen_intensity, figures_frozen_stiffness, figures_frozen_clumps };
    static const char* const files[] = { "frozen_hair_1_intensity.png", "frozen_hair_2_stiffness.png",
                                         "frozen_hair_3_clumps.png" };
    bench_options options = quick;
    options.pictures = ".";
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( figures_run( frozen, WISP_COUNT( frozen ), &options, &all, &error ), error );
    expect_good( &all );
    // the settings, figures 1 and 2, and figure 3 at three densities
    assert_int_equal( all.tables[0].row_count, 1 + 2 + 3 );
    assert_int_equal( all.picture_count, 3 );
    for ( int i = 0; i < 3; ++i )
    {
        FILE* file = fopen( files[i], "rb" );
        assert_non_null( file );
        fclose( file );
        remove( files[i] );
    }
    results_free( &all );
}
