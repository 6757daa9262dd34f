// Twist and rest shapes of elastic strands on their double-precision oracle.
#include "strand_oracle_fixture.h"

// ---- twist ----

static void a_root_that_turns_about_a_straight_rod_turns_its_tip( void** state )
{
    (void)state;
    const double dt = 1.0 / 60.0, angle = 2.5;
    strand_oracle strand = new_straight( 16, 0.1, true ), start;
    strand_oracle_stiffen( &strand, 8e-9, 6e-9, true, dt );
    strand_oracle_rest_shape( &strand );
    start = strand;
    strand.turn = strand_oracle_about( double3_make( 1.0, 0.0, 0.0 ), angle );
    strand_oracle_settings settings = rod_settings( dt );
    settings.gravity = zero;
    steps( &strand, &settings, 30 );
    const double3 foreign = { 1.0, 0.0, 0.0 };
    for ( int s = 0; s < 15; ++s )
    {
        const double3 now = strand_oracle_turned( strand.frame[s], foreign );
        const double3 reference =
            strand_oracle_turned( strand.turn, strand_oracle_turned( start.frame[s], foreign ) );
        assert_close( double3_distance( now, reference ), 0.0, 1e-9 );
        assert_close( strand_oracle_twist( &strand, s ), 0.0, 1e-9 );
    }
    assert_close( farthest( &strand, &start ), 0.0, 1e-12 );
}

static void the_sign_of_a_frame_means_nothing( void** state )
{
    (void)state;
    strand_oracle strand = new_curl( 12, 1.0, true );
    strand_oracle_stiffen( &strand, 1e-7, 7.5e-8, true, 0.0 );
    strand_oracle_rest_shape( &strand );
    deform( &strand, 51, 0.002 );
    strand_oracle other = strand;
    for ( int s = 0; s < 11; s += 2 )
    {
        const strand_oracle_quaternion q = strand.frame[s];
        other.frame[s] = ( strand_oracle_quaternion ){ -q.x, -q.y, -q.z, -q.w };
    }
    double3 a[12], b[12];
    strand_oracle_rod_gradient( &strand, a );
    strand_oracle_rod_gradient( &other, b );
    for ( int i = 0; i < 12; ++i )
    {
        assert_close( double3_distance( a[i], b[i] ), 0.0, 1e-14 * double3_length( a[11] ) );
    }
    assert_close( strand_oracle_rod_energy( &strand ) / strand_oracle_rod_energy( &other ), 1.0, 1e-14 );
}

static void a_segment_turns_by_a_radian_at_most( void** state )
{
    (void)state;
    strand_oracle strand = new_straight( 2, 0.01, true );
    strand_oracle_stiffen( &strand, 1e-8, 1e-8, true, 0.0 );
    strand_oracle_rest_shape( &strand );
    strand.turn = strand_oracle_about( double3_make( 1.0, 0.0, 0.0 ), 3.0 );
    strand_oracle_rod_factor( &strand, 0.0, 1e-3 );
    const double before = strand_oracle_twist( &strand, 0 );
    strand_oracle_rod( &strand, 0.0, 1e-3, NULL );
    // a radian to first order, (0, 0, a/2, 1), is 2 atan( 1/2 )
    assert_close( fabs( before - strand_oracle_twist( &strand, 0 ) ), 2.0 * atan( 0.5 ), 1e-14 );
}

// Motion of a free curl whose segments were turned about themselves, and its prediction by the gradient at the frames
// that the rod leaves.
static void move_turned( double turned, double3* by_rod, double3* by_gradient )
{
    const double dt = 1e-5; // so short that (M + dt^2 K) is M to five digits
    strand_oracle strand = new_curl( 12, 1.0, false );
    strand_oracle_stiffen( &strand, 1e-8, 7.5e-9, false, 0.0 );
    strand_oracle_rest_shape( &strand );
    deform( &strand, 52, 0.002 );
    settle_twist( &strand );
    for ( int s = 0; s < 11; ++s )
    {
        const double angle = turned * random_between( 53, s, -1.0, 1.0 );
        const strand_oracle_quaternion turn = strand_oracle_about( double3_make( 0.0, 0.0, 1.0 ), angle );
        strand.frame[s] = strand_oracle_product( strand.frame[s], turn );
    }
    const strand_oracle start = strand;
    strand_oracle_rod_factor( &strand, 0.0, dt );
    strand_oracle_rod( &strand, 0.0, dt, NULL );
    strand_oracle after = start;
    memcpy( after.frame, strand.frame, sizeof( strand.frame ) );
    strand_oracle_rod_gradient( &after, by_gradient );
    for ( int i = 0; i < 12; ++i )
    {
        const double3 x = double3_sub( strand.position[i], start.position[i] );
        by_rod[i] = double3_scale( 1.0 / ( dt * dt * strand.weight[i] ), x );
        by_gradient[i] = double3_scale( -1.0, by_gradient[i] );
    }
}

static void what_was_measured_turns_with_the_segments( void** state )
{
    (void)state;
    double3 rod[2][12], gradient[2][12];
    move_turned( 0.0, rod[0], gradient[0] );
    move_turned( 0.1, rod[1], gradient[1] );
    double first = 0.0, worst = 0.0;
    for ( int i = 0; i < 12; ++i )
    {
        const double3 off = double3_sub( rod[0][i], gradient[0][i] ); // dt^2 K and rounding, the same in both
        first = fmax( first, double3_length( gradient[1][i] ) );
        const double3 left = double3_sub( double3_sub( rod[1][i], gradient[1][i] ), off );
        worst = fmax( worst, double3_length( left ) );
    }
    print_message( "turned by 0.1: forces differ by %.2g of the largest\n", worst / first );
    // second order in the turn, 0.1^2 / 2, of forces that are at most of that size
    assert_true( worst < 5e-3 * first );
}

static void twist_comes_to_balance( void** state )
{
    (void)state;
    double residual[MAX_STRAND_ORACLE];
    strand_oracle strand = new_curl( 24, 2.0, true );
    strand_oracle_stiffen( &strand, 1e-7, 7.5e-8, true, 0.0 );
    strand_oracle_rest_shape( &strand );
    deform( &strand, 50, 0.002 );
    strand_oracle_twist_balance( &strand, residual );
    double before = 0.0, after = 0.0;
    for ( int s = 0; s < 23; ++s )
    {
        before = fmax( before, fabs( residual[s] ) );
    }
    settle_twist( &strand );
    strand_oracle_twist_balance( &strand, residual );
    for ( int s = 0; s < 23; ++s )
    {
        after = fmax( after, fabs( residual[s] ) );
    }
    assert_true( before > 0.0 );
    assert_close( after / before, 0.0, 1e-10 );
}

// ---- balance ----

// The imbalance of forces and of twist, relative to the strand's weight and its moment.
static double missing_to_balance( const strand_oracle* strand )
{
    double3 force[MAX_STRAND_ORACLE];
    double twist[MAX_STRAND_ORACLE], worst = 0.0;
    strand_oracle_rod_gradient( strand, force );
    strand_oracle_twist_balance( strand, twist );
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const double3 e = double3_sub( strand->position[s + 1], strand->position[s] );
        const double3 pull = double3_scale( strand->tension[s] / strand->length[s], e );
        force[s] = double3_sub( force[s], pull );
        force[s + 1] = double3_add( force[s + 1], pull );
        worst = fmax( worst, fabs( twist[s] ) / ( whole_weight( strand ) * whole_length( strand ) ) );
    }
    for ( int i = 1; i < strand->count; ++i )
    {
        const double3 missing = double3_sub( double3_scale( strand->mass[i], gravity ), force[i] );
        worst = fmax( worst, double3_length( missing ) / whole_weight( strand ) );
    }
    return worst;
}

static void a_balanced_curl_is_in_balance( void** state )
{
    (void)state;
    static const double rigidity[] = { 8e-9, 1e-7, 1e-6, 1e-5 };
    for ( int k = 0; k < 4; ++k )
    {
        strand_oracle strand = new_curl( 32, 3.0, true );
        strand_oracle_stiffen( &strand, rigidity[k], 0.75 * rigidity[k], true, 1.0 / 600.0 );
        strand_oracle_balance( &strand, gravity );
        const double missing = missing_to_balance( &strand );
        print_message( "balanced curl EI %g: %.2g of its weight is missing\n", rigidity[k], missing );
        // a moment's rounding is EI / (l^2 W) times that of a direction: 1 at a hair, 1e3 at the last row
        assert_true( missing < 1e-12 * fmax( 1.0, rigidity[k] / 1e-7 ) );
    }
}

static void a_balanced_curl_stays_where_it_is( void** state )
{
    (void)state;
    for ( int k = 0; k < 2; ++k )
    {
        const double dt = 1.0 / 600.0;
        double moved[2];
        for ( int back = 0; back < 2; ++back )
        {
            strand_oracle strand = new_curl( 32, k == 0 ? 3.0 : 1.5, true ), start = strand;
            strand_oracle_stiffen( &strand, 1e-7, 7.5e-8, true, dt );
            strand_oracle_balance( &strand, gravity );
            strand_oracle_settings settings = rod_settings( dt );
            settings.looks_back = back == 1;
            steps( &strand, &settings, 1200 );
            moved[back] = farthest( &strand, &start ) / whole_length( &start );
        }
        print_message( "balanced curl of %g turns after 2 s: %.2g L away looking at p*, %.2g L looking back\n",
                       k == 0 ? 3.0 : 1.5, moved[0], moved[1] );
        assert_true( moved[1] < 1e-6 );
        // at p* gravity has bent the first segment already: the substep has another equilibrium than the equations
        assert_true( moved[0] > 1e-6 );
    }
}

static void a_curl_that_is_straight_at_rest_sags( void** state )
{
    (void)state;
    const double dt = 1.0 / 600.0;
    strand_oracle strand = new_curl( 32, 1.5, true ), start = strand;
    strand_oracle_stiffen( &strand, 1e-7, 7.5e-8, true, dt );
    strand_oracle_rest_straight( &strand );
    strand_oracle_settings settings = rod_settings( dt );
    settings.damping = 5.0;
    steps( &strand, &settings, 1200 );
    assert_true( farthest( &strand, &start ) > 0.1 * whole_length( &start ) );
    assert_true( strand_oracle_strain( &strand ) < 1e-3 );
}

static void a_soft_curl_keeps_its_shape_under_no_gravity( void** state )
{
    (void)state;
    const double dt = 1.0 / 600.0;
    strand_oracle strand = new_curl( 32, 3.0, true ), start = strand;
    strand_oracle_stiffen( &strand, 8e-9, 6e-9, true, dt );
    strand_oracle_rest_shape( &strand );
    strand_oracle_settings settings = rod_settings( dt );
    settings.gravity = zero;
    steps( &strand, &settings, 1200 );
    assert_close( farthest( &strand, &start ), 0.0, 1e-12 );

    // and never has more energy than a kick has added
    for ( int i = 1; i < strand.count; ++i )
    {
        strand.velocity[i] = double3_scale( 0.02, random_vector( 60, i ) );
    }
    const double given = kinetic( &strand );
    for ( int k = 0; k < 1200; ++k )
    {
        strand_oracle_substep( &strand, &settings, NULL );
        assert_true( kinetic( &strand ) + strand_oracle_rod_energy( &strand ) <= given );
    }
}

static void small_rods_and_any_stiffness_are_no_trouble( void** state )
{
    (void)state;
    for ( int n = 0; n < 4 * 3 * 2 * 2; ++n )
    {
        const int count = 1 + n % 4;
        const double rigidity = n / 4 % 3 == 0 ? 0.0 : ( n / 4 % 3 == 1 ? 1e-8 : 1e12 ),
                     dt = n / 12 % 2 == 0 ? 0.2 : 1e-3;
        const bool at_a_point = n / 24 == 1;
        double3 points[4] = { zero, zero, zero, zero };
        for ( int i = 0; i < count && at_a_point == false; ++i )
        {
            points[i] = double3_make( 0.01 * i, -0.004 * i * i, 0.002 * i );
        }
        strand_oracle strand;
        assert_true( strand_oracle_shape( &strand, points, count ) );
        strand_oracle_weigh( &strand, line_density, true );
        strand_oracle_stiffen( &strand, rigidity, rigidity, true, dt );
        strand_oracle_balance( &strand, gravity );
        const strand_oracle_settings settings = rod_settings( dt );
        steps( &strand, &settings, 30 );
        for ( int i = 0; i < count; ++i )
        {
            assert_true( isfinite( double3_length( strand.position[i] ) + double3_length( strand.velocity[i] ) ) );
        }
        assert_true( strand_oracle_strain( &strand ) <= settings.tolerance );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_root_that_turns_about_a_straight_rod_turns_its_tip ),
        cmocka_unit_test( the_sign_of_a_frame_means_nothing ),
        cmocka_unit_test( a_segment_turns_by_a_radian_at_most ),
        cmocka_unit_test( what_was_measured_turns_with_the_segments ),
        cmocka_unit_test( twist_comes_to_balance ),
        cmocka_unit_test( a_balanced_curl_is_in_balance ),
        cmocka_unit_test( a_balanced_curl_stays_where_it_is ),
        cmocka_unit_test( a_curl_that_is_straight_at_rest_sags ),
        cmocka_unit_test( a_soft_curl_keeps_its_shape_under_no_gravity ),
        cmocka_unit_test( small_rods_and_any_stiffness_are_no_trouble ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
