// The case of strands at very small sizes: its suites keep what they promise, and figures of hair are met.
#include "bench_tables.h"

#include "figures_bench.h"
#include "accuracy/accuracy.h"
#include "program_data.h"
#include "suite_cases.h"

static const bench_options quick = { .quick = true, .seconds = 1.0, .workers = 2 };

// Rows of a suite of the case, those whose names begin so.
static void run_suite( const char* name, const char* beginning, results* all )
{
    char inner[64], path[1024];
    const bench_options brief = { .seconds = 1e-3, .workers = 2 };
    wisp_suite suite;
    wisp_error error = { 0 };
    setenv( "WISP_CACHE", "suite-cache", 1 );
    snprintf( inner, sizeof inner, "suites/strands/%s.yaml", name );
    program_data_path( inner, path, sizeof path );
    assert_ok( suite_read( path, &suite, &error ), error );
    const int count = suite.row_count;
    suite.row_count = 0;
    for ( int i = 0; i < count; ++i )
    {
        if ( strncmp( suite.rows[i].name, beginning, strlen( beginning ) ) == 0 )
        {
            const suite_row kept = suite.rows[i];
            suite.rows[i] = suite.rows[suite.row_count];
            suite.rows[suite.row_count++] = kept;
        }
    }
    assert_ok( suite_bench_rows( &suite, &brief, all, &error ), error );
    expect_good( all );
    suite.row_count = count;
    suite_release( &suite );
}

static double error_of( const results* all, const char* variant, const char* value )
{
    for ( int r = 0; r < all->row_count; ++r )
    {
        if ( strcmp( all->rows[r].variant, variant ) == 0 )
        {
            return value_of( &all->rows[r].error, value );
        }
    }
    fail_msg( "there is no row '%s'", variant );
    return NAN;
}

#define DISTANCE "RMS_distance_to_the_reference_mm"
#define LOST "energy_lost_percent_of_released"

TEST( the_direct_solve_is_exact_and_a_sweep_is_not )
{
    results all = { 0 };
    run_suite( "bend_links", "bend links", &all );
    assert_true( error_of( &all, "bend links, lengths=direct", "stretch_mean_percent" ) < 0.01 );
    assert_true( error_of( &all, "bend links, lengths=direct one pass", "stretch_mean_percent" ) < 0.01 );
    assert_true( error_of( &all, "bend links, lengths=links", "stretch_mean_percent" ) > 0.01 );
    assert_true( error_of( &all, "bend links, lengths=direct", DISTANCE ) <
                 error_of( &all, "bend links, lengths=links", DISTANCE ) );
    results_free( &all );
}

TEST( more_substeps_come_nearer_to_the_reference_and_lose_less )
{
    static const char* const rows[] = { "direct, substeps=1", "direct, substeps=4", "direct, substeps=10",
                                        "direct, substeps=40" };
    results all = { 0 };
    run_suite( "energy", "direct", &all );
    for ( int i = 1; i < WISP_COUNT( rows ); ++i )
    {
        assert_true( error_of( &all, rows[i], DISTANCE ) < error_of( &all, rows[i - 1], DISTANCE ) );
        assert_true( error_of( &all, rows[i], LOST ) < error_of( &all, rows[i - 1], LOST ) );
    }
    assert_true( error_of( &all, rows[3], LOST ) > 0.0 );
    results_free( &all );
}

TEST( lone_ghosts_without_sway_are_their_guides )
{
    results all = { 0 };
    run_suite( "guides", "1 : ", &all );
    // 1:1 is the guide up to rounding; with more ghosts per guide they differ from simulated strands
    assert_true( error_of( &all, "1 : 1, without sway", DISTANCE ) < 1e-3 );
    assert_true( error_of( &all, "1 : 1", DISTANCE ) > 0.1 );
    assert_true( error_of( &all, "1 : 4, without sway", DISTANCE ) > 0.1 );
    assert_true( error_of( &all, "1 : 16, without sway", DISTANCE ) >
                 error_of( &all, "1 : 4, without sway", DISTANCE ) );
    (void)find_table( &all, "Accuracy `guides`: ms of a step by pass, 2 workers" );
    for ( int r = 0; r < all.row_count; ++r )
    {
        assert_true( value_of( &all.rows[r].stages, "guide_hair.ghosts" ) > 0.0 );
    }
    results_free( &all );
}

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

TEST( pictures_of_ghosts_are_written )
{
    static figures_fn* const one[] = { figures_ghost_apart };
    bench_options options = quick;
    options.pictures = ".";
    results all = { 0 };
    wisp_error error = { 0 };
    remove( "guide_hair_2c_centre.png" );
    assert_ok( figures_run( one, 1, &options, &all, &error ), error );
    FILE* file = fopen( "guide_hair_2c_centre.png", "rb" );
    assert_non_null( file );
    assert_int_equal( fgetc( file ), 0x89 );
    fclose( file );
    remove( "guide_hair_2c_centre.png" );
    assert_int_equal( all.picture_count, 1 );
    assert_string_equal( all.pictures[0].path, "./guide_hair_2c_centre.png" );
    results_free( &all );
}
