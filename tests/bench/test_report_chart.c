// Charts of the report: points are at the positions given by the ticks of their axes, and values without a position
// are left out and counted.
#include "report_fixture.h"

#include "report_axis.h"
#include "report_chart.h"
#include "report_drawing.h"

// coordinates have two digits
#define ROUNDED 0.0101

// ---- results ----

static int add_points( results* all, const drawn_point* points, int count )
{
    int chart = results_add_chart( all, "A chart", "strands", "ms" );
    int series = results_add_series( all, chart, "ours", true );
    for ( int i = 0; i < count; ++i )
    {
        results_add_point( all, chart, series, ( results_point ){ .x = points[i].x, .y = points[i].y } );
    }
    return chart;
}

static char* page_of_points( const drawn_point* points, int count, bool x_log, bool y_log )
{
    results all = empty_results();
    results_chart* chart = results_chart_at( &all, add_points( &all, points, count ) );
    chart->x_log = x_log;
    chart->y_log = y_log;
    char* page = page_of( &all, &quiet_run );
    assert_well_formed( page );
    results_free( &all );
    return page;
}

// ---- places ----

TEST( points_of_linear_axes_stand_between_their_ticks )
{
    const drawn_point points[] = { { -4.0, 0.01 }, { 2.5, 0.0375 }, { 10.0, 0.05 } };
    char* page = page_of_points( points, 3, false, false );
    double left = tick_at( page, 'x', "0" ), right = tick_at( page, 'x', "10" );
    double bottom = tick_at( page, 'y', "0.01" ), top = tick_at( page, 'y', "0.05" );
    assert_true( right > left + 100.0 && bottom > top + 100.0 );
    for ( int i = 0; i < 3; ++i )
    {
        drawn_point p = point_at( page, i );
        assert_near( p.x, left + ( right - left ) * points[i].x / 10.0, 2 * ROUNDED );
        assert_near( p.y, bottom + ( top - bottom ) * ( points[i].y - 0.01 ) / 0.04, 2 * ROUNDED );
    }
    free( page );
}

TEST( points_of_logarithmic_axes_stand_between_their_ticks )
{
    const drawn_point points[] = { { 100.0, 0.02 }, { 3000.0, 1.0 }, { 50000.0, 314.0 } };
    char* page = page_of_points( points, 3, true, true );
    double left = tick_at( page, 'x', "100" ), right = tick_at( page, 'x',
                                                                "10\xe2\x80\x89"
                                                                "000" );
    double bottom = tick_at( page, 'y', "0.1" ), top = tick_at( page, 'y', "100" );
    for ( int i = 0; i < 3; ++i )
    {
        drawn_point p = point_at( page, i );
        assert_near( p.x, left + ( right - left ) * log10( points[i].x / 100.0 ) / 2.0, 2 * ROUNDED );
        assert_near( p.y, bottom + ( top - bottom ) * log10( points[i].y / 0.1 ) / 3.0, 2 * ROUNDED );
    }
    free( page );
}

TEST( a_line_goes_through_its_points )
{
    const drawn_point points[] = { { 1.0, 3.0 }, { 2.0, 5.0 }, { 3.0, 4.0 } };
    char* page = page_of_points( points, 3, false, false );
    const char* line = strstr( plot_of( page ), "<path class=\"line" );
    assert_non_null( line );
    const char* at = strstr( line, " d=\"" ) + 4;
    for ( int i = 0; i < 3; ++i )
    {
        drawn_point p = point_at( page, i );
        char* end = NULL;
        assert_int_equal( *at, i == 0 ? 'M' : 'L' );
        assert_near( strtod( at + 1, &end ), p.x, 1e-9 );
        assert_near( strtod( end, &end ), p.y, 1e-9 );
        at = end;
    }
    assert_int_equal( *at, '"' );
    free( page );
}

TEST( what_has_no_place_is_left_out_counted_and_not_bridged )
{
    const drawn_point points[] = { { 1.0, 1.0 }, { 2.0, NAN }, { 3.0, 2.0 },
                                   { 4.0, 0.0 }, { 5.0, 3.0 }, { INFINITY, 1.0 } };
    char* page = page_of_points( points, 6, false, true );
    assert_int_equal( point_count( page ), 3 );
    assert_non_null( strstr( page, "3 points have no place" ) );
    const char* line = strstr( plot_of( page ), "<path class=\"line" );
    const char* end = strstr( line, "/>" );
    int begins = 0;
    for ( const char* at = strstr( line, " d=\"" ); at < end; ++at )
    {
        begins += *at == 'M';
    }
    assert_int_equal( begins, 3 );
    assert_null( strstr( plot_of( page ), "nan" ) );
    assert_null( strstr( plot_of( page ), "inf" ) );
    free( page );

    // a linear axis can show 0
    page = page_of_points( points, 6, false, false );
    assert_int_equal( point_count( page ), 4 );
    free( page );
}

TEST( charts_of_nothing_say_so )
{
    const drawn_point none[] = { { NAN, 1.0 }, { 1.0, -INFINITY } };
    for ( int count = 0; count <= 2; count += 2 )
    {
        char* page = page_of_points( none, count, false, false );
        assert_non_null( strstr( page, "There is nothing to draw." ) );
        assert_null( strstr( page, "class=\"plot\"" ) );
        free( page );
    }
    results all = empty_results();
    results_chart_at( &all, results_add_chart( &all, "bars", "", "" ) )->is_bars = true;
    results_add_chart( &all, "no series", "", "" );
    char* page = page_of( &all, &quiet_run );
    assert_well_formed( page );
    assert_int_equal( count_of( page, "There is nothing to draw." ), 2 );
    free( page );
    results_free( &all );
}

TEST( one_point_of_any_size_stands_inside )
{
    static const double values[] = { 0.0, 1.0, -1.0, 7.3, 1e-12, -3e-99, 1e99, 123456.789, 5e-324, 1e-100 };
    for ( int i = 0; i < WISP_COUNT( values ); ++i )
    {
        for ( int is_log = 0; is_log < 2; ++is_log )
        {
            const drawn_point point = { values[i], values[i] };
            if ( !report_axis_takes( is_log, values[i] ) )
            {
                continue;
            }
            char* page = page_of_points( &point, 1, is_log, is_log );
            drawn_point p = point_at( page, 0 );
            assert_true( p.x >= REPORT_CHART_LEFT && p.x <= REPORT_CHART_WIDTH - REPORT_CHART_RIGHT );
            assert_true( p.y >= REPORT_CHART_TOP && p.y <= REPORT_CHART_HEIGHT - REPORT_CHART_BOTTOM );
            free( page );
        }
    }
}

// ---- axes ----

// 1, 2 or 5 times a power of ten, up to rounding.
static bool is_round( double value )
{
    double fraction = value / pow( 10.0, floor( log10( value ) + 1e-9 ) );
    return fabs( fraction - 1.0 ) < 1e-6 || fabs( fraction - 2.0 ) < 1e-6 || fabs( fraction - 5.0 ) < 1e-6;
}

static int label_count( const report_axis* axis )
{
    int count = 0;
    for ( int i = 0; i < axis->tick_count; ++i )
    {
        count += axis->ticks[i].label[0] != '\0';
    }
    return count;
}

TEST( linear_ticks_are_round_few_and_hold_all_values )
{
    static const double ends[][2] = { { 0.0, 1.0 },        { 0.3, 0.7 },      { -5.0, 17.0 },
                                      { 1e-9, 7e-9 },      { 990.0, 1000.0 }, { -3e7, -1e7 },
                                      { 0.1, 0.30000001 }, { -1e100, 1e100 }, { 1.0, 1.0000001 } };
    for ( int i = 0; i < WISP_COUNT( ends ); ++i )
    {
        report_axis axis = report_axis_make( ends[i][0], ends[i][1], false );
        double step = axis.ticks[1].value - axis.ticks[0].value;
        double slack = 1e-6 * step;
        assert_true( axis.lower <= ends[i][0] + slack && axis.upper >= ends[i][1] - slack );
        assert_true( axis.tick_count >= 3 && axis.tick_count <= 8 );
        assert_true( is_round( step ) );
        for ( int t = 0; t < axis.tick_count; ++t )
        {
            assert_near( axis.ticks[t].value, axis.lower + t * step, slack );
            assert_true( axis.ticks[t].label[0] != '\0' );
        }
        assert_true( axis.ticks[axis.tick_count - 1].value == axis.upper );
    }
}

TEST( logarithmic_ticks_are_few_rise_and_hold_all_values )
{
    static const double ends[][2] = { { 1.0, 10.0 },      { 0.3, 0.7 },      { 2.1, 2.9 },
                                      { 1e-9, 7e-3 },     { 990.0, 1000.0 }, { 1e-100, 1e100 },
                                      { 100.0, 50000.0 }, { 1e-4, 1e6 },     { 0.001, 0.0010001 } };
    for ( int i = 0; i < WISP_COUNT( ends ); ++i )
    {
        report_axis axis = report_axis_make( ends[i][0], ends[i][1], true );
        assert_true( axis.lower <= ends[i][0] * ( 1.0 + 1e-8 ) && axis.upper >= ends[i][1] * ( 1.0 - 1e-8 ) );
        assert_true( axis.lower > 0.1 * ends[i][0] && axis.upper < 10.0 * ends[i][1] );
        assert_true( is_round( axis.lower ) && is_round( axis.upper ) );
        assert_true( label_count( &axis ) >= 2 && label_count( &axis ) <= 10 );
        for ( int t = 1; t < axis.tick_count; ++t )
        {
            assert_true( axis.ticks[t].value > axis.ticks[t - 1].value );
        }
    }
}

TEST( ticks_are_written_exactly )
{
    report_axis axis = report_axis_make( 0.0, 0.3, false );
    assert_string_equal( axis.ticks[1].label, "0.1" );
    assert_string_equal( axis.ticks[3].label, "0.3" );
    axis = report_axis_make( -200000.0, 0.0, false );
    assert_string_equal( axis.ticks[0].label, "\xe2\x88\x92"
                                              "200\xe2\x80\x89"
                                              "000" );
    axis = report_axis_make( 1e-9, 1e-3, true );
    assert_string_equal( axis.ticks[0].label, "10\xe2\x81\xbb\xe2\x81\xb9" );
    axis = report_axis_make( -1.5e-8, 1e-8, false );
    assert_string_equal( axis.ticks[0].label, "\xe2\x88\x92"
                                              "1.5\xc2\xb7"
                                              "10\xe2\x81\xbb\xe2\x81\xb8" );
    assert_string_equal( axis.ticks[1].label, "\xe2\x88\x92"
                                              "10\xe2\x81\xbb\xe2\x81\xb8" );
    axis = report_axis_make( 0.0, 3e12, false );
    assert_string_equal( axis.ticks[1].label, "10\xc2\xb9\xc2\xb2" );
    assert_string_equal( axis.ticks[2].label, "2\xc2\xb7"
                                              "10\xc2\xb9\xc2\xb2" );
}

// ---- what stands out ----

TEST( marked_points_have_a_ring_around_them )
{
    results all = empty_results();
    int chart = add_points( &all, ( const drawn_point[] ){ { 1.0, 1.0 }, { 2.0, 3.0 } }, 2 );
    all.charts[chart].series[0].points[1].is_marked = true;
    char* page = page_of( &all, &quiet_run );
    assert_int_equal( count_of( page, "<circle class=\"ring\"" ), 1 );
    const char* ring = strstr( page, "<circle class=\"ring\"" );
    drawn_point p = point_at( page, 1 );
    assert_true( attribute_of( ring, "cx" ) == p.x && attribute_of( ring, "cy" ) == p.y );
    free( page );
    results_free( &all );
}

TEST( a_tooltip_has_name_label_and_both_values_with_their_units )
{
    results all = empty_results();
    int chart = add_points( &all, ( const drawn_point[] ){ { 2000.0, 0.0123456 } }, 1 );
    snprintf( all.charts[chart].series[0].points[0].label, 64, "10 + tethers" );
    char* page = page_of( &all, &quiet_run );
    assert_non_null(
        strstr( page, "<title>ours: 10 + tethers\n2000 \xc2\xb7 strands\n0.01235 \xc2\xb7 ms</title>" ) );
    free( page );
    results_free( &all );
}

TEST( names_beside_points_cover_neither_points_nor_names )
{
    results all = empty_results();
    drawn_point points[40];
    for ( int i = 0; i < WISP_COUNT( points ); ++i )
    {
        points[i] = ( drawn_point ){ ( i * 37 ) % 41, ( i * i * 13 ) % 43 };
    }
    int chart = add_points( &all, points, WISP_COUNT( points ) );
    for ( int i = 0; i < WISP_COUNT( points ); ++i )
    {
        all.charts[chart].series[0].points[i].is_marked = true;
        snprintf( all.charts[chart].series[0].points[i].label, 64, "name %d", i );
    }
    char* page = page_of( &all, &quiet_run );
    double left[40], bottom[40];
    int count = 0;
    for ( const char* at = strstr( page, "<text class=\"label" ); at; at = strstr( at + 1, "<text class=\"label" ) )
    {
        left[count] = attribute_of( at, "x" );
        bottom[count++] = attribute_of( at, "y" );
    }
    assert_true( count >= 3 );
    for ( int i = 0; i < count; ++i )
    {
        // six characters of about 6 units, ten high
        for ( int k = 0; k < WISP_COUNT( points ); ++k )
        {
            drawn_point p = point_at( page, k );
            assert_false( p.x > left[i] && p.x < left[i] + 36.0 && p.y < bottom[i] && p.y > bottom[i] - 10.0 );
        }
        for ( int k = 0; k < i; ++k )
        {
            assert_false( fabs( left[i] - left[k] ) < 36.0 && fabs( bottom[i] - bottom[k] ) < 10.0 );
        }
    }
    free( page );
    results_free( &all );
}

TEST( sixteen_series_differ_in_colour_or_shape )
{
    results all = empty_results();
    int chart = results_add_chart( &all, "many", "x", "y" );
    for ( int s = 0; s < 16; ++s )
    {
        char name[32];
        snprintf( name, sizeof( name ), "series %d", s );
        int series = results_add_series( &all, chart, name, false );
        results_add_point( &all, chart, series, ( results_point ){ .x = s, .y = s } );
    }
    char* page = page_of( &all, &quiet_run );
    char seen[16][40];
    const char* at = plot_of( page );
    for ( int s = 0; s < 16; ++s )
    {
        at = strstr( at + 1, "<g class=\"point " );
        assert_non_null( at );
        const char* marker = strstr( at, "#m" );
        snprintf( seen[s], sizeof( seen[s] ), "%.2s %.3s", at + strlen( "<g class=\"point " ), marker );
        for ( int k = 0; k < s; ++k )
        {
            assert_string_not_equal( seen[s], seen[k] );
        }
    }
    assert_int_equal( count_of( strstr( page, "<ul class=\"key\">" ), "<li><svg class=\"s" ), 16 );
    free( page );
    results_free( &all );
}

// ---- bars ----

static double bar_fraction( const char* page, int number )
{
    const char* at = strstr( page, "<rect class=\"bar\" height" );
    for ( int i = 0; i < number && at; ++i )
    {
        at = strstr( at + 1, "<rect class=\"bar\" height" );
    }
    assert_non_null( at );
    return attribute_of( at, "width" );
}

static char* page_of_bars( const double* values, int count, bool y_log )
{
    results all = empty_results();
    int chart = results_add_chart( &all, "Effects", "effect", "ms" );
    int series = results_add_series( &all, chart, "one", false ),
        other = results_add_series( &all, chart, "two", false );
    results_chart_at( &all, chart )->is_bars = true;
    results_chart_at( &all, chart )->y_log = y_log;
    for ( int i = 0; i < count; ++i )
    {
        results_point point = { .x = i, .y = values[i] };
        snprintf( point.label, sizeof( point.label ), "effect %d", i );
        results_add_point( &all, chart, series, point );
        if ( i == 0 )
        {
            results_add_point( &all, chart, other, point );
        }
    }
    char* page = page_of( &all, &quiet_run );
    assert_well_formed( page );
    results_free( &all );
    return page;
}

TEST( bars_are_as_long_as_their_values )
{
    char* page = page_of_bars( ( const double[] ){ 2.0, 8.0, NAN, 0.5 }, 4, false );
    assert_near( bar_fraction( page, 0 ), 25.0, ROUNDED );
    assert_near( bar_fraction( page, 1 ), 25.0, ROUNDED ); // of the other series
    assert_near( bar_fraction( page, 2 ), 100.0, ROUNDED );
    assert_near( bar_fraction( page, 3 ), 6.25, ROUNDED );
    // unknown values have a line and no bar
    assert_non_null( strstr( page, ">effect 2</th><td class=\"bar\"></td><td class=\"n\">-</td>" ) );
    assert_non_null( strstr( page, "rowspan=\"2\">effect 0</th>" ) );
    free( page );

    page = page_of_bars( ( const double[] ){ -1.0, 3.0 }, 2, false );
    assert_near( bar_fraction( page, 0 ), 25.0, ROUNDED );
    assert_near( bar_fraction( page, 2 ), 75.0, ROUNDED );
    free( page );
}

TEST( logarithmic_bars_begin_a_decade_below_the_smallest )
{
    char* page = page_of_bars( ( const double[] ){ 1.0, 1000.0, 10.0 }, 3, true );
    assert_near( bar_fraction( page, 0 ), 25.0, ROUNDED );
    assert_near( bar_fraction( page, 2 ), 100.0, ROUNDED );
    assert_near( bar_fraction( page, 3 ), 50.0, ROUNDED );
    free( page );
}
