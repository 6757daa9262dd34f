// Colours and texture coordinates of vertices: read from OBJ and PLY, written back, kept by repairs, described.
#define _XOPEN_SOURCE 700

#include "mesh_fixture.h"

#include <math.h>
#include <unistd.h>

static wisp_mesh read_obj( const char* text )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_read_obj( text, strlen( text ), "text.obj", &mesh, &error ), error );
    return mesh;
}

static wisp_mesh read_ply( const void* bytes, size_t size )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_read_ply( bytes, size, "bytes.ply", &mesh, &error ), error );
    return mesh;
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

// ---- OBJ -------------------------------------------------------------------------------------------------------

TEST( colours_stand_behind_the_position_of_an_obj_vertex )
{
    // without weight, with weight, and none: white
    wisp_mesh mesh = read_obj( "v 0 0 0 0.25 .5 1e-1\nv 1 0 0 1 0.75 0 0.125\nv 0 1 0\nf 1 2 3\n" );
    const wisp_vec3 colours[] = { { 0.25f, 0.5f, 0.1f }, { 0.75f, 0.0f, 0.125f }, { 1, 1, 1 } };
    assert_memory_equal( mesh.colours, colours, sizeof colours );
    assert_int_equal( mesh.colour_missing_count, 1 );
    assert_true( mesh.points[1].x == 1.0f && mesh.uvs == NULL );
    wisp_mesh_release( &mesh );
    mesh = read_obj( "v 0 0 0\nv 1 0 0 1\nv 0 1 0\nf 1 2 3\n" );
    assert_null( mesh.colours );
    wisp_mesh_release( &mesh );
}

TEST( a_vertex_keeps_the_first_texture_coordinates_of_its_corners )
{
    // Faces come before their `vt` lines, count backwards from what came before, repeat an equal pair (no seam) and
    // name another (a seam); the fourth vertex has none.
    wisp_mesh mesh = read_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nvt 0.5 0.25\nf 1/1 2/-1 3/3\nvt 0.5 0.25 7\n"
                               "vt 2\nvt .1 .9\nf 1/2 2/-1 3/3\n" );
    const float uvs[] = { 0.5f, 0.25f, 0.5f, 0.25f, 2.0f, 0.0f, 0.0f, 0.0f };
    assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
    assert_int_equal( mesh.uv_seam_count, 1 );
    assert_int_equal( mesh.uv_missing_count, 1 );
    wisp_mesh_release( &mesh );
}

TEST( an_index_without_a_line_of_texture_coordinates_gives_none )
{
    wisp_mesh mesh = read_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/2 3/9\n" );
    assert_null( mesh.uvs );
    assert_int_equal( mesh.uv_missing_count, 0 );
    wisp_mesh_release( &mesh );
    mesh = read_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 1\nf 1/1 2/2 3/-2\n" );
    assert_int_equal( mesh.uv_missing_count, 2 );
    assert_true( mesh.uvs[0] == 1.0f && mesh.uvs[2] == 0.0f );
    wisp_mesh_release( &mesh );
    // lines that no face names
    mesh = read_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 1 1\nf 1 2 3\n" );
    assert_null( mesh.uvs );
    wisp_mesh_release( &mesh );
}

TEST( damaged_colours_and_texture_coordinates_are_refused_by_their_line )
{
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt nan 0\nf 1 2 3\n", "line 4: got \"nan\", expected a number" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt\nf 1 2 3\n", "line 4: got texture coordinates of 0 numbers" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0 0 0\nf 1 2 3\n", "line 4: got texture coordinates of 4 numbers" );
    refuse_obj( "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 0 1e99\nf 1 2 3\n", "line 5: \"1e99\" is too large" );
    refuse_obj( "v 0 0 0\nv 1 0 0 0 1e99 0\nv 0 1 0\nf 1 2 3\n", "vertex 1: its colour is not finite" );
}

// ---- PLY -------------------------------------------------------------------------------------------------------

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
        wisp_mesh mesh = read_ply( text, strlen( text ) );
        const wisp_vec3 colours[] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
        assert_memory_equal( mesh.colours, colours, sizeof colours );
        assert_true( mesh.points[1].x == 1.0f && mesh.points[2].y == 1.0f );
        wisp_mesh_release( &mesh );
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
        wisp_mesh mesh = read_ply( text, strlen( text ) );
        const float uvs[] = { 0.5f, 0.25f, 1, 2, 3, 4 };
        assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
        assert_null( mesh.colours );
        wisp_mesh_release( &mesh );
    }
}

TEST( a_lone_channel_or_coordinate_of_ply_is_skipped )
{
    const char* text =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float s\nproperty uchar red\nproperty uchar blue\n" PLY_FACE
        "0 0 0 1 1 1\n1 0 0 1 1 1\n0 1 0 1 1 1\n3 0 1 2\n";
    wisp_mesh mesh = read_ply( text, strlen( text ) );
    assert_true( mesh.colours == NULL && mesh.uvs == NULL );
    wisp_mesh_release( &mesh );
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

// ---- written back ----------------------------------------------------------------------------------------------

static void round_trip( const wisp_mesh* mesh, const char* name )
{
    wisp_mesh again;
    assert_int_equal( wisp_mesh_write( name, mesh, NULL ), WISP_OK );
    assert_int_equal( wisp_mesh_read( name, &again, NULL ), WISP_OK );
    assert_attributes( mesh, &again );
    wisp_mesh_release( &again );
}

TEST( both_formats_restore_colours_and_coordinates_bit_for_bit )
{
    wisp_mesh mesh =
        read_obj( "v 0 0 0 0.1 0.2 0.3\nv 1 0 0 -0.0 1.5 1e-9\nv 0 1 0 0 0 1\nvt 0.1 -0.7\nvt 3 0.3333333\n"
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
    wisp_mesh mesh = read_ply( text, strlen( text ) );
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
    wisp_mesh mesh = read_obj( "v 0 0 0 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n" );
    wisp_error error = { .status = WISP_OK };
    mesh.uvs[3] = INFINITY;
    assert_int_equal( wisp_mesh_write( "never.ply", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 1: its texture coordinates are not finite" );
    mesh.uvs[3] = 0.0f;
    mesh.colours[2].z = NAN;
    assert_int_equal( wisp_mesh_write( "never.obj", &mesh, &error ), WISP_BAD_INPUT );
    assert_contains( error.message, "vertex 2: its colour is not finite" );
    wisp_mesh_release( &mesh );
}

// ---- repaired and described ------------------------------------------------------------------------------------

TEST( a_repair_that_removes_vertices_keeps_what_belongs_to_the_others )
{
    wisp_mesh mesh = read_obj( "v 9 9 9 .9 .9 .9\nv 0 0 0 .1 .1 .1\nv 1 0 0 .2 .2 .2\nv 0 1 0 .3 .3 .3\n"
                               "vt 1 1\nvt 2 2\nvt 3 3\nf 2/1 3/2 4/3\n" );
    wisp_mesh_repairs repairs;
    assert_int_equal( wisp_mesh_repair( &mesh, WISP_MESH_DROP_UNREFERENCED, &repairs, NULL ), WISP_OK );
    const wisp_vec3 colours[] = { { .1f, .1f, .1f }, { .2f, .2f, .2f }, { .3f, .3f, .3f } };
    const float uvs[] = { 1, 1, 2, 2, 3, 3 };
    assert_int_equal( mesh.vertex_count, 3 );
    assert_memory_equal( mesh.colours, colours, sizeof colours );
    assert_memory_equal( mesh.uvs, uvs, sizeof uvs );
    wisp_mesh_repairs_release( &repairs );
    wisp_mesh_release( &mesh );
}

TEST( the_description_names_their_ranges_and_what_was_missing )
{
    wisp_mesh mesh =
        read_obj( "v 0 0 0 .25 0 1\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 .5\nvt 2 3\nf 1/1 2/1 3/2\nf 1/2 2/1 4\n" );
    char* text = NULL;
    size_t size = 0;
    FILE* stream = open_memstream( &text, &size );
    assert_int_equal( wisp_mesh_info( stream, &mesh, "thing" ), WISP_OK );
    fclose( stream );
    assert_contains( text, "colours              red 0.25 .. 1, green 0 .. 1, blue 1 .. 1\n" );
    assert_contains( text, "texture coordinates  u 0 .. 2, v 0 .. 3\n" );
    assert_contains( text, "note: vertices without a colour, which are white: 3\n" );
    assert_contains( text, "note: vertices with several texture coordinates, of which the first are kept: 1\n" );
    assert_contains( text, "note: vertices without texture coordinates, which are at (0, 0): 1\n" );
    free( text );
    wisp_mesh_release( &mesh );
}

static int make_folder( void** state )
{
    static char path[] = "test-mesh-attributes-XXXXXX";
    *state = path;
    return mkdtemp( path ) != NULL && chdir( path ) == 0 ? 0 : -1;
}

static int remove_folder( void** state )
{
    return chdir( ".." ) == 0 ? rmdir( *state ) : -1;
}

TEST_GROUP( make_folder, remove_folder )
