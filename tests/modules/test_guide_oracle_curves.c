// Curves of guide hair on their double-precision oracle: Eq. 6, splines along strands and in time, other node counts,
// frames. Numbers of equations, figures and sections are those of Park and Kim 2024.
#include "guide_oracle_fixture.h"

enum
{
    SAMPLES = 8,
    MAX_POINTS = 32 * SAMPLES + 1,
};

static void random_strand( int n, int count, double3* nodes )
{
    nodes[0] = random_vector( n, 50 );
    for ( int i = 1; i < count; ++i )
    {
        double3 way = double3_add( double3_make( 0.0, -1.0, 0.0 ), double3_scale( 0.7, random_vector( n, i ) ) );
        nodes[i] = double3_add( nodes[i - 1], double3_scale( segment, way ) );
    }
}

// Equal segments, each turned by `turn` against the previous one: always in the same direction, or alternately.
static void turned_strand( double turn, bool to_and_fro, int count, double3* nodes )
{
    double angle = 0.0;
    nodes[0] = double3_make( 0.1, 0.5, -0.2 );
    for ( int i = 1; i < count; ++i )
    {
        nodes[i] = double3_add( nodes[i - 1], double3_make( segment * sin( angle ), -segment * cos( angle ), 0.0 ) );
        angle += to_and_fro && i % 2 == 0 ? -turn : turn;
    }
}

static int draw( const double3* nodes, int count, guide_oracle_curve curve, double3* points )
{
    double3 controls[4 * 32];
    guide_oracle_curve_controls( nodes, count, curve, controls );
    return guide_oracle_draw( controls, guide_oracle_curve_count( count, curve ), SAMPLES, false, points );
}

// Distance of a point from the line through two others.
static double off_line( double3 p, double3 a, double3 b )
{
    double3 way = double3_sub( b, a );
    return double3_length( double3_cross( double3_sub( p, a ), way ) ) / double3_length( way );
}

// Eq. 6
static void bezier_weights_sum_to_one_and_the_printed_ones_fall_short( void** state )
{
    (void)state;
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
static void a_bezier_curve_has_its_ends_stays_in_its_hull_and_moves_with_the_scene( void** state )
{
    (void)state;
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

// Eq. 6
static void groups_share_their_ends_and_a_rest_is_a_quadratic_or_a_line( void** state )
{
    (void)state;
    const int groups[12] = { 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 4 };
    for ( int count = 0; count < 12; ++count )
    {
        // more nodes than the strand has: none of them may have an effect
        double3 nodes[16], controls[4 * 12], points[MAX_POINTS];
        random_strand( count, 16, nodes );
        int m = guide_oracle_curve_count( count, GUIDE_ORACLE_CURVE_GROUPS );
        assert_int_equal( m, groups[count] );
        guide_oracle_curve_controls( nodes, count, GUIDE_ORACLE_CURVE_GROUPS, controls );
        int drawn = guide_oracle_draw( controls, m, SAMPLES, false, points );
        assert_int_equal( drawn, m > 0 ? m * SAMPLES + 1 : 0 );
        for ( int k = 0; k < m; ++k )
        {
            int last = 3 * k + 3 < count ? 3 * k + 3 : count - 1;
            assert_at( points[SAMPLES * k], nodes[3 * k], 0.0 );
            assert_at( points[SAMPLES * ( k + 1 )], nodes[last], 0.0 );
            for ( int n = 0; n <= SAMPLES; ++n )
            {
                double t = (double)n / SAMPLES;
                const double3* x = nodes + 3 * k;
                double3 expected = guide_oracle_bezier( x, t, false );
                if ( last - 3 * k == 1 )
                {
                    expected = double3_add( double3_scale( 1.0 - t, x[0] ), double3_scale( t, x[1] ) );
                }
                if ( last - 3 * k == 2 )
                {
                    expected = double3_add(
                        double3_scale( ( 1.0 - t ) * ( 1.0 - t ), x[0] ),
                        double3_add( double3_scale( 2.0 * t * ( 1.0 - t ), x[1] ), double3_scale( t * t, x[2] ) ) );
                }
                assert_at( points[SAMPLES * k + n], expected, 1e-15 );
            }
        }
    }
}

static void straight_and_repeated_nodes_are_valid_curves( void** state )
{
    (void)state;
    for ( int count = 2; count <= 11; ++count )
    {
        double3 nodes[11], points[MAX_POINTS];
        double3 begin = { 0.3, 0.2, 0.1 }, way = { 0.6, -0.48, 0.64 };
        for ( int i = 0; i < count; ++i )
        {
            nodes[i] = double3_add( begin, double3_scale( 0.02 * i * i, way ) );
        }
        for ( int curve = 0; curve < 3; ++curve )
        {
            int drawn = draw( nodes, count, (guide_oracle_curve)curve, points );
            for ( int n = 0; n < drawn; ++n )
            {
                assert_close( off_line( points[n], begin, double3_add( begin, way ) ), 0.0, 1e-15 );
            }
        }
        for ( int i = 0; i < count; ++i )
        {
            nodes[i] = begin;
        }
        int drawn = draw( nodes, count, GUIDE_ORACLE_CURVE_GROUPS, points );
        for ( int n = 0; n < drawn; ++n )
        {
            assert_at( points[n], begin, 1e-15 );
        }
        assert_true( guide_oracle_largest_turn( nodes, count ) == 0.0 );
    }
}

// Fig. 3
static void drawn_curves_turn_less_sharply_than_their_strand_and_end_where_it_ends( void** state )
{
    (void)state;
    for ( int count = 4; count <= 10; count += 3 )
    {
        for ( int n = 1; n <= 10; ++n )
        {
            double turn = 0.15 * n;
            for ( int curve = 0; curve < 3; ++curve )
            {
                double3 nodes[10], points[MAX_POINTS];
                turned_strand( turn, true, count, nodes );
                int drawn = draw( nodes, count, (guide_oracle_curve)curve, points );
                assert_close( guide_oracle_largest_turn( nodes, count ), turn, 1e-13 );
                assert_true( guide_oracle_largest_turn( points, drawn ) < turn );
                assert_at( points[0], nodes[0], 0.0 );
                assert_at( points[drawn - 1], nodes[count - 1], 0.0 );
            }
        }
    }
}

static double turn_between( double3 a, double3 b, double3 c )
{
    return double3_angle( double3_sub( b, a ), double3_sub( c, b ) );
}

// The error at shared ends of groups, and the improvement by smooth curves
static void groups_keep_the_turn_of_a_shared_node_where_joined_and_smooth_curves_have_none( void** state )
{
    (void)state;
    for ( int n = 0; n < 50; ++n )
    {
        double3 nodes[10], group[4 * 3], joined[4 * 3], smooth[4 * 9];
        random_strand( n, 10, nodes );
        guide_oracle_curve_controls( nodes, 10, GUIDE_ORACLE_CURVE_JOINED, joined );
        guide_oracle_curve_controls( nodes, 10, GUIDE_ORACLE_CURVE_GROUPS, group );
        guide_oracle_curve_controls( nodes, 10, GUIDE_ORACLE_CURVE_SMOOTH, smooth );
        for ( int k = 1; k < 3; ++k )
        {
            // end tangents of a Bezier curve are along its outer control segments
            double3 in = double3_sub( group[4 * k - 1], group[4 * k - 2] ),
                    out = double3_sub( group[4 * k + 1], group[4 * k] );
            assert_close( double3_angle( in, out ), turn_between( nodes[3 * k - 1], nodes[3 * k], nodes[3 * k + 1] ),
                          1e-14 );
            // the same lengths on one line, along the neighbours of the node
            double3 before = double3_sub( joined[4 * k - 1], joined[4 * k - 2] ),
                    after = double3_sub( joined[4 * k + 1], joined[4 * k] );
            assert_close( double3_angle( before, after ), 0.0, 1e-14 );
            assert_close( double3_angle( before, double3_sub( nodes[3 * k + 1], nodes[3 * k - 1] ) ), 0.0, 1e-14 );
            assert_close( double3_length( before ), double3_length( in ), 1e-15 );
            assert_close( double3_length( after ), double3_length( out ), 1e-15 );
            assert_at( joined[4 * k], nodes[3 * k], 0.0 );
        }
        for ( int k = 1; k < 9; ++k )
        {
            double3 in = double3_sub( smooth[4 * k - 1], smooth[4 * k - 2] ),
                    out = double3_sub( smooth[4 * k + 1], smooth[4 * k] );
            assert_at( in, out, 1e-15 );
            assert_at( smooth[4 * k], nodes[k], 0.0 );
        }
    }
}

// Fig. 3 on strands that always turn the same way: arcs, and helices of a rising pitch. Groups that share nodes alone turn more at a
// joint than the strand: by its own turn there, and by half of what a sample of the curve turns on each side.
static void arcs_and_helices_turn_less_at_every_joint_by_all_curves_but_the_printed_one( void** state )
{
    (void)state;
    for ( int n = 0; n < 300; ++n )
    {
        const int count = 7 + n % 7;
        const double turn = 0.1 + 0.1 * ( n / 7 % 10 ), pitch = 0.004 * ( n / 70 );
        double3 nodes[13], points[MAX_POINTS];
        turned_strand( turn, false, count, nodes );
        for ( int i = 0; i < count; ++i )
        {
            nodes[i].z += pitch * i;
        }
        const double before = guide_oracle_largest_turn( nodes, count );
        for ( int curve = 0; curve < 3; ++curve )
        {
            int drawn = draw( nodes, count, (guide_oracle_curve)curve, points );
            const double after = guide_oracle_largest_turn( points, drawn );
            assert_true( curve == GUIDE_ORACLE_CURVE_GROUPS ? after > before : after < 0.75 * before );
            assert_at( points[0], nodes[0], 0.0 );
            assert_at( points[drawn - 1], nodes[count - 1], 0.0 );
        }
    }
}

// Section II.2.2
static void the_spline_passes_through_its_nodes_with_one_derivative( void** state )
{
    (void)state;
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

// Section II.2.2
static void between_frames_a_node_keeps_its_positions_and_velocities( void** state )
{
    (void)state;
    double dt = 1.0 / 30.0;
    for ( int n = 0; n < 50; ++n )
    {
        double3 x[3] = { random_vector( n, 0 ), random_vector( n, 1 ), random_vector( n, 2 ) };
        double3 v[3] = { random_vector( n, 3 ), random_vector( n, 4 ), random_vector( n, 5 ) };
        assert_at( guide_oracle_between_frames( x[0], v[0], x[1], v[1], dt, 0.0 ), x[0], 0.0 );
        assert_at( guide_oracle_between_frames( x[0], v[0], x[1], v[1], dt, 1.0 ), x[1], 0.0 );
        // C1 across a frame: both sides end with the node's own velocity
        double3 before = guide_oracle_velocity_between_frames( x[0], v[0], x[1], v[1], dt, 1.0 );
        double3 after = guide_oracle_velocity_between_frames( x[1], v[1], x[2], v[2], dt, 0.0 );
        assert_at( before, v[1], 1e-14 );
        assert_at( after, v[1], 1e-14 );

        // four conditions: any cubic motion is reproduced exactly, including free fall
        double3 a = random_vector( n, 6 ), j = random_vector( n, 7 );
        double u = random_between( n, 30, 0.0, 1.0 );
        double3 end = double3_add( double3_add( x[0], double3_scale( dt, v[0] ) ),
                                   double3_add( double3_scale( dt * dt, a ), double3_scale( dt * dt * dt, j ) ) );
        double3 end_v =
            double3_add( v[0], double3_add( double3_scale( 2.0 * dt, a ), double3_scale( 3.0 * dt * dt, j ) ) );
        double t = u * dt;
        double3 expected = double3_add( double3_add( x[0], double3_scale( t, v[0] ) ),
                                        double3_add( double3_scale( t * t, a ), double3_scale( t * t * t, j ) ) );
        double3 expected_v =
            double3_add( v[0], double3_add( double3_scale( 2.0 * t, a ), double3_scale( 3.0 * t * t, j ) ) );
        assert_at( guide_oracle_between_frames( x[0], v[0], end, end_v, dt, u ), expected, 1e-15 );
        assert_at( guide_oracle_velocity_between_frames( x[0], v[0], end, end_v, dt, u ), expected_v, 1e-13 );
    }
}

// Other node counts (extension)
static void a_stencil_is_the_spline_at_a_normalised_arc_length( void** state )
{
    (void)state;
    for ( int n = 0; n < 50; ++n )
    {
        double3 rest[7], present[7], moved[7];
        double arc[7];
        double3 shift = { 4.0, -2.0, 1.0 };
        random_strand( n, 7, rest );
        random_strand( n + 100, 7, present );
        guide_oracle_arc( rest, 7, arc );
        assert_true( arc[0] == 0.0 && arc[6] == 1.0 );
        for ( int i = 0; i < 7; ++i )
        {
            assert_true( i == 0 || arc[i] > arc[i - 1] );
            moved[i] = double3_add( present[i], shift );
            // at its own arc length a node is reproduced; rounding may start one interval later
            guide_oracle_stencil node = guide_oracle_spline_stencil( rest, 7, arc[i] );
            assert_at( guide_oracle_gather( &node, present ), present[i], 1e-15 );
        }
        for ( int m = 0; m <= 40; ++m )
        {
            double s = m / 40.0;
            guide_oracle_stencil stencil = guide_oracle_spline_stencil( rest, 7, s );
            assert_close( stencil.weight[0] + stencil.weight[1] + stencil.weight[2] + stencil.weight[3], 1.0, 1e-15 );
            int k = 0;
            while ( k < 5 && arc[k + 1] <= s )
            {
                k += 1;
            }
            double u = ( s - arc[k] ) / ( arc[k + 1] - arc[k] );
            // computed on the rest shape, used on any other
            assert_at( guide_oracle_gather( &stencil, present ), guide_oracle_spline( present, 7, k, u ), 1e-15 );
            assert_at( guide_oracle_gather( &stencil, moved ),
                       double3_add( guide_oracle_gather( &stencil, present ), shift ), 1e-14 );
        }
    }
    // without length or with one node there is still a point
    const double3 same[3] = { { 1, 2, 3 }, { 1, 2, 3 }, { 1, 2, 3 } };
    double arc[3];
    guide_oracle_arc( same, 3, arc );
    assert_true( arc[1] == 0.5 && arc[2] == 1.0 );
    guide_oracle_stencil none = guide_oracle_spline_stencil( same, 3, 0.7 );
    assert_at( guide_oracle_gather( &none, same ), same[0], 1e-15 );
    none = guide_oracle_spline_stencil( same, 1, 0.7 );
    assert_at( guide_oracle_gather( &none, same ), same[0], 0.0 );
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

// Unequal node counts (conclusion): twice the nodes by nearest particle and by spline, against node to node. The elastic and the
// centre weight are off: they do not vanish towards the pinned root, and their step from root to node 1 turns the
// farther the shorter that segment is, however the nodes are paired.
static void twice_the_nodes_kink_by_nearest_pairing_and_not_by_spline( void** state )
{
    (void)state;
    for ( int tip = 0; tip <= 1; ++tip )
    {
        for ( int ghost_count = 1; ghost_count <= 4; ghost_count += 3 )
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
                options.tip_gain = tip;
                options.pairing = (guide_oracle_pairing)p;
                int count = p == GUIDE_ORACLE_PAIRING_NODE ? NODES : 2 * NODES;
                straight_ghosts( ghost_count, count, ghosts );
                guide_oracle_def def = { 1, NODES, ghost_count, count, s.target, ghosts, NULL };
                assert_int_equal( guide_oracle_create( &def, &options, &hair[p], NULL ), WISP_OK );
                for ( int n = 0; n < ghost_count * count; ++n )
                {
                    assert_at( hair[p].y[n], ghosts[n], 1e-15 );
                }
            }
            double kink = 0.0;
            for ( int frame = 0; frame < 90; ++frame )
            {
                swing( &s, 20 );
                for ( int p = 0; p < 3; ++p )
                {
                    step( &hair[p], s.x, s.v );
                }
                double plain = ghost_turn( &hair[GUIDE_ORACLE_PAIRING_NODE] );
                assert_true( ghost_turn( &hair[GUIDE_ORACLE_PAIRING_SPLINE] ) <= plain );
                kink = fmax( kink, ghost_turn( &hair[GUIDE_ORACLE_PAIRING_NEAREST] ) - plain );
            }
            // nodes of one particle keep their rest direction, and the segments between pairs absorb the rest
            assert_true( kink > 0.2 );
            for ( int p = 0; p < 3; ++p )
            {
                guide_oracle_destroy( &hair[p] );
            }
        }
    }
}

// The centre with other node counts
static void the_centre_of_a_group_with_other_nodes_is_the_resampled_target( void** state )
{
    (void)state;
    scene s = make_scene( 1, 1 );
    double3 ghosts[4 * 17];
    straight_ghosts( 4, 17, ghosts );
    guide_oracle_options options = options_without_weights();
    options.pairing = GUIDE_ORACLE_PAIRING_SPLINE;
    guide_oracle_def def = { 1, NODES, 4, 17, s.target, ghosts, NULL };
    guide_oracle hair;
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    for ( int frame = 0; frame < 60; ++frame )
    {
        swing( &s, 5 );
        step( &hair, s.x, s.v );
        for ( int j = 0; j < 17; ++j )
        {
            guide_oracle_stencil point = guide_oracle_spline_stencil( s.target, NODES, j / 16.0 );
            assert_at( ghost_mean( &hair, hair.y, 0, j ), guide_oracle_gather( &point, s.x ), 1e-12 );
        }
        assert_at( ghost_mean( &hair, hair.y, 0, 0 ), s.x[0], 1e-12 );
        assert_at( ghost_mean( &hair, hair.y, 0, 16 ), s.x[NODES - 1], 1e-12 );
    }
    guide_oracle_destroy( &hair );
}

// Degenerate strands with other node counts
static void more_nodes_are_held_to_the_same_segment_of_the_target( void** state )
{
    (void)state;
    double3 target[4] = { { 0, 0, 0 }, { 0, -0.01, 0 }, { 0, -0.03, 0 }, { 0, -0.07, 0 } }, v[4], ghost[15];
    for ( int n = 0; n < 15; ++n )
    {
        ghost[n] = double3_make( 0.001, -0.005 * n, 0.0 );
        v[n % 4] = double3_make( 50.0, 0.0, 0.0 );
    }
    guide_oracle_options options = guide_oracle_default_options();
    options.pairing = GUIDE_ORACLE_PAIRING_SPLINE;
    guide_oracle_def def = { 1, 4, 1, 15, target, ghost, NULL };
    guide_oracle hair;
    assert_int_equal( guide_oracle_create( &def, &options, &hair, NULL ), WISP_OK );
    step( &hair, target, v );
    // nodes 2 and 6 coincide with nodes of the target, where rounding decides
    const int inside[7] = { 1, 3, 4, 5, 7, 10, 13 };
    for ( int n = 0; n < 7; ++n )
    {
        double length = inside[n] < 2 ? 0.01 : inside[n] < 6 ? 0.02 : 0.04;
        assert_close( double3_distance( hair.y[inside[n]], hair.b[inside[n]] ), length, 1e-15 );
    }
    assert_int_equal( hair.counters.cut_displacements, 14 );
    guide_oracle_destroy( &hair );
}

static void assert_rotation( const guide_oracle_rotation* r )
{
    for ( int n = 0; n < 9; ++n )
    {
        double dot = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            dot += r->m[n / 3][k] * r->m[n % 3][k];
        }
        assert_close( dot, n / 3 == n % 3 ? 1.0 : 0.0, 1e-14 );
    }
    double3 x = { r->m[0][0], r->m[0][1], r->m[0][2] }, y = { r->m[1][0], r->m[1][1], r->m[1][2] };
    assert_close( double3_dot( double3_cross( x, y ), double3_make( r->m[2][0], r->m[2][1], r->m[2][2] ) ), 1.0,
                  1e-14 );
}

static void the_smallest_rotation_turns_one_direction_into_another_and_nothing_more( void** state )
{
    (void)state;
    for ( int n = 0; n < 200; ++n )
    {
        double3 a = random_vector( n, 0 ), b = random_vector( n, 1 ), axis = double3_cross( a, b );
        bool reversed = false;
        guide_oracle_rotation r = guide_oracle_smallest_rotation( a, b, &reversed );
        assert_rotation( &r );
        assert_close( double3_angle( guide_oracle_rotate( &r, a ), b ), 0.0, 1e-14 );
        // its axis is perpendicular to both, so it is the smallest
        assert_at( guide_oracle_rotate( &r, axis ), axis, 1e-14 );
        assert_false( reversed );

        r = guide_oracle_smallest_rotation( a, double3_scale( -3.0, a ), &reversed );
        assert_true( reversed );
        assert_rotation( &r );
        assert_close( double3_angle( guide_oracle_rotate( &r, a ), a ), pi, 1e-14 );
    }
    bool reversed = false;
    guide_oracle_rotation r = guide_oracle_smallest_rotation( zero, random_vector( 0, 0 ), &reversed );
    assert_at( guide_oracle_rotate( &r, random_vector( 0, 1 ) ), random_vector( 0, 1 ), 0.0 );
    assert_false( reversed );
}

static void parallel_frames_are_the_head_where_all_turns_and_carry_rest_tangents_where_it_bends( void** state )
{
    (void)state;
    for ( int n = 0; n < 50; ++n )
    {
        double3 rest[NODES], turned[NODES], bent[NODES];
        guide_oracle_rotation frames[NODES];
        guide_oracle_rotation head =
            guide_oracle_turn_about( random_vector( n, 80 ), 3.0 * random_between( n, 9, -1.0, 1.0 ) );
        random_strand( n, NODES, rest );
        random_strand( n + 200, NODES, bent );
        for ( int i = 0; i < NODES; ++i )
        {
            turned[i] = guide_oracle_rotate( &head, rest[i] );
            bent[i] = guide_oracle_rotate( &head, bent[i] );
        }
        assert_int_equal( guide_oracle_parallel_frames( rest, turned, NODES, &head, frames ), 0 );
        for ( int i = 0; i < NODES; ++i )
        {
            for ( int k = 0; k < 9; ++k )
            {
                assert_close( frames[i].m[k / 3][k % 3], head.m[k / 3][k % 3], 1e-13 );
            }
        }
        guide_oracle_parallel_frames( rest, bent, NODES, &head, frames );
        for ( int i = 0; i < NODES; ++i )
        {
            assert_rotation( &frames[i] );
            if ( i > 0 )
            {
                double3 carried = guide_oracle_rotate( &frames[i], double3_sub( rest[i], rest[i - 1] ) );
                assert_close( double3_angle( carried, double3_sub( bent[i], bent[i - 1] ) ), 0.0, 1e-13 );
            }
        }
    }

    // a bend within a plane turns about its normal only: no twist
    double3 rest[NODES], bent[NODES];
    guide_oracle_rotation frames[NODES], none = guide_oracle_no_rotation();
    turned_strand( 0.0, false, NODES, rest );
    turned_strand( 0.35, false, NODES, bent );
    guide_oracle_parallel_frames( rest, bent, NODES, &none, frames );
    for ( int i = 1; i < NODES; ++i )
    {
        guide_oracle_rotation expected = guide_oracle_turn_about( double3_make( 0.0, 0.0, 1.0 ), 0.35 * ( i - 1 ) );
        for ( int k = 0; k < 9; ++k )
        {
            assert_close( frames[i].m[k / 3][k % 3], expected.m[k / 3][k % 3], 1e-13 );
        }
    }

    // sections without length add nothing, a strand folded back is counted
    bent[4] = bent[3];
    bent[6] = double3_add( bent[5], guide_oracle_rotate( &frames[5], double3_make( 0.0, segment, 0.0 ) ) );
    bent[5] = double3_add( bent[4], guide_oracle_rotate( &frames[5], double3_make( 0.0, -segment, 0.0 ) ) );
    bent[6] = double3_add( bent[5], guide_oracle_rotate( &frames[5], double3_make( 0.0, segment, 0.0 ) ) );
    guide_oracle_rotation again[NODES];
    assert_int_equal( guide_oracle_parallel_frames( rest, bent, 7, &none, again ), 1 );
    assert_memory_equal( &again[4], &again[3], sizeof( none ) );
    assert_rotation( &again[6] );
}

// X5, A16
static void ghosts_of_a_turned_head_stay_on_their_side_only_with_frames( void** state )
{
    (void)state;
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

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( bezier_weights_sum_to_one_and_the_printed_ones_fall_short ),
        cmocka_unit_test( a_bezier_curve_has_its_ends_stays_in_its_hull_and_moves_with_the_scene ),
        cmocka_unit_test( groups_share_their_ends_and_a_rest_is_a_quadratic_or_a_line ),
        cmocka_unit_test( straight_and_repeated_nodes_are_valid_curves ),
        cmocka_unit_test( drawn_curves_turn_less_sharply_than_their_strand_and_end_where_it_ends ),
        cmocka_unit_test( groups_keep_the_turn_of_a_shared_node_where_joined_and_smooth_curves_have_none ),
        cmocka_unit_test( arcs_and_helices_turn_less_at_every_joint_by_all_curves_but_the_printed_one ),
        cmocka_unit_test( the_spline_passes_through_its_nodes_with_one_derivative ),
        cmocka_unit_test( between_frames_a_node_keeps_its_positions_and_velocities ),
        cmocka_unit_test( a_stencil_is_the_spline_at_a_normalised_arc_length ),
        cmocka_unit_test( twice_the_nodes_kink_by_nearest_pairing_and_not_by_spline ),
        cmocka_unit_test( the_centre_of_a_group_with_other_nodes_is_the_resampled_target ),
        cmocka_unit_test( more_nodes_are_held_to_the_same_segment_of_the_target ),
        cmocka_unit_test( the_smallest_rotation_turns_one_direction_into_another_and_nothing_more ),
        cmocka_unit_test( parallel_frames_are_the_head_where_all_turns_and_carry_rest_tangents_where_it_bends ),
        cmocka_unit_test( ghosts_of_a_turned_head_stay_on_their_side_only_with_frames ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
