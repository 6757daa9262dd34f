// Every file in tests/bad/scene is refused with exactly the sentence below: place, key and what is wrong. The folder
// is walked, so that a file dropped there without a sentence fails.
#define _XOPEN_SOURCE 700

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <dirent.h>

#include <cmocka.h>

#include "scene.h"

#ifndef WISP_SOURCE_ROOT
#define WISP_SOURCE_ROOT "."
#endif

static const char FOLDER[] = WISP_SOURCE_ROOT "/tests/bad/scene";

typedef struct bad_scene
{
    const char* file;
    const char* sentence; // what follows the file's name
} bad_scene;

// clang-format off
static const bad_scene BAD_SCENES[] = {
    { "alias.yaml",
      ":2:8: an alias (*); write the values out where they are used" },
    { "anchor.yaml",
      ":1:7: an anchor (&); write the values out where they are used" },
    { "angle_in_degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_angle_max: 45 is out of range, must be in [0, 3.14159265]" },
    { "bad_indent.yaml",
      ":4:10: not YAML: mapping values are not allowed in this context" },
    { "base_sixty.yaml",
      ":2:8: steps: must be a whole number, not '1:30'" },
    { "below_absolute_zero.yaml",
      ":5:29: strands[0].climate.temperature: -300 is out of range, must be in [-273.15, 1000]" },
    { "bias_one.yaml",
      ":5:26: strands[0].look.colour_bias: 1 is out of range, must be in [0.001, 0.999]" },
    { "block_is_list.yaml",
      ":6:7: strands[0].frozen_hair: must be a mapping ({} takes the defaults), not a list" },
    { "block_is_true.yaml",
      ":6:15: strands[0].frozen_hair.freeze: must be a mapping ({} takes the defaults), not 'true'" },
    { "capital_key.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'Radius', did you mean 'radius'?" },
    { "celsius.yaml",
      ":5:29: strands[0].climate.temperature: '-10C' has a unit; temperatures are plain numbers in degrees Celsius" },
    { "choice_far.yaml",
      ":6:23: strands[0].frozen_hair.align.blend: must be one of arc, chord, not 'quadratic'" },
    { "choice_near.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: must be one of prose, printed, closing, wet, not 'pose', did you mean 'prose'?" },
    { "choice_number.yaml",
      ":6:13: strands[0].frozen_hair.base: must be one of rest, previous, not '1'" },
    { "colour_bytes.yaml",
      ":5:27: strands[0].look.root_colour[0]: 255 is out of range, must be in [0, 1]" },
    { "comma.yaml",
      ":2:15: step_seconds: '0,02' has a comma; write a decimal point" },
    { "command_no_strands.yaml",
      ":3:25: commands[0].strands: there are no strands 'hair': the scene has none" },
    { "command_not_frozen.yaml",
      ":6:25: commands[0].strands: the strands 'hair' have no key 'frozen_hair', which alone takes commands" },
    { "command_too_late.yaml",
      ":9:5: commands[0]: step 3 never comes: the scene has 3, counted from 0" },
    { "command_twice.yaml",
      ":11:5: commands: strands 'hair' have a command for step 2 already, in line 9" },
    { "command_unknown_strands.yaml",
      ":8:25: commands[0].strands: there are no strands 'hiar', did you mean 'hair'?" },
    { "command_without_cursor.yaml",
      ":8:5: commands[0]: key 'cursor' is missing" },
    { "control_character.yaml",
      ":2:8: control character U+001B is not allowed in a scene" },
    { "cursor_far.yaml",
      ":6:28: strands[0].frozen_hair.align.cursor[1]: 1e7 is out of range, must be in [-1000000, 1000000]" },
    { "cursor_mapping.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: must be a list of three numbers, not a mapping" },
    { "cursor_two_numbers.yaml",
      ":6:24: strands[0].frozen_hair.align.cursor: must be a list of three numbers, not of 2" },
    { "curve_ends_early.yaml",
      ":5:33: strands[0].climate.curve[1]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_from_half.yaml",
      ":5:25: strands[0].climate.curve[0]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_ice_falls.yaml",
      ":5:43: strands[0].climate.curve[2]: ice must rise from 0 at the first point to 1 at the last" },
    { "curve_nine_points.yaml",
      ":5:23: strands[0].climate.curve: must have 2 to 8 points, not 9" },
    { "curve_one_point.yaml",
      ":5:23: strands[0].climate.curve: must have 2 to 8 points, not 1" },
    { "curve_returns.yaml",
      ":5:42: strands[0].climate.curve[2]: stiffness turns back; it must rise or fall throughout" },
    { "curve_triple.yaml",
      ":5:24: strands[0].climate.curve[0]: must be a pair [ice, stiffness]" },
    { "curve_turns_back.yaml",
      ":5:52: strands[0].climate.curve[3]: stiffness turns back; it must rise or fall throughout" },
    { "cut_utf8.yaml",
      ":1:11: byte 0xe2 is not UTF-8; save the file as UTF-8" },
    { "cycle.yaml",
      ":2:10: an anchor (&); write the values out where they are used" },
    { "degrees.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_angle_max: '45°' has a unit; angles are plain numbers in radians" },
    { "dimension_four.yaml",
      ":3:38: strands[0].make.dimension: 4 is out of range, must be in [2, 3]" },
    { "directive.yaml",
      ":1:1: a YAML directive; a scene has no use for them" },
    { "duplicate_key.yaml",
      ":8:7: strands[0].frozen_hair: key 'seed' is written twice, first in line 6" },
    { "duplicate_strands.yaml",
      ":4:1: key 'strands' is written twice, first in line 2" },
    { "empty.yaml",
      ": the scene is empty; it needs at least the line 'wisp: 1'" },
    { "empty_block.yaml",
      ":6:14: strands[0].frozen_hair.freeze: must be a mapping ({} takes the defaults), but nothing is written here" },
    { "entry_is_text.yaml",
      ":2:11: strands[0]: must be a mapping ({} takes the defaults), not 'hair'" },
    { "escape_in_key.yaml",
      ":2:1: unknown key 'st?[31m?rands', known are wisp, step_seconds, steps, substeps, iterations, workers, strands, commands, output" },
    { "escape_in_value.yaml",
      ":6:21: strands[0].frozen_hair.clump.gap: must be one of prose, printed, closing, wet, not 'pr?ose', did you mean 'prose'?" },
    { "exponent_for_whole.yaml",
      ":2:8: steps: must be a whole number, not '1e3'" },
    { "file_and_make.yaml",
      ":3:5: strands[0]: has both 'file' and 'make'; strands are read or made, not both" },
    { "file_empty.yaml",
      ":3:25: strands[0].file: must be text, but nothing is written here" },
    { "file_nothing.yaml",
      ":3:25: strands[0].file: must be text, but nothing is written here" },
    { "fraction_of_step.yaml",
      ":2:8: steps: must be a whole number, not '2.5'" },
    { "hexadecimal.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '0x10'" },
    { "inf.yaml",
      ":5:29: strands[0].climate.temperature: '-.inf' is not a finite number" },
    { "intensity_two.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: 2 is out of range, must be in [0, 1]" },
    { "invalid_utf8.yaml",
      ":2:6: byte 0xe9 is not UTF-8; save the file as UTF-8" },
    { "iterations_huge.yaml",
      ":2:13: iterations: 99999999999999999999 is out of range, must be in [1, 10000]" },
    { "list_as_key.yaml",
      ":2:3: a list or mapping is not usable as a key" },
    { "list_empty.yaml",
      ":6:33: strands[0].frozen_hair.freeze.bend_stiffness: the list is empty; it takes one number a strand" },
    { "list_for_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not a list" },
    { "list_item_range.yaml",
      ":6:37: strands[0].frozen_hair.freeze.bend_stiffness[1]: 0 is out of range, must be in [0.001, 1e+12]" },
    { "list_item_text.yaml",
      ":6:31: strands[0].frozen_hair.align.intensity[1]: must be a number, not text: write 1 without quotes" },
    { "list_too_long.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: the list has 4 numbers, but 3 strands are made" },
    { "list_too_short.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: the list has 2 numbers, but 3 strands are made" },
    { "long_key.yaml",
      ":2:1: unknown key 'radiusradiusradiusradiusradiusradiusradiusra...', known are wisp, step_seconds, steps, substeps, iterations, workers, strands, commands, output" },
    { "long_number.yaml",
      ":2:8: steps: must be a whole number, not '11111111111111111111111111111111111111111111...'" },
    { "merge_key.yaml",
      ":2:1: unknown key '<<', known are wisp, step_seconds, steps, substeps, iterations, workers, strands, commands, output" },
    { "millimetres.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: '10 mm' has a unit; lengths are plain numbers in metres" },
    { "milliseconds.yaml",
      ":2:15: step_seconds: '16ms' has a unit; times are plain numbers in seconds" },
    { "name_empty.yaml",
      ":3:13: strands[0].name: must be text, but nothing is written here" },
    { "name_too_long.yaml",
      ":3:13: strands[0].name: 'hhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhh...' is not a name: 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "name_with_space.yaml",
      ":3:13: strands[0].name: 'long hair' is not a name: 1 to 64 of the characters A-Z a-z 0-9 _ -" },
    { "nan.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: '.nan' is not a finite number" },
    { "negative_seed.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '-1'" },
    { "neighbour_limit.yaml",
      ":6:33: strands[0].frozen_hair.clump.neighbour_limit: 5000 is out of range, must be in [1, 4096]" },
    { "neither_file_nor_make.yaml",
      ":3:5: strands[0]: has neither 'file' nor 'make'; one tells where the strands come from" },
    { "newer_version.yaml",
      ":1:7: wisp: the scene has version 2, this program reads version 1" },
    { "no_name.yaml",
      ":3:5: strands[0]: key 'name' is missing" },
    { "no_version.yaml",
      ":1:1: key 'wisp' is missing" },
    { "nothing.yaml",
      ":2:1: must be a mapping with the key 'wisp', but nothing is written here" },
    { "nothing_for_number.yaml",
      ":6:25: strands[0].frozen_hair.clump.radius: must be a number, but nothing is written here" },
    { "nul_byte.yaml",
      ":2:8: a NUL byte; a scene is text" },
    { "nul_escape.yaml",
      ":3:11: the text holds a NUL character" },
    { "octal.yaml",
      ":6:13: strands[0].frozen_hair.seed: '010' begins with a zero, which means octal in YAML 1.1; write decimal digits" },
    { "one_vertex.yaml",
      ":3:37: strands[0].make.vertices: 1 is out of range, must be in [2, 134217728]" },
    { "only_comments.yaml",
      ": the scene is empty; it needs at least the line 'wisp: 1'" },
    { "output_extension.yaml",
      ":6:28: output[0].file: 'out.abc' must end in .hair, .usda or .obj, which tells the format" },
    { "output_no_extension.yaml",
      ":6:28: output[0].file: 'v1.0/hair' must end in .hair, .usda or .obj, which tells the format" },
    { "output_only_extension.yaml",
      ":6:28: output[0].file: '.hair' must end in .hair, .usda or .obj, which tells the format" },
    { "output_same_file.yaml",
      ":7:5: output: the file 'out.obj' is written in line 6 already" },
    { "output_unknown_strands.yaml",
      ":6:16: output[0].strands: there are no strands 'beard'" },
    { "output_without_file.json",
      ":4:15: output[0]: key 'file' is missing" },
    { "overflow.yaml",
      ":6:23: strands[0].frozen_hair.align.reach: 1e999 is out of range, must be in [0, 10000000]" },
    { "overlong_utf8.yaml",
      ":1:11: byte 0xc0 is not UTF-8; save the file as UTF-8" },
    { "percent.yaml",
      ":6:27: strands[0].frozen_hair.align.intensity: '80%' has a unit; this is a plain number without one" },
    { "plain_nan.yaml",
      ":6:28: strands[0].frozen_hair.align.cursor[1]: 'NaN' is not a finite number" },
    { "quoted_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not text: write 0.01 without quotes" },
    { "quoted_true.yaml",
      ":6:23: strands[0].frozen_hair.clump.guard: must be true or false, not the text 'true'" },
    { "radius_underflow.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: 1e-60 is out of range, must be in [1e-06, 1000000]" },
    { "radius_zero.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: 0 is out of range, must be in [1e-06, 1000000]" },
    { "same_name.yaml",
      ":6:5: strands[2]: the name 'hair' is taken by the strands in line 3" },
    { "second_document.yaml",
      ":2:1: a second document; a scene file holds one" },
    { "seed_too_large.yaml",
      ":6:13: strands[0].frozen_hair.seed: must be a whole number in [0, 18446744073709551615], not '18446744073709551616'" },
    { "shape_unknown.yaml",
      ":3:34: strands[0].make.shape: must be one of straight, wavy, curly, not 'curley', did you mean 'curly'?" },
    { "step_negative.yaml",
      ":6:22: strands[0].frozen_hair.clump.step: -1 is out of range, must be in [0, 1000]" },
    { "step_zero.yaml",
      ":2:15: step_seconds: 0 is out of range, must be in [1e-09, 1000000]" },
    { "steps_negative.yaml",
      ":2:8: steps: -1 is out of range, must be in [0, 1000000]" },
    { "steps_too_many.yaml",
      ":2:8: steps: 1000001 is out of range, must be in [0, 1000000]" },
    { "stiffness_negative.yaml",
      ":6:36: strands[0].frozen_hair.freeze.stretch_stiffness: -7 is out of range, must be in [0.001, 1e+12]" },
    { "strands_mapping.yaml",
      ":2:10: strands: must be a list of strands, not a mapping" },
    { "strands_nothing.yaml",
      ":2:9: strands: must be a list of strands, but nothing is written here" },
    { "substeps_zero.yaml",
      ":2:11: substeps: 0 is out of range, must be in [1, 10000]" },
    { "surrogate.yaml",
      ":2:3: byte 0xed is not UTF-8; save the file as UTF-8" },
    { "tab_after_spaces.yaml",
      ":4:3: a tab where YAML wants spaces; indent with spaces" },
    { "tab_indent.yaml",
      ":3:1: a tab where YAML wants spaces; indent with spaces" },
    { "tag.yaml",
      ":1:7: a YAML tag; a scene has no use for them" },
    { "tag_bang.yaml",
      ":2:8: a YAML tag; a scene has no use for them" },
    { "tag_list.yaml",
      ":2:10: a YAML tag; a scene has no use for them" },
    { "too_deep.yaml",
      ":2:41: lists and mappings are nested more than 32 deep" },
    { "too_many_made.yaml",
      ":3:25: strands[0].make: 1000000 strands of 1000 vertices are more than 134217728 vertices" },
    { "top_is_list.yaml",
      ":1:1: must be a mapping with the key 'wisp', not a list" },
    { "top_is_text.yaml",
      ":1:1: must be a mapping with the key 'wisp', not 'wisp'" },
    { "trailing_text.json",
      ":1:15: not YAML: did not find expected <document start>" },
    { "truncated.json",
      ":1:40: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "unclosed_brace.yaml",
      ":2:35: not YAML: while parsing a flow mapping, did not find expected ',' or '}'" },
    { "unclosed_quote.yaml",
      ":4:1: not YAML: while scanning a quoted scalar, found unexpected end of stream" },
    { "underscore.yaml",
      ":2:8: steps: must be a whole number, not '1_000'" },
    { "unknown_key.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'raduis', did you mean 'radius'?" },
    { "unknown_key_far.yaml",
      ":6:16: strands[0].frozen_hair.clump: unknown key 'mass', known are radius, iterations, step, gap, gap_reference, guard, distance_min, lambda_min, neighbour_limit" },
    { "unknown_top_key.yaml",
      ":2:1: unknown key 'strand', did you mean 'strands'?" },
    { "utf16.yaml",
      ":1:1: byte 0xff is not UTF-8; save the file as UTF-8" },
    { "version_half.yaml",
      ":1:7: wisp: must be a whole number, not '1.5'" },
    { "version_text.yaml",
      ":1:7: wisp: must be a whole number, not text: write 1 without quotes" },
    { "want_text.yaml",
      ":5:11: strands[0].want: must be a list of points, width and colour, not 'points'" },
    { "want_twice.yaml",
      ":5:20: strands[0].want[1]: 'points' is listed twice" },
    { "want_unknown.yaml",
      ":5:12: strands[0].want[0]: must be one of points, width, colour, not 'point', did you mean 'points'?" },
    { "want_without_look.yaml",
      ":5:20: strands[0].want[1]: 'width' comes from a look, but these strands have no key 'look'" },
    { "wetness_percent.yaml",
      ":5:25: strands[0].climate.wetness: 70 is out of range, must be in [0, 1]" },
    { "word_for_number.yaml",
      ":6:24: strands[0].frozen_hair.clump.radius: must be a number, not 'wide'" },
    { "workers_many.yaml",
      ":2:10: workers: 65 is out of range, must be in [0, 64]" },
    { "yes_for_true.yaml",
      ":6:23: strands[0].frozen_hair.clump.guard: must be true or false, not 'yes'" },
};
// clang-format on

static const bad_scene* find( const char* file )
{
    for ( int i = 0; i < WISP_COUNT( BAD_SCENES ); ++i )
    {
        if ( strcmp( BAD_SCENES[i].file, file ) == 0 )
        {
            return &BAD_SCENES[i];
        }
    }
    return NULL;
}

static void path_in_folder( char* path, size_t room, const char* file )
{
    int length = snprintf( path, room, "%s/%s", FOLDER, file );
    assert_true( length > 0 && (size_t)length < room );
}

static void every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong( void** state )
{
    (void)state;
    for ( int i = 0; i < WISP_COUNT( BAD_SCENES ); ++i )
    {
        const bad_scene* bad = &BAD_SCENES[i];
        char path[1024];
        path_in_folder( path, sizeof path, bad->file );
        wisp_scene scene;
        wisp_error error = { .status = WISP_OK };
        wisp_status status = wisp_scene_read( path, &scene, &error );

        if ( status != WISP_BAD_INPUT || error.status != WISP_BAD_INPUT )
        {
            wisp_scene_release( &scene );
            fail_msg( "%s: status is \"%s\": %s", bad->file, wisp_status_name( status ), error.sentence );
        }
        // The folder before the name differs from machine to machine.
        const char* name = strstr( error.sentence, bad->file );
        assert_non_null( name );
        assert_string_equal( name + strlen( bad->file ), bad->sentence );
        assert_null( scene.strands );
        assert_null( scene.blocks );
    }
}

static void every_file_of_the_folder_has_its_sentence( void** state )
{
    (void)state;
    DIR* walk = opendir( FOLDER );
    assert_non_null( walk );
    int files = 0;
    for ( struct dirent* entry = readdir( walk ); entry; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] == '.' )
        {
            continue;
        }
        ++files;
        if ( !find( entry->d_name ) )
        {
            print_error( "%s has no sentence in the table\n", entry->d_name );
        }
        assert_non_null( find( entry->d_name ) );
    }
    closedir( walk );
    assert_int_equal( files, WISP_COUNT( BAD_SCENES ) );
}

static void a_refusal_without_an_error_to_fill_still_has_its_status( void** state )
{
    (void)state;
    char path[1024];
    path_in_folder( path, sizeof path, BAD_SCENES[0].file );
    wisp_scene scene;
    assert_int_equal( wisp_scene_read( path, &scene, NULL ), WISP_BAD_INPUT );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_bad_file_is_refused_with_its_place_its_key_and_what_is_wrong ),
        cmocka_unit_test( every_file_of_the_folder_has_its_sentence ),
        cmocka_unit_test( a_refusal_without_an_error_to_fill_still_has_its_status ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
