// The case of strands at very small sizes: scalar C computes the same as the engine, the scene is the one described
// in the tables, and the tables have their rows.
#include "bench_tables.h"

#include "figures_bench.h"
#include "plain/strands_plain.h"
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

// ---- scalar C ----

enum
{
    VERTICES = 6,
    SEGMENTS = VERTICES - 1,
};

// A x = b by elimination with pivots, in double.
static void solve_dense( double a[SEGMENTS][SEGMENTS], double* x )
{
    for ( int k = 0; k < SEGMENTS; ++k )
    {
        int pivot = k;
        for ( int i = k + 1; i < SEGMENTS; ++i )
        {
            pivot = fabs( a[i][k] ) > fabs( a[pivot][k] ) ? i : pivot;
        }
        for ( int j = 0; j < SEGMENTS; ++j )
        {
            double swap = a[k][j];
            a[k][j] = a[pivot][j];
            a[pivot][j] = swap;
        }
        double swap = x[k];
        x[k] = x[pivot];
        x[pivot] = swap;
        for ( int i = 0; i < SEGMENTS; ++i )
        {
            double fraction = i == k ? 0.0 : a[i][k] / a[k][k];
            for ( int j = 0; j < SEGMENTS; ++j )
            {
                a[i][j] -= fraction * a[k][j];
            }
            x[i] -= fraction * x[k];
        }
    }
    for ( int k = 0; k < SEGMENTS; ++k )
    {
        x[k] /= a[k][k];
    }
}

// One Newton pass on |p_{s+1} - p_s| = l_s: every gradient written out, J W J^T without simplification.
static void newton_pass( double p[VERTICES][3], const double* w, const double* rest )
{
    double gradient[SEGMENTS][VERTICES][3] = { { { 0.0 } } }, a[SEGMENTS][SEGMENTS] = { { 0.0 } }, x[SEGMENTS];
    for ( int s = 0; s < SEGMENTS; ++s )
    {
        double d[3], squared = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            d[k] = p[s + 1][k] - p[s][k];
            squared += d[k] * d[k];
        }
        for ( int k = 0; k < 3; ++k )
        {
            gradient[s][s + 1][k] = d[k] / sqrt( squared );
            gradient[s][s][k] = -gradient[s][s + 1][k];
        }
        x[s] = rest[s] - sqrt( squared );
    }
    for ( int s = 0; s < SEGMENTS; ++s )
    {
        for ( int t = 0; t < SEGMENTS; ++t )
        {
            for ( int i = 0; i < 3 * VERTICES; ++i )
            {
                a[s][t] += w[i / 3] * gradient[s][i / 3][i % 3] * gradient[t][i / 3][i % 3];
            }
        }
    }
    solve_dense( a, x );
    for ( int i = 0; i < 3 * VERTICES; ++i )
    {
        for ( int s = 0; s < SEGMENTS; ++s )
        {
            p[i / 3][i % 3] += w[i / 3] * gradient[s][i / 3][i % 3] * x[s];
        }
    }
}

static void plain_tridiagonal_solves_the_whole_system( void** state )
{
    (void)state;
    wisp_vec3 points[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        points[v] = ( wisp_vec3 ){ 0.1f * (float)v, 0.02f * (float)( v * v % 5 ), 0.01f * (float)( 3 * v % 4 ) };
    }
    plain_strands plain;
    assert_true( plain_strands_create( &plain, points, 1, VERTICES, 1.0f ) );
    plain.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    plain.bends = false;
    plain.stretch = PLAIN_STRAND_TRIDIAGONAL;
    plain.passes = 1;
    double p[VERTICES][3], w[VERTICES], rest[VERTICES];
    for ( int v = 0; v < VERTICES; ++v )
    {
        // a step of 1 s with these velocities is the disturbance
        plain.velocity[v] = ( wisp_vec3 ){ 0.01f * (float)( v % 3 ), -0.02f * (float)( v % 2 ), 0.015f };
        float moves = v > 0 ? 1.0f : 0.0f;
        p[v][0] = (double)( points[v].x + moves * plain.velocity[v].x );
        p[v][1] = (double)( points[v].y + moves * plain.velocity[v].y );
        p[v][2] = (double)( points[v].z + moves * plain.velocity[v].z );
        w[v] = (double)plain.inverse_mass[v];
        rest[v] = (double)plain.length[v];
    }
    newton_pass( p, w, rest );
    plain_strands_step( &plain, 1.0f );
    for ( int v = 0; v < VERTICES; ++v )
    {
        // coordinates up to 0.5 m, a handful of roundings
        assert_true( fabs( (double)plain.position[v].x - p[v][0] ) < 4.0 * (double)FLT_EPSILON );
        assert_true( fabs( (double)plain.position[v].y - p[v][1] ) < 4.0 * (double)FLT_EPSILON );
        assert_true( fabs( (double)plain.position[v].z - p[v][2] ) < 4.0 * (double)FLT_EPSILON );
    }
    plain_strands_destroy( &plain );
}

static void vertices_of_plain_strands_have_half_the_mass_of_each_segment( void** state )
{
    (void)state;
    const wisp_vec3 points[3] = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 1.0f, 3.0f, 0.0f } };
    plain_strands plain;
    assert_true( plain_strands_create( &plain, points, 1, 3, 2.0f ) );
    assert_true( plain.inverse_mass[0] == 0.0f );
    assert_true( plain.inverse_mass[1] == 1.0f / 4.0f );
    assert_true( plain.inverse_mass[2] == 1.0f / 3.0f );
    plain_strands_destroy( &plain );
    assert_false( plain_strands_create( &plain, points, 1, PLAIN_STRAND_VERTICES_MAX + 1, 2.0f ) );
    assert_null( plain.position );
}

static double distance_to_engine( plain_strand_stretch how, int steps, double* moved )
{
    enum
    {
        STRANDS = 20,
    };
    strands_shape shape;
    strands_implementation implementation;
    plain_strands plain;
    wisp_error error = { 0 };
    const bool sweeps = how == PLAIN_STRAND_SWEEP;
    const strands_setting setting = { "one", sweeps ? WISP_STRAND_STRETCH_LINKS : WISP_STRAND_STRETCH_DIRECT,
                                      WISP_STRAND_BEND_LINKS, 2, 10 };
    assert_ok( strands_shape_make_horizontal( STRANDS, &shape, &error ), error );
    strands_generator generator = strands_default_generator( &shape );
    generator.dynamics = strands_setting_dynamics( &setting );
    generator.substeps = setting.substeps;
    assert_ok( strands_implementation_create( &generator, &implementation, &error ), error );
    assert_true(
        plain_strands_create( &plain, shape.points, STRANDS, STRANDS_VERTICES, generator.dynamics.line_density ) );
    plain.bend_compliance = STRANDS_BEND_COMPLIANCE;
    plain.stretch = how;
    plain.substeps = setting.substeps;
    assert_ok( strands_implementation_steps( &implementation, steps, &error ), error );
    for ( int s = 0; s < steps; ++s )
    {
        plain_strands_step( &plain, STRANDS_STEP );
    }
    const wisp_vec3* points;
    assert_ok( strands_implementation_points( &implementation, &points, &error ), error );
    double distance = strands_rms_distance( points, plain.position, strands_shape_size( &shape ) );
    *moved = strands_rms_distance( points, shape.points, strands_shape_size( &shape ) );
    plain_strands_destroy( &plain );
    strands_implementation_destroy( &implementation );
    strands_shape_free( &shape );
    return distance;
}

static void both_sides_of_the_comparison_compute_the_same( void** state )
{
    (void)state;
    for ( int how = 0; how < 2; ++how )
    {
        double moved;
        double distance = distance_to_engine( how == 0 ? PLAIN_STRAND_SWEEP : PLAIN_STRAND_TRIDIAGONAL, 3, &moved );

        // 30 substeps of two roundings of 1 m each; the strands have fallen by then
        assert_true( moved > 5e-3 );
        assert_true( distance < 60.0 * (double)FLT_EPSILON );
    }
}

// ---- the scene ----

static void strands_start_horizontal_with_their_roots_pinned( void** state )
{
    (void)state;
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

static void a_nan_is_never_a_small_stretch( void** state )
{
    (void)state;
    strands_shape shape;
    wisp_error error = { 0 };
    const wisp_vec3 along = { 1.0f, 0.0f, 0.0f };
    assert_ok( strands_shape_make_straight( 4, along, 1.0, &shape, &error ), error );
    wisp_vec3 points[4] = { { 0.0f, 0.0f, 0.0f }, { NAN, 0.0f, 0.0f }, { 0.6f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f } };
    const strands_stretch stretch = strands_measure_stretch( &shape, points );
    assert_true( isnan( stretch.mean ) );
    strands_shape_free( &shape );
}

// ---- the tables ----

static void the_comparison_has_a_line_a_setting_and_the_kernels_alone( void** state )
{
    (void)state;
    strands_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( strands_comparison( &plan, &all, &error ), error );
    expect_good( &all );
    assert_fits_terminal( &all );
    const results_table* table = find_table( &all, "Strands x 20 vertices" );

    // two of scalar C per size, all five settings at 20 strands and two at 100
    assert_int_equal( table->row_count, 1 + 2 + 5 + 2 + 2 );
    int nvcloth = column_of( table, "NvCloth 1 / 2 threads ms*" ), hash = column_of( table, "hash" );
    assert_string_equal( cell( table, 3, 1 ), "direct, bend links" );
    assert_string_equal( cell( table, 3, nvcloth ), "-" );
    assert_string_equal( cell( table, 10, 0 ), "100" );
    assert_string_equal( cell( table, 10, nvcloth ), "0.149 / 0.079" );
    assert_int_equal( strlen( cell( table, 10, hash ) ), 16 );
    for ( int r = 0; r < all.row_count; ++r )
    {
        const results_row* row = &all.rows[r];
        bool is_ours = strncmp( row->variant, "plain", 5 ) != 0;
        assert_true( row->ms_median > 0.0 );
        assert_int_equal( row->has_hash, is_ours );
        assert_true( isfinite( value_of( &row->error, "rms_share_of_length" ) ) );

        // the direct solve is exact, a sweep is not
        bool is_direct = strncmp( row->variant, "direct", 6 ) == 0 || strstr( row->variant, "tridiagonal" );
        assert_true( !is_direct || value_of( &row->error, "stretch_mean" ) < 1e-4 );
    }

    // one chart per worker count, with the times of the rows: at 20 and at 100 strands
    assert_int_equal( all.chart_count, plan.worker_count );
    const results_series* plain = &all.charts[0].series[0];
    assert_string_equal( plain->name, "plain C, sweeps, 10 substeps" );
    assert_int_equal( plain->count, 2 );
    assert_true( plain->points[0].x == 20.0 && plain->points[1].x == 100.0 );
    assert_true( plain->points[0].y == all.rows[0].ms_median );
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

static void more_substeps_come_nearer_to_the_reference_and_lose_less( void** state )
{
    (void)state;
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

static void closed_forms_are_met( void** state )
{
    (void)state;
    strands_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( strands_closed_forms( &plan, &all, &error ), error );
    const results_table* table = find_table( &all, "Strands against closed forms" );
    assert_true( table->row_count > 60 );
    expect_good( &all );
    results_free( &all );
}

static void a_hair_at_rest_does_not_depend_on_the_rate_of_steps( void** state )
{
    (void)state;
    strands_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( strands_independence( &plan, &all, &error ), error );
    find_table( &all, "A clamped hair" );
    double least = INFINITY, most = 0.0;
    for ( int r = 0; r < all.row_count; ++r )
    {
        const results_values* size = &all.rows[r].size; // rate, substeps, vertices
        if ( size->items[1].value == 10.0 && size->items[2].value == 20.0 )
        {
            least = fmin( least, value_of( &all.rows[r].error, "tip_elastica_percent" ) );
            most = fmax( most, value_of( &all.rows[r].error, "tip_elastica_percent" ) );
        }
    }
    // 20 vertices are half a percent from the continuous hair, at every rate
    assert_true( least > 0.0 && most < 1.0 );
    assert_true( most - least < 0.05 );
    // the converged run is the closed form
    assert_true( value_of( &all.rows[0].error, "tip_elastica_percent" ) < 0.05 );
    results_free( &all );
}

static void lone_ghosts_without_sway_are_their_guides( void** state )
{
    (void)state;
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

static void a_million_vertices_are_held_to_their_claims( void** state )
{
    (void)state;
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

static void the_stats_of_guide_hair_are_met( void** state )
{
    (void)state;
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

static void the_figures_of_frozen_hair_are_met_and_drawn( void** state )
{
    (void)state;
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

static void pictures_of_ghosts_are_written( void** state )
{
    (void)state;
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

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( plain_tridiagonal_solves_the_whole_system ),
        cmocka_unit_test( vertices_of_plain_strands_have_half_the_mass_of_each_segment ),
        cmocka_unit_test( both_sides_of_the_comparison_compute_the_same ),
        cmocka_unit_test( strands_start_horizontal_with_their_roots_pinned ),
        cmocka_unit_test( a_nan_is_never_a_small_stretch ),
        cmocka_unit_test( the_comparison_has_a_line_a_setting_and_the_kernels_alone ),
        cmocka_unit_test( more_substeps_come_nearer_to_the_reference_and_lose_less ),
        cmocka_unit_test( closed_forms_are_met ),
        cmocka_unit_test( a_hair_at_rest_does_not_depend_on_the_rate_of_steps ),
        cmocka_unit_test( lone_ghosts_without_sway_are_their_guides ),
        cmocka_unit_test( a_million_vertices_are_held_to_their_claims ),
        cmocka_unit_test( the_stats_of_guide_hair_are_met ),
        cmocka_unit_test( the_figures_of_frozen_hair_are_met_and_drawn ),
        cmocka_unit_test( pictures_of_ghosts_are_written ),
    };
    return cmocka_run_group_tests_name( "bench strands", tests, NULL, NULL );
}
