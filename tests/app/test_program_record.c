// The built program, whose path is the first argument, records, tracks, verifies and describes files: recordings are
// read back by the library.
#include "flying_sheet.h"

// ---- recordings of a run ----

static void a_run_is_recorded_in_every_format( void** state )
{
    (void)state;
    static const char* const files[][2] = {
        { "a.wisp", "a.wisp" },    { "a.pc2", "a.pc2" },   { "a.pvd", "a/hair_0004.vtp" },
        { "a.obj", "a_0004.obj" }, { "a.usda", "a.usda" },
    };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        char command[100];
        snprintf( command, sizeof( command ), "run hair.yaml --record %s", files[i][0] );
        run_ok( command );
        assert_string_equal( result.err, "" );
        assert_non_null( strstr( result.out, ": 4 frames\n" ) );
        assert_true( exists( files[i][1] ) );
    }
}

static void a_recording_has_the_start_and_every_nth_step_with_hashes( void** state )
{
    (void)state;
    run_ok( "run hair.yaml --steps 7 --every 3 --record nth.wisp" );
    wisp_error error = { 0 };
    wisp_recording* recording;
    assert_int_equal( wisp_recording_open( "nth.wisp", &recording, &error ), WISP_OK );
    wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, 3 );
    assert_true( info.complete );
    assert_string_equal( wisp_recording_body( recording, 0 )->name, "hair" );
    assert_int_equal( wisp_recording_body( recording, 0 )->strand_count, 40 );
    for ( int f = 0; f < 3; ++f )
    {
        double time;
        uint64_t hash;
        assert_int_equal( wisp_recording_frame( recording, f, NULL, &time, &hash, &error ), WISP_OK );
        // a step is a float of 1/60 s
        assert_true( fabs( time - 3.0 * f / 60.0 ) < 1e-7 * ( f + 1 ) );
        assert_true( hash != 0 );
    }
    wisp_recording_close( recording );
}

static void tracks_are_the_points_of_the_recording( void** state )
{
    (void)state;
    run_ok( "run hair.yaml --record t.wisp --track hair:19,0 --track hair:7 --track-file t.csv" );
    assert_non_null( strstr( result.out, "t.csv: 3 vertices over 4 frames" ) );
    FILE* table = fopen( "t.csv", "r" );
    assert_non_null( table );
    char line[400];
    assert_non_null( fgets( line, sizeof( line ), table ) );
    assert_memory_equal( line, "time,hair.19.x,hair.19.y,hair.19.z,hair.0.x", 43 );

    wisp_error error = { 0 };
    wisp_recording* recording;
    wisp_vec3 points[800];
    wisp_vec3* all[] = { points };
    assert_int_equal( wisp_recording_open( "t.wisp", &recording, &error ), WISP_OK );
    assert_int_equal( wisp_recording_body( recording, 0 )->vertex_count, 800 );
    for ( int f = 0; f < 4; ++f )
    {
        float x, y, z;
        assert_int_equal( wisp_recording_frame( recording, f, all, NULL, NULL, &error ), WISP_OK );
        assert_non_null( fgets( line, sizeof( line ), table ) );
        assert_int_equal( sscanf( line, "%*f,%f,%f,%f", &x, &y, &z ), 3 );
        // nine digits restore every float
        assert_true( x == points[19].x && y == points[19].y && z == points[19].z );
    }
    assert_null( fgets( line, sizeof( line ), table ) );
    fclose( table );
    wisp_recording_close( recording );
}

// ---- verification ----

static void a_run_verifies_its_recording_on_other_workers( void** state )
{
    (void)state;
    run_ok( "run hair.yaml --record proof.wisp --workers 1" );
    run_ok( "run hair.yaml --verify proof.wisp --workers 3 --isa baseline" );
    assert_non_null( strstr( result.out, "proof.wisp: 4 frames, every bit equal" ) );
    run_ok( "run hair.yaml --verify proof.wisp --steps 2" );
    assert_non_null( strstr( result.out, "proof.wisp: 3 frames, every bit equal" ) );
    assert_non_null( strstr( result.out, "proof.wisp: 1 frames after the last step" ) );
}

static void a_recording_that_is_cut_or_of_another_length_proves_nothing( void** state )
{
    (void)state;
    run_ok( "run hair.yaml --record proof.wisp" );
    run_ok( "run hair.yaml --record short.wisp --steps 2" );
    assert_refused( "run hair.yaml --verify short.wisp", "short.wisp: got 3 frames, expected 4" );
    run_ok( "run hair.yaml --verify short.wisp --steps 2" );
    assert_refused( "run hair.yaml --verify proof.wisp --steps 4", "proof.wisp: got 4 frames, expected 5" );
    size_t size;
    char* bytes = read_bytes( "proof.wisp", &size );
    FILE* cut = fopen( "cut.wisp", "wb" );
    assert_int_equal( fwrite( bytes, 1, size - 100, cut ), size - 100 );
    fclose( cut );
    free( bytes );
    assert_refused( "run hair.yaml --verify cut.wisp", "cut.wisp: the recording is cut" );
}

/// A copy in which one number of one vertex in one frame is the next float.
static void copy_with_one_bit_off( const char* from, const char* to )
{
    wisp_error error = { 0 };
    wisp_recording* recording;
    assert_int_equal( wisp_recording_open( from, &recording, &error ), WISP_OK );
    wisp_recording_info info = wisp_recording_describe( recording );
    const wisp_recorder_def def = { .bodies = wisp_recording_body( recording, 0 ),
                                    .body_count = info.body_count,
                                    .dt = info.dt };
    wisp_recorder* recorder;
    assert_int_equal( wisp_recorder_open( to, WISP_RECORD_WISP, &def, &recorder, &error ), WISP_OK );
    for ( int f = 0; f < info.frame_count; ++f )
    {
        wisp_vec3 points[800];
        wisp_vec3* all[] = { points };
        double time;
        uint64_t hash;
        assert_int_equal( wisp_recording_frame( recording, f, all, &time, &hash, &error ), WISP_OK );
        if ( f == 2 )
        {
            points[123].y = nextafterf( points[123].y, 9.0f );
        }
        const wisp_vec3* changed[] = { points };
        assert_int_equal( wisp_recorder_frame( recorder, time, hash, changed, &error ), WISP_OK );
    }
    assert_int_equal( wisp_recorder_close( recorder, &error ), WISP_OK );
    wisp_recording_close( recording );
}

static void a_difference_of_one_bit_is_named_by_frame_body_and_vertex( void** state )
{
    (void)state;
    run_ok( "run hair.yaml --record proof.wisp" );
    copy_with_one_bit_off( "proof.wisp", "off.wisp" );
    assert_refused( "run hair.yaml --verify off.wisp", "off.wisp: frame 2 " );
    assert_non_null( strstr( result.err, "hair differs at vertex 123: " ) );
    assert_string_equal( result.out, "" );
}

static void a_recording_of_something_else_is_not_compared( void** state )
{
    (void)state;
    assert_refused( "run hair.yaml --verify fly.wisp", "body 0 differs in its name" );
    assert_refused( "run hair.yaml --verify absent.wisp", "absent.wisp" );
    assert_refused( "run hair.yaml --verify sheet.obj", "sheet.obj" );
}

// ---- info ----

static void info_names_what_is_wrong_with_a_mesh_by_element( void** state )
{
    (void)state;
    run_ok( "info sheet.obj" );
    assert_non_null( strstr( result.out, "triangles            32" ) );
    assert_non_null( strstr( result.out, "open edges" ) );
    write_text( "turned.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 3 4\n" );
    run_ok( "info turned.obj" );
    assert_non_null( strstr( result.out, "winding" ) );
    write_text( "broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n" );
    assert_refused( "info broken.obj", "broken.obj" );
    assert_string_equal( result.out, "" );
}

static void info_tells_whether_a_recording_is_whole( void** state )
{
    (void)state;
    run_ok( "info fly.wisp" );
    assert_non_null( strstr( result.out, "6 frames" ) );
    run_ok( "info fly.pc2" );

    size_t size;
    char* bytes = read_bytes( "fly.wisp", &size );
    assert_true( size > 1000 );
    bytes[size - 200] ^= 1;
    write_bytes( "damaged.wisp", bytes, size );
    free( bytes );
    assert_refused( "info damaged.wisp", "frame 5" );
    assert_refused( "render damaged.wisp -o damaged.png", "frame 5" );
    assert_false( exists( "damaged.png" ) );
}

int main( int argc, char** argv )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_run_is_recorded_in_every_format ),
        cmocka_unit_test( a_recording_has_the_start_and_every_nth_step_with_hashes ),
        cmocka_unit_test( tracks_are_the_points_of_the_recording ),
        cmocka_unit_test( a_run_verifies_its_recording_on_other_workers ),
        cmocka_unit_test( a_recording_that_is_cut_or_of_another_length_proves_nothing ),
        cmocka_unit_test( a_difference_of_one_bit_is_named_by_frame_body_and_vertex ),
        cmocka_unit_test( a_recording_of_something_else_is_not_compared ),
        cmocka_unit_test( info_names_what_is_wrong_with_a_mesh_by_element ),
        cmocka_unit_test( info_tells_whether_a_recording_is_whole ),
    };
    return find_program( argc, argv )
               ? cmocka_run_group_tests_name( "program record", tests, enter_folder, leave_folder )
               : 64;
}
