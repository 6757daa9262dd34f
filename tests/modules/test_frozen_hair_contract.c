// Frozen hair (Kim 2026, Eq. 1-13): the engine against closed forms through its public interface alone. Eq. 14-19 are
// in test_frozen_hair_contract_clump.c, figures and table in test_frozen_hair_stats.c. A float rounds by u = 2^-24:
// where a bound for double precision is known, the bound here is the number of roundings times u times the size of
// the rounded value.
#include "frozen_hair_contract.h"

static const double pi = 3.14159265358979323846;

static double3 arm_of( const wisp_vec3* points, int a, int b )
{
    return double3_sub( double3_widen( points[b] ), double3_widen( points[a] ) );
}

// ---- Eq. 1-7: strands, lengths, bends ----

// Eq. 1
TEST( strands_come_back_in_the_users_order_and_roots_stay )
{
    const int lengths[] = { 3, 0, 17, 1, 40, 2 };
    int counts[50];
    for ( int s = 0; s < 50; ++s )
    {
        counts[s] = lengths[s * s % WISP_COUNT( lengths )];
    }
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create_mixed( HAIR_CURLY, 3, 50, counts, 0.004f );
    wisp_frozen_hair_def def = hair_no_stages();
    SCOPED( free_local ) wisp_vec3* still = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( still, groom.points, groom.vertex_count ) );
    def = wisp_default_frozen_hair_def();
    SCOPED( free_local ) wisp_vec3* moved = hair_run( NULL, &groom, &def );
    for ( int s = 0; s < 50; ++s )
    {
        int root = groom.offsets[s], count = counts[s];
        assert_true( count == 0 || hair_same_bits( moved + root, groom.points + root, 1 ) );
        assert_true( count < 2 || !hair_same_bits( moved + root, groom.points + root, count ) );
    }
}

// Eq. 2: without random changes a segment is its length times its tangent, so the output tests both.
TEST( tangent_and_length_of_any_segment_multiply_to_the_segment )
{
    enum
    {
        strands = 1000
    };
    const wisp_random_key key = wisp_random_make_key( 3, 0, 0 );
    static wisp_vec3 points[2 * strands];
    static int counts[strands];
    for ( int s = 0; s < strands; ++s )
    {
        float scale = (float)pow( 10.0, (double)( s % 10 ) - 6.0 );
        float c[3];
        for ( int axis = 0; axis < 3; ++axis )
        {
            c[axis] = scale * ( wisp_random_unit_float( key, (uint32_t)s, (uint32_t)axis, 0 ) - 0.5f );
        }
        points[2 * s + 1] = ( wisp_vec3 ){ c[0], c[1], c[2] };
        counts[s] = 2;
    }
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 3, strands, counts, points );
    wisp_frozen_hair_def def = hair_freeze_only();
    def.stretch_stiffness = def.bend_stiffness = 1e12f;
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
    for ( int s = 0; s < strands; ++s )
    {
        // two lengths of 4 u each, a division, a product
        double length = double3_length( double3_widen( points[2 * s + 1] ) );
        hair_assert_close( hair_distance( out[2 * s + 1], points[2 * s + 1] ) / length, 0.0, 10.0 * u );
    }
}

// Eq. 3 and 7: the drawn length of a segment is its actual length
TEST( segments_have_the_length_that_was_drawn_for_them )
{
    const float stiffness[] = { 7.0f, 3.0f, 0.3f };
    for ( int n = 0; n < 3 * WISP_COUNT( stiffness ); ++n )
    {
        hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), 3, 200, 20, 0.008f );
        wisp_frozen_hair_def def = hair_freeze_only();
        const double k = (double)( def.stretch_stiffness = stiffness[n / 3] );
        wisp_vec3* out = hair_run( NULL, &groom, &def );

        // both ends are rounded, the length itself by a dozen roundings of up to 1 + 1/k
        double ends = 4.0 * u * extent( out, groom.vertex_count );
        int at_the_floor = 0;
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            if ( v % 20 == 0 )
            {
                continue;
            }
            double l0 = hair_distance( groom.points[v], groom.points[v - 1] ),
                   length = hair_distance( out[v], out[v - 1] );
            double factor = 1.0 + ( 2.0 * draw( 1, v / 20, v % 20 ) - 1.0 ) / k;
            hair_assert_close( length, l0 * fmax( factor, 0.05 ), ends + 12.0 * u * l0 * ( 1.0 + 1.0 / k ) );
            assert_true( length <= l0 * ( 1.0 + 1.0 / k ) + ends );
            assert_true( length >= l0 * fmax( 1.0 - 1.0 / k, 0.05 ) - ends );
            at_the_floor += factor < 0.05 ? 1 : 0;
        }
        // below a stiffness of one the printed equation would make lengths negative
        assert_true( ( at_the_floor > 100 ) == ( k < 1.0 ) );
        free( out );
        hair_groom_destroy( &groom );
    }
}

// |l*/l0 - 1| of uniform numbers has the mean alpha/2, l*/l0 - 1 the deviation alpha/sqrt 3
TEST( relative_lengths_spread_as_the_printed_percentages_say )
{
    const double stiffness[] = { 7.0, 3.0 }, printed_mean[] = { 0.071, 0.167 };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 3, 500, 20, 0.008f );
    for ( int n = 0; n < 2; ++n )
    {
        wisp_frozen_hair_def def = hair_freeze_only();
        def.stretch_stiffness = (float)stiffness[n];
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        double mean = 0.0, square = 0.0, count = 500.0 * 19.0, alpha = 1.0 / stiffness[n];
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            double l0 = v % 20 > 0 ? hair_distance( groom.points[v], groom.points[v - 1] ) : 0.0;
            double change = v % 20 > 0 ? hair_distance( out[v], out[v - 1] ) / l0 - 1.0 : 0.0;
            mean += fabs( change ) / count;
            square += change * change / count;
        }
        // three deviations of a sample: |U(-1,1)| deviates by 1/sqrt 12; its fourth moment is 9/5 of the squared
        // second
        hair_assert_close( mean, alpha / 2.0, 3.0 * alpha / sqrt( 12.0 * count ) );
        hair_assert_close( mean, printed_mean[n], 3.0 * alpha / sqrt( 12.0 * count ) + 0.0005 );
        hair_assert_close( sqrt( square ), alpha / sqrt( 3.0 ),
                           3.0 * alpha / sqrt( 3.0 ) * sqrt( 0.8 / count ) / 2.0 );
    }
}

// Eq. 4: an axis that were not a unit vector perpendicular to the segment would turn it by less
TEST( segments_turn_by_exactly_the_angle_that_was_drawn )
{
    for ( int n = 0; n < 6; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( (hair_shape)( n / 2 ), 2 + n % 2, 100, 20, 0.008f );
        wisp_frozen_hair_def def = hair_freeze_only();
        def.bend_stiffness = 2.0f;
        def.stretch_stiffness = 1e9f;
        const double most = (double)def.max_bend_angle / 2.0;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        double ends = 4.0 * u * extent( out, groom.vertex_count );
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            if ( v % 20 > 0 )
            {
                double3 before = arm_of( groom.points, v - 1, v ), after = arm_of( out, v - 1, v );
                double turned = double3_angle( before, after );
                double drawn = fabs( most * ( 2.0 * draw( 2, v / 20, v % 20 ) - 1.0 ) );
                hair_assert_close( turned, drawn, ends / double3_length( after ) + 30.0 * u );
                assert_true( turned <= most + ends / double3_length( after ) + 30.0 * u );
            }
        }
    }
}

// Eq. 4: the axis of straight hair is random, but depends on the hair and not on the command
TEST( straight_hair_bends_about_the_same_axis_at_every_command )
{
    hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 3, 60, 20, 0.008f );
    wisp_frozen_hair_def def = hair_freeze_only();
    def.bend_stiffness = 1.0f;
    wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    wisp_vec3* first = hair_points( world, entity, groom.vertex_count );
    hair_command( world, entity, def.cursor );
    hair_step( world );
    const wisp_vec3* second = hair_view( world, entity, groom.vertex_count );
    double ends = 8.0 * u * extent( first, groom.vertex_count ) / 0.007, spread = 0.0;
    int compared = 0;
    for ( int v = 0; v < groom.vertex_count; ++v )
    {
        double3 t = arm_of( groom.points, 0, 1 );
        double3 a = double3_cross( t, arm_of( first, v - ( v % 20 > 0 ), v ) );
        double3 b = double3_cross( t, arm_of( second, v - ( v % 20 > 0 ), v ) );
        double size_a = double3_length( a ) / double3_dot( t, t ), size_b = double3_length( b ) / double3_dot( t, t );
        if ( v % 20 == 0 || size_a < 0.05 || size_b < 0.05 )
        {
            continue; // a root, or an angle too small to determine its axis
        }
        double sine = double3_length( double3_cross( a, b ) ) / ( double3_length( a ) * double3_length( b ) );
        hair_assert_close( sine, 0.0, ends / size_a + ends / size_b );
        spread += fabs( a.x ) > fabs( a.z ) ? 1.0 : 0.0;
        compared += 1;
    }
    assert_true( compared > 500 );
    assert_in_range( (int)spread, compared / 4, 3 * compared / 4 ); // axes point everywhere
    free( first );
    wisp_world_destroy( world );
    hair_groom_destroy( &groom );
}

// Eq. 6-7: the stiff limit
TEST( infinitely_stiff_hair_returns_to_rest )
{
    for ( int n = 0; n < 6; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( (hair_shape)( n / 2 ), 2 + n % 2, 50, 20, 0.008f );
        wisp_frozen_hair_def def = hair_freeze_only();
        def.stretch_stiffness = def.bend_stiffness = 1e9f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        for ( int v = 0; v < groom.vertex_count; ++v )
        {
            // every vertex adds a rounded coordinate and a step with the roundings of Eq. 2
            double tolerance = 20.0 * u * ( extent( groom.points, groom.vertex_count ) + 10.0 * 0.0075 );
            hair_assert_close( hair_distance( out[v], groom.points[v] ), 0.0, tolerance );
        }
    }
}

// ---- Eq. 5, 8, 9, 10, 11, 12, 13: turning towards the cursor ----

// Eq. 5: a rotation keeps all distances and the handedness of a curl
TEST( a_whole_turn_is_rigid_and_keeps_a_curls_handedness )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 40, 20, 0.008f );
    wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ 0.11f, 0.03f, -0.05f } );
    def.intensity = 1.0f;
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );

    // 34 roundings of a rotation of an arm of 0.09 m, and two rounded coordinates, at each end
    double ends = 2.0 * u * ( 34.0 * 0.09 + 2.0 * extent( out, groom.vertex_count ) );
    for ( int s = 0; s < 40; ++s )
    {
        const wisp_vec3 *a = groom.points + 20 * s, *b = out + 20 * s;
        for ( int i = 0; i < 20; ++i )
        {
            for ( int j = 0; j < i; ++j )
            {
                hair_assert_close( hair_distance( b[i], b[j] ), hair_distance( a[i], a[j] ), ends );
            }
        }
        double before = double3_dot( arm_of( a, 0, 1 ), double3_cross( arm_of( a, 1, 2 ), arm_of( a, 2, 3 ) ) );
        double after = double3_dot( arm_of( b, 0, 1 ), double3_cross( arm_of( b, 1, 2 ), arm_of( b, 2, 3 ) ) );
        double segment = hair_distance( a[0], a[1] );
        hair_assert_close( after, before, 3.0 * ends * segment * segment * 1.1 );
        assert_true( fabs( before ) > 0.05 * segment * segment * segment );
    }
}

// Eq. 8-9
TEST( a_straight_strand_turns_its_tip_to_the_cursor_and_a_hook_its_direction_from_its_mean )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 3, 20, 20, 0.008f );
    wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ -0.1f, -0.02f, 0.09f } );
    def.intensity = 1.0f;
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
    for ( int s = 0; s < 20; ++s )
    {
        // a mean of 20 coordinates rounds 14 times; half a strand of 0.07 m is the arm of its direction
        double mean_error = 14.0 * u * extent( groom.points, groom.vertex_count ) / 0.07;
        double3 t = double3_sub( double3_widen( def.cursor ), double3_widen( out[20 * s] ) );
        hair_assert_close( double3_angle( arm_of( out + 20 * s, 0, 19 ), t ), 0.0, mean_error + 60.0 * u );
    }
    free( out );
    hair_groom_destroy( &groom );

    // tip - mean of this hook is (2, -1)/3 and not (1, -1); turned onto y it is atan2( 1, 2 ) further than a quarter
    const wisp_vec3 hook[] = { { 0, 0, 0 }, { 0, -1, 0 }, { 1, -1, 0 } };
    const int counts[] = { 3 };
    groom = hair_groom_from( 2, 1, counts, hook );
    def = hair_align_only( ( wisp_vec3 ){ 0, 5, 0 } );
    def.intensity = 1.0f;
    out = hair_run( NULL, &groom, &def );
    double turn = double3_angle( arm_of( hook, 0, 1 ), arm_of( out, 0, 1 ) );
    hair_assert_close( turn, pi / 2.0 + atan2( 1.0, 2.0 ), 40.0 * u );
}

// Eq. 10
TEST( strands_out_of_reach_keep_their_bits )
{
    for ( int nearest = 0; nearest <= 1; ++nearest )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 2, 60, 20, 0.008f );
        wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ 0.2f, -0.07f, 0.0f } );
        def.reach = 0.1f;
        def.reach_nearest = nearest != 0;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        int moved = 0;
        for ( int s = 0; s < 60; ++s )
        {
            double near = INFINITY;
            for ( int i = nearest ? 0 : 19; i < 20; ++i )
            {
                near = fmin( near, hair_distance( groom.points[20 * s + i], def.cursor ) );
            }
            bool same = hair_same_bits( out + 20 * s, groom.points + 20 * s, 20 );
            assert_int_equal( same, near > (double)def.reach );
            moved += same ? 0 : 1;
        }
        assert_in_range( moved, 10, 50 );
    }
}

// Eq. 11: after a whole turn the direction is that of the cursor, even from the opposite
TEST( a_whole_turn_points_at_the_cursor_even_from_the_opposite )
{
    for ( int n = 0; n < 24; ++n )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_create( (hair_shape)( n % 3 ), 2 + n / 3 % 2, 12, 20, 0.01f );
        const double z = groom.dimension == 2 ? 0.0 : 0.4 * sin( 3.0 * n );
        wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ (float)sin( n ), (float)cos( n ), (float)z } );
        def.intensity = 1.0f;
        const wisp_vec3 tip = groom.points[19];
        if ( n >= 12 )
        {
            def.cursor = ( wisp_vec3 ){ -tip.x, -tip.y, -tip.z }; // from the first root, behind it
        }
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        for ( int s = 0; s < 12; ++s )
        {
            const wisp_vec3* p = out + 20 * s;
            SCOPED( free_local ) double3* wide = hair_widen_all( p, 20 );
            double3 v = frozen_oracle_representative( wide, 20, FROZEN_ORACLE_DIRECTION_MEAN );
            double3 t = double3_sub( double3_widen( def.cursor ), wide[0] );

            // twenty rounded coordinates before and after the turn, relative to the length of v; the axis of an
            // almost opposite strand is less accurate, but a turn by pi about it ends opposite all the same
            double error = 48.0 * u * extent( out, groom.vertex_count ) / double3_length( v ) + 40.0 * u;
            hair_assert_close( double3_angle( v, t ), 0.0, error );
        }
    }
}

// Eq. 11: opposite but for rounding, the cross product is noise of any direction and must not be the axis
TEST( a_turn_from_the_rounded_opposite_ends_at_the_cursor )
{
    enum
    {
        strands = 400
    };
    const wisp_random_key key = wisp_random_make_key( 5, 0, 0 );
    for ( int n = 0; n < strands; ++n )
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
        hair_assert_close( off, 0.0, 44.0 * u );
        hair_assert_close( double3_length( double3_widen( out[1] ) ) / double3_length( double3_widen( points[1] ) ),
                           1.0, 40.0 * u );
    }
}

// Eq. 12
TEST( the_turn_grows_linearly_from_the_intensity_to_one )
{
    const float intensity[] = { 0.0f, 0.2f, 0.8f, 1.0f };
    for ( int n = 0; n < 2 * WISP_COUNT( intensity ); ++n )
    {
        const float x = intensity[n / 2];
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 2 + n % 2, 1, 20, 0.0f );

        // (0, 1, 2) is perpendicular to (2, -6, 3), (1, 0, 0) to (0, -7, 0)
        wisp_frozen_hair_def def =
            hair_align_only( n % 2 == 0 ? ( wisp_vec3 ){ 1, 0, 0 } : ( wisp_vec3 ){ 0, 1, 2 } );
        def.intensity = x;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        for ( int i = 1; i < 20; ++i )
        {
            double w = (double)x + ( 1.0 - (double)x ) * i / 19.0;
            double turn = double3_angle( arm_of( groom.points, 0, i ), arm_of( out, 0, i ) );
            hair_assert_close( turn, w * pi / 2.0, 60.0 * u );
        }
    }
    const wisp_vec3 lone[] = { { 0.01f, 0.02f, 0.03f } };
    const int counts[] = { 1 };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_from( 3, 1, counts, lone );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( out, lone, 1 ) );
}

// Eq. 12: a strand ends at its own N - 1, whatever the length of those beside it; it keeps its turn until the next command
TEST( a_short_strand_among_long_ones_turns_as_if_alone_at_every_command )
{
    SCOPED( hair_groom_destroy )
    hair_groom both = hair_groom_create_mixed( HAIR_CURLY, 3, 2, ( const int[] ){ 4, 20 }, 0.0f );
    SCOPED( hair_groom_destroy ) hair_groom alone = hair_groom_from( 3, 1, ( const int[] ){ 4 }, both.points );
    wisp_frozen_hair_def def = hair_align_only( ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    def.base = WISP_FROZEN_BASE_STROKE;
    def.intensity = 0.3f;
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    const wisp_entity a = hair_add_frozen( world, &both, &def ), b = hair_add_frozen( world, &alone, &def );
    for ( int n = 0; n < 5; ++n )
    {
        const wisp_vec3 cursor = { (float)sin( n ), (float)cos( n ), 0.3f * (float)n - 0.6f };
        hair_command( world, a, cursor );
        hair_command( world, b, cursor );
        hair_step( world );
        assert_true( hair_same_bits( hair_view( world, a, 24 ), hair_view( world, b, 4 ), 4 ) );
    }
    assert_true( hair_distance( hair_view( world, b, 4 )[3], alone.points[3] ) > 1e-3 );
}

// Eq. 13 by an arc; the printed chord shortens
TEST( an_arc_keeps_distances_to_the_root )
{
    const float angles[] = { 0.4f, 1.5707964f, 2.9f };
    for ( int n = 0; n < WISP_COUNT( angles ); ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_STRAIGHT, 2, 1, 20, 0.0f );
        wisp_frozen_hair_def def =
            hair_align_only( ( wisp_vec3 ){ (float)sin( angles[n] ), (float)-cos( angles[n] ), 0.0f } );
        def.intensity = 0.2f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        for ( int i = 1; i < 20; ++i )
        {
            double ratio = double3_length( arm_of( out, 0, i ) ) / double3_length( arm_of( groom.points, 0, i ) );
            hair_assert_close( ratio, 1.0, 60.0 * u );
        }
    }
}
