// Statistics of results. Order statistics, straight lines, and the profile over many steps; what the gate says of a row
// beside its base, and of times in pairs; fine curvature against ripples in closed form.
#include "unit.h"

#include "gate_check.h"
#include "gate_paired.h"
#include "stats.h"
#include "suite_compare.h"

// ---- order statistics ----

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

// ---- the gate: times in pairs ----

TEST( the_exact_test_counts_sign_patterns )
{
    const double all[] = { 1.0, 2.0, 3.0, 4.0 };
    assert_true( gate_sign_flip( all, 4 ) == 1.0 / 16.0 ); // only one pattern has as large a sum
    const double mixed[] = { 1.0, -1.0 };
    assert_true( gate_sign_flip( mixed, 2 ) == 3.0 / 4.0 ); // +2, 0 and 0 of four
    const double below[] = { -1.0, -2.0, -3.0 };
    assert_true( gate_sign_flip( below, 3 ) == 1.0 );
}

// Under no difference a p of at most q comes up in at most q of all cases.
TEST( the_exact_test_holds_its_level )
{
    enum
    {
        TRIALS = 4000,
        COUNT = 10,
    };
    int alarms = 0;
    uint64_t random = 1;
    for ( int t = 0; t < TRIALS; ++t )
    {
        double values[COUNT];
        for ( int i = 0; i < COUNT; ++i )
        {
            random = random * 6364136223846793005u + 1442695040888963407u;
            const double u = (double)( random >> 11 ) / 9007199254740992.0 - 0.5;
            values[i] = u * fabs( u ); // symmetric, with long tails
        }
        alarms += gate_sign_flip( values, COUNT ) <= 0.05 ? 1 : 0;
    }
    assert_true( alarms > TRIALS * 0.03 && alarms < TRIALS * 0.065 );
}

// ---- the gate: rows ----

// A measurement of 1000 instructions and more in one of three passes.
static suite_measurement measured( double more )
{
    suite_measurement m = { .hash = 1, .steps = 10, .pass_count = 3 };
    m.values[SUITE_INSTRUCTIONS] = 1000.0 + more;
    m.passes[0] = ( suite_pass ){ .name = "cloth.air", .instructions = 400.0 };
    m.passes[1] = ( suite_pass ){ .name = "cloth.bending", .instructions = 500.0 + more };
    m.passes[2] = ( suite_pass ){ .name = "links.xpbd", .instructions = 100.0 };
    return m;
}

static gate_row_check check( double more, bool compares_counts )
{
    suite_row row = { .name = "flag" };
    row.budgets[SUITE_INSTRUCTIONS].relative = 0.005;
    static gate_base_row base_row;
    base_row = ( gate_base_row ){ .name = "flag", .measured = measured( 0.0 ) };
    const gate_base base = { .rows = &base_row, .row_count = 1 };
    const suite_measurement now = measured( more );
    gate_row_check out;
    gate_check_row( &row, &base, compares_counts, &now, &out );
    return out;
}

TEST( the_pass_that_grew_is_named )
{
    const gate_row_check out = check( 50.0, true );
    assert_int_equal( out.state, GATE_WORSE );
    assert_non_null( strstr( out.message, "cloth.bending +10.00 %" ) );
    assert_null( strstr( out.message, "cloth.air" ) );
}

TEST( growth_within_the_budget_passes )
{
    assert_int_equal( check( 4.0, true ).state, GATE_SAME );
    assert_int_equal( check( -500.0, true ).state, GATE_SAME );
    assert_int_equal( check( 50.0, false ).state, GATE_SAME ); // of another compiler
}

// An error that is not finite is worse than any.
TEST( errors_have_a_budget )
{
    static const struct
    {
        double now;
        gate_state expected;
    } all[] = { { 1e-3, GATE_SAME }, { 1.04e-3, GATE_SAME },   { 1.06e-3, GATE_WORSE },
                { 1e-4, GATE_SAME }, { INFINITY, GATE_WORSE }, { NAN, GATE_SAME } };
    for ( size_t i = 0; i < WISP_COUNT( all ); ++i )
    {
        suite_row row = { .name = "flag" };
        row.budgets[SUITE_ERROR].relative = 0.05;
        gate_base_row base_row = { .name = "flag", .measured = measured( 0.0 ) };
        base_row.measured.values[SUITE_ERROR] = 1e-3;
        const gate_base base = { .rows = &base_row, .row_count = 1 };
        suite_measurement now = measured( 0.0 );
        now.values[SUITE_ERROR] = all[i].now;
        gate_row_check out;
        gate_check_row( &row, &base, true, &now, &out );
        assert_int_equal( out.state, all[i].expected );
    }
}

// ---- fine curvature ----

enum
{
    SIDE = 17,
};

// A sheet with ripples along x. The normal of its vertices is upright but for the square of the slope.
static void ripple( double height, wisp_vec3* points )
{
    for ( int i = 0; i < SIDE * SIDE; ++i )
    {
        const double x = i % SIDE;
        points[i] = ( wisp_vec3 ){ (float)x, (float)( height * sin( x ) ), (float)( i / SIDE ) };
    }
}

static int make_triangles( int32_t* out )
{
    int count = 0;
    for ( int i = 0; i < SIDE * ( SIDE - 1 ); ++i )
    {
        if ( i % SIDE < SIDE - 1 )
        {
            const int32_t corners[6] = { i, i + SIDE, i + 1, i + 1, i + SIDE, i + SIDE + 1 };
            memcpy( out + 3 * (size_t)count, corners, sizeof corners );
            count += 2;
        }
    }
    return count;
}

TEST( ripples_of_half_the_height_are_half_the_detail )
{
    static wisp_vec3 low[SIDE * SIDE], high[SIDE * SIDE];
    static int32_t triangles[6 * SIDE * SIDE];
    int first[2] = { 0, SIDE * SIDE };
    wisp_record_body body = { .name = "sheet", .triangles = triangles, .vertex_count = SIDE * SIDE };
    body.triangle_count = make_triangles( triangles );
    ripple( 0.005, low );
    ripple( 0.01, high );
    const suite_motion one = { .bodies = &body, .body_count = 1, .first = first, .points = low, .frame_count = 1 };
    const suite_motion other = { .bodies = &body, .body_count = 1, .first = first, .points = high, .frame_count = 1 };
    // the square of the slope is 1e-4
    assert_true( fabs( suite_detail( &one, &other, 0, 1 ) - 0.5 ) < 1e-4 );
    assert_true( fabs( suite_detail( &other, &other, 0, 1 ) - 1.0 ) < 1e-12 );
    ripple( 0.0, low );
    assert_true( suite_detail( &one, &other, 0, 1 ) == 0.0 );
    assert_true( isnan( suite_detail( &other, &one, 0, 1 ) ) );
}

// ---- beyond the horizon ----

enum
{
    FRAMES = 3,
};

TEST( late_means_are_those_of_a_sheet_that_is_larger_and_hangs_lower )
{
    static wisp_vec3 points[2][FRAMES][SIDE * SIDE];
    static int32_t triangles[6 * SIDE * SIDE];
    static const float lower[FRAMES] = { 0.0f, 0.25f, 0.75f };
    int first[2] = { 0, SIDE * SIDE };
    wisp_vec3 energies[2][FRAMES] = { { { 0, 10, 0 }, { 2, 4, 0 }, { 1, 3, 0 } },
                                      { { 0, 10, 0 }, { 2, 3, 0 }, { 0, 3, 0 } } };
    double times[FRAMES] = { 1.0, 2.0, 3.0 };
    wisp_record_body body = { .name = "sheet", .triangles = triangles, .vertex_count = SIDE * SIDE };
    body.triangle_count = make_triangles( triangles );
    suite_motion motions[2];
    for ( int m = 0; m < 2; ++m )
    {
        for ( int f = 0; f < FRAMES; ++f )
        {
            ripple( 0.01, points[m][f] );
            for ( int v = 0; m == 1 && f > 0 && v < SIDE * SIDE; ++v )
            {
                wisp_vec3* p = &points[m][f][v];
                *p = ( wisp_vec3 ){ 1.02f * p->x, 1.02f * p->y - lower[f], 1.02f * p->z };
            }
        }
        motions[m] = ( suite_motion ){ &body, 1,           first,  points[m][0],   points[m][0],
                                       times, energies[m], FRAMES, { NULL, false } };
    }
    suite_reference reference = { .motion = motions[0], .frame_count = 1, .gravity = { 0.0f, -9.81f, 0.0f } };
    suite_comparison c;
    assert_int_equal( suite_compare( &motions[1], &reference, "it", &c, NULL ), WISP_OK );
    assert_true( c.distance == 0.0 );
    assert_true( fabs( c.late_height + 0.5 ) < 1e-4 ); // sines have a mean near 0
    assert_true( fabs( c.late_energy + 1.0 / 7.0 ) < 1e-12 );
    assert_true( fabs( c.late_stretch - 0.02 ) < 1e-5 );
    assert_true( fabs( c.late_detail - 1.02 ) < 1e-5 );
    reference.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, -3.0f };
    assert_int_equal( suite_compare( &motions[1], &reference, "it", &c, NULL ), WISP_OK );
    assert_true( fabs( c.late_height - 0.02 * ( SIDE - 1 ) / 2 ) < 1e-5 );
    reference.frame_count = FRAMES;
    assert_int_equal( suite_compare( &motions[1], &reference, "it", &c, NULL ), WISP_OK );
    assert_true( c.distance > 0.1 && isnan( c.late_height ) && isnan( c.late_energy ) && isnan( c.late_stretch ) &&
                 isnan( c.late_detail ) );
}
