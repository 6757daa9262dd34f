// Every file in tests/bad/recording is rejected with a message, when it is opened or when a frame is read. The test
// walks the folder, so any file in it is tested.
#include "record_fixture.h"

#include "bad_folder.h"

#include "../bad/bad_recordings.h"

static const char* const bad_folder = WISP_SOURCE_ROOT "/tests/bad/recording";

// The first rejection: of the file, or of a frame.
static wisp_status read_recording( const char* path, bool is_cache, wisp_error* error )
{
    SCOPED( recording_local ) wisp_recording* recording = NULL;
    wisp_status status =
        is_cache ? wisp_pc2_open( path, &recording, error ) : wisp_recording_open( path, &recording, error );
    assert_int_equal( recording == NULL, status != WISP_OK );
    for ( int f = 0; status == WISP_OK && f < wisp_recording_describe( recording ).frame_count; ++f )
    {
        status = wisp_recording_frame( recording, f, NULL, NULL, NULL, error );
    }
    return status;
}

static void demand_refusal( const char* path, const char* name, wisp_error* error )
{
    const wisp_status status = read_recording( path, strstr( name, ".pc2" ) != NULL, error );
    if ( status != WISP_BAD_INPUT )
    {
        fail_msg( "%s: status is \"%s\" instead of \"bad input\"", name, wisp_status_name( status ) );
    }
}

TEST( every_file_of_the_folder_is_refused_with_a_message_that_names_it )
{
    demand_refusal_of_folder( 60, demand_refusal );
}

TEST( every_refusal_gives_the_reason_the_file_was_made_for )
{
    for ( int l = 0; l < WISP_COUNT( bad_recording_lists ); ++l )
    {
        demand_words( bad_recording_lists + l, demand_refusal );
    }
}

TEST( the_committed_files_are_those_that_the_generator_writes )
{
    for ( int l = 0; l < WISP_COUNT( bad_recording_lists ); ++l )
    {
        demand_bytes( bad_recording_lists + l );
    }
}

TEST( the_files_they_were_made_from_are_good )
{
    unsigned char bytes[BAD_FILE_MAX];
    wisp_error error = { .status = WISP_OK };
    SCOPED( recording_local ) wisp_recording* recording = NULL;
    bad_recording_good_wisp( bytes );
    assert_ok( wisp_recording_open_memory( bytes, WISP_SIZE, "good.wisp", &recording, &error ), error );
    assert_true( wisp_recording_describe( recording ).complete );
    assert_int_equal( wisp_recording_describe( recording ).frame_count, 2 );
    assert_ok( wisp_recording_frame( recording, 0, NULL, NULL, NULL, &error ), error );
    assert_ok( wisp_recording_frame( recording, 1, NULL, NULL, NULL, &error ), error );
    wisp_recording_close( recording );

    wisp_vec3 points[2];
    wisp_vec3* all[] = { points };
    bad_recording_good_pc2( bytes );
    assert_ok( wisp_pc2_open_memory( bytes, PC2_SIZE, "good.pc2", &recording, &error ), error );
    assert_int_equal( wisp_recording_describe( recording ).frame_count, 2 );
    assert_int_equal( wisp_recording_body( recording, 0 )->vertex_count, WISP_COUNT( points ) );
    assert_ok( wisp_recording_frame( recording, 0, all, NULL, NULL, &error ), error );
    assert_ok( wisp_recording_frame( recording, 1, all, NULL, NULL, &error ), error );
}

// The valid file is built from the description of the format, so it also tests the writer.
TEST_IN_FOLDER( the_recorder_writes_the_good_file_byte_for_byte )
{
    static const int32_t triangle[] = { 0, 1, 2 }, offsets[] = { 0, 2, 4 };
    static const wisp_record_body bodies[] = {
        { .name = "cloth", .triangles = triangle, .vertex_count = 3, .triangle_count = 1 },
        { .name = "hairs", .offsets = offsets, .vertex_count = 4, .strand_count = 2 },
    };
    static const wisp_vec3 ones[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    const wisp_vec3* points[] = { ones, ones };
    wisp_recorder_def def = { .bodies = bodies, .body_count = 2, .dt = 1.0 };
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "good.wisp" );
    assert_ok( wisp_recorder_open( path, WISP_RECORD_WISP, &def, &recorder, &error ), error );
    assert_ok( wisp_recorder_frame( recorder, 0.0, 7, points, &error ), error );
    assert_ok( wisp_recorder_frame( recorder, 1.0, 7, points, &error ), error );
    assert_ok( wisp_recorder_close( recorder, &error ), error );

    unsigned char good[BAD_FILE_MAX];
    bad_recording_good_wisp( good );
    size_t size = 0;
    unsigned char* found = read_bytes( path, &size );
    assert_int_equal( size, WISP_SIZE );
    assert_memory_equal( found, good, WISP_SIZE );
    free( found );
}
