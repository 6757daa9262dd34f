// Tips that are held, against closed forms: catenary, twisted rods under tension, rings under load and twist; release, what
// is refused, and that strands without held tips have no pass for them. Rods with an elliptic section: cantilevers flat, on
// edge and askew, natural twist, lateral buckling; what is refused.
#include "strand_section_fixture.h"

static const float FRAME = 1.0f / 60.0f;
static const double PI = 3.141592653589793;

static const wisp_vec3 ALONG_X = { 1.0f, 0.0f, 0.0f };
static const wisp_vec3 NOWHERE = { 0.0f, 0.0f, 0.0f };

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

// ---- two ends ----

// L = 2 a sinh( d / 2a ) with d = 0.8 L: sag 0.26543751 L, largest tension 0.603639 of the weight.
TEST( a_chain_between_two_ends_hangs_as_a_catenary )
{
    enum
    {
        COUNT = 65,
    };
    for ( int bends = 0; bends < 2; ++bends )
    {
        wisp_vec3 points[COUNT];
        float tensions[COUNT];
        lay_rod( ALONG_X, 1.0f, COUNT, points );
        wisp_strand_dynamics_def def = rod_def( 1e-6f, 0.0f );
        def.bending = bends ? WISP_STRAND_BEND_ROD : WISP_STRAND_BEND_NONE;
        def.gravity = ( wisp_vec3 ){ 0.0f, -9.81f, 0.0f };
        def.damping = 3.0f;
        rod_world rod;
        open_rod( &rod, points, COUNT, 8, &def );
        hold_tip( &rod, WISP_STRAND_TIP_PINNED ); // taut at first
        bring_tip( &rod, ALONG_X, 0.0, ( wisp_vec3 ){ -0.2f, 0.0f, 0.0f }, 60 );
        strand_steps( rod.s.world, 400, FRAME );
        assert_fraction( -(double)rod_point( &rod, COUNT / 2 ).y, 0.26543751, 5e-4, "catenary, sag, m" );
        assert_true( fabsf( rod_point( &rod, COUNT - 1 ).x - 0.8f ) < 1e-6f );
        // half a segment hangs between the support and the middle of the first one
        assert_int_equal( wisp_read_strand_tension( rod.s.world, rod.e, tensions ), WISP_OK );
        const double slope = 55.9254 * PI / 180.0, top = 0.603639 * 9.81;
        assert_fraction( (double)tensions[0], top - 0.5 * 9.81 / ( COUNT - 1 ) * sin( slope ), 2e-3, "tension, N" );
        close_rod( &rod );
    }
}

// Amplitude of the buckling of a rod of 1 m, EI = GJ = 1 N m^2, both of whose ends keep their direction while the tip is
// free to move, pulled along x by `force` and twisted by `angle`.
static double writhe( float force, double angle )
{
    enum
    {
        COUNT = 33,
    };
    wisp_vec3 points[COUNT];
    float masses[COUNT];
    lay_rod( ALONG_X, 1.0f, COUNT, points );
    for ( int i = 0; i < COUNT; ++i )
    {
        masses[i] = i + 1 < COUNT ? 4e-4f : 0.2f;
    }
    wisp_strand_dynamics_def def = rod_def( 1.0f, 1.0f );
    def.gravity = ( wisp_vec3 ){ 5.0f * force, 1e-3f, 0.0f };
    def.vertex_masses = masses;
    def.damping = 0.5f;
    rod_world rod;
    open_rod( &rod, points, COUNT, 64, &def );
    hold_tip( &rod, WISP_STRAND_TIP_GUIDED );
    bring_tip( &rod, ALONG_X, angle, NOWHERE, 120 );
    strand_steps( rod.s.world, 240, FRAME );
    double most = 0.0;
    for ( int i = 0; i < COUNT; ++i )
    {
        const wisp_vec3 p = rod_point( &rod, i );
        most = fmax( most, hypot( (double)p.y, (double)p.z ) );
    }
    close_rod( &rod );
    return most;
}

// Greenhill 1883: M^2 / 4 EI = F + pi^2 EI / L^2. Without a force the rod buckles at a twist of one turn, with EI = GJ.
TEST( a_twisted_rod_under_tension_buckles_at_the_moment_of_greenhill )
{
    const float forces[] = { 0.0f, 20.0f };
    for ( int i = 0; i < WISP_COUNT( forces ); ++i )
    {
        const double critical =
            2.0 * sqrt( 1.03 * (double)forces[i] + PI * PI ) /* the rod itself is 6 % of the weight */;
        assert_true( writhe( forces[i], 0.98 * critical ) < 0.001 );
        assert_true( writhe( forces[i], 1.02 * critical ) > 0.01 );
    }
}

// Light hair whose clamped tips were moved towards the roots comes to rest: tension that is applied without a solve is bounded.
TEST( light_hair_with_moved_tips_comes_to_rest )
{
    enum
    {
        COUNT = 16,
    };
    wisp_vec3 points[COUNT];
    float masses[COUNT];
    for ( int i = 0; i < COUNT; ++i )
    {
        points[i] = ( wisp_vec3 ){ 0.0f, -0.1f * (float)i / (float)( COUNT - 1 ), 0.0f };
        masses[i] = 4.3333e-8f;
    }
    const float turns[] = { 0.0f, 2.967f }; // rad, 170 degrees
    for ( int k = 0; k < WISP_COUNT( turns ); ++k )
    {
        wisp_strand_dynamics_def def = wisp_default_strand_dynamics_def();
        def.rest = WISP_STRAND_REST_STRAIGHT;
        def.vertex_masses = masses;
        def.damping = 4.0f;
        rod_world rod;
        open_rod( &rod, points, COUNT, 10, &def );
        assert_int_equal( wisp_request( rod.s.world, rod.e, WISP_MOTION_STATS ), WISP_OK );
        hold_tip( &rod, WISP_STRAND_TIP_CLAMPED );
        bring_tip( &rod, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f }, (double)turns[k], ( wisp_vec3 ){ 0.0f, 0.03f, 0.0f },
                   30 );
        strand_steps( rod.s.world, 270, FRAME );
        wisp_motion_stats stats;
        assert_int_equal( wisp_read_motion_stats( rod.s.world, rod.e, &stats ), WISP_OK );
        assert_true( stats.speed_max < 0.05 ); // m/s; it was 0.28 and 0.36
        close_rod( &rod );
    }
}

// ---- loops ----

enum
{
    RING = 49, // vertices, the last on the first
    TOP = ( RING - 1 ) / 2,
};

// A ring of 1 m in the xy plane that stands on its root. Its first segment is level: a straight rod that is bent into it
// bends at the joint as anywhere else, and turns until the root is level.
static void lay_ring( wisp_vec3* points )
{
    const double step = 2.0 * PI / ( RING - 1 ), radius = 0.5 / ( ( RING - 1 ) * sin( 0.5 * step ) );
    for ( int i = 0; i < RING; ++i )
    {
        const double a = step * ( i % ( RING - 1 ) ) - 0.5 * step;
        points[i] = ( wisp_vec3 ){ (float)( radius * ( sin( a ) + sin( 0.5 * step ) ) ),
                                   (float)( radius * ( cos( 0.5 * step ) - cos( a ) ) ), 0.0f };
    }
}

static void open_ring( rod_world* rod, int substeps, const wisp_strand_dynamics_def* def )
{
    wisp_vec3 points[RING];
    lay_ring( points );
    open_rod( rod, points, RING, substeps, def );
    hold_tip( rod, WISP_STRAND_TIP_CLAMPED );
}

// How far a ring of a straight rod leaves its plane, over its length, when one end of it was turned by so much.
static double out_of_plane( double twist, double twist_rigidity )
{
    wisp_strand_dynamics_def def = rod_def( 1.0f, (float)twist_rigidity );
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 1e-4f };
    def.damping = 1.0f;
    rod_world rod;
    open_ring( &rod, 8, &def );
    bring_tip( &rod, ALONG_X, twist, NOWHERE, 120 );
    strand_steps( rod.s.world, 480, FRAME );
    double most = 0.0;
    for ( int i = 0; i < RING; ++i )
    {
        most = fmax( most, fabs( (double)rod_point( &rod, i ).z ) );
    }
    close_rod( &rod );
    return most;
}

// 2 pi sqrt( 3 ) EI / GJ (Michell 1889; Zajac 1962; Goriely 2006).
TEST( a_twisted_ring_leaves_its_plane_at_the_twist_of_michell )
{
    const double ratios[] = { 1.0, 1.5 }; // GJ / EI
    for ( int i = 0; i < WISP_COUNT( ratios ); ++i )
    {
        const double critical = 2.0 * PI * sqrt( 3.0 ) / ratios[i];
        assert_true( out_of_plane( 0.98 * critical, ratios[i] ) < 0.005 );
        assert_true( out_of_plane( 1.02 * critical, ratios[i] ) > 0.015 );
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

// ---- cantilevers ----

// The tip of a cantilever of 1 m along x under 0.05 N/m along -y, after so many steps.
static wisp_vec3 tip_after( int steps, wisp_strand_dynamics_def def )
{
    enum
    {
        COUNT = 33,
    };
    wisp_vec3 points[COUNT];
    lay_rod( ALONG_X, 1.0f, COUNT, points );
    def.gravity = ( wisp_vec3 ){ 0.0f, -0.05f, 0.0f };
    def.damping = 5.0f;
    rod_world rod;
    open_rod( &rod, points, COUNT, 8, &def );
    strand_steps( rod.s.world, steps, FRAME );
    const wisp_vec3 tip = rod_point( &rod, COUNT - 1 );
    close_rod( &rod );
    return tip;
}

// The same at rest.
static wisp_vec3 sagged_tip( wisp_strand_dynamics_def def )
{
    return tip_after( 600, def );
}

static wisp_strand_dynamics_def ribbon_def( wisp_vec3 normal )
{
    wisp_strand_dynamics_def def = rod_def( 0.1f, 1.0f );
    def.edgewise_rigidity = 1.0f;
    def.flat_normal = normal;
    return def;
}

TEST( a_ribbon_sags_as_the_rod_that_it_is_in_each_plane )
{
    const wisp_vec3 flat = sagged_tip( ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } ) );
    const wisp_vec3 on_edge = sagged_tip( ribbon_def( ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } ) );
    const wisp_vec3 soft = sagged_tip( rod_def( 0.1f, 1.0f ) ), stiff = sagged_tip( rod_def( 1.0f, 1.0f ) );
    // w L^4 / 8 EI, off by the square of a segment over the length, 0.1 %, and on the flat side by the large rotation
    assert_fraction( -(double)on_edge.y, 0.05 / 8.0, 2e-3, "on edge, m" );
    assert_fraction( -(double)flat.y, (double)-soft.y, 1e-4, "flat, m" );
    assert_fraction( -(double)on_edge.y, (double)-stiff.y, 1e-4, "as a round rod, m" );
    assert_true( fabsf( flat.z ) < 1e-6f && fabsf( on_edge.z ) < 1e-6f );
}

// Askew by 45 degrees the load has a part in each plane, and the tip moves sideways.
TEST( a_ribbon_askew_deflects_sideways )
{
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 1.0f } );
    def.bend_rigidity = 0.5f; // small rotations
    const wisp_vec3 tip = sagged_tip( def );
    const double flat = 0.05 / ( 8.0 * 0.5 ), edge = 0.05 / 8.0;
    assert_fraction( -(double)tip.y, 0.5 * ( flat + edge ), 5e-3, "down, m" );
    assert_fraction( -(double)tip.z, 0.5 * ( flat - edge ), 5e-3, "sideways, m" );
}

// The flat side turns along the rod. Under a small load the tip sinks by the integral of q (L - s)^3 / 2 times the
// compliance in the plane of the load at s, cos^2 / EI + sin^2 / EI'.
TEST( natural_twist_turns_the_flat_side_along_the_rod )
{
    const double twist = 3.141592653589793;
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    def.bend_rigidity = 0.5f;
    def.natural_twist = (float)twist;
    double sum = 0.0;
    for ( int i = 0; i < 1000; ++i )
    {
        const double s = ( i + 0.5 ) / 1000.0, c = cos( twist * s );
        sum += 0.05 * 0.5 * pow( 1.0 - s, 3.0 ) * ( c * c / 0.5 + ( 1.0 - c * c ) ) / 1000.0;
    }
    assert_fraction( -(double)sagged_tip( def ).y, sum, 5e-3, "twisted ribbon, m" );
    def.rest = WISP_STRAND_REST_SHAPE;
    assert_fraction( -(double)sagged_tip( def ).y, sum, 5e-3, "twisted ribbon of its shape, m" );
    def.rest = WISP_STRAND_REST_SAG_FREE;
    assert_true( fabsf( sagged_tip( def ).y ) < 1e-5f );
}

// ---- lateral buckling ----

// How far the tip of a deep cantilever with a point load at its end moves sideways, over a sideways load of a thousandth.
static double sideways( float load, float edgewise )
{
    enum
    {
        COUNT = 17,
    };
    wisp_vec3 points[COUNT];
    float masses[COUNT];
    lay_rod( ALONG_X, 1.0f, COUNT, points );
    for ( int i = 0; i < COUNT; ++i )
    {
        masses[i] = i + 1 < COUNT ? 1e-4f : 0.1f;
    }
    wisp_strand_dynamics_def def = rod_def( 1.0f, 1.0f );
    def.edgewise_rigidity = edgewise;
    def.flat_normal = ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f };
    def.gravity = ( wisp_vec3 ){ 0.0f, -10.0f * load, 1e-3f * load };
    def.vertex_masses = masses;
    def.damping = 3.0f;
    rod_world rod;
    open_rod( &rod, points, COUNT, 16, &def );
    strand_steps( rod.s.world, 1200, FRAME );
    const double z = (double)rod_point( &rod, COUNT - 1 ).z / (double)load;
    close_rod( &rod );
    return z;
}

// P = 4.013 sqrt( EI GJ ) / L^2 (Prandtl 1899, Michell 1899), over sqrt( ( 1 - EI/EI' ) ( 1 - GJ/EI' ) ) because the bent
// beam is an arch. Below it a sideways load is amplified by 1 / ( 1 - (P / P_cr)^2 ).
TEST( a_deep_cantilever_buckles_sideways_at_the_load_of_prandtl )
{
    const double low = 1.0, high = 3.8 * 3.8, amplified = sideways( 1.0f, 200.0f ) / sideways( 3.8f, 200.0f );
    const double critical = sqrt( ( high - amplified * low ) / ( 1.0 - amplified ) );
    assert_fraction( critical, 4.013 / ( 1.0 - 1.0 / 200.0 ), 0.03, "lateral buckling, N" );
}

// ---- the flattest section ----

// EI is what flatness in single precision leaves of EI'. Across the flat side motion is slow, so it takes long to rest.
TEST( the_flattest_ribbons_sag_as_the_rod_that_they_are )
{
    wisp_strand_dynamics_def def = ribbon_def( ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    const double round = (double)tip_after( 3000, rod_def( 0.1f, 1.0f ) ).y;
    def.edgewise_rigidity = 1e4f * def.bend_rigidity;
    assert_fraction( (double)tip_after( 3000, def ).y, round, 1e-3, "1e4 times stiffer on edge, m" );
    def.edgewise_rigidity = 1e5f * def.bend_rigidity;
    assert_fraction( (double)tip_after( 3000, def ).y, round, 0.02, "1e5 times stiffer on edge, m" );
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
