// What recordings hold besides points: values, normals, widths, colours, and bodies that stand still. Limits, and
// recordings that end early.
#include "record_text_fixture.h"

#include <math.h>

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

// ---- .vtp ------------------------------------------------------------------------------------------------------

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
        char* text = read_bytes( path_in( state, name ), &size );
        assert_xml( text );
        assert_contains( text, "<PointData Scalars=\"strain\" Normals=\"Normals\">" );
        read_floats( text, "strain", strain, CLOTH_VERTICES );
        read_floats( text, "speed", speed, CLOTH_VERTICES );
        fill( &x, f );
        assert_memory_equal( strain, x.strain, sizeof strain );
        assert_memory_equal( speed, x.speed, sizeof speed );
        free( text );
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
    char* text = read_bytes( path_in( state, "a/hair-2_0001.vtp" ), &size );
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
    free( text );
}

TEST_IN_FOLDER( a_static_body_is_one_file_that_all_frames_name )
{
    values_fixture x;
    record( path_in( state, "a.pvd" ), &x, 3 );
    assert_true( exists( path_in( state, "a/ground_0001.vtp" ) ) );
    assert_false( exists( path_in( state, "a/ground_0002.vtp" ) ) );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.pvd" ), &size );
    assert_xml( text );
    assert_int_equal( count_of( text, "name=\"ground\" file=\"a/ground_0001.vtp\"" ), 3 );
    free( text );
    text = read_bytes( path_in( state, "a/ground_0001.vtp" ), &size );
    assert_null( strstr( text, "TimeValue" ) );
    free( text );
}

// ---- .usda -----------------------------------------------------------------------------------------------------

TEST_IN_FOLDER( usd_prims_have_normals_velocities_colours_and_widths )
{
    values_fixture x;
    record( path_in( state, "a.usda" ), &x, 3 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.usda" ), &size );
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
    free( text );
}

TEST_IN_FOLDER( a_static_body_has_no_time_samples_in_usd )
{
    values_fixture x;
    record( path_in( state, "a.usda" ), &x, 3 );
    size_t size = 0;
    char* text = read_bytes( path_in( state, "a.usda" ), &size );
    const char* ground = strstr( text, "def Mesh \"ground\"" );
    assert_non_null( ground );
    assert_null( strstr( ground, "timeSamples" ) );
    assert_null( strstr( ground, "velocities" ) );
    assert_contains( ground, "point3f[] points = [(-1, 0, -1), (1, 0, -1), (0, 0, 1)]\n" );
    assert_contains( ground, "float3[] extent = [(-1, 0, -1), (1, 0, 1)]\n" );
    free( text );
}

// ---- recordings that end early ---------------------------------------------------------------------------------

static int frames_in( void** state, const char* name )
{
    size_t size = 0;
    int count = 0;
    char* text = read_bytes( path_in( state, name ), &size );
    const bool is_own = strcmp( name, "a.wisp" ) == 0;
    if ( is_own || strcmp( name, "a_cloth.pc2" ) == 0 )
    {
        wisp_recording* recording = NULL;
        const char* path = path_in( state, name );
        assert_int_equal( is_own ? wisp_recording_open( path, &recording, NULL )
                                 : wisp_pc2_open( path, &recording, NULL ),
                          WISP_OK );
        assert_true( wisp_recording_describe( recording ).complete );
        count = wisp_recording_describe( recording ).frame_count;
        wisp_recording_close( recording );
    }
    else if ( strcmp( name, "a.pvd" ) == 0 )
    {
        assert_xml( text );
        count = count_of( text, "name=\"cloth\"" );
    }
    else if ( strcmp( name, "a.usda" ) == 0 )
    {
        assert_balanced( text );
        count = atoi( strstr( text, "endTimeCode = " ) + 14 ) + 1;
    }
    else
    {
        // three bodies have points, and two of them a target for each frame after the first
        assert_memory_equal( text, "glTF", 4 );
        assert_int_equal( get_u32( (unsigned char*)text + 8 ), size );
        count = ( count_of( text + 20, "{\"POSITION\":" ) - 3 ) / 2 + 1;
    }
    free( text );
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
        for ( int frames = 1; frames <= 3; ++frames )
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

// ---- what is refused -------------------------------------------------------------------------------------------

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
