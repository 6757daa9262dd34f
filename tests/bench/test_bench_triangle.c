// Table 1 of the triangle cloth at very small sizes: its tables and rows, and failures of the run after an error.
#include "bench_tables.h"

#include "paper_triangle.h"

static const bench_options quick = { .quick = true, .workers = 2 };

static triangle_plan small_plan( void )
{
    return ( triangle_plan ){
        .drops = { { 300, 200.0f, 1014.0, 24 }, { 0, 200.0f, 516.0, 24 } },
        .drop_count = 2,
        .workers = { 1, 2 },
        .worker_count = 2,
        .options = &quick,
    };
}

TEST( every_cloth_that_is_timed_has_a_line_with_a_hash )
{
    const results* all = *state;
    expect_good( all );
    assert_fits_terminal( all );
    const results_table* table = find_table( all, "Triangle cloth, Noh and Jung, Table 1" );
    assert_int_equal( table->row_count, 1 + 2 );
    assert_string_equal( cell( table, 1, 0 ), "triangles" );
    assert_string_equal( cell( table, 1, 5 ), "1.014" );
    assert_string_equal( cell( table, 2, 1 ), "625" );
    // 2400 first and 2160 second neighbours of 25 x 25
    assert_string_equal( cell( table, 2, 2 ), "4560" );
    assert_string_equal( cell( table, 2, 5 ), "0.516" );
    assert_string_equal( cell( table, 1, table->column_count - 2 ), "0 / 0" );
    assert_int_equal( strlen( cell( table, 1, table->column_count - 1 ) ), 16 );
}

TEST( triangles_stand_beside_quads_with_the_source )
{
    const results_table* table = find_table( *state, "Triangles / quads" );
    assert_int_equal( table->row_count, 1 + 2 ); // one per worker count
    assert_string_equal( cell( table, 2, 1 ), "2" );
}

TEST( rows_for_machines_are_there_for_every_worker_count )
{
    const results* all = *state;
    assert_int_equal( count_rows( all, "paper.triangle_cloth", "source" ), 2 );
    assert_int_equal( count_rows( all, "paper.triangle_cloth", "quads" ), 2 );
    assert_int_equal( count_rows( all, "paper.triangle_cloth", "triangles" ), 2 );
}

TEST( the_sizes_of_the_case_are_those_of_the_source_and_beyond )
{
    bench_options options = quick;
    options.seconds = 40.0;
    const triangle_plan full = triangle_default_plan( &options );
    options.seconds = 8.0;
    const triangle_plan fast = triangle_default_plan( &options );
    assert_int_equal( full.drops[0].vertices, 958 );
    assert_int_equal( full.drops[1].vertices, 0 );
    assert_int_equal( full.drops[full.drop_count - 1].vertices, 100000 );
    assert_int_equal( fast.drop_count, full.drop_count - 1 );
}

static int make_results( void** state )
{
    static results all;
    const triangle_plan plan = small_plan();
    wisp_error error = { 0 };
    assert_ok( paper_triangle_run( &plan, &all, &error ), error );
    *state = &all;
    return 0;
}

TEST_GROUP( make_results, free_results )
