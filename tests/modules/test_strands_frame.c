// Moving frames of strands: teleports, what is felt costs nothing, what is refused. What is carried is in tests/claims.
#include "strands_fixture.h"

#include "wisp/moving_frame.h"

#include <math.h>

static const float DT = 1.0f / 60.0f;

enum
{
    STRANDS = 20,
    VERTICES = 12,
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

static wisp_strand_dynamics_def def_of( wisp_strand_rest rest )
{
    wisp_strand_dynamics_def def = undamped_hair();
    def.rest = rest;
    return def;
}

TEST( a_frame_that_is_felt_changes_no_bit_and_has_no_pass )
{
    const wisp_strand_dynamics_def def = def_of( WISP_STRAND_REST_STRAIGHT );
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

// A head that moves farther than the distance of a teleport takes its strands along, once.
TEST( a_head_that_teleports_carries_strands_once )
{
    const wisp_strand_dynamics_def def = def_of( WISP_STRAND_REST_STRAIGHT );
    walker *framed = open_walker( &def, straight_out, 1 ), *bare = open_walker( &def, straight_out, 1 );
    give_frame( framed, 0.0f, 0.0f );
    const wisp_transform far = walked_pose( 1, 50.0f, 0.0f );
    follow( framed, far, true );
    follow( bare, far, true );
    assert_true( farthest_apart( framed, bare, walked_pose( 0, 0.0f, 0.0f ) ) < 1e-6 );
    close_walker( framed );
    close_walker( bare );
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
