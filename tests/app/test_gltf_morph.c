// Morph targets of glTF files: recordings that come back, weights over time, sparse displacements, meshes by a path with a time
// or the name of a target, what is refused.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include "files.h"

#include "gltf_internal.h"
#include "gltf_writer.h"
#include "record.h"

#include <math.h>

// ---- recordings ------------------------------------------------------------------------------------------------

enum
{
    SIDE = 6,
    VERTICES = SIDE * SIDE,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
    FRAMES = 7,
};

static const char TAKE[] = "morph_take.glb";

// Of numbers with all their digits. The first two vertices start at one place and part.
static wisp_vec3 recorded( int frame, int v )
{
    const int from = frame == 0 && v == 1 ? 0 : v;
    return ( wisp_vec3 ){ 0.1f * (float)( from % SIDE ) + 0.0137f * (float)frame,
                          1.0f / 3.0f * (float)( from / SIDE ) - 0.001f * (float)( frame * frame ),
                          sinf( 0.7f * (float)( from + frame ) ) };
}

static double time_of( int frame )
{
    return 0.25 * frame; // no rounding in single precision
}

static int write_take( void** state )
{
    (void)state;
    static int32_t triangles[3 * TRIANGLES];
    static const int32_t triangle[] = { 0, 1, 2 }, offsets[] = { 0, 2, 3 };
    int32_t* corner = triangles;
    for ( int c = 0; c < ( SIDE - 1 ) * ( SIDE - 1 ); ++c, corner += 6 )
    {
        const int a = c / ( SIDE - 1 ) * SIDE + c % ( SIDE - 1 );
        const int32_t two[6] = { a, a + 1, a + SIDE, a + 1, a + SIDE + 1, a + SIDE };
        memcpy( corner, two, sizeof two );
    }
    const wisp_record_body bodies[] = {
        { .name = "hair", .offsets = offsets, .vertex_count = 3, .strand_count = 2 },
        { .name = "sheet", .triangles = triangles, .vertex_count = VERTICES, .triangle_count = TRIANGLES },
        { .name = "ground", .triangles = triangle, .vertex_count = 3, .triangle_count = 1, .is_static = true },
        { .name = "twin", .triangles = triangles, .vertex_count = VERTICES, .triangle_count = TRIANGLES },
    };
    const wisp_recorder_def def = { .bodies = bodies, .body_count = 4, .dt = 0.25 };
    wisp_recorder* recorder;
    wisp_error error = { 0 };
    assert_ok( wisp_recorder_open( TAKE, WISP_RECORD_BY_NAME, &def, &recorder, &error ), error );
    for ( int f = 0; f < FRAMES; ++f )
    {
        wisp_vec3 sheet[VERTICES], twin[VERTICES], hair[3], ground[3] = { { 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
        for ( int v = 0; v < VERTICES; ++v )
        {
            sheet[v] = recorded( f, v );
            twin[v] = recorded( 2 * f, v );
        }
        for ( int v = 0; v < 3; ++v )
        {
            hair[v] = ( wisp_vec3 ){ (float)v, (float)f, 0.0f };
        }
        const wisp_vec3* points[] = { hair, sheet, ground, twin };
        assert_ok( wisp_recorder_frame( recorder, time_of( f ), 0, points, &error ), error );
    }
    assert_ok( wisp_recorder_close( recorder, &error ), error );
    return 0;
}

static int remove_take( void** state )
{
    (void)state;
    return remove( TAKE );
}

// What a file holds of a coordinate at a weight: the sum in double precision of what is rounded to single.
static double held( float first, float then, double weight )
{
    return (double)first + weight * (double)( then - first );
}

static void assert_frame( const wisp_mesh* mesh, int frame, int next, double weight )
{
    assert_int_equal( mesh->vertex_count, VERTICES );
    assert_int_equal( mesh->triangle_count, TRIANGLES );
    double error = 0.0;
    for ( int v = 0; v < VERTICES; ++v )
    {
        const wisp_vec3 o = recorded( 0, v ), a = recorded( frame, v ), b = recorded( next, v ), p = mesh->points[v];
        const float first[3] = { o.x, o.y, o.z }, from[3] = { a.x, a.y, a.z }, to[3] = { b.x, b.y, b.z },
                    got[3] = { p.x, p.y, p.z };
        for ( int k = 0; k < 3; ++k )
        {
            const double expected =
                held( first[k], from[k], 1.0 - weight ) + held( first[k], to[k], weight ) - (double)first[k];
            assert_true( fabs( (double)got[k] - expected ) <= 6e-8 * ( 1.0 + fabs( expected ) ) );
            const double true_place = ( 1.0 - weight ) * (double)from[k] + weight * (double)to[k];
            error = fmax( error, fabs( (double)got[k] - true_place ) );
        }
    }
    assert_true( error < 2.5e-7 ); // of coordinates up to 2: displacements are rounded, and their sum
}

static wisp_mesh read_good( const char* path )
{
    wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_ok( wisp_mesh_read( path, &mesh, &error ), error );
    return mesh;
}

TEST( every_frame_of_a_recording_is_read_back_by_name_and_by_time )
{
    for ( int f = 0; f < FRAMES; ++f )
    {
        char path[100];
        snprintf( path, sizeof path, "%s#sheet@%g", TAKE, time_of( f ) );
        wisp_mesh at_time = read_good( path );
        assert_frame( &at_time, f, f, 0.0 );
        snprintf( path, sizeof path, f == 0 ? "%s#sheet" : "%s#sheet@frame_%04d", TAKE, f + 1 );
        wisp_mesh by_name = read_good( path );
        assert_same_mesh( &at_time, &by_name );
        wisp_mesh_release( &at_time );
        wisp_mesh_release( &by_name );
    }
    wisp_mesh between = read_good( "morph_take.glb#sheet@0.8125" );
    assert_frame( &between, 3, 4, 0.25 );
    wisp_mesh_release( &between );
    wisp_mesh late = read_good( "morph_take.glb#sheet@1e3" );
    assert_frame( &late, FRAMES - 1, FRAMES - 1, 0.0 );
    wisp_mesh_release( &late );
    // another body by the same weights
    wisp_mesh twin = read_good( "morph_take.glb#twin@0.5" );
    assert_true( fabsf( twin.points[9].z - recorded( 4, 9 ).z ) < 2.5e-7f );
    wisp_mesh_release( &twin );
    wisp_mesh still = read_good( "morph_take.glb#ground@1" );
    assert_int_equal( still.vertex_count, 3 );
    wisp_mesh_release( &still );
}

TEST( the_description_lists_targets_and_their_frames )
{
    gltf_model model;
    wisp_error error = { 0 };
    char text[8000] = "";
    FILE* stream = fmemopen( text, sizeof text, "w" );
    assert_ok( gltf_read( TAKE, 0, &model, &error ), error );
    assert_int_equal( gltf_info( stream, &model, "take.glb" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "  mesh sheet of 1 primitive\n  morph targets: 6\n    target 0, frame_0002, at 0.25 s\n"
                           "    target 1, frame_0003, at 0.5 s\n" );
    assert_contains( text, "    target 5, frame_0007, at 1.5 s\n" );
    assert_contains( text, "animation recording: 1.5 s, 2 channels\n" );
    assert_true( model.animations[0].weights[1].is_shared && !model.animations[0].weights[0].is_shared );
    gltf_release( &model );
}

#define ZEROS "00000000000000000000000000000000"

TEST( paths_that_ask_for_what_is_not_there_are_refused )
{
    static const char* const BAD[][2] = {
        { "morph_take.glb#sheet@frame_0001", "morph_take.glb: got 'frame_0001' behind @, expected a time in s or one "
                                             "of the 6 morph targets 'frame_0002' .. "
                                             "'frame_0007'" },
        { "morph_take.glb#sheet@-1", "morph_take.glb: got '-1' behind @" },
        { "morph_take.glb#sheet@", "morph_take.glb: got '' behind @" },
        { "morph_take.glb#sheet@1e999", "morph_take.glb: got '1e999' behind @" }, // infinite
        { "morph_take.glb#sheet@0." ZEROS ZEROS "1", "morph_take.glb: got '0.0000" },
        { "morph_take.glb#ground@frame_0002", "mesh 'ground' has no morph targets, got 'frame_0002' behind @" },
        { "morph_take.glb#skirt@1", "got 0 nodes with the mesh 'skirt'" },
        { "morph_take.glb#@1", "got 3 nodes with a mesh, expected the name of one behind #" },
    };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        wisp_mesh mesh;
        wisp_error error = { 0 };
        assert_int_equal( wisp_mesh_read( BAD[i][0], &mesh, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, BAD[i][1] );
        assert_null( mesh.points );
    }
}

// ---- files by hand ---------------------------------------------------------------------------------------------

// A square. Target 0 moves all vertices along z by 1, 2, 3, 4; target 1 is sparse and moves vertex 2 by (5, 6, 7).
enum
{
    QUAD_POINTS = 0,    // 4 x vec3
    QUAD_MOVES = 48,    // 4 x vec3
    QUAD_SPARSE = 96,   // vec3
    QUAD_TIMES = 108,   // 2 float: 1 s and 3 s
    QUAD_WEIGHTS = 116, // 2 x 2 float
    QUAD_SPLINE = 132,  // 2 x 3 x 2 float
    QUAD_CORNERS = 180, // 6 bytes
    QUAD_INDEX = 186,   // 1 byte
    QUAD_BYTES = 188,
};

static gltf_bytes quad_binary( void )
{
    gltf_bytes b = { { 0 }, 0 };
    static const float points[12] = { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 };
    static const float moves[12] = { 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4 }, sparse[3] = { 5, 6, 7 };
    static const float times[2] = { 1, 3 }, weights[4] = { 0, 1, 1, 0 };
    // in-tangents, values, out-tangents: target 0 from 0 with slope 1 to 1 with slope 0
    static const float spline[12] = { 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0 };
    static const unsigned char corners[8] = { 0, 1, 2, 0, 2, 3, 2, 0 };
    gltf_put( &b, points, sizeof points );
    gltf_put( &b, moves, sizeof moves );
    gltf_put( &b, sparse, sizeof sparse );
    gltf_put( &b, times, sizeof times );
    gltf_put( &b, weights, sizeof weights );
    gltf_put( &b, spline, sizeof spline );
    gltf_put( &b, corners, sizeof corners );
    assert_int_equal( b.size, QUAD_BYTES );
    return b;
}

static const char QUAD[] =
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"name\":\"quad\",\"mesh\":0,\"translation\":[10,0,0]}],"
    "\"meshes\":[{\"name\":\"quad\",\"weights\":[0.5,0],\"extras\":{\"targetNames\":[\"lift\"]},\"primitives\":[{"
    "\"attributes\":{\"POSITION\":0},\"indices\":1,\"targets\":[{\"POSITION\":2},{\"POSITION\":3}]}]}],"
    "\"animations\":[{\"samplers\":[{\"input\":4,\"output\":5,\"interpolation\":\"LINEAR\"}],"
    "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"weights\"}}]}],"
    "\"accessors\":["
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"
    "{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,"
    "\"byteOffset\":6,\"componentType\":5121},\"values\":{\"bufferView\":0,\"byteOffset\":96}}},"
    "{\"bufferView\":0,\"byteOffset\":108,\"componentType\":5126,\"count\":2,\"type\":\"SCALAR\"},"
    "{\"bufferView\":0,\"byteOffset\":116,\"componentType\":5126,\"count\":4,\"type\":\"SCALAR\"},"
    "{\"bufferView\":0,\"byteOffset\":132,\"componentType\":5126,\"count\":12,\"type\":\"SCALAR\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":180},{\"buffer\":0,\"byteOffset\":180,\"byteLength\":8}],"
    "\"buffers\":[{\"byteLength\":188}]}";

// The file with one piece of its text replaced.
static wisp_status read_quad( const char* from, const char* to, gltf_model* model, wisp_error* error )
{
    char json[6000];
    const char* found = from != NULL ? strstr( QUAD, from ) : QUAD;
    assert_non_null( found );
    snprintf( json, sizeof json, "%.*s%s%s", (int)( found - QUAD ), QUAD, from != NULL ? to : "",
              found + ( from != NULL ? strlen( from ) : 0 ) );
    const gltf_bytes binary = quad_binary(), file = gltf_binary_file( json, &binary );
    unsigned char* exact = malloc( file.size );
    memcpy( exact, file.data, file.size );
    const wisp_status status = gltf_read_bytes( exact, file.size, NULL, "quad.glb", 0, model, error );
    free( exact );
    return status;
}

static wisp_vec3 place_of( const gltf_model* model, gltf_moment moment, int v )
{
    wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_ok( gltf_mesh_at( model, 0, moment, "quad", &mesh, &error ), error );
    const wisp_vec3 p = mesh.points[v];
    wisp_mesh_release( &mesh );
    return p;
}

static void assert_place( wisp_vec3 p, double x, double y, double z )
{
    assert_true( fabs( (double)p.x - x ) < 1e-6 && fabs( (double)p.y - y ) < 1e-6 && fabs( (double)p.z - z ) < 1e-6 );
}

TEST( displacements_are_added_by_weights_and_placed_by_the_node )
{
    gltf_model model;
    wisp_error error = { 0 };
    assert_ok( read_quad( NULL, NULL, &model, &error ), error );
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
    assert_ok( read_quad( "\"translation\"", "\"weights\":[0,1],\"translation\"", &model, &error ), error );
    assert_place( place_of( &model, rest, 2 ), 16, 7, 7 ); // those of the node come first
    gltf_release( &model );
    assert_ok( read_quad( "LINEAR", "STEP", &model, &error ), error );
    assert_place( place_of( &model, ( gltf_moment ){ 0, 2.9, -1 }, 2 ), 16, 7, 7 );
    gltf_release( &model );
    assert_ok( read_quad( "\"output\":5,\"interpolation\":\"LINEAR\"",
                          "\"output\":6,\"interpolation\":\"CUBICSPLINE\"", &model, &error ),
               error );
    // Hermite at the middle: dt / 8 of the first slope, half of the last value
    assert_place( place_of( &model, ( gltf_moment ){ 0, 2.0, -1 }, 1 ), 11, 0, 2 * ( 2.0 / 8.0 + 0.5 ) );
    gltf_release( &model );
}

TEST( an_animation_moves_the_weights_of_its_node_alone )
{
    gltf_model model;
    wisp_error error = { 0 };
    assert_ok( read_quad( "\"nodes\":[", "\"nodes\":[{\"name\":\"other\",\"mesh\":0},", &model, &error ), error );
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
    gltf_release( &model );
}

TEST( a_frame_of_a_target_shows_it_alone )
{
    gltf_model model;
    wisp_error error = { 0 };
    // weights (1, 1) and (0, 0)
    assert_ok( read_quad( "\"byteOffset\":116", "\"byteOffset\":120", &model, &error ), error );
    assert_true( gltf_target_time( &model, 0, 0, 0 ) == -1.0 && gltf_target_time( &model, 0, 0, 1 ) == -1.0 );
    gltf_release( &model );
    // values of a spline are between its tangents
    assert_ok( read_quad( "\"output\":5,\"interpolation\":\"LINEAR\"",
                          "\"output\":6,\"interpolation\":\"CUBICSPLINE\"", &model, &error ),
               error );
    assert_true( gltf_target_time( &model, 0, 0, 0 ) == 3.0 && gltf_target_time( &model, 0, 0, 1 ) == -1.0 );
    gltf_release( &model );
}

TEST( weights_that_throw_vertices_out_of_all_numbers_are_refused )
{
    gltf_model model;
    wisp_mesh mesh;
    wisp_error error = { 0 };
    assert_ok( read_quad( "[0.5,0]", "[3e38,0]", &model, &error ), error );
    assert_int_equal( gltf_mesh_at_rest( &model, 0, "quad.glb", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: z is infinite" );
    assert_null( mesh.points );
    gltf_release( &model );
}

// A name may have an @.
TEST( the_whole_name_of_a_mesh_goes_before_a_time )
{
    char json[6000];
    const char *name = "\"name\":\"quad\",\"mesh\"", *found = strstr( QUAD, name );
    assert_non_null( found );
    snprintf( json, sizeof json, "%.*s\"name\":\"quad@1\",\"mesh\"%s", (int)( found - QUAD ), QUAD,
              found + strlen( name ) );
    const gltf_bytes binary = quad_binary(), file = gltf_binary_file( json, &binary );
    write_bytes( "morph_at.glb", file.data, file.size );
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

TEST( bad_targets_are_refused_by_element )
{
    static const char* const BAD[][3] = {
        { "\"byteOffset\":48,\"componentType\":5126,\"count\":4",
          "\"byteOffset\":48,\"componentType\":5126,\"count\":3",
          "mesh 0: primitive 0: target 0: accessor 2: got 3 values, expected 4, one for each vertex" },
        { "\"targets\":[{\"POSITION\":2}", "\"targets\":[{\"POSITION\":77}", "accessor" },
        { "\"sparse\":{\"count\":1", "\"sparse\":{\"count\":3", "its 3 sparse values are not within the bytes" },
        { "\"sparse\":{\"count\":1", "\"sparse\":{\"count\":5", "got sparse values of type" },
        { "\"byteOffset\":6,\"componentType\":5121", "\"byteOffset\":6,\"componentType\":5126",
          "indices of type 5126" },
        { "\"values\":{\"bufferView\":0,\"byteOffset\":96}", "\"values\":{\"bufferView\":0,\"byteOffset\":170}",
          "accessor 3: its 1 sparse values are not within the bytes of the file" },
        { "\"values\":{\"bufferView\":0,\"byteOffset\":96}", "\"values\":{\"bufferView\":9,\"byteOffset\":96}",
          "got buffer view 9" },
        { "\"indices\":{\"bufferView\":1,\"byteOffset\":6", "\"indices\":{\"bufferView\":0,\"byteOffset\":15",
          "sparse value 0 is of a vertex that the mesh does not have" },
        { "\"weights\":[0.5,0]", "\"weights\":[0.5]", "mesh 0: weights: got 1 numbers, expected 2" },
        { "\"output\":5", "\"output\":6",
          "animation 0: channel 0: got 12 weights, expected one for each of 2 keys and 2" },
        { "\"targets\":[{\"POSITION\":2},{\"POSITION\":3}]}]",
          "\"targets\":[{\"POSITION\":2},{\"POSITION\":3}]},{\"attributes\":{\"POSITION\":0},\"indices\":1}]",
          "mesh 0: primitive 1: got 0 morph targets, expected 2 as of the primitive before" },
    };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        gltf_model model;
        wisp_error error = { 0 };
        if ( read_quad( BAD[i][0], BAD[i][1], &model, &error ) != WISP_BAD_INPUT ||
             strstr( error.message, BAD[i][2] ) == NULL )
        {
            fail_msg( "%d: '%s' has not '%s'", i, error.message, BAD[i][2] );
        }
        assert_null( model.nodes );
    }
}

// A short file cannot ask for much memory by naming the same bytes again and again.
TEST( targets_of_the_same_bytes_are_bounded )
{
    char many[3000] = "\"targets\":[{\"POSITION\":2}";
    for ( int i = 0; i < 60; ++i )
    {
        strcat( many, ",{\"POSITION\":2}" );
    }
    gltf_model model;
    wisp_error error = { 0 };
    assert_int_equal( read_quad( "\"targets\":[{\"POSITION\":2}", many, &model, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "its 62 morph targets are the same bytes again and again" );
}

TEST_GROUP( write_take, remove_take )
