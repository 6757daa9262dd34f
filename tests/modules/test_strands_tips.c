// Tips that are held and released, what is refused of them and of rods with an elliptic section, and that strands without held
// tips have no pass for them. Closed forms are in tests/claims.
#include "strand_section_fixture.h"

static const float FRAME = 1.0f / 60.0f;

static const wisp_vec3 ALONG_X = { 1.0f, 0.0f, 0.0f };

// Move the tip in equal parts per step to a rotation and a displacement.
static void bring_tip( rod_world* rod, wisp_vec3 axis, double angle, wisp_vec3 displacement, int steps )
{
    for ( int i = 1; i <= steps; ++i )
    {
        const float part = (float)i / (float)steps;
        turn_tip( rod, axis, angle * i / steps,
                  ( wisp_vec3 ){ part * displacement.x, part * displacement.y, part * displacement.z } );
        strand_steps( rod->s.world, 1, FRAME );
    }
}

// ---- holds change ----

TEST( a_tip_that_is_released_swings_as_if_it_had_been_free )
{
    wisp_vec3 points[9];
    lay_rod( ALONG_X, 0.4f, 9, points );
    wisp_strand_dynamics_def def = rod_def( 1e-3f, 1e-3f );
    def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
    rod_world held, free;
    open_rod( &held, points, 9, 8, &def );
    open_rod( &free, points, 9, 8, &def );
    hold_tip( &held, WISP_STRAND_TIP_CLAMPED );
    hold_tip( &held, WISP_STRAND_TIP_FREE ); // before a step: nothing has moved
    strand_steps( held.s.world, 30, FRAME );
    strand_steps( free.s.world, 30, FRAME );
    assert_true( vec_distance( rod_point( &held, 8 ), rod_point( &free, 8 ) ) < 1e-4 );

    // held again where it is, and let go
    const wisp_vec3 caught = rod_point( &held, 8 );
    hold_tip( &held, WISP_STRAND_TIP_CLAMPED );
    strand_steps( held.s.world, 30, FRAME );
    assert_true( vec_distance( rod_point( &held, 8 ), caught ) < 1e-6 );
    hold_tip( &held, WISP_STRAND_TIP_FREE );
    strand_steps( held.s.world, 10, FRAME );
    assert_true( vec_distance( rod_point( &held, 8 ), caught ) > 1e-2 );
    close_rod( &held );
    close_rod( &free );
}

TEST( a_tip_moves_with_the_head_and_beyond_reach_it_is_counted )
{
    wisp_vec3 points[9];
    lay_rod( ALONG_X, 0.4f, 9, points );
    wisp_strand_dynamics_def def = rod_def( 1e-3f, 1e-3f );
    rod_world rod;
    open_rod( &rod, points, 9, 8, &def );
    hold_tip( &rod, WISP_STRAND_TIP_CLAMPED );
    bring_tip( &rod, ALONG_X, 0.0, ( wisp_vec3 ){ -0.1f, 0.0f, 0.0f }, 10 );
    const wisp_quat quarter = { 0.0f, 0.0f, sqrtf( 0.5f ), sqrtf( 0.5f ) }; // x to y
    assert_int_equal(
        wisp_move_strand_head( rod.s.world, rod.e, ( wisp_transform ){ quarter, { 0.0f, 0.0f, 0.2f } } ), WISP_OK );
    strand_steps( rod.s.world, 1, FRAME );
    assert_true( vec_distance( rod_point( &rod, 8 ), ( wisp_vec3 ){ 0.0f, 0.3f, 0.2f } ) < 1e-6 );
    assert_int_equal( wisp_world_counter( rod.s.world, WISP_COUNT_STRETCHED ), 0 );
    turn_tip( &rod, ALONG_X, 0.0, ( wisp_vec3 ){ 0.2f, 0.0f, 0.0f } );
    strand_steps( rod.s.world, 60, FRAME );
    assert_int_equal( wisp_world_counter( rod.s.world, WISP_COUNT_STRETCHED ), 60 );
    turn_tip( &rod, ALONG_X, 0.0, ( wisp_vec3 ){ -0.05f, 0.0f, 0.0f } );
    strand_steps( rod.s.world, 60, FRAME );
    for ( int i = 1; i < 9; ++i ) // it comes back to its lengths
    {
        assert_fraction( vec_distance( rod_point( &rod, i ), rod_point( &rod, i - 1 ) ), 0.05, 1e-3, "segment, m" );
    }
    close_rod( &rod );
}

TEST( tips_that_cannot_be_held_are_refused )
{
    wisp_vec3 points[3];
    lay_rod( ALONG_X, 1.0f, 3, points );
    wisp_strand_dynamics_def def = rod_def( 1.0f, 1.0f );
    rod_world rod;
    open_rod( &rod, points, 3, 1, &def );
    wisp_world* world = rod.s.world;
    const wisp_transform origin = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    wisp_transform far = origin;
    far.translation.x = 2e6f;
    assert_int_equal( wisp_move_strand_tip( world, rod.e, 0, origin ), WISP_CONFLICT );
    assert_int_equal( wisp_hold_strand_tip( world, rod.e, 1, WISP_STRAND_TIP_PINNED ), WISP_BAD_INPUT );
    assert_string_equal( wisp_world_message( world ), "strands: got the tip of strand 1, expected 0 .. 0" );
    assert_int_equal( wisp_hold_strand_tip( world, rod.e, -1, WISP_STRAND_TIP_PINNED ), WISP_BAD_INPUT );
    assert_int_equal( wisp_hold_strand_tip( world, rod.e, 0, WISP_STRAND_TIP_COUNT ), WISP_BAD_INPUT );
    hold_tip( &rod, WISP_STRAND_TIP_PINNED );
    assert_int_equal( wisp_move_strand_tip( world, rod.e, 0, far ), WISP_BAD_INPUT );
    assert_string_equal( wisp_world_message( world ),
                         "strands: the tip at (2e+06, 0, 0) is not within 1e6 m of the origin" );
    def.bending = WISP_STRAND_BEND_NONE;
    assert_int_equal( wisp_set_strand_dynamics( world, rod.e, &def ), WISP_OK );
    assert_int_equal( wisp_hold_strand_tip( world, rod.e, 0, WISP_STRAND_TIP_CLAMPED ), WISP_CONFLICT );
    strand_steps( world, 1, FRAME );
    close_rod( &rod );
}

TEST( only_strands_with_held_tips_have_passes_for_them )
{
    wisp_vec3 points[9];
    lay_rod( ALONG_X, 0.4f, 9, points );
    wisp_strand_dynamics_def def = rod_def( 1e-3f, 1e-3f );
    rod_world rod;
    open_rod( &rod, points, 9, 8, &def );
    strand_steps( rod.s.world, 1, FRAME );
    assert_false( plan_says( rod.s.world, "strands.tips", "item loop" ) );
    assert_false( plan_says( rod.s.world, "strands.tip_frames", "item loop" ) );
    hold_tip( &rod, WISP_STRAND_TIP_PINNED );
    strand_steps( rod.s.world, 1, FRAME );
    assert_true( plan_says( rod.s.world, "strands.tips", "item loop" ) );
    assert_false( plan_says( rod.s.world, "strands.rod_curved", "item loop" ) );
    hold_tip( &rod, WISP_STRAND_TIP_CLAMPED );
    strand_steps( rod.s.world, 1, FRAME );
    assert_true( plan_says( rod.s.world, "strands.rod_curved", "item loop" ) );
    close_rod( &rod );
}

static wisp_strand_dynamics_def ribbon_def( wisp_vec3 normal )
{
    wisp_strand_dynamics_def def = rod_def( 0.1f, 1.0f );
    def.edgewise_rigidity = 1.0f;
    def.flat_normal = normal;
    return def;
}

// ---- refusals ----

TEST( sections_that_cannot_be_are_refused )
{
    wisp_vec3 points[3];
    lay_rod( ALONG_X, 1.0f, 3, points );
    const wisp_strand_dynamics_def good = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    rod_world rod;
    open_rod( &rod, points, 3, 1, &good );
    wisp_strand_dynamics_def bad[7] = { good, good, good, good, good, good, good };
    bad[0].edgewise_rigidity = 0.05f;
    bad[1].edgewise_rigidity = NAN;
    bad[2].edgewise_rigidity = 0.0f;
    bad[3].natural_twist = INFINITY;
    bad[4].flat_normal.x = NAN;
    bad[5].bending = WISP_STRAND_BEND_NONE;
    bad[6].edgewise_rigidity = 1.1e5f * good.bend_rigidity;
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        assert_int_equal( wisp_set_strand_dynamics( rod.s.world, rod.e, bad + i ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( rod.s.world ), "strands: " ) );
    }
    strand_steps( rod.s.world, 1, FRAME );
    close_rod( &rod );
}
