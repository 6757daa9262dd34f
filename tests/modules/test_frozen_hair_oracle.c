// The oracle of frozen hair is sound: closed forms, the rotation of Eq. 11, and each printed form beside its resolution. Numbers of
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

/// The oracle's pipeline; the caller frees the points.
static double3* run( const frozen_scene* scene, const frozen_oracle_options* options )
{
    double3* out = new_points( scene );
    assert_int_equal( frozen_oracle_run( &scene->hair, options, NULL, out ), WISP_OK );
    return out;
}

// Eq. 3, 4 and 7. An axis that were not a unit vector perpendicular to the segment would turn it by less. Below a stiffness of one the
// printed equation would make lengths negative.
TEST( segments_have_the_length_and_the_angle_that_were_drawn )
{
    for ( int n = 0; n < 12; ++n )
    {
        SCOPED( frozen_scene_destroy )
        frozen_scene scene = new_scene( (frozen_scene_shape)( n % 3 ), 2 + n / 3 % 2, 100, 20, 0.008 );
        frozen_oracle_options options = frozen_oracle_default_options();
        options.dimension = 2 + n / 3 % 2;
        const double k = n < 6 ? 7.0 : 0.3;
        double stiffness[100];
        for ( int s = 0; s < 100; ++s )
        {
            stiffness[s] = k;
        }
        scene.hair.stretch_stiffness = scene.hair.bend_stiffness = stiffness;
        SCOPED( free_local ) double3* out = new_points( &scene );
        frozen_oracle_deform( &scene.hair, &options, out );
        int at_the_floor = 0;
        for ( int v = 0; v < scene.vertex_count; ++v )
        {
            if ( v % 20 > 0 )
            {
                const double3 rest = double3_sub( scene.hair.rest[v], scene.hair.rest[v - 1] ),
                              now = double3_sub( out[v], out[v - 1] );
                const double factor = 1.0 + frozen_oracle_eta( &options, v / 20, v % 20 ) / k,
                             turn = fabs( options.theta_max / k * frozen_oracle_xi( &options, v / 20, v % 20 ) );
                assert_close( double3_length( now ), double3_length( rest ) * fmax( factor, 0.05 ), 1e-14 );
                assert_close( double3_angle( rest, now ), turn > pi ? 2.0 * pi - turn : turn, 1e-10 );
                at_the_floor += factor < 0.05 ? 1 : 0;
            }
        }
        assert_true( ( at_the_floor > 100 ) == ( k < 1.0 ) );
    }
}

// Eq. 14: one at contact, and it leaves the radius smoothly
TEST( the_adhesion_kernel_is_one_at_contact_and_none_at_the_radius )
{
    const double h = 0.01;
    assert_true( frozen_oracle_kernel( 0.0, h ) == 1.0 && frozen_oracle_kernel( h, h ) == 0.0 );
    assert_true( frozen_oracle_kernel( 1.2 * h, h ) == 0.0 );
    assert_close( frozen_oracle_kernel( 0.5 * h, h ), 0.25, 1e-15 );
    assert_close( frozen_oracle_kernel( 0.99 * h, h ), 1e-4, 1e-15 );
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
        SCOPED( free_local ) double3* out = run( scene, &options );
        c[n] = measure_clumping( out, scene->vertex_count, scene->offsets[1], spacing );
        // 1e-15 m is the rounding of coordinates below one metre
        assert_true( !guarded || c[n].nearest_gap >= fmin( c[0].nearest_gap, options.min_distance ) - 1e-15 );
    }
}

TEST( locks_form_and_gaps_stay_as_the_prose_says )
{
    for ( int n = 0; n < 6; ++n )
    {
        const bool flat = n < 3;
        const double spacing = flat ? 0.004 : 0.008;
        SCOPED( frozen_scene_destroy )
        frozen_scene scene = new_scene( (frozen_scene_shape)( n % 3 ), flat ? 2 : 3, flat ? 40 : 49, 20, spacing );
        clumping c[4];
        clump_aligned_hair( &scene, flat ? 2 : 3, spacing, true, c );
        assert_true( c[1].locks < c[0].locks && c[2].locks < c[0].locks && c[3].locks < c[0].locks );
        assert_true( c[3].mean_gap > c[2].mean_gap && c[2].mean_gap > c[1].mean_gap );
    }
}
