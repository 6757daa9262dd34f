// Meshes in files: round trips, and colours and texture coordinates of vertices, read from OBJ and PLY, written back and kept
// by repairs. What cannot be written leaves no file. Order, polygons, indices and encodings are in
// tests/app/transcripts/meshes.t, files of boundary points in record.t.
#define _XOPEN_SOURCE 700

#include "locale_fixture.h"
#include "mesh_fixture.h"

#include "files.h"
#include "mesh.h"

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

TEST( a_locale_with_a_decimal_comma_changes_nothing )
{
    enter_comma_locale();
    const char* ply =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_index\nend_header\n0.5 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    SCOPED( wisp_mesh_release ) wisp_mesh a = read_obj_text( "v 0.5 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" );
    SCOPED( wisp_mesh_release ) wisp_mesh b = read_ply_bytes( ply, strlen( ply ) );
    setlocale( LC_ALL, "C" );
    assert_true( a.points[0].x == 0.5f );
    assert_same_mesh( &a, &b );
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
    static const char* const names[] = { "round-trip.OBJ", "round-trip.ply" };
    const wisp_mesh_generator sphere = wisp_default_mesh_generator( WISP_MESH_ICOSPHERE );
    for ( int i = 0; i < 4; ++i )
    {
        SCOPED( wisp_mesh_release )
        wisp_mesh mesh = i < 2 ? fixture_mesh( odd_points, 4, odd_triangles, 3 ) : fixture_made( &sphere ), again;
        assert_int_equal( wisp_mesh_write( names[i % 2], &mesh, NULL ), WISP_OK );
        assert_int_equal( wisp_mesh_read( names[i % 2], &again, NULL ), WISP_OK );
        assert_same_mesh( &mesh, &again );
        wisp_mesh_release( &again );
        remove( names[i % 2] );
    }
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

// ---- colours and texture coordinates ----

// Vertices with their colours and texture coordinates, and how many colours, seams and texture coordinates are missing.
static void print_mesh( char* to, const wisp_mesh* mesh )
{
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        const wisp_vec3 p = mesh->points[v], c = mesh->colours != NULL ? mesh->colours[v] : ( wisp_vec3 ){ 0 };
        to += sprintf( to, "%g %g %g", (double)p.x, (double)p.y, (double)p.z );
        to += mesh->colours != NULL ? sprintf( to, " c %g %g %g", (double)c.x, (double)c.y, (double)c.z ) : 0;
        to +=
            mesh->uvs != NULL ? sprintf( to, " t %g %g", (double)mesh->uvs[2 * v], (double)mesh->uvs[2 * v + 1] ) : 0;
        to += sprintf( to, "\n" );
    }
    sprintf( to, "%d %d %d", mesh->colour_missing_count, mesh->uv_seam_count, mesh->uv_missing_count );
}

#define PLY_HEAD "ply\nformat ascii 1.0\nelement vertex 3\n"
#define PLY_PLACE "property float x\nproperty float y\nproperty float z\n"
#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
#define PLY_COLOURS( t, one )                                                                                        \
    PLY_HEAD "property " t " red\nproperty float x\nproperty float y\nproperty " t " green\nproperty float z\n"      \
             "property " t " blue\nproperty uchar alpha\n" PLY_FACE one " 0 0 0 0 0 1\n0 1 0 " one " 0 0 2\n"        \
             "0 0 1 0 0 " one " 3\n3 0 1 2\n",                                                                       \
        0, "0 0 0 c 1 0 0\n1 0 0 c 0 1 0\n0 1 0 c 0 0 1\n0 0 0"
#define PLY_UVS( u, v )                                                                                              \
    PLY_HEAD PLY_PLACE "property float " u "\nproperty float " v "\nproperty float u\n"                              \
                       "property list uchar int v\n" PLY_FACE                                                        \
                       "0 0 0 .5 .25 9 0\n1 0 0 1 2 9 1 9\n0 1 0 3 4 9 0\n3 0 1 2\n",                                \
        0, "0 0 0 t 0.5 0.25\n1 0 0 t 1 2\n0 1 0 t 3 4\n0 0 0"
#define CORNERS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
#define PLAIN "0 0 0\n1 0 0\n0 1 0\n0 0 0"

static const struct
{
    const char *name, *text;
    int repairs;
    const char* expected;
} attribute_cases[] = {
    { "colours without weight, with weight, and none: white",
      "v 0 0 0 0.25 .5 1e-1\nv 1 0 0 1 0.75 0 0.125\nv 0 1 0\nf 1 2 3\n", 0,
      "0 0 0 c 0.25 0.5 0.1\n1 0 0 c 0.75 0 0.125\n0 1 0 c 1 1 1\n1 0 0" },
    { "a weight is no colour", "v 0 0 0\nv 1 0 0 1\nv 0 1 0\nf 1 2 3\n", 0, PLAIN },
    // Faces come before their `vt` lines, count backwards from what came before, repeat an equal pair (no seam) and
    // name another (a seam); the fourth vertex has none.
    { "the first texture coordinates of its corners",
      CORNERS "v 9 9 9\nvt 0.5 0.25\nf 1/1 2/-1 3/3\nvt 0.5 0.25 7\nvt 2\nvt 2 .9\nf 1/2 2/-1 3/3\n", 0,
      "0 0 0 t 0.5 0.25\n1 0 0 t 0.5 0.25\n0 1 0 t 2 0\n9 9 9 t 0 0\n0 1 1" },
    { "indices without lines", CORNERS "f 1/1 2/2 3/9\n", 0, PLAIN },
    { "indices beyond the lines", CORNERS "vt 1 1\nf 1/1 2/2 3/-2\n", 0,
      "0 0 0 t 1 1\n1 0 0 t 0 0\n0 1 0 t 0 0\n0 0 2" },
    { "lines that no face names", CORNERS "vt 1 1\nf 1 2 3\n", 0, PLAIN },
    { "uchar", PLY_COLOURS( "uchar", "255" ) },
    { "int", PLY_COLOURS( "int", "255" ) },
    { "ushort", PLY_COLOURS( "ushort", "65535" ) },
    { "float", PLY_COLOURS( "float", "1" ) },
    { "double", PLY_COLOURS( "double", "1.0" ) },
    { "s, t before u, v", PLY_UVS( "s", "t" ) },
    { "u, v before u, v", PLY_UVS( "u", "v" ) },
    { "texture_u, texture_v before u, v", PLY_UVS( "texture_u", "texture_v" ) },
    { "a lone channel or coordinate",
      PLY_HEAD PLY_PLACE "property float s\nproperty uchar red\nproperty uchar blue\n" PLY_FACE
                         "0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n",
      0, PLAIN },
    { "the others of a removed vertex, which had none in the file",
      "v 9 9 9 .9 .9 .9\nv 0 0 0 .1 .1 .1\nv 1 0 0 .2 .2 .2\nv 0 1 0 .3 .3 .3\nvt 1 1\nvt 2 2\nvt 3 3\n"
      "f 2/1 3/2 4/3\n",
      WISP_MESH_DROP_UNREFERENCED,
      "0 0 0 c 0.1 0.1 0.1 t 1 1\n1 0 0 c 0.2 0.2 0.2 t 2 2\n0 1 0 c 0.3 0.3 0.3 t 3 3\n0 0 1" },
    { "those of the vertex that stays",
      "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 0 0 1 1 1\nv 1 1 0 0 0 0\nv 0 1 0 1 1 1\n"
      "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 0.5\nf 1/1 2/2 3/3\nf 4/4 5/1 6/3\n",
      WISP_MESH_WELD, "0 0 0 c 1 0 0 t 0 0\n1 0 0 c 0 1 0 t 1 0\n0 1 0 c 0 0 1 t 0 1\n1 1 0 c 0 0 0 t 0 0\n0 1 0" },
};

TEST( colours_and_texture_coordinates_belong_to_their_vertices )
{
    for ( int i = 0; i < WISP_COUNT( attribute_cases ); ++i )
    {
        char found[400];
        const char* text = attribute_cases[i].text;
        SCOPED( wisp_mesh_repairs_release ) wisp_mesh_repairs repairs = { 0 };
        SCOPED( wisp_mesh_release )
        wisp_mesh mesh = text[0] == 'p' ? read_ply_bytes( text, strlen( text ) ) : read_obj_text( text );
        if ( attribute_cases[i].repairs != 0 )
        {
            assert_int_equal( wisp_mesh_repair( &mesh, attribute_cases[i].repairs, 0.0f, &repairs, NULL ), WISP_OK );
        }
        print_mesh( found, &mesh );
        if ( strcmp( found, attribute_cases[i].expected ) != 0 )
        {
            fail_msg( "%s: got\n%s\nexpected\n%s", attribute_cases[i].name, found, attribute_cases[i].expected );
        }
    }
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

TEST( what_cannot_be_is_refused_and_leaves_no_file )
{
    static const struct
    {
        size_t at; // in the sheet
        int bits;
        const char* words;
    } cases[] = {
#define AT( member ) offsetof( sheet, member )
        { AT( places[9] ), 0x7fc00000, FILE_NAME ": the place of point 2 is not finite" },
        { AT( directions[12] ), 0x7f800000, "the normal of point 3 is not finite" },
        { AT( normals[1].y ), 0x7fc00000, "the normal of vertex 1 is not finite" },
        { AT( places[15] ), 7, "point 3 is on element 7 of 7" },
        { AT( places[15] ), -1, "point 3 is on element -1 of 7" },
        { AT( edges[7] ), 4, "edge 3: got vertex 4, expected 0 .. 3" },
        { AT( layer.point_count ), -1, "4 vertices and -1 points" },
        { AT( layer.point_count ), 1 << 26, "are more than the 67108864 that are read back" },
        { AT( triangles[2] ), 9, "9" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        sheet s;
        wisp_error error = { .status = WISP_OK };
        make_sheet( &s );
        memcpy( (char*)&s + cases[i].at, &cases[i].bits, sizeof cases[i].bits );
        assert_int_equal( wisp_mesh_write_layer( FILE_NAME, &s.mesh, &s.layer, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, cases[i].words );
        assert_int_equal( access( FILE_NAME, F_OK ), -1 );
    }
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
