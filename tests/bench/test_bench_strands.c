// The case of strands at very small sizes: the scene is the one described in the tables, and the tables have their
// rows.
#include "bench_tables.h"

#include "figures_bench.h"
#include "accuracy/accuracy.h"
#include "program_data.h"
#include "strands_bench.h"

static const bench_options quick = { .quick = true, .seconds = 1.0, .workers = 2 };

static strands_plan small_plan( void )
{
    strands_plan plan = strands_default_plan( &quick );
    plan.sizes[0] = 20;
    plan.sizes[1] = 100;
    plan.size_count = 2;
    plan.scenario_steps = STRANDS_REFERENCE_STEPS;
    plan.few_settings_strands = 50;
    plan.few_settings = 2;
    plan.comparison_seconds = 0.0;
    return plan;
}

// ---- the scene ----

TEST( strands_start_horizontal_with_their_roots_pinned )
{
    strands_shape few, many;
    strands_implementation implementation;
    wisp_error error = { 0 };
    assert_ok( strands_shape_make_horizontal( 7, &few, &error ), error );
    assert_ok( strands_shape_make_horizontal( 40, &many, &error ), error );
    assert_memory_equal( few.points, many.points, 7 * STRANDS_VERTICES * sizeof( wisp_vec3 ) );
    const strands_stretch none = strands_measure_stretch( &few, few.points );
    assert_true( none.max == 0.0 && none.mean == 0.0 );
    for ( int i = 0; i < strands_shape_size( &few ); ++i )
    {
        double x = (double)few.points[i].x, z = (double)few.points[i].z;
        assert_true( few.points[i].y == 0.0f );
        double along = (double)STRANDS_SPACING * ( i % STRANDS_VERTICES );
        assert_true( fabs( sqrt( x * x + z * z ) - along ) < 4.0 * (double)FLT_EPSILON );
    }
    const strands_setting rod = { "rod", WISP_STRAND_STRETCH_DIRECT, WISP_STRAND_BEND_ROD, 2, 10 };
    strands_generator generator = strands_default_generator( &few );
    generator.dynamics = strands_setting_dynamics( &rod );
    assert_ok( strands_implementation_create( &generator, &implementation, &error ), error );
    assert_ok( strands_implementation_steps( &implementation, 10, &error ), error );
    const wisp_vec3* points;
    assert_ok( strands_implementation_points( &implementation, &points, &error ), error );
    for ( int s = 0; s < 7; ++s )
    {
        const wisp_vec3 root = points[s * STRANDS_VERTICES];
        assert_true( root.x == 0.0f && root.y == 0.0f && root.z == 0.0f );
        assert_true( points[s * STRANDS_VERTICES + STRANDS_VERTICES - 1].y < -1e-3f );
    }
    strands_implementation_destroy( &implementation );
    strands_shape_free( &few );
    strands_shape_free( &many );
}

TEST( a_nan_is_never_a_small_stretch )
{
    strands_shape shape;
    wisp_error error = { 0 };
    assert_ok( strands_shape_make_horizontal( 1, &shape, &error ), error );
    wisp_vec3 points[STRANDS_VERTICES];
    memcpy( points, shape.points, sizeof( points ) );
    points[1].x = NAN;
    const strands_stretch stretch = strands_measure_stretch( &shape, points );
    assert_true( isnan( stretch.mean ) );
    strands_shape_free( &shape );
}

// ---- the tables ----

TEST( the_comparison_has_a_line_a_setting_and_the_kernels_alone )
{
    strands_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( strands_comparison( &plan, &all, &error ), error );
    expect_good( &all );
    assert_fits_terminal( &all );
    const results_table* table = find_table( &all, "Strands x 20 vertices" );

    // all five settings at 20 strands and two at 100
    assert_int_equal( table->row_count, 1 + 5 + 2 );
    int nvcloth = column_of( table, "NvCloth 1 / 2 threads ms*" ), hash = column_of( table, "hash" );
    assert_string_equal( cell( table, 1, 1 ), "direct, bend links" );
    assert_string_equal( cell( table, 1, nvcloth ), "-" );
    assert_string_equal( cell( table, 6, 0 ), "100" );
    assert_string_equal( cell( table, 6, nvcloth ), "0.149 / 0.079" );
    assert_int_equal( strlen( cell( table, 6, hash ) ), 16 );
    for ( int r = 0; r < all.row_count; ++r )
    {
        const results_row* row = &all.rows[r];
        assert_true( row->ms_median > 0.0 );
        assert_true( row->has_hash );
        assert_true( isfinite( value_of( &row->error, "rms_share_of_length" ) ) );

        // the direct solve is exact, a sweep is not
        bool is_direct = strncmp( row->variant, "direct", 6 ) == 0;
        assert_true( !is_direct || value_of( &row->error, "stretch_mean" ) < 1e-4 );
    }

    // one chart per worker count, with the times of the rows: at 20 and at 100 strands
    assert_int_equal( all.chart_count, plan.worker_count );
    const results_series* first = &all.charts[0].series[0];
    assert_string_equal( first->name, "direct, bend links, 10 substeps" );
    assert_int_equal( first->count, 2 );
    assert_true( first->points[0].x == 20.0 && first->points[1].x == 100.0 );
    assert_true( first->points[0].y == all.rows[0].ms_median );
    results_free( &all );
}

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
