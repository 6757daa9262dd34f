// The built program, whose path is the first argument, with valid and invalid input: exit statuses, one message per
// error, help of every command, and only plain bytes without a terminal.
#include "program_fixture.h"

#include <jansson.h>
#include <sys/stat.h>

// ---- scenes ----

static const char good_scene[] =
    "wisp: 1\n"
    "steps: 3\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { shape: wavy, dimension: 2, strands: 40, vertices: 20, spacing: 0.001 }\n"
    "    frozen_hair:\n"
    "      freeze: {}\n"
    "      align: { cursor: [0, -0.3, 0] }\n"
    "      clump: { radius: 0.006 }\n"
    "    appearance: {}\n"
    "    compute: [points, width, colour]\n"
    "hair_events:\n"
    "  - { step: 1, strands: hair, cursor: [0.1, -0.2, 0] }\n"
    "output:\n"
    "  - { strands: hair, file: written.hair }\n"
    "  - { strands: hair, file: written.obj }\n";

// Line by line what has no effect, and beside it what has one.
static const char vain_scene[] = "wisp: 1\n"
                                 "steps: 1\n"
                                 "strands:\n"
                                 "  - name: fine\n"
                                 "    generate: { strands: 2, vertices: 20, length: 0.0001 }\n"
                                 "    dynamics: { wind: [3, 0, 0] }\n"
                                 "    collision: false\n"
                                 "  - name: still\n"
                                 "    generate: { strands: 2 }\n"
                                 "    frozen_hair: {}\n"
                                 "  - name: thick\n"
                                 "    generate: { strands: 2 }\n"
                                 "    dynamics: {}\n"
                                 "    grid: { friction: 0 }\n"
                                 "    collision: false\n"
                                 "surfaces:\n"
                                 "  - name: left\n"
                                 "    generate: { shape: plane, columns: 3, rows: 3 }\n"
                                 "    pins: [0, 1]\n"
                                 "    cloth: { wind: [3, 0, 0] }\n"
                                 "    collision: { mask: [2] }\n"
                                 "    contact: { self: false, layers: [3] }\n"
                                 "  - name: right\n"
                                 "    generate: { shape: plane, columns: 3, rows: 3 }\n"
                                 "    pins: [0, 2]\n"
                                 "    cloth: {}\n"
                                 "    collision: false\n"
                                 "  - { name: open, file: split.obj, cloth: {}, collision: false }\n"
                                 "colliders:\n"
                                 "  - { name: floor, shape: plane }\n"
                                 "  - { name: picture, shape: plane, layers: [] }\n"
                                 "seams:\n"
                                 "  - { name: sewn, surfaces: [left, right], pairs: [[0, 0], [1, 1], [2, 2]] }\n";

// Two triangles of a square, with vertices of their own.
static const char split_mesh[] = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3\nf 4 5 6\n";
static const char joined_scene[] =
    "wisp: 1\nsurfaces:\n  - { name: joined, file: split.obj, repair: [weld], cloth: {} }\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "good.yaml", good_scene },
                                       { "vain.yaml", vain_scene },
                                       { "split.obj", split_mesh },
                                       { "joined.yaml", joined_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

// ---- what has no effect ----

static void assert_told( const char* text, const char* where, const char* line )
{
    if ( strstr( text, line ) == NULL )
    {
        fail_msg( "%s does not tell '%s', but:\n%s", where, line, text );
    }
}

TEST( what_has_no_effect_is_told_in_a_line_by_the_log_and_by_run_plan_and_info )
{
    static const char* const LINES[] = {
        "vain.yaml:4: 'fine': 'wind' has no effect",
        "vain.yaml:4: 'fine': 38 of the segments are below 10 um",
        "vain.yaml:8: 'still': 'frozen_hair' has no effect",
        "vain.yaml:11: 'thick': 'grid' has no effect",
        "vain.yaml:17: 'left': 'wind' has no effect",
        "vain.yaml:17: 'left': 'collision' has no effect",
        "vain.yaml:17: 'left': 'contact' has no effect",
        "vain.yaml:28: 'open': 2 vertices are where others are",
        "vain.yaml:30: 'floor': nothing collides with this collider",
        "seams: 1 of 3 pairs of entity 10 join two pinned vertices",
    };
    for ( int i = 0; i < WISP_COUNT( LINES ); ++i )
    {
        run( "run vain.yaml" );
        assert_told( result.out, "run", LINES[i] );
        assert_told( result.err, "the log", LINES[i] );
        run( "plan vain.yaml --steps 0" );
        assert_told( result.out, "plan", LINES[i] );
        run( "info vain.yaml" );
        assert_told( result.out, "info", LINES[i] );
        assert_string_equal( result.err, "" );
        assert_null( strstr( result.out, "note: vain.yaml:21" ) ); // 'right'
        assert_null( strstr( result.out, "'picture'" ) );
    }
    for ( int i = 0; i < 2; ++i )
    {
        run( i == 0 ? "info good.yaml" : "info joined.yaml" );
        assert_null( strstr( result.out, "note:" ) );
    }
}

// ---- the command line ----

TEST( the_version_is_told )
{
    run_ok( "--version" );
    const char first[] = "wisp " WISP_VERSION_STRING "\nkernels: baseline";
    assert_memory_equal( result.out, first, strlen( first ) );
    assert_string_equal( result.err, "" );
    char numbers[32];
    snprintf( numbers, sizeof( numbers ), "%d.%d.%d", WISP_VERSION_MAJOR, WISP_VERSION_MINOR, WISP_VERSION_PATCH );
    assert_string_equal( numbers, WISP_VERSION_STRING );
}

// No line is wider than a terminal of 100 columns.
static void assert_lines_fit( const char* text )
{
    while ( *text )
    {
        const size_t length = strcspn( text, "\n" );
        if ( length > 100 )
        {
            fail_msg( "%zu columns: %.*s", length, (int)length, text );
        }
        text += length + ( text[length] == '\n' ? 1 : 0 );
    }
}

TEST( help_of_every_command_names_its_usage_and_the_exit_statuses )
{
    static const char* const commands[][2] = {
        { "--help", "Usage: wisp [OPTION...] COMMAND" },
        { "run --help", "Usage: wisp run [OPTION...] SCENE" },
        { "plan --help", "Usage: wisp plan [OPTION...] SCENE" },
        { "bench --help", "Usage: wisp bench [OPTION...] [CASE|SUITE...]" },
        { "accuracy --help", "Usage: wisp accuracy [OPTION...] SCENE" },
        { "info --help", "Usage: wisp info [OPTION...] FILE" },
        { "render --help", "Usage: wisp render [OPTION...] SCENE|RECORDING|MESH|GROOM" },
        { "tune --help", "Usage: wisp tune [OPTION...] SCENE" },
        { "torture --help", "Usage: wisp torture [OPTION...] [SCENE...]" },
    };
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        run_ok( commands[i][0] );
        assert_non_null( strstr( result.out, commands[i][1] ) );
        assert_non_null( strstr( result.out, "Exit status:\n  0   success\n" ) );
        assert_lines_fit( result.out );
        assert_string_equal( result.err, "" );
    }
}

TEST( a_misspelt_word_of_an_option_is_answered_with_the_nearest )
{
    assert_usage( "run good.yaml --isa avx22", "did you mean 'avx2'?" );
    assert_usage( "run good.yaml --isa quantum", "expected one of baseline, avx2, avx512" );
}

// ---- files ----

TEST( a_misspelt_key_is_named_with_its_line_and_the_nearest_key )
{
    write_text( "bad.yaml", "wisp: 1\n"
                            "strands:\n"
                            "  - name: hair\n"
                            "    generate: { shape: wavy, dimension: 2, strnads: 40 }\n" );
    assert_refused( "run bad.yaml", "bad.yaml:4:" );
    assert_non_null( strstr( result.err, "did you mean 'strands'?" ) );
    assert_refused( "plan bad.yaml", "bad.yaml:4:" );
    assert_refused( "info bad.yaml", "bad.yaml:4:" );
    assert_string_equal( result.out, "" );
}

TEST( a_groom_that_a_scene_cannot_read_is_named_with_the_line_of_the_scene )
{
    write_text( "bad.yaml", "wisp: 1\n"
                            "strands:\n"
                            "  - name: hair\n"
                            "    file: absent.hair\n"
                            "    compute: [points]\n" );
    assert_refused( "run bad.yaml", "bad.yaml:3:" );
    assert_non_null( strstr( result.err, "absent.hair" ) );
    assert_refused( "info bad.yaml", "bad.yaml:3:" );
}

TEST( a_list_of_numbers_must_have_one_for_each_strand_of_the_file )
{
    run_ok( "run good.yaml" );
    write_text( "bad.yaml", "wisp: 1\n"
                            "strands:\n"
                            "  - name: hair\n"
                            "    file: written.hair\n"
                            "    frozen_hair:\n"
                            "      align: { intensity: [0.5, 0.6, 0.7] }\n"
                            "    compute: [points]\n" );
    assert_refused( "run bad.yaml", "bad.yaml:3:" );
    assert_non_null( strstr( result.err, "intensity: got 3 numbers, expected one for each of 40 strands" ) );
}

TEST( results_that_cannot_be_written_fail_the_run )
{
    assert_refused( "run good.yaml --output absent/summary.csv", "absent/summary.csv" );
    if ( access( "/dev/full", W_OK ) == 0 )
    {
        assert_refused( "run good.yaml --output /dev/full", "/dev/full" );
    }
}

TEST( what_cannot_be_written_is_told_before_the_first_step )
{
    write_text( "lost.yaml", "wisp: 1\n"
                             "strands:\n"
                             "  - name: hair\n"
                             "    generate: { shape: straight, dimension: 2, strands: 3, vertices: 4 }\n"
                             "    compute: [points]\n"
                             "output:\n"
                             "  - { strands: hair, file: absent/hair.obj }\n" );
    assert_refused( "run lost.yaml --record early.wisp", "lost.yaml:7:5: absent/hair.obj: cannot be written" );
    assert_refused( "run good.yaml --record early.wisp --output absent/summary.csv",
                    "absent/summary.csv: cannot be written" );
    // a recording begins with the start of the scene
    assert_int_not_equal( access( "early.wisp", F_OK ), 0 );
}

// ---- output ----

static json_t* run_for_json( const char* command )
{
    run_ok( command );
    json_t* root = json_loads( result.out, JSON_REJECT_DUPLICATES, NULL );
    assert_non_null( root );
    return root;
}

TEST( a_run_gives_the_same_hash_on_every_worker_count_and_instruction_set )
{
    static const char* const commands[] = {
        "run good.yaml --format json --workers 1",
        "run good.yaml --format json --workers 2",
        "run good.yaml --format json --workers 5",
        "run good.yaml --format json --isa baseline",
    };
    char first[17] = "";
    for ( int i = 0; i < WISP_COUNT( commands ); ++i )
    {
        json_t* root = run_for_json( commands[i] );
        json_t* row = json_array_get( json_object_get( root, "rows" ), 0 );
        const char* hash = json_string_value( json_object_get( row, "hash" ) );
        assert_int_equal( strlen( hash ), 16 );
        if ( i == 0 )
        {
            strcpy( first, hash );
        }
        assert_string_equal( hash, first );
        assert_int_equal( json_integer_value( json_object_get( row, "steps" ) ), 3 );
        assert_int_equal( json_integer_value( json_object_get( json_object_get( row, "size" ), "vertices" ) ), 800 );
        json_decref( root );
    }
}

TEST( a_run_prints_passes_counters_and_hash )
{
    run_ok( "run good.yaml --steps 2 --verbose" );
    assert_string_equal( result.err, "" );
    // the search takes most of the time; passes below 1 % may be summed
    static const char* const expected[] = {
        "\nTime per step by pass", "frozen_hair.clump",   "neighbours",     "\nsteps        2 of 16.67 ms: ",
        " x real time with ",      " bytes per vertex\n", "\nhash         "
    };
    for ( int i = 0; i < WISP_COUNT( expected ); ++i )
    {
        assert_non_null( strstr( result.out, expected[i] ) );
    }
    run( "run good.yaml --steps 2 --format json" );
    static const char* const stages[] = { "\"frozen_hair.freeze\"", "\"frozen_hair.clump\"",
                                          "\"strand_appearance.width\"" };
    for ( int i = 0; i < WISP_COUNT( stages ); ++i )
    {
        assert_non_null( strstr( result.out, stages[i] ) );
    }
}

// A counter that is zero is not printed, and the first line is the result.
TEST( a_run_begins_with_its_result_and_leaves_out_zero_counters )
{
    run_ok( "run good.yaml --steps 2" );
    int lines = 0;
    for ( const char* c = result.out; *c; ++c )
    {
        lines += *c == '\n' ? 1 : 0;
    }
    assert_int_equal( lines, 8 ); // six, and two files that the scene writes
    run_ok( "run good.yaml --steps 2 -v" );
    assert_memory_equal( result.out, "scene ", 6 );
    char* machine = strstr( result.out, "\nmachine: " );
    assert_non_null( machine );
    *machine = '\0'; // names of processors and flags of compilers can be long
    assert_lines_fit( result.out );
    assert_null( strstr( result.out, "halted" ) );
    assert_null( strstr( result.out, "gravity scaled" ) );
    const char* hash = strstr( result.out, "\nhash " );
    assert_true( hash && hash < strstr( result.out, "Time per step" ) );
}

TEST( every_format_can_be_queried_for )
{
    static const char* const starts[][2] = {
        { "run good.yaml --format text", "scene " },      { "run good.yaml --format markdown", "|  |  |" },
        { "run good.yaml --format csv", "case,variant" }, { "run good.yaml --format json", "{" },
        { "run good.yaml --format github", "[" },
    };
    for ( int i = 0; i < WISP_COUNT( starts ); ++i )
    {
        run_ok( starts[i][0] );
        assert_memory_equal( result.out, starts[i][1], strlen( starts[i][1] ) );
    }
}

TEST( the_summary_goes_to_a_file_when_queried )
{
    run_ok( "run good.yaml --format csv --output summary.csv" );
    assert_string_equal( result.out, "" );
    assert_int_equal( access( "summary.csv", R_OK ), 0 );
}

TEST( info_prints_the_keys_of_a_block )
{
    run_ok( "info --keys surfaces.cloth" );
    assert_non_null( strstr( result.out, "### `surfaces[].cloth`" ) );
    assert_non_null( strstr( result.out, "- `internal_damping` (number or [map](#maps), 1/s" ) );
    assert_null( strstr( result.out, "balloon" ) );
    run_ok( "info --keys" );
    assert_non_null( strstr( result.out, "### The scene" ) );
}

TEST( a_run_writes_the_files_of_its_scene_with_width_and_colour )
{
    remove( "written.hair" );
    remove( "written.obj" );
    run_ok( "run good.yaml" );
    assert_int_equal( access( "written.obj", R_OK ), 0 );
    run_ok( "info written.hair" );
    assert_non_null( strstr( result.out, "800" ) );
    // the defaults of the appearance: 80 micrometres at the root, 20 at the tip
    assert_non_null( strstr( result.out, "min 2e-05" ) );
    assert_non_null( strstr( result.out, "max 8e-05" ) );
    assert_non_null( strstr( result.out, "a vertex" ) );
}

TEST( stretched_cloth_is_reported_and_statistics_are_printed )
{
    static const char cloth[] = "surfaces:\n"
                                "  - name: flag\n"
                                "    generate: { shape: plane, columns: 33, rows: 33, spacing: 0.03 }\n"
                                "    pins: [0, 32]\n"
                                "    cloth: { coarse_substeps: 0 }\n";
    char text[600];
    snprintf( text, sizeof( text ), "wisp: 1\nsteps: 60\nsubsteps: 1\n%s", cloth );
    write_text( "soft.yaml", text );
    run( "run soft.yaml -v" );
    assert_int_equal( result.status, 0 );
    assert_non_null( strstr( result.out, "links.xpbd" ) ); // without the key compute a surface is simulated
    assert_non_null( strstr( result.out, "flag is stretched by " ) );
    assert_non_null( strstr( result.out, "tethers: true of its cloth keeps lengths" ) );
    assert_null( strstr( result.out, "Motion at the end" ) );
    snprintf( text, sizeof( text ), "wisp: 1\nsteps: 60\n%s    compute: [ points, motion_stats ]\n", cloth );
    write_text( "good_cloth.yaml", text );
    run( "run good_cloth.yaml -v" );
    assert_int_equal( result.status, 0 );
    assert_null( strstr( result.out, "is stretched" ) );
    assert_non_null( strstr( result.out, "Motion at the end" ) );
    assert_non_null( strstr( result.out, "kinetic J" ) );
}

TEST( penetration_is_printed_and_a_vertex_below_a_surface_is_told )
{
    static const char cloth[] = "wisp: 1\nsteps: 20\n"
                                "surfaces:\n"
                                "  - name: sheet\n"
                                "    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"
                                "    transform: { translate: [0, %s, 0] }\n"
                                "    cloth: {}\n"
                                "    collision: { thickness: 0.01, max_push_out_speed: 0.1 }\n"
                                "    compute: [points, collision_stats]\n"
                                "colliders:\n"
                                "  - { name: ground, shape: plane }\n";
    char text[600];
    snprintf( text, sizeof( text ), cloth, "0.02" );
    write_text( "above.yaml", text );
    run_ok( "run above.yaml -v" );
    assert_non_null( strstr( result.out, "deepest mm" ) );
    assert_null( strstr( result.out, "below the surface" ) );
    snprintf( text, sizeof( text ), cloth, "-0.05" );
    write_text( "below.yaml", text );
    run_ok( "run below.yaml" );
    assert_null( strstr( result.out, "deepest mm" ) );
    assert_non_null( strstr( result.out, "sheet: vertex " ) );
    assert_non_null( strstr( result.out, "mm below the surface of a collider in step 1\n" ) );
    run_ok( "run below.yaml --format json" );
    assert_non_null( strstr( result.out, "\"collision_penetration\": 0.0" ) );
}

// Mean edges of 56.9 mm / 2^1.5, less a quarter of that, the default thickness.
TEST( edges_that_pass_through_those_of_a_box_are_told )
{
    static const char cloth[] = "wisp: 1\nsteps: 1\nsurfaces:\n"
                                "  - { name: sheet, generate: { shape: plane, columns: 5, rows: 5, spacing: 0.05 }, "
                                "cloth: {}, collision: { %s } }\n"
                                "colliders: [{ name: crate, shape: box, half_extent: [1, 1, 1] }]\n";
    static const char* const settings[] = { "", "features: all", "thickness: 0.03" };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        char text[600];
        snprintf( text, sizeof text, cloth, settings[i] );
        write_text( "crate.yaml", text );
        run_ok( "run crate.yaml" );
        assert_true( ( strstr( result.out, "pass up to 5.9 mm through those of the box 'crate'" ) != NULL ) ==
                     ( i == 0 ) );
    }
}

// A sheet of 0.15 kg/m^2 and 0.16 m^2 that lies on the ground weighs 0.2352 N at 9.8 m/s^2.
TEST( the_reaction_of_a_collider_is_the_weight_of_what_lies_on_it )
{
    write_text( "weight.yaml", "wisp: 1\nsteps: 60\ngravity: [0, -9.8, 0]\n"
                               "surfaces:\n"
                               "  - name: sheet\n"
                               "    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"
                               "    transform: { translate: [0, 0.01, 0] }\n"
                               "    cloth: {}\n"
                               "    collision: { thickness: 0.01 }\n"
                               "colliders:\n"
                               "  - { name: ground, shape: plane, compute: [reaction] }\n"
                               "  - { name: aside, shape: sphere, radius: 1, position: [0, 9, 0] }\n" );
    run_ok( "run weight.yaml -v" );
    const char* table = strstr( result.out, "Reaction of colliders" );
    assert_non_null( table );
    const char* row = strstr( table, "\nground" );
    assert_non_null( row );
    double mean[3], largest = 0.0;
    assert_int_equal( sscanf( row + 7, "%lf %lf %lf %lf", &mean[0], &mean[1], &mean[2], &largest ), 4 );
    assert_true( fabs( mean[0] ) < 1e-4 && fabs( mean[2] ) < 1e-4 && fabs( mean[1] + 0.2352 ) < 1e-3 );
    assert_true( largest >= 0.235 && largest < 0.5 );
    assert_null( strstr( result.out, "aside" ) );
    assert_null( strstr( result.out, "Penetration" ) );
}

TEST( a_scene_without_requests_has_a_plan_without_passes )
{
    write_text( "empty.yaml", "wisp: 1\n"
                              "strands:\n"
                              "  - name: hair\n"
                              "    generate: { shape: straight, dimension: 2, strands: 3, vertices: 4 }\n"
                              "    compute: []\n" );
    run_ok( "plan empty.yaml" );
    assert_non_null( strstr( result.out, ": 0 passes" ) );
    run_ok( "run empty.yaml --steps 2 -v" );
    assert_non_null( strstr( result.out, "\ncomputed     nothing, since the scene requests nothing" ) );
    assert_null( strstr( result.out, "Time per step by pass" ) );
    run_ok( "plan good.yaml" );
    assert_non_null( strstr( result.out, "frozen_hair.freeze" ) );
    assert_null( strstr( result.out, ": 0 passes" ) );
}

TEST( info_tells_scenes_results_and_grooms_apart )
{
    run_ok( "info good.yaml" );
    assert_non_null( strstr( result.out, "hair (line 4): 40 strands, 800 vertices" ) );
    run_ok( "run good.yaml --format json --output result.json" );
    run_ok( "info result.json" );
    assert_non_null( strstr( result.out, "good.yaml/run strands=40 vertices=800" ) );
    run_ok( "info written.hair" );
}

TEST( info_refuses_what_it_does_not_know_or_cannot_trust )
{
    write_text( "other.txt", "a letter\n" );
    assert_refused( "info other.txt", "unknown kind of file, expected a groom" );
    write_text( "quads.yaml", "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 3, rows: 3 }, "
                              "implicit: { stiffness_model: link, links: quad } }\n" );
    assert_refused( "info --host quads.yaml", "quads.yaml:3: got 'implicit.links', which --host does not print" );
    write_text( "cut.hair", "HAIR" );
    assert_refused( "info cut.hair", "cut.hair" );
    write_text( "result.json", "{\"wisp_results\":1,\"machine\":{},\"build\":{},\"rows\":[{}]}" );
    assert_refused( "info result.json", "rows[0].case" );
}

TEST( bench_lists_its_cases )
{
    run_ok( "bench --list" );
    assert_memory_equal( result.out, "paper ", 6 );
}

// ---- terminals ----

TEST( progress_is_drawn_on_a_terminal_and_wiped_out_again )
{
    setenv( "TERM", "xterm", 1 );
    run_on_terminal( "run good.yaml" );
    assert_int_equal( result.status, 0 );
    assert_non_null( strstr( result.err, "\033[32m" ) );
    assert_int_equal( result.err[strlen( result.err ) - 1], '\r' );
}

TEST( no_color_takes_the_colour_away_and_leaves_the_bar )
{
    setenv( "TERM", "xterm", 1 );
    setenv( "NO_COLOR", "1", 1 );
    run_on_terminal( "run good.yaml" );
    assert_int_equal( result.status, 0 );
    assert_null( strchr( result.err, '\033' ) );
    assert_non_null( strstr( result.err, "\r[" ) );
    setenv( "NO_COLOR", "", 1 );
    run_on_terminal( "run good.yaml" );
    assert_non_null( strstr( result.err, "\033[32m" ) );
    unsetenv( "NO_COLOR" );
}

TEST( a_dumb_terminal_and_a_file_see_no_bar )
{
    setenv( "TERM", "dumb", 1 );
    run_on_terminal( "run good.yaml" );
    assert_int_equal( result.status, 0 );
    assert_string_equal( result.err, "" );
    setenv( "TERM", "xterm", 1 );
    run( "run good.yaml" );
    assert_string_equal( result.err, "" );
    assert_null( strchr( result.out, '\033' ) );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
