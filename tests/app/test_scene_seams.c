// Seams of scenes: keys, names, vertices after a repair, what is refused once meshes are known, reports.
#include "scene_world_fixture.h"

#include "wisp/module/module.h"

static const char TWO_PANELS[] =
    "wisp: 1\n"
    "gravity: [0, 0, 0]\n"
    "surfaces:\n"
    "  - { name: a, generate: { shape: plane, columns: 4, rows: 4, spacing: 0.1 }, cloth: {} }\n"
    "  - { name: b, instance_of: a, transform: { translate: [0.35, 0, 0] }, cloth: {} }\n"
    "seams:\n";

static void build_sewn( fixture* f, const char* seam )
{
    char text[1500];
    snprintf( text, sizeof text, "%s  - %s\n", TWO_PANELS, seam );
    build( f, text );
}

TEST( every_key_of_a_seam_reaches_its_place )
{
    fixture f;
    build_sewn( &f, "{ name: s, surfaces: [b, a], pairs: [[4, 7], [8, 11]], distance: 0.01, closing_speed: 0.2, "
                    "compliance: 0.03, strength: 4 }\n"
                    "  - { name: t, surfaces: [a, b], within: 0.06 }" );
    const wisp_scene_seam* s = f.scene.seams;
    static const int32_t pairs[] = { 4, 7, 8, 11 };
    assert_int_equal( f.scene.seam_count, 2 );
    assert_string_equal( s->name, "s" );
    assert_true( s->surfaces[0] == 1 && s->surfaces[1] == 0 && s->pair_count == 2 );
    assert_memory_equal( s->pairs, pairs, sizeof pairs );
    assert_true( s->def.distance == 0.01f && s->def.closing_speed == 0.2f && s->def.compliance == 0.03f &&
                 s->def.strength == 4.0f && s->def.within == 0.0f );
    assert_true( s[1].def.within == 0.06f && s[1].def.strength == INFINITY && s[1].def.closing_speed == 1.0f );
    assert_int_equal( wisp_count_seam_pairs( f.world.world, f.world.seams[0] ), 2 );
    assert_int_equal( wisp_count_seam_pairs( f.world.world, f.world.seams[1] ), 4 );
    release( &f );
}

// Panels of a scene close by the speed of their seam.
TEST( a_scene_closes_its_seam )
{
    fixture f;
    build_sewn( &f, "{ name: s, surfaces: [a, b], within: 0.06, closing_speed: 0.2 }" );
    step( &f, 30 );
    for ( int i = 0; i < 4; ++i )
    {
        const wisp_vec3 a = point_of( &f, 0, 4 * i + 3 ), b = point_of( &f, 1, 4 * i );
        assert_true( fabsf( a.x - b.x ) < 1e-4f && fabsf( a.y - b.y ) < 1e-4f && fabsf( a.z - b.z ) < 1e-4f );
    }
    release( &f );
}

// The file has a vertex that no triangle names, which a repair removes; scenes keep the numbers of the file.
TEST( vertices_are_numbered_as_in_the_file )
{
    static const wisp_vec3 points[] = { { 0, 0, 0 }, { 9, 9, 9 }, { 1, 0, 0 }, { 0, 0, 1 } };
    static const int32_t triangles[] = { 0, 3, 2 };
    const wisp_scene_arrays arrays = {
        .file = "tri.obj", .points = points, .point_count = 4, .triangles = triangles, .triangle_count = 1
    };
    static const char* const PAIRS[] = { "[[3, 2]]", "[[0, 1]]" };
    for ( int i = 0; i < 2; ++i )
    {
        char text[500];
        snprintf( text, sizeof text,
                  "wisp: 1\nsurfaces:\n  - { name: a, file: tri.obj, repair: [unreferenced] }\n"
                  "seams:\n  - { name: s, surfaces: [a, a], pairs: %s }\n",
                  PAIRS[i] );
        wisp_scene scene;
        wisp_error error = { 0 };
        scene_world world;
        assert_ok( wisp_scene_parse( text, strlen( text ), "test", &scene, &error ), error );
        assert_ok( wisp_scene_set_arrays( &scene, &arrays, 1, &error ), error );
        const scene_world_options options = { .is_quiet = true };
        const wisp_status status = scene_world_create( &scene, &options, &world, &error );
        if ( i == 0 )
        {
            wisp_vec3 now[3];
            assert_ok( status, error );
            for ( int k = 0; k < 60; ++k )
            {
                assert_ok( scene_world_step( &world, &error ), error );
            }
            assert_ok( scene_world_points( &world, 0, now, &error ), error );
            assert_true( fabsf( now[2].x - now[1].x ) < 0.3f && fabsf( now[2].z - now[1].z ) < 0.3f );
            assert_true( fabsf( now[0].x ) < 1e-6f && fabsf( now[0].z ) < 1e-6f );
            scene_world_destroy( &world );
        }
        else
        {
            assert_int_equal( status, WISP_BAD_INPUT );
            assert_contains( error.message, "test:5:5: seam 's': pairs[0]: got vertex 1 of 'a'" );
        }
        wisp_scene_release( &scene );
    }
}

TEST( what_only_the_world_knows_is_refused_with_its_line )
{
    static const char* const BAD[][2] = {
        { "{ name: s, surfaces: [a, b], within: 0.04 }", "test:7:5: seam 's': seams: no boundary vertex" },
        { "{ name: s, surfaces: [a, b], pairs: [[0, 16]] }", "test:7:5: seam 's': pairs[0]: got vertex 16 of 'b'" },
    };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        char text[1500];
        wisp_scene scene;
        wisp_error error = { 0 };
        scene_world world;
        snprintf( text, sizeof text, "%s  - %s\n", TWO_PANELS, BAD[i][0] );
        assert_ok( wisp_scene_parse( text, strlen( text ), "test", &scene, &error ), error );
        const scene_world_options options = { .is_quiet = true };
        assert_int_equal( scene_world_create( &scene, &options, &world, &error ), WISP_BAD_INPUT );
        assert_contains( error.message, BAD[i][1] );
        wisp_scene_release( &scene );
    }
}

TEST( only_a_scene_with_seams_has_the_module )
{
    const wisp_module* used[SCENE_MAX_MODULES];
    fixture f;
    build_sewn( &f, "{ name: s, surfaces: [a, b], within: 0.06 }" );
    const int with = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 0;
    const int without = scene_world_used_modules( &f.scene, used );
    f.scene.seam_count = 1;
    assert_int_equal( with, without + 1 );
    release( &f );
}
