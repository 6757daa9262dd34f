// Recordings for other programs: point caches, ParaView, OBJ, USD. Every format is read back here by a small independent
// reader, and every number must be restored bit for bit. What recordings hold besides points: values, normals, widths,
// colours, and bodies that stand still. Limits, and recordings that end early.
#include "record_text_fixture.h"

#include <sys/stat.h>

// ---- .pc2 ----

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
    SCOPED( recording_local ) wisp_recording* cache = NULL;
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
}

// ---- .pvd and .vtp ----

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
        SCOPED( free_local )
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
    }
}

TEST_IN_FOLDER( the_list_of_frames_has_their_times_and_paths_beside_it )
{
    wisp_recorder_def def = fixture_def();
    fixture_record( path_in( state, "a&b.pvd" ), &def, 2 );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a&b.pvd" ), &size );
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

// ---- .obj ----

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
        SCOPED( free_local ) char* text = read_bytes( path_in( state, f == 0 ? "a_0001.obj" : "a_0002.obj" ), &size );
        assert_obj( text, f );
    }
}

// ---- .usda ----

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
    fixture_record( path_in( state, "a.usda" ), &def, 3 );
    assert_int_equal( count_files( state ), 1 );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.usda" ), &size );
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
}

// 1/60 as a float is not exact, and USD needs a standard rate. Some readers refuse an empty list of samples.
TEST_IN_FOLDER( usd_without_frames_has_a_rate_and_no_samples )
{
    wisp_recorder_def def = fixture_def();
    def.dt = (double)( 1.0f / 60.0f );
    fixture_record( path_in( state, "a.usda" ), &def, 0 );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.usda" ), &size );
    assert_balanced( text );
    assert_contains( text, "timeCodesPerSecond = 60\n" );
    assert_null( strstr( text, "timeSamples" ) );
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

// ---- failures of the operating system ----

TEST_IN_FOLDER( files_that_cannot_be_read_half_written_appear_when_they_are_finished )
{
    static const char* const names[] = { "a.usda", "a.pvd", "a.pc2", "a.glb", "a.csv" };
    wisp_recorder_def def = fixture_def();
    def.body_count = 1;
    def.track_count = 1;
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char* path = path_in( state, names[i] );
        write_bytes( path, "precious", 8 );
        wisp_recorder* recorder = NULL;
        assert_int_equal( fixture_open( path, &def, &recorder, NULL ), WISP_OK );
        assert_int_equal( fixture_add_frame( recorder, 0, NULL ), WISP_OK );
        size_t size = 0;
        SCOPED( free_local ) char* text = read_bytes( path, &size );
        assert_string_equal( text, "precious" );
        free( text );
        assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
        text = read_bytes( path, &size );
        assert_true( size > 8 );
    }
}

// The first failure, at any point: opening, a frame, or closing.
static wisp_status record_until_it_fails( const char* path, wisp_error* error )
{
    wisp_recorder_def def = fixture_def();
    def.body_count = 1;
    def.track_count = 1;
    wisp_recorder* recorder = NULL;
    wisp_status status = fixture_open( path, &def, &recorder, error );
    for ( int f = 0; f < 200 && status == WISP_OK; ++f )
    {
        status = fixture_add_frame( recorder, f, error );
    }
    wisp_status closed = wisp_recorder_close( recorder, status == WISP_OK ? error : NULL );
    return status == WISP_OK ? closed : status;
}

TEST_IN_FOLDER( a_full_disk_is_a_message_in_every_format )
{
    static const char* const names[] = { "full.wisp", "full.pc2", "full.pvd",     "full.usda",
                                         "full.glb",  "full.csv", "full_0001.obj" };
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
    static const char* const names[] = { "none/a.pc2", "none/a.pvd", "none/a.usda",
                                         "none/a.obj", "none/a.glb", "none/a.csv" };
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

enum
{
    BODIES = 3,
    VERTICES = 5, // most of a body
};

static const int32_t floor_triangles[] = { 0, 2, 1 };
static const wisp_vec3 floor_points[] = { { -1, 0, -1 }, { 1, 0, -1 }, { 0, 0, 1 } };
static const float hair_widths[] = { 1e-3f, 8e-4f, 1e-4f, 1e-3f, 5e-4f };
static const wisp_vec3 hair_colours[] = {
    { 0, 0, 0 }, { 1, 0.5f, 0.25f }, { 1, 1, 1 }, { 0.002f, 0.2f, 0 }, { 0, 0, 1 }
};

/// A folded sheet that opens, two strands, and a floor. The numbers of values are refilled for each frame.
typedef struct values_fixture
{
    float strain[VERTICES], speed[VERTICES];
    wisp_record_value cloth_values[2];
    wisp_record_body bodies[BODIES];
    wisp_vec3 cloth[CLOTH_VERTICES], hair[HAIR_VERTICES], ground[3];
    wisp_recorder_def def;
} values_fixture;

static void fill( values_fixture* x, int f )
{
    const float height = 0.25f * (float)f;
    const wisp_vec3 cloth[] = { { 0, 1, 0 }, { 1, 1, 0 }, { 0, 1, -1 }, { 1, 1 + height, -1 } };
    memcpy( x->cloth, cloth, sizeof cloth );
    for ( int v = 0; v < HAIR_VERTICES; ++v )
    {
        x->hair[v] = ( wisp_vec3 ){ 0.1f * (float)v, 2.0f - 0.3f * (float)f * (float)v, 0.7f };
    }
    memcpy( x->ground, floor_points, sizeof floor_points );
    for ( int v = 0; v < CLOTH_VERTICES; ++v )
    {
        x->strain[v] = 0.01f * (float)( v + 10 * f );
        x->speed[v] = 1.0f / (float)( 1 + v + f );
    }
}

static void prepare( values_fixture* x )
{
    *x = ( values_fixture ){ .cloth_values = { { "strain", x->strain }, { "speed", x->speed } } };
    x->bodies[0] = fixture_bodies[0];
    x->bodies[0].base_colour = ( wisp_vec3 ){ 0.5f, 0.25f, 0.125f };
    x->bodies[0].values = x->cloth_values;
    x->bodies[0].value_count = 2;
    x->bodies[1] = fixture_bodies[1];
    x->bodies[1].widths = hair_widths;
    x->bodies[1].colours = hair_colours;
    x->bodies[2] = ( wisp_record_body ){
        .name = "ground", .triangles = floor_triangles, .vertex_count = 3, .triangle_count = 1, .is_static = true
    };
    x->def = ( wisp_recorder_def ){ .bodies = x->bodies, .body_count = BODIES, .dt = 0.5 };
}

static wisp_status add( wisp_recorder* recorder, values_fixture* x, int f, wisp_error* error )
{
    const wisp_vec3* points[] = { x->cloth, x->hair, x->ground };
    fill( x, f );
    return wisp_recorder_frame( recorder, 0.5 * f, 0, points, error );
}

static wisp_recorder* open_good( const char* path, values_fixture* x )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    assert_ok( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &x->def, &recorder, &error ), error );
    return recorder;
}

static void record( const char* path, values_fixture* x, int frame_count )
{
    wisp_error error = { .status = WISP_OK };
    prepare( x );
    wisp_recorder* recorder = open_good( path, x );
    for ( int f = 0; f < frame_count; ++f )
    {
        assert_ok( add( recorder, x, f, &error ), error );
    }
    assert_ok( wisp_recorder_close( recorder, &error ), error );
}

static void read_floats( const char* text, const char* name, float* out, int count )
{
    unsigned char bytes[512];
    assert_int_equal( decode_array( text, name, bytes, sizeof bytes ), count );
    for ( int i = 0; i < count; ++i )
    {
        out[i] = get_float( bytes + 4 * i );
    }
}

// ---- .vtp ----

TEST_IN_FOLDER( values_of_each_frame_are_arrays_of_points )
{
    values_fixture x;
    record( path_in( state, "a.pvd" ), &x, 3 );
    for ( int f = 0; f < 3; ++f )
    {
        char name[40];
        size_t size = 0;
        float strain[CLOTH_VERTICES], speed[CLOTH_VERTICES];
        snprintf( name, sizeof name, "a/cloth_%04d.vtp", f + 1 );
        SCOPED( free_local ) char* text = read_bytes( path_in( state, name ), &size );
        assert_xml( text );
        assert_contains( text, "<PointData Scalars=\"strain\" Normals=\"Normals\">" );
        read_floats( text, "strain", strain, CLOTH_VERTICES );
        read_floats( text, "speed", speed, CLOTH_VERTICES );
        fill( &x, f );
        assert_memory_equal( strain, x.strain, sizeof strain );
        assert_memory_equal( speed, x.speed, sizeof speed );
    }
}

TEST_IN_FOLDER( normals_are_weighted_by_area )
{
    values_fixture x;
    record( path_in( state, "a.pvd" ), &x, 2 );
    size_t size = 0;
    float normals[3 * CLOTH_VERTICES];
    char* text = read_bytes( path_in( state, "a/cloth_0002.vtp" ), &size );
    read_floats( text, "Normals", normals, 3 * CLOTH_VERTICES );
    free( text );
    // The first triangle lies flat; the second rises by 1/4 m over 1 m in x and has the normal (-1, 4, 0) times 1/4 plus
    // the same along z, as its cross product (-0.25, 1, 0.25) says. The middle vertices have the sum of both.
    const double flat[3] = { 0, 1, 0 }, risen[3] = { -0.25, 1, 0.25 };
    for ( int v = 0; v < CLOTH_VERTICES; ++v )
    {
        double sum[3], length = 0.0;
        for ( int k = 0; k < 3; ++k )
        {
            sum[k] = ( v != 3 ? flat[k] : 0.0 ) + ( v != 0 ? risen[k] : 0.0 );
            length += sum[k] * sum[k];
        }
        for ( int k = 0; k < 3; ++k )
        {
            // rounded once
            assert_float_equal( normals[3 * v + k], (float)( sum[k] / sqrt( length ) ), 1.2e-7f );
        }
    }
}

TEST_IN_FOLDER( strands_have_widths_and_colours_for_a_display )
{
    values_fixture x;
    record( path_in( state, "a.pvd" ), &x, 1 );
    size_t size = 0;
    float widths[HAIR_VERTICES];
    unsigned char bytes[512];
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a/hair-2_0001.vtp" ), &size );
    assert_xml( text );
    assert_contains( text, "<PointData Scalars=\"width\">" );
    assert_null( strstr( text, "Normals" ) );
    read_floats( text, "width", widths, HAIR_VERTICES );
    assert_memory_equal( widths, hair_widths, sizeof widths );
    assert_contains( text, "<DataArray type=\"UInt8\" Name=\"RGB\" NumberOfComponents=\"3\"" );
    decode_array( text, "RGB", bytes, sizeof bytes );
    // IEC 61966-2-1: 12.92 c up to 0.0031308, 1.055 c^(1/2.4) - 0.055 above, times 255
    static const unsigned char expected[] = { 0, 0, 0, 255, 188, 137, 255, 255, 255, 7, 124, 0, 0, 0, 255 };
    assert_memory_equal( bytes, expected, sizeof expected );
}

TEST_IN_FOLDER( a_static_body_is_one_file_that_all_frames_name )
{
    values_fixture x;
    record( path_in( state, "a.pvd" ), &x, 3 );
    assert_true( exists( path_in( state, "a/ground_0001.vtp" ) ) );
    assert_false( exists( path_in( state, "a/ground_0002.vtp" ) ) );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.pvd" ), &size );
    assert_xml( text );
    assert_int_equal( count_of( text, "name=\"ground\" file=\"a/ground_0001.vtp\"" ), 3 );
    free( text );
    text = read_bytes( path_in( state, "a/ground_0001.vtp" ), &size );
    assert_null( strstr( text, "TimeValue" ) );
}

// ---- .usda ----

TEST_IN_FOLDER( usd_prims_have_normals_velocities_colours_and_widths )
{
    values_fixture x;
    record( path_in( state, "a.usda" ), &x, 3 );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.usda" ), &size );
    assert_balanced( text );
    assert_contains( text, "    framesPerSecond = 2\n" );
    char* hair = strstr( text, "def BasisCurves \"hair_2\"" );
    assert_non_null( hair );
    *hair = 0;
    assert_contains( text, "uniform bool doubleSided = 1\n" );
    assert_contains(
        text, "color3f[] primvars:displayColor = [(0.5, 0.25, 0.125)] (\n            interpolation = \"constant\"" );
    assert_contains( text,
                     "normal3f[] normals (interpolation = \"vertex\")\n        normal3f[] normals.timeSamples = {\n"
                     "            0: [(0, 1, 0), (0, 1, 0), (0, 1, 0), (0, 1, 0)],\n" );
    // vertex 3 rises by 0.25 m in 0.5 s
    assert_contains( text, "            1: [(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0.5, 0)],\n" );
    assert_contains( text, "            2: [(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0.5, 0)],\n" );
    assert_contains( text, "float[] primvars:strain (interpolation = \"vertex\")\n" );
    char sample[200];
    fill( &x, 2 );
    snprintf( sample, sizeof sample, "            2: [%.9g, %.9g, %.9g, %.9g],\n", (double)x.strain[0],
              (double)x.strain[1], (double)x.strain[2], (double)x.strain[3] );
    assert_contains( text, sample );
    *hair = 'd';
    assert_contains( hair, "float[] widths = [0.00100000005, 0.00079999998, 9.99999975e-05, 0.00100000005, "
                           "0.000500000024] (\n            interpolation = \"vertex\"" );
    assert_contains( hair, "color3f[] primvars:displayColor = [(0, 0, 0), (1, 0.5, 0.25), " );
}

TEST_IN_FOLDER( a_static_body_has_no_time_samples_in_usd )
{
    values_fixture x;
    record( path_in( state, "a.usda" ), &x, 3 );
    size_t size = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, "a.usda" ), &size );
    const char* ground = strstr( text, "def Mesh \"ground\"" );
    assert_non_null( ground );
    assert_null( strstr( ground, "timeSamples" ) );
    assert_null( strstr( ground, "velocities" ) );
    assert_contains( ground, "point3f[] points = [(-1, 0, -1), (1, 0, -1), (0, 0, 1)]\n" );
    assert_contains( ground, "float3[] extent = [(-1, 0, -1), (1, 0, 1)]\n" );
}

// ---- recordings that end early ----

static int frames_in( void** state, const char* name )
{
    size_t size = 0;
    int count = 0;
    SCOPED( free_local ) char* text = read_bytes( path_in( state, name ), &size );
    const bool is_own = strcmp( name, "a.wisp" ) == 0;
    if ( is_own || strcmp( name, "a_cloth.pc2" ) == 0 )
    {
        SCOPED( recording_local ) wisp_recording* recording = NULL;
        const char* path = path_in( state, name );
        assert_int_equal( is_own ? wisp_recording_open( path, &recording, NULL )
                                 : wisp_pc2_open( path, &recording, NULL ),
                          WISP_OK );
        assert_true( wisp_recording_describe( recording ).complete );
        count = wisp_recording_describe( recording ).frame_count;
    }
    else if ( strcmp( name, "a.pvd" ) == 0 )
    {
        assert_xml( text );
        count = count_of( text, "name=\"cloth\"" );
    }
    else if ( strcmp( name, "a.usda" ) == 0 )
    {
        assert_balanced( text );
        count = strstr( text, "timeSamples" ) != NULL ? atoi( strstr( text, "endTimeCode = " ) + 14 ) + 1 : 0;
    }
    else
    {
        // three bodies have points, and two of them a target for each frame after the first
        assert_memory_equal( text, "glTF", 4 );
        assert_int_equal( get_u32( (unsigned char*)text + 8 ), size );
        count = count_of( text + 20, "{\"POSITION\":" );
        count = count > 0 ? ( count - 3 ) / 2 + 1 : 0;
    }
    return count;
}

TEST_IN_FOLDER( a_recording_may_end_before_the_frames_that_were_expected )
{
    static const char* const names[][2] = { { "a.wisp", "a.wisp" },
                                            { "a.pc2", "a_cloth.pc2" },
                                            { "a.pvd", "a.pvd" },
                                            { "a.usda", "a.usda" },
                                            { "a.glb", "a.glb" } };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        for ( int frames = 0; frames <= 3; ++frames )
        {
            values_fixture x;
            wisp_error error = { .status = WISP_OK };
            prepare( &x );
            x.def.frame_count = 100;
            wisp_recorder* recorder = open_good( path_in( state, names[i][0] ), &x );
            for ( int f = 0; f < frames; ++f )
            {
                assert_ok( add( recorder, &x, f, &error ), error );
            }
            assert_ok( wisp_recorder_close( recorder, &error ), error );
            assert_int_equal( frames_in( state, names[i][1] ), frames );
        }
    }
}

// ---- what is refused ----

TEST_IN_FOLDER( a_static_body_that_moves_is_refused_and_the_recording_goes_on )
{
    values_fixture x;
    wisp_error error = { .status = WISP_OK };
    prepare( &x );
    wisp_recorder* recorder = open_good( path_in( state, "a.wisp" ), &x );
    assert_ok( add( recorder, &x, 0, &error ), error );
    fill( &x, 1 );
    x.ground[1].y = 0.5f;
    const wisp_vec3* points[] = { x.cloth, x.hair, x.ground };
    assert_int_equal( wisp_recorder_frame( recorder, 0.5, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT,
                        "a.wisp: frame 1: body ground has moved, but it was opened as static" );
    assert_ok( add( recorder, &x, 1, &error ), error );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
}

TEST_IN_FOLDER( a_value_that_is_not_finite_is_refused_by_name )
{
    values_fixture x;
    wisp_error error = { .status = WISP_OK };
    prepare( &x );
    wisp_recorder* recorder = open_good( path_in( state, "a.pvd" ), &x );
    fill( &x, 0 );
    x.speed[2] = NAN;
    const wisp_vec3* points[] = { x.cloth, x.hair, x.ground };
    assert_int_equal( wisp_recorder_frame( recorder, 0.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.pvd: frame 0: body cloth, vertex 2: speed is not finite" );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
    assert_false( exists( path_in( state, "a/cloth_0001.vtp" ) ) );
}

static void refuse( void** state, values_fixture* x, const char* words )
{
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "a.pvd" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &x->def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, words );
    assert_int_equal( count_files( state ), 0 );
    prepare( x );
}

TEST_IN_FOLDER( widths_colours_and_names_of_values_are_checked )
{
    static const float thin[] = { 1, 1, -1, 1, 1 };
    static const wisp_vec3 bright[] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 0, 2, 0 } };
    values_fixture x;
    prepare( &x );
    x.bodies[1].widths = thin;
    refuse( state, &x, "a.pvd: body hair-2, vertex 2: got a width of -1 m" );
    x.bodies[1].colours = bright;
    refuse( state, &x, "a.pvd: body hair-2, vertex 4: got a colour of (0, 2, 0)" );
    x.bodies[0].base_colour.x = NAN;
    refuse( state, &x, "a.pvd: body cloth: got a colour of (nan, 0.25, 0.125)" );
    x.cloth_values[1].name = "strain";
    refuse( state, &x, "a.pvd: body cloth: two values are called strain" );
    x.cloth_values[1].name = "width";
    refuse( state, &x, "a.pvd: body cloth: value 1 has no numbers, or a name that files use" );
    x.cloth_values[0].name = "1st";
    refuse( state, &x, "a.pvd: body cloth: value 0 has" );
}
