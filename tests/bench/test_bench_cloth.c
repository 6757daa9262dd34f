// The cases of cloth, balloon and figures at very small sizes: their tables and rows, equal results of both sides of
// a comparison, and failures of the run after an error.
#include "bench_tables.h"

#include "accuracy/accuracy.h"
#include "balloon_bench.h"
#include "program_data.h"
#include "cloth_bench.h"
#include "figures_bench.h"
#include "figures_drape.h"
#include "suite.h"
#include "suite/suite_folder.h"
#include "oracle/constraint_oracle.h"
#include "wisp/module/module.h"

static const bench_options quick = { .quick = true, .workers = 2 };

static cloth_plan small_plan( void )
{
    cloth_plan plan = cloth_default_plan( &quick );
    plan.comparison_sizes[0] = 8;
    plan.comparison_sizes[1] = 12;
    plan.comparison_count = 2;
    plan.scenario = ( scenario_plan ){ .warm_steps = 6, .measured_steps = 10, .turn_steps = 3 };
    plan.comparison_seconds = 0.0;
    return plan;
}

// ---- the case of cloth ----

static void the_comparison_has_a_line_a_size_with_an_error_and_a_hash( void** state )
{
    (void)state;
    cloth_plan plan = small_plan();
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( cloth_comparison( &plan, &all, &error ), error );
    assert_false( all.failed );
    const results_table* table = find_table( &all, "Cloth against scalar C" );
    assert_int_equal( table->row_count, 1 + 2 );
    assert_string_equal( cell( table, 2, 0 ), "12" );
    assert_int_equal( strlen( cell( table, 1, table->column_count - 1 ) ), 16 );

    // scalar step, scalar pass and two worker counts per size
    assert_int_equal( all.row_count, 2 * 4 );
    for ( int r = 0; r < all.row_count; ++r )
    {
        const results_row* row = &all.rows[r];
        assert_true( row->ms_median > 0.0 );
        bool is_ours = strcmp( row->variant, "wisp" ) == 0;
        assert_int_equal( row->has_hash, is_ours );
        assert_int_equal( row->error.count > 0, is_ours );
    }
    assert_true( has_note( &all, "Claim: " ) );
    results_free( &all );
}

// ---- its suites ----

static int count_suite_rows( const char* path )
{
    wisp_suite suite;
    wisp_error error = { 0 };
    assert_ok( suite_read( path, &suite, &error ), error );
    const int count = suite.row_count;
    suite_release( &suite );
    return count;
}

static void suites_of_the_case_are_read( void** state )
{
    (void)state;
    static const char* const names[] = { "hang", "coarse_64", "coarse_128", "coarse_irregular", "passes" };
    for ( size_t i = 0; i < WISP_COUNT( names ); ++i )
    {
        char path[500];
        snprintf( path, sizeof path, "%s/data/suites/cloth/%s.yaml", WISP_SOURCE_ROOT, names[i] );
        assert_true( count_suite_rows( path ) >= 4 );
    }
}

static void a_folder_without_suites_is_an_error( void** state )
{
    (void)state;
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( suite_bench_folder( "nowhere", 1.0, &quick, &all, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "nowhere" ) );
    assert_int_equal( suite_bench_folder( "scenes", 1.0, &quick, &all, &error ), WISP_BAD_INPUT );
    results_free( &all );
}

// ---- its reference ----

static void the_reference_projects_as_the_oracle_does( void** state )
{
    (void)state;
    cloth_scene scene;
    wisp_fabric* fabric;
    cloth_reference reference;
    wisp_error error = { 0 };
    assert_ok( cloth_scene_make( 6, true, &scene, &error ), error );
    assert_ok( cloth_cook( &scene, &fabric, &error ), error );
    assert_ok( cloth_reference_create( &scene, fabric, &reference, &error ), error );
    assert_int_equal( reference.link_count, fabric->link_count );
    double3* p = checked_calloc( (size_t)reference.slot_count, sizeof( double3 ) );
    double h = (double)CLOTH_STEP;
    for ( int i = 0; i < reference.slot_count; ++i )
    {
        const double* q = reference.position[i];
        double fall = reference.inverse_mass[i] > 0.0 ? h * h * (double)CLOTH_GRAVITY : 0.0;
        p[i] = double3_make( q[0], q[1] - fall, q[2] );
    }
    for ( int i = 0; i < reference.link_count; ++i )
    {
        int a = reference.links[i][0], b = reference.links[i][1];
        double3 da, db;
        constraint_oracle_distance_step( p[a], p[b], reference.inverse_mass[a], reference.inverse_mass[b],
                                         reference.rest[i], &da, &db );
        p[a] = double3_add( p[a], double3_scale( reference.stiffness[i], da ) );
        p[b] = double3_add( p[b], double3_scale( reference.stiffness[i], db ) );
    }
    cloth_reference_step( &reference, 1 );
    for ( int i = 0; i < reference.slot_count; ++i )
    {
        const double* q = reference.position[i];
        // the same arithmetic in another association
        assert_true( double3_distance( p[i], double3_make( q[0], q[1], q[2] ) ) < 1e-14 );
    }
    free( p );
    cloth_reference_destroy( &reference );
    wisp_fabric_release( fabric );
    cloth_scene_free( &scene );
}

// ---- failures ----

static void a_hash_of_its_own_fails_the_run( void** state )
{
    (void)state;
    surface_implementation implementations[2] = { { .generator = { .workers = 1 } },
                                                  { .generator = { .workers = 2 } } };
    results all = { 0 };
    const uint64_t same[2] = { 7, 7 }, apart[2] = { 7, 8 };
    scenario_check_hashes( implementations, 2, same, "a row", &all );
    assert_false( all.failed );
    scenario_check_hashes( implementations, 2, apart, "a row", &all );
    assert_true( all.failed );
    assert_true( has_note( &all, "FAILED: a row: 2 workers give hash 0000000000000008" ) );
    results_free( &all );
}

static void an_error_above_its_tolerance_or_without_a_number_fails_the_run( void** state )
{
    (void)state;
    const double wrong[] = { 2e-6, NAN, INFINITY };
    for ( int i = 0; i < WISP_COUNT( wrong ); ++i )
    {
        results all = { 0 };
        cloth_check_error( 1e-6, 1e-6, "a row", &all );
        assert_false( all.failed );
        cloth_check_error( wrong[i], 1e-6, "a row", &all );
        assert_true( all.failed );
        results_free( &all );
    }
}

static void a_claim_that_is_not_met_is_a_message_and_no_failure( void** state )
{
    (void)state;
    results all = { 0 };
    results_add_claim( &all, false, "it is fast", 1.5, " times" );
    assert_false( all.failed );
    assert_true( has_note( &all, "claim not met on this machine" ) );
    results_free( &all );
}

static void a_cloth_that_leaves_its_bounds_is_shown_as_halted( void** state )
{
    (void)state;
    cloth_scene scene;
    wisp_fabric* fabric;
    surface_implementation implementation;
    scenario_stats stats;
    wisp_error error = { 0 };
    const cloth_setting setting = { 1, 1 };
    const scenario_plan plan = { .warm_steps = 3, .measured_steps = 6, .turn_steps = 3 };
    assert_ok( cloth_scene_make( 6, false, &scene, &error ), error );
    assert_ok( cloth_cook( &scene, &fabric, &error ), error );
    assert_ok( cloth_implementation_create( &scene, fabric, &setting, 1, &implementation, &error ), error );
    assert_ok( surface_implementation_step( &implementation, &error ), error );
    float* position = wisp_world_column( implementation.world, implementation.entity, WISP_PARTICLE_POSITION, 0 );
    position[4 * fabric->vertex_slot[17]] = NAN;
    assert_ok( scenario_run( &implementation, 1, &plan, NULL, NULL, &stats, &error ), error );
    assert_int_equal( stats.halted_at, implementation.halted_at );
    assert_int_equal( stats.halted_at, 2 );
    assert_true( isnan( stats.ms[0].median ) && isnan( stats.stretch_max ) && isnan( stats.path ) );
    surface_implementation_destroy( &implementation );
    wisp_fabric_release( fabric );
    cloth_scene_free( &scene );
}

// ---- the other two cases ----

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

static void the_balloon_shows_volume_pressure_and_memory_beside_time( void** state )
{
    (void)state;
    results all = { 0 };
    run_suite( "sizes", 2, &all );
    balloon_conclude( 0, 2, &all );
    assert_false( all.failed );
    assert_int_equal( all.row_count, 2 * 2 );
    const results_table* sizes = find_table( &all, "Balloon: cost by size" );
    assert_int_equal( sizes->row_count, 1 + 2 * 2 );
    assert_string_equal( named_cell( sizes, 1, "vertices" ), "642" );
    assert_true( atof( named_cell( sizes, 1, "volume ns per triangle" ) ) > 0.0 );
    assert_true( atof( named_cell( sizes, 1, "bytes per vertex" ) ) > 100.0 );
    assert_int_equal( all.charts[all.chart_count - 1].series_count, 2 );
    assert_true( has_note( &all, "Claim: " ) );

    // a volume that is not there is wrong, too
    all.rows[0].error.count = 0;
    balloon_conclude( 0, 2, &all );
    assert_true( all.failed );
    results_free( &all );
}

// Times of 10 ms for 642 vertices that grow with the given power.
static bool fails_with_power( results* all, double power )
{
    for ( int i = 0; i < all->row_count; ++i )
    {
        const double vertices = strtod( strstr( all->rows[i].variant, "vertices=" ) + 9, NULL );
        all->rows[i].ms_p10 = 10.0 * pow( vertices / 642.0, power );
    }
    all->failed = false;
    balloon_conclude( 0, 2, all );
    return all->failed;
}

static void a_balloon_whose_time_is_not_linear_in_its_vertices_fails( void** state )
{
    (void)state;
    results all = { 0 };
    run_suite( "sizes", 3, &all );
    assert_false( fails_with_power( &all, 1.0 ) );
    assert_true( fails_with_power( &all, 1.2 ) );
    assert_true( fails_with_power( &all, 2.0 ) );
    results_free( &all );
}

static void the_virial_pressure_is_near_that_of_even_scaling( void** state )
{
    (void)state;
    results all = { 0 };
    run_suite( "pressure", 2, &all );
    const results_table* table = find_table( &all, "Suite `pressure`" );
    const int row = row_of( table, "1 iteration, pressure=virial, substeps=100" );
    const double pressure = atof( named_cell( table, row, "pressure, Pa" ) );
    const double even = atof( named_cell( table, row, "pressure if scaled evenly, Pa" ) );
    // within 2 %, as the specification's table has it
    assert_true( even > 2000.0 && fabs( pressure / even - 1.0 ) < 0.02 );
    results_free( &all );
}

static void the_accuracy_of_a_step_is_as_promised( void** state )
{
    (void)state;
    static figures_fn* const one[] = { figures_hang_accuracy };
    results all = { 0 };
    wisp_error error = { 0 };
    setenv( "WISP_CACHE", "suite-cache", 1 );
    assert_ok( figures_run( one, 1, &quick, &all, &error ), error );
    assert_false( all.failed );
    assert_int_equal( all.tables[0].row_count, 1 + 3 );
    const results_table* step = find_table( &all, "Accuracy `step`" );
    assert_true( atof( named_cell( step, row_of( step, "bdf2, 0.02 s" ), "left to euler" ) ) > 0.0 );
    assert_true( atof( named_cell( step, row_of( step, "euler, dt=0.005" ), "linear iterations" ) ) > 0.0 );
    for ( int r = 1; r < step->row_count; ++r )
    {
        assert_true( atof( named_cell( step, r, "largest distance, mm" ) ) >
                     atof( named_cell( step, r, "RMS distance to the reference, mm" ) ) );
    }
    results_free( &all );
}

static void a_figure_that_is_not_met_fails_the_run( void** state )
{
    (void)state;
    static figures_fn* const small[] = { figures_two_particles, figures_links, figures_four_forces };
    results all = { 0 };
    wisp_error error = { 0 };
    assert_ok( figures_run( small, WISP_COUNT( small ), &quick, &all, &error ), error );
    assert_false( all.failed );
    assert_int_equal( all.tables[0].row_count, 1 + 4 );

    figures_case page = { .out = &all, .table = 0 };
    figures_add( &page, "F0", "an experiment", "one", false, "%d", 2 );
    assert_true( all.failed );
    assert_true( has_note( &all, "FAILED: F0, an experiment: expected one; measured 2." ) );
    results_free( &all );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( the_comparison_has_a_line_a_size_with_an_error_and_a_hash ),
        cmocka_unit_test( suites_of_the_case_are_read ),
        cmocka_unit_test( a_folder_without_suites_is_an_error ),
        cmocka_unit_test( the_reference_projects_as_the_oracle_does ),
        cmocka_unit_test( a_hash_of_its_own_fails_the_run ),
        cmocka_unit_test( an_error_above_its_tolerance_or_without_a_number_fails_the_run ),
        cmocka_unit_test( a_claim_that_is_not_met_is_a_message_and_no_failure ),
        cmocka_unit_test( a_cloth_that_leaves_its_bounds_is_shown_as_halted ),
        cmocka_unit_test( the_balloon_shows_volume_pressure_and_memory_beside_time ),
        cmocka_unit_test( a_balloon_whose_time_is_not_linear_in_its_vertices_fails ),
        cmocka_unit_test( the_virial_pressure_is_near_that_of_even_scaling ),
        cmocka_unit_test( the_accuracy_of_a_step_is_as_promised ),
        cmocka_unit_test( a_figure_that_is_not_met_fails_the_run ),
    };
    return cmocka_run_group_tests_name( "bench cloth", tests, NULL, NULL );
}
