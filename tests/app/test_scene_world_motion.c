// From a scene to a running world: what strands tell, levels of detail, groups of pins that events attach, whose motion is in
// tests/claims/pins.yaml, modules of seams. What a user does to the world of a scene: holds vertices, moves colliders, changes
// gravity and wind. Points that scenes lead to are in tests/app/transcripts/scenes.t.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "world_from_scene.h"

#include "wisp/module/module.h"

// ---- requests ----

TEST( strands_that_move_tell_strain_speed_and_motion_stats_and_others_do_not )
{
    SCOPED( release ) fixture f;
    build(
        &f,
        "wisp: 1\nsteps: 3\nstrands:\n"
        "  - name: hair\n    generate: { dimension: 2, strands: 4, vertices: 6, length: 0.2, length_variation: 0 }\n"
        "    transform: { rotate: { axis: [1, 0, 0], degrees: 90 } }\n"
        "    dynamics: { bending: none }\n    compute: [strain, speed, motion_stats]\n"
        "  - { name: still, generate: { strands: 2, vertices: 2 } }\n" );
    step( &f, 3 );
    float speed[24], strain[24];
    wisp_motion_stats motion_stats;
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_SPEED, speed, &f.error ), WISP_OK );
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_STRAIN, strain, &f.error ), WISP_OK );
    assert_int_equal( scene_world_motion_stats( &f.world, 0, &motion_stats, &f.error ), WISP_OK );
    // a chain released level falls at least as fast as a stone: g t = 0.49 m/s after 3 steps, from the tip, 2/3 of it
    // on the way
    assert_true( speed[5] > 0.3f && speed[0] == 0.0f );
    assert_true( strain[3] >= 0.0f && strain[3] <= 1e-3f ); // the tolerance of the direct solve
    assert_true( fabs( motion_stats.speed_max - (double)speed[5] ) < 0.2 );
    assert_int_equal( scene_world_request( &f.world, 1, SCENE_REQUEST_SPEED, &f.error ), WISP_BAD_INPUT );
    assert_string_equal( f.error.message, "test.yaml: 'still' has no speed" );
}

TEST( levels_of_detail_are_set_and_changed_by_events )
{
    SCOPED( release ) fixture f;
    build(
        &f,
        "wisp: 1\nsteps: 20\nsubsteps: 8\nstrands:\n"
        "  - { name: guides, generate: { strands: 4, vertices: 6 }, dynamics: {}, detail: { level: fewer_substeps } "
        "}\n"
        "  - { name: hair, generate: { strands: 8, vertices: 6 }, ghosts: { targets: guides }, detail: { level: "
        "coarse } }\n"
        "surfaces:\n"
        "  - name: sheet\n    generate: { shape: plane, columns: 24, rows: 24, spacing: 0.02 }\n    pins: [0, 23]\n"
        "    cloth: { coarse_substeps: 1 }\n    detail: { substep_divisor: 2, blend_steps: 4 }\n"
        "events:\n"
        "  - { step: 3, surface: sheet, detail: coarse }\n"
        "  - { step: 5, strands: guides, detail: nothing }\n" );
    wisp_world* world = f.world.world;
    const wisp_entity guides = f.world.entities[0], hair = f.world.entities[1], sheet = f.world.surfaces[0].entity;
    assert_int_equal( wisp_detail_of( world, guides ), WISP_DETAIL_FEWER_SUBSTEPS );
    assert_int_equal( wisp_detail_of( world, hair ), WISP_DETAIL_COARSE );
    assert_int_equal( wisp_detail_of( world, sheet ), WISP_DETAIL_FULL );
    step( &f, 3 );
    assert_int_equal( scene_world_substeps( &f.world, 0 ), 2 );
    assert_int_equal( scene_world_substeps( &f.world, 2 ), 8 );
    step( &f, 4 );
    assert_int_equal( wisp_detail_of( world, sheet ), WISP_DETAIL_COARSE );
    assert_int_equal( scene_world_substeps( &f.world, 2 ), 4 );
    assert_int_equal( wisp_detail_of( world, guides ), WISP_DETAIL_NOTHING );
}

// ---- pins ----

#define SHEET                                                                                                        \
    "wisp: 1\ndt: 0.02\nsteps: 60\nsurfaces:\n"                                                                      \
    "  - name: cloth\n    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"                          \
    "    compute: [points, speed]\n"

TEST( an_event_that_attaches_a_group_holds_it )
{
    SCOPED( release ) fixture f;
    build( &f, SHEET "    pin_groups:\n      - { name: grip, pins: [0], starts_free: true }\n"
                     "  - name: tray\n    generate: { shape: plane, columns: 2, rows: 2, spacing: 1 }\n"
                     "    pin_box: { min: [-2, -2, -2], max: [2, 2, 2] }\n"
                     "events:\n  - { step: 2, surface: cloth, pin_group: grip, attach_pins: tray }\n" );
    assert_int_equal( scene_pins_holding( &f.world.surfaces[0], 0 ), -1 );
    step( &f, 3 );
    assert_int_equal( scene_pins_holding( &f.world.surfaces[0], 0 ), 1 );
}

// ---- seams ----

TEST( only_a_scene_with_seams_has_the_module )
{
    const wisp_module* used[SCENE_MAX_MODULES];
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 4, rows: 4 }, cloth: {} }\n"
               "seams:\n  - { name: s, surfaces: [a, a], pairs: [[0, 3]] }\n" );
    const int with = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 0;
    const int without = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 1;
    assert_int_equal( with, without + 1 );
}

// ---- input of a user ----

static const char hanging[] = "wisp: 1\n"
                              "steps: 60\n"
                              "substeps: 4\n"
                              "surfaces:\n"
                              "  - name: cloth\n"
                              "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }\n"
                              "    pins: [0, 5]\n"
                              "    cloth: {}\n"
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
    SCOPED( release ) fixture f;
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
}

TEST( a_vertex_that_the_scene_pins_stays_where_it_was_left )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    scene_hold hold;
    assert_ok( scene_world_grab( &f.world, CLOTH, 5, &hold, &f.error ), f.error );
    assert_true( hold.was_pinned );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.4f, 0.2f, 0.0f }, &f.error ), f.error );
    step( &f, 1 );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 20 );
    assert_at( point( &f, CLOTH, 5 ), 0.4f, 0.2f, 0.0f );
}

TEST( strands_come_along_with_their_head_and_a_second_drag_starts_from_there )
{
    SCOPED( release ) fixture f;
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
}

TEST( what_keyframes_move_or_what_stands_still_is_refused_with_its_name )
{
    SCOPED( release ) fixture f;
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
}

TEST( a_collider_is_where_it_was_moved )
{
    SCOPED( release ) fixture f;
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
}

TEST( gravity_acts_on_cloth_and_strands )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    const wisp_vec3 tip = point( &f, HAIR, 5 );
    assert_ok( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ 5.0f, 0.0f, 0.0f }, &f.error ), f.error );
    step( &f, 20 );
    assert_true( point( &f, HAIR, 5 ).x > tip.x + 0.02f );
    assert_true( point( &f, CLOTH, 35 ).x > 0.255f && fabsf( point( &f, CLOTH, 35 ).y ) < 1e-3f );
    assert_int_equal( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ NAN, 0.0f, 0.0f }, &f.error ),
                      WISP_BAD_INPUT );
}

TEST( wind_gives_cloth_air_that_slows_it_in_a_calm )
{
    SCOPED( release ) fixture f;
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
    assert_true( wisp_world_plan_passes( f.world.world ) > passes );
}

static uint64_t hash_of_a_drag( int workers )
{
    SCOPED( release ) fixture f = { .scene = parsed( hanging ) };
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
    return wisp_world_hash( f.world.world );
}

TEST( equal_input_gives_equal_bits )
{
    const uint64_t one = hash_of_a_drag( 1 );
    assert_int_equal( hash_of_a_drag( 1 ), one );
    assert_int_equal( hash_of_a_drag( 3 ), one );
}
