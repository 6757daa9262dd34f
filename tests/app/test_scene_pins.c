// Entries of scenes that belong together. Pins in groups, whose motion is in tests/claims/pins.yaml. Seams: keys, names,
// vertices after a repair, what is refused once meshes are known, reports. Tearing: keys, spare vertices, instances, maps of
// the strength, bodies whose triangles change. The key `copies`: entries in a grid, what they share, and what is refused.
#define _XOPEN_SOURCE 700

#include "folder_fixture.h"
#include "scene_fixture.h"
#include "scene_world_fixture.h"

#include "world_from_scene.h"

#include "wisp/module/module.h"

// ---- pins ----

#define SHEET                                                                                                        \
    "wisp: 1\ndt: 0.02\nsteps: 60\nsurfaces:\n"                                                                      \
    "  - name: cloth\n    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"                          \
    "    compute: [points, speed]\n"

// Two grippers on opposite edges, x = -0.2 and x = 0.2; one pulls, one pulls and turns about the vertical through its middle.
#define GRIPPERS                                                                                                     \
    SHEET "    cloth: { bending: bend_links }\n    pin_groups:\n"                                                    \
          "      - name: left\n        pin_box: { min: [-0.21, -1, -1], max: [-0.19, 1, 1] }\n"                      \
          "        pin_keyframes: [ { time: 0.4, translate: [-0.08, 0.02, 0] } ]\n"                                  \
          "      - name: right\n        pin_box: { min: [0.19, -1, -1], max: [0.21, 1, 1] }\n"                       \
          "        pin_keyframes: [ { time: 0.2, translate: [0, 0, 0] },\n"                                          \
          "          { time: 1, translate: [0.06, 0, 0.04], rotate: { axis: [0, 1, 0], degrees: 40 } } ]\n"

TEST( copies_have_groups_of_their_own )
{
    SCOPED( release ) fixture f;
    build( &f, SHEET "    copies: { count: 2, spacing: [2, 0, 0] }\n    pin_groups:\n"
                     "      - { name: a, pin_nearest: [[0.2, 0, -0.2]],\n"
                     "          pin_keyframes: [ { time: 0.2, translate: [0, 0.1, 0] } ] }\n" );
    step( &f, 10 );
    assert_point_at( point_of( &f, 0, 8 ), 0.2f, 0.1f, -0.2f );
    assert_point_at( point_of( &f, 1, 8 ), 2.2f, 0.1f, -0.2f );
}

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

// @param restore_at step after which the world goes on in another one; 0: never
static uint64_t hash_after( int workers, int steps, int restore_at )
{
    SCOPED( release )
    fixture f = { .scene =
                      parsed( GRIPPERS "events:\n  - { step: 20, surface: cloth, pin_group: right, release: true }\n"
                                       "  - { step: 25, surface: cloth, pin_group: right, hold: true }\n" ) };
    create( &f, workers );
    step( &f, restore_at > 0 ? restore_at : steps );
    if ( restore_at > 0 ) // into a world that has made one step
    {
        fixture g = { .scene = f.scene };
        create( &g, workers );
        step( &g, 1 );
        const size_t size = wisp_world_snapshot_size( f.world.world ), front = scene_pins_state_size( &f.world );
        char* bytes = checked_calloc( size + front, 1 );
        scene_pins_save( &f.world, bytes );
        assert_int_equal( wisp_world_snapshot( f.world.world, bytes + front, size ), WISP_OK );
        assert_int_equal( scene_pins_state_size( &g.world ), front );
        scene_pins_load( &g.world, bytes );
        assert_int_equal( wisp_world_restore( g.world.world, bytes + front, size ), WISP_OK );
        g.world.next_step = f.world.next_step;
        g.world.next_event = f.world.next_event;
        free( bytes );
        g.world.scene = &f.scene; // that of g ends here
        scene_world_destroy( &f.world );
        f.world = g.world;
        step( &f, steps - restore_at );
    }
    return wisp_world_hash( f.world.world );
}

TEST( workers_and_snapshots_change_no_bit )
{
    const uint64_t expected = hash_after( 1, 50, 0 );
    assert_true( hash_after( 3, 50, 0 ) == expected );
    assert_true( hash_after( 2, 50, 22 ) == expected ); // let go
    assert_true( hash_after( 2, 50, 30 ) == expected ); // held again
}

TEST( a_vertex_in_two_groups_and_an_empty_box_are_refused )
{
    demand_refusal(
        SHEET "    pins: [3]\n    pin_groups: [ { name: a, pins: [4, 3] } ]\n",
        "test.yaml:5:5: surface 'cloth': vertex 3 of the group 'a' is also pinned by the surface or by a group "
        "before it" );
    // the number in the file, of a vertex that a repair has moved up
    demand_refusal(
        SHEET
        "    repair: [weld]\n    weld_distance: 0.06\n    pins: [8]\n    pin_groups: [ { name: a, pins: [8] } ]\n",
        "test.yaml:5:5: surface 'cloth': vertex 8 of the group 'a' is also pinned by the surface or by a group "
        "before it" );
    demand_refusal( SHEET "    pin_groups: [ { name: a, pin_box: { min: [5, 5, 5], max: [6, 6, 6] } } ]\n",
                    "test.yaml:5:5: surface 'cloth': group 'a': no vertex starts in pin_box 0" );
}

// ---- seams ----

static const char TWO_PANELS[] =
    "wisp: 1\n"
    "gravity: [0, 0, 0]\n"
    "surfaces:\n"
    "  - { name: a, generate: { shape: plane, columns: 4, rows: 4, spacing: 0.1 }, cloth: {} }\n"
    "  - { name: b, instance_of: a, transform: { translate: [0.35, 0, 0] }, cloth: {} }\n"
    "seams:\n";

static void build_sewn( fixture* f, const char* seam )
{
    char text[1500];
    snprintf( text, sizeof text, "%s  - %s\n", TWO_PANELS, seam );
    build( f, text );
}

// Panels of a scene close by the speed of their seam.
TEST( a_scene_closes_its_seam )
{
    SCOPED( release ) fixture f;
    build_sewn( &f, "{ name: s, surfaces: [a, b], within: 0.06, closing_speed: 0.2 }" );
    step( &f, 30 );
    for ( int i = 0; i < 4; ++i )
    {
        const wisp_vec3 a = point_of( &f, 0, 4 * i + 3 ), b = point_of( &f, 1, 4 * i );
        assert_true( fabsf( a.x - b.x ) < 1e-4f && fabsf( a.y - b.y ) < 1e-4f && fabsf( a.z - b.z ) < 1e-4f );
    }
}

// The file has a vertex that no triangle names, which a repair removes; scenes keep the numbers of the file.
TEST( vertices_are_numbered_as_in_the_file )
{
    static const wisp_vec3 points[] = { { 0, 0, 0 }, { 9, 9, 9 }, { 1, 0, 0 }, { 0, 0, 1 } };
    static const int32_t triangles[] = { 0, 3, 2 };
    const wisp_scene_arrays arrays = {
        .file = "tri.obj", .points = points, .point_count = 4, .triangles = triangles, .triangle_count = 1
    };
    static const char* const PAIRS[] = { "[[3, 2]]", "[[0, 1]]" };
    for ( int i = 0; i < 2; ++i )
    {
        char text[500];
        snprintf( text, sizeof text,
                  "wisp: 1\nsurfaces:\n  - { name: a, file: tri.obj, repair: [unreferenced] }\n"
                  "seams:\n  - { name: s, surfaces: [a, a], pairs: %s }\n",
                  PAIRS[i] );
        SCOPED( wisp_scene_release ) wisp_scene scene;
        wisp_error error = { 0 };
        scene_world world;
        assert_ok( wisp_scene_parse( text, strlen( text ), "test", &scene, &error ), error );
        assert_ok( wisp_scene_set_arrays( &scene, &arrays, 1, &error ), error );
        const scene_world_options options = { .is_quiet = true };
        const wisp_status status = scene_world_create( &scene, &options, &world, &error );
        if ( i == 0 )
        {
            wisp_vec3 now[3];
            assert_ok( status, error );
            for ( int k = 0; k < 60; ++k )
            {
                assert_ok( scene_world_step( &world, &error ), error );
            }
            assert_ok( scene_world_points( &world, 0, now, &error ), error );
            assert_true( fabsf( now[2].x - now[1].x ) < 0.3f && fabsf( now[2].z - now[1].z ) < 0.3f );
            assert_true( fabsf( now[0].x ) < 1e-6f && fabsf( now[0].z ) < 1e-6f );
            scene_world_destroy( &world );
        }
        else
        {
            assert_int_equal( status, WISP_BAD_INPUT );
            assert_contains( error.message, "test:5:5: seam 's': pairs[0]: got vertex 1 of 'a'" );
        }
    }
}

TEST( what_only_the_world_knows_is_refused_with_its_line )
{
    static const char* const BAD[][2] = {
        { "{ name: s, surfaces: [a, b], within: 0.04 }", "test:7:5: seam 's': seams: no boundary vertex" },
        { "{ name: s, surfaces: [a, b], pairs: [[0, 16]] }", "test:7:5: seam 's': pairs[0]: got vertex 16 of 'b'" },
    };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        char text[1500];
        SCOPED( wisp_scene_release ) wisp_scene scene;
        wisp_error error = { 0 };
        scene_world world;
        snprintf( text, sizeof text, "%s  - %s\n", TWO_PANELS, BAD[i][0] );
        assert_ok( wisp_scene_parse( text, strlen( text ), "test", &scene, &error ), error );
        const scene_world_options options = { .is_quiet = true };
        assert_int_equal( scene_world_create( &scene, &options, &world, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, BAD[i][1] );
    }
}

TEST( only_a_scene_with_seams_has_the_module )
{
    const wisp_module* used[SCENE_MAX_MODULES];
    SCOPED( release ) fixture f;
    build_sewn( &f, "{ name: s, surfaces: [a, b], within: 0.06 }" );
    const int with = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 0;
    const int without = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 1;
    assert_int_equal( with, without + 1 );
}

// ---- tearing ----

enum
{
    SIDE = 6,
    OWN = SIDE * SIDE,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
};

// Sheets that hang along z from their first row. Their weight is 0.23 N/m of width.
static const char SHEETS[] = "wisp: 1\n"
                             "gravity: [0, 0, 9.81]\n"
                             "substeps: 4\n"
                             "iterations: 4\n"
                             "surfaces:\n"
                             "  - name: a\n"
                             "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.03 }\n"
                             "    pins: [0, 1, 2, 3, 4, 5]\n"
                             "    cloth: {}\n"
                             "    tearing: { strength: %s, max_splits: 7, max_new_vertices: 12 }\n"
                             "  - name: b\n"
                             "    instance_of: a\n"
                             "    transform: { translate: [1, 0, 0] }\n"
                             "    pin_box: { min: [0, -1, -1], max: [2, 1, 1] }\n"
                             "    cloth: {}\n"
                             "    tearing: { strength: %s }\n";

static void build_sheets( fixture* f, const char* a, const char* b )
{
    char text[2000];
    snprintf( text, sizeof text, SHEETS, a, b );
    build( f, text );
}

TEST( every_key_reaches_its_place_and_meshes_have_spare_vertices )
{
    SCOPED( release ) fixture f;
    build_sheets( &f, "80", "90" );
    const wisp_scene_surface* s = f.scene.surfaces;
    assert_true( s->has_tearing && s->tearing.strength == 80.0f && s->tearing.max_splits == 7 );
    assert_true( s->max_new_vertices == 12 && s[1].max_new_vertices == -1 && s[1].tearing.max_splits == 64 );
    // the instance asks for more: a quarter of 36, at least 64
    for ( int i = 0; i < 2; ++i )
    {
        wisp_tearing_stats stats;
        assert_int_equal( f.world.surfaces[i].spare_count, 64 );
        assert_int_equal( wisp_read_tearing_stats( f.world.world, f.world.surfaces[i].entity, &stats ), WISP_OK );
        assert_int_equal( stats.spare_count, 64 );
    }
    // spare vertices are not pinned, although they lie where a pin is
    assert_int_equal( f.world.surfaces[0].pin_count, SIDE );
    assert_int_equal( f.world.surfaces[1].pin_count, OWN );
}

TEST( an_instance_tears_on_its_own_and_bodies_show_it )
{
    SCOPED( release ) fixture f;
    build_sheets( &f, "0.01", "1e6" );
    int32_t before[3 * TRIANGLES];
    const scene_body a = scene_world_body( &f.world, 0 ), b = scene_world_body( &f.world, 1 );
    assert_true( a.tears && b.tears && a.triangle_count == TRIANGLES && b.triangle_count == TRIANGLES );
    assert_true( a.triangles != b.triangles );
    memcpy( before, a.triangles, sizeof before );
    assert_memory_equal( b.triangles, before, sizeof before );
    step( &f, 20 );
    assert_true( f.world.surfaces[0].split_count > 0 && f.world.surfaces[1].split_count == 0 );
    assert_true( memcmp( a.triangles, before, sizeof before ) != 0 ); // the same array
    assert_memory_equal( b.triangles, before, sizeof before );
    int largest = 0;
    for ( int i = 0; i < 3 * TRIANGLES; ++i )
    {
        largest = a.triangles[i] > largest ? a.triangles[i] : largest;
    }
    assert_int_equal( largest, OWN + f.world.surfaces[0].split_count - 1 );
}

// The strength grows from left to right: only the left tears.
TEST_WITH( a_map_of_the_strength_is_one_number_per_vertex_of_the_mesh, make_folder, remove_folder )
{
    SCOPED( release ) fixture f;
    const char* path = path_in( state, "strength.txt" );
    FILE* file = fopen( path, "w" );
    assert_non_null( file );
    for ( int v = 0; v < OWN; ++v )
    {
        fprintf( file, "%s\n", v % SIDE < 3 ? "1e-6" : "1" );
    }
    fclose( file );
    char map[600];
    snprintf( map, sizeof map, "{ map: %s, to: 1000 }", path );
    build_sheets( &f, map, "1e6" );
    step( &f, 20 );
    const scene_body a = scene_world_body( &f.world, 0 );
    assert_true( f.world.surfaces[0].split_count > 0 );
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        const int column = t / 2 % ( SIDE - 1 ); // cells are row by row
        for ( int k = 0; k < 3 && column >= 3; ++k )
        {
            assert_true( a.triangles[3 * t + k] < OWN );
        }
    }
}

// ---- copies ----

static void demand_parse_refusal( const char* text, const char* part )
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
    SCOPED( wisp_scene_release )
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
}

TEST( without_columns_the_grid_is_as_wide_as_the_root )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed(
        "wisp: 1\nstrands:\n"
        "  - { name: tuft, generate: { strands: 2, vertices: 3 }, copies: { count: 7, spacing: [1, 0, 1] } }\n" );
    assert_int_equal( scene.strands_count, 7 );
    assert_vector( scene.strands[2].pose.translation, 2, 0, 0 );
    assert_vector( scene.strands[3].pose.translation, 0, 0, 1 );
    assert_vector( scene.strands[6].pose.translation, 0, 0, 2 );
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
        SCOPED( wisp_scene_release ) wisp_scene scene = parsed( texts[i] );
        SCOPED( scene_world_destroy ) scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
        for ( int step = 0; step < scene.steps; ++step )
        {
            assert_ok( scene_world_step( &world, &error ), error );
        }
        hashes[i] = wisp_world_hash( world.world );
    }
    assert_true( hashes[0] == hashes[1] );
}

TEST( what_has_no_place_or_no_name_is_refused )
{
    demand_parse_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 2, spacing: [1, 0, 0] } }\n"
        "  - { name: a-2, generate: { shape: plane } }\n",
        "the name of the copy 'a-2' is taken by the entry in line 4" );
    demand_parse_refusal(
        "wisp: 1\nstrands:\n  - { name: a, generate: { strands: 2 }, dynamics: {} }\n"
        "  - { name: b, scatter: { around: a, count: 2, radius: 0.1 }, copies: { count: 2, spacing: [1, 0, 0] } }\n",
        "'copies' is not possible with 'scatter'" );
    demand_parse_refusal( "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 2 } }\n",
                          "spacing" );
    demand_parse_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane }, copies: { count: 0, spacing: [1, 0, 0] } }\n",
        "count" );
}

// A short scene cannot ask for more than a long one.
TEST( copies_count_to_the_limits_of_a_scene )
{
    demand_parse_refusal(
        "wisp: 1\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane }, copies: { count: 10000, spacing: [1, 0, 0] } }\n"
        "  - { name: b, generate: { shape: plane } }\n",
        "10001 surfaces" );
    demand_parse_refusal(
        "wisp: 1\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 100, rows: 100 }, copies: { count: 10000, "
        "spacing: [1, 0, 0] } }\n",
        "100000000 vertices" );
    demand_parse_refusal(
        "wisp: 1\nstrands:\n"
        "  - { name: a, generate: { strands: 100000, vertices: 20 }, copies: { count: 10000, spacing: "
        "[1, 0, 0] } }\n",
        "20000000000 vertices" );
    demand_parse_refusal(
        "wisp: 1\nsurfaces:\n"
        "  - { name: abcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcdefghijabcd, generate: { shape: plane }, "
        "copies: { count: 2, spacing: [1, 0, 0] } }\n",
        "more than 64 characters" );
}
