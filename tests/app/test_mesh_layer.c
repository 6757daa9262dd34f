// A mesh with points on it, as a file: every number is at the position in the header, other programs read it as a
// mesh, and invalid input is rejected without a file.
#include "unit.h"

#include "mesh.h"

#include <unistd.h>

#define FILE_NAME "layer_test.ply"

// Two triangles with five edges; three points on edges and one inside.
typedef struct sheet
{
    wisp_vec3 points[4], normals[4];
    int32_t triangles[6], edges[10];
    float places[16], directions[16];
    wisp_mesh mesh;
    wisp_mesh_layer layer;
} sheet;

static float bits_of( int element )
{
    float bits;
    memcpy( &bits, &element, sizeof bits );
    return bits;
}

static void make_sheet( sheet* s )
{
    *s = ( sheet ){
        .points = { { 0.0f, 0.0f, 0.0f }, { 1.0f, 0.0f, 0.0f }, { 0.0f, 1.0f, 0.0f }, { 1.0f, 1.0f, 0.125f } },
        .normals = { { 0.0f, 0.0f, 1.0f }, { 0.0f, 0.6f, 0.8f }, { 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } },
        .triangles = { 0, 1, 2, 2, 1, 3 },
        .edges = { 0, 1, 0, 2, 1, 2, 1, 3, 2, 3 },
        .places = { 0.5f, 0.0f, 0.0f, bits_of( 0 ), 0.0f, 0.25f, 0.0f, bits_of( 1 ), 0.0f, 0.75f, 0.0f, bits_of( 1 ),
                    0.25f, 0.25f, 0.0f, bits_of( 5 ) },
        .directions = { 0.0f, 0.6f, 0.8f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f,
                        0.0f },
    };
    s->mesh = ( wisp_mesh ){ .points = s->points, .triangles = s->triangles, .vertex_count = 4, .triangle_count = 2 };
    s->layer = ( wisp_mesh_layer ){ .normals = s->normals,
                                    .edges = s->edges,
                                    .edge_count = 5,
                                    .points = s->places,
                                    .point_normals = s->directions,
                                    .point_count = 4 };
}

static void write_good( const sheet* s )
{
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_write_layer( FILE_NAME, &s->mesh, &s->layer, &error ), error );
}

// The test machine is little-endian, like the file.
TEST( every_number_is_where_the_header_says )
{
    sheet s;
    make_sheet( &s );
    write_good( &s );
    static unsigned char bytes[4096];
    FILE* file = fopen( FILE_NAME, "rb" );
    assert_non_null( file );
    const size_t size = fread( bytes, 1, sizeof bytes - 1, file );
    fclose( file );
    assert_non_null( strstr( (const char*)bytes,
                             "element vertex 8\nproperty float x\nproperty float y\nproperty float "
                             "z\nproperty float nx\nproperty float ny\nproperty float "
                             "nz\nproperty int element\nelement face 2\n" ) );
    assert_non_null( strstr( (const char*)bytes, "element edge 5\nproperty int vertex1\nproperty int vertex2\n" ) );
    const char* end = strstr( (const char*)bytes, "end_header\n" );
    assert_non_null( end );
    const unsigned char* row = (const unsigned char*)end + strlen( "end_header\n" );
    assert_int_equal( row + 8 * 28 + 2 * 13 + 5 * 8 - bytes, size );
    for ( int i = 0; i < 8; ++i, row += 28 )
    {
        float numbers[6];
        int32_t element;
        memcpy( numbers, row, sizeof numbers );
        memcpy( &element, row + sizeof numbers, sizeof element );
        const float* place = i < 4 ? &s.points[i].x : &s.places[4 * ( i - 4 )];
        const float* normal = i < 4 ? &s.normals[i].x : &s.directions[4 * ( i - 4 )];
        assert_memory_equal( numbers, place, 3 * sizeof( float ) );
        assert_memory_equal( numbers + 3, normal, 3 * sizeof( float ) );
        const int32_t elements[] = { -1, -1, -1, -1, 0, 1, 1, 5 };
        assert_int_equal( element, elements[i] );
    }
    for ( int t = 0; t < 2; ++t, row += 13 )
    {
        assert_int_equal( row[0], 3 );
        assert_memory_equal( row + 1, s.triangles + 3 * t, 3 * sizeof( int32_t ) );
    }
    assert_memory_equal( row, s.edges, sizeof s.edges );
    remove( FILE_NAME );
}

TEST( it_is_read_back_as_a_mesh_with_vertices_of_no_triangle )
{
    sheet s;
    make_sheet( &s );
    write_good( &s );
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_read( FILE_NAME, &mesh, &error ), WISP_OK );
    assert_int_equal( mesh.vertex_count, 8 );
    assert_int_equal( mesh.triangle_count, 2 );
    assert_memory_equal( mesh.points, s.points, sizeof s.points );
    assert_true( mesh.points[7].x == 0.25f && mesh.points[7].y == 0.25f && mesh.points[7].z == 0.0f );
    assert_memory_equal( mesh.triangles, s.triangles, sizeof s.triangles );
    wisp_mesh_diagnostics report;
    assert_int_equal( wisp_mesh_examine( &mesh, &report, &error ), WISP_OK );
    assert_int_equal( report.unreferenced.count, 4 );
    wisp_mesh_release( &mesh );
    remove( FILE_NAME );
}

TEST( a_layer_without_points_is_the_mesh_with_its_normals )
{
    sheet s;
    make_sheet( &s );
    s.layer.point_count = 0;
    s.layer.points = s.layer.point_normals = NULL;
    write_good( &s );
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_read( FILE_NAME, &mesh, &error ), WISP_OK );
    assert_int_equal( mesh.vertex_count, 4 );
    wisp_mesh_release( &mesh );
    remove( FILE_NAME );
}

static void assert_refused( const sheet* s, const char* words )
{
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_write_layer( FILE_NAME, &s->mesh, &s->layer, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, words );
    assert_int_equal( access( FILE_NAME, F_OK ), -1 );
}

TEST( what_cannot_be_is_refused_and_leaves_no_file )
{
    remove( FILE_NAME );
    sheet s;
    make_sheet( &s );
    s.places[9] = NAN;
    assert_refused( &s, FILE_NAME ": the place of point 2 is not finite" );
    make_sheet( &s );
    s.directions[12] = INFINITY;
    assert_refused( &s, "the normal of point 3 is not finite" );
    make_sheet( &s );
    s.normals[1].y = NAN;
    assert_refused( &s, "the normal of vertex 1 is not finite" );
    make_sheet( &s );
    s.places[15] = bits_of( 7 );
    assert_refused( &s, "point 3 is on element 7 of 7" );
    s.places[15] = bits_of( -1 );
    assert_refused( &s, "point 3 is on element -1 of 7" );
    make_sheet( &s );
    s.edges[7] = 4;
    assert_refused( &s, "edge 3: got vertex 4, expected 0 .. 3" );
    make_sheet( &s );
    s.layer.point_count = -1;
    assert_refused( &s, "4 vertices and -1 points" );
    s.layer.point_count = 1 << 26;
    assert_refused( &s, "are more than the 67108864 that are read back" );
    make_sheet( &s );
    s.triangles[2] = 9;
    assert_refused( &s, "9" );
}

TEST( a_folder_that_is_not_there_is_an_error_of_the_system )
{
    sheet s;
    make_sheet( &s );
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_write_layer( "no_such_folder/a.ply", &s.mesh, &s.layer, &error ), WISP_IO_ERROR );
    assert_non_null( strstr( error.message, "no_such_folder/a.ply" ) );
}
