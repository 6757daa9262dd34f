// Implicit cloth of scenes: every key sets its field, quad links are those of Choi and Ko, and scenes run.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

// ---- missing keys ----

TEST( an_implicit_cloth_without_keys_has_the_defaults_of_its_module )
{
    wisp_scene scene = with_block( "implicit", "{}" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_implicit_cloth_def *d = &s->implicit, def = wisp_default_implicit_cloth_def();
    assert_true( s->has_implicit && !s->has_cloth && !s->has_balloon && !s->has_quad_links );
    assert_true( d->stretch_stiffness == def.stretch_stiffness && d->bend_stiffness == def.bend_stiffness );
    assert_true( d->bend_rigidity == def.bend_rigidity && d->compression_stiffness == def.compression_stiffness );
    assert_true( d->link_damping == def.link_damping && d->tolerance == def.tolerance );
    assert_true( d->stiffness_model == def.stiffness_model && d->weights == def.weights );
    assert_true( d->integrator == def.integrator );
    assert_int_equal( d->newton_iterations, def.newton_iterations );
    assert_int_equal( d->max_newton_iterations, def.max_newton_iterations );
    assert_int_equal( d->max_iterations, def.max_iterations );
    assert_int_equal( d->size, def.size );
    wisp_scene_release( &scene );
}

TEST( a_surface_without_the_key_is_no_implicit_cloth )
{
    wisp_scene scene = parsed( "wisp: 1\nsurfaces:\n  - { name: cloth, generate: { shape: plane }, cloth: {} }\n" );
    assert_false( scene.surfaces[0].has_implicit || scene.surfaces[0].has_quad_links );
    wisp_scene_release( &scene );
}

// ---- given keys ----

TEST( every_key_of_an_implicit_cloth_reaches_its_place )
{
    wisp_scene scene = with_block(
        "implicit", "{ stiffness_model: material, stretch_stiffness: 350, bend_stiffness: 2e-6, bend_rigidity: 3e-6, "
                    "compression_stiffness: "
                    "150, link_damping: 0.5, weights: none, integrator: bdf2, "
                    "newton_iterations: 3, "
                    "max_newton_iterations: 5, "
                    "tolerance: 1e-6, max_iterations: 77, links: mesh }" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_implicit_cloth_def* d = &s->implicit;
    assert_int_equal( d->stiffness_model, WISP_IMPLICIT_STIFFNESS_MATERIAL );
    assert_true( d->stretch_stiffness == 350.0f && d->bend_stiffness == 2e-6f && d->bend_rigidity == 3e-6f );
    assert_true( d->compression_stiffness == 150.0f && d->link_damping == 0.5f );
    assert_int_equal( d->weights, WISP_IMPLICIT_WEIGHTS_NONE );
    assert_int_equal( d->integrator, WISP_INTEGRATOR_BDF2 );
    assert_int_equal( d->newton_iterations, 3 );
    assert_int_equal( d->max_newton_iterations, 5 );
    assert_int_equal( d->max_iterations, 77 );
    assert_true( d->tolerance == 1e-6f && !s->has_quad_links );
    wisp_scene_release( &scene );
}

TEST( every_word_is_the_enumerator_of_its_name )
{
    static const struct
    {
        const char* mapping;
        size_t at;
        int value;
    } words[] = {
#define WORD( key, member, word, value )                                                                             \
    { "{ " #key ": " #word " }", offsetof( wisp_implicit_cloth_def, member ), value }
        WORD( stiffness_model, stiffness_model, link, WISP_IMPLICIT_STIFFNESS_LINK ),
        WORD( stiffness_model, stiffness_model, material, WISP_IMPLICIT_STIFFNESS_MATERIAL ),
        WORD( weights, weights, effective, WISP_IMPLICIT_WEIGHTS_EFFECTIVE ),
        WORD( weights, weights, none, WISP_IMPLICIT_WEIGHTS_NONE ),
        WORD( integrator, integrator, euler, WISP_INTEGRATOR_EULER ),
        WORD( integrator, integrator, bdf2, WISP_INTEGRATOR_BDF2 ),
#undef WORD
    };
    // One word for each enumerator.
    assert_int_equal( WISP_COUNT( words ),
                      WISP_IMPLICIT_STIFFNESS_COUNT + WISP_IMPLICIT_WEIGHTS_COUNT + WISP_INTEGRATOR_COUNT );
    for ( int i = 0; i < WISP_COUNT( words ); ++i )
    {
        wisp_scene scene = with_block( "implicit", words[i].mapping );
        int value = -1;
        memcpy( &value, (const char*)&scene.surfaces[0].implicit + words[i].at, sizeof value );
        assert_int_equal( value, words[i].value );
        wisp_scene_release( &scene );
    }
}

TEST( quad_links_are_taken_of_a_plane_and_of_its_instances )
{
    wisp_scene scene =
        parsed( "wisp: 1\nsurfaces:\n"
                "  - { name: a, generate: { shape: plane }, implicit: { links: quad } }\n"
                "  - { name: b, instance_of: a, implicit: { links: quad }, compute: [effect_stats] }\n" );
    assert_true( scene.surfaces[0].has_quad_links && scene.surfaces[1].has_quad_links );
    assert_true( scene.surfaces[1].request_stats && !scene.surfaces[0].request_stats );
    assert_null( scene.surfaces[0].implicit.stretch_pairs );
    wisp_scene_release( &scene );
}

TEST( a_scene_with_every_key_of_implicit_cloth_is_read )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_scene_read( WISP_SOURCE_ROOT "/tests/app/scenes/implicit_cloth.yaml", &scene, &error ), error );
    assert_int_equal( scene.surface_count, 2 );
    assert_true( scene.surfaces[0].has_implicit && scene.surfaces[1].has_implicit );
    assert_true( !scene.surfaces[0].has_quad_links && scene.surfaces[1].has_quad_links );
    wisp_scene_release( &scene );
}

// ---- pairs ----

TEST( a_grid_of_25_by_25_has_2352_pairs_that_stretch_and_2208_that_bend )
{
    wisp_quad_pairs pairs;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_quad_pairs_make( 25, 25, &pairs, &error ), WISP_OK );
    // 24 * 25 along each side and 24 * 24 along each diagonal; 23 in place of 24 two apart
    assert_int_equal( pairs.stretch_count, 2 * 24 * 25 + 2 * 24 * 24 );
    assert_int_equal( pairs.stretch_count, 2352 );
    assert_int_equal( pairs.bend_count, 2 * 23 * 25 + 2 * 23 * 23 );
    assert_int_equal( pairs.bend_count, 2208 );

    int neighbours[625] = { 0 };
    for ( int i = 0; i < 2 * pairs.stretch_count; ++i )
    {
        ++neighbours[pairs.stretch[i]];
    }
    for ( int i = 0; i < 2 * pairs.bend_count; ++i )
    {
        ++neighbours[pairs.bend[i]];
    }
    for ( int j = 2; j < 23; ++j )
    {
        for ( int i = 2; i < 23; ++i )
        {
            assert_int_equal( neighbours[25 * j + i], 16 );
        }
    }
    assert_int_equal( neighbours[0], 6 );
    wisp_quad_pairs_release( &pairs );
    assert_null( pairs.stretch );
}

// How many pairs of a list join the two, whichever comes first.
static int joined( const int32_t* pairs, int count, int a, int b )
{
    int found = 0;
    for ( int i = 0; i < count; ++i )
    {
        found += ( pairs[2 * i] == a && pairs[2 * i + 1] == b ) || ( pairs[2 * i] == b && pairs[2 * i + 1] == a );
    }
    return found;
}

TEST( pairs_of_a_grid_are_first_and_second_neighbours_each_once )
{
    static const int sizes[][2] = { { 2, 2 }, { 2, 5 }, { 3, 2 }, { 3, 3 }, { 7, 5 } };
    for ( int k = 0; k < WISP_COUNT( sizes ); ++k )
    {
        const int columns = sizes[k][0], count = columns * sizes[k][1];
        wisp_quad_pairs pairs;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_quad_pairs_make( columns, sizes[k][1], &pairs, &error ), WISP_OK );
        int stretch = 0, bend = 0;
        for ( int a = 0; a < count; ++a )
        {
            for ( int b = a + 1; b < count; ++b )
            {
                const int x = abs( a % columns - b % columns ), y = abs( a / columns - b / columns );
                const int first = x <= 1 && y <= 1, second = ( x == 0 || x == 2 ) && ( y == 0 || y == 2 );
                assert_int_equal( joined( pairs.stretch, pairs.stretch_count, a, b ), first );
                assert_int_equal( joined( pairs.bend, pairs.bend_count, a, b ), second );
                stretch += first;
                bend += second;
            }
        }
        assert_int_equal( pairs.stretch_count, stretch );
        assert_int_equal( pairs.bend_count, bend );
        wisp_quad_pairs_release( &pairs );
    }
}

TEST( a_grid_that_is_no_grid_or_too_large_has_no_pairs )
{
    static const int sizes[][2] = { { 1, 5 }, { 5, 1 }, { 0, 0 }, { -3, -3 }, { 65536, 65536 }, { 8192, 8193 } };
    for ( int k = 0; k < WISP_COUNT( sizes ); ++k )
    {
        wisp_quad_pairs pairs;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_quad_pairs_make( sizes[k][0], sizes[k][1], &pairs, &error ), WISP_BAD_INPUT );
        assert_non_null( strstr( error.message, "quad pairs: " ) );
        assert_true( !pairs.stretch && !pairs.bend && pairs.stretch_count == 0 && pairs.bend_count == 0 );
    }
}

// ---- worlds ----

static wisp_implicit_cloth_stats stats_of( fixture* f, int surface )
{
    wisp_implicit_cloth_stats stats = { 0 };
    assert_int_equal( wisp_read_implicit_cloth_stats( f->world.world, f->world.surfaces[surface].entity, &stats ),
                      WISP_OK );
    return stats;
}

static wisp_vec3 first_point( fixture* f )
{
    const int count = scene_world_body( &f->world, 0 ).vertex_count;
    wisp_vec3* points = checked_calloc( (size_t)count, sizeof *points );
    assert_int_equal( scene_world_points( &f->world, 0, points, &f->error ), WISP_OK );
    wisp_vec3 point = points[0];
    free( points );
    return point;
}

TEST( a_plane_with_quad_links_has_the_links_of_the_quad_reference )
{
    fixture f;
    build( &f, "wisp: 1\ndt: 0.01\nsurfaces:\n"
               "  - { name: a, generate: { shape: plane, columns: 25, rows: 25 }, pins: [0], compute: [points, "
               "effect_stats], "
               "implicit: { links: quad } }\n"
               "  - { name: b, instance_of: a, compute: [points, effect_stats], implicit: { links: quad } }\n" );
    step( &f, 1 );
    for ( int i = 0; i < 2; ++i )
    {
        wisp_implicit_cloth_stats stats = stats_of( &f, i );
        assert_int_equal( stats.stretch_links, 2352 );
        assert_int_equal( stats.bend_links, 2208 );
        assert_int_equal( stats.max_neighbours, 16 );
    }
    release( &f );
}

TEST( a_mesh_with_its_own_links_stretches_along_edges_and_bends_across_them )
{
    fixture f;
    build(
        &f,
        "wisp: 1\ndt: 0.01\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 5, rows: 4 }, pins: [0], compute: [points, effect_stats], "
        "implicit: {} }\n" );
    step( &f, 1 );
    // 4 * 4 + 5 * 3 along the sides, 4 * 3 diagonals of cells; an edge has two triangles unless it is one of the 14
    // of the border, and no two edges of a regular plane have the same opposite vertices
    wisp_implicit_cloth_stats stats = stats_of( &f, 0 );
    assert_int_equal( stats.stretch_links, 43 );
    assert_int_equal( stats.bend_links, 43 - 14 );
    assert_int_equal( scene_world_body( &f.world, 0 ).kind, SCENE_BODY_CLOTH );
    release( &f );
}

TEST( a_hung_cloth_keeps_its_pin_and_falls )
{
    fixture f;
    build(
        &f,
        "wisp: 1\ndt: 0.01\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 9, rows: 9 }, pins: [0], compute: [points], implicit: { "
        "link_damping: 0 } }\n" );
    wisp_vec3 start = first_point( &f );
    step( &f, 20 );
    wisp_vec3 end = first_point( &f );
    assert_true( start.x == end.x && start.y == end.y && start.z == end.z );
    wisp_vec3* points = checked_calloc( 81, sizeof *points );
    assert_int_equal( scene_world_points( &f.world, 0, points, &f.error ), WISP_OK );
    // in 0.2 s a free vertex falls 0.2 m, and so does the far corner of a stiff plate 0.16 m wide that turns about its
    // pin; cloth bends on the way
    assert_true( points[80].y < -0.05f );
    free( points );
    release( &f );
}

// Without a restart, BDF2 would use the velocity before the event in the step: x + 2/3 h v instead of x + h v.
TEST( a_velocity_of_an_event_counts_from_its_step_on_whatever_the_integrator )
{
    static const char* const integrators[] = { "euler", "bdf2" };
    static const char* const keys[] = { "velocity", "gust" };
    for ( int i = 0; i < 4; ++i )
    {
        char text[512];
        snprintf( text, sizeof text,
                  "wisp: 1\nsteps: 10\ndt: 0.01\ngravity: [0, 0, 0]\nsurfaces:\n"
                  "  - { name: a, generate: { shape: plane, columns: 4, rows: 4 }, compute: [points], implicit: { "
                  "integrator: "
                  "%s } }\n"
                  "events:\n  - { step: 4, surface: a, %s: [0, -1, 0] }\n",
                  integrators[i % 2], keys[i / 2] );
        fixture f;
        build( &f, text );
        step( &f, 4 );
        assert_true( fabsf( first_point( &f ).y ) < 1e-7f );
        step( &f, 1 );
        // nothing but rounding of numbers near 0.03 m
        assert_true( fabsf( first_point( &f ).y + 0.01f ) < 1e-7f );
        release( &f );
    }
}

TEST( the_ends_of_all_ranges_are_taken_by_the_module )
{
    static const char* const mappings[] = {
        "{ stretch_stiffness: 0, bend_stiffness: 0, link_damping: 0, newton_iterations: 1, tolerance: 1e-7, "
        "max_iterations: "
        "0 }",
        "{ stretch_stiffness: 1e9, bend_stiffness: 1e9, compression_stiffness: 1e9, link_damping: 1e9, "
        "newton_iterations: "
        "64, tolerance: 0.1, max_iterations: 1000000 }",
        "{ stiffness_model: material, weights: none, bend_rigidity: 0 }",
        "{ stiffness_model: material, weights: effective, bend_rigidity: 1e9 }",
    };
    for ( int i = 0; i < WISP_COUNT( mappings ); ++i )
    {
        fixture f = { .scene = with_block( "implicit", mappings[i] ) };
        create( &f, 1 );
        release( &f );
    }
}

// ---- scenes of the project ----

TEST( the_scenes_of_the_project_with_implicit_cloth_run )
{
    static const char* const files[] = { "triangle_drape.yaml", "quad_drape.yaml", "garment_drop.yaml",
                                         "moving_floor_cloth.yaml", "stiff_thirtieth.yaml" };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        fixture f = { .scene = read_good( files[i] ) };
        assert_true( f.scene.surfaces[0].has_implicit );
        create( &f, 2 );
        assert_int_equal( wisp_request_implicit_cloth_stats( f.world.world, f.world.surfaces[0].entity, true ),
                          WISP_OK );
        step( &f, 3 );
        assert_true( stats_of( &f, 0 ).iterations > 0 );
        assert_true( wisp_world_counter( f.world.world, WISP_COUNT_HALTED ) == 0 );
        release( &f );
    }
}
