// Recordings in our own format: reading, a truncation or a flipped bit, and rejected input. Vertex tracks.
#include "locale_fixture.h"
#include "record_fixture.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

static wisp_recording* open_good( const char* path )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recording* recording = NULL;
    assert_ok( wisp_recording_open( path, &recording, &error ), error );
    return recording;
}

static void assert_frame_is( wisp_recording* recording, int f )
{
    wisp_error error = { .status = WISP_OK };
    fixture_frame found, expected = fixture_points( f );
    memset( &found, 0xa5, sizeof found );
    wisp_vec3* points[] = { found.cloth, found.hair };
    double time = -1.0;
    uint64_t hash = 0;
    assert_ok( wisp_recording_frame( recording, f, points, &time, &hash, &error ), error );
    assert_memory_equal( &found, &expected, sizeof found );
    assert_true( time == fixture_time( f ) );
    assert_true( hash == fixture_hash( f ) );
}

// ---- reading ----

TEST_IN_FOLDER( a_recording_comes_back_bit_for_bit_in_any_order )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.WISP" ), &def, 5 );
    wisp_recording* recording = open_good( path_in( state, "a.WISP" ) );
    wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, 5 );
    assert_int_equal( info.body_count, FIXTURE_BODIES );
    assert_true( info.dt == def.dt );
    assert_true( info.complete );
    assert_int_equal( info.tail_bytes, 0 );
    static const int order[] = { 4, 0, 3, 1, 2, 2 };
    for ( int i = 0; i < WISP_COUNT( order ); ++i )
    {
        assert_frame_is( recording, order[i] );
    }
    wisp_recording_close( recording );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( bodies_come_back_with_their_names_triangles_and_offsets )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.wisp" ), &def, 0 );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path_in( state, "a.wisp" ) );
    const wisp_record_body* cloth = wisp_recording_body( recording, 0 );
    const wisp_record_body* hair = wisp_recording_body( recording, 1 );
    assert_string_equal( cloth->name, "cloth" );
    assert_string_equal( hair->name, "hair-2" );
    assert_int_equal( cloth->vertex_count, CLOTH_VERTICES );
    assert_int_equal( cloth->triangle_count, 2 );
    assert_null( cloth->offsets );
    assert_memory_equal( cloth->triangles, fixture_triangles, sizeof fixture_triangles );
    assert_int_equal( hair->vertex_count, HAIR_VERTICES );
    assert_int_equal( hair->strand_count, 2 );
    assert_null( hair->triangles );
    assert_memory_equal( hair->offsets, fixture_offsets, sizeof fixture_offsets );
}

// Points stay as they are where the format says what they are relative to, and are places in the world elsewhere.
TEST_IN_FOLDER( points_far_away_are_relative_to_an_origin )
{
    wisp_recorder_def def = fixture_def();
    def.origin[0] = 20000.0;
    def.origin[2] = -4096.5;
    fixture_record( path_in( state, "a.wisp" ), &def, 2 );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path_in( state, "a.wisp" ) );
    const wisp_recording_info info = wisp_recording_describe( recording );
    assert_memory_equal( info.origin, def.origin, sizeof info.origin );
    assert_frame_is( recording, 1 );
    assert_string_equal( wisp_recording_body( recording, 1 )->name, "hair-2" );
    wisp_recording_close( recording );

    fixture_record( path_in( state, "a.pc2" ), &def, 1 );
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_pc2_open( path_in( state, "a_cloth.pc2" ), &recording, &error ), error );
    wisp_vec3 found[CLOTH_VERTICES];
    wisp_vec3* points[] = { found };
    assert_ok( wisp_recording_frame( recording, 0, points, NULL, NULL, &error ), error );
    const fixture_frame expected = fixture_points( 0 );
    assert_true( found[1].x == (float)( 20000.0 + (double)expected.cloth[1].x ) );
    assert_true( found[1].z == (float)( -4096.5 + (double)expected.cloth[1].z ) );
}

TEST_IN_FOLDER( a_body_that_is_not_requested_is_skipped )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.wisp" ), &def, 1 );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path_in( state, "a.wisp" ) );
    fixture_frame found, expected = fixture_points( 0 );
    wisp_vec3* points[] = { NULL, found.hair };
    assert_int_equal( wisp_recording_frame( recording, 0, points, NULL, NULL, NULL ), WISP_OK );
    assert_memory_equal( found.hair, expected.hair, sizeof expected.hair );
}

TEST_IN_FOLDER( a_frame_that_is_not_there_is_refused_by_its_number )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.wisp" ), &def, 2 );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path_in( state, "a.wisp" ) );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_recording_frame( recording, 2, NULL, NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.wisp: got frame 2, the recording has 2" );
    assert_int_equal( wisp_recording_frame( recording, -1, NULL, NULL, NULL, NULL ), WISP_BAD_INPUT );
}

// ---- crashes, cuts and damage ----

TEST_IN_FOLDER( a_frame_is_in_the_file_when_the_call_returns )
{
    wisp_recorder_def def = fixture_def();
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "a.wisp" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    for ( int f = 0; f < 3; ++f )
    {
        assert_int_equal( fixture_add_frame( recorder, f, NULL ), WISP_OK );
        SCOPED( recording_local ) wisp_recording* recording = open_good( path );
        wisp_recording_info info = wisp_recording_describe( recording );
        assert_int_equal( info.frame_count, f + 1 );
        assert_int_equal( info.tail_bytes, 0 );
        assert_false( info.complete );
        assert_frame_is( recording, f );
    }
    assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
}

// A recording in memory, and where its parts are.
typedef struct sample
{
    unsigned char* bytes;
    size_t size, header, frame;
    int count;
} sample;

static sample make_sample( void** state )
{
    sample s = { .count = 3 };
    wisp_recorder_def def = fixture_def();
    char* path = path_in( state, "sample.wisp" );
    fixture_record( path, &def, s.count );
    s.bytes = read_bytes( path, &s.size );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path );
    s.header = (size_t)wisp_recording_describe( recording ).first_byte;
    s.frame = (size_t)wisp_recording_describe( recording ).frame_bytes;
    return s;
}

// The block is exactly as long as the truncated file, so that a sanitizer detects a read beyond it.
static void demand_cut( const sample* s, size_t size )
{
    unsigned char* bytes = checked_malloc( size > 0 ? size : 1 );
    memcpy( bytes, s->bytes, size );
    wisp_error error = { .status = WISP_OK };
    wisp_recording* recording = NULL;
    wisp_status status = wisp_recording_open_memory( bytes, size, "cut", &recording, &error );
    if ( size < s->header )
    {
        assert_int_equal( status, WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, "cut: " );
        assert_null( recording );
    }
    else
    {
        assert_ok( status, error );
        wisp_recording_info info = wisp_recording_describe( recording );
        size_t frames = ( size - s->header ) / s->frame;
        assert_int_equal( info.frame_count, frames );
        assert_int_equal( info.complete, size == s->size );
        assert_int_equal( info.tail_bytes, size == s->size ? 0 : size - s->header - frames * s->frame );
        for ( int f = 0; f < info.frame_count; ++f )
        {
            assert_frame_is( recording, f );
        }
    }
    wisp_recording_close( recording );
    free( bytes );
}

TEST_IN_FOLDER( a_recording_cut_at_any_byte_gives_its_whole_frames_and_tells_or_is_refused )
{
    sample s = make_sample( state );
    for ( size_t size = 0; size <= s.size; ++size )
    {
        demand_cut( &s, size );
    }
    free( s.bytes );
}

// Exactly the damaged part is rejected, and all others are read.
static void demand_flip( const sample* s, size_t at )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recording* recording = NULL;
    wisp_status status = wisp_recording_open_memory( s->bytes, s->size, "flipped", &recording, &error );
    if ( at < s->header )
    {
        assert_int_equal( status, WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, "flipped: byte " );
        return;
    }
    assert_ok( status, error );
    int hit = (int)( ( at - s->header ) / s->frame );
    wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, s->count );
    assert_int_equal( info.complete, hit < s->count );
    assert_int_equal( info.tail_bytes > 0, hit == s->count );
    for ( int f = 0; f < s->count; ++f )
    {
        if ( f != hit )
        {
            assert_frame_is( recording, f );
            continue;
        }
        char words[100];
        snprintf( words, sizeof words, "flipped: frame %d at byte %zu is damaged", f,
                  s->header + (size_t)hit * s->frame );
        fixture_frame untouched, found;
        memset( &untouched, 0xa5, sizeof untouched );
        found = untouched;
        wisp_vec3* points[] = { found.cloth, found.hair };
        assert_int_equal( wisp_recording_frame( recording, f, points, NULL, NULL, &error ), WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, words );
        assert_memory_equal( &found, &untouched, sizeof found );
    }
    wisp_recording_close( recording );
}

TEST_IN_FOLDER( a_flipped_bit_anywhere_is_seen_and_hurts_only_its_own_frame )
{
    sample s = make_sample( state );
    for ( size_t at = 0; at < s.size; ++at )
    {
        for ( int bit = 0; bit < 8; ++bit )
        {
            s.bytes[at] ^= (unsigned char)( 1 << bit );
            demand_flip( &s, at );
            s.bytes[at] ^= (unsigned char)( 1 << bit );
        }
    }
    free( s.bytes );
}

TEST_IN_FOLDER( frames_that_a_power_cut_left_as_zeros_are_told_as_a_cut )
{
    sample s = make_sample( state );
    size_t size = s.header + 3 * s.frame + 10;
    memset( s.bytes + s.header + s.frame, 0, 2 * s.frame + 10 );
    wisp_recording* recording = NULL;
    assert_int_equal( wisp_recording_open_memory( s.bytes, size, "zeros", &recording, NULL ), WISP_OK );
    wisp_recording_info info = wisp_recording_describe( recording );
    assert_int_equal( info.frame_count, 1 );
    assert_int_equal( info.tail_bytes, 2 * s.frame + 10 );
    assert_false( info.complete );
    assert_frame_is( recording, 0 );
    wisp_recording_close( recording );
    free( s.bytes );
}

TEST_IN_FOLDER( a_frame_of_another_recording_is_refused )
{
    sample s = make_sample( state );
    wisp_recorder_def def = fixture_def();
    def.dt = 0.5;
    char* path = path_in( state, "other.wisp" );
    fixture_record( path, &def, 3 );
    size_t size = 0;
    unsigned char* other = read_bytes( path, &size );
    assert_int_equal( size, s.size );
    memcpy( s.bytes + s.header + s.frame, other + s.header + s.frame, s.frame );
    wisp_recording* recording = NULL;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_recording_open_memory( s.bytes, s.size, "mixed", &recording, NULL ), WISP_OK );
    assert_int_equal( wisp_recording_frame( recording, 1, NULL, NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "mixed: frame 1 at byte" );
    wisp_recording_close( recording );
    free( other );
    free( s.bytes );
}

// ---- rejected input ----

TEST_IN_FOLDER( a_malformed_body_is_refused_by_name_and_leaves_the_old_file )
{
    static const int32_t beyond[] = { 0, 1, 2, 0, 1, 4 }, late[] = { 1, 5 }, falling[] = { 0, 4, 3, 5 },
                         early[] = { 0, 4 };
    static const char long_name[] = "a2345678901234567890123456789012345678901234567890123456789012345";
    static const struct
    {
        wisp_record_body body;
        const char* words;
    } cases[] = {
#define MESH( of_name, list, count, vertices )                                                                       \
    { .name = of_name, .triangles = list, .triangle_count = count, .vertex_count = vertices }
#define STRANDS( list, count )                                                                                       \
    {                                                                                                                \
        .name = "s", .offsets = list, .strand_count = count, .vertex_count = 5                                       \
    }
        { MESH( "m", beyond, 2, 4 ), "precious.wisp: body m: triangle 1: got vertex 4, expected 0 .. 3" },
        { MESH( "m", NULL, 2, 4 ), "body m: the list of its 2 triangles is missing" },
        { MESH( "m", NULL, -1, 4 ), "body m: got -1 triangles" },
        { MESH( "m", NULL, -1, 0 ), "body m: got 0 vertices" },
        { MESH( "cloth", NULL, -1, 0 ), "bodies 0 and 1 are both called cloth" },
        { MESH( "../m", NULL, -1, 0 ), "body 1: expected a name" },
        { MESH( "", NULL, -1, 0 ), "body 1: expected a name" },
        { MESH( long_name, NULL, -1, 0 ), "body 1: expected a name" },
        { STRANDS( late, 1 ), "body s: strand 0 starts at vertex 1" },
        { STRANDS( falling, 3 ), "body s: strand 1 runs from vertex 4 to 3 of 5" },
        { STRANDS( early, 1 ), "body s: the strands end at vertex 4 of 5" },
        { STRANDS( early, 0 ), "body s: got 0 strands" },
    };
    char* path = path_in( state, "precious.wisp" );
    write_bytes( path, "precious", 8 );
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        const wisp_record_body bodies[] = { fixture_bodies[0], cases[i].body };
        const wisp_recorder_def def = { .bodies = bodies, .body_count = 2, .dt = 0.1 };
        wisp_recorder* recorder = NULL;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_BAD_INPUT );
        assert_null( recorder );
        assert_one_message( &error, WISP_BAD_INPUT, cases[i].words );
    }
    char kept[20];
    read_text( path, kept, sizeof kept );
    assert_string_equal( kept, "precious" );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( a_definition_that_makes_no_sense_is_refused )
{
    static const struct
    {
        const char* name;
        double dt;
        int bodies;
        const char* words;
    } cases[] = {
        { "a.wisp", 0.0, FIXTURE_BODIES, "a.wisp: got 0 seconds between two frames" },
        { "a.wisp", 0.1, 0, "got 0 bodies, expected 1 to 4096" },
        { "a.wisp.txt", 0.1, FIXTURE_BODIES, "ends in .wisp, .pc2, .pvd, .obj, .usda or .glb" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        wisp_recorder* recorder = NULL;
        wisp_error error = { .status = WISP_OK };
        wisp_recorder_def def = fixture_def();
        def.dt = cases[i].dt;
        def.body_count = cases[i].bodies;
        assert_int_equal( fixture_open( path_in( state, cases[i].name ), &def, &recorder, &error ), WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, cases[i].words );
    }
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_frame_that_is_refused_does_not_end_the_recording )
{
    wisp_recorder_def def = fixture_def();
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.wisp" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    assert_int_equal( fixture_add_frame( recorder, 0, NULL ), WISP_OK );
    assert_int_equal( fixture_add_frame( recorder, 0, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.wisp: frame 1: got time" );

    fixture_frame frame = fixture_points( 1 );
    frame.hair[3].z = NAN;
    const wisp_vec3* points[] = { frame.cloth, frame.hair };
    assert_int_equal( wisp_recorder_frame( recorder, 1.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "frame 1: body hair-2, vertex 3: z is not finite" );
    frame.hair[3].z = 0.0f;
    assert_int_equal( wisp_recorder_frame( recorder, NAN, 0, points, &error ), WISP_BAD_INPUT );

    assert_int_equal( fixture_add_frame( recorder, 1, NULL ), WISP_OK );
    assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path );
    assert_int_equal( wisp_recording_describe( recording ).frame_count, 2 );
    assert_frame_is( recording, 1 );
}

// ---- failures of the operating system ----

TEST_IN_FOLDER( a_frame_that_the_disk_refuses_is_taken_back_and_may_be_repeated )
{
    wisp_recorder_def def = fixture_def();
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "a.wisp" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    assert_int_equal( fixture_add_frame( recorder, 0, NULL ), WISP_OK );
    struct stat info;
    assert_int_equal( stat( path, &info ), 0 );

    // Files may grow by 50 bytes more: the write fails in the middle of a frame, as on a full disk.
    struct rlimit before;
    assert_int_equal( getrlimit( RLIMIT_FSIZE, &before ), 0 );
    struct rlimit small = { (rlim_t)info.st_size + 50, before.rlim_max };
    void ( *old )( int ) = signal( SIGXFSZ, SIG_IGN );
    assert_int_equal( setrlimit( RLIMIT_FSIZE, &small ), 0 );
    wisp_error error = { .status = WISP_OK };
    wisp_status status = fixture_add_frame( recorder, 1, &error );
    assert_int_equal( setrlimit( RLIMIT_FSIZE, &before ), 0 );
    signal( SIGXFSZ, old );

    assert_int_equal( status, WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "a.wisp: cannot write: " );
    struct stat after;
    assert_int_equal( stat( path, &after ), 0 );
    assert_int_equal( after.st_size, info.st_size );

    assert_int_equal( fixture_add_frame( recorder, 1, NULL ), WISP_OK );
    assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path );
    assert_true( wisp_recording_describe( recording ).complete );
    assert_frame_is( recording, 0 );
    assert_frame_is( recording, 1 );
}

TEST_IN_FOLDER( a_path_that_cannot_be_written_or_read_is_a_message )
{
    wisp_recorder_def def = fixture_def();
    wisp_recorder* recorder = NULL;
    wisp_recording* recording = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "none/a.wisp" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "none/a.wisp: cannot create a file beside it" );
    assert_null( recorder );
    assert_int_equal( wisp_recording_open( path, &recording, &error ), WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "none/a.wisp: cannot open: " );
    assert_int_equal( wisp_recording_open( path_in( state, "." ), &recording, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "got a folder" );
    char* pipe_path = path_in( state, "pipe.wisp" );
    assert_int_equal( mkfifo( pipe_path, 0600 ), 0 );
    assert_int_equal( wisp_recording_open( pipe_path, &recording, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "got a device or a pipe" );
    assert_null( recording );
}

TEST_IN_FOLDER( a_file_that_shrinks_while_it_is_read_is_an_error )
{
    wisp_recorder_def def = fixture_def();
    char* path = path_in( state, "a.wisp" );
    fixture_record( path, &def, 2 );
    SCOPED( recording_local ) wisp_recording* recording = open_good( path );
    assert_int_equal( truncate( path, (off_t)wisp_recording_describe( recording ).first_byte + 20 ), 0 );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_recording_frame( recording, 0, NULL, NULL, NULL, &error ), WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "the file became shorter while it was read" );
}

// ---- tracks ----

TEST_IN_FOLDER( numbers_have_points_in_a_locale_with_commas )
{
    enter_comma_locale();
    const wisp_recorder_def def = fixture_def();
    wisp_recorder* track = NULL;
    wisp_status status = fixture_open( path_in( state, "a.csv" ), &def, &track, NULL );
    status = status == WISP_OK ? fixture_add_frame( track, 0, NULL ) : status;
    wisp_recorder_close( track, NULL );
    setlocale( LC_ALL, "C" );
    assert_int_equal( status, WISP_OK );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.csv" ), &size );
    assert_contains( text, "\n0.0166666" );
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
        wisp_recorder_def def = fixture_def();
        def.tracks = points;
        def.track_count = cases[i].count;
        wisp_recorder* track = NULL;
        wisp_error error = { .status = WISP_OK };
        char* path = path_in( state, "a.csv" );
        assert_int_equal( wisp_recorder_open( path, WISP_RECORD_TRACKS, &def, &track, &error ), WISP_BAD_INPUT );
        assert_one_message( &error, WISP_BAD_INPUT, cases[i].words );
        assert_null( track );
    }
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_number_that_is_not_finite_writes_no_line )
{
    const wisp_recorder_def def = fixture_def();
    wisp_recorder* track = NULL;
    assert_int_equal( fixture_open( path_in( state, "a.csv" ), &def, &track, NULL ), WISP_OK );
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
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.csv" ), &size );
    int lines = 0;
    for ( size_t i = 0; i < size; ++i )
    {
        lines += text[i] == '\n';
    }
    assert_int_equal( lines, 2 );
}
