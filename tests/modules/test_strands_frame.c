// Moving frames and largest speeds of strands: what is not felt carries, what is felt is the world's motion, and nothing costs
// nothing.
#include "strands_fixture.h"

#include "wisp/moving_frame.h"

#include <math.h>

static const float DT = 1.0f / 60.0f;

enum
{
    STRANDS = 20,
    VERTICES = 12,
    STEPS = 30,
};

typedef struct walker
{
    hosted s;
    wisp_world* world;
    wisp_entity e;
} walker;

static walker* open_walker( const wisp_strand_dynamics_def* def, strand_curve* curve, int workers )
{
    walker* w = checked_calloc( 1, sizeof( walker ) );
    open_strands( &w->s, 8, 1, workers );
    w->world = w->s.world;
    w->e = add_moving( w->world, STRANDS, VERTICES, curve, 0.15f, def );
    assert_int_equal( wisp_request( w->world, w->e, WISP_MOTION_STATS ), WISP_OK );
    return w;
}

static void close_walker( walker* w )
{
    close_world( &w->s );
    free( w );
}

static void give_frame( walker* w, float linear, float angular )
{
    wisp_moving_frame_def def = wisp_default_moving_frame_def();
    def.linear_inertia = linear;
    def.angular_inertia = angular;
    assert_status( w->world, wisp_set_moving_frame( w->world, w->e, &def ), WISP_OK );
}

// Move frame and head, and make a step.
static void follow( walker* w, wisp_transform pose, bool has_head )
{
    assert_status( w->world, wisp_move_frame( w->world, w->e, pose ), WISP_OK );
    if ( has_head )
    {
        assert_status( w->world, wisp_move_strand_head( w->world, w->e, pose ), WISP_OK );
    }
    strand_steps( w->world, 1, DT );
}

static double farthest_apart( walker* moved, walker* still, wisp_transform pose )
{
    const wisp_vec3 *p = strand_points( moved->world, moved->e ), *q = strand_points( still->world, still->e );
    double farthest = 0.0;
    for ( int v = 0; v < STRANDS * VERTICES; ++v )
    {
        const double apart = vec_distance( p[v], wisp_transform_to_world( pose, q[v] ) );
        farthest = apart <= farthest ? farthest : apart; // NaN is the farthest
    }
    return farthest;
}

typedef struct kind
{
    const char* name;
    strand_curve* curve;
    wisp_strand_stretch stretch;
    wisp_strand_bend bending;
    wisp_strand_rest rest;
    wisp_integrator integrator;
    float damping, bend_damping, drag;
    double tolerance; // m
} kind;

static wisp_strand_dynamics_def def_of( const kind* k )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.stretch = k->stretch;
    def.bending = k->bending;
    def.rest = k->rest;
    def.integrator = k->integrator;
    def.damping = k->damping;
    def.bend_damping = k->bend_damping;
    def.drag_coefficient = k->drag;
    def.bend_compliance = 100.0f;
    return def;
}

#define DIRECT WISP_STRAND_STRETCH_DIRECT
#define ROD WISP_STRAND_BEND_ROD

static const kind KINDS[] = {
    { "straight rod", straight_out, DIRECT, ROD, WISP_STRAND_REST_STRAIGHT, WISP_INTEGRATOR_EULER,
      .tolerance = 2e-6 },
    { "damped rod", straight_out, DIRECT, ROD, WISP_STRAND_REST_STRAIGHT, WISP_INTEGRATOR_EULER, .damping = 4.0f,
      .bend_damping = 0.01f, .drag = 1.0f, .tolerance = 1e-5 },
    { "curls", curl_down, DIRECT, ROD, WISP_STRAND_REST_SHAPE, WISP_INTEGRATOR_EULER, .bend_damping = 0.01f,
      .tolerance = 2e-6 },
    { "sag-free curls", curl_down, DIRECT, ROD, WISP_STRAND_REST_SAG_FREE, WISP_INTEGRATOR_EULER, .tolerance = 2e-6 },
    { "bdf2", straight_out, DIRECT, ROD, WISP_STRAND_REST_STRAIGHT, WISP_INTEGRATOR_BDF2, .damping = 1.0f,
      .tolerance = 2e-6 },
    { "links", straight_out, WISP_STRAND_STRETCH_LINKS, WISP_STRAND_BEND_LINKS, WISP_STRAND_REST_STRAIGHT,
      WISP_INTEGRATOR_EULER, .damping = 1.0f, .tolerance = 2e-6 },
    { "chain", straight_out, DIRECT, WISP_STRAND_BEND_NONE, WISP_STRAND_REST_STRAIGHT, WISP_INTEGRATOR_EULER,
      .damping = 1.0f, .tolerance = 2e-6 },
};

TEST( strands_that_feel_nothing_move_as_in_a_still_frame )
{
    for ( int k = 0; k < WISP_COUNT( KINDS ); ++k )
    {
        const wisp_strand_dynamics_def def = def_of( KINDS + k );
        walker *moved = open_walker( &def, KINDS[k].curve, 1 ), *still = open_walker( &def, KINDS[k].curve, 1 ),
               *felt = open_walker( &def, KINDS[k].curve, 1 );
        give_frame( moved, 0.0f, 0.0f );
        wisp_transform pose = walked_pose( 0, 0.0f, 0.0f );
        for ( int i = 1; i <= STEPS; ++i )
        {
            follow( still, walked_pose( 0, 0.0f, 0.0f ), true );
            pose = walked_pose( i, 0.1f, 0.05f );
            follow( moved, pose, true );
            follow( felt, pose, true );
        }
        // roots go straight where the frame turns
        const double apart = farthest_apart( moved, still, pose );
        if ( !( apart < KINDS[k].tolerance ) )
        {
            fail_msg( "%s: %g m apart, tolerated %g m", KINDS[k].name, apart, KINDS[k].tolerance );
        }
        assert_true( farthest_apart( felt, still, pose ) > 0.02 );
        close_walker( moved );
        close_walker( still );
        close_walker( felt );
    }
}

TEST( a_frame_that_is_felt_changes_no_bit_and_has_no_pass )
{
    const wisp_strand_dynamics_def def = def_of( KINDS );
    walker *framed = open_walker( &def, straight_out, 1 ), *bare = open_walker( &def, straight_out, 1 );
    give_frame( framed, 1.0f, 1.0f );
    for ( int i = 1; i <= 5; ++i )
    {
        follow( framed, walked_pose( i, 0.1f, 0.05f ), true );
        follow( bare, walked_pose( i, 0.1f, 0.05f ), true );
    }
    assert_true( wisp_world_hash( framed->world ) == wisp_world_hash( bare->world ) );
    assert_false( plan_says( framed->world, "strands.carry", "item loop" ) );
    assert_false( plan_says( framed->world, "strands.frame", "item loop" ) );
    close_walker( framed );
    close_walker( bare );
}

// Without gravity a free stick goes along with what it does not feel.
TEST( a_free_stick_is_carried_by_the_rest_of_the_fraction )
{
    wisp_strand_dynamics_def def = def_of( KINDS );
    def.free_roots = true;
    def.gravity = ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    walker* w = open_walker( &def, straight_out, 1 );
    wisp_vec3 before[STRANDS * VERTICES];
    strand_steps( w->world, 1, DT );
    memcpy( before, strand_points( w->world, w->e ), sizeof( before ) );
    give_frame( w, 0.3f, 1.0f );
    for ( int i = 1; i <= 10; ++i )
    {
        follow( w, walked_pose( i, 0.1f, 0.0f ), false );
    }
    const wisp_vec3 way = walked_pose( 10, 0.1f, 0.0f ).translation;
    for ( int v = 0; v < STRANDS * VERTICES; ++v )
    {
        const wisp_vec3 to = { before[v].x + 0.7f * way.x, before[v].y + 0.7f * way.y, before[v].z + 0.7f * way.z };
        assert_true( vec_distance( strand_points( w->world, w->e )[v], to ) < 1e-6 );
    }
    wisp_motion_stats stats;
    assert_int_equal( wisp_read_motion_stats( w->world, w->e, &stats ), WISP_OK );
    assert_true( stats.speed_max < 1e-4 ); // velocities are without it
    close_walker( w );
}

TEST( a_teleport_takes_the_frame_along )
{
    const wisp_strand_dynamics_def def = def_of( KINDS + 2 );
    const wisp_transform motion = { { 0.0f, 1.0f, 0.0f, 0.0f }, { 4.0f, 0.0f, 8.0f } };
    walker *here = open_walker( &def, curl_down, 1 ), *there = open_walker( &def, curl_down, 1 );
    give_frame( here, 0.0f, 0.0f );
    give_frame( there, 0.0f, 0.0f );
    follow( here, walked_pose( 1, 0.1f, 0.05f ), true );
    follow( there, walked_pose( 1, 0.1f, 0.05f ), true );
    assert_status( there->world, wisp_teleport( there->world, there->e, motion, true ), WISP_OK );
    strand_steps( here->world, 3, DT );
    strand_steps( there->world, 3, DT );
    assert_true( farthest_apart( there, here, motion ) < 1e-5 );
    close_walker( here );
    close_walker( there );
}

// A head that moves farther than the distance of a teleport takes its strands along, once.
TEST( a_head_that_teleports_carries_strands_once )
{
    const wisp_strand_dynamics_def def = def_of( KINDS );
    walker *framed = open_walker( &def, straight_out, 1 ), *bare = open_walker( &def, straight_out, 1 );
    give_frame( framed, 0.0f, 0.0f );
    const wisp_transform far = walked_pose( 1, 50.0f, 0.0f );
    follow( framed, far, true );
    follow( bare, far, true );
    assert_true( farthest_apart( framed, bare, walked_pose( 0, 0.0f, 0.0f ) ) < 1e-6 );
    close_walker( framed );
    close_walker( bare );
}

TEST( a_largest_speed_holds_and_is_counted )
{
    for ( int bdf2 = 0; bdf2 < 2; ++bdf2 )
    {
        wisp_strand_dynamics_def def = def_of( KINDS + ( bdf2 ? 4 : 0 ) );
        def.free_roots = true;
        def.damping = 0.0f;
        walker* w = open_walker( &def, straight_out, 1 );
        wisp_motion_stats stats;
        assert_status( w->world, wisp_set_max_speed( w->world, w->e, 2.0f ), WISP_OK );
        for ( int i = 0; i < 60; ++i )
        {
            strand_steps( w->world, 1, DT );
            assert_int_equal( wisp_read_motion_stats( w->world, w->e, &stats ), WISP_OK );
            assert_true( stats.speed_max <= 2.0 + 1e-6 );
        }
        assert_true( fabs( stats.momentum[1] / stats.mass + 2.0 ) < 1e-5 );
        assert_true( wisp_world_counter( w->world, WISP_COUNT_SPEED_LIMITED ) > 1000 );
        assert_status( w->world, wisp_set_max_speed( w->world, w->e, INFINITY ), WISP_OK );
        strand_steps( w->world, 1, DT );
        assert_false( plan_says( w->world, "strands.max_speed", "item loop" ) );
        assert_int_equal( wisp_read_motion_stats( w->world, w->e, &stats ), WISP_OK );
        assert_true( stats.speed_max > 2.1 );
        close_walker( w );
    }
}

TEST( strands_that_do_not_move_have_no_frame )
{
    hosted s;
    const int count = 4;
    open_strands( &s, 1, 1, 1 );
    const wisp_entity e = add_strands( s.world, &count, 1, straight_out, 0.1f );
    wisp_moving_frame_def def = wisp_default_moving_frame_def();
    def.linear_inertia = 0.5f;
    assert_int_equal( wisp_set_moving_frame( s.world, e, &def ), WISP_CONFLICT );
    assert_non_null(
        strstr( wisp_world_message( s.world ), "has strands that do not move: give them dynamics first" ) );
    assert_int_equal( wisp_set_max_speed( s.world, e, 1.0f ), WISP_CONFLICT );
    close_world( &s );
}
