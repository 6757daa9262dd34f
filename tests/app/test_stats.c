// Order statistics, straight lines, and the profile over many steps.
#include "unit.h"

#include "stats.h"

TEST( the_median_of_an_odd_count_is_the_middle_one )
{
    double samples[] = { 9.0, 1.0, 5.0, 700.0, 3.0 };
    stats_summary s = stats_summarise( samples, 5 );
    assert_int_equal( s.count, 5 );
    assert_true( s.median == 5.0 );
    assert_true( s.minimum == 1.0 );
    assert_true( s.maximum >= s.p90 && s.mean > s.minimum && s.mean < s.maximum );
}

TEST( the_median_of_an_even_count_lies_between_the_middle_two )
{
    double samples[] = { 4.0, 1.0, 2.0, 8.0 };
    assert_true( stats_summarise( samples, 4 ).median == 3.0 );
}

TEST( percentiles_interpolate_between_neighbours )
{
    double samples[12];
    for ( int i = 0; i < 12; ++i )
    {
        samples[i] = 11 - i;
    }
    // 0 .. 11: the tenth percentile is at position 1.1, the ninetieth at 9.9; one rounding of the position remains
    stats_summary s = stats_summarise( samples, 12 );
    assert_float_equal( s.p10, 1.1, 4 * DBL_EPSILON * 11 );
    assert_float_equal( s.p90, 9.9, 4 * DBL_EPSILON * 11 );
    assert_true( stats_quantile( samples, 12, 0.0 ) == 0.0 );
    assert_true( stats_quantile( samples, 12, 1.0 ) == 11.0 );
}

TEST( one_sample_is_its_own_median_and_percentiles )
{
    double sample = 2.5;
    stats_summary s = stats_summarise( &sample, 1 );
    assert_true( s.median == 2.5 && s.p10 == 2.5 && s.p90 == 2.5 && s.minimum == 2.5 );
    assert_true( s.maximum == 2.5 && s.mean == 2.5 );
}

TEST( no_samples_have_no_median )
{
    stats_summary s = stats_summarise( NULL, 0 );
    assert_true( isnan( s.median ) && isnan( s.p10 ) && isnan( s.p90 ) && isnan( s.minimum ) );
}

TEST( points_on_a_line_give_the_line )
{
    double x[] = { 0.0, 1.0, 2.0, 3.0 }, y[] = { 0.5, 2.5, 4.5, 6.5 };
    stats_line line = stats_fit_line( x, y, 4 );
    // all sums are exact here
    assert_true( line.intercept == 0.5 && line.slope == 2.0 && line.r_squared == 1.0 );
}

TEST( the_source_table_gives_the_line_that_it_is_known_for )
{
    double thousands[] = { 2.0, 6.0, 10.0 }, ms[] = { 6.8, 16.5, 28.7 };
    stats_line line = stats_fit_line( thousands, ms, 3 );
    // stated to two decimals: 0.91 ms + 2.74 ms per 1000 vertices
    assert_float_equal( line.intercept, 0.91, 0.005 );
    assert_float_equal( line.slope, 2.74, 0.005 );
    assert_true( line.r_squared > 0.99 && line.r_squared < 1.0 );
}

TEST( noise_without_a_trend_is_not_explained )
{
    double x[] = { 0.0, 1.0, 2.0, 3.0 }, y[] = { 1.0, -1.0, -1.0, 1.0 };
    stats_line line = stats_fit_line( x, y, 4 );
    assert_true( line.slope == 0.0 && line.r_squared == 0.0 );
}

TEST( a_line_far_from_the_origin_keeps_its_digits )
{
    double x[] = { 1e9, 1e9 + 1.0, 1e9 + 2.0 }, y[] = { 3.0, 4.0, 5.0 };
    stats_line line = stats_fit_line( x, y, 3 );
    // the mean of x has an error of a few of its last places, 1.2e-7 each; the slope depends on their square
    assert_float_equal( line.slope, 1.0, 1e-6 );
    assert_float_equal( line.r_squared, 1.0, 1e-6 );
}

TEST( a_single_x_has_no_line )
{
    double x[] = { 2.0, 2.0 }, y[] = { 1.0, 3.0 };
    stats_line line = stats_fit_line( x, y, 2 );
    assert_true( isnan( line.slope ) && isnan( line.intercept ) && isnan( line.r_squared ) );
    assert_true( isnan( stats_fit_line( x, y, 0 ).slope ) );
}

TEST( passes_keep_their_own_samples_when_the_plan_changes )
{
    profile_samples samples = { 0 };
    const wisp_profile_line both[] = { { "a.first", 1.0, 10 }, { "b.second", 5.0, 20 } };
    const wisp_profile_line second[] = { { "b.second", 7.0, 30 } };
    assert_int_equal( profile_samples_add( &samples, ( wisp_profile ){ both, 2, 6.0 } ), WISP_OK );
    assert_int_equal( profile_samples_add( &samples, ( wisp_profile ){ second, 1, 7.0 } ), WISP_OK );

    assert_int_equal( samples.pass_count, 2 );
    assert_string_equal( samples.passes[1].name, "b.second" );
    assert_int_equal( samples.passes[1].items, 30 );
    assert_true( profile_samples_median( &samples, 0 ) == 1.0 );
    assert_true( profile_samples_median( &samples, 1 ) == 6.0 );
    profile_samples_free( &samples );
    assert_int_equal( samples.pass_count, 0 );
}

TEST( a_test_of_ranks_has_the_p_value_of_its_formula )
{
    // U = 8, by ranks; its variance is 64 / 12 (17 - 24 / 240) with four ties of two
    const double a[] = { 1, 2, 3, 4, 5, 6, 7, 8 }, b[] = { 5, 6, 7, 8, 9, 10, 11, 12 };
    assert_float_equal( stats_rank_sum( a, 8, b, 8 ), 0.013313003, 1e-6 );
    assert_float_equal( stats_rank_sum( b, 8, a, 8 ), 0.013313003, 1e-6 );
    assert_true( stats_rank_sum( a, 8, a, 8 ) == 1.0 );
    assert_true( stats_rank_sum( a, 3, b, 3 ) == 1.0 );
    const double equal[] = { 2, 2, 2, 2, 2 };
    assert_true( stats_rank_sum( equal, 5, equal, 5 ) == 1.0 );
}

TEST( tests_share_their_level )
{
    // against 0.05 / 4, / 3, / 2, / 1: the third fails, so the fourth is not asked
    const double p[] = { 0.045, 0.012, NAN, 0.016, 0.03 };
    bool is_rejected[5];
    stats_holm( p, 5, 4, 0.05, is_rejected );
    assert_true( is_rejected[1] && is_rejected[3] );
    assert_false( is_rejected[0] || is_rejected[2] || is_rejected[4] );
    stats_holm( p, 5, 5, 0.05, is_rejected ); // a level over five tests rejects none
    assert_false( is_rejected[1] );
}
