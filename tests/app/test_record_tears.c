// Recordings of a mesh that tears: a square of two triangles whose corner 0 is split in frame 2, so that the second triangle
// gets vertex 4 there. Vertex 5 is never used.
#include "folder_fixture.h"

#include "../bad/bad_recordings.h"
#include "gltf.h"
#include "record.h"

enum
{
    VERTICES = 6,
    FRAMES = 4,
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

static const char* record( void** state, const char* name )
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
    assert_int_equal( wisp_recording_open( record( state, "x.wisp" ), &recording, &error ), WISP_OK );
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
    unsigned char* bytes = read_bytes( record( state, "x.wisp" ), &size );
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
    record( state, "x.obj" );
    char* text = text_of( path_in( state, "x_0002.obj" ) );
    assert_non_null( strstr( text, "f 1 3 4\n" ) );
    free( text );
    text = text_of( path_in( state, "x_0003.obj" ) );
    assert_non_null( strstr( text, "f 5 3 4\n" ) );
    free( text );
}

// Vertex 4 was where vertex 0 was in the frame before: it rose by 1 m and went 1.75 m sideways in half a second.
TEST_WITH( usd_has_a_sample_of_the_triangles_per_frame, make_folder, remove_folder )
{
    char* text = text_of( record( state, "x.usda" ) );
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
    free( text );
}

// Unit normals of a level triangle point up or down; split off, the second one is level too.
TEST_WITH( glb_has_all_corners_in_their_places_with_the_triangles_of_the_last_frame, make_folder, remove_folder )
{
    const char* path = record( state, "x.glb" );
    gltf_model model = { 0 };
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
        wisp_mesh frame = { 0 };
        wisp_vec3 points[VERTICES];
        place( f, points );
        snprintf( named, sizeof named, "%s#sheet@%g", path, 0.5 * f );
        assert_int_equal( wisp_mesh_read( named, &frame, &error ), WISP_OK );
        for ( int i = 0; i < 6; ++i )
        {
            const wisp_vec3 p = frame.points[frame.triangles[i]], q = points[triangles_of( f )[i]];
            assert_true( fabsf( p.x - q.x ) + fabsf( p.y - q.y ) + fabsf( p.z - q.z ) < 1e-6f );
        }
        wisp_mesh_release( &frame );
    }
    gltf_release( &model );
}
