// The cases of cloth, balloon and strands at very small sizes: their rows, and failures of the run after an error.
#include "bench_tables.h"

#include "accuracy/accuracy.h"
#include "suite_cases.h"
#include "program_data.h"
#include "suite.h"
#include "suite_study.h"

#include <glob.h>

static const bench_options quick = { .quick = true, .workers = 2 };

// ---- suites ----

// Reading a suite checks that each row names things of its scene and is a scene.
TEST( every_suite_of_the_tree_is_read )
{
    static const char* const patterns[] = { "/data/suites/*.yaml", "/data/suites/[!sv]*/*.yaml",
                                            "/data/suites/s[!c]*/*.yaml", "/data/suites/scaling/scaling.yaml" };
    SCOPED( globfree ) glob_t found;
    for ( int i = 0; i < WISP_COUNT( patterns ); ++i )
    {
        char pattern[500];
        snprintf( pattern, sizeof pattern, "%s%s", WISP_SOURCE_ROOT, patterns[i] );
        assert_int_equal( glob( pattern, i > 0 ? GLOB_APPEND : 0, NULL, &found ), 0 );
    }
    assert_true( found.gl_pathc >= 50 );
    for ( size_t i = 0; i < found.gl_pathc; ++i )
    {
        wisp_suite suite;
        wisp_error error = { 0 };
        assert_ok( suite_read( found.gl_pathv[i], &suite, &error ), error );
        assert_true( suite.row_count > 0 );
        suite_release( &suite );
    }
}

TEST( a_folder_without_suites_is_an_error )
{
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( suite_bench_folder( "nowhere", 1.0, &quick, &all, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "nowhere" ) );
    assert_int_equal( suite_bench_folder( "scenes", 1.0, &quick, &all, &error ), WISP_BAD_INPUT );
    results_free( &all );
}

// ---- failures ----

TEST( a_claim_that_is_not_met_is_a_message_and_no_failure )
{
    results all = { 0 };
    results_add_claim( &all, false, "it is fast", 1.5, " times" );
    assert_false( all.failed );
    assert_true( has_note( &all, "claim not met on this machine" ) );
    results_free( &all );
}

// ---- balloon ----

static void run_suite( const char* name, int rows, results* all )
{
    char inner[64], path[1024];
    const bench_options brief = { .seconds = 1e-3, .workers = 2 };
    wisp_suite suite;
    wisp_error error = { 0 };
    snprintf( inner, sizeof inner, "suites/balloon/%s.yaml", name );
    program_data_path( inner, path, sizeof path );
    assert_ok( suite_read( path, &suite, &error ), error );
    const int count = suite.row_count;
    suite.row_count = rows;
    assert_ok( suite_bench_rows( &suite, &brief, all, &error ), error );
    suite.row_count = count;
    suite_release( &suite );
}

TEST( a_balloon_whose_volume_is_wrong_fails )
{
    results all = { 0 };
    run_suite( "sizes", 2, &all );
    balloon_conclude( 0, 2, &all );
    assert_false( all.failed );
    assert_int_equal( all.row_count, 2 * 2 );
    assert_true( has_note( &all, "Claim: " ) );

    // a volume that is not there is wrong, too
    all.rows[0].error.count = 0;
    balloon_conclude( 0, 2, &all );
    assert_true( all.failed );
    results_free( &all );
}

// Times of 10 ms for 642 vertices that grow with the given power. @return whether the claim that they are linear is met
static bool is_linear_with_power( results* all, double power )
{
    for ( int i = 0; i < all->row_count; ++i )
    {
        const double vertices = strtod( strstr( all->rows[i].variant, "vertices=" ) + 9, NULL );
        all->rows[i].ms_p10 = 10.0 * pow( vertices / 642.0, power );
    }
    const int first = all->note_count;
    balloon_conclude( 0, 2, all );
    int met = 0;
    for ( int i = first; i < all->note_count; ++i )
    {
        const bool is_power = strstr( all->notes[i], "goes with vertices to the power" ) != NULL;
        met += is_power && strstr( all->notes[i], ": met." ) != NULL ? 1 : 0;
    }
    return met == 2 && !all->failed;
}

// How times grow depends on what else runs: it is told, and fails nothing.
TEST( a_balloon_whose_time_is_not_linear_in_its_vertices_is_told )
{
    results all = { 0 };
    run_suite( "sizes", 3, &all );
    assert_true( is_linear_with_power( &all, 1.0 ) );
    assert_false( is_linear_with_power( &all, 1.2 ) || all.failed );
    assert_false( is_linear_with_power( &all, 2.0 ) || all.failed );
    results_free( &all );
}

// ---- strands ----

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
