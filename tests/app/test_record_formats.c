// Recordings for other programs, which tests/app/transcripts/formats.t reads: what only a host can do to them. Values, widths and
// colours that are refused, bodies that move although they are static, limits of the formats, recordings that end early. Meshes that
// tear: a square of two triangles whose corner 0 is split in frame 2, so that the second triangle gets vertex 4 there. Vertex 5 is
// never used.
#include "record_fixture.h"

#include "../bad/seal_recording.h"

static int count_of( const char* text, const char* words )
{
    int count = 0;
    for ( const char* at = strstr( text, words ); at != NULL; at = strstr( at + 1, words ) )
    {
        ++count;
    }
    return count;
}

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

enum
{
    BODIES = 3,
    MOST_VERTICES = 5, // of a body
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
    float strain[MOST_VERTICES], speed[MOST_VERTICES];
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

// ---- recordings that end early ----

static int frames_in( void** state, const char* name )
{
    size_t size = 0;
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
        return wisp_recording_describe( recording ).frame_count;
    }
    if ( strcmp( name, "a.pvd" ) == 0 )
    {
        assert_contains( text, "</VTKFile>\n" );
        return count_of( text, "name=\"cloth\"" );
    }
    if ( strcmp( name, "a.usda" ) == 0 )
    {
        // some readers refuse an empty list of samples
        assert_string_equal( text + size - 2, "}\n" );
        return strstr( text, "timeSamples" ) != NULL ? atoi( strstr( text, "endTimeCode = " ) + 14 ) + 1 : 0;
    }
    // three bodies have points, and two of them a target for each frame after the first; without a frame there is no mesh
    const int count = count_of( text + 20, "{\"POSITION\":" );
    assert_int_equal( strstr( text + 20, "\"meshes\"" ) != NULL, count > 0 );
    assert_int_equal( strstr( text + 20, "\"animations\"" ) != NULL, count > 3 );
    return count > 0 ? ( count - 3 ) / 2 + 1 : 0;
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

// ---- limits ----

TEST_IN_FOLDER( more_frames_than_fit_are_refused_before_the_first )
{
    values_fixture x;
    prepare( &x );
    wisp_recorder_def def = x.def;
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.glb" );
    write_bytes( path, "precious", 8 );
    def.frame_count = 2001;
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: got 2001 frames, expected at most 1000, because" );
    // 2000 steps, every 3rd: 666 and the start
    assert_contains( error.message, "one in 3 of these frames would fit" );
    assert_int_equal( count_files( state ), 1 );

    // 8 million vertices are 96 MB a frame, of at most 1024
    static const int32_t offsets[] = { 0, 8000000 };
    const wisp_record_body large = { .name = "l", .offsets = offsets, .vertex_count = 8000000, .strand_count = 1 };
    def.bodies = &large;
    def.body_count = 1;
    def.frame_count = 21;
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: got 21 frames, expected at most 10, because" );
    assert_contains( error.message, "one in 3 of these frames would fit" );
    size_t size = 0;
    SCOPED( free_local ) char* kept = read_bytes( path, &size );
    assert_string_equal( kept, "precious" );
}

TEST_IN_FOLDER( a_frame_beyond_the_limit_is_refused_and_those_before_are_kept )
{
    values_fixture x;
    wisp_error error = { .status = WISP_OK };
    prepare( &x );
    wisp_recorder* recorder = open_good( path_in( state, "a.glb" ), &x );
    for ( int f = 0; f < WISP_RECORD_GLB_MAX_FRAMES; ++f )
    {
        assert_ok( add( recorder, &x, f, &error ), error );
    }
    assert_int_equal( add( recorder, &x, WISP_RECORD_GLB_MAX_FRAMES, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: a .glb file of these bodies ends after 1000 frames" );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
    assert_int_equal( frames_in( state, "a.glb" ), WISP_RECORD_GLB_MAX_FRAMES );
}

TEST_IN_FOLDER( times_and_points_that_the_format_cannot_hold_are_refused )
{
    values_fixture x;
    wisp_error error = { .status = WISP_OK };
    prepare( &x );
    wisp_recorder* recorder = open_good( path_in( state, "a.glb" ), &x );
    fill( &x, 0 );
    const wisp_vec3* points[] = { x.cloth, x.hair, x.ground };
    assert_int_equal( wisp_recorder_frame( recorder, -1.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 0: got time -1 s, expected at least 0" );
    assert_ok( wisp_recorder_frame( recorder, 1.0, 0, points, &error ), error );
    assert_int_equal( wisp_recorder_frame( recorder, 1.0 + 1e-9, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 1: got time 1 s" );
    x.hair[4].y = -3e38f;
    assert_int_equal( wisp_recorder_frame( recorder, 2.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 1: body hair-2, vertex 4 is too far from the origin" );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
}

// ---- a mesh that tears ----

enum
{
    VERTICES = 6,
    FRAMES = 4,
    SPLIT = 2, // first with vertex 4
};

static const int32_t WHOLE[6] = { 0, 1, 2, 0, 2, 3 }, TORN[6] = { 0, 1, 2, 4, 2, 3 };

static const int32_t* triangles_of( int frame )
{
    return frame < SPLIT ? WHOLE : TORN;
}

// The square rises by 1 m a frame; what is split off goes sideways.
static void place( int frame, wisp_vec3 points[VERTICES] )
{
    static const wisp_vec3 START[VERTICES] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 0, 1 },
                                               { 0, 0, 1 }, { 7, 7, 7 }, { 7, 7, 7 } };
    for ( int v = 0; v < VERTICES; ++v )
    {
        points[v] = START[v];
        points[v].y += v < 4 ? (float)frame : 0.0f;
    }
    if ( frame >= SPLIT )
    {
        points[4] = ( wisp_vec3 ){ 0.25f - (float)frame, (float)frame, 0.0f };
    }
}

static const char* record_tear( void** state, const char* name )
{
    const char* path = path_in( state, name );
    int32_t triangles[6];
    memcpy( triangles, WHOLE, sizeof triangles );
    const wisp_record_body body = { .name = "sheet",
                                    .triangles = triangles,
                                    .vertex_count = VERTICES,
                                    .triangle_count = 2,
                                    .triangles_change = true };
    const wisp_recorder_def def = { .bodies = &body, .body_count = 1, .dt = 0.5 };
    wisp_recorder* recorder = NULL;
    wisp_error error = { 0 };
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), WISP_OK );
    for ( int f = 0; f < FRAMES; ++f )
    {
        wisp_vec3 points[VERTICES];
        const wisp_vec3* all[1] = { points };
        place( f, points );
        memcpy( triangles, triangles_of( f ), sizeof triangles );
        assert_int_equal( wisp_recorder_frame( recorder, 0.5 * f, 0, all, &error ), WISP_OK );
        triangles[3] = VERTICES;
        assert_int_equal( wisp_recorder_frame( recorder, 0.5 * f + 0.25, 0, all, &error ), WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, "body sheet: triangle 1: got vertex 6, expected 0 .. 5" ) );
    }
    memset( triangles, 0, sizeof triangles ); // they are not needed any more
    assert_int_equal( wisp_recorder_close( recorder, &error ), WISP_OK );
    return path;
}

TEST_WITH( every_frame_of_our_own_format_has_its_triangles, make_folder, remove_folder )
{
    wisp_recording* recording = NULL;
    wisp_error error = { 0 };
    assert_int_equal( wisp_recording_open( record_tear( state, "x.wisp" ), &recording, &error ), WISP_OK );
    const wisp_record_body* body = wisp_recording_body( recording, 0 );
    assert_true( body->triangles_change );
    assert_memory_equal( body->triangles, WHOLE, sizeof WHOLE );
    static const int ORDER[] = { 3, 0, 2, 1 };
    for ( int i = 0; i < WISP_COUNT( ORDER ); ++i )
    {
        wisp_vec3 points[VERTICES], expected[VERTICES];
        wisp_vec3* all[1] = { points };
        assert_int_equal( wisp_recording_frame( recording, ORDER[i], all, NULL, NULL, &error ), WISP_OK );
        place( ORDER[i], expected );
        assert_memory_equal( points, expected, sizeof points );
        assert_memory_equal( body->triangles, triangles_of( ORDER[i] ), sizeof WHOLE );
        // a frame whose points are not asked for changes nothing
        assert_int_equal( wisp_recording_frame( recording, 3 - ORDER[i], NULL, NULL, NULL, &error ), WISP_OK );
        assert_memory_equal( body->triangles, triangles_of( ORDER[i] ), sizeof WHOLE );
    }
    wisp_recording_close( recording );
}

TEST_WITH( a_vertex_that_a_frame_does_not_have_is_refused_and_changes_nothing, make_folder, remove_folder )
{
    size_t size = 0;
    unsigned char* bytes = read_bytes( record_tear( state, "x.wisp" ), &size );
    wisp_recording* recording = NULL;
    wisp_error error = { 0 };
    assert_int_equal( wisp_recording_open_memory( bytes, size, "x.wisp", &recording, &error ), WISP_OK );
    const wisp_recording_info info = wisp_recording_describe( recording );
    wisp_recording_close( recording );
    // the last number before the checksum of frame 1
    put_number( bytes + info.first_byte + 2 * info.frame_bytes - 12, 0, 4, VERTICES );
    bad_recording_seal( bytes, size );
    assert_int_equal( wisp_recording_open_memory( bytes, size, "x.wisp", &recording, &error ), WISP_OK );
    wisp_vec3 points[VERTICES] = { { 0 } };
    wisp_vec3* all[1] = { points };
    assert_int_equal( wisp_recording_frame( recording, 1, all, NULL, NULL, &error ), WISP_BAD_INPUT );
    assert_non_null( strstr( error.message, "body sheet, triangle 1: got vertex 6, expected 0 .. 5" ) );
    assert_memory_equal( wisp_recording_body( recording, 0 )->triangles, WHOLE, sizeof WHOLE );
    assert_true( points[1].x == 0.0f );
    wisp_recording_close( recording );
    free( bytes );
}
