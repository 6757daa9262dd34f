// Changes of single values in a scene's file: every other byte stays, for any layout of the file.
#include "files.h"

#include "scene.h"
#include "scene_edit.h"

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
