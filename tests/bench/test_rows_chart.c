// Charts of rows: they show the values of the rows, and the front consists of undominated ones.
#include "unit.h"

#include "bench_output.h"

static void add_row( results* all, const char* name, const char* variant, int workers, double vertices, double ms )
{
    results_row* row = results_add_row( all, name, variant );
    results_put( &row->size, "vertices", vertices );
    row->workers = workers;
    row->ms_median = ms;
    row->steps = 5;
}

TEST( rows_become_a_series_for_each_variant_and_worker_count )
{
    results all = { .failed = false };
    add_row( &all, "race", "old", 1, 1.0, 1.0 ); // before the first
    for ( int i = 1; i <= 2; ++i )
    {
        add_row( &all, "race", "plain", 1, i, 4.0 * i );
        add_row( &all, "race", "ours", 1, i, 2.0 * i );
        add_row( &all, "race", "ours", 2, i, i );
        add_row( &all, "other", "ours", 2, i, i );
    }
    rows_chart chart = { .first_row = 1, .name = "race", .title = "t", .x = rows_vertices, .y = rows_ms };
    rows_chart_add( &chart, &all );
    assert_int_equal( all.chart_count, 1 );
    assert_true( all.charts[0].x_log && all.charts[0].y_log );
    assert_int_equal( all.charts[0].series_count, 3 );
    const results_series* series = all.charts[0].series;
    assert_string_equal( series[0].name, "plain, 1 worker" );
    assert_string_equal( series[2].name, "ours, 2 workers" );
    assert_int_equal( series[2].count, 2 );
    assert_true( series[1].points[1].x == 2.0 && series[1].points[1].y == 4.0 );

    chart.workers = 1;
    rows_chart_add( &chart, &all );
    assert_int_equal( all.charts[1].series_count, 2 );
    assert_string_equal( all.charts[1].series[1].name, "ours" );
    assert_int_equal( all.charts[1].series[1].count, 2 );
    results_free( &all );
}

static double error_of( const results_row* row )
{
    return rows_error( row, "miss" );
}

TEST( the_front_is_what_nothing_beats )
{
    static const struct
    {
        double ms, miss;
        bool is_front;
    } ways[] = { { 1.0, 9.0, true }, { 2.0, 5.0, true },  { 3.0, 5.0, false }, { 2.0, 7.0, false },
                 { 8.0, 1.0, true }, { NAN, 0.0, false }, { 9.0, 9.0, false } };
    results all = { .failed = false };
    for ( int i = 0; i < WISP_COUNT( ways ); ++i )
    {
        char name[32];
        snprintf( name, sizeof( name ), "way %d", i );
        add_row( &all, "race", name, 2, 1.0, ways[i].ms );
        results_put( &all.rows[i].error, "miss", ways[i].miss );
    }
    add_row( &all, "race", "late", 2, 1.0, 0.5 );
    results_put( &all.rows[all.row_count - 1].error, "miss", 0.1 );
    all.rows[all.row_count - 1].steps = 4; // so it is not one of them
    rows_chart_add(
        &( rows_chart ){
            .name = "race", .title = "t", .min_steps = 5, .x = rows_ms, .y = error_of, .is_front = true },
        &all );
    assert_int_equal( all.charts[0].series_count, 1 );
    const results_series* series = &all.charts[0].series[0];
    assert_string_equal( series->name, "2 workers" );
    for ( int i = 0; i < WISP_COUNT( ways ); ++i )
    {
        assert_int_equal( series->points[i].is_marked, ways[i].is_front );
        assert_string_equal( series->points[i].label, all.rows[i].variant );
    }
    results_free( &all );
}
