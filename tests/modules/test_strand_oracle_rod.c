// Elastic strands on their double-precision oracle: bending, its linear system, energy and its gradient. The closed
// forms are those of the table of references.
#include "strand_oracle_fixture.h"

// ---- closed forms ----

static void a_heavy_rod_sags_as_the_elastica( void** state )
{
    (void)state;
    static const struct
    {
        double g, drop, reach;
    } row[] = {
        { 1.0, 0.12347140, 0.99124640 },
        { 10.0, 0.70019972, 0.65635376 },
        { 100.0, 0.93752394, 0.15922338 },
    };
    for ( int k = 0; k < 12; ++k )
    {
        const double length = 0.1, dt = k < 6 ? 1.0 / 600.0 : 1.0 / 120.0, g = row[k % 3].g;
        const bool looks_back = k / 3 % 2 == 1;
        strand_oracle strand = new_straight( 64, length, true );
        // no limit: 64 vertices of G = 1 at 1/120 s are beyond it, and would sag by 80 % more
        strand_oracle_stiffen( &strand, line_density * 9.81 * pow( length, 3.0 ) / g, 0.0, true, 0.0 );
        strand_oracle_settings settings = rod_settings( dt );
        settings.looks_back = looks_back;
        settings.damping = 20.0;
        for ( int n = 0; n < (int)( 10.0 / dt ); ++n )
        {
            assert_false( strand_oracle_substep( &strand, &settings, NULL ) );
        }
        const double drop = -strand.position[63].y / length, reach = strand.position[63].x / length;
        print_message( "elastica G %g at 1/%g s%s: drop %+.3f %%, reach %+.3f %%\n", g, 1.0 / dt,
                       looks_back ? ", looking back" : "", 100.0 * ( drop / row[k % 3].drop - 1.0 ),
                       100.0 * ( reach / row[k % 3].reach - 1.0 ) );
        assert_close( drop / row[k % 3].drop, 1.0, 0.02 );
        assert_close( reach / row[k % 3].reach, 1.0, 0.02 );
    }
}

static double cantilever_error( double substeps_a_second )
{
    const double length = 0.1, frequency = 10.0, dt = 1.0 / substeps_a_second, omega = 2.0 * pi * frequency;
    strand_oracle strand = new_straight( 64, length, true );
    const double rigidity = omega * omega * line_density * pow( length, 4.0 ) / ( 3.51602 * 3.51602 );
    strand_oracle_stiffen( &strand, rigidity, 0.0, true, dt );
    for ( int i = 1; i < 64; ++i )
    {
        strand.velocity[i].y = 0.01 * i * i / ( 63.0 * 63.0 );
    }
    strand_oracle_settings settings = rod_settings( dt );
    settings.gravity = zero;
    double first = -1.0, last = -1.0, time = 0.0;
    int intersections = 0;
    while ( time < 0.6 )
    {
        const double before = strand.position[63].y;
        strand_oracle_substep( &strand, &settings, NULL );
        time += dt;
        const double now = strand.position[63].y;
        if ( before < 0.0 && now >= 0.0 )
        {
            last = time - dt * now / ( now - before );
            first = intersections == 0 ? last : first;
            intersections += 1;
        }
    }
    assert_true( intersections > 2 );
    return ( intersections - 1 ) / ( last - first ) / frequency - 1.0;
}

static void a_cantilever_swings_with_its_first_frequency( void** state )
{
    (void)state;
    for ( double rate = 1200.0; rate < 5000.0; rate *= 2.0 )
    {
        const double error = cantilever_error( rate );
        print_message( "cantilever of 10 Hz at %g substeps a second: %+.3f %%\n", rate, 100.0 * error );
        assert_close( error, 0.0, 0.02 );
    }
}

// ---- the linear system ----

static void solve_dense( int n, double* a, double3* b )
{
    for ( int i = 0; i < n; ++i )
    {
        int best = i;
        for ( int r = i + 1; r < n; ++r )
        {
            best = fabs( a[r * n + i] ) > fabs( a[best * n + i] ) ? r : best;
        }
        for ( int c = 0; c < n; ++c )
        {
            const double swapped = a[i * n + c];
            a[i * n + c] = a[best * n + c];
            a[best * n + c] = swapped;
        }
        const double3 right = b[i];
        b[i] = b[best];
        b[best] = right;
        for ( int r = i + 1; r < n; ++r )
        {
            const double fraction = a[r * n + i] / a[i * n + i];
            for ( int c = i; c < n; ++c )
            {
                a[r * n + c] -= fraction * a[i * n + c];
            }
            b[r] = double3_sub( b[r], double3_scale( fraction, b[i] ) );
        }
    }
    for ( int i = n - 1; i >= 0; --i )
    {
        for ( int c = i + 1; c < n; ++c )
        {
            b[i] = double3_sub( b[i], double3_scale( a[i * n + c], b[c] ) );
        }
        b[i] = double3_scale( 1.0 / a[i * n + i], b[i] );
    }
}

static void the_factor_solves_what_a_dense_elimination_solves( void** state )
{
    (void)state;
    static double matrix[32 * 32];
    for ( int k = 0; k < 8; ++k )
    {
        const double dt = 1.0 / 600.0, damping = k % 4 < 2 ? 0.0 : 2e-3;
        strand_oracle strand = new_curl( 32, 1.0, k % 2 == 0 );
        strand_oracle_stiffen( &strand, k < 4 ? 1e-8 : 1e-6, 0.0, k % 2 == 0, dt );
        strand_oracle_rest_straight( &strand );
        if ( k == 4 )
        {
            strand_oracle_pin( &strand, 9 );
        }
        const strand_oracle start = strand;
        double3 right[32];
        strand_oracle_rod_gradient( &strand, right );
        strand_oracle_rod_matrix( &strand, dt * dt + damping * dt, matrix );
        for ( int i = 0; i < 32; ++i )
        {
            const bool held = strand.weight[i] <= 0.0;
            right[i] = held ? zero : double3_scale( -dt * dt, right[i] );
            matrix[i * 32 + i] = held ? 1.0 : matrix[i * 32 + i];
        }
        solve_dense( 32, matrix, right );

        // previous equals the position, so that damping adds nothing to the right-hand side
        strand_oracle_rod_factor( &strand, damping, dt );
        strand_oracle_rod( &strand, damping, dt, NULL );
        double worst = 0.0, most = 0.0;
        for ( int i = 0; i < 32; ++i )
        {
            const double3 x = double3_sub( strand.position[i], start.position[i] );
            worst = fmax( worst, double3_distance( x, right[i] ) );
            most = fmax( most, double3_length( right[i] ) );
        }
        // of the strand's extent: positions carry the rounding
        assert_true( most > 1e-6 );
        assert_close( worst, 0.0, 1e-12 );
    }
}

static void stiffness_ends_where_single_precision_does( void** state )
{
    (void)state;
    const double dt = 1.0 / 60.0;
    strand_oracle strand = new_straight( 16, 0.15, true );
    strand_oracle_stiffen( &strand, 1e12, 1e3, true, dt );
    for ( int i = 0; i < 15; ++i )
    {
        // the tip is half as heavy as the others, and bends at the vertex before it
        const double mass = line_density * 0.01 * ( i == 14 ? 0.5 : 1.0 );
        assert_close( dt * dt * strand.stiffness[i] / ( mass * 0.01 * 0.01 ) / 6e4, 1.0, 1e-12 );
        assert_close( strand.twist_stiffness[i] * ( i == 0 ? 0.005 : 0.01 ), 1e3, 1e-9 );
    }
    strand_oracle_stiffen( &strand, 1e-9, 0.0, true, dt );
    assert_close( strand.stiffness[0] * 0.005, 1e-9, 1e-21 );
    assert_close( strand.stiffness[1] * 0.01, 1e-9, 1e-21 );
    strand_oracle_stiffen( &strand, 1e-9, 1e-9, false, dt );
    assert_close( strand.stiffness[0] + strand.twist_stiffness[0], 0.0, 0.0 );
}

static void damping_of_bending_brakes_it_and_leaves_what_does_not_bend_alone( void** state )
{
    (void)state;
    const double dt = 1.0 / 2400.0;
    double left[2], first = 0.0;
    for ( int k = 0; k < 2; ++k )
    {
        strand_oracle strand = new_straight( 32, 0.1, true );
        strand_oracle_stiffen( &strand, 1e-7, 0.0, true, dt );
        for ( int i = 1; i < 32; ++i )
        {
            strand.velocity[i].y = 0.01 * i * i / ( 31.0 * 31.0 );
        }
        first = kinetic( &strand );
        strand_oracle_settings settings = rod_settings( dt );
        settings.gravity = zero;
        settings.bend_damping = k == 0 ? 0.0 : 1e-2;
        steps( &strand, &settings, 960 );
        left[k] = kinetic( &strand ) + strand_oracle_rod_energy( &strand );
    }
    // energy falls as exp( -beta omega^2 t ), omega 44 / s of the first mode: 5e-4 after 0.4 s
    print_message( "damped bending: %.2g of the energy is left, %.2g undamped\n", left[1] / first, left[0] / first );
    assert_true( left[1] < 2e-3 * first );
    assert_true( left[0] > 0.5 * first );

    // a free strand that falls and drifts without bending does so with any damping
    strand_oracle strand = new_straight( 32, 0.1, false ), start = strand;
    strand_oracle_stiffen( &strand, 1e-7, 0.0, false, dt );
    for ( int i = 0; i < 32; ++i )
    {
        strand.velocity[i] = double3_make( 0.1, 0.2, 0.3 );
    }
    strand_oracle_settings settings = rod_settings( dt );
    settings.bend_damping = 1.0;
    steps( &strand, &settings, 240 );
    for ( int i = 0; i < 32; ++i )
    {
        const double3 way = double3_sub( strand.position[i], start.position[i] );
        const double3 reference = { 0.01, 0.02 - 9.81 * dt * dt * 240.0 * 241.0 / 2.0, 0.03 };
        assert_close( double3_distance( way, reference ), 0.0, 1e-12 );
    }
}

// ---- energy and its gradient ----

static double energy_at( const strand_oracle* strand, int vertex, int axis, double h )
{
    strand_oracle moved = *strand;
    double* coordinate[3] = { &moved.position[vertex].x, &moved.position[vertex].y, &moved.position[vertex].z };
    *coordinate[axis] += h;
    carry_frames( &moved );
    return strand_oracle_rod_energy( &moved );
}

// Largest difference between the rod's gradient and central differences, of the largest component.
static double gradient_error( const strand_oracle* strand )
{
    double3 gradient[MAX_STRAND_ORACLE];
    double worst = 0.0, most = 0.0;
    strand_oracle_rod_gradient( strand, gradient );
    for ( int i = 1; i < strand->count; ++i )
    {
        const double g[3] = { gradient[i].x, gradient[i].y, gradient[i].z };
        for ( int axis = 0; axis < 3; ++axis )
        {
            // h^2 / l^2 of truncation and 1e-16 l / h of rounding are both below 1e-9 at l = 1 cm
            const double h = 1e-7;
            const double slope = ( energy_at( strand, i, axis, h ) - energy_at( strand, i, axis, -h ) ) / ( 2.0 * h );
            worst = fmax( worst, fabs( slope - g[axis] ) );
            most = fmax( most, fabs( g[axis] ) );
        }
    }
    assert_true( most > 0.0 );
    return worst / most;
}

static void twist_changes_by_half_the_curvature_binormal( void** state )
{
    (void)state;
    for ( int key = 0; key < 8; ++key )
    {
        strand_oracle strand = new_curl( 6, 0.6, false );
        deform( &strand, 20 + key, 5e-3 );
        for ( int s = 0; s < 5; ++s ) // frames that are twisted already
        {
            const strand_oracle_quaternion turn =
                strand_oracle_about( double3_make( 0.0, 0.0, 1.0 ), random_between( key, s, -0.7, 0.7 ) );
            strand.frame[s] = strand_oracle_product( strand.frame[s], turn );
        }
        for ( int vertex = 1; vertex < 5; ++vertex )
        {
            const double3 a = double3_sub( strand.position[vertex], strand.position[vertex - 1] );
            const double3 b = double3_sub( strand.position[vertex + 1], strand.position[vertex] );
            const double3 ta = double3_scale( 1.0 / double3_length( a ), a );
            const double3 tb = double3_scale( 1.0 / double3_length( b ), b );
            const double3 kb = double3_scale( 2.0 / ( 1.0 + double3_dot( ta, tb ) ), double3_cross( ta, tb ) );
            for ( int side = -1; side <= 1; side += 2 )
            {
                const int moved = vertex + side; // the far end of the segment before, or behind
                const double length = double3_length( side < 0 ? a : b );
                const double3 reference = double3_scale( side / ( 2.0 * length ), kb );
                const double t[3] = { reference.x, reference.y, reference.z };
                for ( int axis = 0; axis < 3; ++axis )
                {
                    double twist[2];
                    for ( int k = 0; k < 2; ++k )
                    {
                        strand_oracle other = strand;
                        double* c[3] = { &other.position[moved].x, &other.position[moved].y,
                                         &other.position[moved].z };
                        *c[axis] += k == 0 ? 1e-7 : -1e-7;
                        carry_frames( &other );
                        twist[k] = strand_oracle_twist( &other, vertex );
                    }
                    assert_close( ( twist[0] - twist[1] ) / 2e-7, t[axis], 1e-6 * double3_length( reference ) );
                }
            }
        }
    }
}

static void the_gradient_is_that_of_the_energy_where_no_bend_twists( void** state )
{
    (void)state;
    // a plane curve with a rest curvature in its plane: b_i = T_i = 0
    strand_oracle plane = new_straight( 12, 0.12, true );
    strand_oracle_stiffen( &plane, 1e-7, 7e-8, true, 0.0 );
    for ( int i = 1; i < 12; ++i )
    {
        plane.position[i].y = 0.004 * i * i / 11.0;
    }
    deform( &plane, 30, 0.0 );
    strand_oracle_rest_shape( &plane );
    for ( int i = 1; i < 12; ++i )
    {
        plane.position[i].y += 0.01 * random_between( 31, i, -1.0, 1.0 );
    }
    deform( &plane, 32, 0.0 );
    const double in_plane = gradient_error( &plane );

    // straight at rest, bent and twisted: b_i = 0, T_i is not
    strand_oracle twisted = new_straight( 12, 0.12, true );
    strand_oracle_stiffen( &twisted, 1e-7, 7e-8, true, 0.0 );
    twisted.framed = true;
    deform( &twisted, 33, 0.005 );
    for ( int s = 0; s < 11; ++s )
    {
        const strand_oracle_quaternion turn =
            strand_oracle_about( double3_make( 0.0, 0.0, 1.0 ), random_between( 34, s, -0.5, 0.5 ) );
        twisted.frame[s] = strand_oracle_product( twisted.frame[s], turn );
    }
    const double with_twist = gradient_error( &twisted );
    print_message( "gradient: plane curve %.2g, twisted rod %.2g of the largest force\n", in_plane, with_twist );
    assert_true( in_plane < 1e-6 );
    assert_true( with_twist < 1e-6 );
}

// Rest curvature turns with its frames, and its reaction is exact where no vertex is twisted. The twist that holds
// the balance here leaves out a part of second order.
static void the_gradient_is_that_of_the_energy_of_a_curl_out_of_its_plane( void** state )
{
    (void)state;
    strand_oracle strand = new_curl( 12, 1.5, true );
    strand_oracle_stiffen( &strand, 1e-6, 7.5e-7, true, 0.0 );
    strand_oracle_rest_shape( &strand );
    deform( &strand, 35, 0.003 );
    settle_twist( &strand );
    const double error = gradient_error( &strand );
    print_message( "gradient: curl out of its plane %.2g of the largest force is left out\n", error );
    assert_true( error < 1e-3 );
}

// The axes of an elliptic section turn with its frames as rest curvature does; the tip is held.
static void the_gradient_is_that_of_the_energy_of_an_elliptic_section( void** state )
{
    (void)state;
    strand_oracle strand = new_curl( 12, 1.5, true );
    strand.flatness = 0.8;
    strand.guided = true;
    strand_oracle_stiffen( &strand, 1e-6, 7.5e-7, true, 0.0 );
    strand_oracle_rest_shape( &strand );
    deform( &strand, 35, 0.003 );
    settle_twist( &strand );
    const double error = gradient_error( &strand );
    print_message( "gradient: elliptic curl with a held tip %.2g of the largest force is left out\n", error );
    assert_true( error < 2e-3 );
    const double round = strand_oracle_rod_energy( &strand );
    strand.flatness = 0.0;
    assert_true( round < 0.9 * strand_oracle_rod_energy( &strand ) ); // it bends across its flat side
}

// Beyond 139 degrees rest curvature and twist fade with the fold, and the energy with them.
static void a_vertex_that_folds_back_has_the_gradient_of_its_energy( void** state )
{
    (void)state;
    for ( int k = 0; k < 12; ++k )
    {
        const int degrees = 140 + 5 * ( k / 2 );
        strand_oracle strand = new_straight( 4, 0.03, true );
        strand.flatness = k % 2 == 0 ? 0.0 : 0.7;
        strand_oracle_stiffen( &strand, 1e-6, 7.5e-7, true, 0.0 );
        const double3 axis = double3_make( 0.0, 0.0, 1.0 );
        const double3 e = double3_sub( strand.position[3], strand.position[2] );
        const strand_oracle_quaternion at_rest = strand_oracle_about( axis, 0.4 );
        strand.position[3] = double3_add( strand.position[2], strand_oracle_turned( at_rest, e ) );
        strand_oracle_rest_shape( &strand );
        // in the plane of the rest shape, so that no twist is in the way
        const strand_oracle_quaternion folded = strand_oracle_about( axis, degrees * 3.14159265358979 / 180.0 );
        strand.position[3] = double3_add( strand.position[2], strand_oracle_turned( folded, e ) );
        carry_frames( &strand );
        const double error = gradient_error( &strand );
        print_message( "gradient at a fold of %d degrees: %.2g of the largest force is left out\n", degrees, error );
        assert_true( error < 1e-6 );
    }
}

static void a_rigid_turn_of_a_curl_costs_no_energy( void** state )
{
    (void)state;
    strand_oracle strand = new_curl( 24, 2.0, false );
    strand_oracle_stiffen( &strand, 1e-7, 7.5e-8, false, 0.0 );
    strand_oracle_rest_shape( &strand );
    memset( strand.weight, 0, sizeof( strand.weight ) ); // it moves to its turned position
    strand_oracle_rod_factor( &strand, 0.0, 1e-3 );
    strand_oracle frozen = strand;
    const double3 axis = double3_scale( 1.0 / 3.0, double3_make( 1.0, 2.0, -2.0 ) );
    const strand_oracle_quaternion turn = strand_oracle_about( axis, 0.02 );
    for ( int k = 0; k < 100; ++k )
    {
        for ( int i = 0; i < strand.count; ++i )
        {
            strand.position[i] = strand_oracle_turned( turn, strand.position[i] );
        }
        strand_oracle_rod( &strand, 0.0, 1e-3, NULL );
    }
    // the same shape with frames that have not followed
    memcpy( frozen.position, strand.position, sizeof( strand.position ) );
    const double cost = strand_oracle_rod_energy( &strand ) / strand_oracle_rod_energy( &frozen );
    print_message( "two radians of a rigid turn cost %.2g of what they cost with frozen frames\n", cost );
    assert_true( cost < 1e-6 );
}

static void a_straight_rod_never_gains_energy( void** state )
{
    (void)state;
    for ( int k = 0; k < 6; ++k )
    {
        const double dt = k % 2 == 0 ? 1.0 / 60.0 : 1.0 / 600.0, rigidity = k < 2 ? 8e-9 : ( k < 4 ? 1e-6 : 1e-3 );
        strand_oracle strand = new_straight( 24, 0.2, true );
        strand_oracle_stiffen( &strand, rigidity, 0.0, true, dt );
        strand_oracle_settings settings = rod_settings( dt );
        settings.gravity = zero;
        settings.passes = 4;
        for ( int i = 1; i < strand.count; ++i )
        {
            const double s = i / 23.0;
            strand.velocity[i] = double3_make( 0.0, 0.02 * s * s, 0.01 * sin( 7.0 * s ) * s );
        }
        const double start = kinetic( &strand );
        double most = 0.0;
        for ( int n = 0; n < (int)( 2.0 / dt ); ++n )
        {
            strand_oracle_substep( &strand, &settings, NULL );
            most = fmax( most, kinetic( &strand ) + strand_oracle_rod_energy( &strand ) );
        }
        print_message( "straight rod EI %g, dt 1/%g: energy at most %.6f of the first\n", rigidity, 1.0 / dt,
                       most / start );
        assert_true( most <= start * ( 1.0 + 1e-12 ) );
    }
}

static void the_momentum_of_a_free_rod_is_constant( void** state )
{
    (void)state;
    for ( int curled = 0; curled < 2; ++curled )
    {
        const double dt = 1.0 / 600.0;
        strand_oracle strand = curled == 1 ? new_curl( 24, 2.0, false ) : new_straight( 24, 0.2, false );
        strand_oracle_stiffen( &strand, 8e-9, 6e-9, false, dt );
        if ( curled == 1 )
        {
            strand_oracle_rest_shape( &strand );
        }
        double3 start = zero, end = zero, spin = zero, spin_end = zero;
        for ( int i = 0; i < strand.count; ++i )
        {
            strand.velocity[i] =
                double3_add( double3_make( 0.05, 0.0, 0.0 ), double3_scale( 0.02, random_vector( 40, i ) ) );
            const double3 p = double3_scale( strand.mass[i], strand.velocity[i] );
            start = double3_add( start, p );
            spin = double3_add( spin, double3_cross( strand.position[i], p ) );
        }
        strand_oracle_settings settings = rod_settings( dt );
        settings.gravity = zero;
        settings.passes = 4;
        for ( int k = 0; k < 600; ++k )
        {
            assert_false( strand_oracle_substep( &strand, &settings, NULL ) );
        }
        for ( int i = 0; i < strand.count; ++i )
        {
            const double3 p = double3_scale( strand.mass[i], strand.velocity[i] );
            end = double3_add( end, p );
            spin_end = double3_add( spin_end, double3_cross( strand.position[i], p ) );
        }
        print_message( "free %s: momentum changes by %.2g, angular momentum by %.2g of itself\n",
                       curled == 1 ? "curl" : "rod", double3_distance( start, end ) / double3_length( start ),
                       double3_distance( spin, spin_end ) / double3_length( spin ) );
        assert_close( double3_distance( start, end ) / double3_length( start ), 0.0, 1e-12 );
    }
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_heavy_rod_sags_as_the_elastica ),
        cmocka_unit_test( a_cantilever_swings_with_its_first_frequency ),
        cmocka_unit_test( the_factor_solves_what_a_dense_elimination_solves ),
        cmocka_unit_test( stiffness_ends_where_single_precision_does ),
        cmocka_unit_test( damping_of_bending_brakes_it_and_leaves_what_does_not_bend_alone ),
        cmocka_unit_test( twist_changes_by_half_the_curvature_binormal ),
        cmocka_unit_test( the_gradient_is_that_of_the_energy_where_no_bend_twists ),
        cmocka_unit_test( the_gradient_is_that_of_the_energy_of_a_curl_out_of_its_plane ),
        cmocka_unit_test( the_gradient_is_that_of_the_energy_of_an_elliptic_section ),
        cmocka_unit_test( a_vertex_that_folds_back_has_the_gradient_of_its_energy ),
        cmocka_unit_test( a_rigid_turn_of_a_curl_costs_no_energy ),
        cmocka_unit_test( a_straight_rod_never_gains_energy ),
        cmocka_unit_test( the_momentum_of_a_free_rod_is_constant ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
