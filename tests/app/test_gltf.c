// glTF files: meshes joined and merged at seams, skins posed by hand, what is refused and by which element. Morph targets:
// weights over time, sparse displacements, meshes by a path with a time or the name of a target. Recordings come back in
// tests/app/transcripts/scenes.t.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include "gltf_fixture.h"
#include "gltf_internal.h"

#include <unistd.h>

static void assert_matrix( const double* got, const double expected[12] )
{
    for ( int i = 0; i < 12; ++i )
    {
        // the quarter turn of the file is rounded to single precision
        assert_true( fabs( got[i] - expected[i] ) < 1e-7 );
    }
}

// ---- meshes ----

TEST( primitives_are_joined_and_split_vertices_merged_where_place_and_weights_agree )
{
    SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
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
    model = gltf_good( "strip.glb", "", "", GLTF_KEEP_SEAMS );
    assert_int_equal( model.meshes[0].mesh.vertex_count, 8 );
    assert_int_equal( model.meshes[0].merged_count, 0 );
}

TEST( vertices_of_equal_place_and_other_weights_stay_apart )
{
    gltf_parts parts = gltf_open( "strip.glb" );
    // vertex 4 lies on vertex 1
    const float weights[4] = { 0.25f, 0.75f, 0.0f, 0.0f };
    memcpy( parts.binary + STRIP_WEIGHTS + 4 * 16, weights, sizeof weights );
    SCOPED( gltf_release ) gltf_model model;
    assert_int_equal( gltf_read_parts( &parts, "s.glb", 0, &model, NULL ), WISP_OK );
    assert_int_equal( model.meshes[0].merged_count, 1 );
}

TEST( a_skinned_mesh_at_rest_is_placed_by_its_joints_and_not_by_its_node )
{
    SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    int node = -1;
    assert_int_equal( gltf_find_mesh( &model, NULL, "s.glb", &node, NULL ), WISP_OK );
    assert_int_equal( node, 0 );
    assert_int_equal( gltf_mesh_at_rest( &model, node, "s.glb", &mesh, NULL ), WISP_OK );
    const wisp_vec3 points[] = { { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 }, { 2, 0, 1 }, { 2, 1, 1 } };
    assert_memory_equal( mesh.points, points, sizeof points );
}

// ---- poses ----

TEST( poses_equal_those_computed_by_hand )
{
    SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
    assert_int_equal( gltf_find_animation( &model, "bend" ), 0 );
    assert_int_equal( gltf_find_animation( &model, "none" ), -1 );
    assert_true( model.animations[0].duration == 1.5 );
    SCOPED( free_local ) double* work = malloc( gltf_pose_work( &model ) * sizeof *work );
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
}

TEST( rotations_take_the_shorter_way )
{
    gltf_parts parts = gltf_open( "strip.glb" );
    // the same quarter turn with the other sign
    float* q = (float*)( parts.binary + STRIP_ROTATIONS + 16 );
    q[2] = -q[2];
    q[3] = -q[3];
    SCOPED( gltf_release ) gltf_model model;
    assert_int_equal( gltf_read_parts( &parts, "s.glb", 0, &model, NULL ), WISP_OK );
    SCOPED( free_local ) double* work = malloc( gltf_pose_work( &model ) * sizeof *work );
    double m[24];
    gltf_pose( &model, 0, 0, 1.0, work, m );
    const double c = sqrt( 0.5 ), middle[12] = { c, -c, 0, 0.875 - c, c, c, 0, -c, 0, 0, 1, 0 };
    assert_matrix( m + 12, middle );
}

// ---- files ----

TEST( a_mesh_of_a_file_is_taken_by_name )
{
#define STRIP WISP_SOURCE_ROOT "/tests/bad/gltf/strip.glb"
    static const char* const good[] = { STRIP, STRIP "#body", STRIP "#strip" };
    wisp_error error = { .status = WISP_OK };
    wisp_mesh mesh;
    for ( int i = 0; i < WISP_COUNT( good ); ++i )
    {
        assert_ok( wisp_mesh_read( good[i], &mesh, &error ), error );
        assert_int_equal( mesh.vertex_count, 6 );
        wisp_mesh_release( &mesh );
    }
    assert_int_equal( wisp_mesh_read( STRIP "#arm", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "strip.glb: got 0 nodes with the mesh 'arm', expected one of body" );
    assert_int_equal( wisp_mesh_read( "none.glb#arm", &mesh, &error ), WISP_IO_ERROR );
}

TEST( a_gltf_text_reads_the_buffer_beside_it_and_no_other )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    static const struct
    {
        const char *buffers, *message;
    } cases[] = { { "\"buffers\":[{\"uri\":\"strip.bin\",", NULL },
                  { "\"buffers\":[{\"uri\":\"../strip.bin\",", "not in the folder" },
                  { "\"buffers\":[{\"uri\":\"/etc/passwd\",", "" },
                  { "\"buffers\":[{\"uri\":\"missing.bin\",", "missing.bin" } };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        gltf_parts parts = gltf_open( "strip.glb" );
        gltf_edit( &parts, "\"buffers\":[{", cases[i].buffers );
        write_bytes( "strip.bin", parts.binary, parts.size );
        write_text( "strip.gltf", parts.json );
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
    SCOPED( gltf_release ) gltf_model model = gltf_good( "strip.glb", "", "", 0 );
    SCOPED( free_local ) char* text = NULL;
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
}

// ---- bad files ----

typedef struct bad_gltf
{
    const char *from, *to, *message;
    int at; // in the binary part, with `value`
    float value;
} bad_gltf;

static const bad_gltf bad_strips[] = {
    { "", "", "mesh 0: primitive 0: POSITION: accessor 0: value 1 is NaN", STRIP_POINTS + 16, NAN },
    { "", "", "mesh 0: primitive 0: vertex 3: its weights sum to 0", STRIP_WEIGHTS + 16 * 3, 0.0f },
    { "", "", "mesh 0: primitive 0: vertex 0: a weight is negative", STRIP_WEIGHTS, -1.0f },
    { "", "", "skin 0: inverseBindMatrices: accessor 12: value 0 is infinite", STRIP_MATRICES + 4, INFINITY },
    { "", "", "animation 0: channel 0: key 1 at 0.500000 s is not after the one before", STRIP_TIMES + 4, 0.5f },
    { "", "", "animation 0: channel 0: key 0: the rotation is zero", STRIP_ROTATIONS + 12, 0.0f },
    // two indices of 65535
    { "", "", "mesh 0: primitive 0: index 3: got vertex 32704, expected 0 .. 3", STRIP_INDICES + 4, NAN },
    { "\"joints\":[1,2]", "\"joints\":[1]", "mesh 0: vertex 1: got joint 1, skin 0 has 1", -1, 0 },
    { "\"joints\":[1,2]", "\"joints\":[1,9]", "skin 0: joint 1: got node 9, the file has 3", -1, 0 },
    { "\"joints\":[1,2]", "\"joints\":[1,2,0]", "skin 0: got 2 inverse bind matrices, expected 3", -1, 0 },
    { "\"children\":[2]", "\"children\":[1]", "node 1: it is its own ancestor", -1, 0 },
    { "\"children\":[2]", "\"children\":[2,2]", "node 2: it has two parents, nodes 1 and 1", -1, 0 },
    { "\"children\":[2]", "\"children\":[77]", "node 1: got child 77, the file has 3", -1, 0 },
    { "\"mesh\":0", "\"mesh\":5", "node 0: got mesh 5, the file has 1", -1, 0 },
    { "\"translation\":[7,7,7]", "\"translation\":[7,7]", "node 0: translation", -1, 0 },
    { "\"indices\":10", "\"indices\":99", "primitive indices accessor out of bounds", -1, 0 },
    { "\"count\":6,\"type\":\"SCALAR\"", "\"count\":2000000000,\"type\":\"SCALAR\"",
      "accessor 10: its 2000000000 values are not within the bytes of the file", -1, 0 },
    { "\"count\":2,\"type\":\"MAT4\"", "\"count\":2,\"type\":\"VEC3\"", "accessor 12: got values of 3 numbers", -1,
      0 },
    { "\"count\":6,\"type\":\"VEC3\"", "\"count\":5,\"type\":\"VEC3\"",
      "animation 0: channel 2: got 5 values, expected 6, for 2 keys", -1, 0 },
    { "CUBICSPLINE", "CUBICSPLINT", "got the interpolation CUBICSPLINT, expected STEP, LINEAR or CUBICSPLINE", -1,
      0 },
    { "{\"asset\":", "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\":",
      "the extension KHR_draco_mesh_compression is not read", -1, 0 },
    { "{\"asset\":", "[\"asset\":", "", -1, 0 },
    { "{\"asset\":", "{\"extras\":[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
      "nested at most 64", -1, 0 },
};

static const bad_gltf bad_quads[] = {
    { "\"byteOffset\":48,\"componentType\":5126,\"count\":4", "\"byteOffset\":48,\"componentType\":5126,\"count\":3",
      "mesh 0: primitive 0: target 0: accessor 2: got 3 values, expected 4, one for each vertex", -1, 0 },
    { "\"targets\":[{\"POSITION\":2}", "\"targets\":[{\"POSITION\":77}", "accessor", -1, 0 },
    { "\"sparse\":{\"count\":1", "\"sparse\":{\"count\":3", "its 3 sparse values are not within the bytes", -1, 0 },
    { "\"sparse\":{\"count\":1", "\"sparse\":{\"count\":5", "got sparse values of type", -1, 0 },
    { "\"byteOffset\":6,\"componentType\":5121", "\"byteOffset\":6,\"componentType\":5126", "indices of type 5126",
      -1, 0 },
    { "\"values\":{\"bufferView\":0,\"byteOffset\":96}", "\"values\":{\"bufferView\":0,\"byteOffset\":170}",
      "accessor 3: its 1 sparse values are not within the bytes of the file", -1, 0 },
    { "\"values\":{\"bufferView\":0,\"byteOffset\":96}", "\"values\":{\"bufferView\":9,\"byteOffset\":96}",
      "got buffer view 9", -1, 0 },
    { "\"indices\":{\"bufferView\":1,\"byteOffset\":6", "\"indices\":{\"bufferView\":0,\"byteOffset\":15",
      "sparse value 0 is of a vertex that the mesh does not have", -1, 0 },
    { "\"weights\":[0.5,0]", "\"weights\":[0.5]", "mesh 0: weights: got 1 numbers, expected 2", -1, 0 },
    { "\"output\":5", "\"output\":6", "animation 0: channel 0: got 12 weights, expected one for each of 2 keys and 2",
      -1, 0 },
    { "\"targets\":[{\"POSITION\":2},{\"POSITION\":3}]}]",
      "\"targets\":[{\"POSITION\":2},{\"POSITION\":3}]},{\"attributes\":{\"POSITION\":0},\"indices\":1}]",
      "mesh 0: primitive 1: got 0 morph targets, expected 2 as of the primitive before", -1, 0 },
};

static void demand_refusals( const char* name, const bad_gltf* bad, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        gltf_parts parts = gltf_open( name );
        gltf_model model;
        wisp_error error = { .status = WISP_OK };
        gltf_edit( &parts, bad[i].from, bad[i].to );
        memcpy( parts.binary + ( bad[i].at < 0 ? 0 : bad[i].at ), &bad[i].value,
                bad[i].at < 0 ? 0 : sizeof( float ) );
        if ( gltf_read_parts( &parts, "bad.glb", 0, &model, &error ) != WISP_BAD_INPUT ||
             strncmp( error.message, "bad.glb: ", 9 ) != 0 || strstr( error.message, bad[i].message ) == NULL )
        {
            fail_msg( "%s: '%s' has not '%s'", name, error.message, bad[i].message );
        }
        assert_null( model.nodes );
    }
}

TEST( bad_files_are_refused_by_element )
{
    demand_refusals( "strip.glb", bad_strips, WISP_COUNT( bad_strips ) );
    demand_refusals( "quad.glb", bad_quads, WISP_COUNT( bad_quads ) );
}

TEST( a_cut_file_is_refused_at_every_length )
{
    size_t whole;
    const gltf_parts parts = gltf_open( "strip.glb" );
    SCOPED( free_local ) unsigned char* file = gltf_file( &parts, &whole );
    for ( size_t size = 0; size < whole; size += 1 + size / 40 )
    {
        unsigned char* exact = malloc( size > 0 ? size : 1 );
        memcpy( exact, file, size );
        gltf_model model;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( gltf_read_bytes( exact, size, NULL, "cut.glb", 0, &model, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, "cut.glb: " );
        free( exact );
    }
}

// ---- morph targets ----

static wisp_vec3 place_of( const gltf_model* model, gltf_moment moment, int v )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_ok( gltf_mesh_at( model, 0, moment, "quad", &mesh, &error ), error );
    return mesh.points[v];
}

static void assert_place( wisp_vec3 p, double x, double y, double z )
{
    assert_true( fabs( (double)p.x - x ) < 1e-6 && fabs( (double)p.y - y ) < 1e-6 && fabs( (double)p.z - z ) < 1e-6 );
}

TEST( displacements_are_added_by_weights_and_placed_by_the_node )
{
    SCOPED( gltf_release ) gltf_model model = gltf_good( "quad.glb", "", "", 0 );
    assert_string_equal( model.meshes[0].target_names[0], "lift" );
    assert_string_equal( model.meshes[0].target_names[1], "target 1" );
    const gltf_moment rest = { -1, 0.0, -1 }, sparse = { -1, 0.0, 1 };
    assert_place( place_of( &model, rest, 2 ), 11, 1, 1.5 ); // half of target 0
    assert_place( place_of( &model, sparse, 2 ), 16, 7, 7 );
    assert_place( place_of( &model, sparse, 3 ), 10, 1, 0 );
    assert_place( place_of( &model, ( gltf_moment ){ 0, 0.0, -1 }, 2 ), 16, 7, 7 );
    assert_place( place_of( &model, ( gltf_moment ){ 0, 1.5, -1 }, 2 ), 11 + 0.75 * 5, 1 + 0.75 * 6,
                  0.25 * 3 + 0.75 * 7 );
    assert_place( place_of( &model, ( gltf_moment ){ 0, 9.0, -1 }, 1 ), 11, 0, 2 );
    assert_true( gltf_target_time( &model, 0, 0, 1 ) == 1.0 && gltf_target_time( &model, 0, 0, 0 ) == 3.0 );
    gltf_release( &model );
    model = gltf_good( "quad.glb", "\"translation\"", "\"weights\":[0,1],\"translation\"", 0 );
    assert_place( place_of( &model, rest, 2 ), 16, 7, 7 ); // those of the node come first
    gltf_release( &model );
    model = gltf_good( "quad.glb", "LINEAR", "STEP", 0 );
    assert_place( place_of( &model, ( gltf_moment ){ 0, 2.9, -1 }, 2 ), 16, 7, 7 );
    gltf_release( &model );
    model = gltf_good( "quad.glb", "\"output\":5,\"interpolation\":\"LINEAR\"",
                       "\"output\":6,\"interpolation\":\"CUBICSPLINE\"", 0 );
    // Hermite at the middle: dt / 8 of the first slope, half of the last value
    assert_place( place_of( &model, ( gltf_moment ){ 0, 2.0, -1 }, 1 ), 11, 0, 2 * ( 2.0 / 8.0 + 0.5 ) );
}

TEST( an_animation_moves_the_weights_of_its_node_alone )
{
    SCOPED( gltf_release )
    gltf_model model = gltf_good( "quad.glb", "\"nodes\":[", "\"nodes\":[{\"name\":\"other\",\"mesh\":0},", 0 );
    const gltf_moment then = { 0, 1.5, -1 };
    double weights[2][2];
    gltf_weights_at( &model, 0, then, weights[0] );
    gltf_weights_at( &model, 1, then, weights[1] );
    assert_true( weights[0][0] == 0.25 && weights[0][1] == 0.75 ); // the channel is that of node 0
    assert_true( weights[1][0] == 0.5 && weights[1][1] == 0.0 );   // at rest
    assert_true( gltf_target_time( &model, 0, 0, 1 ) == 1.0 && gltf_target_time( &model, 1, 0, 1 ) == -1.0 );
    // one target alone is shown whatever the time
    gltf_weights_at( &model, 0, ( gltf_moment ){ 0, 1.5, 0 }, weights[0] );
    assert_true( weights[0][0] == 1.0 && weights[0][1] == 0.0 );
}

TEST( a_frame_of_a_target_shows_it_alone )
{
    // weights (1, 1) and (0, 0)
    SCOPED( gltf_release ) gltf_model model = gltf_good( "quad.glb", "\"byteOffset\":116", "\"byteOffset\":120", 0 );
    assert_true( gltf_target_time( &model, 0, 0, 0 ) == -1.0 && gltf_target_time( &model, 0, 0, 1 ) == -1.0 );
    gltf_release( &model );
    // values of a spline are between its tangents
    model = gltf_good( "quad.glb", "\"output\":5,\"interpolation\":\"LINEAR\"",
                       "\"output\":6,\"interpolation\":\"CUBICSPLINE\"", 0 );
    assert_true( gltf_target_time( &model, 0, 0, 0 ) == 3.0 && gltf_target_time( &model, 0, 0, 1 ) == -1.0 );
}

TEST( weights_that_throw_vertices_out_of_all_numbers_are_refused )
{
    wisp_mesh mesh;
    wisp_error error = { 0 };
    SCOPED( gltf_release ) gltf_model model = gltf_good( "quad.glb", "[0.5,0]", "[3e38,0]", 0 );
    assert_int_equal( gltf_mesh_at_rest( &model, 0, "quad.glb", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: z is infinite" );
    assert_null( mesh.points );
}

// A name may have an @.
static wisp_mesh read_good( const char* path )
{
    wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_ok( wisp_mesh_read( path, &mesh, &error ), error );
    return mesh;
}

TEST( the_whole_name_of_a_mesh_goes_before_a_time )
{
    size_t size;
    gltf_parts parts = gltf_open( "quad.glb" );
    gltf_edit( &parts, "\"name\":\"quad\",\"mesh\"", "\"name\":\"quad@1\",\"mesh\"" );
    SCOPED( free_local ) unsigned char* file = gltf_file( &parts, &size );
    write_bytes( "morph_at.glb", file, size );
    wisp_mesh named = read_good( "morph_at.glb#quad@1" ), later = read_good( "morph_at.glb#quad@1@1" );
    assert_place( named.points[2], 11, 1, 1.5 ); // at rest
    assert_place( later.points[2], 16, 7, 7 );
    wisp_mesh_release( &named );
    wisp_mesh_release( &later );
    remove( "morph_at.glb" );
}

// Vertices 0, 1 and 2 are at one place; 2 moves as 0 does, 1 does not.
TEST( merged_vertices_take_their_displacements_along )
{
    static const wisp_vec3 points[] = { { 0, 0, 0 }, { 0, 0, 0 }, { 0, 0, 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
    static const int32_t triangles[] = { 0, 3, 4, 1, 3, 4, 2, 4, 3 }, merged[] = { 0, 2, 3, 1, 2, 3, 0, 3, 2 };
    static const float targets[] = { 1, 1, 1, 2, 2, 2, 1, 1, 1, 3, 3, 3, 4, 4, 4,
                                     5, 5, 5, 6, 6, 6, 5, 5, 5, 7, 7, 7, 8, 8, 8 },
                       kept[] = { 1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 6, 6, 6, 7, 7, 7, 8, 8, 8 };
    gltf_mesh mesh = { .mesh = fixture_mesh( points, 5, triangles, 3 ), .target_count = 2 };
    mesh.targets = malloc( sizeof targets );
    assert_non_null( mesh.targets );
    memcpy( mesh.targets, targets, sizeof targets );
    assert_int_equal( gltf_merge_seams( &mesh, "merged", NULL ), WISP_OK );
    assert_int_equal( mesh.merged_count, 1 );
    assert_int_equal( mesh.mesh.vertex_count, 4 );
    assert_memory_equal( mesh.mesh.triangles, merged, sizeof merged );
    assert_memory_equal( mesh.targets, kept, sizeof kept );
    free( mesh.targets );
    wisp_mesh_release( &mesh.mesh );
}

// A short file cannot ask for much memory by naming the same bytes again and again.
TEST( targets_of_the_same_bytes_are_bounded )
{
    char many[3000] = "\"targets\":[{\"POSITION\":2}";
    for ( int i = 0; i < 60; ++i )
    {
        strcat( many, ",{\"POSITION\":2}" );
    }
    const bad_gltf row = { "\"targets\":[{\"POSITION\":2}", many,
                           "its 62 morph targets are the same bytes again and again", -1, 0 };
    demand_refusals( "quad.glb", &row, 1 );
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
