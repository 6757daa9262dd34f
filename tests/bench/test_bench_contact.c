// The case `contact` at very small sizes: all searches find the same, tables are complete, and the measures of
// overlap and of intersections detect them.
#include "bench_tables.h"

#include "contact_bench.h"
#include "contact_overlap.h"
#include "contact_probe.h"
#include "contact_query_input.h"

#include <unistd.h>

static const bench_options quick = { .quick = true, .workers = 2 };

static contact_plan small_plan( void )
{
    return ( contact_plan ){
        .sheet_sides = { 12, 24 },
        .sphere_levels = { 1, 3 },
        .size_count = 2,
        .max_brute = 1e5, // the smaller size runs all queries, the larger one a sample
        .query_seconds = 0.0,
        .fold_side = 16,
        .fold_steps = 50,
        .fold_seconds = 1e3,
        .motion_seconds = 1e3,
        .balloon_level = 1,
        .balloon_steps = 30,
        .balloon_seconds = 1e3,
        .teams = { { 1, 2 }, 2 },
        .options = &quick,
    };
}

static double number( const results_table* table, int row, const char* column )
{
    return strtod( named_cell( table, row, column ), NULL );
}

// ---- tables ----

static void no_check_of_the_case_fails( void** state )
{
    const results* all = *state;
    expect_good( all );
    assert_fits_terminal( all );
    assert_column( find_table( all, "Contact, queries" ), "same", "yes" );
    assert_column( find_table( all, "Contact, the cost" ), "same", "yes" );
    assert_column( find_table( all, "Contact, cost of motion" ), "same", "yes" );
    assert_column( find_table( all, "Contact, two balloons" ), "same", "yes" );
    assert_column( find_table( all, "Contact, ten balloons" ), "same", "yes" );
}

static void every_search_has_a_line_for_every_kind_and_size( void** state )
{
    const results_table* table = find_table( *state, "Contact, queries" );
    int brute = 0, automatic = 0;
    for ( int r = 1; r < table->row_count; ++r )
    {
        const char* search = named_cell( table, r, "search" );
        brute += strcmp( search, "brute force" ) == 0 ? 1 : 0;
        automatic += strstr( search, "(auto)" ) != NULL ? 1 : 0;
        assert_true( number( table, r, "pairs" ) > 0.0 );
    }
    const int contests = QUERY_INPUT_SOURCES * 2 * QUERY_INPUT_KINDS;
    assert_int_equal( automatic, contests );
    assert_int_equal( table->row_count - 1, 2 * contests + brute );
    // 144 particles and 397 edges of the sheet, 84 and 240 of the spheres, whose triangles are 242 and 160
    assert_int_equal( brute, 6 );
}

static void a_tree_is_refitted_and_a_grid_is_not( void** state )
{
    const results_table* table = find_table( *state, "Contact, queries" );
    for ( int r = 1; r < table->row_count; ++r )
    {
        const bool is_tree = strncmp( named_cell( table, r, "search" ), "tree", 4 ) == 0;
        const bool has_refit = strcmp( named_cell( table, r, "refit ms, 1 w" ), "-" ) != 0;
        assert_true( has_refit == is_tree );
    }
}

static void what_is_not_kept_apart_crosses_and_what_is_does_not( void** state )
{
    const results_table* table = find_table( *state, "Contact, the cost" );
    assert_true( number( table, row_of( table, "none" ), "max intersections" ) > 0.0 );
    assert_string_equal( named_cell( table, row_of( table, "none" ), "pairs" ), "-" );
    assert_string_equal( named_cell( table, row_of( table, "exact, margin 2" ), "max intersections" ), "0" );
    assert_true( number( table, row_of( table, "exact, margin 2" ), "pairs" ) > 0.0 );
}

static void the_tree_folds_the_cloth_as_the_grid_does( void** state )
{
    const results_table* table = find_table( *state, "Contact, the cost" );
    assert_string_equal( named_cell( table, row_of( table, "exact, margin 2, tree" ), "hash" ),
                         named_cell( table, row_of( table, "exact, margin 2" ), "hash" ) );
}

static void a_larger_margin_has_more_pairs( void** state )
{
    const results_table* table = find_table( *state, "Contact, the cost" );
    const double one = number( table, row_of( table, "exact, margin 1" ), "pairs" );
    const double two = number( table, row_of( table, "exact, margin 2" ), "pairs" );
    const double four = number( table, row_of( table, "exact, margin 4" ), "pairs" );
    assert_true( one < two && two < four );
}

static void a_ball_at_its_pace_folds_the_cloth_as_in_the_other_table( void** state )
{
    const results_table* table = find_table( *state, "Contact, cost of motion" );
    const results_table* price = find_table( *state, "Contact, the cost" );
    const int rest = row_of( table, "ball at rest" ), pace = row_of( table, "its pace" ),
              twice = row_of( table, "twice its pace" );
    assert_string_equal( named_cell( table, pace, "hash" ),
                         named_cell( price, row_of( price, "exact, margin 1" ), "hash" ) );
    assert_string_not_equal( named_cell( table, rest, "hash" ), named_cell( table, pace, "hash" ) );
    assert_string_not_equal( named_cell( table, twice, "hash" ), named_cell( table, pace, "hash" ) );
    assert_true( number( table, rest, "max speed, m/s" ) == 0.0 );
    assert_true( number( table, pace, "max speed, m/s" ) == 0.54 ); // 0.15 m, 3 and 2 rad/s
    assert_true( number( table, twice, "max speed, m/s" ) == 1.08 );
    for ( int r = pace; r < table->row_count; ++r )
    {
        assert_string_equal( named_cell( table, r, "max intersections" ), "0" );
        assert_true( number( table, r, "contacts" ) > 0.0 );
    }
}

static void balloons_overlap_only_where_nothing_keeps_them_apart( void** state )
{
    const results_table* table = find_table( *state, "Contact, two balloons" );
    assert_true( number( table, row_of( table, "none" ), "max overlap, %" ) > 5.0 );
    assert_true( number( table, row_of( table, "exact, margin 2" ), "max overlap, %" ) <
                 1.0 ); // extension, not in the balloon paper
    assert_true( number( table, row_of( table, "exact, margin 2" ), "force N" ) > 0.0 );
}

static void rows_for_machines_are_there_for_every_worker_count( void** state )
{
    const results* all = *state;
    int rows = 0, motion_rows = 0;
    for ( int i = 0; i < all->row_count; ++i )
    {
        rows += strcmp( all->rows[i].name, "contact.fold" ) == 0 ? 1 : 0;
        motion_rows += strcmp( all->rows[i].name, "contact.motion" ) == 0 ? 1 : 0;
        assert_true( all->rows[i].steps > 0 && isfinite( all->rows[i].ms_median ) );
    }
    assert_int_equal( rows, 2 * ( find_table( all, "Contact, the cost" )->row_count - 1 ) );
    assert_int_equal( motion_rows, 2 * ( find_table( all, "Contact, cost of motion" )->row_count - 1 ) );
}

// ---- limits ----

static void a_way_that_takes_too_long_ends_early( void** state )
{
    (void)state;
    const contact_way way = { .name = "exact", .margin = 2.0f };
    const contact_teams teams = { { 1 }, 1 };
    contact_scene scene;
    contact_run run;
    wisp_error error = { 0 };
    assert_int_equal( contact_make_cloth( 6, &scene, &error ), WISP_OK );
    const contact_comparison comparison = {
        .scene = &scene,
        .enter = contact_enter_fold,
        .ways = &way,
        .way_count = 1,
        .steps = 100,
        .seconds = 0.0,
        .teams = &teams,
        .options = &quick,
        .name = "contact.fold",
        .span = 1.0,
    };
    assert_int_equal( contact_comparison_run( &comparison, &run, &error ), WISP_OK );
    assert_true( run.steps > 0 && run.steps < 100 );
    assert_true( run.same_hash );
    contact_scene_free( &scene );
}

static void the_sizes_of_the_case_grow_with_its_time( void** state )
{
    (void)state;
    bench_options options = { .seconds = 18.0, .workers = 1 };
    const contact_plan brief = contact_default_plan( &options );
    options.seconds = 85.0;
    const contact_plan usual = contact_default_plan( &options );
    options.seconds = 600.0;
    const contact_plan full = contact_default_plan( &options );
    assert_true( brief.size_count < usual.size_count && brief.fold_steps < usual.fold_steps );
    assert_int_equal( full.fold_side, 64 );
    assert_int_equal( full.fold_steps, 300 ); // five seconds
    assert_int_equal( full.teams.count, 1 );
}

// ---- measures ----

// Two balloons, one of which is moved into the other by this distance.
static double overlap_of( float distance, float* thickness )
{
    const contact_setting setting = { .way = { .name = "none", .is_off = true }, .workers = 1 };
    contact_scene scene;
    contact_world world;
    contact_overlap seen;
    wisp_error error = { 0 };
    assert_int_equal( contact_make_balloon( 3, &scene, &error ), WISP_OK );
    assert_int_equal( contact_enter_pair( &scene, &setting, &world, &error ), WISP_OK );
    assert_int_equal( contact_step( &world, &error ), WISP_OK );
    // the measure uses the points that are passed to it
    wisp_vec3* points[2];
    for ( int i = 0; i < 2; ++i )
    {
        const wisp_vec3* shown;
        assert_int_equal( contact_points( &world, i, &shown, &error ), WISP_OK );
        points[i] = (wisp_vec3*)(uintptr_t)shown;
        for ( int v = 0; v < scene.mesh.vertex_count; ++v )
        {
            points[i][v] = scene.mesh.points[v];
            points[i][v].x += i == 0 ? 0.0f : distance;
        }
    }
    assert_int_equal( contact_find_overlap( &world, &seen, &error ), WISP_OK );
    *thickness = scene.thickness;
    contact_leave( &world );
    contact_scene_free( &scene );
    return seen.overlap;
}

static void overlap_is_how_deep_a_vertex_is_in_the_other_balloon( void** state )
{
    (void)state;
    float t;
    // facets of a level 3 sphere are up to 0.6 % of the radius below it: the depth of a vertex may be smaller by that
    const double facet = 0.006 * (double)PRESS_RADIUS;
    const double deep = overlap_of( 1.6f * PRESS_RADIUS, &t ), expected = 0.4 * (double)PRESS_RADIUS + (double)t;
    assert_true( deep <= expected + 1e-6 && deep > expected - 2.0 * facet );
    const double near = overlap_of( 2.0f * PRESS_RADIUS + 0.5f * t, &t );
    assert_true( near <= 0.5 * (double)t + 1e-6 && near > 0.5 * (double)t - 2.0 * facet );
    assert_true( overlap_of( 2.0f * PRESS_RADIUS + 2.0f * t, &t ) == 0.0 );
}

static wisp_status fail_on_purpose( void* context, const wisp_parallel* parallel, const wisp_kernels* kernels,
                                    wisp_error* error )
{
    assert_non_null( parallel );
    assert_non_null( kernels );
    *(int*)context += 1;
    return wisp_fail( error, WISP_CONFLICT, "on purpose" );
}

static void a_probe_calls_once_and_hands_a_failure_on( void** state )
{
    (void)state;
    contact_probe probe;
    wisp_error error = { 0 };
    int calls = 0;
    assert_int_equal( contact_probe_open( 2, &probe, &error ), WISP_OK );
    assert_int_equal( contact_probe_run( &probe, fail_on_purpose, &calls, &error ), WISP_CONFLICT );
    assert_int_equal( calls, 1 );
    assert_non_null( strstr( error.message, "on purpose" ) );
    contact_probe_close( &probe );
}

static void pictures_are_written_and_linked( void** state )
{
    (void)state;
    char folder[] = "contact_pictures_XXXXXX";
    assert_non_null( mkdtemp( folder ) );
    bench_options options = quick;
    options.pictures = folder;
    contact_plan plan = small_plan();
    plan.options = &options;
    plan.picture_side = 8;
    plan.picture_level = 2;
    plan.picture_steps = 20;
    plan.picture_pixels = 16;
    results all = { 0 };
    wisp_error error = { 0 };
    assert_int_equal( contact_pictures( &plan, &all, &error ), WISP_OK );
    static const char* const names[] = { "contact_pair", "contact_stack", "contact_cloth" };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char path[128];
        snprintf( path, sizeof( path ), "%s/%s.png", folder, names[i] );
        assert_non_null( strstr( all.notes[i], path ) );
        assert_int_equal( remove( path ), 0 );
    }
    assert_int_equal( rmdir( folder ), 0 );
    results_free( &all );
}

static int make_results( void** state )
{
    static results all;
    const contact_plan plan = small_plan();
    wisp_error error = { 0 };
    assert_ok( contact_bench_run( &plan, &all, &error ), error );
    *state = &all;
    return 0;
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( no_check_of_the_case_fails ),
        cmocka_unit_test( every_search_has_a_line_for_every_kind_and_size ),
        cmocka_unit_test( a_tree_is_refitted_and_a_grid_is_not ),
        cmocka_unit_test( what_is_not_kept_apart_crosses_and_what_is_does_not ),
        cmocka_unit_test( the_tree_folds_the_cloth_as_the_grid_does ),
        cmocka_unit_test( a_larger_margin_has_more_pairs ),
        cmocka_unit_test( a_ball_at_its_pace_folds_the_cloth_as_in_the_other_table ),
        cmocka_unit_test( balloons_overlap_only_where_nothing_keeps_them_apart ),
        cmocka_unit_test( rows_for_machines_are_there_for_every_worker_count ),
        cmocka_unit_test( a_way_that_takes_too_long_ends_early ),
        cmocka_unit_test( the_sizes_of_the_case_grow_with_its_time ),
        cmocka_unit_test( overlap_is_how_deep_a_vertex_is_in_the_other_balloon ),
        cmocka_unit_test( a_probe_calls_once_and_hands_a_failure_on ),
        cmocka_unit_test( pictures_are_written_and_linked ),
    };
    return cmocka_run_group_tests_name( "bench contact", tests, make_results, free_results );
}
