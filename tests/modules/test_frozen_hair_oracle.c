// The method of frozen hair, equation by equation and stage by stage, on its double-precision oracle. The pipeline
// and the guard are in test_frozen_hair_oracle_pipeline.c, statistics and figures in
// test_frozen_hair_oracle_figures.c. Numbers of equations, figures and sections are those of Kim 2026.
#include "frozen_hair_fixture.h"

// Eq. 1
static void a_strand_set_keeps_its_points_and_each_strand_begins_with_its_root( void** state )
{
    (void)state;
    const int counts[] = { 1, 0, 3, 2 };
    double3 points[6];
    for ( int n = 0; n < 6; ++n )
    {
        points[n] = random_vector( n, 0 );
    }
    frozen_scene scene = new_scene_from( 4, counts, points );
    const int expected[] = { 0, 1, 1, 4, 6 };
    assert_memory_equal( scene.offsets, expected, sizeof( expected ) );

    frozen_oracle_options options = frozen_oracle_default_options();
    options.deform = options.align = options.clump = false;
    double3* unchanged = run( &scene, &options );
    assert_true( same_bits( unchanged, points, 6 ) );

    options.deform = options.align = options.clump = true;
    double3* out = run( &scene, &options );
    const int roots[] = { 0, 1, 4 };
    for ( int n = 0; n < 3; ++n )
    {
        assert_true( same_bits( out + roots[n], points + roots[n], 1 ) );
    }
    assert_false( same_bits( out + 2, points + 2, 1 ) );
    free( unchanged );
    free( out );
    frozen_scene_destroy( &scene );
}

// Eq. 2
static void a_tangent_is_a_unit_vector_and_a_zero_segment_copies_the_previous_one( void** state )
{
    (void)state;
    double3 previous = { 0.6, 0.8, 0.0 };
    for ( int n = 0; n < 1000; ++n )
    {
        double3 segment = double3_scale( pow( 10.0, random_between( n, 3, -6.0, 3.0 ) ), random_vector( n, 0 ) );
        assert_close( double3_length( frozen_oracle_tangent( segment, previous ) ), 1.0, 1e-15 );
    }
    double3 copied = frozen_oracle_tangent( double3_make( 0.0, 1e-13, 0.0 ), previous );
    assert_true( same_bits( &copied, &previous, 1 ) );
}

// Eq. 3: bounds; the statistics are in test_frozen_hair_oracle_figures.c
static void a_target_length_stays_within_one_over_the_stiffness( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        double alpha = frozen_oracle_softness( 7.0, 0.0 );
        double length = frozen_oracle_target_length( 0.004, alpha, random_between( n, 0, -1.0, 1.0 ), 0.05 );
        assert_true( fabs( length / 0.004 - 1.0 ) <= alpha );
    }
    // a stiffness below one would give negative lengths
    assert_close( frozen_oracle_target_length( 0.004, 2.0, -0.9, 0.05 ), 0.05 * 0.004, 1e-18 );
    assert_true( frozen_oracle_target_length( 0.0, 2.0, 0.9, 0.05 ) == 0.0 );
    assert_close( frozen_oracle_softness( 7.0, 1e-6 ), 1.0 / 7.000001, 1e-16 );
}

// Eq. 4
static void a_bend_turns_about_a_unit_axis_perpendicular_to_its_segment( void** state )
{
    (void)state;
    for ( int shape = FROZEN_SCENE_STRAIGHT; shape <= FROZEN_SCENE_CURLY; ++shape )
    {
        frozen_scene scene = new_scene( (frozen_scene_shape)shape, 3, 20, 20, 0.008 );
        frozen_oracle_options options = frozen_oracle_default_options();
        for ( int s = 0; s < scene.hair.strand_count; ++s )
        {
            double3 previous = { 0.0, 0.0, 0.0 };
            for ( int i = 1; i < 20; ++i )
            {
                frozen_oracle_segment g = frozen_oracle_jitter( &scene.hair, &options, scene.rest, s, i, previous );
                assert_close( double3_length( g.axis ), 1.0, 1e-12 );
                assert_close( double3_dot( g.axis, g.tangent ), 0.0, 1e-12 );
                assert_true( fabs( g.angle ) <= options.theta_max / 7.0 );
                assert_close( double3_angle( g.direction, g.tangent ), fabs( g.angle ), 1e-9 );
                previous = g.tangent;
            }
        }
        frozen_scene_destroy( &scene );
    }
}

// Eq. 4
static void straight_hair_and_first_segments_bend_about_the_fallback_axis( void** state )
{
    (void)state;
    double3 down = { 0.0, -1.0, 0.0 }, aside = { 1.0, 0.0, 0.0 };
    double3 flat = frozen_oracle_bend_axis( down, down, 5, 2, 1.0 );
    assert_true( flat.x == 0.0 && flat.y == 0.0 && flat.z == 1.0 );
    double3 first = frozen_oracle_bend_axis( aside, down, 1, 2, 1.0 );
    assert_true( first.x == 0.0 && first.y == 0.0 && first.z == 1.0 );
    double3 bent = frozen_oracle_bend_axis( aside, down, 2, 2, 1.0 );
    assert_close( bent.z, -1.0, 1e-15 );

    // the threshold between straight and bent is a sine of 1e-8
    assert_true( frozen_oracle_bend_axis( double3_make( 0.9e-8, -1.0, 0.0 ), down, 2, 2, 1.0 ).z == 1.0 );
    assert_close( frozen_oracle_bend_axis( double3_make( 1.1e-8, -1.0, 0.0 ), down, 2, 2, 1.0 ).z, -1.0, 1e-15 );

    // in space the axis goes round the segment with psi, on both sides of the equator
    for ( int n = 0; n < 1000; ++n )
    {
        double3 t = double3_unit( random_vector( n, 0 ) ), b1, b2;
        double psi = random_between( n, 4, 0.0, 2.0 * pi );
        frozen_oracle_frame( t, &b1, &b2 );
        double3 axis = frozen_oracle_bend_axis( t, t, 3, 3, psi );
        assert_close( double3_dot( axis, t ), 0.0, 1e-12 );
        assert_close( double3_length( axis ), 1.0, 1e-12 );
        assert_close( double3_dot( axis, b1 ), cos( psi ), 1e-12 );
        assert_close( double3_distance( double3_cross( b1, b2 ), t ), 0.0, 1e-12 );
    }
}

// Eq. 5
static void a_rodrigues_matrix_is_a_rotation( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        double m[3][3];
        double angle = random_between( n, 3, -pi, pi );
        double3 axis = double3_unit( random_vector( n, 0 ) );
        frozen_oracle_rodrigues( axis, angle, m );
        for ( int a = 0; a < 3; ++a )
        {
            for ( int b = 0; b < 3; ++b )
            {
                double product = m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b];
                assert_close( product, a == b ? 1.0 : 0.0, 1e-12 );
            }
        }
        double3 row[3];
        memcpy( row, m, sizeof( m ) );
        assert_close( double3_dot( row[0], double3_cross( row[1], row[2] ) ), 1.0, 1e-12 );
        assert_close( double3_distance( frozen_oracle_rotate( axis, angle, axis ), axis ), 0.0, 1e-12 );
        assert_close( m[0][0] + m[1][1] + m[2][2], 1.0 + 2.0 * cos( angle ), 1e-12 );
    }
    double3 quarter = frozen_oracle_rotate( double3_make( 0, 0, 1 ), pi / 2.0, double3_make( 1, 0, 0 ) );
    assert_close( double3_distance( quarter, double3_make( 0, 1, 0 ) ), 0.0, 1e-12 );
}

// Eq. 6-7
static void a_deformed_segment_has_its_target_length( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 20, 20, 0.008 );
    double3* out = new_points( &scene );
    for ( int printed = 0; printed <= 1; ++printed )
    {
        frozen_oracle_options options = frozen_oracle_default_options();
        options.epsilon = printed ? 1e-6 : 0.0;
        frozen_oracle_deform( &scene.hair, &options, out );
        for ( int s = 0; s < 20; ++s )
        {
            double3 previous = { 0.0, 0.0, 0.0 };
            for ( int i = 1; i < 20; ++i )
            {
                int v = 20 * s + i;
                frozen_oracle_segment g = frozen_oracle_jitter( &scene.hair, &options, scene.rest, s, i, previous );
                double shrink = g.rest_length / ( g.rest_length + options.epsilon );
                // 1e-15 m is the rounding of coordinates below one metre
                assert_close( double3_distance( out[v], out[v - 1] ), g.target_length * shrink, 1e-15 );
                assert_true( fabs( g.target_length / g.rest_length - 1.0 ) <= 1.0 / 7.0 );
                previous = g.tangent;
            }
        }
    }
    free( out );
    frozen_scene_destroy( &scene );
}

// The stiff limit
static void infinitely_stiff_hair_returns_to_rest( void** state )
{
    (void)state;
    for ( int shape = FROZEN_SCENE_STRAIGHT; shape <= FROZEN_SCENE_CURLY; ++shape )
    {
        frozen_scene scene = new_scene( (frozen_scene_shape)shape, 3, 20, 20, 0.008 );
        set_stiffness( &scene, 1e9 );
        frozen_oracle_options options = frozen_oracle_default_options();
        double3* out = new_points( &scene );
        frozen_oracle_deform( &scene.hair, &options, out );
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            double strand_length = 0.0;
            for ( int i = 1; i < 20; ++i )
            {
                int a = 20 * ( v / 20 ) + i;
                strand_length += double3_distance( scene.rest[a], scene.rest[a - 1] );
            }
            assert_close( double3_distance( out[v], scene.rest[v] ), 0.0, 1e-8 * strand_length );
        }
        free( out );
        frozen_scene_destroy( &scene );
    }
}

// Eq. 8-9
static void the_direction_of_a_straight_strand_is_the_same_from_mean_and_root( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 3, 1, 20, 0.0 );
    double3 mean = frozen_oracle_representative( scene.rest, 20, FROZEN_ORACLE_DIRECTION_MEAN );
    double3 root = frozen_oracle_representative( scene.rest, 20, FROZEN_ORACLE_DIRECTION_ROOT );
    assert_close( double3_angle( mean, root ), 0.0, 1e-12 );
    assert_close( double3_length( mean ) / double3_length( root ), 0.5, 1e-12 );
    assert_close( double3_distance( root, double3_sub( scene.rest[19], scene.rest[0] ) ), 0.0, 1e-15 );
    frozen_scene_destroy( &scene );

    // on a bent strand they differ
    const double3 hook[3] = { { 0, 0, 0 }, { 0, -1, 0 }, { 1, -1, 0 } };
    mean = frozen_oracle_representative( hook, 3, FROZEN_ORACLE_DIRECTION_MEAN );
    assert_close( double3_distance( mean, double3_make( 2.0 / 3.0, -1.0 / 3.0, 0.0 ) ), 0.0, 1e-15 );
}

// Eq. 10
static void strands_outside_the_cursor_radius_keep_their_bits( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 2, 40, 20, 0.008 );
    frozen_oracle_options options = frozen_oracle_default_options();
    options.cursor = double3_make( 0.0, -0.15, 0.0 );
    options.cursor_radius = 0.1;
    double3* out = new_points( &scene );
    frozen_oracle_align( &scene.hair, &options, scene.rest, out );
    int outside = 0;
    for ( int s = 0; s < 40; ++s )
    {
        bool far = double3_distance( scene.rest[20 * s + 19], options.cursor ) > 0.1;
        assert_int_equal( same_bits( out + 20 * s, scene.rest + 20 * s, 20 ), far );
        outside += far;
    }
    assert_in_range( outside, 10, 30 );
    free( out );
    frozen_scene_destroy( &scene );
}

// The cursor's radius is 0
static void a_zero_radius_reaches_only_a_tip_at_the_cursor_and_nearest_reaches_any_vertex( void** state )
{
    (void)state;
    const double3 p[3] = { { 0, 0, 0 }, { 0, -1, 0 }, { 0, -2, 0 } };
    assert_true( frozen_oracle_in_reach( p, 3, p[2], 0.0, FROZEN_ORACLE_REACH_TIP ) );
    assert_false( frozen_oracle_in_reach( p, 3, double3_make( 0, -2, 1e-9 ), 0.0, FROZEN_ORACLE_REACH_TIP ) );
    assert_false( frozen_oracle_in_reach( p, 3, p[1], 0.5, FROZEN_ORACLE_REACH_TIP ) );
    assert_true( frozen_oracle_in_reach( p, 3, p[1], 0.5, FROZEN_ORACLE_REACH_NEAREST ) );
}

// Eq. 11
static void the_alignment_rotation_turns_v_onto_u_even_when_they_are_opposite( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        double3 v = random_vector( 2 * n, 0 ), u = random_vector( 2 * n + 1, 0 ), axis;
        int dimension = n % 2 == 0 ? 2 : 3;
        double phi;
        if ( dimension == 2 )
        {
            v.z = u.z = 0.0;
        }
        if ( n % 5 == 0 )
        {
            u = double3_scale( n % 10 == 0 ? -0.7 : 0.7, v );
        }
        assert_true( frozen_oracle_turn( v, u, dimension, &axis, &phi ) );
        assert_true( phi >= 0.0 && phi <= pi );
        assert_close( double3_length( axis ), 1.0, 1e-12 );
        assert_close( double3_angle( frozen_oracle_rotate( axis, phi, v ), u ), 0.0, 1e-9 );
        if ( dimension == 2 )
        {
            assert_true( axis.x == 0.0 && axis.y == 0.0 );
        }
    }
    // close to opposite, the axis is still that of v and u, not the fallback
    double3 axis, v = { 1.0, 0.0, 0.0 }, nearly_opposite = { -1.0, 1e-8, 2e-8 };
    double phi;
    assert_true( frozen_oracle_turn( v, nearly_opposite, 3, &axis, &phi ) );
    assert_close( double3_angle( frozen_oracle_rotate( axis, phi, v ), nearly_opposite ), 0.0, 1e-9 );
    assert_false( frozen_oracle_turn( double3_scale( 1e-13, v ), v, 3, &axis, &phi ) );
    assert_false( frozen_oracle_turn( v, double3_scale( 1e-13, v ), 3, &axis, &phi ) );
}

// Eq. 12
static void the_weight_rises_linearly_from_the_intensity_at_the_root_to_one_at_the_tip( void** state )
{
    (void)state;
    for ( int i = 0; i < 20; ++i )
    {
        assert_close( frozen_oracle_weight( i, 20, 0.2 ), 0.2 + 0.8 * i / 19.0, 1e-15 );
        assert_close( frozen_oracle_weight( i, 20, 1.0 ), 1.0, 1e-15 );
    }
    assert_true( frozen_oracle_weight( 0, 20, 0.0 ) == 0.0 && frozen_oracle_weight( 19, 20, 0.0 ) == 1.0 );
    assert_true( frozen_oracle_weight( 0, 1, 0.3 ) == 0.3 );
}

// Eq. 13
static void the_chord_blend_shortens_as_its_formula_says_and_the_arc_keeps_lengths( void** state )
{
    (void)state;
    for ( int n = 0; n < 1000; ++n )
    {
        double3 root = random_vector( n + 5000, 0 ), axis = double3_unit( random_vector( n, 0 ) ), b1, b2;
        double phi = random_between( n, 3, 0.0, pi ), w = random_between( n, 4, 0.0, 1.0 );
        frozen_oracle_frame( axis, &b1, &b2 );
        double3 arm = double3_scale( 0.3, b1 );
        double3 p = double3_add( root, arm );
        double3 chord = frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_CHORD, root, p, axis, phi, w );
        double3 arc = frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_ARC, root, p, axis, phi, w );
        double ratio = sqrt( 1.0 - 2.0 * w * ( 1.0 - w ) * ( 1.0 - cos( phi ) ) );
        assert_close( double3_distance( chord, root ) / 0.3, ratio, 1e-12 );
        assert_close( double3_distance( arc, root ) / 0.3, 1.0, 1e-12 );
        for ( int end = 0; end <= 1; ++end )
        {
            chord = frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_CHORD, root, p, axis, phi, end );
            arc = frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_ARC, root, p, axis, phi, end );
            assert_close( double3_distance( chord, arc ), 0.0, 1e-12 );
        }
    }
}

// A straight strand is aligned
static void a_straight_strand_turns_fully_with_x_one_and_linearly_with_x_zero( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_STRAIGHT, 3, 9, 20, 0.008 );
    frozen_oracle_options options = frozen_oracle_default_options();
    options.cursor = double3_make( 0.1, -0.05, 0.15 );
    options.cursor_radius = 1.0;
    double3* out = new_points( &scene );
    for ( int x = 0; x <= 1; ++x )
    {
        for ( int s = 0; s < 9; ++s )
        {
            scene.intensity[s] = x;
        }
        frozen_oracle_align( &scene.hair, &options, scene.rest, out );
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            int root = 20 * ( v / 20 ), i = v % 20;
            double3 before = double3_sub( scene.rest[v], scene.rest[root] );
            double3 after = double3_sub( out[v], scene.rest[root] );
            double3 u = double3_sub( options.cursor, scene.rest[root] );
            double phi = double3_angle( double3_sub( scene.rest[root + 19], scene.rest[root] ), u );
            assert_close( double3_length( after ), double3_length( before ), 1e-15 );
            assert_close( double3_angle( before, after ), i == 0 ? 0.0 : ( x + ( 1 - x ) * i / 19.0 ) * phi, 1e-9 );
            assert_close( i == 19 ? double3_angle( after, u ) : 0.0, 0.0, 1e-9 );
        }
    }
    free( out );
    frozen_scene_destroy( &scene );
}

// Eq. 14
static void the_adhesion_kernel_is_one_at_zero_and_leaves_zero_flat_at_h( void** state )
{
    (void)state;
    double h = 0.01;
    assert_true( frozen_oracle_kernel( 0.0, h ) == 1.0 );
    assert_true( frozen_oracle_kernel( h, h ) == 0.0 && frozen_oracle_kernel( 1.00001 * h, h ) == 0.0 );
    assert_close( frozen_oracle_kernel( 0.25 * h, h ), 0.5625, 1e-15 );

    // the slope at h(1 - e) is -2e/h: halving e halves the difference quotient
    double e = 1e-3;
    double slope = ( frozen_oracle_kernel( h, h ) - frozen_oracle_kernel( h * ( 1.0 - e ), h ) ) / e;
    double half = ( frozen_oracle_kernel( h, h ) - frozen_oracle_kernel( h * ( 1.0 - e / 2.0 ), h ) ) / ( e / 2.0 );
    assert_close( slope, -e, 1e-12 );
    assert_close( half / slope, 0.5, 1e-9 );
}

// Two strands whose roots are far apart and whose tips are r apart, so that only the tips interact.
static frozen_scene two_tips( double r )
{
    const int counts[] = { 2, 2 };
    const double3 points[] = { { -1, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0.6 * r, -0.8 * r, 0 } };
    return new_scene_from( 2, counts, points );
}

// Eq. 15
static void two_vertices_pull_each_other_with_opposite_forces( void** state )
{
    (void)state;
    frozen_scene scene = two_tips( 0.004 );
    frozen_oracle_options options = frozen_oracle_default_options();
    frozen_oracle_adhesion a = frozen_oracle_adhere( &scene.hair, &options, scene.rest, 0, 1, NULL );
    frozen_oracle_adhesion b = frozen_oracle_adhere( &scene.hair, &options, scene.rest, 1, 1, NULL );
    assert_true( a.force.x == -b.force.x && a.force.y == -b.force.y && a.force.z == -b.force.z );
    assert_close( double3_length( a.force ), 0.36, 1e-12 );
    assert_close( a.nearest, 0.004, 1e-15 );
    assert_int_equal( a.neighbours, 1 );

    // printed division: one pair keeps its force but for r / (r + eps)
    options.epsilon = 1e-6;
    a = frozen_oracle_adhere( &scene.hair, &options, scene.rest, 0, 1, NULL );
    assert_close( double3_length( a.force ), 0.36 * 0.004 / 0.004001, 1e-12 );
    frozen_scene_destroy( &scene );
}

// Eq. 15: the neighbour set does not depend on the order of the sum
static void another_order_of_the_sum_changes_rounding_only( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 25, 20, 0.006 );
    frozen_oracle_options options = frozen_oracle_default_options();
    int* identity = malloc( sizeof( int ) * (size_t)scene.vertex_count );
    int* reversed = malloc( sizeof( int ) * (size_t)scene.vertex_count );
    assert_true( identity != NULL && reversed != NULL );
    for ( int n = 0; n < scene.vertex_count; ++n )
    {
        identity[n] = n;
        reversed[n] = scene.vertex_count - 1 - n;
    }
    int differing = 0;
    for ( int v = 0; v < scene.vertex_count; ++v )
    {
        frozen_oracle_adhesion up = frozen_oracle_adhere( &scene.hair, &options, scene.rest, v / 20, v % 20, NULL );
        frozen_oracle_adhesion same =
            frozen_oracle_adhere( &scene.hair, &options, scene.rest, v / 20, v % 20, identity );
        frozen_oracle_adhesion down =
            frozen_oracle_adhere( &scene.hair, &options, scene.rest, v / 20, v % 20, reversed );
        assert_true( same_bits( &up.force, &same.force, 1 ) );
        assert_true( up.neighbours == down.neighbours && up.nearest == down.nearest );
        // a sum of n terms of at most 1 rounds by less than n^2 units in the last place
        double n = up.neighbours;
        assert_close( double3_distance( up.force, down.force ), 0.0, n * n * 0x1p-52 );
        differing += !same_bits( &up.force, &down.force, 1 );
    }
    assert_true( differing > 0 );
    free( identity );
    free( reversed );
    frozen_scene_destroy( &scene );
}

// Eq. 16
static void a_wet_pair_closes_by_twice_the_step_of_its_kernel( void** state )
{
    (void)state;
    const double distances[] = { 0.001, 0.004, 0.0099, 0.02 };
    for ( int n = 0; n < 4; ++n )
    {
        double r = distances[n];
        frozen_scene scene = two_tips( r );
        frozen_oracle_options options = frozen_oracle_default_options();
        options.gap = FROZEN_ORACLE_GAP_NONE;
        options.min_distance_clamp = false;
        options.deform = options.align = false;
        options.clump_step = 0.0002;
        options.clump_iterations = 1;
        double3* out = run( &scene, &options );
        double expected = r - 2.0 * options.clump_step * frozen_oracle_kernel( r, options.clump_radius );
        assert_close( double3_distance( out[1], out[3] ), expected, 1e-12 );
        double3 a = double3_sub( out[1], scene.rest[1] ), b = double3_sub( out[3], scene.rest[3] );
        assert_close( double3_length( double3_add( a, b ) ), 0.0, 1e-15 );
        assert_true( same_bits( out, scene.rest, 1 ) && same_bits( out + 2, scene.rest + 2, 1 ) );
        free( out );
        frozen_scene_destroy( &scene );
    }
}

// Eq. 16: K iterations are K steps
static void a_clump_of_three_iterations_is_three_clump_steps( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 16, 20, 0.006 );
    frozen_oracle_options options = frozen_oracle_default_options();
    options.clump_iterations = 3;
    double3 *a = new_points( &scene ), *b = new_points( &scene ), *c = new_points( &scene );
    assert_int_equal( frozen_oracle_clump( &scene.hair, &options, scene.rest, NULL, c ), WISP_OK );
    clump_step( &scene, &options, 0, scene.rest, scene.rest, NULL, NULL, a );
    clump_step( &scene, &options, 1, scene.rest, a, NULL, NULL, b );
    clump_step( &scene, &options, 2, scene.rest, b, NULL, NULL, a );
    assert_true( same_bits( a, c, scene.vertex_count ) );
    free( a );
    free( b );
    free( c );
    frozen_scene_destroy( &scene );
}

// Eq. 17-19
static void the_guard_cuts_a_step_to_half_the_room_before_the_nearest_vertex( void** state )
{
    (void)state;
    frozen_oracle_options options = frozen_oracle_default_options();
    frozen_oracle_adhesion adhesion = { { 3.0, -4.0, 0.0 }, 0.0012, 9 };
    double3 cut = frozen_oracle_tentative_step( &options, adhesion );
    assert_close( double3_distance( cut, double3_make( 0.0003, -0.0004, 0.0 ) ), 0.0, 1e-15 );

    // closer than r_min there is no room: the vertex stays, it is not pushed away
    adhesion.nearest = 0.0001;
    assert_true( double3_length( frozen_oracle_tentative_step( &options, adhesion ) ) == 0.0 );

    options.min_distance_clamp = false;
    double3 whole = frozen_oracle_tentative_step( &options, adhesion );
    assert_close( double3_distance( whole, double3_make( 0.003, -0.004, 0.0 ) ), 0.0, 1e-15 );

    // a step with enough room is unchanged
    options.min_distance_clamp = true;
    adhesion.nearest = 0.0102 + 1e-9;
    double3 same = frozen_oracle_tentative_step( &options, adhesion );
    assert_true( same_bits( &same, &whole, 1 ) );
}

// Eq. 17-18
static void each_gap_rule_reads_a_change_of_distance_as_it_says( void** state )
{
    (void)state;
    double h = 0.01;
    assert_close( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_SIGNED, 0.004, 0.006, h ), 0.2, 1e-12 );
    assert_true( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_SIGNED, 0.006, 0.004, h ) == 0.0 );
    assert_close( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_REVERSED, 0.006, 0.004, h ), 0.2, 1e-12 );
    assert_true( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_REVERSED, 0.004, 0.006, h ) == 0.0 );
    assert_close( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_ABSOLUTE, 0.004, 0.006, h ), 0.2, 1e-12 );
    assert_close( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_ABSOLUTE, 0.006, 0.004, h ), 0.2, 1e-12 );
    assert_true( frozen_oracle_pair_delta( FROZEN_ORACLE_GAP_ABSOLUTE, 0.006, 0.5, h ) == 1.0 );

    assert_close( frozen_oracle_lambda( FROZEN_ORACLE_GAP_SIGNED, 0.25, 0.4, 0.1 ), 0.75 * 0.4 + 0.25, 1e-15 );
    assert_close( frozen_oracle_lambda( FROZEN_ORACLE_GAP_REVERSED, 0.25, 0.4, 0.1 ), 0.75 * 0.4 + 0.25, 1e-15 );
    assert_close( frozen_oracle_lambda( FROZEN_ORACLE_GAP_ABSOLUTE, 0.25, 0.4, 0.1 ), 0.75 * 0.4 + 0.025, 1e-15 );
    assert_true( frozen_oracle_lambda( FROZEN_ORACLE_GAP_NONE, 0.25, 0.4, 0.1 ) == 1.0 );
}

// Eq. 17-19
static void a_vertex_takes_the_kernel_weighted_mean_of_its_pairs( void** state )
{
    (void)state;
    const int counts[] = { 2, 1, 1, 1, 1 };
    const double3 before[] = { { 0.003, 0, 0 }, { 0, 0, 0 }, { 0.005, 0, 0 },
                               { 0, 0.002, 0 }, { 0, 0, 0 }, { 1, 0, 0 } };
    double3 after[6];
    memcpy( after, before, sizeof( before ) );
    after[0].x = 0.001;
    after[2].x = 0.004;
    frozen_scene scene = new_scene_from( 5, counts, before );
    frozen_oracle_options options = frozen_oracle_default_options();
    double delta = frozen_oracle_vertex_delta( &scene.hair, &options, before, after, 0, 1, NULL );
    // g(5 mm) = 0.25 moved by 0.1 h, g(2 mm) = 0.64 unmoved; the own root and the coincident vertex do not count
    assert_close( delta, 0.25 * 0.1 / ( 0.25 + 0.64 ), 1e-12 );
    assert_true( frozen_oracle_vertex_delta( &scene.hair, &options, before, after, 4, 0, NULL ) == 0.0 );
    frozen_scene_destroy( &scene );
}

// Eq. 17-19: with gap_ref = stage the brake accumulates, with gap_ref = iteration it starts again
static void the_stage_reference_brakes_harder_than_the_iteration_reference( void** state )
{
    (void)state;
    frozen_scene scene = new_scene( FROZEN_SCENE_WAVY, 3, 25, 20, 0.006 );
    frozen_oracle_options options = frozen_oracle_default_options();
    double3 *p = new_points( &scene ), *out = new_points( &scene );
    double* delta = new_doubles( &scene );
    double sum[2] = { 0.0, 0.0 };
    assert_int_equal( frozen_oracle_clump( &scene.hair, &options, scene.rest, NULL, p ), WISP_OK );
    for ( int reference = 0; reference < 2; ++reference )
    {
        options.gap_reference = (frozen_oracle_gap_reference)reference;
        clump_step( &scene, &options, 4, scene.rest, p, delta, NULL, out );
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            sum[reference] += delta[v];
        }
    }
    assert_true( sum[0] > 1.5 * sum[1] && sum[1] > 0.0 );
    free( p );
    free( out );
    free( delta );
    frozen_scene_destroy( &scene );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_strand_set_keeps_its_points_and_each_strand_begins_with_its_root ),
        cmocka_unit_test( a_tangent_is_a_unit_vector_and_a_zero_segment_copies_the_previous_one ),
        cmocka_unit_test( a_target_length_stays_within_one_over_the_stiffness ),
        cmocka_unit_test( a_bend_turns_about_a_unit_axis_perpendicular_to_its_segment ),
        cmocka_unit_test( straight_hair_and_first_segments_bend_about_the_fallback_axis ),
        cmocka_unit_test( a_rodrigues_matrix_is_a_rotation ),
        cmocka_unit_test( a_deformed_segment_has_its_target_length ),
        cmocka_unit_test( infinitely_stiff_hair_returns_to_rest ),
        cmocka_unit_test( the_direction_of_a_straight_strand_is_the_same_from_mean_and_root ),
        cmocka_unit_test( strands_outside_the_cursor_radius_keep_their_bits ),
        cmocka_unit_test( a_zero_radius_reaches_only_a_tip_at_the_cursor_and_nearest_reaches_any_vertex ),
        cmocka_unit_test( the_alignment_rotation_turns_v_onto_u_even_when_they_are_opposite ),
        cmocka_unit_test( the_weight_rises_linearly_from_the_intensity_at_the_root_to_one_at_the_tip ),
        cmocka_unit_test( the_chord_blend_shortens_as_its_formula_says_and_the_arc_keeps_lengths ),
        cmocka_unit_test( a_straight_strand_turns_fully_with_x_one_and_linearly_with_x_zero ),
        cmocka_unit_test( the_adhesion_kernel_is_one_at_zero_and_leaves_zero_flat_at_h ),
        cmocka_unit_test( two_vertices_pull_each_other_with_opposite_forces ),
        cmocka_unit_test( another_order_of_the_sum_changes_rounding_only ),
        cmocka_unit_test( a_wet_pair_closes_by_twice_the_step_of_its_kernel ),
        cmocka_unit_test( a_clump_of_three_iterations_is_three_clump_steps ),
        cmocka_unit_test( the_guard_cuts_a_step_to_half_the_room_before_the_nearest_vertex ),
        cmocka_unit_test( each_gap_rule_reads_a_change_of_distance_as_it_says ),
        cmocka_unit_test( a_vertex_takes_the_kernel_weighted_mean_of_its_pairs ),
        cmocka_unit_test( the_stage_reference_brakes_harder_than_the_iteration_reference ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
