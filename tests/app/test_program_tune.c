// `wisp tune` as a user meets it: what is found is true when it is run again, and the scene that is written has it.
#include "program_fixture.h"

#include "scene.h"

#include <math.h>

static const char cloth_scene[] = "# A small cloth.\n"
                                  "wisp: 1\n"
                                  "step_seconds: 0.0166667\n"
                                  "steps: 20\n"
                                  "substeps: 3 # as it was\n"
                                  "surfaces:\n"
                                  "  - name: cloth\n"
                                  "    make: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"
                                  "    pins: [0, 8]\n"
                                  "    # soft\n"
                                  "    cloth: { bending: none }\n";

static const char still_scene[] = "wisp: 1\n"
                                  "strands:\n"
                                  "  - name: hair\n"
                                  "    make: { shape: wavy, dimension: 2, strands: 4, vertices: 9 }\n"
                                  "    frozen_hair: { freeze: {} }\n"
                                  "    want: [points]\n";

static int enter_folder( void** state )
{
    if ( enter_new_folder( state ) != 0 )
    {
        return -1;
    }
    write_file( "cloth.yaml", cloth_scene );
    write_file( "still.yaml", still_scene );
    return 0;
}

/// A number of the text behind some words; NaN if they are not there.
static double number_behind( const char* text, const char* words )
{
    const char* at = strstr( text, words );
    return at ? strtod( at + strlen( words ), NULL ) : NAN;
}

static void read_whole( const char* path, char* out, size_t size )
{
    FILE* file = fopen( path, "r" );
    assert_non_null( file );
    out[fread( out, 1, size - 1, file )] = '\0';
    fclose( file );
}

// ---- what is found ----

static void an_error_is_met_and_the_scene_that_is_written_has_the_choice( void** state )
{
    (void)state;
    run( "tune cloth.yaml --error 0.02 --workers 1 --output tuned.yaml" );
    assert_int_equal( result.status, 0 );
    assert_string_equal( result.err, "" );
    assert_non_null( strstr( result.out, "Met: an error of 0.02 m, by substeps: " ) );
    assert_true( number_behind( result.out, "ms a step and an error of " ) <= 0.02 );
    assert_non_null( strstr( result.out, "chosen" ) );
    assert_non_null( strstr( result.out, "front" ) );

    wisp_scene scene;
    assert_int_equal( wisp_scene_read( "tuned.yaml", &scene, NULL ), WISP_OK );
    assert_int_equal( scene.substeps, (int)number_behind( result.out, "by substeps: " ) );
    const char* met = strstr( result.out, "Met: " );
    assert_int_equal( scene.iterations, (int)number_behind( met, ", iterations: " ) );
    assert_int_equal( scene.surfaces[0].cloth.tethers, strstr( met, "cloth.tethers: true" ) != NULL );
    assert_int_equal( scene.surfaces[0].cloth.level_passes, (int)number_behind( met, ", cloth.level_passes: " ) );
    wisp_scene_release( &scene );

    char text[2000];
    read_whole( "tuned.yaml", text, sizeof text );
    assert_memory_equal( text, "# A small cloth.\nwisp: 1\n", 25 );
    assert_non_null( strstr( text, " # as it was\n" ) );
    assert_non_null( strstr( text, "    # soft\n    cloth: {" ) );
    run( "run tuned.yaml" );
    assert_int_equal( result.status, 0 );
}

static void a_budget_is_met_or_it_is_told_that_it_is_not( void** state )
{
    (void)state;
    run( "tune cloth.yaml --budget 1000 --workers 1 --seconds 0.1" );
    assert_int_equal( result.status, 0 );
    assert_non_null( strstr( result.out, "Met: 1000 ms a step" ) );
    assert_non_null( strstr( result.out, "81 points and 6 steps" ) );
    run( "tune cloth.yaml --budget 1e-9 --workers 1 --seconds 0.1 -o unmet.yaml" );
    assert_int_equal( result.status, 1 );
    assert_non_null( strstr( result.out, "Not met: 1e-09 ms a step; nearest comes substeps: 1, iterations: 1" ) );
    assert_non_null( strstr( result.out, "Nothing was written to unmet.yaml" ) );
    assert_int_equal( access( "unmet.yaml", F_OK ), -1 );
}

static void an_error_out_of_reach_ends_with_1_and_the_best( void** state )
{
    (void)state;
    run( "tune cloth.yaml --error 1e-12 --workers 1 --seconds 0.1" );
    assert_int_equal( result.status, 1 );
    assert_string_equal( result.err, "" );
    assert_non_null( strstr( result.out, "Not met: an error of 1e-12 m; nearest comes substeps: 16" ) );
}

static void a_report_in_json_has_a_row_for_every_setting( void** state )
{
    (void)state;
    run( "tune cloth.yaml --error 0.02 --workers 1 --seconds 0.1 --format json" );
    assert_int_equal( result.status, 0 );
    assert_int_equal( result.out[0], '{' );
    assert_non_null( strstr( result.out, "\"chosen\"" ) );
    assert_non_null( strstr( result.out, "\"rms_m\"" ) );
    assert_non_null( strstr( result.out, "\"substeps\"" ) );
}

static void a_limit_leaves_one_run_and_says_that_there_may_be_better( void** state )
{
    (void)state;
    run( "tune cloth.yaml --error 0.02 --workers 1 --limit 1e-9" );
    assert_non_null( strstr( result.out, "1 runs of 1 settings" ) );
    assert_non_null( strstr( result.out, "there may be better ones" ) );
}

static void a_repair_is_told_once_and_not_with_every_run( void** state )
{
    (void)state;
    write_file( "doubled.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nf 1 3 2\nf 2 3 4\nf 2 3 4\n" );
    write_file( "doubled.yaml", "wisp: 1\nsteps: 4\nsurfaces:\n  - name: a\n    file: doubled.obj\n"
                                "    repair: [duplicates]\n    pins: [0]\n    cloth: { bending: none }\n" );
    run( "tune doubled.yaml --error 1e-9 --workers 1" );
    assert_int_equal( result.status, 1 );
    assert_int_equal( line_count( result.err ), 1 );
    assert_non_null( strstr( result.err, "surface 'a'" ) );
}

// ---- what is refused ----

static void wrong_command_lines_are_told( void** state )
{
    (void)state;
    assert_usage( "tune", "which scene?" );
    assert_usage( "tune cloth.yaml", "one of them" );
    assert_usage( "tune cloth.yaml --error 1 --budget 1", "one of them" );
    assert_usage( "tune cloth.yaml --error 0.5mm", "'0.5mm' is not a number above 0" );
    assert_usage( "tune cloth.yaml --error -1", "is not a number above 0" );
    assert_usage( "tune cloth.yaml --budget nan", "is not a number above 0" );
    assert_usage( "tune cloth.yaml --error 1 --format tabel", "--format" );
    assert_usage( "tune cloth.yaml --error 1 --workers 0", "--workers" );
    assert_usage( "tune cloth.yaml --error 1 still.yaml", "one scene at a time" );
}

static void scenes_that_cannot_be_tuned_are_refused( void** state )
{
    (void)state;
    assert_refused( "tune no_such.yaml --error 1", "no_such.yaml" );
    assert_refused( "tune still.yaml --error 1", "nothing in the scene moves in time" );
    write_file( "bad.yaml", "wisp: 1\nsubsteps: none\n" );
    assert_refused( "tune bad.yaml --error 1", "bad.yaml:2:11" );
}

static void a_place_where_the_scene_would_not_find_its_files_is_refused( void** state )
{
    (void)state;
    write_file( "mesh.yaml", "wisp: 1\nsurfaces:\n  - { name: a, file: a.obj, cloth: {} }\n" );
    assert_refused( "tune mesh.yaml --error 1 -o elsewhere/tuned.yaml", "write elsewhere/tuned.yaml beside it" );
    assert_refused( "tune cloth.yaml --error 10 --seconds 0.02 --workers 1 -o elsewhere/tuned.yaml", "elsewhere" );
}

int main( int argc, char** argv )
{
    if ( argc < 2 || !realpath( argv[1], program ) )
    {
        fprintf( stderr, "usage: test_program_tune PROGRAM\n" );
        return 2;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( an_error_is_met_and_the_scene_that_is_written_has_the_choice ),
        cmocka_unit_test( a_budget_is_met_or_it_is_told_that_it_is_not ),
        cmocka_unit_test( an_error_out_of_reach_ends_with_1_and_the_best ),
        cmocka_unit_test( a_report_in_json_has_a_row_for_every_setting ),
        cmocka_unit_test( a_limit_leaves_one_run_and_says_that_there_may_be_better ),
        cmocka_unit_test( a_repair_is_told_once_and_not_with_every_run ),
        cmocka_unit_test( wrong_command_lines_are_told ),
        cmocka_unit_test( scenes_that_cannot_be_tuned_are_refused ),
        cmocka_unit_test( a_place_where_the_scene_would_not_find_its_files_is_refused ),
    };
    return cmocka_run_group_tests( tests, enter_folder, leave_folder );
}
