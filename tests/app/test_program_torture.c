// The program as a user meets it: wisp torture.
#include "program_fixture.h"

#include <jansson.h>

static const char good_scene[] = "wisp: 1\n"
                                 "steps: 60\n"
                                 "surfaces:\n"
                                 "  - name: cloth\n"
                                 "    generate: { shape: plane, columns: 5, rows: 5, spacing: 0.05 }\n"
                                 "    pins: [0, 4]\n"
                                 "    cloth: {}\n";

// The reader takes it and the engine does not: the mesh is open.
static const char broken_scene[] = "wisp: 1\n"
                                   "steps: 120\n"
                                   "surfaces:\n"
                                   "  - name: cloth\n"
                                   "    generate: { shape: plane }\n"
                                   "    balloon: {}\n";

static int enter_folder( void** state )
{
    static const text_file files[] = { { "good.yaml", good_scene }, { "broken.yaml", broken_scene } };
    return enter_folder_with( state, files, WISP_COUNT( files ) );
}

TEST( scenes_that_hold_are_status_0 )
{
    run_ok( "torture good.yaml" );
    assert_string_equal( result.err, "" );
    assert_contains( result.out, "scenes  1, " );
    assert_contains( result.out, "broken  0" );
}

TEST( a_scene_that_breaks_is_status_1_and_a_sentence )
{
    run( "torture good.yaml broken.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "broken   1" );
    assert_contains( result.out, "broken.yaml: refused: " );
}

// A sheet that is heavy at the bottom gains less energy than all of it could by being lifted, but it gains some.
TEST( close_limits_break_what_others_let_pass )
{
    write_text( "close.yaml",
                "wisp: 1\nsteps: 300\nsurfaces:\n  - name: cloth\n"
                "    generate: { shape: alternating_plane, columns: 12, rows: 12, spacing: 0.05 }\n"
                "    transform: { rotate: { degrees: [90, 0, 0] } }\n    pins: [0, 11]\n    damping: 4\n"
                "    mass_ratio: 1e3\n    cloth: { bending: isometric }\n" );
    run_ok( "torture close.yaml" );
    run( "torture --close close.yaml" );
    assert_int_equal( result.status, 1 );
    assert_contains( result.out, "close.yaml: energy: energy is " );
}

TEST( a_search_counts_its_scenes )
{
    run( "torture --seed 1 --scenes 3 --keep 0 --out found --format json" );
    assert_true( result.status == 0 || result.status == 1 );
    json_t* root = json_loads( result.out, 0, NULL );
    assert_non_null( root );
    const json_t* size = json_object_get( json_array_get( json_object_get( root, "rows" ), 0 ), "size" );
    assert_int_equal( json_number_value( json_object_get( size, "scenes" ) ), 3 );
    json_decref( root );
}

TEST( a_scene_of_a_seed_is_printed_as_a_scene )
{
    run_ok( "torture --seed 3 --first 5 --print" );
    write_text( "printed.yaml", result.out );
    run_ok( "info printed.yaml" );
}

TEST( wrong_usage_and_bad_files_are_told )
{
    assert_usage( "torture --scenes 0", "--scenes" );
    assert_usage( "torture --mesh none.obj", "expected a file" );
    assert_refused( "torture none.yaml", "none.yaml" );
}

TEST_ARGUMENTS( find_program )
TEST_GROUP( enter_folder, leave_folder )
