// Frozen hair as experiments, on the oracle: the distributions of its random numbers and the three figures of Kim
// 2026. Bounds on sampled figures are three standard deviations of the sampling.
#include "clumping.h"
#include "frozen_hair_fixture.h"

static const double degree = 3.14159265358979323846 / 180.0;

static int compare_doubles( const void* a, const void* b )
{
    double x = *(const double*)a, y = *(const double*)b;
    return ( x > y ) - ( x < y );
}

// The largest distance between the distribution of n samples and that of U(0,1), times sqrt(n): Kolmogorov and
// Smirnov. 1.95 is passed by one uniform sample in a thousand. Sorts the samples.
static double distance_from_uniform( double* samples, int n )
{
    double largest = 0.0;
    qsort( samples, (size_t)n, sizeof( double ), compare_doubles );
    for ( int i = 0; i < n; ++i )
    {
        double above = ( i + 1.0 ) / n - samples[i], below = samples[i] - (double)i / n;
        largest = fmax( largest, fmax( above, below ) );
    }
    return largest * sqrt( n );
}

// Lengths: |l*/l0 - 1| <= alpha, its mean is alpha / 2, the deviation of l*/l0 is alpha / sqrt 3
static void lengths_are_spread_evenly_over_plus_and_minus_alpha( void** state )
{
    (void)state;
    const double stiffness[] = { 7.0, 3.0 }, printed_mean[] = { 0.071, 0.167 };
    for ( int n = 0; n < 2; ++n )
    {
        frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 1000, 20, 0.008 );
        set_stiffness( &scene, stiffness[n] );
        frozen_oracle_options options = frozen_oracle_default_options();
        double3* out = new_points( &scene );
        frozen_oracle_deform( &scene.hair, &options, out );
        double alpha = 1.0 / stiffness[n], mean = 0.0, square = 0.0;
        int count = 0;
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            if ( v % 20 > 0 )
            {
                double l0 = double3_distance( scene.rest[v], scene.rest[v - 1] );
                double change = double3_distance( out[v], out[v - 1] ) / l0 - 1.0;
                assert_true( fabs( change ) <= alpha + 1e-12 ); // coordinates round by 1e-16 m, segments are 3 mm
                mean += fabs( change );
                square += change * change;
                count += 1;
            }
        }
        mean /= count;
        // of u ~ U(-1,1): |u| has variance 1/12, u^2 has mean 1/3 and variance 4/45
        assert_close( mean, alpha / 2.0, 3.0 * alpha * sqrt( 1.0 / 12.0 / count ) );
        assert_close( square / count, alpha * alpha / 3.0, 3.0 * alpha * alpha * sqrt( 4.0 / 45.0 / count ) );
        assert_close( mean, printed_mean[n], 0.0005 + 3.0 * alpha * sqrt( 1.0 / 12.0 / count ) );
        free( out );
        frozen_scene_destroy( &scene );
    }
}

// Eq. 3-4, random numbers: eta, xi and zeta are uniform, and neighbouring elements are independent
static void the_random_numbers_are_uniform_and_uncorrelated( void** state )
{
    (void)state;
    enum
    {
        n = 20000
    };
    double* samples = checked_malloc( 3 * n * sizeof( double ) );
    frozen_oracle_options options = frozen_oracle_default_options();
    for ( int i = 0; i < n; ++i )
    {
        samples[i] = frozen_oracle_eta( &options, i / 20, i % 20 ) * 0.5 + 0.5;
        samples[n + i] = frozen_oracle_xi( &options, i / 20, i % 20 ) * 0.5 + 0.5;
        samples[2 * n + i] = frozen_oracle_zeta( &options, i / 80, i / 4 % 20, i % 4 );
    }
    for ( int a = 0; a < 3; ++a )
    {
        double neighbours = 0.0, streams = 0.0;
        for ( int i = 0; i < n; ++i )
        {
            double u = samples[a * n + i] - 0.5;
            neighbours += u * ( samples[a * n + ( i + 1 ) % n] - 0.5 );
            streams += u * ( samples[( a + 1 ) % 3 * n + i] - 0.5 );
        }
        // products of two independent U(-1/2,1/2) have variance 1/144
        assert_close( neighbours / n, 0.0, 3.0 / 12.0 / sqrt( n ) );
        assert_close( streams / n, 0.0, 3.0 / 12.0 / sqrt( n ) );
    }
    for ( int a = 0; a < 3; ++a )
    {
        assert_true( distance_from_uniform( samples + a * n, n ) < 1.95 );
    }
    free( samples );
}

// The distribution of lambda: without growing distances the printed and the closing rule leave lambda uniform
static void lambda_is_uniform_where_no_distance_counts( void** state )
{
    (void)state;
    enum
    {
        n = 20000
    };
    const frozen_oracle_gap rules[] = { FROZEN_ORACLE_GAP_SIGNED, FROZEN_ORACLE_GAP_REVERSED };
    // `printed` does not count a pair that closes, `closing` does not count one that opens
    const double r1[] = { 0.004, 0.006 };
    double* samples = checked_malloc( n * sizeof( double ) );
    frozen_oracle_options options = frozen_oracle_default_options();
    for ( int rule = 0; rule < 2; ++rule )
    {
        double delta = frozen_oracle_pair_delta( rules[rule], 0.005, r1[rule], options.clump_radius );
        for ( int i = 0; i < n; ++i )
        {
            double zeta = frozen_oracle_zeta( &options, i / 80, i / 4 % 20, i % 4 );
            samples[i] = frozen_oracle_lambda( rules[rule], delta, zeta, 0.0 );
        }
        assert_true( distance_from_uniform( samples, n ) < 1.95 );
    }
    free( samples );
}

// The distribution of lambda: E[lambda] is (1 - delta) / 2 with the prose, (1 + delta) / 2 with the closing rule
static void lambda_follows_its_law_in_hair( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 64, 20, 0.004 );
    double3 *p = new_points( &scene ), *out = new_points( &scene );
    double *delta = new_doubles( &scene ), *lambda = new_doubles( &scene );
    const frozen_oracle_gap rules[] = { FROZEN_ORACLE_GAP_ABSOLUTE, FROZEN_ORACLE_GAP_REVERSED,
                                        FROZEN_ORACLE_GAP_NONE };
    for ( int rule = 0; rule < 3; ++rule )
    {
        frozen_oracle_options options = frozen_oracle_default_options();
        options.gap = rules[rule];
        assert_int_equal( frozen_oracle_clump( &scene.hair, &options, scene.rest, NULL, p ), WISP_OK );
        clump_step( &scene, &options, options.clump_iterations, scene.rest, p, delta, lambda, out );
        double excess = 0.0, variance = 0.0, change = 0.0;
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            if ( v % 20 > 0 )
            {
                double one_or_zero = rules[rule] == FROZEN_ORACLE_GAP_REVERSED ? 1.0 : 0.0;
                excess += lambda[v] - ( 1.0 - delta[v] ) / 2.0 - delta[v] * one_or_zero;
                variance += ( 1.0 - delta[v] ) * ( 1.0 - delta[v] ) / 12.0;
                change += delta[v] / ( 0.95 * scene.vertex_count );
                assert_true( rules[rule] != FROZEN_ORACLE_GAP_NONE || ( lambda[v] == 1.0 && delta[v] == 0.0 ) );
            }
        }
        if ( rules[rule] != FROZEN_ORACLE_GAP_NONE )
        {
            assert_close( excess, 0.0, 3.0 * sqrt( variance ) );
            assert_true( change > 0.05 ); // the hair has moved enough to test the distribution
        }
    }
    free( p );
    free( out );
    free( delta );
    free( lambda );
    frozen_scene_destroy( &scene );
}

// Fig. 1: how far vertex i of an aligned straight strand turned about its root
static double turn_of( const frozen_scene* scene, const double3* out, int i )
{
    return double3_angle( double3_sub( scene->rest[i], scene->rest[0] ), double3_sub( out[i], out[0] ) );
}

static void intensity_spreads_the_turn_linearly_with_arc_and_late_with_chord( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 2, 1, 20, 0.0 );
    const double intensities[] = { 0.8, 0.2 };
    double rise[2][2];
    for ( int n = 0; n < 4; ++n )
    {
        double x = intensities[n % 2];
        frozen_oracle_options options = frozen_oracle_default_options();
        options.dimension = 2;
        options.deform = options.clump = false;
        options.cursor = double3_make( 0.1, -0.05, 0.0 );
        options.cursor_radius = 1.0;
        options.blend = n / 2 == 0 ? FROZEN_ORACLE_BLEND_ARC : FROZEN_ORACLE_BLEND_CHORD;
        scene.intensity[0] = x;
        double3* out = run( &scene, &options );
        double phi = double3_angle( double3_make( 0, -1, 0 ), options.cursor );
        double off_the_line = 0.0;
        for ( int i = 1; i < 20; ++i )
        {
            double w = x + ( 1.0 - x ) * i / 19.0;
            double chord = atan2( w * sin( phi ), 1.0 - w + w * cos( phi ) );
            assert_close( turn_of( &scene, out, i ), options.blend == FROZEN_ORACLE_BLEND_ARC ? w * phi : chord,
                          1e-9 );
            assert_true( i == 1 || turn_of( &scene, out, i ) > turn_of( &scene, out, i - 1 ) );
            off_the_line = fmax( off_the_line, fabs( turn_of( &scene, out, i ) - w * phi ) );
        }
        assert_true( options.blend == FROZEN_ORACLE_BLEND_ARC ? off_the_line < 1e-9 : off_the_line > 0.3 * degree );
        assert_close( turn_of( &scene, out, 19 ), phi, 1e-9 );
        rise[n / 2][n % 2] = turn_of( &scene, out, 19 ) - turn_of( &scene, out, 1 );
        free( out );
    }
    // 0.8 turns the strand as a whole, 0.2 bends it from root to tip
    assert_true( rise[0][0] < 0.3 * rise[0][1] && rise[1][0] < 0.4 * rise[1][1] );
    frozen_scene_destroy( &scene );
}

// Mean over inner vertices of |change of the turning angle| against rest, rad, in the plane; its length spread in
// *spread.
static double waviness( const frozen_scene* scene, const double3* out, double* spread )
{
    double sum = 0.0, square = 0.0;
    int bends = 0, segments = 0;
    for ( int v = 0; v < scene->vertex_count; ++v )
    {
        if ( v % 20 > 0 )
        {
            double l0 = double3_distance( scene->rest[v], scene->rest[v - 1] );
            double change = double3_distance( out[v], out[v - 1] ) / l0 - 1.0;
            square += change * change;
            segments += 1;
        }
        if ( v % 20 > 1 )
        {
            double angle[2];
            const double3* shapes[2] = { scene->rest, out };
            for ( int n = 0; n < 2; ++n )
            {
                double3 a = double3_sub( shapes[n][v - 1], shapes[n][v - 2] );
                double3 b = double3_sub( shapes[n][v], shapes[n][v - 1] );
                angle[n] = atan2( a.x * b.y - a.y * b.x, double3_dot( a, b ) );
            }
            sum += fabs( remainder( angle[1] - angle[0], 360.0 * degree ) );
            bends += 1;
        }
    }
    *spread = sqrt( square / segments );
    return sum / bends;
}

// Fig. 2: the mean change of turning angle is (2/3) theta_max alpha_b in the plane: 4.29 and 10.0 degrees
static void stiffness_seven_is_less_wavy_than_three_by_the_printed_angles( void** state )
{
    (void)state;
    const double stiffness[] = { 1e9, 7.0, 3.0 }, printed_degrees[] = { 0.0, 4.29, 10.0 };
    for ( int shape = FROZEN_SCENE_STRAIGHT; shape <= FROZEN_SCENE_CURLY; ++shape )
    {
        double angle[3], spread[3];
        for ( int n = 0; n < 3; ++n )
        {
            frozen_scene scene = new_scene( (frozen_scene_shape)shape, 2, 1000, 20, 0.004 );
            set_stiffness( &scene, stiffness[n] );
            frozen_oracle_options options = frozen_oracle_default_options();
            options.dimension = 2;
            options.align = options.clump = false;
            double3* out = run( &scene, &options );
            angle[n] = waviness( &scene, out, &spread[n] );

            // |u - v| of independent U(-1,1) has mean 2/3 and variance 2/9; neighbouring bends share a segment and so
            // have the correlation 0.1, which widens the sampling by sqrt( 1 + 2 * 0.1 ); 0.005 is the rounding of
            // the printed figures
            double step = options.theta_max / stiffness[n] / degree;
            double sampling = 3.0 * step * sqrt( 1.2 * 2.0 / 9.0 / ( 1000 * 18 ) );
            assert_close( angle[n] / degree, step * 2.0 / 3.0, sampling + 1e-9 );
            assert_close( angle[n] / degree, printed_degrees[n], sampling + 0.005 );
            free( out );
            frozen_scene_destroy( &scene );
        }
        assert_true( angle[0] < angle[1] && angle[1] < angle[2] );
        assert_true( spread[0] < spread[1] && spread[1] < spread[2] );
    }
}

// Fig. 3: hair aligned by the cursor, then clumped by wet, printed and prose rule; result[0] is before clumping
static void clump_aligned_hair( const frozen_scene* scene, int dimension, double spacing, int event,
                                bool min_distance_clamp, clumping result[4] )
{
    const frozen_oracle_gap rules[] = { FROZEN_ORACLE_GAP_NONE, FROZEN_ORACLE_GAP_NONE, FROZEN_ORACLE_GAP_SIGNED,
                                        FROZEN_ORACLE_GAP_ABSOLUTE };
    for ( int n = 0; n < 4; ++n )
    {
        frozen_oracle_options options = frozen_oracle_default_options();
        options.dimension = dimension;
        options.cursor = double3_make( 0.08, -0.17, 0.0 );
        options.cursor_radius = 1.0;
        options.event = (uint64_t)event;
        options.clump = n > 0;
        options.gap = rules[n];
        options.min_distance_clamp = min_distance_clamp;
        double3* out = run( scene, &options );
        for ( int s = 0; s < scene->hair.strand_count; ++s )
        {
            assert_true( same_bits( out + 20 * s, scene->rest + 20 * s, 1 ) ); // roots fixed
        }
        result[n] = measure_clumping( out, scene->vertex_count, scene->offsets[1], spacing );
        free( out );
    }
}

// Fig. 3: locks form, gaps stay: prose > printed > wet. In the plane, where the source works, from its density on (roots 0.2 h
// apart), and in space from 0.4 h on.
static void clumping_gathers_aligned_strands_into_fewer_locks_and_leaves_gaps( void** state )
{
    (void)state;
    const struct
    {
        int dimension, strands;
        double spacing;
    } grooms[] = { { 2, 40, 0.002 }, { 2, 40, 0.004 }, { 2, 40, 0.008 }, { 3, 49, 0.004 }, { 3, 49, 0.008 } };
    for ( int n = 0; n < 3 * 3 * WISP_COUNT( grooms ); ++n )
    {
        int g = n / 9, event = n / 3 % 3;
        frozen_scene scene =
            new_scene( (frozen_scene_shape)( n % 3 ), grooms[g].dimension, grooms[g].strands, 20, grooms[g].spacing );
        clumping c[4];
        clump_aligned_hair( &scene, grooms[g].dimension, grooms[g].spacing, event, true, c );
        assert_true( c[1].locks < c[0].locks && c[2].locks < c[0].locks && c[3].locks < c[0].locks );
        assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
        assert_true( c[0].mean_gap > c[3].mean_gap );
        for ( int rule = 1; rule < 4; ++rule )
        {
            // 1e-15 m is the rounding of coordinates below one metre
            assert_true( c[rule].nearest_gap >= fmin( c[0].nearest_gap, 0.0002 ) - 1e-15 );
        }
        frozen_scene_destroy( &scene );
    }
}

// Fig. 3, the limit of the figure's expectation: in space, with roots 0.2 h apart, a vertex has neighbours all around, whose
// pulls cancel. Braked steps leave all wavy strands but two alone, though gaps get smaller in the same order.
static void in_space_at_the_density_of_the_plane_no_locks_form( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 49, 20, 0.002 );
    clumping c[4];
    clump_aligned_hair( &scene, 3, 0.002, 0, true, c );
    assert_true( c[0].locks >= 48 && c[2].locks >= 48 && c[3].locks >= 48 );
    assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
    frozen_scene_destroy( &scene );
}

// Eq. 17-19, the limit of the order of the gaps: without the guard dense hair overshoots, and the undamped step
// overshoots most
static void dense_hair_without_the_guard_reverses_the_order_of_the_gaps( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 49, 20, 0.002 );
    clumping c[4];
    clump_aligned_hair( &scene, 3, 0.002, 0, false, c );
    assert_true( c[3].mean_gap < c[2].mean_gap && c[2].mean_gap < c[1].mean_gap );
    clump_aligned_hair( &scene, 3, 0.002, 0, true, c );
    assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
    frozen_scene_destroy( &scene );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( lengths_are_spread_evenly_over_plus_and_minus_alpha ),
        cmocka_unit_test( the_random_numbers_are_uniform_and_uncorrelated ),
        cmocka_unit_test( lambda_is_uniform_where_no_distance_counts ),
        cmocka_unit_test( lambda_follows_its_law_in_hair ),
        cmocka_unit_test( intensity_spreads_the_turn_linearly_with_arc_and_late_with_chord ),
        cmocka_unit_test( stiffness_seven_is_less_wavy_than_three_by_the_printed_angles ),
        cmocka_unit_test( clumping_gathers_aligned_strands_into_fewer_locks_and_leaves_gaps ),
        cmocka_unit_test( in_space_at_the_density_of_the_plane_no_locks_form ),
        cmocka_unit_test( dense_hair_without_the_guard_reverses_the_order_of_the_gaps ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
