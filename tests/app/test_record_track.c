// Vertex tracks, and what `wisp info` prints about recordings and point caches.
#include "record_fixture.h"

#include <locale.h>
#include <sys/stat.h>

// ---- tracks ----------------------------------------------------------------------------------------------------

static const wisp_track_point followed[] = { { 1, 4 }, { 0, 1 } };

static wisp_recorder_def track_def( const wisp_track_point* points, int count )
{
    wisp_recorder_def def = fixture_def();
    def.tracks = points;
    def.track_count = count;
    return def;
}

static wisp_recorder* open_track( const char* path )
{
    const wisp_recorder_def def = track_def( followed, 2 );
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* track = NULL;
    assert_ok( wisp_recorder_open( path, WISP_RECORD_TRACKS, &def, &track, &error ), error );
    return track;
}

static char* next_number( char* at, float expected )
{
    assert_int_equal( *at, ',' );
    float found = strtof( at + 1, &at );
    assert_memory_equal( &found, &expected, sizeof found );
    return at;
}

TEST_IN_FOLDER( tracks_are_a_table_whose_numbers_come_back_bit_for_bit )
{
    wisp_recorder* track = open_track( path_in( state, "a.csv" ) );
    for ( int f = 0; f < 3; ++f )
    {
        assert_int_equal( fixture_add_frame( track, f, NULL ), WISP_OK );
    }
    assert_int_equal( wisp_recorder_close( track, NULL ), WISP_OK );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.csv" ), &size );
    static const char names[] = "time,hair-2.4.x,hair-2.4.y,hair-2.4.z,cloth.1.x,cloth.1.y,cloth.1.z\n";
    assert_int_equal( strncmp( text, names, strlen( names ) ), 0 );
    char* at = text + strlen( names );
    for ( int f = 0; f < 3; ++f, ++at )
    {
        fixture_frame expected = fixture_points( f );
        assert_true( strtod( at, &at ) == fixture_time( f ) );
        for ( int i = 0; i < 2; ++i )
        {
            wisp_vec3 p = i == 0 ? expected.hair[4] : expected.cloth[1];
            at = next_number( next_number( next_number( at, p.x ), p.y ), p.z );
        }
        assert_int_equal( *at, '\n' );
    }
    assert_int_equal( *at, 0 );
    free( text );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( numbers_have_points_in_a_locale_with_commas )
{
    static const char* const locales[] = { "de_DE.UTF-8", "fr_FR.UTF-8", "de_DE", "fr_FR" };
    bool found = false;
    for ( int i = 0; i < WISP_COUNT( locales ) && !found; ++i )
    {
        found = setlocale( LC_NUMERIC, locales[i] ) != NULL;
    }
    if ( !found )
    {
        SKIP( "no locale with a decimal comma is installed" );
    }
    wisp_recorder* track = open_track( path_in( state, "a.csv" ) );
    wisp_status status = fixture_add_frame( track, 0, NULL );
    wisp_recorder_close( track, NULL );
    setlocale( LC_NUMERIC, "C" );
    assert_int_equal( status, WISP_OK );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.csv" ), &size );
    assert_contains( text, "\n0.0166666" );
    free( text );
}

TEST_IN_FOLDER( a_vertex_that_does_not_exist_is_refused_by_its_place )
{
    static const struct
    {
        wisp_track_point point;
        int count;
        const char* words;
    } cases[] = {
        { { 1, 5 }, 2, "a.csv: track 1 names vertex 5 of body hair-2, which has 5" },
        { { 1, -1 }, 2, "a.csv: track 1 names vertex -1 of body hair-2, which has 5" },
        { { 2, 0 }, 2, "a.csv: track 1 names body 2 of 2" },
        { { 1, 0 }, 0, "a.csv: got 0 vertices, expected at least 1" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        const wisp_track_point points[] = { { 0, 0 }, cases[i].point };
        const wisp_recorder_def def = track_def( points, cases[i].count );
        wisp_recorder* track = NULL;
        wisp_error error = { .status = WISP_OK };
        char* path = path_in( state, "a.csv" );
        assert_int_equal( wisp_recorder_open( path, WISP_RECORD_TRACKS, &def, &track, &error ), WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, cases[i].words );
        assert_null( track );
    }
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_table_of_tracks_is_never_chosen_by_its_name )
{
    const wisp_recorder_def def = track_def( followed, 2 );
    wisp_recorder* track = NULL;
    char* path = path_in( state, "a.csv" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &track, NULL ), WISP_BAD_INPUT );
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_number_that_is_not_finite_writes_no_line )
{
    wisp_recorder* track = open_track( path_in( state, "a.csv" ) );
    fixture_frame frame = fixture_points( 0 );
    frame.cloth[1].y = INFINITY;
    const wisp_vec3* points[] = { frame.cloth, frame.hair };
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_recorder_frame( track, 0.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.csv: frame 0: body cloth, vertex 1: y is not finite" );
    frame.cloth[1].y = 0.0f;
    assert_int_equal( wisp_recorder_frame( track, 0.0, 0, points, NULL ), WISP_OK );
    assert_int_equal( wisp_recorder_close( track, NULL ), WISP_OK );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.csv" ), &size );
    int lines = 0;
    for ( size_t i = 0; i < size; ++i )
    {
        lines += text[i] == '\n';
    }
    assert_int_equal( lines, 2 );
    free( text );
}

TEST_IN_FOLDER( a_full_disk_is_a_message )
{
    struct stat info;
    if ( stat( "/dev/full", &info ) != 0 || !S_ISCHR( info.st_mode ) )
    {
        SKIP( "there is no /dev/full" );
    }
    assert_int_equal( symlink( "/dev/full", path_in( state, "full.csv" ) ), 0 );
    wisp_recorder* track = open_track( path_in( state, "full.csv" ) );
    wisp_error error = { .status = WISP_OK };
    wisp_status status = WISP_OK;
    for ( int f = 0; f < 2000 && status == WISP_OK; ++f )
    {
        status = fixture_add_frame( track, f, &error );
    }
    assert_int_equal( status, WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "full.csv: cannot write: " );
    assert_int_equal( wisp_recorder_close( track, &error ), WISP_IO_ERROR );
}

// ---- wisp info -------------------------------------------------------------------------------------------------

static const int32_t plain_triangle[] = { 0, 1, 2 };
static const wisp_record_body plain_body = {
    .name = "sail", .triangles = plain_triangle, .vertex_count = 3, .triangle_count = 1
};

static void record_plain( const char* path, int frame_count )
{
    wisp_recorder_def def = { .bodies = &plain_body, .body_count = 1, .dt = 0.5 };
    wisp_recorder* recorder = NULL;
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    for ( int f = 0; f < frame_count; ++f )
    {
        const wisp_vec3 triangle[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 2.0f + (float)f, -0.5f } };
        const wisp_vec3* points[] = { triangle };
        assert_int_equal( wisp_recorder_frame( recorder, 0.5 * f, f == 0 ? 0 : 9, points, NULL ), WISP_OK );
    }
    assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
}

static char* print_recording( const char* path, wisp_status expected, wisp_error* error )
{
    wisp_recording* recording = NULL;
    assert_ok( wisp_recording_open( path, &recording, error ), *error );
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    assert_non_null( stream );
    assert_int_equal( wisp_recording_print( stream, recording, "sail.wisp", error ), expected );
    fclose( stream );
    wisp_recording_close( recording );
    return text;
}

// header 40 + 16 + 4 + 12 + 8 = 80 bytes, frame 40 + 36 + 8 = 84 bytes
TEST_IN_FOLDER( info_tells_what_is_in_a_recording )
{
    char* path = path_in( state, "sail.wisp" );
    wisp_error error = { .status = WISP_OK };
    record_plain( path, 3 );
    char* text = print_recording( path, WISP_OK, &error );
    assert_string_equal( text, "sail.wisp: recording of 3 frames\n"
                               "  step                 0.5 s\n"
                               "  time                 0 .. 1 s\n"
                               "  frame                84 bytes\n"
                               "  hash of the world    of 2 frames\n"
                               "  bodies               1\n"
                               "    sail               1 triangles, 3 vertices, x 0 .. 1, y 0 .. 4, z -0.5 .. 0 m\n"
                               "  no defects\n" );
    free( text );
}

TEST_IN_FOLDER( info_tells_a_cut_and_does_not_refuse_it )
{
    char* path = path_in( state, "sail.wisp" );
    wisp_error error = { .status = WISP_OK };
    record_plain( path, 3 );
    assert_int_equal( truncate( path, 80 + 84 + 30 ), 0 );
    char* text = print_recording( path, WISP_OK, &error );
    assert_contains( text, "recording of 1 frames" );
    assert_contains( text, "  wrong: the recording was cut: 30 bytes from byte 164 on are not a whole frame\n" );
    assert_null( strstr( text, "nothing is wrong" ) );
    free( text );
    assert_int_equal( truncate( path, 80 ), 0 );
    text = print_recording( path, WISP_OK, &error );
    assert_contains( text, "recording of 0 frames" );
    assert_contains( text, "  wrong: the recording was not finished: the mark of the end is missing at byte 80\n" );
    free( text );
}

TEST_IN_FOLDER( info_names_the_first_ten_damaged_frames_and_counts_the_rest )
{
    char* path = path_in( state, "sail.wisp" );
    wisp_error error = { .status = WISP_OK };
    record_plain( path, 14 );
    size_t size = 0;
    unsigned char* bytes = read_bytes( path, &size );
    for ( int f = 1; f < 14; ++f )
    {
        bytes[80 + 84 * f + 50] ^= 4;
    }
    write_bytes( path, bytes, size );
    free( bytes );
    char* text = print_recording( path, WISP_BAD_INPUT, &error );
    assert_one_message( &error, WISP_BAD_INPUT, "sail.wisp: frame 1 at byte 164 is damaged" );
    assert_contains( text, "  time                 0 .. 0 s\n" );
    assert_contains( text, "sail.wisp: frame 10 at byte 920 is damaged" );
    assert_null( strstr( text, "frame 11 at" ) );
    assert_contains( text, "  wrong: and 3 more frames\n" );
    free( text );
}

TEST_IN_FOLDER( info_tells_what_is_in_a_point_cache )
{
    record_plain( path_in( state, "sail.pc2" ), 2 );
    wisp_recording* cache = NULL;
    assert_int_equal( wisp_pc2_open( path_in( state, "sail.pc2" ), &cache, NULL ), WISP_OK );
    char* text = NULL;
    size_t length = 0;
    FILE* stream = open_memstream( &text, &length );
    assert_non_null( stream );
    assert_int_equal( wisp_recording_print( stream, cache, "sail.pc2", NULL ), WISP_OK );
    fclose( stream );
    wisp_recording_close( cache );
    assert_string_equal( text, "sail.pc2: point cache of 2 frames\n"
                               "  frames               from 0, every 1\n"
                               "  points               3, x 0 .. 1, y 0 .. 3, z -0.5 .. 0 m\n"
                               "  no defects\n" );
    free( text );
}
