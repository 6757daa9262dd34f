// The oracle of guide hair is sound: centres, gradients, weights and curves by closed forms, and each printed form beside its
// resolution. Numbers of equations, figures and sections are those of Park and Kim 2024.
#include "guide_oracle_fixture.h"

static guide_oracle_def def_of( const scene* s )
{
    return ( guide_oracle_def ){ s->target_count, NODES, s->ghost_count, NODES, s->target, s->ghost, NULL };
}

static guide_oracle make_hair( const scene* s, const guide_oracle_options* options )
{
    guide_oracle_def def = def_of( s );
    guide_oracle hair;
    wisp_error error = { 0 };
    assert_ok( guide_oracle_create( &def, options, &hair, &error ), error );
    return hair;
}

static guide_oracle_options options_without_weights( void )
{
    guide_oracle_options options = guide_oracle_default_options();
    options.elastic_gain = options.tip_gain = options.centre_gain = 0.0;
    return options;
}

static double3 ghost_mean( const guide_oracle* hair, const double3* ghosts, int a, int i )
{
    double3 sum = zero;
    int count = 0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( hair->link[g * hair->options.link_count] == a )
        {
            sum = double3_add( sum, ghosts[g * hair->node_count + i] );
            count += 1;
        }
    }
    return double3_scale( 1.0 / count, sum );
}

// Fig. 1; section III.1
TEST( without_weights_the_centre_is_the_target_and_ghosts_move_as_a_block )
{
    scene s = make_scene( 2, 5 );
    const guide_oracle_options options = options_without_weights();
    guide_oracle hair = make_hair( &s, &options );
    double3 apart[MAX_GHOSTS * NODES];
    for ( int n = 0; n < s.ghost_count * NODES; ++n )
    {
        apart[n] = double3_sub( hair.y[n], s.target[n / NODES / 5 * NODES + n % NODES] );
    }
    for ( int frame = 0; frame < 60; ++frame )
    {
        swing( &s, 5 );
        step( &hair, s.x, s.v );
        for ( int n = 0; n < 2 * NODES; ++n )
        {
            assert_at( ghost_mean( &hair, hair.y, n / NODES, n % NODES ), s.x[n], 1e-12 );
        }
        for ( int n = 0; n < s.ghost_count * NODES; ++n )
        {
            assert_at( double3_sub( hair.y[n], s.x[n / NODES / 5 * NODES + n % NODES] ), apart[n], 1e-12 );
        }
    }
    guide_oracle_destroy( &hair );
}

// Eq. 2-3
TEST( the_spread_gradient_is_the_difference_quotient_of_the_energy )
{
    for ( int round = 0; round < 20; ++round )
    {
        double3 d[6], gradient[6], sum = zero;
        for ( int l = 0; l < 6; ++l )
        {
            d[l] = random_vector( round, l );
        }
        double v = guide_oracle_spread( d, 6 ), requested = random_between( round, 90, 0.3, 3.0 ) * v, largest = 0.0;
        guide_oracle_spread_gradient( 7.0, d, 6, requested, gradient );
        for ( int l = 0; l < 6; ++l )
        {
            largest = fmax( largest, double3_length( gradient[l] ) );
            sum = double3_add( sum, gradient[l] );
        }
        for ( int n = 0; n < 18; ++n )
        {
            double* coordinate = n % 3 == 0 ? &d[n / 3].x : n % 3 == 1 ? &d[n / 3].y : &d[n / 3].z;
            double analytic = n % 3 == 0 ? gradient[n / 3].x : n % 3 == 1 ? gradient[n / 3].y : gradient[n / 3].z;
            double kept = *coordinate, h = 1e-5;
            *coordinate = kept + h;
            double above = guide_oracle_spread_energy( 7.0, guide_oracle_spread( d, 6 ), requested );
            *coordinate = kept - h;
            double below = guide_oracle_spread_energy( 7.0, guide_oracle_spread( d, 6 ), requested );
            *coordinate = kept;
            assert_close( ( above - below ) / ( 2.0 * h ) / largest, analytic / largest, 1e-6 );
        }
        assert_close( double3_length( sum ) / largest, 0.0, 1e-12 );
    }
}

// Eq. 2-3
TEST( one_exact_projection_reaches_the_requested_spread_and_moves_nothing_in_sum )
{
    const double ratio[3] = { 0.25, 1.0, 2.5 };
    for ( int n = 0; n < 3; ++n )
    {
        double3 start[5], exact[5], sum = zero;
        for ( int l = 0; l < 5; ++l )
        {
            start[l] = exact[l] = double3_add( random_vector( n, l ), double3_make( 3.0, 1.0, -2.0 ) );
        }
        const double requested = ratio[n] * guide_oracle_spread( start, 5 );
        assert_int_equal( guide_oracle_spread_project( exact, 5, requested, true ), GUIDE_ORACLE_SPREAD_SOUND );
        assert_ratio( guide_oracle_spread( exact, 5 ), requested, 1e-12 );
        for ( int l = 0; l < 5; ++l )
        {
            sum = double3_add( sum, double3_sub( exact[l], start[l] ) );
        }
        assert_close( double3_length( sum ), 0.0, 1e-12 );
    }
}

// Eq. 4. |v|^2 is 1.69: the literal form leaves [0, 1] and has a unit.
TEST( the_elastic_weight_is_nothing_in_steady_motion_and_all_at_reversal )
{
    const guide_oracle_elastic change = GUIDE_ORACLE_ELASTIC_CHANGE, cosine = GUIDE_ORACLE_ELASTIC_PRINTED_COS,
                               raw = GUIDE_ORACLE_ELASTIC_PRINTED_RAW;
    const double3 v = { 0.3, -1.2, 0.4 }, back = double3_scale( -2.0, v ), slow = { 0.0, 9e-7, 0.0 };
    assert_close( guide_oracle_elastic_weight( change, v, v ), 0.0, 1e-15 );
    assert_close( guide_oracle_elastic_weight( change, v, back ), 1.0, 1e-15 );
    assert_close( guide_oracle_elastic_weight( raw, v, v ), 0.5 * 1.69 + 0.5, 1e-15 );
    assert_close( guide_oracle_elastic_weight( raw, v, back ), -1.69 + 0.5, 1e-15 );
    for ( int n = 0; n < 1000; ++n )
    {
        const double3 a = random_vector( n, 0 ), b = random_vector( n, 1 );
        const double w = guide_oracle_elastic_weight( change, a, b );
        assert_close( w, 0.5 - 0.5 * cos( double3_angle( a, b ) ), 1e-15 );
        assert_close( w + guide_oracle_elastic_weight( cosine, a, b ), 1.0, 1e-15 );
    }
    // section 4.3: below a micrometre a second there is no direction
    assert_true( guide_oracle_elastic_weight( change, v, slow ) == 0.0 );
    assert_true( guide_oracle_elastic_weight( cosine, slow, v ) == 0.5 );
}

// Eq. 5, Fig. 2: by the elastic weight alone four ghosts move alike, the centre weight moves them apart.
TEST( a_ghost_is_displaced_by_tau_v_times_its_weights_and_its_root_is_not )
{
    for ( int alone = 0; alone < 2; ++alone )
    {
        scene s = make_scene( 2, 4 );
        guide_oracle_options options = guide_oracle_default_options();
        options.cap_offset = false;
        options.tau = 0.03;
        options.tip_gain = options.centre_gain = alone == 1 ? 0.0 : 0.5;
        guide_oracle hair = make_hair( &s, &options );
        double3 v0[2 * NODES], v[2 * NODES];
        for ( int n = 0; n < 2 * NODES; ++n )
        {
            v0[n] = random_vector( 1, n );
            v[n] = random_vector( 2, n );
        }
        step( &hair, s.target, v0 );
        step( &hair, s.target, v );
        for ( int n = 0; n < 8 * NODES; ++n )
        {
            int i = n % NODES, a = n / NODES / 4, k = a * NODES + i;
            double w = guide_oracle_elastic_weight( GUIDE_ORACLE_ELASTIC_CHANGE, v[k], v0[k] );
            double3 c = ghost_mean( &hair, hair.b, a, i );
            double apart = i / 9.0 + double3_distance( hair.b[n], c ) / hair.largest[a];
            double3 expected = i == 0 ? zero : double3_scale( 0.03 * ( w + options.tip_gain * apart ), v[k] );
            assert_at( double3_sub( hair.y[n], hair.b[n] ), expected, 1e-14 );
            assert_at( hair.b[n], double3_add( s.target[k], hair.offset[n] ), 1e-15 );
        }
        guide_oracle_destroy( &hair );
    }
}

// Eq. 6
TEST( bezier_weights_sum_to_one_and_the_printed_ones_fall_short )
{
    double most = 0.0, max_at = 0.0;
    for ( int n = 0; n <= 300; ++n )
    {
        double t = n / 300.0, w[4], p[4];
        guide_oracle_bezier_weights( t, false, w );
        guide_oracle_bezier_weights( t, true, p );
        assert_close( w[0] + w[1] + w[2] + w[3], 1.0, 1e-15 );
        for ( int k = 0; k < 4; ++k )
        {
            assert_true( w[k] >= 0.0 );
            assert_true( k == 1 || p[k] == w[k] );
        }
        double deficit = 1.0 - ( p[0] + p[1] + p[2] + p[3] );
        assert_close( deficit, ( 1.0 - t ) * ( 1.0 - t ) * t, 1e-15 );
        max_at = deficit > most ? t : max_at;
        most = fmax( most, deficit );
    }
    assert_close( most, 4.0 / 27.0, 1e-15 );
    assert_close( max_at, 1.0 / 3.0, 1e-15 );
}

// Eq. 6
TEST( a_bezier_curve_has_its_ends_stays_in_its_hull_and_moves_with_the_scene )
{
    double3 shift = { 5.0, -3.0, 2.0 };
    for ( int n = 0; n < 100; ++n )
    {
        double3 x[4], moved[4];
        for ( int k = 0; k < 4; ++k )
        {
            x[k] = random_vector( n, k );
            moved[k] = double3_add( x[k], shift );
        }
        assert_at( guide_oracle_bezier( x, 0.0, false ), x[0], 0.0 );
        assert_at( guide_oracle_bezier( x, 1.0, false ), x[3], 0.0 );
        double t = random_between( n, 60, 0.05, 0.95 );
        double3 b = guide_oracle_bezier( x, t, false );
        for ( int m = 0; m < 20; ++m )
        {
            double3 way = random_vector( n, 20 + m );
            double farthest = double3_dot( way, x[0] );
            for ( int k = 1; k < 4; ++k )
            {
                farthest = fmax( farthest, double3_dot( way, x[k] ) );
            }
            assert_true( double3_dot( way, b ) <= farthest + 1e-15 );
        }
        double3 along = double3_sub( guide_oracle_bezier( moved, t, false ), b );
        assert_at( along, shift, 1e-14 );
        // the printed curve falls short by its deficit
        along = double3_sub( guide_oracle_bezier( moved, t, true ), guide_oracle_bezier( x, t, true ) );
        assert_at( double3_sub( shift, along ), double3_scale( ( 1.0 - t ) * ( 1.0 - t ) * t, shift ), 1e-14 );
    }
}

static void random_strand( int n, int count, double3* nodes )
{
    nodes[0] = random_vector( n, 50 );
    for ( int i = 1; i < count; ++i )
    {
        double3 way = double3_add( double3_make( 0.0, -1.0, 0.0 ), double3_scale( 0.7, random_vector( n, i ) ) );
        nodes[i] = double3_add( nodes[i - 1], double3_scale( segment, way ) );
    }
}

// Section II.2.2
TEST( the_spline_passes_through_its_nodes_with_one_derivative )
{
    for ( int n = 0; n < 50; ++n )
    {
        double3 nodes[8], controls[4 * 7];
        random_strand( n, 8, nodes );
        guide_oracle_curve_controls( nodes, 8, GUIDE_ORACLE_CURVE_SMOOTH, controls );
        for ( int k = 0; k < 7; ++k )
        {
            assert_at( guide_oracle_spline( nodes, 8, k, 0.0 ), nodes[k], 0.0 );
            assert_at( guide_oracle_spline( nodes, 8, k, 1.0 ), nodes[k + 1], 0.0 );
            if ( k > 0 )
            {
                assert_at( guide_oracle_spline_slope( nodes, 8, k - 1, 1.0 ),
                           guide_oracle_spline_slope( nodes, 8, k, 0.0 ), 1e-15 );
            }
            double u = random_between( n, k, 0.01, 0.99 ), h = 1e-5;
            double3 quotient = double3_scale( 0.5 / h, double3_sub( guide_oracle_spline( nodes, 8, k, u + h ),
                                                                    guide_oracle_spline( nodes, 8, k, u - h ) ) );
            // a third derivative of 0.1 m times h^2, and rounding of 1e-16 m over h
            assert_at( quotient, guide_oracle_spline_slope( nodes, 8, k, u ), 1e-10 );
            // the Bezier form is the same curve
            assert_at( guide_oracle_bezier( controls + 4 * k, u, false ), guide_oracle_spline( nodes, 8, k, u ),
                       1e-15 );
        }
        // ends by one-sided differences
        assert_at( guide_oracle_tangent( nodes, 8, 0 ), double3_sub( nodes[1], nodes[0] ), 0.0 );
        assert_at( guide_oracle_tangent( nodes, 8, 7 ), double3_sub( nodes[7], nodes[6] ), 0.0 );
        assert_at( guide_oracle_tangent( nodes, 8, 3 ), double3_scale( 0.5, double3_sub( nodes[4], nodes[2] ) ),
                   0.0 );
    }
}

// Section II.2.2: four conditions, so that any cubic motion is reproduced exactly
TEST( between_frames_a_node_keeps_its_positions_and_velocities )
{
    const double dt = 1.0 / 30.0;
    for ( int n = 0; n < 50; ++n )
    {
        const double3 x = random_vector( n, 0 ), v = random_vector( n, 1 ), a = random_vector( n, 2 ),
                      j = random_vector( n, 3 );
        double3 place[3], velocity[3];
        const double u[3] = { 0.0, 1.0, random_between( n, 30, 0.0, 1.0 ) };
        for ( int k = 0; k < 3; ++k )
        {
            const double t = u[k] * dt;
            place[k] = double3_add( double3_add( x, double3_scale( t, v ) ),
                                    double3_add( double3_scale( t * t, a ), double3_scale( t * t * t, j ) ) );
            velocity[k] =
                double3_add( v, double3_add( double3_scale( 2.0 * t, a ), double3_scale( 3.0 * t * t, j ) ) );
        }
        for ( int k = 0; k < 3; ++k )
        {
            assert_at( guide_oracle_between_frames( place[0], velocity[0], place[1], velocity[1], dt, u[k] ),
                       place[k], 1e-15 );
            assert_at( guide_oracle_velocity_between_frames( place[0], velocity[0], place[1], velocity[1], dt, u[k] ),
                       velocity[k], 1e-13 );
        }
    }
}

// The ghosts of a straight target, `count` nodes each, around it.
static void straight_ghosts( int ghost_count, int count, double3* ghosts )
{
    for ( int n = 0; n < ghost_count * count; ++n )
    {
        // four in a square: their mean is the target
        double angle = 0.7 + 0.5 * pi * ( n / count );
        ghosts[n] = double3_make( 0.005 * cos( angle ), 1.0 - segment * ( NODES - 1 ) * ( n % count ) / ( count - 1 ),
                                  0.005 * sin( angle ) );
    }
}

static double ghost_turn( const guide_oracle* hair )
{
    double largest = 0.0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        largest = fmax( largest, guide_oracle_largest_turn( hair->y + g * hair->node_count, hair->node_count ) );
    }
    return largest;
}

// GUI-X1: twice the nodes by spline turn no more than node to node, by nearest particle they kink. The elastic and the centre
// weight are off: they do not vanish towards the pinned root, so that its first segment turns the farther the shorter it is.
TEST( twice_the_nodes_kink_by_nearest_pairing_and_not_by_spline )
{
    scene s = make_scene( 1, 1 );
    double3 ghosts[4 * 2 * NODES];
    guide_oracle hair[3];
    straight_ghosts( 1, NODES, s.target );
    for ( int i = 0; i < NODES; ++i )
    {
        s.target[i].x = s.target[i].z = 0.0;
        s.x[i] = s.target[i];
    }
    for ( int p = 0; p < 3; ++p )
    {
        guide_oracle_options options = options_without_weights();
        options.tip_gain = 1.0;
        options.pairing = (guide_oracle_pairing)p;
        const int count = p == GUIDE_ORACLE_PAIRING_NODE ? NODES : 2 * NODES;
        straight_ghosts( 4, count, ghosts );
        const guide_oracle_def def = { 1, NODES, 4, count, s.target, ghosts, NULL };
        assert_int_equal( guide_oracle_create( &def, &options, &hair[p], NULL ), WISP_OK );
    }
    double kink = 0.0;
    for ( int frame = 0; frame < 90; ++frame )
    {
        swing( &s, 20 );
        for ( int p = 0; p < 3; ++p )
        {
            step( &hair[p], s.x, s.v );
        }
        const double plain = ghost_turn( &hair[GUIDE_ORACLE_PAIRING_NODE] );
        assert_true( ghost_turn( &hair[GUIDE_ORACLE_PAIRING_SPLINE] ) <= plain );
        kink = fmax( kink, ghost_turn( &hair[GUIDE_ORACLE_PAIRING_NEAREST] ) - plain );
    }
    assert_true( kink > 0.2 );
    for ( int p = 0; p < 3; ++p )
    {
        guide_oracle_destroy( &hair[p] );
    }
}

// GUI-X5
TEST( ghosts_of_a_turned_head_stay_on_their_side_only_with_frames )
{
    scene s = make_scene( 2, 4 );
    guide_oracle_rotation turn = guide_oracle_turn_about( double3_make( 0.0, 1.0, 0.0 ), pi );
    guide_oracle_rotation heads[2] = { turn, turn }, given[2 * NODES];
    for ( int n = 0; n < 2 * NODES; ++n )
    {
        s.x[n] = guide_oracle_rotate( &turn, s.target[n] );
        given[n] = turn;
    }
    for ( int frame = 0; frame < 3; ++frame )
    {
        guide_oracle_options options = options_without_weights();
        options.frame = (guide_oracle_frame)frame;
        guide_oracle hair = make_hair( &s, &options );
        double3 start[8 * NODES];
        memcpy( start, hair.y, sizeof( start ) );
        guide_oracle_motion motion = { s.x, s.v, frame == GUIDE_ORACLE_FRAME_GIVEN ? given : heads };
        assert_int_equal( guide_oracle_step( &hair, &motion, NULL ), WISP_OK );
        double farthest = 0.0;
        for ( int n = 0; n < 8 * NODES; ++n )
        {
            farthest = fmax( farthest, double3_distance( hair.y[n], guide_oracle_rotate( &turn, start[n] ) ) );
        }
        for ( int n = 0; n < 2 * NODES; ++n )
        {
            // The centre is kept for any frames: a rotation of offsets that sum to 0
            assert_at( ghost_mean( &hair, hair.y, n / NODES, n % NODES ), s.x[n], 1e-12 );
        }
        // without frames the farthest offset, 9 mm and its noise, ends on the other side
        assert_true( frame == GUIDE_ORACLE_FRAME_OFF ? farthest > 0.012 : farthest < 1e-14 );
        guide_oracle_destroy( &hair );
    }
}
