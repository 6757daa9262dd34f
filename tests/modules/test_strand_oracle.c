// Moving strands on their double-precision oracle: pendulums, chains, conserved quantities, damping and air. The
// closed forms are those of the table of references.
#include "strand_oracle_fixture.h"

// ---- pendulums and chains ----

// Time from one passage of x = 0 by a vertex to the next in the same direction.
static double measured_period( strand_oracle* strand, const strand_oracle_settings* settings, int vertex )
{
    double first = -1.0, time = 0.0;
    for ( int k = 0; k < 2000000; ++k )
    {
        const double before = strand->position[vertex].x;
        strand_oracle_substep( strand, settings, NULL );
        time += settings->dt;
        const double now = strand->position[vertex].x;
        if ( before > 0.0 && now <= 0.0 )
        {
            const double intersection = time - settings->dt * now / ( now - before );
            if ( first >= 0.0 )
            {
                return intersection - first;
            }
            first = intersection;
        }
    }
    fail_msg( "vertex %d never swung", vertex );
    return 0.0;
}

static double pendulum_error( double degrees, double reference, double substeps_a_second )
{
    const double angle = degrees * pi / 180.0, length = 1.0;
    strand_oracle strand = new_chain( 2, length, double3_make( sin( angle ), -cos( angle ), 0.0 ), true );
    const strand_oracle_settings settings = strand_oracle_default_settings( 1.0 / substeps_a_second );
    const double period = measured_period( &strand, &settings, 1 );
    return period / ( reference * 2.0 * pi * sqrt( length / fall ) ) - 1.0;
}

static void a_pendulum_has_its_period_at_every_amplitude( void** state )
{
    (void)state;
    static const struct
    {
        double degrees, reference, substeps;
    } row[] = {
        { 10.0, 1.00190719, 240.0 },
        { 30.0, 1.01740880, 1920.0 },
        { 60.0, 1.07318201, 7680.0 },
        { 90.0, 1.18034060, 30720.0 },
    };
    for ( size_t k = 0; k < sizeof( row ) / sizeof( row[0] ); ++k )
    {
        const double error = pendulum_error( row[k].degrees, row[k].reference, row[k].substeps );
        print_message( "pendulum %g degrees, %g substeps a second: period %+.4f %%\n", row[k].degrees,
                       row[k].substeps, 100.0 * error );
        assert_close( error, 0.0, 1e-3 );
    }
}

static void the_error_of_the_period_falls_with_the_substep( void** state )
{
    (void)state;
    const double coarse = pendulum_error( 60.0, 1.07318201, 480.0 ), fine = pendulum_error( 60.0, 1.07318201, 960.0 );
    print_message( "pendulum 60 degrees: period %+.4f %% at 480, %+.4f %% at 960 substeps a second\n", 100.0 * coarse,
                   100.0 * fine );
    // first order: halved, within a fifth
    assert_close( fine / coarse, 0.5, 0.1 );
}

// The k-th mode of n equal masses under their weight: recursion from the force balance of each mass, tension (n - s) m g in
// segment s.
static strand_oracle new_swinging_chain( int n, double relative_period )
{
    strand_oracle strand = new_chain( n + 1, 1.0, double3_make( 0.0, -1.0, 0.0 ), true );
    const double omega = 2.0 * pi / relative_period, link = 1.0 / n; // in units of sqrt( g / L )
    double y[MAX_STRAND_ORACLE] = { 0.0, 1.0 }, largest = 1.0;
    for ( int i = 1; i < n; ++i )
    {
        const double pull = ( n - i + 1 ) * ( y[i] - y[i - 1] ) - omega * omega * link * y[i];
        y[i + 1] = y[i] + pull / ( n - i );
        largest = fmax( largest, fabs( y[i + 1] ) );
    }
    for ( int i = 1; i <= n; ++i )
    {
        // a circle's worth of slope: vertices hang on their links, displaced by at most 1e-3 L
        const double x = 1e-3 * y[i] / largest, before = strand.position[i - 1].x;
        strand.position[i].x = x;
        strand.position[i].y = strand.position[i - 1].y - sqrt( link * link - ( x - before ) * ( x - before ) );
    }
    return strand;
}

static void hanging_chains_have_the_periods_of_laguerre( void** state )
{
    (void)state;
    static const struct
    {
        int n;
        double relative, substeps;
    } row[] = {
        { 2, 5.804906, 960.0 },   { 10, 5.352609, 960.0 },  { 32, 5.265950, 960.0 },
        { 10, 2.326381, 1920.0 }, { 32, 2.293556, 1920.0 },
    };
    for ( size_t k = 0; k < sizeof( row ) / sizeof( row[0] ); ++k )
    {
        strand_oracle strand = new_swinging_chain( row[k].n, row[k].relative );
        const strand_oracle_settings settings = strand_oracle_default_settings( 1.0 / row[k].substeps );
        const double error =
            measured_period( &strand, &settings, row[k].n ) / ( row[k].relative * sqrt( 1.0 / fall ) ) - 1.0;
        print_message( "chain of %d, period %g: %+.4f %%\n", row[k].n, row[k].relative, 100.0 * error );
        assert_close( error, 0.0, 5e-3 );
    }
}

static void each_segment_of_a_chain_pulls_with_the_weight_below( void** state )
{
    (void)state;
    for ( int measure = 0; measure < 2; ++measure )
    {
        strand_oracle strand = new_chain( 33, 0.5, double3_make( 0.0, -1.0, 0.0 ), true );
        strand_oracle_settings settings = strand_oracle_default_settings( 1.0 / 600.0 );
        settings.measure = (strand_oracle_measure)measure;
        steps( &strand, &settings, 200 );
        for ( int s = 0; s < 32; ++s )
        {
            assert_ratio( strand.tension[s], ( 32 - s ) * 1e-3 * fall, 1e-3 );
        }
    }
}

static void a_cable_between_two_pins_hangs_as_a_catenary( void** state )
{
    (void)state;
    enum
    {
        SEGMENTS = 64
    };
    double3 points[SEGMENTS + 1];
    for ( int i = 0; i <= SEGMENTS; ++i )
    {
        const double along = i / (double)SEGMENTS;
        points[i] = double3_make( 0.8 * along, -0.6 * fmin( along, 1.0 - along ), 0.0 ); // a V of length 1
    }
    strand_oracle strand;
    assert_true( strand_oracle_shape( &strand, points, SEGMENTS + 1 ) );
    strand_oracle_weigh( &strand, 1.0, true );
    strand_oracle_pin( &strand, SEGMENTS );
    strand_oracle_settings settings = strand_oracle_default_settings( 1.0 / 600.0 );
    settings.damping = 5.0;
    steps( &strand, &settings, 6000 );

    const double sag = -strand.position[SEGMENTS / 2].y;
    // the tension at the pin also holds the half segment that the pin itself carries
    const double3 pull =
        double3_scale( strand.tension[0] / strand.length[0], double3_sub( strand.position[1], strand.position[0] ) );
    const double most = hypot( pull.x, -pull.y + 0.5 * fall / SEGMENTS );
    print_message( "catenary: sag %+.4f %%, tension %+.4f %%\n", 100.0 * ( sag / 0.26543751 - 1.0 ),
                   100.0 * ( most / ( 0.603639 * fall ) - 1.0 ) );
    assert_ratio( sag, 0.26543751, 5e-3 );
    assert_ratio( most, 0.603639 * fall, 5e-3 );
    assert_true( strand_oracle_strain( &strand ) < 1e-6 );
}

// ---- conserved quantities ----

static void a_free_strand_falls_without_strain_or_spin( void** state )
{
    (void)state;
    strand_oracle strand = new_crooked( 1, 20, false ), start = strand;
    const double dt = 1.0 / 600.0;
    const strand_oracle_settings settings = strand_oracle_default_settings( dt );
    steps( &strand, &settings, 600 );
    for ( int i = 0; i < strand.count; ++i )
    {
        // the scheme falls by g dt^2 k (k + 1) / 2; a sum of 600 roundings of metres remains
        const double fallen = fall * dt * dt * 600.0 * 601.0 / 2.0;
        assert_close( strand.position[i].y, start.position[i].y - fallen, 1e-12 );
        assert_close( strand.position[i].x, start.position[i].x, 1e-12 );
        assert_close( strand.tension[i], 0.0, 1e-12 );
    }
    assert_true( strand_oracle_strain( &strand ) < 1e-12 );
}

static void the_momentum_of_a_free_strand_is_constant( void** state )
{
    (void)state;
    static const char* const name[] = { "direct", "pbd", "xpbd" };
    for ( int k = 0; k < 3; ++k )
    {
        strand_oracle strand = new_crooked( 2, 24, false );
        kick( &strand, 3, 0.5 );
        const double3 start = momentum( &strand ), spin = angular_momentum( &strand );
        strand_oracle_settings settings =
            settings_of( k == 0 ? STRAND_ORACLE_LENGTHS_DIRECT : STRAND_ORACLE_LENGTHS_LINKS, k == 2, 1.0 / 600.0 );
        settings.gravity = zero;
        settings.passes = 8; // a strand that is reset does not keep its momentum: here none is
        settings.bending = k > 0 ? STRAND_ORACLE_BENDING_LINKS : STRAND_ORACLE_BENDING_NONE;
        steps( &strand, &settings, 600 );
        const double linear = double3_distance( momentum( &strand ), start ) / double3_length( start );
        const double angular = double3_distance( angular_momentum( &strand ), spin ) / double3_length( spin );
        print_message( "%s: momentum changes by %.2g, angular momentum by %.2g of itself\n", name[k], linear,
                       angular );
        assert_true( linear < 1e-12 );
    }
}

static double energy( const strand_oracle* strand )
{
    double sum = 0.0;
    for ( int i = 0; i < strand->count; ++i )
    {
        const double3 v = strand->velocity[i];
        sum += strand->mass[i] * ( 0.5 * double3_dot( v, v ) + fall * strand->position[i].y );
    }
    return sum;
}

static void energy_never_rises_without_damping( void** state )
{
    (void)state;
    static const int counts[] = { 2, 3, 11, 33 };
    for ( int k = 0; k < 4; ++k )
    {
        strand_oracle strand = new_chain( counts[k], 0.5, double3_make( 1.0, 0.0, 0.0 ), true );
        const strand_oracle_settings settings = strand_oracle_default_settings( 1.0 / 1200.0 );
        const double start = energy( &strand ), scale = strand.mass[0] * fall * 0.5 * counts[k];
        double highest = -DBL_MAX;
        for ( int n = 0; n < 2400; ++n )
        {
            strand_oracle_substep( &strand, &settings, NULL );
            highest = fmax( highest, energy( &strand ) );
        }
        print_message( "chain of %d vertices: energy at most %+.2g of its weight's\n", counts[k],
                       ( highest - start ) / scale );
        assert_true( highest - start <= 1e-9 * scale );
        assert_true( is_finite( &strand ) );
    }
}

// ---- prediction, damping, air ----

static void a_held_root_goes_where_it_is_carried( void** state )
{
    (void)state;
    strand_oracle strand = new_crooked( 4, 5, true );
    strand_oracle_pin( &strand, 3 );
    strand.velocity[3] = double3_make( 1.0, 0.0, 0.0 );
    const strand_oracle start = strand;
    const double3 root = { 0.1, 0.2, 0.3 };
    strand_oracle_predict( &strand, &root, double3_make( 0.0, -10.0, 0.0 ), 0.01 );
    assert_close( double3_distance( strand.position[0], root ), 0.0, 0.0 );
    // velocities of 30 m/s, four roundings
    const double3 way = double3_sub( root, start.position[0] );
    assert_close( double3_distance( strand.velocity[0], double3_scale( 100.0, way ) ), 0.0,
                  30.0 * 4.0 * DBL_EPSILON );
    assert_close( double3_distance( strand.position[3], start.position[3] ), 0.0, 0.0 );
    assert_close( start.position[3].x - strand.previous[3].x, 0.01, 4.0 * DBL_EPSILON );
    assert_close( strand.velocity[1].y, -0.1, 4.0 * DBL_EPSILON );
    assert_close( strand.position[1].y, start.position[1].y - 0.001, 4.0 * DBL_EPSILON );

    // without a root it stays
    strand = start;
    strand.velocity[0] = double3_make( 1.0, 2.0, 3.0 );
    strand_oracle_predict( &strand, NULL, double3_make( 0.0, -10.0, 0.0 ), 0.01 );
    assert_close( double3_distance( strand.position[0], start.position[0] ), 0.0, 0.0 );
    assert_close( double3_length( strand.velocity[0] ), 0.0, 0.0 );
}

static void damping_leaves_the_rigid_motion_of_the_head_alone( void** state )
{
    (void)state;
    const double3 linear = { 0.3, -0.2, 0.5 }, angular = { 1.0, 2.0, -0.5 }, centre = { 0.1, 0.0, 0.2 };
    strand_oracle strand = new_crooked( 5, 20, true );
    for ( int i = 0; i < strand.count; ++i )
    {
        const double3 arm = double3_sub( strand.position[i], centre );
        strand.velocity[i] = double3_add( linear, double3_cross( angular, arm ) );
    }
    const strand_oracle start = strand;
    strand_oracle_damp( &strand, 0.25, linear, angular, centre );
    for ( int i = 0; i < strand.count; ++i )
    {
        assert_close( double3_distance( strand.velocity[i], start.velocity[i] ), 0.0, 1e-15 );
    }

    // and keeps the other components
    strand.velocity[7] = double3_add( strand.velocity[7], double3_make( 0.0, 1.0, 0.0 ) );
    strand_oracle_damp( &strand, 0.25, linear, angular, centre );
    assert_close( strand.velocity[7].y - start.velocity[7].y, 0.25, 1e-15 );
}

static void air_leaves_motion_along_the_strand_alone( void** state )
{
    (void)state;
    const double3 along = double3_scale( 1.0 / 3.0, double3_make( 1.0, 2.0, -2.0 ) );
    strand_oracle strand = new_chain( 12, 0.3, along, false );
    for ( int i = 0; i < strand.count; ++i )
    {
        strand.velocity[i] = double3_scale( 0.1 * ( i + 1 ), along );
    }
    const strand_oracle start = strand;
    strand_oracle_air( &strand, zero, 1e-2, 1.0 / 60.0 );
    for ( int i = 0; i < strand.count; ++i )
    {
        assert_close( double3_distance( strand.velocity[i], start.velocity[i] ), 0.0, 1e-15 );
    }
}

static void air_across_a_strand_brakes_as_its_square_and_never_turns_it_round( void** state )
{
    (void)state;
    const double mass = 1e-3, dt = 1.0 / 60.0, link = 0.1;
    for ( int k = 0; k < 3; ++k )
    {
        const double drag = k == 0 ? 1e-3 : ( k == 1 ? 1.0 : 1e6 ), speed = 3.0;
        strand_oracle strand = new_chain( 3, 2.0 * link, double3_make( 0.0, -1.0, 0.0 ), false );
        strand.velocity[1] = double3_make( speed, 0.5, 0.0 );
        strand_oracle_air( &strand, zero, drag, dt );
        // v' = v - dt (drag L |v| / m) v' of the part across
        const double a = drag * link * speed / mass * dt;
        assert_ratio( strand.velocity[1].x, speed / ( 1.0 + a ), 1e-9 );
        assert_close( strand.velocity[1].y, 0.5, 1e-15 );
    }

    // a strand at rest is accelerated by the wind, up to its speed and not beyond
    strand_oracle strand = new_chain( 3, 0.2, double3_make( 0.0, -1.0, 0.0 ), false );
    strand_oracle_air( &strand, double3_make( 5.0, 0.0, 0.0 ), 1e6, dt );
    assert_ratio( strand.velocity[1].x, 5.0, 1e-5 );
    assert_true( strand.velocity[1].x <= 5.0 );
}

// ---- BDF2 ----

static strand_oracle fallen( bool bdf2, int substeps )
{
    strand_oracle strand = new_chain( 10, 0.5, double3_make( 1.0, 0.0, 0.0 ), true );
    strand_oracle_past past = { .exists = false };
    strand_oracle_settings settings = strand_oracle_default_settings( 0.25 / substeps );
    settings.passes = 20;
    for ( int k = 0; k < substeps; ++k )
    {
        const bool laid = bdf2 ? strand_oracle_substep_bdf2( &strand, &past, &settings, NULL )
                               : strand_oracle_substep( &strand, &settings, NULL );
        assert_false( laid );
    }
    return strand;
}

static void a_falling_chain_is_of_first_order_by_euler_and_of_second_by_bdf2( void** state )
{
    (void)state;
    const strand_oracle reference = fallen( true, 8192 );
    for ( int order = 1; order <= 2; ++order )
    {
        const strand_oracle coarse = fallen( order == 2, 64 ), fine = fallen( order == 2, 128 );
        const double observed = log2( farthest( &coarse, &reference ) / farthest( &fine, &reference ) );
        assert_true( fabs( observed - order ) < 0.15 );
    }
}

// In a fall without a hold BDF2 keeps the error of its first substep, g h^2 / 2, and has no other.
static void a_free_fall_by_bdf2_is_exact_after_the_first_substep( void** state )
{
    (void)state;
    const double dt = 1.0 / 60.0;
    strand_oracle strand = new_chain( 3, 0.1, double3_make( 1.0, 0.0, 0.0 ), false );
    strand_oracle_past past = { .exists = false };
    const strand_oracle_settings settings = strand_oracle_default_settings( dt );
    for ( int k = 1; k <= 40; ++k )
    {
        strand_oracle_substep_bdf2( &strand, &past, &settings, NULL );
        // x_{n+1} - x_n - (x_n - x_{n-1}) / 3 = he v, so that error goes on to 3 / 2 of itself and stays
        const double t = k * dt, late = strand.position[0].y + 0.5 * fall * t * t;
        assert_true( fabs( strand.velocity[0].y + fall * t ) < 1e-12 );
        assert_true( fabs( late + 0.5 * fall * dt * dt * 1.5 * ( 1.0 - pow( 1.0 / 3.0, k ) ) ) < 1e-12 );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_falling_chain_is_of_first_order_by_euler_and_of_second_by_bdf2 ),
        cmocka_unit_test( a_free_fall_by_bdf2_is_exact_after_the_first_substep ),
        cmocka_unit_test( a_pendulum_has_its_period_at_every_amplitude ),
        cmocka_unit_test( the_error_of_the_period_falls_with_the_substep ),
        cmocka_unit_test( hanging_chains_have_the_periods_of_laguerre ),
        cmocka_unit_test( each_segment_of_a_chain_pulls_with_the_weight_below ),
        cmocka_unit_test( a_cable_between_two_pins_hangs_as_a_catenary ),
        cmocka_unit_test( a_free_strand_falls_without_strain_or_spin ),
        cmocka_unit_test( the_momentum_of_a_free_strand_is_constant ),
        cmocka_unit_test( energy_never_rises_without_damping ),
        cmocka_unit_test( a_held_root_goes_where_it_is_carried ),
        cmocka_unit_test( damping_leaves_the_rigid_motion_of_the_head_alone ),
        cmocka_unit_test( air_leaves_motion_along_the_strand_alone ),
        cmocka_unit_test( air_across_a_strand_brakes_as_its_square_and_never_turns_it_round ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
