// The case `contact` at very small sizes: tables are complete, and the measures of
// overlap and of intersections detect them.
#include "bench_tables.h"

#include "accuracy/accuracy.h"
#include "program_data.h"
#include "suite_cases.h"
#include "suite_measure.h"

static double number( const results_table* table, int row, const char* column )
{
    return strtod( named_cell( table, row, column ), NULL );
}

// ---- tables ----

TEST( no_check_of_the_case_fails )
{
    const results* all = *state;
    expect_good( all );
    assert_fits_terminal( all );
}

TEST( what_is_not_kept_apart_crosses_and_what_is_does_not )
{
    const results_table* table = find_table( *state, "Suite `cost`: contact" );
    assert_true( number( table, row_of( table, "none" ), "max intersections" ) > 0.0 );
    assert_string_equal( named_cell( table, row_of( table, "none" ), "pairs" ), "-" );
    assert_string_equal( named_cell( table, row_of( table, "exact, margin=2" ), "max intersections" ), "0" );
    assert_true( number( table, row_of( table, "exact, margin=2" ), "pairs" ) > 0.0 );
}

TEST( balloons_overlap_only_where_nothing_keeps_them_apart )
{
    const results_table* table = find_table( *state, "Suite `pair`: contact" );
    assert_true( number( table, row_of( table, "none" ), "max overlap, mm" ) > 7.5 );
    const int exact = row_of( table, "exact, margin=2" );
    assert_true( number( table, exact, "max overlap, mm" ) < 1.5 ); // extension, not in the balloon paper
    assert_true( number( table, exact, "largest force, N" ) > 0.0 );
}

// ---- what contact promises ----

static void put_row( results* all, const char* name, const char* variant, const char* value, double number )
{
    results_row* row = results_add_row( all, name, variant );
    assert_non_null( row );
    row->workers = 1;
    results_put( &row->error, value, number );
}

static bool is_refused( const char* name, const char* variant, const char* value, double number )
{
    results all = { 0 };
    put_row( &all, name, variant, value, number );
    contact_check_suites( 0, &all );
    const bool is_failed = all.failed;
    results_free( &all );
    return is_failed;
}

TEST( a_row_that_breaks_a_promise_is_a_failure )
{
    assert_false( is_refused( "suite.cost", "none", "max_intersections", 9.0 ) );
    assert_true( is_refused( "suite.cost", "exact, margin=4", "max_intersections", 1.0 ) );
    assert_false( is_refused( "suite.cost", "triangles", "max_intersections", 1.0 ) );
    assert_true( is_refused( "suite.motion", "its pace, 0.54 m/s", "max_intersections", 1.0 ) );
    assert_false( is_refused( "suite.motion", "no contact, 0.54 m/s", "max_intersections", 1.0 ) );
    assert_true( is_refused( "suite.pair", "exact, margin=2", "max_overlap_mm", 1.6 ) );
    assert_false( is_refused( "suite.pair", "spheres", "max_overlap_mm", 1.6 ) );
    assert_true( is_refused( "suite.stack", "none", "halted_at_step", 7.0 ) );
    assert_true( is_refused( "suite.stack", "exact, margin=2", "net_impulse_N_s", 1e-6 ) );
}

// ---- measures ----

#define RADIUS 0.15
#define THICKNESS 0.006 // m

// Two balloons whose centres are this far apart, m.
static suite_overlap overlap_at( double distance )
{
    char text[600];
    snprintf( text, sizeof text,
              "wisp: 1\nsurfaces:\n"
              "  - name: one\n    generate: { shape: icosphere, level: 3, radius: 0.15 }\n    balloon: {}\n"
              "    contact: { thickness: 0.006 }\n"
              "  - name: other\n    instance_of: one\n    transform: { translate: [%.9g, 0, 0] }\n    balloon: {}\n"
              "    contact: { thickness: 0.006 }\n",
              distance );
    const scene_world_options options = { .workers = 1, .is_quiet = true };
    wisp_scene scene;
    scene_world world;
    suite_overlap found;
    wisp_error error = { 0 };
    assert_ok( wisp_scene_parse( text, strlen( text ), "balloons", &scene, &error ), error );
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    assert_ok( suite_overlap_find( &world, &found, &error ), error );
    scene_world_destroy( &world );
    wisp_scene_release( &scene );
    return found;
}

TEST( overlap_is_how_deep_a_vertex_is_in_the_other_balloon )
{
    // facets of a level 3 sphere are up to 0.6 % of the radius below it: the depth of a vertex may be smaller by that
    const double facet = 0.006 * RADIUS, expected = 0.4 * RADIUS + THICKNESS;
    const suite_overlap deep = overlap_at( 1.6 * RADIUS );
    assert_true( deep.depth <= expected + 1e-6 && deep.depth > expected - 2.0 * facet );
    assert_true( deep.missed > 0.0 && deep.missed < 0.5 );
    const suite_overlap near = overlap_at( 2.0 * RADIUS + 0.5 * THICKNESS );
    assert_true( near.depth <= 0.5 * THICKNESS + 1e-6 && near.depth > 0.5 * THICKNESS - 2.0 * facet );
    assert_true( near.wall_radius < 0.3 * RADIUS && near.wall_unevenness < 0.1 * RADIUS );
    const suite_overlap apart = overlap_at( 2.0 * RADIUS + 2.0 * THICKNESS );
    assert_true( apart.depth == 0.0 && apart.missed == 0.0 && isnan( apart.wall_radius ) );
}

// Enough steps for the cloth to reach the ball and for the plates to press.
static void run_suite( const char* name, results* all )
{
    char inner[64], path[1024];
    const bench_options brief = { .seconds = 1e-3, .workers = 2 };
    wisp_suite suite;
    wisp_error error = { 0 };
    snprintf( inner, sizeof inner, "suites/contact/%s.yaml", name );
    program_data_path( inner, path, sizeof path );
    assert_ok( suite_read( path, &suite, &error ), error );
    for ( int i = 0; i < suite.row_count; ++i )
    {
        suite.rows[i].steps = 45;
    }
    assert_ok( suite_bench_rows( &suite, &brief, all, &error ), error );
    suite_release( &suite );
}

static int make_results( void** state )
{
    static results all;
    run_suite( "cost", &all );
    run_suite( "motion", &all );
    run_suite( "pair", &all );
    contact_check_suites( 0, &all );
    *state = &all;
    return 0;
}

TEST_GROUP( make_results, free_results )
