// Recordings for other programs: point caches, ParaView, OBJ, USD. Every format is read back here by a small
// independent reader, and every number must be restored bit for bit.
#include "record_text_fixture.h"

#include <sys/stat.h>

// ---- .pc2 ------------------------------------------------------------------------------------------------------

TEST_IN_FOLDER( a_point_cache_has_the_layout_of_its_format )
{
    wisp_recorder_def def = fixture_def();
    def.body_count = 1;
    fixture_record( path_in( state, "a.pc2" ), &def, 3 );
    size_t size = 0;
    unsigned char* bytes = read_bytes( path_in( state, "a.pc2" ), &size );
    assert_int_equal( size, 32 + 3 * CLOTH_VERTICES * 12 );
    assert_memory_equal( bytes, "POINTCACHE2\0", 12 );
    assert_int_equal( get_u32( bytes + 12 ), 1 );
    assert_int_equal( get_u32( bytes + 16 ), CLOTH_VERTICES );
    assert_bits( get_float( bytes + 20 ), 0.0f );
    assert_bits( get_float( bytes + 24 ), 1.0f );
    assert_int_equal( get_u32( bytes + 28 ), 3 );
    const unsigned char* at = bytes + 32;
    for ( int f = 0; f < 3; ++f )
    {
        fixture_frame expected = fixture_points( f );
        for ( int v = 0; v < CLOTH_VERTICES; ++v, at += 12 )
        {
            const float point[] = { get_float( at ), get_float( at + 4 ), get_float( at + 8 ) };
            assert_point( point, expected.cloth[v] );
        }
    }
    free( bytes );
    assert_int_equal( count_files( state ), 1 );
}

TEST_IN_FOLDER( several_bodies_are_a_point_cache_each_and_come_back )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.pc2" ), &def, 2 );
    assert_int_equal( count_files( state ), 2 );
    wisp_recording* cache = NULL;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_pc2_open( path_in( state, "a_hair-2.pc2" ), &cache, &error ), error );
    assert_int_equal( wisp_recording_body( cache, 0 )->vertex_count, HAIR_VERTICES );
    assert_int_equal( wisp_recording_describe( cache ).frame_count, 2 );
    for ( int f = 1; f >= 0; --f )
    {
        wisp_vec3 points[HAIR_VERTICES];
        wisp_vec3* all[] = { points };
        double time = -1.0;
        fixture_frame expected = fixture_points( f );
        assert_ok( wisp_recording_frame( cache, f, all, &time, NULL, &error ), error );
        assert_true( time == f );
        assert_memory_equal( points, expected.hair, sizeof points );
    }
    assert_int_equal( wisp_recording_frame( cache, 2, NULL, NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a_hair-2.pc2: got frame 2, the cache has 2" );
    wisp_recording_close( cache );
    assert_ok( wisp_pc2_open( path_in( state, "a_cloth.pc2" ), &cache, &error ), error );
    wisp_recording_close( cache );
}

// ---- .pvd and .vtp ---------------------------------------------------------------------------------------------

TEST_IN_FOLDER( paraview_finds_triangles_lines_and_points_in_every_frame )
{
    static const int32_t ends[] = { 3, 6 }, line[] = { 0, 1, 2, 3, 4 }, line_ends[] = { 3, 5 };
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.pvd" ), &def, 2 );
    assert_int_equal( count_files( state ), 2 );
    assert_int_equal( walk_folder( path_in( state, "a" ), false ), 4 );
    for ( int f = 0; f < 2; ++f )
    {
        fixture_frame expected = fixture_points( f );
        size_t size = 0;
        char* text = read_bytes( path_in( state, f == 0 ? "a/cloth_0001.vtp" : "a/cloth_0002.vtp" ), &size );
        assert_xml( text );
        assert_contains( text, "NumberOfPoints=\"4\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                               "NumberOfPolys=\"2\"" );
        assert_vtp_points( text, expected.cloth, CLOTH_VERTICES );
        assert_numbers( text, "connectivity", fixture_triangles, 6 );
        assert_numbers( text, "offsets", ends, 2 );
        free( text );
        text = read_bytes( path_in( state, f == 0 ? "a/hair-2_0001.vtp" : "a/hair-2_0002.vtp" ), &size );
        assert_xml( text );
        assert_contains( text, "NumberOfLines=\"2\"" );
        assert_vtp_points( text, expected.hair, HAIR_VERTICES );
        assert_numbers( text, "connectivity", line, 5 );
        assert_numbers( text, "offsets", line_ends, 2 );
        free( text );
    }
}

TEST_IN_FOLDER( the_list_of_frames_has_their_times_and_paths_beside_it )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a&b.pvd" ), &def, 2 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a&b.pvd" ), &size );
    assert_xml( text );
    assert_int_equal( count_of( text, "<DataSet " ), 4 );
    for ( int f = 0; f < 2; ++f )
    {
        char words[200];
        snprintf( words, sizeof words,
                  "timestep=\"%.17g\" group=\"\" part=\"1\" name=\"hair-2\" file=\"a&amp;b/hair-2_000%d.vtp\"",
                  fixture_time( f ), f + 1 );
        assert_contains( text, words );
    }
    free( text );
}

TEST_IN_FOLDER( a_strand_without_a_segment_is_no_line )
{
    static const int32_t offsets[] = { 0, 1, 1, 5 }, line[] = { 1, 2, 3, 4 }, ends[] = { 4 };
    wisp_record_body bodies[] = { fixture_bodies[0], fixture_bodies[1] };
    bodies[1].offsets = offsets;
    bodies[1].strand_count = 3;
    wisp_recorder_def def = { .bodies = bodies, .body_count = 2, .dt = 0.1 };
    fixture_record( path_in( state, "a.pvd" ), &def, 1 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a/hair-2_0001.vtp" ), &size );
    assert_contains( text, "NumberOfPoints=\"5\" NumberOfVerts=\"0\" NumberOfLines=\"1\"" );
    assert_numbers( text, "connectivity", line, 4 );
    assert_numbers( text, "offsets", ends, 1 );
    free( text );

    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.usda" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.usda: body hair-2: strand 0 has 1 vertices" );
}

// ---- .obj ------------------------------------------------------------------------------------------------------

// Reads vertices in order; elements are compared as lines.
static void assert_obj( char* text, int f )
{
    fixture_frame expected = fixture_points( f );
    int vertex = 0;
    char elements[200] = "";
    for ( char* line = strtok( text, "\n" ); line != NULL; line = strtok( NULL, "\n" ) )
    {
        if ( strncmp( line, "v ", 2 ) == 0 )
        {
            char* at = line + 2;
            const float x = strtof( at, &at ), y = strtof( at, &at ), z = strtof( at, &at );
            const float point[] = { x, y, z };
            assert_true( *at == 0 && vertex < CLOTH_VERTICES + HAIR_VERTICES );
            assert_point( point,
                          vertex < CLOTH_VERTICES ? expected.cloth[vertex] : expected.hair[vertex - CLOTH_VERTICES] );
            ++vertex;
        }
        else if ( line[0] != '#' )
        {
            strcat( strcat( elements, line ), ";" );
        }
    }
    assert_int_equal( vertex, CLOTH_VERTICES + HAIR_VERTICES );
    assert_string_equal( elements, "o cloth;f 1 2 3;f 3 2 4;o hair-2;l 5 6;l 6 7;l 8 9;" );
}

TEST_IN_FOLDER( obj_frames_are_numbered_from_1_and_come_back )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a.obj" ), &def, 2 );
    assert_int_equal( count_files( state ), 2 );
    for ( int f = 0; f < 2; ++f )
    {
        size_t size = 0;
        char* text = read_bytes( path_in( state, f == 0 ? "a_0001.obj" : "a_0002.obj" ), &size );
        assert_obj( text, f );
        free( text );
    }
}

// ---- .usda -----------------------------------------------------------------------------------------------------

// A list of points in brackets; returns the text after it.
static char* assert_usda_points( char* at, const wisp_vec3* expected, int count )
{
    assert_int_equal( *at, '[' );
    ++at;
    for ( int v = 0; v < count; ++v )
    {
        at += strspn( at, ", " );
        assert_int_equal( *at, '(' );
        float point[3];
        for ( int k = 0; k < 3; ++k )
        {
            point[k] = strtof( at + 1, &at );
            assert_int_equal( *at, k < 2 ? ',' : ')' );
        }
        ++at;
        assert_point( point, expected[v] );
    }
    assert_int_equal( *at, ']' );
    return at + 1;
}

// All samples of a body, at the codes 1, 2, 3 that the fixture's times are.
static void assert_samples( char* text, const char* prim, int body, int frame_count )
{
    char* at = strstr( text, prim );
    assert_non_null( at );
    at = strstr( at, "point3f[] points.timeSamples = {" );
    assert_non_null( at );
    at = strchr( at, '{' ) + 1;
    for ( int f = 0; f < frame_count; ++f )
    {
        assert_int_equal( strtol( at, &at, 10 ), f + 1 );
        assert_int_equal( strncmp( at, ": ", 2 ), 0 );
        fixture_frame expected = fixture_points( f );
        at = body == 0 ? assert_usda_points( at + 2, expected.cloth, CLOTH_VERTICES )
                       : assert_usda_points( at + 2, expected.hair, HAIR_VERTICES );
        assert_int_equal( *at, ',' );
        ++at;
    }
    at += strspn( at, " \n" );
    assert_int_equal( *at, '}' );
}

TEST_IN_FOLDER( usd_has_every_frame_of_every_body_as_a_time_sample )
{
    wisp_recorder_def def = fixture_def();
    def.dt = (double)( 1.0f / 60.0f );
    fixture_record( path_in( state, "a.usda" ), &def, 0 );
    def = fixture_def();
    fixture_record( path_in( state, "a.usda" ), &def, 3 );
    assert_int_equal( count_files( state ), 1 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.usda" ), &size );
    assert_int_equal( strncmp( text, "#usda 1.0\n", 10 ), 0 );
    assert_balanced( text );
    assert_contains( text, "    startTimeCode = 1\n    timeCodesPerSecond = 60\n" );
    assert_contains( text, "    endTimeCode = 3\n    framesPerSecond = 60\n" );
    assert_contains( text,
                     "int[] faceVertexCounts = [3, 3]\n        int[] faceVertexIndices = [0, 1, 2, 2, 1, 3]\n" );
    assert_contains( text, "int[] curveVertexCounts = [3, 2]\n" );
    assert_int_equal( count_of( text, "float3[] extent.timeSamples" ), 2 );
    assert_samples( text, "def Mesh \"cloth\"", 0, 3 );
    assert_samples( text, "def BasisCurves \"hair_2\"", 1, 3 );
    free( text );
}

TEST_IN_FOLDER( a_recording_without_frames_is_still_a_file )
{
    wisp_recorder_def def = fixture_def();
    def.dt = (double)( 1.0f / 60.0f );
    fixture_record( path_in( state, "a.usda" ), &def, 0 );
    fixture_record( path_in( state, "a.pvd" ), &def, 0 );
    fixture_record( path_in( state, "a.pc2" ), &def, 0 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.usda" ), &size );
    assert_balanced( text );
    // 1/60 as a float is not exact, and USD needs a standard rate
    assert_contains( text, "timeCodesPerSecond = 60\n" );
    // some readers refuse an empty list of samples
    assert_null( strstr( text, "timeSamples" ) );
    free( text );
    text = read_bytes( path_in( state, "a.pvd" ), &size );
    assert_xml( text );
    free( text );
    wisp_recording* cache = NULL;
    assert_int_equal( wisp_pc2_open( path_in( state, "a_cloth.pc2" ), &cache, NULL ), WISP_OK );
    assert_int_equal( wisp_recording_describe( cache ).frame_count, 0 );
    wisp_recording_close( cache );
}

TEST_IN_FOLDER( names_that_usd_cannot_tell_apart_are_refused )
{
    wisp_record_body bodies[] = { fixture_bodies[0], fixture_bodies[0] };
    bodies[0].name = "a-b";
    bodies[1].name = "a_b";
    wisp_recorder_def def = { .bodies = bodies, .body_count = 2, .dt = 0.1 };
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.usda" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "bodies a-b and a_b would both be called a_b in USD" );
    assert_int_equal( count_files( state ), 0 );
}

// ---- failures of the operating system --------------------------------------------------------------------------

TEST_IN_FOLDER( files_that_cannot_be_read_half_written_appear_when_they_are_finished )
{
    static const char* const names[] = { "a.usda", "a.pvd", "a.pc2", "a.glb" };
    wisp_recorder_def def = fixture_def();
    def.body_count = 1;
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char* path = path_in( state, names[i] );
        write_bytes( path, "precious", 8 );
        wisp_recorder* recorder = NULL;
        assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
        assert_int_equal( fixture_add_frame( recorder, 0, NULL ), WISP_OK );
        size_t size = 0;
        char* text = read_bytes( path, &size );
        assert_string_equal( text, "precious" );
        free( text );
        assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
        text = read_bytes( path, &size );
        assert_true( size > 8 );
        free( text );
    }
}

// The first failure, at any point: opening, a frame, or closing.
static wisp_status record_until_it_fails( const char* path, wisp_error* error )
{
    wisp_recorder_def def = fixture_def();
    def.body_count = 1;
    wisp_recorder* recorder = NULL;
    wisp_status status = wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, error );
    for ( int f = 0; f < 200 && status == WISP_OK; ++f )
    {
        status = fixture_add_frame( recorder, f, error );
    }
    wisp_status closed = wisp_recorder_close( recorder, status == WISP_OK ? error : NULL );
    return status == WISP_OK ? closed : status;
}

TEST_IN_FOLDER( a_full_disk_is_a_message_in_every_format )
{
    static const char* const names[] = {
        "full.wisp", "full.pc2", "full.pvd", "full.usda", "full.glb", "full_0001.obj"
    };
    struct stat info;
    if ( stat( "/dev/full", &info ) != 0 || !S_ISCHR( info.st_mode ) )
    {
        SKIP( "there is no /dev/full" );
    }
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char* path = path_in( state, names[i] );
        assert_int_equal( symlink( "/dev/full", path ), 0 );
        bool obj = strstr( path, ".obj" ) != NULL;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( record_until_it_fails( obj ? path_in( state, "full.obj" ) : path, &error ), WISP_IO_ERROR );
        assert_one_message( &error, WISP_IO_ERROR, "cannot write: " );
        assert_contains( error.message, "full" );
    }
    // the links, and the folder of the .vtp files, which are not on the full disk
    assert_int_equal( count_files( state ), WISP_COUNT( names ) + 1 );
}

TEST_IN_FOLDER( a_folder_that_is_not_there_is_a_message_in_every_format )
{
    static const char* const names[] = { "none/a.pc2", "none/a.pvd", "none/a.usda", "none/a.obj", "none/a.glb" };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( record_until_it_fails( path_in( state, names[i] ), &error ), WISP_IO_ERROR );
        assert_one_message( &error, WISP_IO_ERROR, "none/a" );
    }
    assert_int_equal( count_files( state ), 0 );
}

TEST_IN_FOLDER( a_file_in_the_place_of_the_folder_of_frames_is_a_message )
{
    wisp_recorder_def def = fixture_def();
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    write_bytes( path_in( state, "a" ), "precious", 8 );
    char* path = path_in( state, "a.pvd" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_IO_ERROR );
    assert_one_message( &error, WISP_IO_ERROR, "/a: cannot make a folder: " );
    assert_int_equal( count_files( state ), 1 );
    path = path_in( state, "b" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_PVD, &def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "b: expected a name with an extension" );
    assert_int_equal( count_files( state ), 1 );
}
