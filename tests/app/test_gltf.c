// glTF files: meshes joined and merged at seams, skins posed by hand, what is refused and by which element.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include "gltf.h"
#include "gltf_writer.h"

#include <math.h>
#include <unistd.h>

static gltf_bytes strip( void )
{
    char json[6000];
    gltf_strip_json( json, sizeof json, "" );
    const gltf_bytes binary = gltf_strip_binary();
    return gltf_binary_file( json, &binary );
}

static gltf_model read_strip( int flags )
{
    const gltf_bytes file = strip();
    gltf_model model;
    wisp_error error = { .status = WISP_OK };
    assert_ok( gltf_read_bytes( file.data, file.size, NULL, "strip.glb", flags, &model, &error ), error );
    return model;
}

static void assert_matrix( const double* got, const double expected[12] )
{
    for ( int i = 0; i < 12; ++i )
    {
        // the quarter turn of the file is rounded to single precision
        assert_true( fabs( got[i] - expected[i] ) < 1e-7 );
    }
}

// ---- meshes ----------------------------------------------------------------------------------------------------

TEST( primitives_are_joined_and_split_vertices_merged_where_place_and_weights_agree )
{
    gltf_model model = read_strip( 0 );
    const gltf_mesh* strip_mesh = &model.meshes[0];
    const int32_t triangles[] = { 0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2 };
    assert_int_equal( strip_mesh->primitive_count, 2 );
    assert_int_equal( strip_mesh->merged_count, 2 );
    assert_int_equal( strip_mesh->mesh.vertex_count, 6 );
    assert_memory_equal( strip_mesh->mesh.triangles, triangles, sizeof triangles );
    assert_int_equal( strip_mesh->mesh.uv_seam_count, 2 );
    assert_true( strip_mesh->mesh.uvs[2] == 1.0f && strip_mesh->mesh.uvs[3] == 0.75f );
    assert_true( strip_mesh->mesh.uvs[8] == 7.0f );
    assert_true( strip_mesh->mesh.colours[4].x == 0.4f && strip_mesh->mesh.colours[4].y == 1.0f );
    const float weights[] = { 0.5f, 0.5f, 0.0f, 0.0f };
    assert_memory_equal( strip_mesh->weights + 4, weights, sizeof weights );
    const int32_t last[] = { 1, 0, 0, 0 }; // the largest first, and no joint where there is no weight
    assert_memory_equal( strip_mesh->joints + 4 * 4, last, sizeof last );
    gltf_release( &model );
    model = read_strip( GLTF_KEEP_SEAMS );
    assert_int_equal( model.meshes[0].mesh.vertex_count, 8 );
    assert_int_equal( model.meshes[0].merged_count, 0 );
    gltf_release( &model );
}

TEST( vertices_of_equal_place_and_other_weights_stay_apart )
{
    char json[6000];
    gltf_strip_json( json, sizeof json, "" );
    gltf_bytes binary = gltf_strip_binary();
    // vertex 4 lies on vertex 1
    const float weights[4] = { 0.25f, 0.75f, 0.0f, 0.0f };
    memcpy( binary.data + STRIP_WEIGHTS + 4 * 16, weights, sizeof weights );
    const gltf_bytes file = gltf_binary_file( json, &binary );
    gltf_model model;
    assert_int_equal( gltf_read_bytes( file.data, file.size, NULL, "s.glb", 0, &model, NULL ), WISP_OK );
    assert_int_equal( model.meshes[0].merged_count, 1 );
    gltf_release( &model );
}

TEST( a_skinned_mesh_at_rest_is_placed_by_its_joints_and_not_by_its_node )
{
    gltf_model model = read_strip( 0 );
    wisp_mesh mesh;
    int node = -1;
    assert_int_equal( gltf_find_mesh( &model, NULL, "s.glb", &node, NULL ), WISP_OK );
    assert_int_equal( node, 0 );
    assert_int_equal( gltf_mesh_at_rest( &model, node, "s.glb", &mesh, NULL ), WISP_OK );
    const wisp_vec3 points[] = { { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 }, { 2, 0, 1 }, { 2, 1, 1 } };
    assert_memory_equal( mesh.points, points, sizeof points );
    wisp_mesh_release( &mesh );
    gltf_release( &model );
}

// ---- poses -----------------------------------------------------------------------------------------------------

TEST( poses_equal_those_computed_by_hand )
{
    gltf_model model = read_strip( 0 );
    assert_int_equal( gltf_find_animation( &model, "bend" ), 0 );
    assert_int_equal( gltf_find_animation( &model, "none" ), -1 );
    assert_true( model.animations[0].duration == 1.5 );
    double* work = malloc( gltf_pose_work( &model ) * sizeof *work );
    double m[24];
    // rest: both joints are shifted along z by the root
    gltf_pose( &model, 0, -1, 0.0, work, m );
    const double rest[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1 };
    assert_matrix( m, rest );
    assert_matrix( m + 12, rest );
    // before the first key: the spline puts the tip on the root, and its inverse bind shifts by -1
    gltf_pose( &model, 0, 0, 0.0, work, m );
    const double unit[12] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0 },
                 before[12] = { 1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 0 };
    assert_matrix( m, unit );
    assert_matrix( m + 12, before );
    // halfway: an eighth of a turn; Hermite of 0, slope 3, 1, slope 0 at 1/2 is 3/8 + 1/2; the step has not happened
    gltf_pose( &model, 0, 0, 1.0, work, m );
    const double c = sqrt( 0.5 ), middle[12] = { c, -c, 0, 0.875 - c, c, c, 0, -c, 0, 0, 1, 0 };
    assert_matrix( m, unit );
    assert_matrix( m + 12, middle );
    // after the last key: a quarter turn about the tip at (1, 2, 0)
    gltf_pose( &model, 0, 0, 9.0, work, m );
    const double moved[12] = { 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1, 0 },
                 after[12] = { 0, -1, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0 };
    assert_matrix( m, moved );
    assert_matrix( m + 12, after );
    free( work );
    gltf_release( &model );
}

TEST( rotations_take_the_shorter_way )
{
    char json[6000];
    gltf_strip_json( json, sizeof json, "" );
    gltf_bytes binary = gltf_strip_binary();
    // the same quarter turn with the other sign
    float* q = (float*)( binary.data + STRIP_ROTATIONS + 16 );
    q[2] = -q[2];
    q[3] = -q[3];
    const gltf_bytes file = gltf_binary_file( json, &binary );
    gltf_model model;
    assert_int_equal( gltf_read_bytes( file.data, file.size, NULL, "s.glb", 0, &model, NULL ), WISP_OK );
    double* work = malloc( gltf_pose_work( &model ) * sizeof *work );
    double m[24];
    gltf_pose( &model, 0, 0, 1.0, work, m );
    const double c = sqrt( 0.5 ), middle[12] = { c, -c, 0, 0.875 - c, c, c, 0, -c, 0, 0, 1, 0 };
    assert_matrix( m + 12, middle );
    free( work );
    gltf_release( &model );
}

// ---- files -----------------------------------------------------------------------------------------------------

TEST( a_mesh_of_a_file_is_taken_by_name )
{
    const gltf_bytes file = strip();
    FILE* out = fopen( "strip.glb", "wb" );
    assert_true( fwrite( file.data, 1, file.size, out ) == file.size && fclose( out ) == 0 );
    static const char* const good[] = { "strip.glb", "strip.glb#body", "strip.glb#strip" };
    wisp_error error = { .status = WISP_OK };
    wisp_mesh mesh;
    for ( int i = 0; i < WISP_COUNT( good ); ++i )
    {
        assert_ok( wisp_mesh_read( good[i], &mesh, &error ), error );
        assert_int_equal( mesh.vertex_count, 6 );
        wisp_mesh_release( &mesh );
    }
    assert_int_equal( wisp_mesh_read( "strip.glb#arm", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "strip.glb: got 0 nodes with the mesh 'arm', expected one of body" );
    assert_int_equal( wisp_mesh_read( "none.glb#arm", &mesh, &error ), WISP_IO_ERROR );
    remove( "strip.glb" );
}

TEST( a_gltf_text_reads_the_buffer_beside_it_and_no_other )
{
    const gltf_bytes binary = gltf_strip_binary();
    char json[6000];
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    FILE* out = fopen( "strip.bin", "wb" );
    assert_true( fwrite( binary.data, 1, binary.size, out ) == binary.size && fclose( out ) == 0 );
    static const struct
    {
        const char *buffer, *message;
    } cases[] = { { "\"uri\":\"strip.bin\",", NULL },
                  { "\"uri\":\"../strip.bin\",", "not in the folder" },
                  { "\"uri\":\"/etc/passwd\",", "" },
                  { "\"uri\":\"missing.bin\",", "missing.bin" } };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        gltf_strip_json( json, sizeof json, cases[i].buffer );
        out = fopen( "strip.gltf", "wb" );
        assert_true( fputs( json, out ) >= 0 && fclose( out ) == 0 );
        const wisp_status status = wisp_mesh_read( "strip.gltf", &mesh, &error );
        assert_int_equal( status, cases[i].message == NULL ? WISP_OK : WISP_BAD_INPUT );
        if ( cases[i].message != NULL )
        {
            assert_contains( error.message, cases[i].message );
        }
        wisp_mesh_release( &mesh );
    }
    remove( "strip.gltf" );
    remove( "strip.bin" );
}

TEST( the_description_names_skins_joints_animations_and_merged_vertices )
{
    gltf_model model = read_strip( 0 );
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_int_equal( gltf_info( stream, &model, "strip.glb" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "strip.glb: glTF, 3 nodes, 1 meshes, 1 skins, 1 animations\n" );
    assert_contains( text, "skin bones: 2 joints\n  joint 0: root\n  joint 1: tip, under root\n" );
    assert_contains( text, "animation bend: 1.5 s, 3 channels\n" );
    assert_contains( text, "strip.glb#body: open mesh of triangles\n" );
    assert_contains( text, "colours              red 0 .. 0.4" );
    assert_contains( text, "note: vertices of equal position and weights, merged: 2\n" );
    free( text );
    gltf_release( &model );
}

// ---- bad files -------------------------------------------------------------------------------------------------

typedef struct bad_gltf
{
    const char *from, *to; // of the JSON
    size_t at;             // in the binary part, with `value`
    float value;
    bool has_value;
    const char* message;
} bad_gltf;

#define EDIT( a, b, m )                                                                                              \
    {                                                                                                                \
        .from = a, .to = b, .message = m                                                                             \
    }
#define PATCH( where, v, m )                                                                                         \
    {                                                                                                                \
        .at = where, .value = v, .has_value = true, .message = m                                                     \
    }

static const bad_gltf bad[] = {
    PATCH( STRIP_POINTS + 16, NAN, "mesh 0: primitive 0: POSITION: accessor 0: value 1 is NaN" ),
    PATCH( STRIP_WEIGHTS + 16 * 3, 0.0f, "mesh 0: primitive 0: vertex 3: its weights sum to 0" ),
    PATCH( STRIP_WEIGHTS, -1.0f, "mesh 0: primitive 0: vertex 0: a weight is negative" ),
    PATCH( STRIP_MATRICES + 4, INFINITY, "skin 0: inverseBindMatrices: accessor 12: value 0 is infinite" ),
    PATCH( STRIP_TIMES + 4, 0.5f, "animation 0: channel 0: key 1 at 0.500000 s is not after the one before" ),
    PATCH( STRIP_ROTATIONS + 12, 0.0f, "animation 0: channel 0: key 0: the rotation is zero" ),
    // two indices of 65535
    PATCH( STRIP_INDICES + 4, NAN, "mesh 0: primitive 0: index 3: got vertex 32704, expected 0 .. 3" ),
    EDIT( "\"joints\":[1,2]", "\"joints\":[1]", "mesh 0: vertex 1: got joint 1, skin 0 has 1" ),
    EDIT( "\"joints\":[1,2]", "\"joints\":[1,9]", "skin 0: joint 1: got node 9, the file has 3" ),
    EDIT( "\"joints\":[1,2]", "\"joints\":[1,2,0]", "skin 0: got 2 inverse bind matrices, expected 3" ),
    EDIT( "\"children\":[2]", "\"children\":[1]", "node 1: it is its own ancestor" ),
    EDIT( "\"children\":[2]", "\"children\":[2,2]", "node 2: it has two parents, nodes 1 and 1" ),
    EDIT( "\"children\":[2]", "\"children\":[77]", "node 1: got child 77, the file has 3" ),
    EDIT( "\"mesh\":0", "\"mesh\":5", "node 0: got mesh 5, the file has 1" ),
    EDIT( "\"translation\":[7,7,7]", "\"translation\":[7,7]", "node 0: translation" ),
    EDIT( "\"indices\":10", "\"indices\":99", "primitive indices accessor out of bounds" ),
    EDIT( "\"count\":6,\"type\":\"SCALAR\"", "\"count\":2000000000,\"type\":\"SCALAR\"",
          "accessor 10: its 2000000000 values are not within the bytes of the file" ),
    EDIT( "\"count\":2,\"type\":\"MAT4\"", "\"count\":2,\"type\":\"VEC3\"", "accessor 12: got values of 3 numbers" ),
    EDIT( "\"count\":6,\"type\":\"VEC3\"", "\"count\":5,\"type\":\"VEC3\"",
          "animation 0: channel 2: got 5 values, expected 6, for 2 keys" ),
    EDIT( "CUBICSPLINE", "CUBICSPLINT", "got the interpolation CUBICSPLINT, expected STEP, LINEAR or CUBICSPLINE" ),
    EDIT( "{\"asset\":", "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\":",
          "the extension KHR_draco_mesh_compression is not read" ),
    EDIT( "{\"asset\":", "[\"asset\":", "" ),
    EDIT( "{\"asset\":", "{\"extras\":[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
          "nested at most 64" ),
};

TEST( bad_files_are_refused_by_element )
{
    for ( int i = 0; i < WISP_COUNT( bad ); ++i )
    {
        char json[6000], edited[7000];
        gltf_strip_json( json, sizeof json, "" );
        gltf_bytes binary = gltf_strip_binary();
        const char* found = bad[i].from != NULL ? strstr( json, bad[i].from ) : json;
        assert_non_null( found );
        snprintf( edited, sizeof edited, "%.*s%s%s", (int)( found - json ), json, bad[i].to != NULL ? bad[i].to : "",
                  found + ( bad[i].from != NULL ? strlen( bad[i].from ) : 0 ) );
        if ( bad[i].has_value )
        {
            memcpy( binary.data + bad[i].at, &bad[i].value, sizeof bad[i].value );
        }
        const gltf_bytes file = gltf_binary_file( edited, &binary );
        unsigned char* exact = malloc( file.size );
        memcpy( exact, file.data, file.size );
        gltf_model model;
        wisp_error error = { .status = WISP_OK };
        const wisp_status status = gltf_read_bytes( exact, file.size, NULL, "bad.glb", 0, &model, &error );
        free( exact );
        assert_int_equal( status, WISP_BAD_INPUT );
        assert_contains( error.message, "bad.glb: " );
        assert_contains( error.message, bad[i].message );
        assert_null( model.nodes );
    }
}

TEST( a_cut_file_is_refused_at_every_length )
{
    const gltf_bytes file = strip();
    for ( size_t size = 0; size < file.size; size += 1 + size / 40 )
    {
        unsigned char* exact = malloc( size > 0 ? size : 1 );
        memcpy( exact, file.data, size );
        gltf_model model;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( gltf_read_bytes( exact, size, NULL, "cut.glb", 0, &model, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, "cut.glb: " );
        free( exact );
    }
}

static int make_folder( void** state )
{
    static char path[] = "test-gltf-XXXXXX";
    *state = path;
    return mkdtemp( path ) != NULL && chdir( path ) == 0 ? 0 : -1;
}

static int remove_folder( void** state )
{
    return chdir( ".." ) == 0 ? rmdir( *state ) : -1;
}

TEST_GROUP( make_folder, remove_folder )
