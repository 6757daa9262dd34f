// Meshes in files: order, polygons, indices, encodings, round trips, and the first scanned mesh.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include <locale.h>
#include <unistd.h>

static wisp_mesh read_obj_text( const char* text )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_read_obj( text, strlen( text ), "text.obj", &mesh, &error ), error );
    return mesh;
}

static wisp_mesh read_ply_bytes( const void* bytes, size_t size )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_read_ply( bytes, size, "bytes.ply", &mesh, &error ), error );
    return mesh;
}

static void assert_triangles( const wisp_mesh* mesh, const int32_t* triangles, int count )
{
    assert_int_equal( mesh->triangle_count, count );
    assert_memory_equal( mesh->triangles, triangles, (size_t)count * 3 * sizeof *triangles );
}

// ---- OBJ -------------------------------------------------------------------------------------------------------

TEST( vertices_and_faces_keep_the_order_of_the_obj_file )
{
    // the second vertex is unreferenced, the third repeats the first, and faces come between vertices
    wisp_mesh mesh = read_obj_text( "v 1 2 3\nv 9 9 9\nv 1 2 3\nf 4 1 3\nv 4 5 6\nf 1 3 4\n" );
    const wisp_vec3 points[] = { { 1, 2, 3 }, { 9, 9, 9 }, { 1, 2, 3 }, { 4, 5, 6 } };
    const int32_t triangles[] = { 3, 0, 2, 0, 2, 3 };
    assert_int_equal( mesh.vertex_count, 4 );
    assert_memory_equal( mesh.points, points, sizeof points );
    assert_triangles( &mesh, triangles, 2 );
    wisp_mesh_release( &mesh );
}

TEST( a_polygon_becomes_a_fan_around_its_first_corner )
{
    wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 2 3 4 5 1\n" );
    const int32_t fan[] = { 1, 2, 3, 1, 3, 4, 1, 4, 0 };
    assert_triangles( &mesh, fan, 3 );
    wisp_mesh_release( &mesh );
}

TEST( every_way_to_write_a_corner_means_the_same_vertex )
{
    wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                                    "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\nf +1 +2 +3\n"
                                    "f -3/-1/-1 -2/-1/-1 -1/-1/-1\nv 5 5 5\nf -4 -3 -2\n" );
    const int32_t same[] = { 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2 };
    assert_triangles( &mesh, same, 7 );
    wisp_mesh_release( &mesh );
}

TEST( only_the_first_three_numbers_of_a_vertex_count )
{
    wisp_mesh mesh = read_obj_text( "v 1 2 3 0.5\nv -1e-3 +.5 2.e1 1 0 0\nv 1 1 1 1 1 1 1\nf 1 2 3\n" );
    const wisp_vec3 points[] = { { 1, 2, 3 }, { -1e-3f, 0.5f, 20 }, { 1, 1, 1 } };
    assert_memory_equal( mesh.points, points, sizeof points );
    wisp_mesh_release( &mesh );
}

TEST( every_other_line_of_an_obj_file_is_passed_over )
{
    // the exponent of the normal would overflow an int inside the library, which therefore never gets it
    wisp_mesh mesh =
        read_obj_text( "# free text, 100 % \xc3\xa9\xff\nmtllib none.mtl\no thing\ng a b\ng \n  v 0 0 0 # here\r\n"
                       "\tv 1 0 0\rv 0 1 0\nvn 1e2147483649 0 0\nusemtl red\ns off\nl 1 2\nt x 1/2/3\n\n"
                       "vertex\nface 1\nf\t1  2 3 #end" );
    const int32_t triangles[] = { 0, 1, 2 };
    assert_int_equal( mesh.vertex_count, 3 );
    assert_triangles( &mesh, triangles, 1 );
    wisp_mesh_release( &mesh );
}

TEST( a_locale_with_a_decimal_comma_changes_nothing )
{
    static const char* const names[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE" };
    bool found = false;
    for ( int i = 0; i < WISP_COUNT( names ) && !found; ++i )
    {
        found = setlocale( LC_ALL, names[i] ) != NULL;
    }
    if ( !found )
    {
        SKIP( "no locale with a decimal comma is installed" );
    }
    const char* ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n0.5 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    wisp_mesh a = read_obj_text( "v 0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" );
    wisp_mesh b = read_ply_bytes( ply, strlen( ply ) );
    setlocale( LC_ALL, "C" );
    assert_true( a.points[0].x == 0.5f );
    assert_same_mesh( &a, &b );
    wisp_mesh_release( &a );
    wisp_mesh_release( &b );
}

// ---- PLY -------------------------------------------------------------------------------------------------------

// Unknown elements and properties before, between and after known ones; doubles, an unsigned list, a face first.
#define TANGLED_HEADER                                                                                               \
    "comment a b c\nobj_info d\nelement strip 2\nproperty list ushort short rows\nelement face 2\n"                  \
    "property uchar flag\nproperty list uchar uint vertex_indices\nproperty list int float weights\n"                \
    "element vertex 4\nproperty char z\nproperty list uchar double extra\nproperty double x\nproperty short y\n"     \
    "element end 1\nproperty int last\nend_header\n"

static const wisp_vec3 tangled_points[] = { { 0.5f, -2, 1 }, { 1, 300, -1 }, { -4, 0, 0 }, { 8, 1, 127 } };
static const int32_t tangled_triangles[] = { 0, 1, 2, 3, 2, 1, 3, 1, 0 };

static void assert_tangled( wisp_mesh* mesh )
{
    assert_int_equal( mesh->vertex_count, 4 );
    assert_memory_equal( mesh->points, tangled_points, sizeof tangled_points );
    assert_triangles( mesh, tangled_triangles, 3 );
    wisp_mesh_release( mesh );
}

TEST( text_ply_passes_over_what_it_does_not_need )
{
    const char* text = "ply\r\nformat ascii 1.0\r\n" TANGLED_HEADER "2 7 -7\n0\n"
                       "1 3 0 1 2 0\n\n9 4 3 2 1 0 2 0.5 1e3\n"
                       "1 0 .5 -2\r\n-1 1 3.5 1 300\n0 0 -4.0 0\n  127 2 1 2 8 1 \n42";
    wisp_mesh mesh = read_ply_bytes( text, strlen( text ) );
    assert_tangled( &mesh );
}

typedef struct byte_writer
{
    unsigned char bytes[1024];
    size_t size;
    bool big;
} byte_writer;

static void put( byte_writer* w, int width, uint64_t bits )
{
    for ( int i = 0; i < width; ++i )
    {
        w->bytes[w->size++] = (unsigned char)( bits >> 8 * ( w->big ? width - 1 - i : i ) & 255 );
    }
}

static void put_double( byte_writer* w, double value )
{
    uint64_t bits;
    memcpy( &bits, &value, sizeof bits );
    put( w, 8, bits );
}

static void put_text( byte_writer* w, const char* text )
{
    memcpy( w->bytes + w->size, text, strlen( text ) );
    w->size += strlen( text );
}

static void put_tangled_rows( byte_writer* w )
{
    put( w, 2, 2 ), put( w, 2, 7 ), put( w, 2, 0xfff9 ), put( w, 2, 0 );
    put( w, 1, 1 ), put( w, 1, 3 ), put( w, 4, 0 ), put( w, 4, 1 ), put( w, 4, 2 ), put( w, 4, 0 );
    put( w, 1, 9 ), put( w, 1, 4 ), put( w, 4, 3 ), put( w, 4, 2 ), put( w, 4, 1 ), put( w, 4, 0 );
    put( w, 4, 2 ), put( w, 4, 0x3f000000 ), put( w, 4, 0x447a0000 );
    for ( int v = 0; v < 4; ++v )
    {
        wisp_vec3 p = tangled_points[v];
        put( w, 1, (uint64_t)(int64_t)p.z );
        put( w, 1, v == 1 );
        if ( v == 1 )
        {
            put_double( w, 3.5 );
        }
        put_double( w, (double)p.x );
        put( w, 2, (uint64_t)(int64_t)p.y );
    }
    put( w, 4, 42 );
}

TEST( binary_ply_passes_over_what_it_does_not_need_in_both_byte_orders )
{
    for ( int big = 0; big < 2; ++big )
    {
        byte_writer w = { .big = big != 0 };
        put_text( &w, big != 0 ? "ply\nformat binary_big_endian 1.0\n" : "ply\nformat binary_little_endian 1.0\n" );
        put_text( &w, TANGLED_HEADER );
        put_tangled_rows( &w );
        unsigned char* exact = checked_malloc( w.size );
        memcpy( exact, w.bytes, w.size );
        wisp_mesh mesh = read_ply_bytes( exact, w.size );
        free( exact );
        assert_tangled( &mesh );
    }
}

// ---- files -----------------------------------------------------------------------------------------------------

static const wisp_vec3 odd_points[] = {
    { 0.1f, -0.0f, 1e-40f },
    { 1.0f / 3.0f, -123456.789f, 0x1.fffffep-1f },
    { 1.17549435e-38f, 16777217.0f, -3.4028235e38f },
    { 0x1p-149f, -7.0f / 9.0f, 3.14159265e-20f },
};
static const int32_t odd_triangles[] = { 3, 1, 0, 2, 3, 0, 1, 1, 2 };

TEST( both_formats_bring_every_float_back_bit_for_bit )
{
    static const char* const names[] = { "round-trip.obj", "round-trip.ply" };
    wisp_mesh mesh = fixture_mesh( odd_points, 4, odd_triangles, 3 );
    for ( int i = 0; i < 2; ++i )
    {
        wisp_mesh again;
        assert_int_equal( wisp_mesh_write( names[i], &mesh, NULL ), WISP_OK );
        assert_int_equal( wisp_mesh_read( names[i], &again, NULL ), WISP_OK );
        assert_same_mesh( &mesh, &again );
        wisp_mesh_release( &again );
        remove( names[i] );
    }
    wisp_mesh_release( &mesh );
}

TEST( a_sphere_survives_both_formats_one_after_the_other )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    wisp_mesh mesh = fixture_made( &generator ), once, twice;
    assert_int_equal( wisp_mesh_write_obj( "sphere.one", &mesh, NULL ), WISP_OK );
    assert_int_equal( rename( "sphere.one", "sphere.OBJ" ), 0 );
    assert_int_equal( wisp_mesh_read( "sphere.OBJ", &once, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_write_ply( "sphere.ply", &once, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_read( "sphere.ply", &twice, NULL ), WISP_OK );
    assert_same_mesh( &mesh, &twice );
    wisp_mesh_release( &mesh );
    wisp_mesh_release( &once );
    wisp_mesh_release( &twice );
    remove( "sphere.OBJ" );
    remove( "sphere.ply" );
}

TEST( a_name_without_a_known_extension_is_refused_both_ways )
{
    wisp_mesh mesh = fixture_tetrahedron(), out;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_read( "thing.stl", &out, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "thing.stl: not a mesh" );
    assert_int_equal( wisp_mesh_write( "thing.stl", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "thing.stl: expected a file that ends in .obj or .ply" );
    assert_int_equal( wisp_mesh_read( "no such folder/a.obj", &out, &error ), WISP_IO_ERROR );
    assert_int_equal( wisp_mesh_write( "no such folder/a.ply", &mesh, &error ), WISP_IO_ERROR );
    wisp_mesh_release( &mesh );
}

TEST( a_malformed_mesh_is_not_written_and_the_old_file_stays )
{
    wisp_mesh mesh = fixture_tetrahedron(), again;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_write( "old.ply", &mesh, NULL ), WISP_OK );
    mesh.triangles[7] = 4;
    assert_int_equal( wisp_mesh_write( "old.ply", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "triangle 2: corner 1: got vertex 4, expected 0 .. 3" );
    mesh.triangles[7] = fixture_tetrahedron_faces[7];
    mesh.points[1].y = 1.0f / 0.0f;
    assert_int_equal( wisp_mesh_write_obj( "old.ply", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: y is infinite" );
    mesh.points[1].y = 0.0f;
    assert_int_equal( wisp_mesh_read( "old.ply", &again, NULL ), WISP_OK );
    assert_same_mesh( &mesh, &again );
    wisp_mesh_release( &again );
    wisp_mesh_release( &mesh );
    remove( "old.ply" );
}

TEST( the_bunny_is_one_closed_sound_shell )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_read( WISP_SOURCE_ROOT "/data/bunny.obj", &mesh, &error ), error );
    wisp_mesh_diagnostics report = fixture_report( &mesh );
    assert_int_equal( report.vertex_count, 1839 );
    assert_int_equal( report.triangle_count, 3674 );
    assert_int_equal( report.edge_count, 3 * 3674 / 2 );
    assert_int_equal( report.euler_characteristic, 2 );
    int demands =
        WISP_MESH_CLOSED | WISP_MESH_ORIENTED | WISP_MESH_MANIFOLD | WISP_MESH_CLEAN | WISP_MESH_ONE_COMPONENT;
    assert_int_equal( wisp_mesh_require( &report, demands, "bunny", &error ), WISP_OK );
    assert_true( report.volume > 0.0 );
    // the first and the last line of each kind, read by hand
    assert_true( mesh.points[0].x == 1.301895f && mesh.points[1838].z == 1.192950f );
    const int32_t first[] = { 2, 1661, 3 };
    assert_memory_equal( mesh.triangles, first, sizeof first );
    wisp_mesh_release( &mesh );
}

static int make_folder( void** state )
{
    static char path[] = "test-mesh-XXXXXX";
    *state = path;
    return mkdtemp( path ) != NULL && chdir( path ) == 0 ? 0 : -1;
}

static int remove_folder( void** state )
{
    return chdir( ".." ) == 0 ? rmdir( *state ) : -1;
}

TEST_GROUP( make_folder, remove_folder )
