// The balloon in motion on its double-precision oracle: pressure table, lift, jet, spin and the figures of the
// balloon paper, which numbers of equations, figures and sections refer to (docs/methods.md).
#include "oracle_support.h"

#include "oracle/balloon_meshes.h"
#include "oracle/balloon_oracle.h"

static const uint64_t random_seed = 23;

static balloon_oracle new_body( const balloon_mesh* mesh, double areal_density, int outlet,
                                const balloon_oracle_options* options )
{
    balloon_oracle body;
    wisp_error error = { 0 };
    assert_ok( balloon_oracle_create_from_mesh( mesh, areal_density, outlet, options, &body, &error ), error );
    return body;
}

static balloon_oracle new_sphere( int level, double areal_density, const balloon_oracle_options* options )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_icosphere( &mesh, level, 0.15 ) );
    balloon_oracle body = new_body( &mesh, areal_density, 0, options );
    balloon_mesh_destroy( &mesh );
    return body;
}

// An asymmetric body whose outlet is off its axis.
static balloon_oracle new_pear( double3 outlet_direction, const balloon_oracle_options* options )
{
    balloon_mesh mesh;
    assert_true( balloon_mesh_pear( &mesh, 2, 0.15 ) );
    balloon_oracle body = new_body( &mesh, 0.02, balloon_mesh_farthest( &mesh, outlet_direction ), options );
    balloon_mesh_destroy( &mesh );
    return body;
}

static balloon_oracle_options without_surroundings( void )
{
    balloon_oracle_options options = balloon_oracle_default_options();
    options.use_gravity = options.use_buoyancy = options.use_drag = false;
    return options;
}

static void steps( balloon_oracle* body, int count )
{
    for ( int n = 0; n < count; ++n )
    {
        balloon_oracle_step( body );
    }
}

static double3 body_momentum( const balloon_oracle* body )
{
    return balloon_oracle_momentum( body->v, body->mass, body->vertex_count );
}

static double3 body_centre( const balloon_oracle* body )
{
    return balloon_oracle_centre( body->x, body->mass, body->vertex_count );
}

static double3 body_angular_momentum( const balloon_oracle* body )
{
    return balloon_oracle_angular_momentum( body->x, body->v, body->mass, body->vertex_count, body_centre( body ) );
}

static double body_volume_ratio( const balloon_oracle* body )
{
    return balloon_oracle_present_volume( body ) / body->rest_volume;
}

// Pressures of a static sphere in three readings. The table was made without bend pairs. Its virial agrees within 1
// %, its converged rows (100 and 400 substeps) within 2 % in every reading. In unconverged rows, which that section
// calls useless, gas and multiplier differ by up to 57 Pa of the limit of 2410 Pa, more than with another order of
// the edges (9 Pa).
static void the_three_pressure_readings_follow_the_table_of_the_specification( void** state )
{
    (void)state;
    const struct
    {
        int substeps, iterations;
        double gas, multiplier, virial;
    } row[] = { { 1, 20, -390, 23, 2867 },   { 1, 400, 131, 427, 2776 },   { 10, 10, 747, 918, 2674 },
                { 50, 1, 1253, 1331, 2593 }, { 100, 1, 2033, 2007, 2475 }, { 400, 1, 2440, 2383, 2417 } };
    for ( int n = 0; n < WISP_COUNT( row ); ++n )
    {
        balloon_oracle_options options = without_surroundings();
        options.velocity_decay = 30.0;
        options.substeps = row[n].substeps;
        options.iterations = row[n].iterations;
        balloon_oracle body = new_sphere( 1, 0.05, &options );
        body.bend_count = 0;
        body.gas_volume = 1.2 * body.rest_volume;
        steps( &body, 30 );
        double gas = balloon_oracle_gauge( &body, BALLOON_ORACLE_PRESSURE_GAS );
        double multiplier = balloon_oracle_gauge( &body, BALLOON_ORACLE_PRESSURE_MULTIPLIER );
        double virial = balloon_oracle_gauge( &body, BALLOON_ORACLE_PRESSURE_VIRIAL );
        double allowed = row[n].substeps >= 100 ? 0.02 * 2410.0 : 60.0;
        assert_close( gas, row[n].gas, allowed );
        assert_close( multiplier, row[n].multiplier, allowed );
        assert_close( virial / row[n].virial, 1.0, 0.01 );
        if ( row[n].substeps == 400 )
        {
            // the virial reads 3 (P - P_atm) V = sum T l, so this is also the check at rest
            assert_close( gas / virial, 1.0, 0.05 );
            assert_close( multiplier / virial, 1.0, 0.05 );
            assert_close( gas / multiplier, 1.0, 0.05 );
        }
        balloon_oracle_destroy( &body );
    }
}

// Fig. 3
static void a_soft_skin_takes_half_to_twice_its_rest_volume( void** state )
{
    (void)state;
    const double target[] = { 0.5, 1.0, 1.5, 2.0 };
    for ( int n = 0; n < 8; ++n )
    {
        balloon_oracle_options options = without_surroundings();
        options.volume = n < 4 ? BALLOON_ORACLE_VOLUME_XPBD : BALLOON_ORACLE_VOLUME_PBD;
        options.structural_k = 0.1;
        options.bend_k = 0.01;
        options.structural_stiffness = 20.0;
        options.bend_stiffness = 0.2;
        options.min_volume = 0.5;
        options.velocity_decay = 5.0;
        balloon_oracle body = new_sphere( 1, 0.02, &options );
        body.gas_volume = target[n % 4] * body.rest_volume;
        steps( &body, 60 );
        print_message( "%s target %.1f V_rest: V = %.4f V_rest\n", n < 4 ? "xpbd" : "pbd", target[n % 4],
                       body_volume_ratio( &body ) );
        assert_close( body_volume_ratio( &body ) / target[n % 4], 1.0, 0.01 );
        balloon_oracle_destroy( &body );
    }
}

// Section III.2
static void the_volume_follows_a_ramp_of_its_gas( void** state )
{
    (void)state;
    balloon_oracle_options options = without_surroundings();
    options.structural_stiffness = 200.0;
    options.bend_stiffness = 2.0;
    options.velocity_decay = 30.0;
    balloon_oracle body = new_sphere( 1, 0.02, &options );
    steps( &body, 10 );
    for ( int half = 0; half < 2; ++half )
    {
        body.options.inflow = ( half == 0 ? 0.3 : -0.3 ) * body.rest_volume;
        for ( int n = 0; n < 60; ++n )
        {
            balloon_oracle_step( &body );
            // so slow that the ramp is a series of equilibria
            assert_close( balloon_oracle_present_volume( &body ) / body.gas_volume, 1.0, 0.01 );
        }
        assert_close( body.gas_volume / body.rest_volume, half == 0 ? 1.3 : 1.0, 1e-12 );
    }
    body.options.inflow = -body.rest_volume;
    steps( &body, 10 );
    assert_true( body.gas_volume == body.rest_volume );
    balloon_oracle_destroy( &body );
}

// Gravity
static void a_balloon_in_a_vacuum_falls_as_a_stone( void** state )
{
    (void)state;
    balloon_oracle_options options = without_surroundings();
    options.use_gravity = true;
    balloon_oracle body = new_sphere( 1, 0.02, &options );
    steps( &body, 60 );
    for ( int i = 0; i < body.vertex_count; ++i )
    {
        assert_close( body.v[i].y, -9.8, 1e-9 );
    }
    // 600 substeps; each rounds positions of a few metres to 1e-15 m and divides by 1/600 s
    assert_close( body_momentum( &body ).y / body.total_mass, -9.8, 1e-10 );
    balloon_oracle_destroy( &body );
}

// Eq. 10
static void a_balloon_rises_only_when_its_lift_exceeds_its_skin( void** state )
{
    (void)state;
    balloon_oracle_options options = balloon_oracle_default_options();
    balloon_oracle probe = new_sphere( 2, 1.0, &options );
    double difference = balloon_oracle_density( 101325.0, BALLOON_ORACLE_AIR, 293.15 ) -
                        balloon_oracle_density( 101325.0, BALLOON_ORACLE_HELIUM, 293.15 );
    double floating = probe.rest_volume * difference / probe.total_mass;
    balloon_oracle_destroy( &probe );
    for ( int n = 0; n < 2; ++n )
    {
        balloon_oracle body = new_sphere( 2, ( n == 0 ? 0.99 : 1.01 ) * floating, &options );
        steps( &body, 30 );
        double y = body_centre( &body ).y;
        assert_true( n == 0 ? y > 1e-4 : y < -1e-4 );
        balloon_oracle_destroy( &body );
    }
}

// Eq. 11: a sphere of 3 g that keeps its shape
static void a_rigid_sphere_rises_at_its_terminal_speed( void** state )
{
    (void)state;
    double reference = balloon_oracle_true_terminal_speed( 0.15, 0.003, 9.8, 1.20410, 0.16639, 0.5 );
    assert_close( reference, 2.32, 5e-3 );
    balloon_oracle_options options = balloon_oracle_default_options();
    // the limit that keeps drag from reversing v decelerates less than the plain force: +2.4 % of speed at dt = 1/600
    // s, +0.2 % at 1/6000 s
    options.dt = 1.0 / 1200.0;
    options.substeps = 1;
    balloon_oracle body = new_sphere( 3, 0.003 / ( 4.0 * pi * 0.15 * 0.15 ), &options );
    for ( int n = 0; n < 480; ++n )
    {
        balloon_oracle_step( &body );
        // keep the shape: every vertex moves like the centre
        double3 v = double3_scale( 1.0 / body.total_mass, body_momentum( &body ) );
        for ( int i = 0; i < body.vertex_count; ++i )
        {
            body.v[i] = v;
        }
    }
    assert_close( body_momentum( &body ).y / body.total_mass / reference, 1.0, 0.02 );
    balloon_oracle_destroy( &body );
    assert_true( balloon_oracle_true_terminal_speed( 0.08, 0.003, 9.8, 1.20410, 0.16639, 0.5 ) == 0.0 );
}

// A light skin launched at 300 m/s with one substep per frame
static void drag_stops_a_thrown_balloon_and_does_not_throw_it_back( void** state )
{
    (void)state;
    for ( int limited = 0; limited < 2; ++limited )
    {
        balloon_oracle_options options = balloon_oracle_default_options();
        options.use_gravity = options.use_buoyancy = false;
        options.limit_drag = limited == 1;
        options.substeps = 1;
        balloon_oracle body = new_sphere( 1, 0.02, &options );
        for ( int i = 0; i < body.vertex_count; ++i )
        {
            body.v[i] = double3_make( 0.0, 300.0, 0.0 );
        }
        balloon_oracle_step( &body );
        double speed = body_momentum( &body ).y / body.total_mass;
        assert_true( limited == 1 ? speed > 0.0 && speed < 300.0 : speed < 0.0 );
        balloon_oracle_destroy( &body );
    }
}

// Sections III.2 and III.3
static void what_leaves_the_outlet_is_what_the_body_gains( void** state )
{
    (void)state;
    balloon_oracle_options options = without_surroundings();
    options.outlet_open = true;
    options.substeps = 1;
    options.iterations = 20;
    balloon_oracle body = new_pear( double3_make( 0.4, 1.0, 0.2 ), &options );
    body.gas_volume = 1.2 * body.rest_volume;
    double start = balloon_oracle_gas_amount( 101325.0, body.gas_volume, 293.15 );
    double gained = 0.0;
    for ( int n = 0; n < 60; ++n )
    {
        double floor_distance = body.gas_volume - body.rest_volume;
        balloon_oracle_step( &body );
        gained += double3_length( body.forces.jet ) * body.h;
        if ( body.jet_on && body.gas_volume > body.rest_volume )
        {
            assert_true( body.gas_volume < body.rest_volume + floor_distance );
            assert_close( double3_length( body.forces.jet ) / ( 2.0 * 1e-4 * body.gauge ), 1.0, 1e-12 );
        }
        assert_close( double3_distance( body_momentum( &body ), body.jet_impulse ) / fmax( gained, 1e-3 ), 0.0,
                      1e-12 );
    }
    double end = balloon_oracle_gas_amount( 101325.0, body.gas_volume, 293.15 );
    assert_true( body.gas_volume == body.rest_volume && gained > 1e-3 );
    assert_close( body.gas_lost / ( BALLOON_ORACLE_HELIUM * ( start - end ) ), 1.0, 1e-13 );
    balloon_oracle_destroy( &body );
}

// Reaction (section III.3) at constant pressure
static void a_jet_at_constant_pressure_has_the_impulse_of_its_closed_form( void** state )
{
    (void)state;
    double rho = balloon_oracle_density( 101325.0, BALLOON_ORACLE_HELIUM, 293.15 ), mass = 0.006, dt = 1e-3;
    double3 v = { 0.0, 0.0, 0.0 }, x = v;
    for ( int n = 0; n < 500; ++n )
    {
        double speed = balloon_oracle_outlet_speed( 2500.0, rho );
        double3 f = balloon_oracle_reaction( balloon_oracle_mass_flow( rho, 1e-4, speed ), speed,
                                             double3_make( 0.0, -1.0, 0.0 ) );
        x = balloon_oracle_predict( x, &v, 1.0 / mass, f, dt );
    }
    assert_close( mass * v.y / balloon_oracle_true_jet_impulse( 1e-4, 2500.0, 0.5 ), 1.0, 1e-6 );
}

// Fig. 4
static void the_four_external_forces_point_where_they_should( void** state )
{
    (void)state;
    balloon_oracle_options options = balloon_oracle_default_options();
    options.outlet_open = true;
    options.substeps = 1;
    balloon_oracle body = new_sphere( 2, 0.02, &options );
    body.gas_volume = 1.2 * body.rest_volume;
    double3 v = { 1.0, 2.0, -0.5 };
    for ( int i = 0; i < body.vertex_count; ++i )
    {
        body.x[i] = double3_scale( 1.05, body.x[i] );
        body.v[i] = v;
    }
    balloon_oracle_step( &body );
    const balloon_oracle_forces* f = &body.forces;
    print_message(
        "gravity (%.4f %.4f %.4f) buoyancy (%.4f %.4f %.4f) drag (%.4f %.4f %.4f) jet (%.4f %.4f %.4f) N\n",
        f->gravity.x, f->gravity.y, f->gravity.z, f->buoyancy.x, f->buoyancy.y, f->buoyancy.z, f->drag.x, f->drag.y,
        f->drag.z, f->jet.x, f->jet.y, f->jet.z );
    assert_close( f->gravity.y, -9.8 * body.total_mass, 1e-15 );
    assert_true( f->buoyancy.y > 0.0 && f->gravity.x == 0.0 && f->buoyancy.z == 0.0 );
    assert_close( double3_dot( f->drag, v ) / double3_length( f->drag ) / double3_length( v ), -1.0, 1e-3 );
    assert_close( double3_dot( f->jet, body.outlet_normal ) / double3_length( f->jet ), -1.0, 1e-12 );
    assert_close( double3_length( f->jet ), 2.0 * 1e-4 * body.gauge, 1e-12 );
    assert_true( body.gauge > 1000.0 );
    balloon_oracle_destroy( &body );
}

// Momentum (section II)
static void internal_constraints_keep_the_momentum_in_every_step( void** state )
{
    (void)state;
    for ( int mode = 0; mode < 2; ++mode )
    {
        balloon_oracle_options options = without_surroundings();
        options.volume = mode == 0 ? BALLOON_ORACLE_VOLUME_XPBD : BALLOON_ORACLE_VOLUME_PBD;
        options.substeps = 1;
        balloon_oracle body = new_pear( double3_make( 1.0, 0.0, 0.0 ), &options );
        body.gas_volume = 1.1 * body.rest_volume;
        double size = 0.0;
        for ( int i = 0; i < body.vertex_count; ++i )
        {
            body.v[i] = random_vector( i, 0 );
            size += body.mass[i] * double3_length( body.v[i] );
        }
        for ( int n = 0; n < 50; ++n )
        {
            double3 before = body_momentum( &body );
            balloon_oracle_step( &body );
            assert_close( double3_distance( body_momentum( &body ), before ) / size, 0.0, 1e-12 );
        }
        balloon_oracle_destroy( &body );
    }
}

static double pair_drift( double speed, double dt )
{
    const double w[2] = { 1.0, 1.0 };
    const int ends[2] = { 0, 1 };
    double3 x[2] = { { 0.5, 0.0, 0.0 }, { -0.5, 0.0, 0.0 } }, v[2] = { { 0.0, speed, 0.0 }, { 0.0, -speed, 0.0 } };
    double3 p[2], zero = { 0.0, 0.0, 0.0 };
    constraint_oracle_skips skips = { { 0 } };
    for ( int n = 0; n < (int)lround( 1.0 / dt ); ++n )
    {
        p[0] = balloon_oracle_predict( x[0], &v[0], 1.0, zero, dt );
        p[1] = balloon_oracle_predict( x[1], &v[1], 1.0, zero, dt );
        constraint_oracle_term term = constraint_oracle_distance( p[0], p[1], 1.0 );
        constraint_oracle_project( &term, ends, w, 1.0, p, &skips );
        for ( int i = 0; i < 2; ++i )
        {
            v[i] = balloon_oracle_velocity( x[i], p[i], dt );
            x[i] = p[i];
        }
    }
    return balloon_oracle_angular_momentum( x, v, w, 2, zero ).z / speed - 1.0;
}

// The printed figures are those of ends that move at 1 m/s, half a metre from the centre, which
// is 2 rad/s; at 1 rad/s the drift is a quarter. Both follow L = L0 / sqrt( 1 + 2 omega^2 dt t ) to first order.
static void the_angular_momentum_of_a_spinning_pair_drifts_in_proportion_to_dt( void** state )
{
    (void)state;
    const double dt[] = { 0.02, 0.01, 0.005 }, printed[] = { -0.071, -0.038, -0.019 };
    for ( int n = 0; n < 3; ++n )
    {
        assert_close( pair_drift( 1.0, dt[n] ), printed[n], 1e-3 );
        assert_close( pair_drift( 0.5, dt[n] ) / ( 1.0 / sqrt( 1.0 + 2.0 * dt[n] ) - 1.0 ), 1.0, 0.05 );
    }
}

// Spin of a body whose jet has ended
static void the_angular_momentum_of_a_spinning_balloon_drifts_less_with_more_substeps( void** state )
{
    (void)state;
    double drift[3];
    for ( int n = 0; n < 3; ++n )
    {
        balloon_oracle_options options = without_surroundings();
        options.substeps = 5 << n;
        options.iterations = 1;
        balloon_oracle body = new_pear( double3_make( 1.0, 0.0, 0.0 ), &options );
        double3 c = body_centre( &body );
        balloon_oracle_spin_kick( body.x, body.v, body.w, body.vertex_count, c, double3_make( 0.0, 3.0, 0.0 ) );
        double start = double3_length( body_angular_momentum( &body ) );
        steps( &body, 60 );
        drift[n] = 1.0 - double3_length( body_angular_momentum( &body ) ) / start;
        balloon_oracle_destroy( &body );
    }
    assert_true( drift[0] > 0.0 );
    // proportional to dt: halves, here within a fifth
    assert_close( drift[0] / drift[1], 2.0, 0.4 );
    assert_close( drift[1] / drift[2], 2.0, 0.4 );
}

// Fig. 5; section III.2: one start of the jet, no chatter
static void an_asymmetric_balloon_swells_empties_and_has_turned( void** state )
{
    (void)state;
    balloon_oracle_options options = balloon_oracle_default_options();
    options.velocity_decay = 0.5;
    balloon_oracle body = new_pear( double3_make( 1.0, 0.3, 0.2 ), &options );
    body.options.inflow = 1.2 * body.rest_volume;
    steps( &body, 15 );
    body.options.inflow = 0.0;
    steps( &body, 15 );
    double full = body_volume_ratio( &body );
    assert_true( full > 1.15 );
    assert_true( balloon_oracle_gauge( &body, BALLOON_ORACLE_PRESSURE_VIRIAL ) > 1000.0 );
    // drag has turned it a little on its way up; the jet turns it further and faster
    double turned_before = balloon_oracle_angle( body.q ), spin_before = double3_length( body.omega ), spin = 0.0;
    body.options.outlet_open = true;
    for ( int n = 0; n < 60; ++n )
    {
        balloon_oracle_step( &body );
        spin = fmax( spin, double3_length( body.omega ) );
    }
    assert_close( body.gas_volume / body.rest_volume, 1.0, 0.01 );
    assert_close( body_volume_ratio( &body ), 1.0, 0.02 );
    assert_true( balloon_oracle_angle( body.q ) > turned_before + 0.15 );
    assert_true( spin > 1.5 * spin_before );
    assert_false( body.jet_on );
    assert_int_equal( body.counters.jet_starts, 1 );
    assert_int_equal( body.counters.clamped_volumes + body.counters.silent_outlets + body.counters.fast_outlets, 0 );
    assert_int_equal( body.counters.skips.count[CONSTRAINT_ORACLE_ZERO_LENGTH], 0 );
    balloon_oracle_destroy( &body );
}

// Fig. 6
static void four_tagged_vertices_leave_tracks_and_the_spin_grows_with_the_outflow( void** state )
{
    (void)state;
    double last_peak = 0.0, last_track[4] = { 0.0, 0.0, 0.0, 0.0 };
    for ( int n = 0; n < 4; ++n )
    {
        balloon_oracle_options options = without_surroundings();
        options.outlet_area = 0.25e-4 * ( 1 << n );
        balloon_oracle body = new_pear( double3_make( 1.0, 0.3, 0.2 ), &options );
        body.gas_volume = 1.2 * body.rest_volume;
        body.options.velocity_decay = 30.0;
        steps( &body, 20 );
        body.options.velocity_decay = 0.0;
        body.options.outlet_open = true;
        const int tagged[4] = { 0, 40, 80, 120 };
        double track[4] = { 0.0, 0.0, 0.0, 0.0 }, peak = 0.0;
        for ( int k = 0; k < 12; ++k )
        {
            double3 before[4];
            for ( int t = 0; t < 4; ++t )
            {
                before[t] = body.x[tagged[t]];
            }
            balloon_oracle_step( &body );
            for ( int t = 0; t < 4; ++t )
            {
                track[t] += double3_distance( before[t], body.x[tagged[t]] );
            }
            peak = fmax( peak, double3_length( body.omega ) );
        }
        print_message( "outlet %.2e m^2: peak spin %.2f rad/s, tracks %.3f %.3f %.3f %.3f m\n", options.outlet_area,
                       peak, track[0], track[1], track[2], track[3] );
        assert_true( peak > 1.1 * last_peak );
        for ( int t = 0; t < 4; ++t )
        {
            assert_true( track[t] > 0.03 && track[t] > 1.2 * last_track[t] );
            last_track[t] = track[t];
        }
        last_peak = peak;
        balloon_oracle_destroy( &body );
    }
}

// Fig. 7: an outlet at the top drives a released balloon down again
static void a_balloon_rises_until_it_is_released_and_turns_back_the_faster_the_fuller( void** state )
{
    (void)state;
    double last_speed = 0.0, last_spin = 0.0;
    for ( int n = 2; n <= 5; ++n )
    {
        balloon_oracle_options options = balloon_oracle_default_options();
        options.velocity_decay = 0.5;
        options.outlet_area = 2e-4;
        balloon_oracle body = new_pear( double3_make( 0.3, 1.0, 0.1 ), &options );
        body.options.inflow = 0.4 * n * body.rest_volume;
        steps( &body, 15 );
        body.options.inflow = 0.0;
        steps( &body, 15 );
        double rising = body_momentum( &body ).y / body.total_mass;
        assert_true( rising > 0.3 );
        assert_true( body_centre( &body ).y > 0.05 );
        body.options.outlet_open = true;
        double speed = 0.0, spin = 0.0;
        for ( int k = 0; k < 15; ++k )
        {
            balloon_oracle_step( &body );
            speed = fmin( speed, body_momentum( &body ).y / body.total_mass );
            spin = fmax( spin, double3_length( body.omega ) );
        }
        print_message( "fill %.1f: rises at %.2f m/s, released %.2f m/s, spin %.2f rad/s\n", 1.0 + 0.1 * n, rising,
                       speed, spin );
        assert_true( speed < last_speed && spin > last_spin );
        assert_true( speed < -0.5 );
        last_speed = speed;
        last_spin = spin;
        balloon_oracle_destroy( &body );
    }
}

// The printed form turns positions and keeps velocities, so the particles do not receive the spin
static void the_printed_spin_turns_positions_and_gives_hardly_any_angular_momentum( void** state )
{
    (void)state;
    double momentum[2];
    for ( int mode = 0; mode < 2; ++mode )
    {
        balloon_oracle_options options = without_surroundings();
        options.spin = mode == 0 ? BALLOON_ORACLE_SPIN_KICK : BALLOON_ORACLE_SPIN_PRINTED;
        options.outlet_open = true;
        balloon_oracle body = new_pear( double3_make( 1.0, 0.3, 0.2 ), &options );
        body.gas_volume = 1.2 * body.rest_volume;
        steps( &body, 10 );
        assert_true( double3_length( body.omega ) > 1.0 );
        assert_true( balloon_oracle_angle( body.q ) > 0.1 );
        momentum[mode] = double3_length( body_angular_momentum( &body ) );
        balloon_oracle_destroy( &body );
    }
    // the remainder comes from the skin, which swings while it empties; measured 0.10 of the kick's
    assert_true( momentum[1] < 0.2 * momentum[0] );
}

// V <= 0 after a collapse, with a vertex pinned all the time
static void a_collapsed_balloon_stays_finite_and_says_so( void** state )
{
    (void)state;
    const balloon_oracle_reading readings[] = { BALLOON_ORACLE_PRESSURE_GAS, BALLOON_ORACLE_PRESSURE_MULTIPLIER,
                                                BALLOON_ORACLE_PRESSURE_VIRIAL };
    for ( int n = 0; n < 6; ++n )
    {
        balloon_oracle_options options = balloon_oracle_default_options();
        options.volume = n < 3 ? BALLOON_ORACLE_VOLUME_XPBD : BALLOON_ORACLE_VOLUME_PBD;
        options.pressure = readings[n % 3];
        options.outlet_open = true;
        balloon_oracle body = new_sphere( 1, 0.02, &options );
        for ( int i = 0; i < body.vertex_count; ++i )
        {
            body.x[i] = double3_make( 0.0, 0.0, 0.0 );
        }
        body.w[7] = 0.0;
        steps( &body, 20 );
        assert_true( body.counters.clamped_volumes > 0 );
        assert_true( body.counters.zero_normals > 0 );
        assert_true( body.counters.skips.count[CONSTRAINT_ORACLE_ZERO_LENGTH] > 0 );
        assert_true( body.counters.skips.count[CONSTRAINT_ORACLE_ZERO_GRADIENT] > 0 );
        assert_true( double3_length( body.x[7] ) == 0.0 );
        for ( int i = 0; i < body.vertex_count; ++i )
        {
            assert_true( isfinite( double3_length( body.x[i] ) ) && isfinite( double3_length( body.v[i] ) ) );
        }
        balloon_oracle_destroy( &body );
    }
}

static void the_same_run_gives_the_same_bits( void** state )
{
    (void)state;
    balloon_oracle_options options = balloon_oracle_default_options();
    options.outlet_open = true;
    balloon_oracle body[2];
    for ( int n = 0; n < 2; ++n )
    {
        body[n] = new_pear( double3_make( 1.0, 0.3, 0.2 ), &options );
        body[n].gas_volume = 1.2 * body[n].rest_volume;
        steps( &body[n], 10 );
    }
    assert_memory_equal( body[0].x, body[1].x, (size_t)body[0].vertex_count * sizeof( double3 ) );
    balloon_oracle_destroy( &body[0] );
    balloon_oracle_destroy( &body[1] );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( the_three_pressure_readings_follow_the_table_of_the_specification ),
        cmocka_unit_test( a_soft_skin_takes_half_to_twice_its_rest_volume ),
        cmocka_unit_test( the_volume_follows_a_ramp_of_its_gas ),
        cmocka_unit_test( a_balloon_in_a_vacuum_falls_as_a_stone ),
        cmocka_unit_test( a_balloon_rises_only_when_its_lift_exceeds_its_skin ),
        cmocka_unit_test( a_rigid_sphere_rises_at_its_terminal_speed ),
        cmocka_unit_test( drag_stops_a_thrown_balloon_and_does_not_throw_it_back ),
        cmocka_unit_test( what_leaves_the_outlet_is_what_the_body_gains ),
        cmocka_unit_test( a_jet_at_constant_pressure_has_the_impulse_of_its_closed_form ),
        cmocka_unit_test( the_four_external_forces_point_where_they_should ),
        cmocka_unit_test( internal_constraints_keep_the_momentum_in_every_step ),
        cmocka_unit_test( the_angular_momentum_of_a_spinning_pair_drifts_in_proportion_to_dt ),
        cmocka_unit_test( the_angular_momentum_of_a_spinning_balloon_drifts_less_with_more_substeps ),
        cmocka_unit_test( an_asymmetric_balloon_swells_empties_and_has_turned ),
        cmocka_unit_test( four_tagged_vertices_leave_tracks_and_the_spin_grows_with_the_outflow ),
        cmocka_unit_test( a_balloon_rises_until_it_is_released_and_turns_back_the_faster_the_fuller ),
        cmocka_unit_test( the_printed_spin_turns_positions_and_gives_hardly_any_angular_momentum ),
        cmocka_unit_test( a_collapsed_balloon_stays_finite_and_says_so ),
        cmocka_unit_test( the_same_run_gives_the_same_bits ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
