// Boundary particles, contact and implicit cloth of scenes: layers follow their surfaces and do not change them, statistics exist where requested, quad links are those of Choi and Ko, and the scenes of the project run.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

TEST( an_instance_has_a_layer_and_a_contact_of_its_own )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        parsed( "wisp: 1\nsurfaces:\n"
                "  - { name: a, generate: { shape: icosphere, level: 1 }, boundary: { spacing: 0.1 } }\n"
                "  - { name: b, instance_of: a, contact: { friction: 0.9 } }\n" );
    assert_true( scene.surfaces[0].has_boundary && !scene.surfaces[1].has_boundary );
    assert_true( !scene.surfaces[0].has_contact && scene.surfaces[1].has_contact );
    assert_true( scene.surfaces[1].contact.friction == 0.9f );
}

// ---- worlds ----

#define BALL                                                                                                         \
    "wisp: 1\nsubsteps: 4\nsurfaces:\n"                                                                              \
    "  - name: ball\n    generate: { shape: icosphere, level: 2, radius: 0.2 }\n    balloon: { gas_ratio: 1.2 }\n"   \
    "    compute: [points, normals]\n"

TEST( a_surface_without_a_layer_is_named )
{
    SCOPED( release ) fixture f;
    build( &f, BALL );
    wisp_boundary_view view;
    assert_int_equal( scene_world_layer( &f.world, 0, &view, &f.error ), WISP_CONFLICT );
    assert_non_null( strstr( f.error.message, "test.yaml: 'ball': " ) );
}

TEST( a_layer_is_there_from_the_start_and_lies_on_its_surface )
{
    SCOPED( release ) fixture f;
    build( &f, BALL "    boundary: { spacing: 0.02 }\n" );
    wisp_boundary_view view;
    assert_int_equal( scene_world_layer( &f.world, 0, &view, &f.error ), WISP_OK );
    assert_true( view.samples->count > 480 );

    step( &f, 2 );
    assert_int_equal( scene_world_layer( &f.world, 0, &view, &f.error ), WISP_OK );
    wisp_vec3 points[162], normals[162];
    assert_int_equal( scene_world_points( &f.world, 0, points, &f.error ), WISP_OK );
    assert_int_equal( scene_world_normals( &f.world, 0, normals, &f.error ), WISP_OK );
    assert_int_equal( view.edge_count, 480 );
    assert_true( view.samples->count > 480 && view.samples->edge_count > 0 );
    for ( int i = 0; i < view.samples->edge_count; ++i )
    {
        int32_t edge;
        memcpy( &edge, &view.samples->xyzw[4 * i + 3], sizeof edge );
        assert_in_range( edge, 0, 479 );
        const wisp_vec3 a = points[view.edges[2 * edge]], b = points[view.edges[2 * edge + 1]];
        const float* p = &view.samples->xyzw[4 * i];
        const double ab = hypot( hypot( (double)( b.x - a.x ), (double)( b.y - a.y ) ), (double)( b.z - a.z ) );
        const double ap = hypot( hypot( (double)( p[0] - a.x ), (double)( p[1] - a.y ) ), (double)( p[2] - a.z ) );
        const double pb = hypot( hypot( (double)( b.x - p[0] ), (double)( b.y - p[1] ) ), (double)( b.z - p[2] ) );
        // coordinates are 0.2 m and floats: their rounding, some 1e-8 m, in each of three lengths
        assert_true( fabs( ap + pb - ab ) < 1e-6 );
    }
    for ( int v = 0; v < 162; ++v )
    {
        const wisp_vec3 n = normals[v];
        assert_true( fabsf( n.x * n.x + n.y * n.y + n.z * n.z - 1.0f ) < 1e-5f );
    }
}

TEST( a_layer_changes_no_bit_of_its_surface )
{
    SCOPED( release ) fixture with, without;
    build( &with, BALL "    boundary: { spacing: 0.02, curvature_gain: 1, hysteresis: 0.2 }\n" );
    build( &without, BALL );
    step( &with, 5 );
    step( &without, 5 );
    wisp_vec3 a[162], b[162];
    assert_int_equal( scene_world_points( &with.world, 0, a, &with.error ), WISP_OK );
    assert_int_equal( scene_world_points( &without.world, 0, b, &without.error ), WISP_OK );
    assert_memory_equal( a, b, sizeof a );
}

// ---- contact in worlds ----

#define TWO_SHEETS                                                                                                   \
    "surfaces:\n"                                                                                                    \
    "  - { name: low, generate: { shape: plane, columns: 8, rows: 8 }, cloth: {}, pins: [0, 7, 56, 63], contact: "   \
    "{} }\n"                                                                                                         \
    "  - { name: high, instance_of: low, transform: { translate: [0, 0.02, 0] }, cloth: {}, contact: {} }\n"

TEST( stats_of_contact_are_there_where_they_are_requested )
{
    SCOPED( release ) fixture f;
    wisp_contact_stats stats;
    build( &f, "wisp: 1\nsubsteps: 4\n" TWO_SHEETS );
    step( &f, 1 );
    assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_CONFLICT );
    release( &f );

    build( &f, "wisp: 1\nsubsteps: 4\ncontact: { compute: [stats] }\n" TWO_SHEETS );
    step( &f, 1 );
    assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_OK );
    assert_int_equal( stats.participants, 2 );
    assert_int_equal( stats.intersections, -1 );
    release( &f );

    build( &f, "wisp: 1\nsubsteps: 4\ncontact: { compute: [intersections] }\n" TWO_SHEETS );
    step( &f, 1 );
    assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_OK );
    assert_int_equal( stats.intersections, 0 );
}

TEST( implicit_cloth_takes_part_in_contact )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\ncontact: { compute: [stats] }\nsurfaces:\n"
               "  - { name: cloth, generate: { shape: plane }, implicit: {}, contact: {} }\n" );
    step( &f, 1 );
    wisp_contact_stats stats;
    assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_OK );
    assert_int_equal( stats.participants, 1 );
}

TEST( what_only_the_mesh_can_tell_is_refused_at_the_line_of_its_surface )
{
    // The mean edge of a plane of spacing 0.02 is below 0.03; four times half of it is below 1.
    fixture f = { .scene =
                      parsed( "wisp: 1\nsurfaces:\n"
                              "  - { name: cloth, generate: { shape: plane }, boundary: { min_spacing: 1 } }\n" ) };
    const scene_world_options options = { .workers = 1 };
    assert_int_equal( scene_world_create( &f.scene, &options, &f.world, &f.error ), WISP_BAD_INPUT );
    assert_non_null( strstr( f.error.message, "test.yaml:3:5: surface 'cloth': " ) );
    wisp_scene_release( &f.scene );
}

TEST( quad_links_are_taken_of_a_plane_and_of_its_instances )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        parsed( "wisp: 1\nsurfaces:\n"
                "  - { name: a, generate: { shape: plane }, implicit: { stiffness_model: link, links: quad } }\n"
                "  - { name: b, instance_of: a, implicit: { stiffness_model: link, links: quad }, compute: "
                "[effect_stats] }\n" );
    assert_true( scene.surfaces[0].has_quad_links && scene.surfaces[1].has_quad_links );
    assert_true( scene.surfaces[1].request_stats && !scene.surfaces[0].request_stats );
    assert_null( scene.surfaces[0].implicit.stretch_pairs );
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
        SCOPED( wisp_quad_pairs_release ) wisp_quad_pairs pairs;
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

TEST( a_plane_with_quad_links_has_the_links_of_the_quad_reference )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\ndt: 0.01\nsurfaces:\n"
               "  - { name: a, generate: { shape: plane, columns: 25, rows: 25 }, pins: [0], compute: [points, "
               "effect_stats], "
               "implicit: { stiffness_model: link, links: quad } }\n"
               "  - { name: b, instance_of: a, compute: [points, effect_stats], implicit: { stiffness_model: link, "
               "links: quad } }\n" );
    step( &f, 1 );
    for ( int i = 0; i < 2; ++i )
    {
        wisp_implicit_cloth_stats stats = stats_of( &f, i );
        assert_int_equal( stats.stretch_links, 2352 );
        assert_int_equal( stats.bend_links, 2208 );
        assert_int_equal( stats.max_neighbours, 16 );
    }
}

TEST( a_mesh_with_its_own_links_stretches_along_edges_and_bends_across_them )
{
    SCOPED( release ) fixture f;
    build(
        &f,
        "wisp: 1\ndt: 0.01\nsurfaces:\n"
        "  - { name: a, generate: { shape: plane, columns: 5, rows: 4 }, pins: [0], compute: [points, effect_stats], "
        "implicit: { stiffness_model: link } }\n" );
    step( &f, 1 );
    // 4 * 4 + 5 * 3 along the sides, 4 * 3 diagonals of cells; an edge has two triangles unless it is one of the 14
    // of the border, and no two edges of a regular plane have the same opposite vertices
    wisp_implicit_cloth_stats stats = stats_of( &f, 0 );
    assert_int_equal( stats.stretch_links, 43 );
    assert_int_equal( stats.bend_links, 43 - 14 );
    assert_int_equal( scene_world_body( &f.world, 0 ).kind, SCENE_BODY_CLOTH );
}
