// Recordings as binary glTF, read here by a strict reader written from the specification (Khronos 2021): chunks, JSON,
// accessors and their bounds, morph targets and the animation. ./dev readers has those of other people. Recordings of a mesh
// that tears: a square of two triangles whose corner 0 is split in frame 2, so that the second triangle gets vertex 4 there.
// Vertex 5 is never used.
#include "folder_fixture.h"
#include "record_text_fixture.h"

#include "../bad/bad_recordings.h"
#include "gltf.h"
#include "record.h"

#include <jansson.h>

enum
{
    SIDE = 3,
    SHEET_VERTICES = SIDE * SIDE,
    SHEET_TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
    FRAMES = 4,
};

// A sheet, strands of 3, 1 and 2 vertices, and a static triangle.
static int32_t sheet_triangles[3 * SHEET_TRIANGLES];
static const int32_t strand_offsets[] = { 0, 3, 4, 6 };
static const wisp_vec3 strand_colours[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 },
                                            { 0, 0, 1 }, { 1, 1, 0 }, { 1, 1, 1 } };
static const int32_t triangle[] = { 0, 1, 2 };

typedef struct sample
{
    wisp_vec3 sheet[SHEET_VERTICES], strands[6], ground[3];
} sample;

static void make_bodies( wisp_record_body* bodies )
{
    int32_t* corner = sheet_triangles;
    for ( int j = 0; j + 1 < SIDE; ++j )
    {
        for ( int i = 0; i + 1 < SIDE; ++i )
        {
            const int a = j * SIDE + i;
            const int32_t two[6] = { a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE };
            memcpy( corner, two, sizeof two );
            corner += 6;
        }
    }
    bodies[0] = ( wisp_record_body ){ .name = "sheet",
                                      .triangles = sheet_triangles,
                                      .vertex_count = SHEET_VERTICES,
                                      .triangle_count = SHEET_TRIANGLES,
                                      .base_colour = { 0.5f, 0.25f, 0.75f } };
    bodies[1] = ( wisp_record_body ){
        .name = "hair", .offsets = strand_offsets, .vertex_count = 6, .strand_count = 3, .colours = strand_colours
    };
    bodies[2] = ( wisp_record_body ){
        .name = "ground", .triangles = triangle, .vertex_count = 3, .triangle_count = 1, .is_static = true
    };
}

static sample points_of( int f )
{
    sample s = { .ground = { { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, -1 } } };
    for ( int v = 0; v < SHEET_VERTICES; ++v )
    {
        s.sheet[v] = ( wisp_vec3 ){ 0.1f * (float)( v % SIDE ) + 0.013f * (float)f, 1.0f / 3.0f * (float)( v / SIDE ),
                                    sinf( 0.7f * (float)( v + f ) ) };
    }
    for ( int v = 0; v < 6; ++v )
    {
        s.strands[v] = ( wisp_vec3 ){ 0.1f, -0.3f * (float)v, 0.02f * (float)( f * v ) };
    }
    return s;
}

static wisp_recorder_def def_of( const wisp_record_body* bodies )
{
    return ( wisp_recorder_def ){ .bodies = bodies, .body_count = 3, .dt = 1.0 / 60.0 };
}

static wisp_status add( wisp_recorder* recorder, int f, wisp_error* error )
{
    const sample s = points_of( f );
    const wisp_vec3* points[] = { s.sheet, s.strands, s.ground };
    return wisp_recorder_frame( recorder, f / 60.0, 0, points, error );
}

// ---- a reader ----

typedef struct glb
{
    char* file;
    size_t size;
    json_t* json;
    const unsigned char* binary; // null: there is none
    size_t binary_size;
} glb;

static glb open_glb( const char* path )
{
    glb g = { 0 };
    g.file = read_bytes( path, &g.size );
    const unsigned char* bytes = (unsigned char*)g.file;
    assert_memory_equal( bytes, "glTF", 4 );
    assert_int_equal( get_u32( bytes + 4 ), 2 );
    assert_int_equal( get_u32( bytes + 8 ), g.size );
    const uint32_t json = get_u32( bytes + 12 );
    assert_memory_equal( bytes + 16, "JSON", 4 );
    assert_int_equal( json % 4, 0 );
    json_error_t why;
    g.json = json_loadb( g.file + 20, json, JSON_REJECT_DUPLICATES, &why );
    if ( g.json == NULL )
    {
        fail_msg( "byte %d: %s", why.position, why.text );
    }
    if ( g.size > 20 + json )
    {
        g.binary = bytes + 20 + json + 8;
        g.binary_size = get_u32( g.binary - 8 );
        assert_memory_equal( g.binary - 4, "BIN\0", 4 );
        assert_int_equal( g.binary_size % 4, 0 );
        assert_int_equal( 20 + json + 8 + g.binary_size, g.size );
    }
    return g;
}

static void close_glb( glb* g )
{
    json_decref( g->json );
    free( g->file );
}

static json_t* item( json_t* from, const char* key, int index )
{
    json_t* found = json_array_get( json_object_get( from, key ), (size_t)index );
    assert_non_null( found );
    return found;
}

static int number( json_t* from, const char* key )
{
    json_t* found = json_object_get( from, key );
    assert_true( json_is_integer( found ) );
    return (int)json_integer_value( found );
}

// The bytes of an accessor, which must be inside its view, and the view inside the buffer.
static const unsigned char* accessor( const glb* g, int index, const char* type, int component, int count )
{
    json_t* a = item( g->json, "accessors", index );
    assert_string_equal( json_string_value( json_object_get( a, "type" ) ), type );
    assert_int_equal( number( a, "componentType" ), component );
    assert_int_equal( number( a, "count" ), count );
    json_t* view = item( g->json, "bufferViews", number( a, "bufferView" ) );
    const int at = json_object_get( a, "byteOffset" ) != NULL ? number( a, "byteOffset" ) : 0;
    const int size = count * ( strcmp( type, "VEC3" ) == 0 ? 12 : 4 );
    assert_int_equal( at % 4, 0 );
    assert_true( at + size <= number( view, "byteLength" ) );
    assert_true( number( view, "byteOffset" ) + number( view, "byteLength" ) <= (int)g->binary_size );
    return g->binary + number( view, "byteOffset" ) + at;
}

static void read_vectors( const glb* g, int index, int count, wisp_vec3* out )
{
    const unsigned char* at = accessor( g, index, "VEC3", 5126, count );
    for ( int v = 0; v < count; ++v )
    {
        out[v] =
            ( wisp_vec3 ){ get_float( at + 12 * v ), get_float( at + 12 * v + 4 ), get_float( at + 12 * v + 8 ) };
    }
}

// The bounds of positions are part of the file and exact.
static void assert_bounds( const glb* g, int index, const wisp_vec3* points, int count )
{
    json_t* a = item( g->json, "accessors", index );
    for ( int k = 0; k < 3; ++k )
    {
        float least = FLT_MAX, most = -FLT_MAX;
        for ( int v = 0; v < count; ++v )
        {
            const float x = ( &points[v].x )[k];
            least = fminf( least, x );
            most = fmaxf( most, x );
        }
        assert_true( (float)json_number_value( item( a, "min", k ) ) == least );
        assert_true( (float)json_number_value( item( a, "max", k ) ) == most );
    }
}

static json_t* primitive( const glb* g, int body )
{
    return item( item( g->json, "meshes", body ), "primitives", 0 );
}

// ---- tests ----

static glb record( const char* path, int frame_count )
{
    wisp_record_body bodies[3];
    make_bodies( bodies );
    const wisp_recorder_def def = def_of( bodies );
    wisp_error error = { .status = WISP_OK };
    wisp_recorder* recorder = NULL;
    assert_ok( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, &error ), error );
    for ( int f = 0; f < frame_count; ++f )
    {
        assert_ok( add( recorder, f, &error ), error );
    }
    assert_ok( wisp_recorder_close( recorder, &error ), error );
    return open_glb( path );
}

// A point plus its displacement, as a reader adds them.
static void assert_sum( wisp_vec3 base, wisp_vec3 moved, wisp_vec3 expected )
{
    for ( int k = 0; k < 3; ++k )
    {
        const float a = ( &base.x )[k], d = ( &moved.x )[k], e = ( &expected.x )[k];
        // the difference is rounded once and the sum once, each by half of an epsilon of what it is at most
        const float largest = fabsf( a ) + fabsf( d ) + fabsf( e );
        assert_true( fabsf( a + d - e ) <= FLT_EPSILON * largest );
    }
}

TEST_IN_FOLDER( points_plus_targets_are_the_points_of_every_frame )
{
    SCOPED( close_glb ) glb g = record( path_in( state, "a.glb" ), FRAMES );
    assert_int_equal( count_files( state ), 1 );
    for ( int body = 0; body < 2; ++body )
    {
        const int count = body == 0 ? SHEET_VERTICES : 6;
        json_t* p = primitive( &g, body );
        wisp_vec3 base[SHEET_VERTICES], moved[SHEET_VERTICES];
        const int at = number( json_object_get( p, "attributes" ), "POSITION" );
        read_vectors( &g, at, count, base );
        assert_bounds( &g, at, base, count );
        assert_int_equal( json_array_size( json_object_get( p, "targets" ) ), FRAMES - 1 );
        for ( int f = 0; f < FRAMES; ++f )
        {
            const sample s = points_of( f );
            const wisp_vec3* expected = body == 0 ? s.sheet : s.strands;
            memset( moved, 0, sizeof moved );
            if ( f > 0 )
            {
                const int target = number( item( p, "targets", f - 1 ), "POSITION" );
                read_vectors( &g, target, count, moved );
                assert_bounds( &g, target, moved, count );
            }
            for ( int v = 0; v < count; ++v )
            {
                assert_sum( base[v], moved[v], expected[v] );
            }
        }
    }
}

static wisp_vec3 normal_of_corner( const wisp_vec3* points, const int32_t* corner )
{
    const wisp_vec3 a = points[corner[0]], b = points[corner[1]], c = points[corner[2]];
    const wisp_vec3 p = { b.x - a.x, b.y - a.y, b.z - a.z }, q = { c.x - a.x, c.y - a.y, c.z - a.z };
    return ( wisp_vec3 ){ p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x };
}

TEST_IN_FOLDER( normals_have_targets_too )
{
    SCOPED( close_glb ) glb g = record( path_in( state, "a.glb" ), FRAMES );
    json_t* p = primitive( &g, 0 );
    wisp_vec3 base[SHEET_VERTICES], turned[SHEET_VERTICES];
    read_vectors( &g, number( json_object_get( p, "attributes" ), "NORMAL" ), SHEET_VERTICES, base );
    read_vectors( &g, number( item( p, "targets", FRAMES - 2 ), "NORMAL" ), SHEET_VERTICES, turned );
    const sample s = points_of( FRAMES - 1 );
    for ( int v = 0; v < SHEET_VERTICES; ++v )
    {
        assert_float_equal( base[v].x * base[v].x + base[v].y * base[v].y + base[v].z * base[v].z, 1.0, 4e-7 );
        wisp_vec3 sum = { 0, 0, 0 };
        for ( int t = 0; t < SHEET_TRIANGLES; ++t )
        {
            for ( int k = 0; k < 3; ++k )
            {
                const wisp_vec3 n = normal_of_corner( s.sheet, sheet_triangles + 3 * t );
                const float weight = sheet_triangles[3 * t + k] == v ? 1.0f : 0.0f;
                sum = ( wisp_vec3 ){ sum.x + weight * n.x, sum.y + weight * n.y, sum.z + weight * n.z };
            }
        }
        const float length = sqrtf( sum.x * sum.x + sum.y * sum.y + sum.z * sum.z );
        // a few roundings of single precision here, one there
        assert_float_equal( base[v].x + turned[v].x, sum.x / length, 2e-6 );
        assert_float_equal( base[v].y + turned[v].y, sum.y / length, 2e-6 );
        assert_float_equal( base[v].z + turned[v].z, sum.z / length, 2e-6 );
    }
}

TEST_IN_FOLDER( one_weight_after_the_other_is_1_at_the_times_of_the_frames )
{
    SCOPED( close_glb ) glb g = record( path_in( state, "a.glb" ), FRAMES );
    json_t* animation = item( g.json, "animations", 0 );
    json_t* sampler = item( animation, "samplers", 0 );
    assert_int_equal( json_array_size( json_object_get( animation, "channels" ) ), 2 );
    assert_string_equal( json_string_value( json_object_get( sampler, "interpolation" ) ), "LINEAR" );
    const unsigned char* times = accessor( &g, number( sampler, "input" ), "SCALAR", 5126, FRAMES );
    const unsigned char* weights =
        accessor( &g, number( sampler, "output" ), "SCALAR", 5126, FRAMES * ( FRAMES - 1 ) );
    for ( int f = 0; f < FRAMES; ++f )
    {
        assert_true( get_float( times + 4 * f ) == (float)( f / 60.0 ) );
        for ( int t = 0; t < FRAMES - 1; ++t )
        {
            const float expected = f > 0 && t == f - 1 ? 1.0f : 0.0f;
            assert_true( get_float( weights + 4 * ( f * ( FRAMES - 1 ) + t ) ) == expected );
        }
    }
    json_t* a = item( g.json, "accessors", number( sampler, "input" ) );
    assert_true( (float)json_number_value( item( a, "max", 0 ) ) == (float)( ( FRAMES - 1 ) / 60.0 ) );
}

TEST_IN_FOLDER( strands_are_lines_with_colours_and_a_static_body_has_no_targets )
{
    static const int ends[] = { 0, 1, 1, 2, 4, 5 };
    SCOPED( close_glb ) glb g = record( path_in( state, "a.glb" ), FRAMES );
    json_t *hair = primitive( &g, 1 ), *ground = primitive( &g, 2 ), *sheet = primitive( &g, 0 );
    assert_int_equal( number( sheet, "mode" ), 4 );
    assert_int_equal( number( hair, "mode" ), 1 );
    const unsigned char* indices = accessor( &g, number( hair, "indices" ), "SCALAR", 5125, 6 );
    for ( int i = 0; i < 6; ++i )
    {
        assert_int_equal( get_u32( indices + 4 * i ), ends[i] );
    }
    wisp_vec3 colours[6];
    read_vectors( &g, number( json_object_get( hair, "attributes" ), "COLOR_0" ), 6, colours );
    assert_memory_equal( colours, strand_colours, sizeof colours );
    assert_null( json_object_get( json_object_get( hair, "attributes" ), "NORMAL" ) );
    assert_null( json_object_get( ground, "targets" ) );
    json_t* material =
        json_object_get( item( g.json, "materials", number( sheet, "material" ) ), "pbrMetallicRoughness" );
    const double colour[] = { 0.5, 0.25, 0.75, 1.0 };
    for ( int k = 0; k < 4; ++k )
    {
        assert_true( json_number_value( item( material, "baseColorFactor", k ) ) == colour[k] );
    }
}

TEST_IN_FOLDER( one_frame_has_no_animation_and_none_no_meshes )
{
    SCOPED( close_glb ) glb g = record( path_in( state, "a.glb" ), 1 );
    assert_null( json_object_get( g.json, "animations" ) );
    assert_int_equal( json_array_size( json_object_get( g.json, "meshes" ) ), 3 );
    close_glb( &g );
    g = record( path_in( state, "a.glb" ), 0 );
    assert_null( json_object_get( g.json, "meshes" ) );
    assert_null( g.binary );
    assert_non_null( json_object_get( g.json, "asset" ) );
}

TEST_IN_FOLDER( vertices_whose_triangles_cancel_have_a_unit_normal )
{
    static const int32_t both[] = { 0, 1, 2, 0, 2, 1 };
    const wisp_record_body body = { .name = "m", .triangles = both, .vertex_count = 3, .triangle_count = 2 };
    const wisp_recorder_def def = { .bodies = &body, .body_count = 1, .dt = 1.0 };
    const sample s = points_of( 0 );
    const wisp_vec3* points[] = { s.ground };
    wisp_recorder* recorder = NULL;
    char* path = path_in( state, "a.glb" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    assert_int_equal( wisp_recorder_frame( recorder, 0.0, 0, points, NULL ), WISP_OK );
    assert_int_equal( wisp_recorder_close( recorder, NULL ), WISP_OK );
    SCOPED( close_glb ) glb g = open_glb( path );
    wisp_vec3 normals[3];
    read_vectors( &g, number( json_object_get( primitive( &g, 0 ), "attributes" ), "NORMAL" ), 3, normals );
    assert_true( normals[1].x == 0.0f && normals[1].y == 1.0f && normals[1].z == 0.0f );
}

// ---- limits ----

TEST_IN_FOLDER( more_frames_than_fit_are_refused_before_the_first )
{
    wisp_record_body bodies[3];
    make_bodies( bodies );
    wisp_recorder_def def = def_of( bodies );
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
    wisp_record_body bodies[3];
    make_bodies( bodies );
    const wisp_recorder_def def = def_of( bodies );
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.glb" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    for ( int f = 0; f < WISP_RECORD_GLB_MAX_FRAMES; ++f )
    {
        assert_ok( add( recorder, f, &error ), error );
    }
    assert_int_equal( add( recorder, WISP_RECORD_GLB_MAX_FRAMES, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: a .glb file of these bodies ends after 1000 frames" );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
    SCOPED( close_glb ) glb g = open_glb( path );
    assert_int_equal( json_array_size( json_object_get( primitive( &g, 0 ), "targets" ) ), 999 );
}

TEST_IN_FOLDER( times_and_points_that_the_format_cannot_hold_are_refused )
{
    wisp_record_body bodies[3];
    make_bodies( bodies );
    const wisp_recorder_def def = def_of( bodies );
    wisp_recorder* recorder = NULL;
    wisp_error error = { .status = WISP_OK };
    char* path = path_in( state, "a.glb" );
    assert_int_equal( wisp_recorder_open( path, WISP_RECORD_BY_NAME, &def, &recorder, NULL ), WISP_OK );
    sample s = points_of( 0 );
    const wisp_vec3* points[] = { s.sheet, s.strands, s.ground };
    assert_int_equal( wisp_recorder_frame( recorder, -1.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 0: got time -1 s, expected at least 0" );
    assert_ok( wisp_recorder_frame( recorder, 1.0, 0, points, &error ), error );
    assert_int_equal( wisp_recorder_frame( recorder, 1.0 + 1e-9, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 1: got time 1 s" );
    s.strands[4].y = -3e38f;
    assert_int_equal( wisp_recorder_frame( recorder, 2.0, 0, points, &error ), WISP_BAD_INPUT );
    assert_one_message( &error, WISP_BAD_INPUT, "a.glb: frame 1: body hair, vertex 4 is too far from the origin" );
    assert_ok( wisp_recorder_close( recorder, &error ), error );
}

// ---- a mesh that tears ----

enum
{
    VERTICES = 6,
    SPLIT = 2, // first frame with vertex 4
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

static char* text_of( const char* path )
{
    size_t size = 0;
    unsigned char* bytes = read_bytes( path, &size );
    char* text = realloc( bytes, size + 1 );
    assert_non_null( text );
    text[size] = 0;
    return text;
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

TEST_WITH( obj_files_have_the_triangles_of_their_frames, make_folder, remove_folder )
{
    record_tear( state, "x.obj" );
    SCOPED( free_local ) char* text = text_of( path_in( state, "x_0002.obj" ) );
    assert_non_null( strstr( text, "f 1 3 4\n" ) );
    free( text );
    text = text_of( path_in( state, "x_0003.obj" ) );
    assert_non_null( strstr( text, "f 5 3 4\n" ) );
}

// Vertex 4 was where vertex 0 was in the frame before: it rose by 1 m and went 1.75 m sideways in half a second.
TEST_WITH( usd_has_a_sample_of_the_triangles_per_frame, make_folder, remove_folder )
{
    SCOPED( free_local ) char* text = text_of( record_tear( state, "x.usda" ) );
    assert_non_null( strstr( text, "        int[] faceVertexIndices.timeSamples = {\n"
                                   "            0: [0, 1, 2, 0, 2, 3],\n"
                                   "            1: [0, 1, 2, 0, 2, 3],\n"
                                   "            2: [0, 1, 2, 4, 2, 3],\n"
                                   "            3: [0, 1, 2, 4, 2, 3],\n"
                                   "        }\n" ) );
    assert_null( strstr( text, "int[] faceVertexIndices = [" ) );
    assert_non_null(
        strstr( text, "            2: [(0, 2, 0), (0, 2, 0), (0, 2, 0), (0, 2, 0), (-3.5, 2, 0), (0, 0, 0)],\n" ) );
    assert_non_null(
        strstr( text, "            3: [(0, 2, 0), (0, 2, 0), (0, 2, 0), (0, 2, 0), (-2, 2, 0), (0, 0, 0)],\n" ) );
}

// Unit normals of a level triangle point up or down; split off, the second one is level too.
TEST_WITH( glb_has_all_corners_in_their_places_with_the_triangles_of_the_last_frame, make_folder, remove_folder )
{
    const char* path = record_tear( state, "x.glb" );
    SCOPED( gltf_release ) gltf_model model = { 0 };
    wisp_error error = { 0 };
    int node = 0;
    char named[600];
    snprintf( named, sizeof named, "%s#sheet", path );
    assert_int_equal( gltf_model_read( named, &model, &node, &error ), WISP_OK );
    const wisp_mesh* mesh = &model.meshes[model.nodes[node].mesh].mesh;
    assert_int_equal( mesh->triangle_count, 2 );
    assert_int_not_equal( mesh->triangles[0], mesh->triangles[3] );
    for ( int f = 0; f < FRAMES; ++f )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh frame = { 0 };
        wisp_vec3 points[VERTICES];
        place( f, points );
        snprintf( named, sizeof named, "%s#sheet@%g", path, 0.5 * f );
        assert_int_equal( wisp_mesh_read( named, &frame, &error ), WISP_OK );
        for ( int i = 0; i < 6; ++i )
        {
            const wisp_vec3 p = frame.points[frame.triangles[i]], q = points[triangles_of( f )[i]];
            assert_true( fabsf( p.x - q.x ) + fabsf( p.y - q.y ) + fabsf( p.z - q.z ) < 1e-6f );
        }
    }
}
