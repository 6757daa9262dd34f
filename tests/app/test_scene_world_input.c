// What a user does to the world of a scene: holds vertices, moves colliders, changes gravity and wind.
#include "scene_world_fixture.h"

#include "world_from_scene.h"

static const char hanging[] = "wisp: 1\n"
                              "steps: 60\n"
                              "substeps: 4\n"
                              "surfaces:\n"
                              "  - name: cloth\n"
                              "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }\n"
                              "    pins: [0, 5]\n"
                              "    cloth: {}\n"
                              "    collision: {}\n"
                              "  - name: waved\n"
                              "    generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"
                              "    transform: { translate: [2, 0, 0] }\n"
                              "    pins: [0]\n"
                              "    pin_keyframes: [{ time: 1, translate: [0, 1, 0] }]\n"
                              "    cloth: {}\n"
                              "strands:\n"
                              "  - name: hair\n"
                              "    generate: { shape: straight, strands: 3, vertices: 6, length: 0.2 }\n"
                              "    dynamics: { drag_coefficient: 1 }\n"
                              "  - name: still\n"
                              "    generate: { shape: straight, strands: 3, vertices: 6, length: 0.2 }\n"
                              "    frozen_hair: { freeze: {} }\n"
                              "colliders:\n"
                              "  - { name: ball, shape: sphere, radius: 0.1, position: [0, -2, 0] }\n"
                              "  - { name: led, shape: sphere, radius: 0.1, position: [0, -3, 0],\n"
                              "      keyframes: [{ time: 1, position: [0, -4, 0] }] }\n";

enum
{
    HAIR,
    STILL,
    CLOTH,
    WAVED,
    BALL,
    LED
};

static wisp_vec3 point( fixture* f, int body, int vertex )
{
    wisp_vec3 points[4096]; // a ball has the most
    assert_ok( scene_world_points( &f->world, body, points, &f->error ), f->error );
    return points[vertex];
}

static void assert_at( wisp_vec3 p, float x, float y, float z )
{
    assert_float_equal( p.x, x, 1e-5f );
    assert_float_equal( p.y, y, 1e-5f );
    assert_float_equal( p.z, z, 1e-5f );
}

TEST( a_held_vertex_goes_where_it_is_dragged_and_is_free_afterwards )
{
    fixture f;
    build( &f, hanging );
    scene_hold hold;
    assert_ok( scene_world_grab( &f.world, CLOTH, 35, &hold, &f.error ), f.error );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.4f, 0.1f, 0.5f }, &f.error ), f.error );
    step( &f, 1 );
    assert_at( point( &f, CLOTH, 35 ), 0.4f, 0.1f, 0.5f );
    step( &f, 5 ); // without another call it stays
    assert_at( point( &f, CLOTH, 35 ), 0.4f, 0.1f, 0.5f );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 20 );
    assert_true( point( &f, CLOTH, 35 ).y < 0.0f );
    release( &f );
}

TEST( a_vertex_that_the_scene_pins_stays_where_it_was_left )
{
    fixture f;
    build( &f, hanging );
    scene_hold hold;
    assert_ok( scene_world_grab( &f.world, CLOTH, 5, &hold, &f.error ), f.error );
    assert_true( hold.was_pinned );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.4f, 0.2f, 0.0f }, &f.error ), f.error );
    step( &f, 1 );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 20 );
    assert_at( point( &f, CLOTH, 5 ), 0.4f, 0.2f, 0.0f );
    release( &f );
}

TEST( strands_come_along_with_their_head_and_a_second_drag_starts_from_there )
{
    fixture f;
    build( &f, hanging );
    const wisp_vec3 root = point( &f, HAIR, 0 );
    for ( int turn = 1; turn <= 2; ++turn )
    {
        scene_hold hold;
        assert_ok( scene_world_grab( &f.world, HAIR, 5, &hold, &f.error ), f.error );
        const wisp_vec3 tip = point( &f, HAIR, 5 );
        const wisp_vec3 target = { tip.x + 0.05f, tip.y, tip.z };
        assert_ok( scene_world_drag( &f.world, &hold, target, &f.error ), f.error );
        step( &f, 1 );
        assert_at( point( &f, HAIR, 0 ), root.x + 0.05f * (float)turn, root.y, root.z );
        assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
        step( &f, 3 );
    }
    release( &f );
}

TEST( what_keyframes_move_or_what_stands_still_is_refused_with_its_name )
{
    fixture f;
    build( &f, hanging );
    scene_hold hold;
    const wisp_vec3 away = { 0.0f, 0.0f, 0.0f };
    static const struct
    {
        int body, vertex;
        wisp_status status;
        const char* message;
    } cases[] = {
        { WAVED, 0, WISP_CONFLICT, "vertex 0 of 'waved' follows the keyframes of its pins" },
        { STILL, 0, WISP_CONFLICT, "strands 'still' do not move by themselves" },
        { CLOTH, 36, WISP_BAD_INPUT, "got vertex 36, but 'cloth' has 36 vertices, counted from 0" },
        { CLOTH, -1, WISP_BAD_INPUT, "got vertex -1, but 'cloth' has 36 vertices, counted from 0" },
        { BALL, 0, WISP_BAD_INPUT, "got body 4, expected one of the 4 that move" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        assert_int_equal( scene_world_grab( &f.world, cases[i].body, cases[i].vertex, &hold, &f.error ),
                          cases[i].status );
        assert_string_equal( f.error.message, cases[i].message );
    }
    assert_int_equal( scene_world_move_collider( &f.world, LED, away, &f.error ), WISP_CONFLICT );
    assert_string_equal( f.error.message, "collider 'led' follows its keyframes" );
    assert_int_equal( scene_world_move_collider( &f.world, CLOTH, away, &f.error ), WISP_CONFLICT );
    assert_int_equal( scene_world_move_collider( &f.world, 6, away, &f.error ), WISP_BAD_INPUT );
    release( &f );
}

TEST( a_collider_is_where_it_was_moved )
{
    fixture f;
    build( &f, hanging );
    const wisp_vec3 before = point( &f, BALL, 0 );
    wisp_vec3 place = { 0.0f, 0.0f, -0.05f };
    for ( int i = 0; i <= 15; ++i )
    {
        place.y = -0.15f + 0.01f * (float)i;
        assert_ok( scene_world_move_collider( &f.world, BALL, place, &f.error ), f.error );
        step( &f, 1 );
    }
    assert_at( point( &f, BALL, 0 ), before.x, before.y + 2.0f, before.z - 0.05f );
    const wisp_vec3 p = point( &f, CLOTH, 14 ); // carried by it, where it would have fallen by 20 cm
    assert_true( p.y > -0.05f );
    assert_true( hypotf( hypotf( p.x - place.x, p.y - place.y ), p.z - place.z ) > 0.099f );
    release( &f );
}

TEST( gravity_acts_on_cloth_and_strands )
{
    fixture f;
    build( &f, hanging );
    const wisp_vec3 tip = point( &f, HAIR, 5 );
    assert_ok( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ 5.0f, 0.0f, 0.0f }, &f.error ), f.error );
    step( &f, 20 );
    assert_true( point( &f, HAIR, 5 ).x > tip.x + 0.02f );
    assert_true( point( &f, CLOTH, 35 ).x > 0.255f && fabsf( point( &f, CLOTH, 35 ).y ) < 1e-3f );
    assert_int_equal( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ NAN, 0.0f, 0.0f }, &f.error ),
                      WISP_BAD_INPUT );
    release( &f );
}

TEST( wind_gives_cloth_air_and_calm_takes_it_away )
{
    fixture f;
    int felt = 0;
    build( &f, hanging );
    step( &f, 1 ); // which has passes of its own
    const int passes = wisp_world_plan_passes( f.world.world );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f }, &felt, &f.error ), f.error );
    assert_int_equal( felt, 3 ); // hair and both cloths
    assert_true( wisp_world_plan_passes( f.world.world ) > passes );
    step( &f, 20 );
    assert_true( point( &f, CLOTH, 35 ).y > -0.1f );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, &felt, &f.error ), f.error );
    assert_int_equal( wisp_world_plan_passes( f.world.world ), passes );
    release( &f );
}

static uint64_t hash_of_a_drag( int workers )
{
    fixture f = { .scene = parsed( hanging ) };
    create( &f, workers );
    scene_hold hold;
    int felt;
    step( &f, 5 );
    assert_ok( scene_world_grab( &f.world, CLOTH, 35, &hold, &f.error ), f.error );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.3f, 0.3f, 0.3f }, &f.error ), f.error );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 1.0f, 0.0f, 2.0f }, &felt, &f.error ), f.error );
    step( &f, 5 );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 5 );
    const uint64_t hash = wisp_world_hash( f.world.world );
    release( &f );
    return hash;
}

TEST( equal_input_gives_equal_bits )
{
    const uint64_t one = hash_of_a_drag( 1 );
    assert_int_equal( hash_of_a_drag( 1 ), one );
    assert_int_equal( hash_of_a_drag( 3 ), one );
}
