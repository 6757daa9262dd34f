// The theory of `wisp validate`, and what its bodies make of it.
#include "unit.h"

#include "validate/validate_bodies.h"
#include "oracle/slender_theory.h"
#include "validate/validate.h"

#include <math.h>

TEST( critical_loads_are_those_of_the_literature )
{
    // Greenhill: 9/4 of the square of the first zero of the Bessel function J_(-1/3), 1.866350859
    assert_true( fabs( slender_column_load() - 2.25 * 1.866350859 * 1.866350859 ) < 1e-6 );
    // Timoshenko and Gere, Theory of Elastic Stability, section 6.3: 12.85
    assert_true( fabs( slender_blade_load() - 12.85 ) < 0.01 );
}

TEST( the_elastica_has_the_numbers_of_the_closed_form )
{
    // G, drop and reach of the length, by another integration in double
    static const double known[][3] = { { 1.0, 0.12347140, 0.99124640 },
                                       { 10.0, 0.70019972, 0.65635376 },
                                       { 100.0, 0.93752394, 0.15922338 } };
    for ( int i = 0; i < 3; ++i )
    {
        double points[5][2];
        elastica_lay( known[i][0], 5, points );
        assert_true( fabs( -points[4][1] - known[i][1] ) < 1e-6 );
        assert_true( fabs( points[4][0] - known[i][2] ) < 1e-6 );
        assert_true( points[0][0] == 0.0 && points[0][1] == 0.0 );
    }
}

// Tips at rest, by each solver, in lengths from theory. 16 cells leave 0.35 % at G = 10.
TEST( every_solver_bends_a_cantilever_to_the_elastica )
{
    const double load = 10.0;
    double exact[2][2];
    elastica_lay( load, 2, exact );
    for ( int solver = 0; solver < VALIDATE_SOLVER_COUNT; ++solver )
    {
        const validate_def def = {
            .solver = (validate_solver)solver,
            .cells = 16,
            .substeps = 16,
            .workers = 1,
            .count = 1,
            .loads = &load,
            .gravity = { 0.0f, -9.81f, 0.0f },
            .damping = 20.0,
        };
        validate_bodies bodies;
        accuracy_run out = { .ms = NULL };
        wisp_vec3 tip;
        assert_int_equal( validate_create( &def, &bodies, NULL ), WISP_OK );
        assert_int_equal( validate_step( &bodies, 200, &out, NULL ), WISP_OK );
        assert_int_equal( validate_tip( &bodies, 0, &tip, NULL ), WISP_OK );
        const double x = (double)tip.x / VALIDATE_LENGTH - exact[1][0],
                     y = (double)tip.y / VALIDATE_LENGTH - exact[1][1];
        assert_true( hypot( x, y ) < 0.006 );
        validate_release( &bodies );
        free( out.ms );
    }
}

// Three percent below the critical load a column swings back, three percent above it goes on.
TEST( a_column_stands_below_its_load_and_falls_above )
{
    const double loads[] = { 0.97 * slender_column_load(), 1.03 * slender_column_load() };
    const validate_def def = {
        .solver = VALIDATE_ROD,
        .cells = 16,
        .substeps = 8,
        .workers = 1,
        .count = 2,
        .loads = loads,
        .gravity = { -9.81f, 0.0f, 0.0f },
        .damping = 5.0,
        .lateral = 0.005,
    };
    validate_bodies bodies;
    accuracy_run out = { .ms = NULL };
    assert_int_equal( validate_create( &def, &bodies, NULL ), WISP_OK );
    assert_int_equal( validate_step( &bodies, 400, &out, NULL ), WISP_OK );
    wisp_vec3 tips[2];
    assert_int_equal( validate_tip( &bodies, 0, tips, NULL ), WISP_OK );
    assert_int_equal( validate_tip( &bodies, 1, tips + 1, NULL ), WISP_OK );
    assert_true( fabs( (double)tips[0].y ) < validate_start( &def ) );
    assert_true( fabs( (double)tips[1].y ) > 2.0 * validate_start( &def ) );
    validate_release( &bodies );
    free( out.ms );
}

static void put_row( results* all, const char* variant, double error, double other, double ms )
{
    results_row* row = results_add_row( all, "accuracy.x", variant );
    assert_non_null( row );
    row->ms_median = ms;
    if ( isfinite( error ) )
    {
        results_put( &row->error, "error", error );
    }
    results_put( &row->error, "other", other );
}

// Of a solver with several settings the least error counts, and one without an error is no error of 0.
TEST( an_overview_has_the_least_and_the_largest_error_of_each_solver )
{
    results all = { .failed = false };
    char summary[400];
    const int table = validate_begin_overview( &all );
    put_row( &all, "rod, 4 cells", 9.0, 0.1, 1.0 );
    put_row( &all, "rod, 8 cells", 2.0, 0.1, 3.0 );
    put_row( &all, "rod, 16 cells", NAN, 0.1, 5.0 );
    put_row( &all, "cloth, 4 cells", 50.0, 0.1, 7.0 );
    put_row( &all, "hair, 4 cells", NAN, 0.1, 7.0 );
    validate_add_to_overview( table, "x", 0, &all );
    validate_end_overview( table, &all, summary, sizeof summary );
    const char* const expected[3][6] = {
        { "x", "rod", "2", "9; 1 of 3 without", "3", "rod, 8 cells" },
        { "x", "cloth", "50", "50", "7", "cloth, 4 cells" },
        { "x", "hair", "-", "-; 1 of 1 without", "-", "-" },
    };
    assert_int_equal( all.tables[table].row_count, 4 );
    for ( int i = 0; i < 18; ++i )
    {
        assert_string_equal( results_cell( all.tables + table, 1 + i / 6, i % 6 ), expected[i / 6][i % 6] );
    }
    assert_non_null( strstr( summary, "1 of 3 lines" ) );
    assert_non_null( strstr( summary, "not `x` by cloth (50), `x` by hair (-)." ) );
    results_free( &all );
}

TEST( each_case_says_what_it_tests_and_where_its_answer_is_from )
{
    int count;
    const validate_case* cases = validate_cases( &count );
    assert_true( count >= 6 && count <= 64 );
    for ( int i = 0; i < count; ++i )
    {
        const char* const texts[] = { cases[i].name,     cases[i].title,   cases[i].tests,
                                      cases[i].left_out, cases[i].formula, cases[i].source };
        for ( int k = 0; k < WISP_COUNT( texts ); ++k )
        {
            assert_true( texts[k] != NULL && texts[k][0] != '\0' );
        }
    }
}
