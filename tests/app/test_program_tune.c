// `wisp tune`: the reported result holds in another run, and the written scene has the configuration.
#include "program_fixture.h"

#include "scene.h"

#include <sys/stat.h>

static const char cloth_scene[] = "# A small cloth.\n"
                                  "wisp: 1\n"
                                  "dt: 0.0166667\n"
                                  "steps: 20\n"
                                  "substeps: 3 # as it was\n"
                                  "surfaces:\n"
                                  "  - name: cloth\n"
                                  "    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"
                                  "    pins: [0, 8]\n"
                                  "    # soft\n"
                                  "    cloth: { bending: none }\n";

static const char still_scene[] = "wisp: 1\n"
                                  "strands:\n"
                                  "  - name: hair\n"
                                  "    generate: { shape: wavy, dimension: 2, strands: 4, vertices: 9 }\n"
                                  "    frozen_hair: { freeze: {} }\n"
                                  "    compute: [points]\n";

// Its first run fails, because nothing is at the position of its pins: another message means that it did not run.
static const char unmade_scene[] = "wisp: 1\n"
                                   "surfaces:\n"
                                   "  - name: cloth\n"
                                   "    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"
                                   "    pin_box: { min: [7, 7, 7], max: [8, 8, 8] }\n"
                                   "    cloth: {}\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "cloth.yaml", cloth_scene },
                                       { "still.yaml", still_scene },
                                       { "unmade.yaml", unmade_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

/// The number after some words of the text; NaN if they are missing.
static double number_behind( const char* text, const char* words )
{
    const char* at = strstr( text, words );
    return at ? strtod( at + strlen( words ), NULL ) : NAN;
}

// The configuration that the report names as chosen, up to the end of its line.
static const char* chosen_line( void )
{
    static char line[400];
    const char* at = strstr( result.out, "\nchosen " );
    assert_non_null( at );
    snprintf( line, sizeof line, "%.*s", (int)strcspn( at + 1, "\n" ), at + 1 );
    return line;
}

// ---- results ----

TEST( an_error_is_met_and_the_scene_that_is_written_has_the_choice )
{
    run_ok( "tune cloth.yaml --error 0.02 --workers 1 --output tuned.yaml" );
    assert_string_equal( result.err, "" );
    assert_memory_equal( result.out, "target     met: error at most 0.02 m; compared until 0.333 s, the end\n", 70 );
    assert_true( number_behind( result.out, "ms per step, error " ) <= 0.02 );
    assert_non_null( strstr( result.out, "chosen" ) );
    assert_non_null( strstr( result.out, "Pareto" ) );

    wisp_scene scene;
    assert_int_equal( wisp_scene_read( "tuned.yaml", &scene, NULL ), WISP_OK );
    const char* met = chosen_line();
    assert_int_equal( scene.substeps, (int)number_behind( met, "substeps: " ) );
    assert_int_equal( scene.iterations, (int)number_behind( met, ", iterations: " ) );
    assert_int_equal( scene.surfaces[0].cloth.tethers, strstr( met, "cloth.tethers: true" ) != NULL );
    assert_int_equal( scene.surfaces[0].cloth.coarse_substeps,
                      (int)number_behind( met, ", cloth.coarse_substeps: " ) );
    wisp_scene_release( &scene );

    char text[2000];
    read_text( "tuned.yaml", text, sizeof text );
    assert_memory_equal( text, "# A small cloth.\nwisp: 1\n", 25 );
    assert_non_null( strstr( text, " # as it was\n" ) );
    assert_non_null( strstr( text, "    # soft\n    cloth: {" ) );
    run_ok( "run tuned.yaml" );
}

TEST( coarse_substeps_of_a_scene_are_tuned_and_their_choice_is_written )
{
    static const char scene[] = "wisp: 1\nsteps: 8\nsubsteps: 1\niterations: 1\nsurfaces:\n  - name: cloth\n"
                                "    generate: { shape: plane, columns: 33, rows: 33, spacing: 0.02 }\n"
                                "    pins: [0, 32]\n    cloth:\n      bending: none\n"
                                "      coarse_substeps: 3 # of mine\n";
    write_text( "coarse.yaml", scene );
    run_ok( "tune coarse.yaml --error 10 --workers 1 -o tuned_coarse.yaml" );
    wisp_scene tuned;
    assert_int_equal( wisp_scene_read( "tuned_coarse.yaml", &tuned, NULL ), WISP_OK );
    assert_int_equal( tuned.surfaces[0].cloth.coarse_substeps,
                      (int)number_behind( chosen_line(), ", cloth.coarse_substeps: " ) );
    wisp_scene_release( &tuned );
    char text[2000];
    read_text( "tuned_coarse.yaml", text, sizeof text );
    assert_non_null( strstr( text, " # of mine\n" ) );
}

TEST( passes_of_strands_are_tuned_and_their_choice_is_written )
{
    static const char scene[] = "wisp: 1\nsteps: 8\nstrands:\n  - name: hair\n"
                                "    generate: { dimension: 2, strands: 16, vertices: 9, spacing: 0.03 }\n"
                                "    dynamics: { stretch_passes: 3, rest: straight }\n";
    write_text( "strands.yaml", scene );
    run_ok( "tune strands.yaml --error 0.01 --workers 1 -o passes.yaml" );
    SCOPED( wisp_scene_release ) wisp_scene tuned;
    assert_int_equal( wisp_scene_read( "passes.yaml", &tuned, NULL ), WISP_OK );
    assert_int_equal( tuned.strands[0].dynamics.stretch_passes,
                      (int)number_behind( chosen_line(), ", dynamics.stretch_passes: " ) );
}

TEST( a_budget_is_met_or_it_is_told_that_it_is_not )
{
    run_ok( "tune cloth.yaml --budget 1000 --workers 1 --seconds 0.1" );
    assert_non_null( strstr( result.out, "target     met: at most 1000 ms per step" ) );
    assert_non_null( strstr( result.out, "81 vertices and 6 times up to 0.1 s" ) );
    run( "tune cloth.yaml --budget 1e-9 --workers 1 --seconds 0.1 -o unmet.yaml" );
    assert_int_equal( result.status, 1 );
    assert_non_null( strstr( result.out, "target     not met: at most 1e-09 ms per step; compared until 0.1 s, the "
                                         "end\nnearest    substeps: 1, iterations: 1" ) );
    assert_non_null( strstr( result.out, "not written: unmet.yaml" ) );
    assert_int_equal( access( "unmet.yaml", F_OK ), -1 );
}

TEST( an_error_out_of_reach_ends_with_1_and_the_best )
{
    run( "tune cloth.yaml --error 1e-12 --workers 1 --seconds 0.1" );
    assert_int_equal( result.status, 1 );
    assert_string_equal( result.err, "" );
    assert_non_null( strstr(
        result.out, "target     not met: error at most 1e-12 m; compared until 0.1 s, the end\nnearest    " ) );
}

TEST( a_report_in_json_has_a_row_for_every_setting )
{
    run_ok( "tune cloth.yaml --error 0.02 --workers 1 --seconds 0.1 --format json" );
    assert_int_equal( result.out[0], '{' );
    assert_non_null( strstr( result.out, "\"chosen\"" ) );
    assert_non_null( strstr( result.out, "\"rms_m\"" ) );
    assert_non_null( strstr( result.out, "\"substeps\"" ) );
}

TEST( a_limit_leaves_one_run_and_says_that_there_may_be_better )
{
    run( "tune cloth.yaml --error 0.02 --workers 1 --limit 1e-9" );
    assert_non_null( strstr( result.out, "1 run of 1 configuration in" ) );
    assert_non_null( strstr( result.out, "better ones may exist" ) );
}

TEST( a_repair_is_told_once_and_not_with_every_run )
{
    write_text( "doubled.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\nf 2 3 4\n" );
    write_text( "doubled.yaml", "wisp: 1\nsteps: 4\nsurfaces:\n  - name: a\n    file: doubled.obj\n"
                                "    repair: [duplicates]\n    pins: [0]\n    cloth: { bending: none }\n" );
    run( "tune doubled.yaml --error 1e-9 --workers 1" );
    assert_int_equal( result.status, 1 );
    assert_int_equal( line_count( result.err ), 1 );
    assert_non_null( strstr( result.err, "surface 'a'" ) );
}

// ---- rejected input ----

TEST( scenes_that_cannot_be_tuned_are_refused )
{
    assert_refused( "tune still.yaml --error 1", "nothing in the scene moves" );
    write_text( "bad.yaml", "wisp: 1\nsubsteps: none\n" );
    assert_refused( "tune bad.yaml --error 1", "bad.yaml:2:11" );
}

TEST( a_place_where_the_scene_would_not_find_its_files_is_refused )
{
    write_text( "mesh.yaml", "wisp: 1\nsurfaces:\n  - { name: a, file: a.obj, cloth: {} }\n" );
    assert_refused( "tune mesh.yaml --error 1 -o elsewhere/tuned.yaml",
                    "elsewhere/tuned.yaml must be in the same folder" );
    assert_refused( "tune cloth.yaml --error 10 --seconds 0.02 --workers 1 -o elsewhere/tuned.yaml", "elsewhere" );
}

TEST( a_place_where_nothing_can_be_written_is_refused_before_any_run )
{
    assert_refused( "tune unmade.yaml --error 1", "no vertex starts in pin_box" );
    assert_refused( "tune unmade.yaml --error 1 -o no_such/tuned.yaml", "no_such/tuned.yaml: cannot be written" );
    assert_int_equal( access( "no_such", F_OK ), -1 );
    assert_int_equal( mkdir( "folder", 0700 ), 0 );
    assert_refused( "tune unmade.yaml --error 1 -o folder", "folder: cannot be written" );
    assert_refused( "tune unmade.yaml --error 1 -o cloth.yaml/tuned.yaml",
                    "cloth.yaml/tuned.yaml: cannot be written" );
}

TEST( a_file_that_may_only_be_read_is_refused_before_any_run )
{
    write_text( "kept.yaml", "kept\n" );
    assert_int_equal( chmod( "kept.yaml", 0400 ), 0 );
    if ( access( "kept.yaml", W_OK ) == 0 )
    {
        SKIP( "root may write everywhere" );
    }
    assert_refused( "tune unmade.yaml --error 1 -o kept.yaml", "kept.yaml: cannot be written" );
}

TEST( trying_whether_a_file_can_be_written_leaves_it_as_it_was )
{
    write_text( "before.yaml", "before\n" );
    assert_refused( "tune unmade.yaml --error 1 -o before.yaml", "no vertex starts in pin_box" );
    char text[100];
    read_text( "before.yaml", text, sizeof text );
    assert_string_equal( text, "before\n" );
    assert_refused( "tune unmade.yaml --error 1 -o new.yaml", "no vertex starts in pin_box" );
    assert_int_equal( access( "new.yaml", F_OK ), -1 );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
