// Meshes in files: order, polygons, indices, encodings, round trips, and the first scanned mesh. Colours and texture
// coordinates of vertices: read from OBJ and PLY, written back, kept by repairs, described. A mesh with points on it, as a
// file: every number is at the position in the header, other programs read it as a mesh, and invalid input is rejected
// without a file.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include "mesh.h"

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

// ---- OBJ ----

TEST( vertices_and_faces_keep_the_order_of_the_obj_file )
{
    // the second vertex is unreferenced, the third repeats the first, and faces come between vertices
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 1 2 3\nv 9 9 9\nv 1 2 3\nf 4 1 3\nv 4 5 6\nf 1 3 4\n" );
    const wisp_vec3 points[] = { { 1, 2, 3 }, { 9, 9, 9 }, { 1, 2, 3 }, { 4, 5, 6 } };
    const int32_t triangles[] = { 3, 0, 2, 0, 2, 3 };
    assert_int_equal( mesh.vertex_count, 4 );
    assert_memory_equal( mesh.points, points, sizeof points );
    assert_triangles( &mesh, triangles, 2 );
}

TEST( a_polygon_becomes_a_fan_around_its_first_corner )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 2 3 4 5 1\n" );
    const int32_t fan[] = { 1, 2, 3, 1, 3, 4, 1, 4, 0 };
    assert_triangles( &mesh, fan, 3 );
}

TEST( every_way_to_write_a_corner_means_the_same_vertex )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
                                    "f 1 2 3\nf 1/1 2/1 3/1\nf 1//1 2//1 3//1\nf 1/1/1 2/1/1 3/1/1\nf +1 +2 +3\n"
                                    "f -3/-1/-1 -2/-1/-1 -1/-1/-1\nv 5 5 5\nf -4 -3 -2\n" );
    const int32_t same[] = { 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2 };
    assert_triangles( &mesh, same, 7 );
}

TEST( only_the_first_three_numbers_of_a_vertex_count )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 1 2 3 0.5\nv -1e-3 +.5 2.e1 1 0 0\nv 1 1 1 1 1 1 1\nf 1 2 3\n" );
    const wisp_vec3 points[] = { { 1, 2, 3 }, { -1e-3f, 0.5f, 20 }, { 1, 1, 1 } };
    assert_memory_equal( mesh.points, points, sizeof points );
}

TEST( every_other_line_of_an_obj_file_is_passed_over )
{
    // the exponent of the normal would overflow an int inside the library, which therefore never gets it
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh =
        read_obj_text( "# free text, 100 % \xc3\xa9\xff\nmtllib none.mtl\no thing\ng a b\ng \n  v 0 0 0 # here\r\n"
                       "\tv 1 0 0\rv 0 1 0\nvn 1e2147483649 0 0\nusemtl red\ns off\nl 1 2\nt x 1/2/3\n\n"
                       "vertex\nface 1\nf\t1  2 3 #end" );
    const int32_t triangles[] = { 0, 1, 2 };
    assert_int_equal( mesh.vertex_count, 3 );
    assert_triangles( &mesh, triangles, 1 );
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
    SCOPED( wisp_mesh_release ) wisp_mesh a = read_obj_text( "v 0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" );
    SCOPED( wisp_mesh_release ) wisp_mesh b = read_ply_bytes( ply, strlen( ply ) );
    setlocale( LC_ALL, "C" );
    assert_true( a.points[0].x == 0.5f );
    assert_same_mesh( &a, &b );
}

// ---- PLY ----

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

// ---- files ----

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
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_mesh( odd_points, 4, odd_triangles, 3 );
    for ( int i = 0; i < 2; ++i )
    {
        wisp_mesh again;
        assert_int_equal( wisp_mesh_write( names[i], &mesh, NULL ), WISP_OK );
        assert_int_equal( wisp_mesh_read( names[i], &again, NULL ), WISP_OK );
        assert_same_mesh( &mesh, &again );
        wisp_mesh_release( &again );
        remove( names[i] );
    }
}

TEST( a_sphere_survives_both_formats_one_after_the_other )
{
    wisp_mesh_generator generator = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    wisp_mesh mesh = fixture_made( &generator ), once, twice;
    assert_int_equal( wisp_mesh_write( "sphere.OBJ", &mesh, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_read( "sphere.OBJ", &once, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_write( "sphere.ply", &once, NULL ), WISP_OK );
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
    assert_int_equal( wisp_mesh_write( "old.ply", &mesh, &error ), WISP_BAD_INPUT );
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
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
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
}

static void refuse_obj( const char* text, const char* part )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_read_obj( text, strlen( text ), "text.obj", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, part );
    assert_null( mesh.points );
}

static void assert_attributes( const wisp_mesh* a, const wisp_mesh* b )
{
    assert_same_mesh( a, b );
    assert_int_equal( a->colours != NULL, b->colours != NULL );
    assert_int_equal( a->uvs != NULL, b->uvs != NULL );
    if ( a->colours != NULL )
    {
        assert_memory_equal( a->colours, b->colours, (size_t)a->vertex_count * sizeof *a->colours );
    }
    if ( a->uvs != NULL )
    {
        assert_memory_equal( a->uvs, b->uvs, 2 * (size_t)a->vertex_count * sizeof *a->uvs );
    }
}

// ---- OBJ ----

TEST( colours_stand_behind_the_position_of_an_obj_vertex )
{
    // without weight, with weight, and none: white
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 0 0 0 0.25 .5 1e-1\nv 1 0 0 1 0.75 0 0.125\nv 0 1 0\nf 1 2 3\n" );
    const wisp_vec3 colours[] = { { 0.25f, 0.5f, 0.1f }, { 0.75f, 0.0f, 0.125f }, { 1, 1, 1 } };
    assert_memory_equal( mesh.colours, colours, sizeof colours );
    assert_int_equal( mesh.colour_missing_count, 1 );
    assert_true( mesh.points[1].x == 1.0f && mesh.uvs == NULL );
    wisp_mesh_release( &mesh );
    mesh = read_obj_text( "v 0 0 0\nv 1 0 0 1\nv 0 1 0\nf 1 2 3\n" );
    assert_null( mesh.colours );
}

TEST( a_vertex_keeps_the_first_texture_coordinates_of_its_corners )
{
    // Faces come before their `vt` lines, count backwards from what came before, repeat an equal pair (no seam) and
    // name another (a seam); the fourth vertex has none.
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nvt 0.5 0.25\nf 1/1 2/-1 3/3\nvt 0.5 0.25 7\n"
                                    "vt 2\nvt .1 .9\nf 1/2 2/-1 3/3\n" );
    const float uvs[] = { 0.5f, 0.25f, 0.5f, 0.25f, 2.0f, 0.0f, 0.0f, 0.0f };
    assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
    assert_int_equal( mesh.uv_seam_count, 1 );
    assert_int_equal( mesh.uv_missing_count, 1 );
}

TEST( an_index_without_a_line_of_texture_coordinates_gives_none )
{
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/9\n" );
    assert_null( mesh.uvs );
    assert_int_equal( mesh.uv_missing_count, 0 );
    wisp_mesh_release( &mesh );
    mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 1\nf 1/1 2/2 3/-2\n" );
    assert_int_equal( mesh.uv_missing_count, 2 );
    assert_true( mesh.uvs[0] == 1.0f && mesh.uvs[2] == 0.0f );
    wisp_mesh_release( &mesh );
    // lines that no face names
    mesh = read_obj_text( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 1\nf 1 2 3\n" );
    assert_null( mesh.uvs );
}

TEST( damaged_colours_and_texture_coordinates_are_refused_by_their_line )
{
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nf 1 2 3\n", "line 4: got \"nan\", expected a number" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt\nf 1 2 3\n", "line 4: got texture coordinates of 0 numbers" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0 0 0\nf 1 2 3\n", "line 4: got texture coordinates of 4 numbers" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0 1e99\nf 1 2 3\n", "line 5: \"1e99\" is too large" );
    refuse_obj( "v 0 0 0\nv 1 0 0 0 1e99 0\nv 0 1 0\nf 1 2 3\n", "vertex 1: its colour is not finite" );
}

// ---- PLY ----

#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"

TEST( ply_colours_of_every_type_become_fractions )
{
    static const struct
    {
        const char *type, *full;
    } types[] = {
        { "uchar", "255" }, { "int", "255" }, { "ushort", "65535" }, { "float", "1" }, { "double", "1.0" }
    };
    for ( int i = 0; i < WISP_COUNT( types ); ++i )
    {
        char text[600];
        const char *t = types[i].type, *f = types[i].full;
        snprintf( text, sizeof text,
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty %s red\nproperty float x\nproperty float y\n"
                  "property %s green\nproperty float z\nproperty %s blue\nproperty uchar alpha\n" PLY_FACE
                  "%s 0 0 0 0 0 1\n0 1 0 %s 0 0 2\n0 0 1 0 0 %s 3\n3 0 1 2\n",
                  t, t, t, f, f, f );
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = read_ply_bytes( text, strlen( text ) );
        const wisp_vec3 colours[] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
        assert_memory_equal( mesh.colours, colours, sizeof colours );
        assert_true( mesh.points[1].x == 1.0f && mesh.points[2].y == 1.0f );
    }
}

TEST( ply_texture_coordinates_have_three_spellings_and_the_first_counts )
{
    static const char* const names[][2] = { { "s", "t" }, { "u", "v" }, { "texture_u", "texture_v" } };
    for ( int i = 0; i < WISP_COUNT( names ); ++i )
    {
        char text[600];
        snprintf( text, sizeof text,
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                  "property float %s\nproperty float %s\nproperty float u\nproperty list uchar int v\n" PLY_FACE
                  "0 0 0 .5 .25 9 0\n1 0 0 1 2 9 1 9\n0 1 0 3 4 9 0\n3 0 1 2\n",
                  names[i][0], names[i][1] );
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = read_ply_bytes( text, strlen( text ) );
        const float uvs[] = { 0.5f, 0.25f, 1, 2, 3, 4 };
        assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
        assert_null( mesh.colours );
    }
}

TEST( a_lone_channel_or_coordinate_of_ply_is_skipped )
{
    const char* text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty uchar red\nproperty uchar blue\n" PLY_FACE
        "0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n";
    SCOPED( wisp_mesh_release ) wisp_mesh mesh = read_ply_bytes( text, strlen( text ) );
    assert_true( mesh.colours == NULL && mesh.uvs == NULL );
}

TEST( a_ply_colour_that_is_nan_is_refused )
{
    unsigned char bytes[400];
    const char* header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float red\nproperty float green\nproperty float blue\n" PLY_FACE;
    size_t size = strlen( header );
    memcpy( bytes, header, size );
    float rows[18] = { 0.0f };
    rows[6] = rows[13] = 1.0f;
    rows[10] = NAN;
    memcpy( bytes + size, rows, sizeof rows );
    size += sizeof rows;
    const unsigned char face[13] = { 3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0 };
    memcpy( bytes + size, face, sizeof face );
    size += sizeof face;
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_mesh_read_ply( bytes, size, "bytes.ply", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: green is NaN" );
}

// ---- written back ----

static void round_trip( const wisp_mesh* mesh, const char* name )
{
    SCOPED( wisp_mesh_release ) wisp_mesh again;
    assert_int_equal( wisp_mesh_write( name, mesh, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_read( name, &again, NULL ), WISP_OK );
    assert_attributes( mesh, &again );
}

TEST( both_formats_restore_colours_and_coordinates_bit_for_bit )
{
    wisp_mesh mesh =
        read_obj_text( "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 -0.0 1.5 1e-9\nv 0 1 0 0 0 1\nvt 0.1 -0.7\nvt 3 0.3333333\n"
                       "f 1/1 2/2 3/1\n" );
    round_trip( &mesh, "attributes.obj" );
    round_trip( &mesh, "attributes.ply" );
    free( mesh.uvs );
    mesh.uvs = NULL;
    round_trip( &mesh, "attributes.obj" );
    round_trip( &mesh, "attributes.ply" );
    wisp_mesh_release( &mesh );
    remove( "attributes.obj" );
    remove( "attributes.ply" );
}

TEST( ply_colours_are_bytes_where_bytes_lose_nothing )
{
    const char* text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n" PLY_FACE
        "0 0 0 1 77 254\n1 0 0 0 128 255\n0 1 0 3 99 200\n3 0 1 2\n";
    wisp_mesh mesh = read_ply_bytes( text, strlen( text ) );
    round_trip( &mesh, "bytes.ply" );
    char head[400] = { 0 };
    FILE* file = fopen( "bytes.ply", "rb" );
    assert_true( fread( head, 1, sizeof head - 1, file ) > 100 );
    fclose( file );
    assert_contains( head, "property uchar red" );
    mesh.colours[1].x = 0.5f;
    round_trip( &mesh, "bytes.ply" );
    file = fopen( "bytes.ply", "rb" );
    assert_true( fread( head, 1, sizeof head - 1, file ) > 100 );
    fclose( file );
    assert_contains( head, "property float red" );
    wisp_mesh_release( &mesh );
    remove( "bytes.ply" );
}

TEST( values_that_are_not_finite_are_not_written )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 0 0 0 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n" );
    wisp_error error = { .status = WISP_OK };
    mesh.uvs[3] = INFINITY;
    assert_int_equal( wisp_mesh_write( "never.ply", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: its texture coordinates are not finite" );
    mesh.uvs[3] = 0.0f;
    mesh.colours[2].z = NAN;
    assert_int_equal( wisp_mesh_write( "never.obj", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 2: its colour is not finite" );
}

// ---- repaired and described ----

TEST( a_repair_that_removes_vertices_keeps_what_belongs_to_the_others )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh = read_obj_text( "v 9 9 9 .9 .9 .9\nv 0 0 0 .1 .1 .1\nv 1 0 0 .2 .2 .2\nv 0 1 0 .3 .3 .3\n"
                                    "vt 1 1\nvt 2 2\nvt 3 3\nf 2/1 3/2 4/3\n" );
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_DROP_UNREFERENCED, 0.0f, &repairs, NULL ), WISP_OK );
    const wisp_vec3 colours[] = { { .1f, .1f, .1f }, { .2f, .2f, .2f }, { .3f, .3f, .3f } };
    const float uvs[] = { 1, 1, 2, 2, 3, 3 };
    assert_int_equal( mesh.vertex_count, 3 );
    assert_memory_equal( mesh.colours, colours, sizeof colours );
    assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
}

TEST( the_description_names_their_ranges_and_what_was_missing )
{
    SCOPED( wisp_mesh_release )
    wisp_mesh mesh =
        read_obj_text( "v 0 0 0 .25 0 1\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 .5\nvt 2 3\nf 1/1 2/1 3/2\nf 1/2 2/1 4\n" );
    SCOPED( free_local ) char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_int_equal( wisp_mesh_info( stream, &mesh, "thing" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "colours              red 0.25 .. 1, green 0 .. 1, blue 1 .. 1\n" );
    assert_contains( text, "texture coordinates  u 0 .. 2, v 0 .. 3\n" );
    assert_contains( text, "note: vertices without a colour, which are white: 3\n" );
    assert_contains( text, "note: vertices with several texture coordinates, of which the first are kept: 1\n" );
    assert_contains( text, "note: vertices without texture coordinates, which are at (0, 0): 1\n" );
}

// ---- points on a mesh ----

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

// ---- the doctor, whose findings and repairs are in tests/app/transcripts/meshes.t ----

TEST( a_malformed_mesh_is_refused_and_reports_nothing )
{
    wisp_mesh mesh = fixture_tetrahedron(), empty = { 0 };
    wisp_mesh_repairs repairs;
    wisp_mesh_diagnostics r;
    wisp_error error = { .status = WISP_OK };
    mesh.triangles[4] = -1;
    assert_int_equal( wisp_mesh_examine( &mesh, &r, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "triangle 1: corner 1: got vertex -1, expected 0 .. 3" );
    assert_int_equal( r.vertex_count, 0 );
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_REPAIR_ALL, 0.0f, &repairs, &error ), WISP_BAD_INPUT );
    mesh.triangles[4] = 1;
    mesh.points[2].z = NAN;
    assert_int_equal( wisp_mesh_examine( &mesh, &r, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 2: z is NaN" );
    assert_int_equal( wisp_mesh_examine( &empty, &r, &error ), WISP_BAD_INPUT );
    wisp_mesh_release( &mesh );
}

TEST( what_cannot_be_welded_is_refused )
{
    static const struct
    {
        float distance;
        const char* message;
    } cases[] = {
        { -1.0f, "mesh: got -1 m as the distance to weld, expected 0 or more" },
        { NAN, "mesh: got nan m as the distance to weld, expected 0 or more" },
        { INFINITY, "mesh: got inf m as the distance to weld, expected 0 or more" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        SCOPED( wisp_mesh_release ) wisp_mesh mesh = fixture_tetrahedron();
        wisp_error error = { 0 };
        wisp_mesh_repairs repairs;
        assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_WELD, cases[i].distance, &repairs, &error ),
                          WISP_BAD_INPUT );
        assert_string_equal( error.message, cases[i].message );
        assert_null( repairs.became );
        assert_int_equal( mesh.triangle_count, 4 );
    }
}

TEST( attributes_are_those_of_the_vertex_that_stays )
{
    static const char text[] =
        "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\n"
        "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 0.5\nf 1/1 2/2 3/3\nf 4/4 5/1 6/3\n";
    SCOPED( wisp_mesh_release ) wisp_mesh mesh;
    wisp_error error = { 0 };
    SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs;
    assert_ok( wisp_mesh_read_obj( text, strlen( text ), "two.obj", &mesh, &error ), error );
    assert_ok( wisp_mesh_repair( &mesh, WISP_MESH_WELD, 0.0f, &repairs, &error ), error );
    assert_int_equal( mesh.vertex_count, 4 );
    assert_true( mesh.colours[1].x == 0.0f && mesh.colours[1].y == 1.0f );
    assert_true( mesh.uvs[2] == 1.0f && mesh.uvs[5] == 1.0f && mesh.uvs[6] == 0.0f );
    assert_int_equal( mesh.uv_seam_count, 1 );
}

TEST( every_repair_is_said_out_loud )
{
    wisp_mesh_repairs all = { .degenerates_dropped = 1,
                              .duplicates_dropped = 2,
                              .triangles_turned = 3,
                              .unreferenced_dropped = 1,
                              .vertices_welded = 5,
                              .collapsed_dropped = 1,
                              .triangles_flipped = 7 };
    wisp_mesh_repairs none = { 0 };
    SCOPED( free_local ) char* text = NULL;
    size_t size;
    FILE* stream = open_memstream( &text, &size );
    assert_non_null( stream );
    wisp_mesh_print_repairs( stream, &all, "a" );
    wisp_mesh_print_repairs( stream, &none, "b" );
    fclose( stream );
    assert_string_equal( text, "a: 5 vertices were merged into others\n"
                               "a: 1 triangle that collapsed was removed\n"
                               "a: 1 triangle without area was removed\n"
                               "a: 2 duplicate triangles were removed\n"
                               "a: 3 triangles were turned over\n"
                               "a: 7 triangles were flipped\n"
                               "a: 1 unreferenced vertex was removed\n"
                               "b: nothing to repair\n" );
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
