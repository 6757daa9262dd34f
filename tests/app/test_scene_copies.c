// The key `copies`: entries in a grid, what they share, and what is refused.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

#include "world_from_scene.h"

static void demand_refusal( const char* text, const char* part )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_scene_parse( text, strlen( text ), "test.yaml", &scene, &error ), WISP_BAD_INPUT );
    if ( strstr( error.message, part ) == NULL )
    {
        fail_msg( "got '%s', expected '%s' in it", error.message, part );
    }
}

TEST( copies_stand_in_rows_and_share_the_fabric )
{
    wisp_scene scene =
        parsed( "wisp: 1\nsurfaces:\n"
                "  - name: sheet\n    generate: { shape: plane, columns: 3, rows: 3 }\n"
                "    transform: { translate: [1, 2, 3] }\n    pin_box: { min: [-1, 0, 0], max: [1, 2, 3] }\n"
                "    pin_nearest: [[0, 1, 0]]\n"
                "    copies: { count: 5, columns: 3, spacing: [10, 20, 30] }\n    cloth: { drag_coefficient: 0.5 }\n"
                "  - { name: last, generate: { shape: plane } }\n"
                "events:\n  - { step: 0, surface: last, velocity: [1, 0, 0] }\n" );
    assert_int_equal( scene.surface_count, 6 );
    // entries keep their numbers, which events have; copies follow
    assert_string_equal( scene.surfaces[1].name, "last" );
    assert_int_equal( scene.events[0].surface, 1 );
    assert_string_equal( scene.surfaces[2].name, "sheet-2" );
    assert_string_equal( scene.surfaces[5].name, "sheet-5" );
    assert_vector( scene.surfaces[0].pose.translation, 1, 2, 3 );
    assert_vector( scene.surfaces[2].pose.translation, 11, 2, 3 );
    assert_vector( scene.surfaces[3].pose.translation, 21, 2, 3 );
    assert_vector( scene.surfaces[4].pose.translation, 1, 22, 33 );
    assert_vector( scene.surfaces[5].pose.translation, 11, 22, 33 );
    for ( int i = 2; i < 6; ++i )
    {
        const wisp_scene_surface* s = &scene.surfaces[i];
        assert_int_equal( s->instance_of, 0 );
        assert_true( s->has_cloth && s->cloth.drag_coefficient == 0.5f && s->request_points );
    }
    assert_vector( scene.surfaces[5].pins.boxes[0].lower, 9, 20, 30 );
    assert_vector( scene.surfaces[5].pins.boxes[0].upper, 11, 22, 33 );
    assert_vector( scene.surfaces[5].pins.nearest[0], 10, 21, 30 );
    assert_vector( scene.surfaces[0].pins.boxes[0].lower, -1, 0, 0 );
    wisp_scene_release( &scene );
}

TEST( without_columns_the_grid_is_as_wide_as_the_root )
{
    wisp_scene scene = parsed(
        "wisp: 1\nstrands:\n"
        "  - { name: tuft, generate: { strands: 2, vertices: 3 }, copies: { count: 7, spacing: [1, 0, 1] } }\n" );
    assert_int_equal( scene.strands_count, 7 );
    assert_vector( scene.strands[2].pose.translation, 2, 0, 0 );
    assert_vector( scene.strands[3].pose.translation, 0, 0, 1 );
    assert_vector( scene.strands[6].pose.translation, 0, 0, 2 );
    wisp_scene_release( &scene );
}

// A copy is what the scene would be with the entry written again.
TEST( copies_move_as_entries_that_are_written_out )
{
    static const char* const texts[2] = {
        "wisp: 1\nsteps: 5\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 5, rows: 5 }, pins: [0, 4], cloth: {}, copies: { count: "
        "2, spacing: [3, 0, 0] } }\n"
        "strands:\n  - { name: b, generate: { strands: 3, vertices: 5 }, dynamics: {}, copies: { count: 2, spacing: "
        "[2, 0, 0] } }\n",
        "wisp: 1\nsteps: 5\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 5, rows: 5 }, pins: [0, 4], cloth: {} }\n"
        "  - { name: a-2, instance_of: a, transform: { translate: [3, 0, 0] }, pins: [0, 4], cloth: {} }\n"
        "strands:\n  - { name: b, generate: { strands: 3, vertices: 5 }, dynamics: {} }\n"
        "  - { name: b-2, generate: { strands: 3, vertices: 5 }, dynamics: {}, transform: { translate: [2, 0, 0] } "
        "}\n",
    };
    uint64_t hashes[2] = { 0 };
    for ( int i = 0; i < 2; ++i )
    {
        const scene_world_options options = { .workers = 1, .is_quiet = true };
        wisp_scene scene = parsed( texts[i] );
        scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
        for ( int step = 0; step < scene.steps; ++step )
        {
            assert_ok( scene_world_step( &world, &error ), error );
        }
        hashes[i] = wisp_world_hash( world.world );
        scene_world_destroy( &world );
        wisp_scene_release( &scene );
    }
    assert_true( hashes[0] == hashes[1] );
}

TEST( what_has_no_place_or_no_name_is_refused )
{
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 2, spacing: [1, 0, 0] } }\n"
        "  - { name: a-2, generate: { shape: plane } }\n",
        "the name of the copy 'a-2' is taken by the entry in line 4" );
    demand_refusal(
        "wisp: 1\nstrands:\n  - { name: a, generate: { strands: 2 }, dynamics: {} }\n"
        "  - { name: b, scatter: { around: a, count: 2, radius: 0.1 }, copies: { count: 2, spacing: [1, 0, 0] } }\n",
        "'copies' is not possible with 'scatter'" );
    demand_refusal( "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 2 } }\n",
                    "spacing" );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 0, spacing: [1, 0, 0] } }\n",
        "count" );
}

// A short scene cannot ask for more than a long one.
TEST( copies_count_to_the_limits_of_a_scene )
{
    demand_refusal( "wisp: 1\nsurfaces:\n"
                    "  - { name: a, generate: { shape: plane }, copies: { count: 10000, spacing: [1, 0, 0] } }\n"
                    "  - { name: b, generate: { shape: plane } }\n",
                    "10001 surfaces" );
    demand_refusal( "wisp: 1\nsurfaces:\n"
                    "  - { name: a, generate: { shape: plane, columns: 100, rows: 100 }, copies: { count: 10000, "
                    "spacing: [1, 0, 0] } }\n",
                    "100000000 vertices" );
    demand_refusal( "wisp: 1\nstrands:\n"
                    "  - { name: a, generate: { strands: 100000, vertices: 20 }, copies: { count: 10000, spacing: "
                    "[1, 0, 0] } }\n",
                    "20000000000 vertices" );
    demand_refusal(
        "wisp: 1\nsurfaces:\n"
        "  - { name: abcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcd, generate: { shape: plane }, "
        "copies: { count: 2, spacing: [1, 0, 0] } }\n",
        "more than 64 characters" );
}
