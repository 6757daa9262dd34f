// The first two stages of the engine, freeze and align, against the double oracle (frozen_hair_shadow.h describes the
// method and the tolerances), every switch and every degenerate strand; then all combinations of stages.
#include "frozen_hair_shadow.h"

static const wisp_vec3 aside_2d = { 0.09f, -0.05f, 0.0f }, aside_3d = { 0.09f, -0.05f, 0.07f };

static wisp_vec3 aside( int dimension )
{
    return dimension == 2 ? aside_2d : aside_3d;
}

static void say( const char* what, hair_shadow shadow )
{
    print_message( "           %s: %.2g m off, %.0f %% of the tolerance\n", what, shadow.offset,
                   100.0 * shadow.fraction );
}

static hair_shadow worse( hair_shadow a, hair_shadow b )
{
    a.offset = fmax( a.offset, b.offset );
    a.fraction = fmax( a.fraction, b.fraction );
    return a;
}

// One number for each of up to 64 strands, evenly spread on a logarithmic scale and shuffled.
static void spread( float* values, int count, double lower, double upper )
{
    for ( int s = 0; s < count; ++s )
    {
        values[s] = (float)( lower * pow( upper / lower, (double)( s * 7 % count ) / ( count - 1 ) ) );
    }
}

// ---- freeze ----

TEST( freezing_follows_the_oracle_for_every_shape_stiffness_and_angle )
{
    const float stiffness[] = { 0.001f, 0.3f, 3.0f, 7.0f, 1e6f }, angle[] = { 0.0f, 0.785398163f, 3.14159274f };
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        hair_shadow worst = { 0 };
        for ( int n = 0; n < 3 * WISP_COUNT( stiffness ) * WISP_COUNT( angle ); ++n )
        {
            SCOPED( hair_groom_destroy )
            hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), dimension, 37, 20, 0.008f );
            wisp_frozen_hair_def def = hair_freeze_only();
            def.stretch_stiffness = def.bend_stiffness = stiffness[n / 3 % WISP_COUNT( stiffness )];
            def.max_bend_angle = angle[n / 3 / WISP_COUNT( stiffness )];
            worst = worse( worst, hair_follow( NULL, &groom, &def, 0 ) );
        }
        say( dimension == 2 ? "2D" : "3D", worst );
    }
}

TEST( stretching_and_bending_stiffness_are_told_apart )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 33, 20, 0.008f );
    float stretch[33], bend[33];
    spread( stretch, 33, 0.01, 1e6 );
    spread( bend, 33, 1e9, 0.2 );
    wisp_frozen_hair_def def = hair_freeze_only();
    def.stretch_stiffness = 2.0f;
    def.bend_stiffness = 11.0f;
    say( "one number for all", hair_follow( NULL, &groom, &def, 0 ) );
    def.strand_bend_stiffness = bend;
    say( "one a strand for bends", hair_follow( NULL, &groom, &def, 0 ) );
    def.strand_stretch_stiffness = stretch;
    say( "one a strand for both", hair_follow( NULL, &groom, &def, 0 ) );
}

TEST( every_event_and_every_seed_draws_the_numbers_of_the_oracle )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 20, 20, 0.008f );
    wisp_frozen_hair_def def = hair_freeze_only();
    hair_shadow worst = { 0 };
    for ( int command = 0; command < 4; ++command )
    {
        worst = worse( worst, hair_follow( NULL, &groom, &def, command ) );
    }
    def.seed = 0xfedcba9876543210u;
    worst = worse( worst, hair_follow( NULL, &groom, &def, 1 ) );
    say( "events 0 to 3, a large seed", worst );
}

// ---- align ----

TEST( aligning_follows_the_oracle_for_every_reach_and_intensity )
{
    const float intensity[] = { 0.0f, 0.2f, 0.8f, 1.0f };
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        hair_shadow worst = { 0 };
        for ( int n = 0; n < 3 * 2 * WISP_COUNT( intensity ); ++n )
        {
            SCOPED( hair_groom_destroy )
            hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), dimension, 37, 20, 0.008f );
            wisp_frozen_hair_def def = hair_align_only( aside( dimension ) );
            def.reach_nearest = n / 3 % 2 == 1;
            def.intensity = intensity[n / 6];
            def.reach = 0.11f;
            worst = worse( worst, hair_follow( NULL, &groom, &def, 0 ) );
        }
        say( dimension == 2 ? "2D" : "3D", worst );
        assert_true( worst.offset > 0.0 );
    }
}

TEST( every_strand_may_have_its_own_intensity )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 40, 20, 0.008f );
    float intensity[40];
    for ( int s = 0; s < 40; ++s )
    {
        intensity[s] = (float)( s * 7 % 40 ) / 39.0f;
    }
    wisp_frozen_hair_def def = hair_align_only( aside_3d );
    def.strand_intensity = intensity;
    say( "one a strand", hair_follow( NULL, &groom, &def, 0 ) );
}

// A straight strand, and cursors exactly behind and before its root, at its root, at its tip.
TEST( special_cursors_turn_a_strand_as_the_oracle_does )
{
    for ( int n = 0; n < 2; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 2 + n, 1, 17, 0.0f );
        const wisp_vec3 tip = groom.points[16], behind = { -tip.x, -tip.y, -tip.z }, root = groom.points[0];
        wisp_frozen_hair_def def = hair_align_only( behind );
        def.intensity = 1.0f;

        // a straight strand turned by pi about any perpendicular is its reflection in its root
        SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
        hair_assert_close( hair_distance( points[16], behind ), 0.0, 20.0 * HAIR_ROUNDING * 0.11 );
        free( points );

        def.cursor = tip;
        say( "parallel", hair_follow( NULL, &groom, &def, 0 ) );

        // under the cursor, and out of a reach of zero: bits stay the same
        def.cursor = root;
        points = hair_run( NULL, &groom, &def );
        assert_true( hair_same_bits( points, groom.points, 17 ) );
        free( points );
        def.cursor = behind;
        def.reach = 0.0f;
        points = hair_run( NULL, &groom, &def );
        assert_true( hair_same_bits( points, groom.points, 17 ) );
    }
}

TEST( a_reach_of_zero_takes_only_the_strand_whose_tip_is_the_cursor )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 30, 20, 0.008f );
    wisp_frozen_hair_def def = hair_align_only( groom.points[20 * 11 + 19] );
    def.reach = 0.0f;
    hair_follow( NULL, &groom, &def, 0 );
    SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
    for ( int s = 0; s < 30; ++s )
    {
        assert_int_equal( hair_same_bits( points + 20 * s, groom.points + 20 * s, 20 ), s != 11 );
    }
}

// Eq. 8: tip - mean of this hook is (2, -1)/3 and not (1, -1); turned onto y it is atan2( 1, 2 ) further than a quarter
TEST( a_hook_turns_its_direction_from_its_mean_to_the_cursor )
{
    const wisp_vec3 hook[] = { { 0, 0, 0 }, { 0, -1, 0 }, { 1, -1, 0 } };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 2, 1, &( int ){ 3 }, hook );
    wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ 0, 5, 0 } );
    def.intensity = 1.0f;
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
    const double turn = double3_angle( double3_make( 0.0, -1.0, 0.0 ), double3_widen( out[1] ) );
    hair_assert_close( turn, 0.5 * acos( -1.0 ) + atan2( 1.0, 2.0 ), 40.0 * HAIR_ROUNDING );
}

// Eq. 11: opposite but for rounding, the cross product is noise of any direction and must not be the axis
TEST( a_turn_from_the_rounded_opposite_ends_at_the_cursor )
{
    const wisp_random_key key = wisp_random_make_key( 5, 0, 0 );
    for ( int n = 0; n < 400; ++n )
    {
        float c[3];
        for ( int axis = 0; axis < 3; ++axis )
        {
            c[axis] = 0.2f * ( wisp_random_unit_float( key, (uint32_t)n, (uint32_t)axis, 0 ) - 0.5f );
        }
        const wisp_vec3 points[] = { { 0, 0, 0 }, { c[0], c[1], n % 2 == 0 ? 0.0f : c[2] } };
        const float back = -( 0.3f + 0.01f * (float)n );
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 2 + n % 2, 1, &( int ){ 2 }, points );
        wisp_frozen_hair_def def =
            hair_align_only( ( wisp_vec3 ){ back * points[1].x, back * points[1].y, back * points[1].z } );
        def.intensity = 1.0f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );

        // three rounded products are off the opposite by u each; the turn by pi has 40 u
        const double off = double3_angle( double3_widen( out[1] ), double3_widen( def.cursor ) );
        const double ratio = double3_length( double3_widen( out[1] ) ) / double3_length( double3_widen( points[1] ) );
        hair_assert_close( off, 0.0, 44.0 * HAIR_ROUNDING );
        hair_assert_close( ratio, 1.0, 40.0 * HAIR_ROUNDING );
    }
}

// ---- degenerate strands ----

TEST( strands_of_mixed_lengths_follow_the_oracle )
{
    const int lengths[] = { 3, 0, 17, 1, 40, 2, 0, 1 };
    int counts[41];
    for ( int s = 0; s < 41; ++s )
    {
        counts[s] = lengths[s * 5 % WISP_COUNT( lengths )];
    }
    for ( int n = 0; n < 6; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create_mixed( (hair_shape)( n / 2 ), 2 + n % 2, 41, counts, 0.005f );
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.cursor = aside( groom.dimension );
        say( n % 2 == 0 ? "2D" : "3D", hair_follow( NULL, &groom, &def, 0 ) );

        def.freeze = n % 4 < 2;
        def.reach_nearest = n % 3 == 0;
        def.clump_step_length = 0.003f;
        say( "third command", hair_follow( NULL, &groom, &def, 2 ) );
    }
}

// Coincident neighbours at the root, in the middle and at the tip, a strand that is one point, and two equal strands.
TEST( segments_without_length_stay_without_length )
{
    const wisp_vec3 points[] = {
        { 0, 0, 0 },      { 0, 0, 0 },           { 0, -0.01f, 0 },      { 0.005f, -0.02f, 0 }, //
        { 0.002f, 0, 0 }, { 0.002f, -0.01f, 0 }, { 0.002f, -0.01f, 0 }, { 0.004f, -0.02f, 0 }, //
        { 0.004f, 0, 0 }, { 0.004f, -0.01f, 0 }, { 0.006f, -0.02f, 0 }, { 0.006f, -0.02f, 0 }, //
        { 0.006f, 0, 0 }, { 0.006f, 0, 0 },      { 0.006f, 0, 0 },      { 0.006f, 0, 0 },      //
        { 0.004f, 0, 0 }, { 0.004f, -0.01f, 0 }, { 0.006f, -0.02f, 0 }, { 0.006f, -0.02f, 0 }, //
    };
    const int counts[] = { 4, 4, 4, 4, 4 };
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( dimension, 5, counts, points );
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.cursor = aside( dimension );
        for ( int n = 0; n < 4; ++n )
        {
            def.clump_iterations = n;
            say( "all stages", hair_follow( NULL, &groom, &def, n ) );
        }
        def = hair_freeze_only();
        SCOPED( free_local ) wisp_vec3* frozen = hair_run( NULL, &groom, &def );
        hair_assert_finite( frozen, groom.vertex_count );
        const int second[] = { 1, 6, 11, 13, 14, 15, 19 };
        for ( int n = 0; n < WISP_COUNT( second ); ++n )
        {
            assert_true( hair_same_bits( frozen + second[n], frozen + second[n] - 1, 1 ) );
        }
    }
}

// ---- together ----

TEST( every_combination_of_stages_follows_the_oracle )
{
    for ( int n = 0; n < 48; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( (hair_shape)( n / 16 ), 2 + n / 8 % 2, 16, 12, 0.005f );
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.freeze = ( n & 1 ) != 0;
        def.align = ( n & 2 ) != 0;
        def.clump = ( n & 4 ) != 0;
        def.cursor = aside( groom.dimension );
        hair_follow( NULL, &groom, &def, n % 3 );
        if ( n % 8 == 0 )
        {
            SCOPED( free_local ) wisp_vec3* points = hair_run( NULL, &groom, &def );
            assert_true( hair_same_bits( points, groom.points, groom.vertex_count ) );
        }
    }
}
