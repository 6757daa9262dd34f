// Surfaces that take values from files. Maps: numbers of text files and images become factors of vertices. Starts as a host has
// them. What is refused, and starts of files, are in tests/app/transcripts/scenes.t.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "files.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

// ---- maps ----

#define GRID "generate: { shape: plane, columns: 3, rows: 2, spacing: 0.1 }"

static char folder[200];

static int make_folder( void** state )
{
    (void)state;
    snprintf( folder, sizeof folder, "%s/wisp_maps_XXXXXX", getenv( "TMPDIR" ) ? getenv( "TMPDIR" ) : "/tmp" );
    return mkdtemp( folder ) == NULL;
}

static int remove_folder( void** state )
{
    (void)state;
    char path[260];
    snprintf( path, sizeof path, "%s/map.txt", folder );
    unlink( path );
    return rmdir( folder );
}

static void write_map( const char* text )
{
    char path[260];
    snprintf( path, sizeof path, "%s/map.txt", folder );
    FILE* file = fopen( path, "wb" );
    assert_non_null( file );
    fputs( text, file );
    assert_int_equal( fclose( file ), 0 );
}

// @param keys with one %s for the folder
static const char* scene_with( const char* keys )
{
    static char text[2000], filled[1200];
    snprintf( filled, sizeof filled, keys, folder );
    snprintf( text, sizeof text, "wisp: 1\nsurfaces:\n  - { name: sheet, " GRID ", %s }\n", filled );
    return text;
}

static const float* column_of( fixture* f, wisp_component component )
{
    return wisp_world_column( f->world.world, f->world.surfaces[0].entity, component, 0 );
}

static float factor_of( fixture* f, wisp_component map, int vertex )
{
    const wisp_fabric* fabric = wisp_world_fabric( f->world.world, f->world.surfaces[0].entity );
    const float* column = column_of( f, map );
    assert_non_null( column );
    return column[fabric->vertex_slot[vertex]];
}

TEST( numbers_of_a_text_file_are_values_of_vertices )
{
    write_map( "0.1, 0.2 0.3\n0.4;0.5\n\n0.6\n" );
    SCOPED( release ) fixture f;
    build( &f, scene_with( "area_density: { map: %s/map.txt }" ) );
    for ( int v = 0; v < 6; ++v )
    {
        assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, v ), 0.1f * (float)( v + 1 ), 1e-7f );
    }
    // half a cell of area a corner and its mass: 0.01 m^2 / 2 / 3 or twice that
    const wisp_fabric* fabric = wisp_world_fabric( f.world.world, f.world.surfaces[0].entity );
    const int slot = fabric->vertex_slot[5];
    const float w = column_of( &f, WISP_PARTICLE_POSITION )[4 * slot + 3];
    assert_float_equal( 1.0f / w, 0.6f * fabric->area[slot], 1e-6f * 0.6f * fabric->area[slot] );
}

TEST( from_and_to_are_the_values_of_zero_and_one )
{
    write_map( "0 1 0.5 0.25 0 1" );
    SCOPED( release ) fixture f;
    build( &f, scene_with( "damping: { map: %s/map.txt, from: 4, to: 2 }" ) );
    const float expected[] = { 4.0f, 2.0f, 3.0f, 3.5f, 4.0f, 2.0f };
    const float rate = *column_of( &f, WISP_PARTICLE_DAMPING );
    for ( int v = 0; v < 6; ++v )
    {
        assert_float_equal( rate * factor_of( &f, WISP_MAP_DAMPING, v ), expected[v], 1e-6f );
    }
}

TEST( an_image_is_sampled_from_left_to_right_along_x_and_from_top_to_bottom_along_z )
{
    char path[300];
    snprintf( path, sizeof path, "area_density: { map: %s/data/scenes/embroidery.png, from: 1, to: 2 }",
              WISP_SOURCE_ROOT );
    char text[1000];
    snprintf( text, sizeof text,
              "wisp: 1\nsurfaces:\n  - { name: sheet, generate: { shape: plane, columns: 101, rows: 101, spacing: "
              "0.01 }, %s }\n",
              path );
    SCOPED( release ) fixture f;
    build( &f, text );
    // the flower of embroidery.png: r = 0.2 + 0.1 cos 6a about the middle is white, the middle and the corners are black
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 80 ), 1.0f, 1e-3f ); // r 0.3, a 0
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 50 ), 0.5f, 1e-3f );
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 0 ), 0.5f, 1e-3f );
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 60 * 101 + 50 ), 1.0f, 1e-3f ); // r 0.1, a 90 degrees
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 60 ), 0.5f, 1e-3f ); // r 0.1, a 0
}

// ---- attributes of files ----

static void write_file( const char* name, const void* bytes, size_t size )
{
    char path[260];
    snprintf( path, sizeof path, "%s/%s", folder, name );
    FILE* file = fopen( path, "wb" );
    assert_non_null( file );
    assert_int_equal( fwrite( bytes, 1, size, file ), size );
    assert_int_equal( fclose( file ), 0 );
}

static void remove_file( const char* name )
{
    char path[260];
    snprintf( path, sizeof path, "%s/%s", folder, name );
    assert_int_equal( unlink( path ), 0 );
}

// @param keys with one %s for the folder
static const char* scene_of_mesh( const char* keys )
{
    static char text[3000], filled[1200];
    snprintf( filled, sizeof filled, keys, folder, folder );
    snprintf( text, sizeof text, "wisp: 1\nsurfaces:\n  - { name: sheet, file: %s/mesh.obj, %s }\n", folder, filled );
    return text;
}

static void write_mesh( const char* text )
{
    write_file( "mesh.obj", text, strlen( text ) );
}

// The first vertex belongs to no triangle, the last one is welded to the one before.
static const char COLOURED[] = "v 9 9 9 1 1 1\nv 0 0 0 0.5 0.25 0\nv 1 0 0 1 0.5 0.75\nv 0 0 1 0 1 0.5\n"
                               "v 0 0 1 0.3 0.3 0.3\nf 2 4 3\nf 3 5 2\n";

TEST( colours_of_vertices_are_values_also_of_an_instance )
{
    static const struct
    {
        const char* channel;
        float values[3];
    } cases[] = {
        { "r", { 0.5f, 1.0f, 0.0f } },
        { "g", { 0.25f, 0.5f, 1.0f } },
        { "b", { 0.0f, 0.75f, 0.5f } },
        { "mean", { 0.25f, 0.75f, 0.5f } },
    };
    write_mesh( COLOURED );
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        char keys[400];
        snprintf( keys, sizeof keys,
                  "repair: [weld, unreferenced], area_density: { map: colours, channel: %s, from: 1, to: 3 } }\n"
                  "  - { name: twin, instance_of: sheet, damping: { map: colours, channel: %s, to: 2 }",
                  cases[i].channel, cases[i].channel );
        SCOPED( release ) fixture f;
        build( &f, scene_of_mesh( keys ) );
        for ( int v = 0; v < 3; ++v )
        {
            const float value = cases[i].values[v];
            assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, v ), ( 1.0f + 2.0f * value ) / 3.0f, 1e-6f );
            const wisp_entity twin = f.world.surfaces[1].entity;
            const float* column = wisp_world_column( f.world.world, twin, WISP_MAP_DAMPING, 0 );
            assert_float_equal( column[wisp_world_fabric( f.world.world, twin )->vertex_slot[v]], value, 1e-6f );
        }
    }
    remove_file( "mesh.obj" );
}

// 4 x 2 pixels: red 0, 85, 170, 255 from the left, green 0 and 255 from the top, blue 51.
static const unsigned char IMAGE[] = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
    0x00, 0x04, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xf0, 0xca, 0xea, 0x34, 0x00, 0x00, 0x00,
    0x1e, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x05, 0xc1, 0x01, 0x01, 0x00, 0x00, 0x08, 0x83, 0x30, 0x3a, 0x91,
    0xc5, 0x92, 0x2f, 0x89, 0x1b, 0xe0, 0xe1, 0x30, 0x84, 0xbc, 0x5c, 0x96, 0x0f, 0x5a, 0xf2, 0x09, 0x91, 0xbf,
    0x94, 0xf1, 0xe6, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82,
};

TEST( an_image_is_sampled_at_texture_coordinates_and_repeats )
{
    // At the middle of a pixel, between two, at the right border, and the first again some images to the right and below.
    write_mesh( "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 2 0 0\nv 2 0 1\n"
                "vt 0.125 0.75\nvt 0.25 0.25\nvt 1 0.5\nvt 3.125 -1.25\nvt -0.125 1.75\nvt 0.375 0\n"
                "f 1/1 3/3 2/2\nf 2/2 3/3 4/4\nf 2/2 4/4 5/5\nf 4/4 6/6 5/5\n" );
    write_file( "map.png", IMAGE, sizeof IMAGE );
    static const float red[] = { 0.0f, 1.0f / 6.0f, 1.0f, 0.0f, 1.0f, 1.0f / 3.0f },
                       green[] = { 0.0f, 1.0f, 0.5f, 0.0f, 0.0f, 1.0f };
    fixture f;
    build( &f, scene_of_mesh( "area_density: { map: %s/map.png, channel: r, from: 1, to: 2 },"
                              " damping: { map: %s/map.png, channel: g }" ) );
    for ( int v = 0; v < 6; ++v )
    {
        assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, v ), 0.5f + 0.5f * red[v], 1e-6f );
        assert_float_equal( factor_of( &f, WISP_MAP_DAMPING, v ), green[v], 1e-6f );
    }
    release( &f );
    // the mean of a pixel, of whole numbers as before
    build( &f, scene_of_mesh( "damping: { map: %s/map.png }" ) );
    assert_float_equal( factor_of( &f, WISP_MAP_DAMPING, 0 ), 17.0f / 255.0f, 1e-6f );
    release( &f );
    remove_file( "mesh.obj" );
    remove_file( "map.png" );
}

TEST( thickness_and_friction_are_maps_of_vertices )
{
    write_map( "0 0.5 1 1 0.5 0" );
    SCOPED( release ) fixture f;
    build( &f, scene_with( "collision: { thickness: { map: %1$s/map.txt, from: 0.01, to: 0.02 },"
                           " friction_scale: { map: %1$s/map.txt, to: 3 } },"
                           " contact: { thickness: { map: %1$s/map.txt, from: 0.004, to: 0.001 },"
                           " friction: { map: %1$s/map.txt } }" ) );
    static const float values[] = { 0.0f, 0.5f, 1.0f, 1.0f, 0.5f, 0.0f };
    for ( int v = 0; v < 6; ++v )
    {
        assert_float_equal( factor_of( &f, WISP_MAP_COLLISION_THICKNESS, v ), 0.5f + 0.5f * values[v], 1e-6f );
        assert_float_equal( factor_of( &f, WISP_MAP_COLLISION_FRICTION, v ), values[v], 1e-6f );
        assert_float_equal( factor_of( &f, WISP_MAP_CONTACT_THICKNESS, v ), 1.0f - 0.75f * values[v], 1e-6f );
        assert_float_equal( factor_of( &f, WISP_MAP_CONTACT_FRICTION, v ), values[v], 1e-6f );
    }
}

// ---- starts ----

TEST( a_host_gives_a_start_as_arrays )
{
    static const wisp_vec3 places[4] = { { 0, 0.5f, 0 }, { 0.5f, 0, 0 }, { 0, 0, 0.25f }, { 1, 2, 3 } };
    static const int32_t triangles[] = { 0, 1, 2 };
    const wisp_scene_arrays arrays = {
        .file = "memory", .points = places, .point_count = 4, .triangles = triangles, .triangle_count = 1
    };
    SCOPED( release )
    fixture f = { .scene = parsed( "wisp: 1\nsurfaces:\n  - { name: a, start: { file: memory },"
                                   " generate: { shape: plane, columns: 2, rows: 2, spacing: 1 } }\n" ) };
    assert_ok( wisp_scene_set_arrays( &f.scene, &arrays, 1, &f.error ), f.error );
    create( &f, 1 );
    for ( int v = 0; v < 4; ++v )
    {
        const wisp_vec3 p = point_of( &f, 0, v );
        assert_memory_equal( &p, &places[v], sizeof p );
    }
    // the rest shape stays that of the mesh
    const wisp_fabric* fabric = f.world.surfaces[0].fabric;
    const wisp_vec3 a = fabric->rest[fabric->vertex_slot[0]], b = fabric->rest[fabric->vertex_slot[1]];
    assert_true( b.x - a.x == 1.0f && a.y == b.y && a.z == b.z );
}

static wisp_status list_file( void* user, const char* file, wisp_error* error )
{
    strcat( strcat( user, file ), " " );
    return strcmp( file, "stop.glb" ) == 0 ? wisp_fail( error, WISP_CONFLICT, "stopped" ) : WISP_OK;
}

TEST( all_files_of_a_scene_are_listed_without_names_of_meshes )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed( "wisp: 1\nsurfaces:\n  - { name: a, file: a.glb#skin, start: { file: 'b#1.obj' }, "
                               "area_density: { map: m.txt },"
                               " animation: { file: motion.glb, clips: [{ clip: walk }] } }\n"
                               "  - { name: b, file: stop.glb, start: { file: not.obj } }\n"
                               "colliders:\n  - { name: c, shape: mesh, file: c.glb#stone }\n"
                               "strands:\n  - { name: s, file: s.hair }\n" );
    char names[200] = "";
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_files( &scene, list_file, names, &error ), WISP_CONFLICT );
    assert_string_equal( names, "s.hair a.glb b#1.obj motion.glb m.txt stop.glb " );
    assert_string_equal( error.message, "stopped" );
}

TEST_GROUP( make_folder, remove_folder )
