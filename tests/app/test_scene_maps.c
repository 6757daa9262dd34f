// Maps of scenes: numbers of text files and images become factors of vertices, and bad ones are refused by one message.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include <stdio.h>
#include <string.h>

#include "files.h"

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

static void numbers_of_a_text_file_are_values_of_vertices( void** state )
{
    (void)state;
    write_map( "0.1, 0.2 0.3\n0.4;0.5\n\n0.6\n" );
    fixture f;
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
    release( &f );
}

static void from_and_to_are_the_values_of_zero_and_one( void** state )
{
    (void)state;
    write_map( "0 1 0.5 0.25 0 1" );
    fixture f;
    build( &f, scene_with( "damping: { map: %s/map.txt, from: 4, to: 2 }" ) );
    const float expected[] = { 4.0f, 2.0f, 3.0f, 3.5f, 4.0f, 2.0f };
    const float rate = *column_of( &f, WISP_PARTICLE_DAMPING );
    for ( int v = 0; v < 6; ++v )
    {
        assert_float_equal( rate * factor_of( &f, WISP_MAP_DAMPING, v ), expected[v], 1e-6f );
    }
    release( &f );
}

static void an_image_is_sampled_from_left_to_right_along_x_and_from_top_to_bottom_along_z( void** state )
{
    (void)state;
    char path[300];
    snprintf( path, sizeof path, "area_density: { map: %s/data/scenes/embroidery.png, from: 1, to: 2 }",
              WISP_SOURCE_ROOT );
    char text[1000];
    snprintf( text, sizeof text,
              "wisp: 1\nsurfaces:\n  - { name: sheet, generate: { shape: plane, columns: 101, rows: 101, spacing: "
              "0.01 }, %s }\n",
              path );
    fixture f;
    build( &f, text );
    // the flower of embroidery.png: r = 0.2 + 0.1 cos 6a about the middle is white, the middle and the corners are black
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 80 ), 1.0f, 1e-3f ); // r 0.3, a 0
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 50 ), 0.5f, 1e-3f );
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 0 ), 0.5f, 1e-3f );
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 60 * 101 + 50 ), 1.0f, 1e-3f ); // r 0.1, a 90 degrees
    assert_float_equal( factor_of( &f, WISP_MAP_AREA_DENSITY, 50 * 101 + 60 ), 0.5f, 1e-3f ); // r 0.1, a 0
    release( &f );
}

// The message ends with these words.
static void demand_map_refusal( const char* keys, wisp_status status, const char* words )
{
    fixture f;
    assert_int_equal( try_build( &f, scene_with( keys ) ), status );
    if ( strstr( f.error.message, words ) == NULL || strstr( f.error.message, ":3:" ) == NULL )
    {
        fail_msg( "'%s' has not '%s' or no line", f.error.message, words );
    }
    wisp_scene_release( &f.scene );
}

static void bad_maps_are_refused_with_file_line_or_vertex( void** state )
{
    (void)state;
    write_map( "1 2 3\n4 5\n" );
    demand_map_refusal( "area_density: { map: %s/map.txt }", WISP_BAD_INPUT,
                        "map.txt: got 5 numbers, but the mesh has 6 vertices" );
    write_map( "1 2 3\n4 x5 6\n" );
    demand_map_refusal( "area_density: { map: %s/map.txt }", WISP_BAD_INPUT,
                        "map.txt:2: got 'x5', expected a finite number" );
    write_map( "1 2 3\n4 5 nan\n" );
    demand_map_refusal( "area_density: { map: %s/map.txt }", WISP_BAD_INPUT, "map.txt:2: got 'nan'" );
    write_map( "1 2 3\n4 -5 6\n" );
    demand_map_refusal( "area_density: { map: %s/map.txt }", WISP_BAD_INPUT, "map.txt: vertex 4: got -5, expected" );
    demand_map_refusal( "area_density: { map: %s/missing.txt }", WISP_IO_ERROR, "missing.txt" );
    demand_map_refusal( "area_density: { map: %s/missing.png }", WISP_BAD_INPUT, "missing.png: is not a PNG image" );
    write_map( "1 1 1 1 1 1" );
    demand_map_refusal( "cloth: { solver: pbd, warp_compliance: { map: %s/map.txt } }", WISP_BAD_INPUT,
                        "map.stretch_compliance: entity" );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( numbers_of_a_text_file_are_values_of_vertices ),
        cmocka_unit_test( from_and_to_are_the_values_of_zero_and_one ),
        cmocka_unit_test( an_image_is_sampled_from_left_to_right_along_x_and_from_top_to_bottom_along_z ),
        cmocka_unit_test( bad_maps_are_refused_with_file_line_or_vertex ),
    };
    return cmocka_run_group_tests( tests, make_folder, remove_folder );
}
