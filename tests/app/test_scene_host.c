// What a host does that holds a scene in memory: arrays in place of files, an edited text, messages in its own log, frames
// of any length. Changes of single values in a scene's file: every other byte stays, for any layout of the file. Where the
// memory of a world goes: the parts of every scene of the project add up to what the host has lent, and none is unnamed.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

#include "files.h"
#include "scene.h"
#include "scene_edit.h"
#include "world_from_scene.h"

#include <dirent.h>
#include <stdatomic.h>

// ---- arrays and an edited text ----

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
    SCOPED( wisp_scene_release ) wisp_scene scene = scene_in( SHEET TUFT, "some/folder/test.yaml", both, 2 );
    const scene_world_options options = { .workers = 1 };
    SCOPED( scene_world_destroy ) scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    assert_int_equal( scene_world_body_count( &world ), 3 );
    assert_int_equal( scene_world_body( &world, 1 ).strand_count, 2 );
    assert_string_equal( scene_world_body( &world, 1 ).name, "tuft-2" );
    const scene_body sheet = scene_world_body( &world, 2 );
    assert_int_equal( sheet.vertex_count, 4 );
    assert_memory_equal( sheet.triangles, TRIANGLES, 6 * sizeof *TRIANGLES );
    assert_ok( scene_world_step( &world, &error ), error );
}

static void demand_no_world( const char* text, wisp_scene_arrays arrays, const char* words )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = scene_in( text, "test.yaml", &arrays, 1 );
    const scene_world_options options = { .workers = 1 };
    scene_world world;
    wisp_error error = { 0 };
    assert_int_equal( scene_world_create( &scene, &options, &world, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
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
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( SHEET );
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_set_arrays( &scene, &STRANDS, 1, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "got strands for 'memory', but no entry has that file" );
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
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        scene_in( "wisp: 1\nsurfaces:\n  - { name: sheet, file: memory, repair: [duplicates], cloth: {} }\n",
                  "test.yaml", &a, 1 );
    for ( int quiet = 0; quiet < 2; ++quiet )
    {
        const scene_world_options options = {
            .workers = 1, .is_quiet = quiet, .log = keep_message, .log_user = kept
        };
        SCOPED( scene_world_destroy ) scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    }
    // once: the second world was quiet
    assert_string_equal( kept, "1 test.yaml:3:5: surface 'sheet': 1 duplicate triangle was removed\n" );
}

// ---- frames of any length ----

#define MOVED                                                                                                        \
    SHEET "events:\n  - { step: 2, surface: sheet, velocity: [1, 0, 0] }\n  - { step: 5, surface: sheet, release: "  \
          "true }\n"

TEST( frames_of_any_length_make_the_steps_of_the_scene )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = scene_in( MOVED, "test.yaml", &MESH, 1 );
    const scene_world_options options = { .workers = 1 };
    SCOPED( scene_world_destroy ) scene_world frames, steps;
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
}

TEST( a_scene_with_steps_of_several_lengths_has_no_frames )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = scene_in( SHEET "dt_factors: [1, 2]\n", "test.yaml", &MESH, 1 );
    const scene_world_options options = { .workers = 1 };
    SCOPED( scene_world_destroy ) scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    assert_int_equal( scene_world_advance( &world, 0.1f, &error ), WISP_CONFLICT );
    assert_contains( error.message, "dt_factors" );
    assert_int_equal( world.next_step, 0 );
}

#define FROM "scene_edit_from.yaml"
#define TO "scene_edit_to.yaml"

static void assert_edited( const char* text, const wisp_scene_edit* edits, int count, const char* expected )
{
    write_text( FROM, text );
    wisp_error error = { 0 };
    assert_ok( wisp_scene_edit_file( FROM, edits, count, TO, &error ), error );
    char is[4000];
    read_text( TO, is, sizeof is );
    assert_string_equal( is, expected );
    remove( FROM );
    remove( TO );
}

static void assert_not_edited( const char* text, wisp_scene_edit edit, const char* words )
{
    write_text( FROM, text );
    write_text( TO, "what was there" );
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_edit_file( FROM, &edit, 1, TO, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    char is[4000];
    read_text( TO, is, sizeof is );
    assert_string_equal( is, "what was there" );
    remove( FROM );
    remove( TO );
}

static const wisp_scene_edit substeps_7 = { NULL, 0, NULL, "substeps", "7" };
static const wisp_scene_edit tethers = { "surfaces", 1, "cloth", "tethers", "true" };

#define SURFACE( name ) "  - name: " name "\n    generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"

// ---- existing values ----

TEST( a_value_is_replaced_and_comments_stay )
{
    assert_edited( "# of a flag\nwisp: 1 # the only one\n\nsubsteps:   12  # many\nsteps: 3\n", &substeps_7, 1,
                   "# of a flag\nwisp: 1 # the only one\n\nsubsteps:   7  # many\nsteps: 3\n" );
}

TEST( columns_count_characters_and_not_bytes )
{
    // Two values on the line of a file's name whose letters have two bytes each.
    const wisp_scene_edit edit = { "surfaces", 0, "cloth", "tethers", "false" };
    assert_edited( "wisp: 1\nsurfaces:\n  - { name: a, file: \xc3\xa4\xc3\xb6\xc3\xbc.obj,"
                   " pins: [0], cloth: { tethers: true } }\n",
                   &edit, 1,
                   "wisp: 1\nsurfaces:\n  - { name: a, file: \xc3\xa4\xc3\xb6\xc3\xbc.obj,"
                   " pins: [0], cloth: { tethers: false } }\n" );
}

TEST( a_byte_order_mark_and_returns_stay )
{
    const wisp_scene_edit edits[2] = { substeps_7, { NULL, 0, NULL, "iterations", "3" } };
    assert_edited( "\xef\xbb\xbfwisp: 1\r\nsubsteps: 2\r\n", edits, 2,
                   "\xef\xbb\xbfwisp: 1\r\niterations: 3\r\nsubsteps: 7\r\n" );
}

// ---- missing keys ----

TEST( a_key_joins_its_mapping_behind_a_line_of_it )
{
    const wisp_scene_edit edits[2] = { { "surfaces", 0, NULL, "damping", "0.5" }, substeps_7 };
    assert_edited(
        "wisp: 1 # first\nsurfaces:\n" SURFACE( "a # named" ) "    # soft\n    cloth: {}\n", edits, 2,
        "wisp: 1 # first\nsubsteps: 7\nsurfaces:\n  - name: a # named\n    damping: 0.5\n    generate: { shape: "
        "plane, columns: 3, rows: 3, spacing: 0.1 }\n    # soft\n    cloth: {}\n" );
}

TEST( a_key_joins_braces_and_lines_of_the_entry_that_is_meant )
{
    assert_edited(
        "wisp: 1\nsurfaces:\n" SURFACE( "a" ) "    cloth: {}\n" SURFACE( "b" ) "    pins: [0]\n    cloth: {}\n",
        &tethers, 1,
        "wisp: 1\nsurfaces:\n" SURFACE( "a" ) "    cloth: {}\n" SURFACE(
            "b" ) "    pins: [0]\n    cloth: { tethers: true }\n" );
    assert_edited( "wisp: 1\nsurfaces:\n" SURFACE( "a" )
                       SURFACE( "b" ) "    pins: [0]\n    cloth: {drag_coefficient: 1}\n",
                   &tethers, 1,
                   "wisp: 1\nsurfaces:\n" SURFACE( "a" )
                       SURFACE( "b" ) "    pins: [0]\n    cloth: { tethers: true, drag_coefficient: "
                                      "1}\n" );
    assert_edited(
        "wisp: 1\nsurfaces:\n" SURFACE( "a" ) SURFACE( "b" ) "    pins: [0]\n    cloth:\n      wind: [0, 0, 1]\n",
        &tethers, 1,
        "wisp: 1\nsurfaces:\n" SURFACE( "a" ) SURFACE( "b" ) "    pins: [0]\n    cloth:\n      tethers: true\n"
                                                             "      wind: [0, 0, 1]\n" );
}

TEST( two_keys_join_braces_with_a_comma_between_them )
{
    const wisp_scene_edit edits[2] = { tethers, { "surfaces", 1, "cloth", "drag_coefficient", "1" } };
    static const char* const braces[][2] = {
        { "{}", "{ tethers: true, drag_coefficient: 1 }" },
        { "{ }", "{ tethers: true, drag_coefficient: 1 }" },
        { "{lift_coefficient: 1}", "{ tethers: true, drag_coefficient: 1, lift_coefficient: 1}" },
        { "{ lift_coefficient: 1 }", "{ tethers: true, drag_coefficient: 1, lift_coefficient: 1 }" }
    };
    for ( int i = 0; i < WISP_COUNT( braces ); ++i )
    {
        char from[400], expected[400];
        static const char head[] = "wisp: 1\nsurfaces:\n" SURFACE( "a" ) SURFACE( "b" ) "    pins: [0]\n    cloth: ";
        snprintf( from, sizeof from, "%s%s\n", head, braces[i][0] );
        snprintf( expected, sizeof expected, "%s%s\n", head, braces[i][1] );
        assert_edited( from, edits, 2, expected );
    }
}

TEST( a_last_line_without_an_end_gets_one )
{
    assert_edited( "wisp: 1", &substeps_7, 1, "wisp: 1\nsubsteps: 7" );
}

TEST( json_stays_json )
{
    const wisp_scene_edit edits[2] = { substeps_7, { NULL, 0, NULL, "steps", "4" } };
    assert_edited( "{\n  \"wisp\": 1,\n  \"steps\": 3\n}\n", edits, 2,
                   "{ \"substeps\": 7,\n  \"wisp\": 1,\n  \"steps\": 4\n}\n" );
}

TEST( no_edits_copy_the_file )
{
    assert_edited( "wisp: 1\n# end\n", NULL, 0, "wisp: 1\n# end\n" );
}

// ---- removed keys ----

static const wisp_scene_edit no_substeps = { NULL, 0, NULL, "substeps", "" };
static const wisp_scene_edit no_damping = { "surfaces", 0, NULL, "damping", "" };

#define MAKE "generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }"
#define JSON_MAKE "\"generate\": { \"shape\": \"plane\", \"columns\": 3, \"rows\": 3, \"spacing\": 0.1 }"

TEST( a_key_goes_with_its_line_and_a_comment_stays )
{
    assert_edited( "# of a flag\nwisp: 1\nsubsteps:  12 \n\nsteps: 3\n", &no_substeps, 1,
                   "# of a flag\nwisp: 1\n\nsteps: 3\n" );
    assert_edited( "wisp: 1\nsubsteps: 12  # many\nsteps: 3\n", &no_substeps, 1, "wisp: 1\n# many\nsteps: 3\n" );
    assert_edited( "wisp: 1\r\nsubsteps: 12\r\nsteps: 3\r\n", &no_substeps, 1, "wisp: 1\r\nsteps: 3\r\n" );
    assert_edited( "wisp: 1\nsubsteps: 12", &no_substeps, 1, "wisp: 1\n" );
    assert_edited( "wisp: 1\nsurfaces:\n  - damping: 1\n    name: a\n    " MAKE "\n", &no_damping, 1,
                   "wisp: 1\nsurfaces:\n  - \n    name: a\n    " MAKE "\n" );
}

TEST( a_key_leaves_braces_with_its_comma )
{
    assert_edited( "wisp: 1\nsurfaces: [{ damping: 1, name: a, " MAKE " }]\n", &no_damping, 1,
                   "wisp: 1\nsurfaces: [{ name: a, " MAKE " }]\n" );
    assert_edited( "wisp: 1\nsurfaces: [{name: a,damping: 1,  " MAKE "}]\n", &no_damping, 1,
                   "wisp: 1\nsurfaces: [{name: a," MAKE "}]\n" );
    assert_edited( "wisp: 1\nsurfaces: [{ name: a, " MAKE ", damping: 1 }]\n", &no_damping, 1,
                   "wisp: 1\nsurfaces: [{ name: a, " MAKE " }]\n" );
    assert_edited( "wisp: 1\nsurfaces:\n  - name: b\n    " MAKE "\n    cloth: { drag_coefficient: 1 }\n",
                   &( wisp_scene_edit ){ "surfaces", 0, "cloth", "drag_coefficient", "" }, 1,
                   "wisp: 1\nsurfaces:\n  - name: b\n    " MAKE "\n    cloth: {  }\n" );
}

TEST( json_loses_a_key_and_stays_json )
{
    assert_edited( "{\n  \"wisp\": 1,\n  \"substeps\" : 3,\n  \"steps\": 3\n}\n", &no_substeps, 1,
                   "{\n  \"wisp\": 1,\n  \"steps\": 3\n}\n" );
    assert_edited( "{\n  \"wisp\": 1,\n  \"substeps\": 3\n}\n", &no_substeps, 1, "{\n  \"wisp\": 1\n}\n" );
    assert_edited( "{ \"wisp\": 1, \"surfaces\": [{ \"name\": \"a\", \"damping\": 1, " JSON_MAKE " }] }", &no_damping,
                   1, "{ \"wisp\": 1, \"surfaces\": [{ \"name\": \"a\", " JSON_MAKE " }] }" );
}

TEST( a_key_that_is_not_there_stays_away )
{
    assert_edited( "wisp: 1\n# end\n", &no_substeps, 1, "wisp: 1\n# end\n" );
}

TEST( keys_come_and_go_at_one_place )
{
    const wisp_scene_edit edits[3] = { no_substeps,
                                       { NULL, 0, NULL, "steps", "4" },
                                       { NULL, 0, NULL, "iterations", "2" } };
    assert_edited( "substeps: 3\nsteps: 3\nwisp: 1\n", edits, 3, "iterations: 2\nsteps: 4\nwisp: 1\n" );
    assert_edited( "{\"substeps\": 3, \"steps\": 3, \"wisp\": 1}\n", edits, 3,
                   "{ \"iterations\": 2, \"steps\": 4, \"wisp\": 1}\n" );
}

TEST( keys_that_do_not_go_alone_are_refused )
{
    const wisp_scene_edit no_pins = { "surfaces", 0, NULL, "pins", "" };
    assert_not_edited( "wisp: 1\nsurfaces:\n" SURFACE( "a" ) "    pins: [0]\n    cloth: {}\n", no_pins,
                       FROM ":5:11: 'pins' cannot be removed here" );
    assert_not_edited( "wisp: 1\nsubsteps:\n  3\n", no_substeps, "'substeps' cannot be removed here" );
    // Whether a comma belongs to a comment cannot be determined from its line.
    assert_not_edited( "{ wisp: 1, # first,\n  substeps: 3\n}\n", no_substeps, "'substeps' cannot be removed here" );
    assert_not_edited( "{ wisp: 1, substeps: 3 # last\n}\n", no_substeps, "'substeps' cannot be removed here" );
    const wisp_scene_edit no_name = { "surfaces", 0, NULL, "name", "" };
    assert_not_edited( "wisp: 1\nsurfaces:\n" SURFACE( "a" ), no_name, "name" );
}

TEST( two_keys_that_request_one_comma_are_refused )
{
    write_text( FROM, "{ wisp: 1, steps: 3, substeps: 3 }\n" );
    const wisp_scene_edit edits[2] = { { NULL, 0, NULL, "steps", "" }, no_substeps };
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_edit_file( FROM, edits, 2, TO, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, FROM ": two changes are at the same place" ) );
    remove( FROM );
}

// ---- rejected input ----

TEST( what_is_not_there_is_refused_and_nothing_is_written )
{
    assert_not_edited( "wisp: 1\nsurfaces:\n" SURFACE( "a" ), tethers, "'tethers' cannot be set to true here" );
    assert_not_edited( "wisp: 1\nsubsteps: [\n", substeps_7, "not YAML" );
}

TEST( a_value_in_several_primitives_is_refused_with_its_line )
{
    const wisp_scene_edit edit = { "surfaces", 0, NULL, "name", "short" };
    assert_not_edited(
        "wisp: 1\nsurfaces:\n  - name: a long\n      name\n    generate: { shape: plane, columns: 3, rows: 3, "
        "spacing: 0.1 }\n",
        edit, FROM ":3:11: 'name' cannot be set" );
}

TEST( a_result_that_is_no_scene_is_not_written )
{
    const wisp_scene_edit edit = { NULL, 0, NULL, "substeps", "0" };
    assert_not_edited( "wisp: 1\n", edit, "substeps" );
    const wisp_scene_edit unknown = { NULL, 0, NULL, "substepz", "1" };
    assert_not_edited( "wisp: 1\n", unknown, "did you mean 'substeps'?" );
}

TEST( without_a_place_to_write_nothing_is_written )
{
    write_text( FROM, "wisp: 1\n" );
    assert_int_equal( wisp_scene_edit_file( FROM, &substeps_7, 1, NULL, NULL ), WISP_OK );
    char is[100];
    read_text( FROM, is, sizeof is );
    assert_string_equal( is, "wisp: 1\n" );
    assert_int_equal( wisp_scene_edit_file( FROM, &substeps_7, 1, FROM, NULL ), WISP_OK );
    read_text( FROM, is, sizeof is );
    assert_string_equal( is, "wisp: 1\nsubsteps: 7\n" );
    remove( FROM );
    assert_int_equal( wisp_scene_edit_file( "no_such.yaml", &substeps_7, 1, NULL, NULL ), WISP_IO_ERROR );
}

// ---- where memory goes ----

enum
{
    MAX_PARTS = 300,
    STEPS = 3,
};

static void* lend( void* user, size_t size, size_t alignment )
{
    atomic_fetch_add( (_Atomic size_t*)user, size );
    return aligned_alloc( alignment, ( size + alignment - 1 ) / alignment * alignment );
}

static void take_back( void* user, void* block, size_t size )
{
    atomic_fetch_sub( (_Atomic size_t*)user, size );
    free( block );
}

static const wisp_memory_part* find_part( const wisp_memory_part* parts, int count, const char* name )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( parts[i].name, name ) == 0 )
        {
            return parts + i;
        }
    }
    return NULL;
}

// @return number of parts
static int check_parts( const wisp_world* world, size_t lent, const char* scene, wisp_memory_part parts[MAX_PARTS] )
{
    const int count = wisp_world_memory_parts( world, parts, MAX_PARTS );
    assert_true( count > 0 && count <= MAX_PARTS );
    assert_int_equal( wisp_world_memory_parts( world, NULL, 0 ), count );
    size_t sum = 0;
    for ( int i = 0; i < count; ++i )
    {
        sum += parts[i].kind != WISP_MEMORY_OUTSIDE ? parts[i].capacity : 0;
        assert_true( parts[i].capacity > 0 && parts[i].bytes <= parts[i].capacity );
        assert_true( i == 0 || parts[i].kind >= parts[i - 1].kind );
    }
    if ( sum != lent || wisp_world_memory( world ) != lent || find_part( parts, count, "other" ) )
    {
        const wisp_memory_part* other = find_part( parts, count, "other" );
        fail_msg( "%s: parts have %zu bytes, %zu of them unnamed; the world says %zu, its host %zu", scene, sum,
                  other ? other->capacity : 0, wisp_world_memory( world ), lent );
    }
    return count;
}

static void run_scene( const char* file, int workers )
{
    static wisp_memory_part parts[MAX_PARTS];
    _Atomic size_t lent = 0;
    const wisp_allocator allocator = { lend, take_back, &lent };
    const scene_world_options options = { .workers = workers, .is_quiet = true, .allocator = &allocator };
    SCOPED( wisp_scene_release ) wisp_scene scene = read_good( file );
    scene_world world;
    wisp_error error = { 0 };
    assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
    check_parts( world.world, atomic_load( &lent ), file, parts );
    for ( int step = 0; step < scene.steps && step < STEPS; ++step )
    {
        assert_ok( scene_world_step( &world, &error ), error );
        check_parts( world.world, atomic_load( &lent ), file, parts );
    }
    scene_world_destroy( &world );
    assert_int_equal( atomic_load( &lent ), 0 );
}

TEST( parts_of_every_scene_add_up_to_what_the_host_lent )
{
    struct dirent** entries;
    const int count = scandir( WISP_SOURCE_ROOT "/data/scenes", &entries, NULL, alphasort );
    int scenes = 0;
    assert_true( count > 0 );
    for ( int i = 0; i < count; ++i )
    {
        const char* dot = strrchr( entries[i]->d_name, '.' );
        if ( dot && strcmp( dot, ".yaml" ) == 0 )
        {
            run_scene( entries[i]->d_name, 1 + i % 2 );
            ++scenes;
        }
        free( entries[i] );
    }
    free( entries );
    assert_true( scenes >= 20 );
}

// Multipliers of links have rows with several iterations only.
TEST( what_one_iteration_does_not_read_has_no_rows )
{
    wisp_memory_part parts[MAX_PARTS];
    for ( int iterations = 1; iterations <= 2; ++iterations )
    {
        char text[300];
        snprintf( text, sizeof text,
                  "wisp: 1\niterations: %d\nsurfaces:\n"
                  "  - { name: a, generate: { shape: plane, columns: 9, rows: 9 }, pins: [0], cloth: {} }\n",
                  iterations );
        SCOPED( wisp_scene_release ) wisp_scene scene = parsed( text );
        const scene_world_options options = { .workers = 1, .is_quiet = true };
        SCOPED( scene_world_destroy ) scene_world world;
        wisp_error error = { 0 };
        assert_ok( scene_world_create( &scene, &options, &world, &error ), error );
        assert_ok( scene_world_step( &world, &error ), error );
        const int count = wisp_world_memory_parts( world.world, parts, MAX_PARTS );
        const wisp_memory_part* compliance = find_part( parts, count, "link.compliance" );
        const wisp_memory_part* lambda = find_part( parts, count, "link.lambda" );
        assert_non_null( compliance );
        assert_int_equal( compliance->bytes, 2 * sizeof( float ) );
        assert_int_equal( lambda != NULL, iterations > 1 );
        assert_true( find_part( parts, count, "link.own" ) == NULL ); // all edges are alike, and so are bend links
        assert_true( lambda == NULL || lambda->bytes == 4 * (size_t)world.surfaces[0].fabric->link_order.slot_count );
        const wisp_memory_part* fabrics = find_part( parts, count, "fabrics" );
        assert_non_null( fabrics );
        assert_int_equal( fabrics->kind, WISP_MEMORY_OUTSIDE );
        assert_int_equal( fabrics->bytes, wisp_fabric_bytes( world.surfaces[0].fabric ) );
    }
}
