// Moving frames and largest speeds in worlds: what is felt costs nothing, what is refused. What is carried is in
// tests/claims.
#include "cloth_fixture.h"

#include "wisp/moving_frame.h"

static const wisp_module* const MODULES[] = { &wisp_cloth_module };
static const wisp_vec3 NONE = { 0.0f, 0.0f, 0.0f };
static const float DT = 1.0f / 60.0f;

enum
{
    SIDE = 26,
    VERTICES = SIDE * SIDE,
    STEPS = 30,
};

typedef struct framed
{
    hosted* h;
    wisp_world* world;
    wisp_entity e;
    wisp_vec3 start[VERTICES];
} framed;

// A cloth, hung up at two corners if it is pinned, else free.
static framed open_framed( const wisp_cloth_def* cloth, bool pinned, wisp_vec3 gravity, int workers )
{
    static const int32_t CORNERS[2] = { 0, SIDE - 1 };
    framed s = { .h = new_hosted( MODULES, WISP_COUNT( MODULES ), 4, 1, workers ) };
    s.world = s.h->world;
    SCOPED( test_mesh_free ) test_mesh mesh = hanging_mesh( SIDE, SIDE, 0.03f, 0.03f );
    for ( int v = 0; v < VERTICES; ++v )
    {
        // curved: a plane would buckle by rounding, each time another way
        mesh.points[v].z = 0.1f * sinf( 6.0f * mesh.points[v].x ) * cosf( 5.0f * mesh.points[v].y );
    }
    memcpy( s.start, mesh.points, sizeof( s.start ) );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    fabric.bend_links = fabric.coarse_sheets = true;
    wisp_surface_def surface = wisp_default_surface_def();
    surface.pins = CORNERS;
    surface.pin_count = pinned ? 2 : 0;
    s.e = add_cloth( s.world, &fabric, surface, cloth, gravity );
    return s;
}

static void close_framed( framed* s )
{
    void* h = s->h;
    close_hosted( &h );
}

static void give_frame( framed* s, float linear, float angular )
{
    SET( s->world, s->e, moving_frame, d.linear_inertia = linear, d.angular_inertia = angular );
}

// Move frame and pins to where they are at the end of a step, and make it.
static void follow( framed* s, wisp_transform pose, bool pinned )
{
    static const int32_t CORNERS[2] = { 0, SIDE - 1 };
    assert_status( s->world, wisp_move_frame( s->world, s->e, pose ), WISP_OK );
    const wisp_vec3 targets[2] = { wisp_transform_to_world( pose, s->start[CORNERS[0]] ),
                                   wisp_transform_to_world( pose, s->start[CORNERS[1]] ) };
    if ( pinned )
    {
        assert_status( s->world, wisp_move_pins( s->world, s->e, CORNERS, targets, 2 ), WISP_OK );
    }
    assert_status( s->world, wisp_world_step( s->world, DT ), WISP_OK );
}

TEST( a_frame_that_is_felt_changes_no_bit_and_has_no_pass )
{
    const wisp_cloth_def cloth = undamped_cloth();
    SCOPED( close_framed )
    framed with = open_framed( &cloth, true, EARTH, 1 ), without = open_framed( &cloth, true, EARTH, 1 );
    give_frame( &with, 0.5f, 0.5f );
    give_frame( &with, 1.0f, 1.0f );
    for ( int i = 1; i <= STEPS; ++i )
    {
        follow( &with, walked_pose( i, 0.1f, 0.05f ), true );
        follow( &without, walked_pose( i, 0.1f, 0.05f ), true );
    }
    assert_true( wisp_world_hash( with.world ) == wisp_world_hash( without.world ) );
    assert_int_equal( count_passes_named( with.world, "particles.carry" ), 0 );
}

TEST( a_largest_speed_that_is_lifted_leaves_no_pass )
{
    const wisp_cloth_def cloth = undamped_cloth();
    SCOPED( close_framed ) framed s = open_framed( &cloth, false, EARTH, 1 );
    assert_status( s.world, wisp_set_max_speed( s.world, s.e, 2.0f ), WISP_OK );
    for ( int i = 0; i < 15; ++i )
    {
        assert_status( s.world, wisp_world_step( s.world, DT ), WISP_OK );
    }
    assert_true( motion_stats_of( s.world, s.e ).speed_max <= 2.0 + 1e-6 );
    assert_status( s.world, wisp_set_max_speed( s.world, s.e, INFINITY ), WISP_OK );
    assert_status( s.world, wisp_world_step( s.world, DT ), WISP_OK );
    assert_int_equal( count_passes_named( s.world, "particles.max_speed" ), 0 );
    assert_true( motion_stats_of( s.world, s.e ).speed_max > 2.1 );
}

TEST( what_cannot_be_is_refused )
{
    const wisp_cloth_def cloth = undamped_cloth();
    SCOPED( close_framed ) framed s = open_framed( &cloth, false, EARTH, 1 );
    wisp_moving_frame_def def = wisp_default_moving_frame_def();
    const uint64_t before = wisp_world_hash( s.world );
    def.pose.translation.x = INFINITY;
    expect_refusal( s.world, wisp_set_moving_frame( s.world, s.e, &def ), WISP_BAD_INPUT, "got position (inf" );
    expect_refusal( s.world, wisp_move_frame( s.world, s.e, ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 0.0f }, NONE } ),
                    WISP_BAD_INPUT, "is not a rotation" );
    expect_refusal( s.world, wisp_set_max_speed( s.world, s.e, 0.0f ), WISP_BAD_INPUT, "max_speed: got 0 m/s" );
    expect_refusal( s.world, wisp_set_max_speed( s.world, s.e, NAN ), WISP_BAD_INPUT, "max_speed: got nan m/s" );
    assert_true( wisp_world_hash( s.world ) == before );
}
