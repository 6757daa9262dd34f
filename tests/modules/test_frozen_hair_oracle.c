// The oracle of frozen hair is sound: each equation by its closed form, and each printed form beside its resolution. Numbers of
// equations are those of Kim 2026. The engine is held to this oracle in test_frozen_hair_stages.c and test_frozen_hair_clump.c.
#include "clumping.h"
#include "oracle_support.h"

#include "oracle/frozen_hair_scenes.h"

static const uint64_t random_seed = 99;

static double3* new_points( const frozen_scene* scene )
{
    double3* points = checked_calloc( (size_t)scene->vertex_count + 1, sizeof( double3 ) );
    return points;
}

static frozen_scene new_scene( frozen_scene_shape shape, int dimension, int strands, int vertices, double spacing )
{
    frozen_scene scene;
    assert_true( frozen_scene_create( &scene, shape, dimension, strands, vertices, spacing ) );
    return scene;
}

static frozen_scene new_scene_from( int strands, const int* counts, const double3* points )
{
    frozen_scene scene;
    assert_true( frozen_scene_from_points( &scene, strands, counts, points ) );
    return scene;
}

/// The oracle's pipeline; the caller frees the points.
static double3* run( const frozen_scene* scene, const frozen_oracle_options* options )
{
    double3* out = new_points( scene );
    wisp_error error = { WISP_OK, "" };
    if ( frozen_oracle_run( &scene->hair, options, NULL, out, &error ) != WISP_OK )
    {
        fail_msg( "the oracle refuses: %s", error.message );
    }
    return out;
}

static bool same_bits( const double3* a, const double3* b, int count )
{
    return memcmp( a, b, (size_t)count * sizeof( double3 ) ) == 0;
}

// Eq. 2
TEST( a_tangent_is_a_unit_vector_and_a_zero_segment_copies_the_previous_one )
{
    double3 previous = { 0.6, 0.8, 0.0 };
    for ( int n = 0; n < 1000; ++n )
    {
        double3 segment = double3_scale( pow( 10.0, random_between( n, 3, -6.0, 3.0 ) ), random_vector( n, 0 ) );
        assert_close( double3_length( frozen_oracle_tangent( segment, previous ) ), 1.0, 1e-15 );
    }
    double3 copied = frozen_oracle_tangent( double3_make( 0.0, 1e-13, 0.0 ), previous );
    assert_true( same_bits( &copied, &previous, 1 ) );
}

// Eq. 4
TEST( a_bend_turns_about_a_unit_axis_perpendicular_to_its_segment )
{
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

// Eq. 5
TEST( a_rodrigues_matrix_is_a_rotation )
{
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
TEST( a_deformed_segment_has_its_target_length )
{
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

// Eq. 11
TEST( the_alignment_rotation_turns_v_onto_u_even_when_they_are_opposite )
{
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

// Eq. 12-13. A chord shortens an arm across the axis and turns it late; an arc does neither.
TEST( the_chord_blend_shortens_as_its_formula_says_and_the_arc_keeps_lengths )
{
    for ( int n = 0; n < 1000; ++n )
    {
        double3 root = random_vector( n + 5000, 0 ), axis = double3_unit( random_vector( n, 0 ) ), b1, b2;
        const double phi = random_between( n, 3, 0.0, pi );
        const double w = frozen_oracle_weight( n % 20, 20, 0.2 );
        assert_close( w, 0.2 + 0.8 * ( n % 20 ) / 19.0, 1e-15 );
        frozen_oracle_frame( axis, &b1, &b2 );
        const double3 arm = double3_scale( 0.3, b1 ), p = double3_add( root, arm );
        const double3 chord =
            double3_sub( frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_CHORD, root, p, axis, phi, w ), root );
        const double3 arc =
            double3_sub( frozen_oracle_blend_point( FROZEN_ORACLE_BLEND_ARC, root, p, axis, phi, w ), root );
        const double ratio = sqrt( 1.0 - 2.0 * w * ( 1.0 - w ) * ( 1.0 - cos( phi ) ) );
        assert_close( double3_length( chord ) / 0.3, ratio, 1e-12 );
        assert_close( double3_length( arc ) / 0.3, 1.0, 1e-12 );
        // a root's own rounding, over the shortest arm
        assert_close( double3_angle( arm, chord ), atan2( w * sin( phi ), 1.0 - w + w * cos( phi ) ), 1e-14 / ratio );
        assert_close( double3_angle( arm, arc ), w * phi, 1e-14 );
    }
}

// Eq. 14
TEST( the_adhesion_kernel_is_one_at_zero_and_leaves_zero_flat_at_h )
{
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
TEST( two_vertices_pull_each_other_with_opposite_forces )
{
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

// Eq. 16
TEST( a_wet_pair_closes_by_twice_the_step_of_its_kernel )
{
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

// Eq. 17-18
TEST( each_gap_rule_reads_a_change_of_distance_as_it_says )
{
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

// Fig. 3: hair aligned by the cursor, then clumped by the wet, the printed and the prose rule; first without.
static void clump_aligned_hair( const frozen_scene* scene, int dimension, double spacing, bool guarded,
                                clumping c[4] )
{
    static const frozen_oracle_gap rules[] = { FROZEN_ORACLE_GAP_NONE, FROZEN_ORACLE_GAP_NONE,
                                               FROZEN_ORACLE_GAP_SIGNED, FROZEN_ORACLE_GAP_ABSOLUTE };
    for ( int n = 0; n < 4; ++n )
    {
        frozen_oracle_options options = frozen_oracle_default_options();
        options.dimension = dimension;
        options.cursor = double3_make( 0.08, -0.17, 0.0 );
        options.cursor_radius = 1.0;
        options.clump = n > 0;
        options.gap = rules[n];
        options.min_distance_clamp = guarded;
        double3* out = run( scene, &options );
        c[n] = measure_clumping( out, scene->vertex_count, scene->offsets[1], spacing );
        // 1e-15 m is the rounding of coordinates below one metre
        assert_true( !guarded || c[n].nearest_gap >= fmin( c[0].nearest_gap, options.min_distance ) - 1e-15 );
        free( out );
    }
}

TEST( locks_form_and_gaps_stay_as_the_prose_says )
{
    for ( int n = 0; n < 6; ++n )
    {
        const bool flat = n < 3;
        const double spacing = flat ? 0.004 : 0.008;
        frozen_scene scene = new_scene( (frozen_scene_shape)( n % 3 ), flat ? 2 : 3, flat ? 40 : 49, 20, spacing );
        clumping c[4];
        clump_aligned_hair( &scene, flat ? 2 : 3, spacing, true, c );
        assert_true( c[1].locks < c[0].locks && c[2].locks < c[0].locks && c[3].locks < c[0].locks );
        assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
        frozen_scene_destroy( &scene );
    }
}

// The limit of that order: dense hair overshoots without the guard, by the undamped step most.
TEST( dense_hair_without_the_guard_reverses_the_order_of_the_gaps )
{
    frozen_scene scene = new_scene( FROZEN_SCENE_CURLY, 3, 49, 20, 0.002 );
    clumping c[4];
    clump_aligned_hair( &scene, 3, 0.002, false, c );
    assert_true( c[3].mean_gap < c[2].mean_gap && c[2].mean_gap < c[1].mean_gap );
    clump_aligned_hair( &scene, 3, 0.002, true, c );
    assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
    frozen_scene_destroy( &scene );
}
