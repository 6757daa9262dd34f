// Every file in tests/bad/recording is refused with a message, when it is opened or when a frame is read. The folder
// is walked, so a file dropped there is tested.
#include "record_fixture.h"

#include "../bad/bad_recordings.h"

enum
{
    FEWEST_FILES = 60,
};

static const char* bad_folder = WISP_SOURCE_ROOT "/tests/bad/recording";

static void path_in_bad_folder( char* path, size_t room, const char* name )
{
    int length = snprintf( path, room, "%s/%s", bad_folder, name );
    assert_true( length > 0 && (size_t)length < room );
}

// The first refusal: of the file, or of a frame.
static wisp_status read_recording( const char* path, wisp_error* error )
{
    wisp_recording* recording = NULL;
    wisp_status status = wisp_recording_open( path, &recording, error );
    assert_int_equal( recording == NULL, status != WISP_OK );
    for ( int f = 0; status == WISP_OK && f < wisp_recording_describe( recording ).frame_count; ++f )
    {
        status = wisp_recording_frame( recording, f, NULL, NULL, NULL, error );
    }
    wisp_recording_close( recording );
    return status;
}

static wisp_status read_cache( const char* path, wisp_error* error )
{
    wisp_pc2* cache = NULL;
    wisp_status status = wisp_pc2_open( path, &cache, error );
    assert_int_equal( cache == NULL, status != WISP_OK );
    for ( int f = 0; status == WISP_OK && f < wisp_pc2_describe( cache ).frame_count; ++f )
    {
        wisp_vec3 points[8];
        assert_true( wisp_pc2_describe( cache ).point_count <= WISP_COUNT( points ) );
        status = wisp_pc2_frame( cache, f, points, error );
    }
    wisp_pc2_close( cache );
    return status;
}

static void demand_refusal( const char* name, wisp_error* error )
{
    char path[1024];
    path_in_bad_folder( path, sizeof path, name );
    wisp_status status = strstr( name, ".pc2" ) != NULL ? read_cache( path, error ) : read_recording( path, error );
    if ( status != WISP_BAD_INPUT )
    {
        fail_msg( "%s: status is \"%s\" instead of \"bad input\"", name, wisp_status_name( status ) );
    }
    if ( strstr( error->message, name ) == NULL )
    {
        fail_msg( "%s: the sentence does not name the file: %s", name, error->message );
    }
    for ( const char* c = error->message; *c != 0; ++c )
    {
        assert_true( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
    assert_int_equal( error->status, WISP_BAD_INPUT );
}

static void every_file_of_the_folder_is_refused_with_a_message_that_names_it( void** state )
{
    (void)state;
    DIR* walk = opendir( bad_folder );
    assert_non_null( walk );
    int count = 0;
    for ( struct dirent* entry = readdir( walk ); entry != NULL; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] != '.' )
        {
            wisp_error error = { .status = WISP_OK };
            demand_refusal( entry->d_name, &error );
            ++count;
        }
    }
    closedir( walk );
    assert_true( count >= FEWEST_FILES );
}

// A file that is refused for another reason than its own tests nothing.
static void demand_words( const bad_recording* list, size_t count )
{
    for ( size_t i = 0; i < count; ++i )
    {
        wisp_error error = { .status = WISP_OK };
        demand_refusal( list[i].name, &error );
        if ( strstr( error.message, list[i].words ) == NULL )
        {
            fail_msg( "%s: expected \"%s\" in: %s", list[i].name, list[i].words, error.message );
        }
    }
}

static void every_refusal_gives_the_reason_the_file_was_made_for( void** state )
{
    (void)state;
    demand_words( bad_wisps, sizeof bad_wisps / sizeof bad_wisps[0] );
    demand_words( bad_pc2s, sizeof bad_pc2s / sizeof bad_pc2s[0] );
}

static void demand_bytes( const bad_recording* list, size_t count, void ( *good )( unsigned char* ) )
{
    for ( size_t i = 0; i < count; ++i )
    {
        unsigned char made[BAD_RECORDING_ROOM];
        size_t size = bad_recording_build( &list[i], good, made );
        char path[1024];
        path_in_bad_folder( path, sizeof path, list[i].name );
        size_t length = 0;
        unsigned char* found = get_file( path, &length );
        if ( length != size || memcmp( found, made, size ) != 0 )
        {
            fail_msg( "%s: the file is not what make_bad_recordings writes", list[i].name );
        }
        free( found );
    }
}

static void the_committed_files_are_those_that_the_generator_writes( void** state )
{
    (void)state;
    demand_bytes( bad_wisps, sizeof bad_wisps / sizeof bad_wisps[0], bad_recording_good_wisp );
    demand_bytes( bad_pc2s, sizeof bad_pc2s / sizeof bad_pc2s[0], bad_recording_good_pc2 );
}

static void the_files_they_were_made_from_are_good( void** state )
{
    (void)state;
    unsigned char bytes[BAD_RECORDING_ROOM];
    wisp_error error = { .status = WISP_OK };
    wisp_recording* recording = NULL;
    bad_recording_good_wisp( bytes );
    assert_good( wisp_recording_open_memory( bytes, WISP_SIZE, "good.wisp", &recording, &error ), &error );
    assert_true( wisp_recording_describe( recording ).complete );
    assert_int_equal( wisp_recording_describe( recording ).frame_count, 2 );
    assert_good( wisp_recording_frame( recording, 0, NULL, NULL, NULL, &error ), &error );
    assert_good( wisp_recording_frame( recording, 1, NULL, NULL, NULL, &error ), &error );
    wisp_recording_close( recording );

    wisp_pc2* cache = NULL;
    wisp_vec3 points[2];
    bad_recording_good_pc2( bytes );
    assert_good( wisp_pc2_open_memory( bytes, PC2_SIZE, "good.pc2", &cache, &error ), &error );
    assert_int_equal( wisp_pc2_describe( cache ).frame_count, 2 );
    assert_good( wisp_pc2_frame( cache, 0, points, &error ), &error );
    assert_good( wisp_pc2_frame( cache, 1, points, &error ), &error );
    wisp_pc2_close( cache );
}

// The good file is built from the description of the format, so this is the description's test of the writer.
static void the_recorder_writes_the_good_file_byte_for_byte( void** state )
{
    static const int32_t triangle[] = { 0, 1, 2 }, offsets[] = { 0, 2, 4 };
    static const wisp_record_body bodies[] = {
        { .name = "cloth", .triangles = triangle, .vertex_count = 3, .triangle_count = 1 },
        { .name = "hairs", .offsets = offsets, .vertex_count = 4, .strand_count = 2 },
    };
    static const wisp_vec3 ones[] = { { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 }, { 1, 1, 1 } };
    const wisp_vec3* points[] = { ones, ones };
    wisp_recorder_def def = { bodies, 2, 1.0 };
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "good.wisp" );
    assert_good( wisp_recorder_open( path, WISP_RECORD_WISP, &def, &recorder, &error ), &error );
    assert_good( wisp_recorder_frame( recorder, 0.0, 7, points, &error ), &error );
    assert_good( wisp_recorder_frame( recorder, 1.0, 7, points, &error ), &error );
    assert_good( wisp_recorder_close( recorder, &error ), &error );

    unsigned char good[BAD_RECORDING_ROOM];
    bad_recording_good_wisp( good );
    size_t size = 0;
    unsigned char* found = get_file( path, &size );
    assert_int_equal( size, WISP_SIZE );
    assert_memory_equal( found, good, WISP_SIZE );
    free( found );
}

int main( int argc, char** argv )
{
    bad_folder = argc > 1 ? argv[1] : bad_folder;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( every_file_of_the_folder_is_refused_with_a_message_that_names_it ),
        cmocka_unit_test( every_refusal_gives_the_reason_the_file_was_made_for ),
        cmocka_unit_test( the_committed_files_are_those_that_the_generator_writes ),
        cmocka_unit_test( the_files_they_were_made_from_are_good ),
        TEST_IN_FOLDER( the_recorder_writes_the_good_file_byte_for_byte ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
