// What a host does that holds a scene in memory: arrays in place of files, an edited text, messages in its own log, frames of any length.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

#include "scene_edit.h"
#include "world_from_scene.h"

#include <stdio.h>
#include <stdlib.h>

static const wisp_vec3 POINTS[] = {
    { 0.0f, 1.0f, 0.0f }, { 0.1f, 1.0f, 0.0f }, { 0.0f, 1.0f, 0.1f }, { 0.1f, 1.0f, 0.1f }
};
static const int32_t TRIANGLES[] = { 0, 2, 3, 0, 3, 1, 0, 3, 1 };
static const int32_t OFFSETS[] = { 0, 2, 4 };

static const wisp_scene_arrays MESH = {
    .file = "memory", .points = POINTS, .point_count = 4, .triangles = TRIANGLES, .triangle_count = 2
};
static const wisp_scene_arrays STRANDS = {
    .file = "memory", .points = POINTS, .point_count = 4, .offsets = OFFSETS, .strand_count = 2
};

#define SHEET "wisp: 1\nsteps: 9\nsurfaces:\n  - { name: sheet, file: memory, pins: [0], cloth: {} }\n"
#define TUFT "strands:\n  - { name: tuft, file: memory, dynamics: {}, copies: { count: 2, spacing: [1, 0, 0] } }\n"

static wisp_scene scene_in( const char* text, const char* name, const wisp_scene_arrays* arrays, int count )
{
    wisp_scene scene;
    wisp_error error = { 0 };
    assert_ok( wisp_scene_parse( text, strlen( text ), name, &scene, &error ), error );
    assert_ok( wisp_scene_set_arrays( &scene, arrays, count, &error ), error );
    return scene;
}

TEST( arrays_stand_for_the_files_that_entries_and_their_copies_name )
{
    const wisp_scene_arrays both[] = { MESH, STRANDS };
    // the name of the scene has a folder, to which its files are relative
    wisp_scene scene = scene_in( SHEET TUFT, "some/folder/test.yaml", both, 2 );
    const scene_world_options options = { .workers = 1 };
    scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    assert_int_equal( scene_world_body_count( &world ), 3 );
    assert_int_equal( scene_world_body( &world, 1 ).strand_count, 2 );
    assert_string_equal( scene_world_body( &world, 1 ).name, "tuft-2" );
    const scene_body sheet = scene_world_body( &world, 2 );
    assert_int_equal( sheet.vertex_count, 4 );
    assert_memory_equal( sheet.triangles, TRIANGLES, 6 * sizeof *TRIANGLES );
    assert_ok( scene_world_step( &world, &error ), error );
    scene_world_destroy( &world );
    wisp_scene_release( &scene );
}

static void demand_no_world( const char* text, wisp_scene_arrays arrays, const char* words )
{
    wisp_scene scene = scene_in( text, "test.yaml", &arrays, 1 );
    const scene_world_options options = { .workers = 1 };
    scene_world world;
    wisp_error error = { 0 };
    assert_int_equal( scene_world_create( &scene, &options, &world, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    wisp_scene_release( &scene );
}

TEST( wrong_arrays_are_refused_as_wrong_files_are )
{
    static const wisp_vec3 infinite[] = {
        { 0.0f, 0.0f, 0.0f }, { 0.0f, INFINITY, 0.0f }, { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f }
    };
    static const int32_t backward[] = { 0, 3, 2 };
    wisp_scene_arrays a = MESH;
    a.point_count = 3;
    demand_no_world( SHEET, a, "memory: triangle 0: corner 2: got vertex 3, expected 0 .. 2" );
    a = MESH;
    a.points = infinite;
    demand_no_world( SHEET, a, "memory: vertex 1: y is infinite" );
    a = MESH;
    a.triangle_count = 0;
    demand_no_world( SHEET, a, "the mesh is empty" );
    a = STRANDS;
    a.offsets = backward;
    demand_no_world( "wisp: 1\n" TUFT, a, "strand 1 runs from vertex 3 to 2" );
    a.points = infinite;
    a.offsets = OFFSETS;
    demand_no_world( "wisp: 1\n" TUFT, a, "memory: groom" );
}

TEST( arrays_that_no_entry_names_are_refused )
{
    wisp_scene scene = parsed( SHEET );
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_set_arrays( &scene, &STRANDS, 1, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "got strands for 'memory', but no entry has that file" );
    wisp_scene_release( &scene );
}

TEST( an_edited_text_keeps_its_other_bytes_and_is_checked )
{
    static const char text[] = "\xef\xbb\xbfwisp: 1 # one\nsubsteps: 3\n";
    const wisp_scene_edit good = { NULL, 0, NULL, "substeps", "7" }, bad = { NULL, 0, NULL, "substeps", "0" };
    char* out = NULL;
    size_t size = 0;
    wisp_error error = { 0 };
    assert_ok( wisp_scene_edit_text( text, strlen( text ), "test.yaml", &good, 1, &out, &size, &error ), error );
    assert_string_equal( out, "\xef\xbb\xbfwisp: 1 # one\nsubsteps: 7\n" );
    assert_int_equal( size, strlen( out ) );
    free( out );
    assert_int_equal( wisp_scene_edit_text( text, strlen( text ), "test.yaml", &bad, 1, &out, &size, &error ),
                      WISP_BAD_INPUT );
    assert_contains( error.message, "substeps: got 0" );
    assert_null( out );
}

// ---- messages ----

static void keep_message( void* user, wisp_log_level level, const char* message )
{
    char* kept = user;
    const size_t length = strlen( kept );
    snprintf( kept + length, 1000 - length, "%d %s\n", (int)level, message );
}

TEST( warnings_of_a_world_go_to_the_log_of_its_host )
{
    wisp_scene_arrays a = MESH;
    a.triangle_count = 3;
    char kept[1000] = "";
    wisp_scene scene =
        scene_in( "wisp: 1\nsurfaces:\n  - { name: sheet, file: memory, repair: [duplicates], cloth: {} }\n",
                  "test.yaml", &a, 1 );
    for ( int quiet = 0; quiet < 2; ++quiet )
    {
        const scene_world_options options = {
            .workers = 1, .is_quiet = quiet, .log = keep_message, .log_user = kept
        };
        scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
        scene_world_destroy( &world );
    }
    // once: the second world was quiet
    assert_string_equal( kept, "1 test.yaml:3:5: surface 'sheet': 1 duplicate triangle was removed\n" );
    wisp_scene_release( &scene );
}

// ---- frames of any length ----

#define MOVED                                                                                                        \
    SHEET "events:\n  - { step: 2, surface: sheet, velocity: [1, 0, 0] }\n  - { step: 5, surface: sheet, release: "  \
          "true }\n"

TEST( frames_of_any_length_make_the_steps_of_the_scene )
{
    wisp_scene scene = scene_in( MOVED, "test.yaml", &MESH, 1 );
    const scene_world_options options = { .workers = 1 };
    scene_world frames, steps;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &frames, &error ), error );
    assert_ok( scene_world_create( &scene, &options, &steps, &error ), error );
    static const float lengths[] = { 0.5f, 2.0f, 0.25f, 3.5f, 0.0f, 0.8f }; // of a step; 7.05 in all
    for ( int i = 0; i < WISP_COUNT( lengths ); ++i )
    {
        assert_ok( scene_world_advance( &frames, lengths[i] * scene.dt, &error ), error );
    }
    assert_int_equal( frames.next_step, 7 );
    while ( steps.next_step < 7 )
    {
        assert_ok( scene_world_step( &steps, &error ), error );
    }
    assert_true( wisp_world_hash( frames.world ) == wisp_world_hash( steps.world ) );
    assert_int_equal( scene_world_advance( &frames, -1.0f, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "test.yaml: step 7: advance: got -1 s" );
    scene_world_destroy( &frames );
    scene_world_destroy( &steps );
    wisp_scene_release( &scene );
}

TEST( a_scene_with_steps_of_several_lengths_has_no_frames )
{
    wisp_scene scene = scene_in( SHEET "dt_factors: [1, 2]\n", "test.yaml", &MESH, 1 );
    const scene_world_options options = { .workers = 1 };
    scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    assert_int_equal( scene_world_advance( &world, 0.1f, &error ), WISP_CONFLICT );
    assert_contains( error.message, "dt_factors" );
    assert_int_equal( world.next_step, 0 );
    scene_world_destroy( &world );
    wisp_scene_release( &scene );
}
