// Tearing of scenes: keys, spare vertices, instances, maps of the strength, bodies whose triangles change.
#include "folder_fixture.h"

#include "scene_world_fixture.h"

enum
{
    SIDE = 6,
    OWN = SIDE * SIDE,
    TRIANGLES = 2 * ( SIDE - 1 ) * ( SIDE - 1 ),
};

// Sheets that hang along z from their first row. Their weight is 0.23 N/m of width.
static const char SHEETS[] = "wisp: 1\n"
                             "gravity: [0, 0, 9.81]\n"
                             "substeps: 4\n"
                             "iterations: 4\n"
                             "surfaces:\n"
                             "  - name: a\n"
                             "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.03 }\n"
                             "    pins: [0, 1, 2, 3, 4, 5]\n"
                             "    cloth: {}\n"
                             "    tearing: { strength: %s, max_splits: 7, max_new_vertices: 12 }\n"
                             "  - name: b\n"
                             "    instance_of: a\n"
                             "    transform: { translate: [1, 0, 0] }\n"
                             "    pin_box: { min: [0, -1, -1], max: [2, 1, 1] }\n"
                             "    cloth: {}\n"
                             "    tearing: { strength: %s }\n";

static void build_sheets( fixture* f, const char* a, const char* b )
{
    char text[2000];
    snprintf( text, sizeof text, SHEETS, a, b );
    build( f, text );
}

TEST( every_key_reaches_its_place_and_meshes_have_spare_vertices )
{
    fixture f;
    build_sheets( &f, "80", "90" );
    const wisp_scene_surface* s = f.scene.surfaces;
    assert_true( s->has_tearing && s->tearing.strength == 80.0f && s->tearing.max_splits == 7 );
    assert_true( s->max_new_vertices == 12 && s[1].max_new_vertices == -1 && s[1].tearing.max_splits == 64 );
    // the instance asks for more: a quarter of 36, at least 64
    for ( int i = 0; i < 2; ++i )
    {
        wisp_tearing_stats stats;
        assert_int_equal( f.world.surfaces[i].spare_count, 64 );
        assert_int_equal( wisp_read_tearing_stats( f.world.world, f.world.surfaces[i].entity, &stats ), WISP_OK );
        assert_int_equal( stats.spare_count, 64 );
    }
    // spare vertices are not pinned, although they lie where a pin is
    assert_int_equal( f.world.surfaces[0].pin_count, SIDE );
    assert_int_equal( f.world.surfaces[1].pin_count, OWN );
    release( &f );
}

TEST( an_instance_tears_on_its_own_and_bodies_show_it )
{
    fixture f;
    build_sheets( &f, "0.01", "1e6" );
    int32_t before[3 * TRIANGLES];
    const scene_body a = scene_world_body( &f.world, 0 ), b = scene_world_body( &f.world, 1 );
    assert_true( a.tears && b.tears && a.triangle_count == TRIANGLES && b.triangle_count == TRIANGLES );
    assert_true( a.triangles != b.triangles );
    memcpy( before, a.triangles, sizeof before );
    assert_memory_equal( b.triangles, before, sizeof before );
    step( &f, 20 );
    assert_true( f.world.surfaces[0].split_count > 0 && f.world.surfaces[1].split_count == 0 );
    assert_true( memcmp( a.triangles, before, sizeof before ) != 0 ); // the same array
    assert_memory_equal( b.triangles, before, sizeof before );
    int largest = 0;
    for ( int i = 0; i < 3 * TRIANGLES; ++i )
    {
        largest = a.triangles[i] > largest ? a.triangles[i] : largest;
    }
    assert_int_equal( largest, OWN + f.world.surfaces[0].split_count - 1 );
    release( &f );
}

// The strength grows from left to right: only the left tears.
TEST_WITH( a_map_of_the_strength_is_one_number_per_vertex_of_the_mesh, make_folder, remove_folder )
{
    fixture f;
    const char* path = path_in( state, "strength.txt" );
    FILE* file = fopen( path, "w" );
    assert_non_null( file );
    for ( int v = 0; v < OWN; ++v )
    {
        fprintf( file, "%s\n", v % SIDE < 3 ? "1e-6" : "1" );
    }
    fclose( file );
    char map[600];
    snprintf( map, sizeof map, "{ map: %s, to: 1000 }", path );
    build_sheets( &f, map, "1e6" );
    step( &f, 20 );
    const scene_body a = scene_world_body( &f.world, 0 );
    assert_true( f.world.surfaces[0].split_count > 0 );
    for ( int t = 0; t < TRIANGLES; ++t )
    {
        const int column = t / 2 % ( SIDE - 1 ); // cells are row by row
        for ( int k = 0; k < 3 && column >= 3; ++k )
        {
            assert_true( a.triangles[3 * t + k] < OWN );
        }
    }
    release( &f );
}
