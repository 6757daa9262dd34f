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

// ---- Eq. 5, 8, 9, 10, 11, 12, 13: turning towards the cursor ----

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
