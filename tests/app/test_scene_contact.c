// Boundary particles, contact and implicit cloth of scenes: every key sets its field, layers follow their surfaces and do
// not change them, statistics exist where requested, quad links are those of Choi and Ko, and the scenes of the project run.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

static wisp_scene with_settings( const char* mapping )
{
    char text[512];
    int length = snprintf( text, sizeof text, "wisp: 1\ncontact: %s\n", mapping );
    assert_true( length > 0 && (size_t)length < sizeof text );
    return parsed( text );
}

// ---- missing keys ----

TEST( a_layer_without_keys_has_the_defaults_of_its_module )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = with_block( "boundary", "{}" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_boundary_def *b = &s->boundary, def = wisp_default_boundary_def();
    assert_true( s->has_boundary && !s->has_contact );
    assert_true( b->spacing == def.spacing && b->policy == def.policy && b->rounding == def.rounding );
    assert_true( b->hysteresis == def.hysteresis );
    assert_true( b->max_points == def.max_points && b->min_spacing == def.min_spacing );
    assert_true( b->max_spacing == def.max_spacing && b->curvature_gain == def.curvature_gain );
    assert_true( b->strain_gain == def.strain_gain && b->eye_angle == def.eye_angle );
    assert_int_equal( b->size, def.size );
}

TEST( a_participant_without_keys_has_the_defaults_of_its_module )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = with_block( "contact", "{}" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_contact_def *c = &s->contact, def = wisp_default_contact_def();
    assert_true( s->has_contact && !s->has_boundary && !scene.has_contact );
    assert_true( c->thickness == def.thickness && c->friction == def.friction && c->self == def.self );
    assert_true( c->max_push_out_speed == def.max_push_out_speed && c->enabled == def.enabled );
    assert_true( c->layers == def.layers && c->mask == def.mask );
    assert_int_equal( c->size, def.size );
}

TEST( contact_of_a_scene_has_the_defaults_of_its_module )
{
    const wisp_contact_settings def = wisp_default_contact_settings();
    const char* const texts[] = { "wisp: 1\n", "wisp: 1\ncontact: {}\n" };
    for ( int i = 0; i < WISP_COUNT( texts ); ++i )
    {
        SCOPED( wisp_scene_release ) wisp_scene scene = parsed( texts[i] );
        assert_int_equal( scene.has_contact, i );
        assert_true( scene.contact.level == def.level );
        assert_true( scene.contact.margin == def.margin );
        assert_int_equal( scene.contact.size, def.size );
        assert_false( scene.request_contact_stats || scene.request_intersections );
    }
}

// ---- given keys ----

TEST( every_key_of_a_layer_reaches_its_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = with_block( "boundary", "{ spacing: 0.02, policy: exact, rounding: up, "
                                               "hysteresis: 0.25, max_points: 1000, min_spacing: 0.01, max_spacing: "
                                               "0.03, curvature_gain: 2, strain_gain: -0.5, eye: [1, 2, 3], "
                                               "eye_angle: 0.016 }" );
    const wisp_boundary_def* b = &scene.surfaces[0].boundary;
    assert_true( b->spacing == 0.02f && b->hysteresis == 0.25f && b->max_points == 1000 );
    assert_int_equal( b->policy, WISP_SPACING_EXACT );
    assert_int_equal( b->rounding, WISP_ROUND_UP );
    assert_true( b->min_spacing == 0.01f && b->max_spacing == 0.03f );
    assert_true( b->curvature_gain == 2.0f && b->strain_gain == -0.5f && b->eye_angle == 0.016f );
    assert_true( b->eye.x == 1.0f && b->eye.y == 2.0f && b->eye.z == 3.0f );
}

TEST( every_key_of_a_participant_reaches_its_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed( "wisp: 1\n"
                               "surfaces:\n"
                               "  - name: cloth\n"
                               "    generate: { shape: plane }\n"
                               "    contact: { thickness: 0.01, friction: 0.7, self: false, max_push_out_speed: 2, "
                               "layers: [1, 3], mask: [0, 2, 31], enabled: false }\n"
                               "strands:\n"
                               "  - name: hair\n"
                               "    generate: { shape: straight }\n"
                               "    dynamics: {}\n"
                               "    contact: { thickness: 0.02, friction: 0.1, max_push_out_speed: 3, layers: [2], "
                               "mask: [], enabled: false }\n" );
    const wisp_contact_def* c = &scene.surfaces[0].contact;
    assert_true( c->thickness == 0.01f && c->friction == 0.7f && !c->self && c->max_push_out_speed == 2.0f );
    assert_true( c->layers == ( 1u << 1 | 1u << 3 ) && c->mask == ( 1u | 1u << 2 | 1u << 31 ) && !c->enabled );
    c = &scene.strands[0].contact;
    assert_true( scene.strands[0].has_contact );
    assert_true( c->thickness == 0.02f && c->friction == 0.1f && c->max_push_out_speed == 3.0f );
    assert_true( c->layers == 1u << 2 && c->mask == 0u && !c->enabled );
}

TEST( every_key_of_the_contact_of_a_scene_reaches_its_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = with_settings( "{ level: spheres, margin: 0.5, "
                                      "compute: [intersections] }" );
    assert_int_equal( scene.contact.level, WISP_CONTACT_SPHERES );
    assert_true( scene.contact.margin == 0.5f );
    assert_true( scene.request_intersections && !scene.request_contact_stats );
    wisp_scene_release( &scene );

    scene = with_settings( "{ level: triangles, compute: [stats] }" );
    assert_true( scene.has_contact && scene.contact.level == WISP_CONTACT_TRIANGLES && scene.request_contact_stats &&
                 !scene.request_intersections );
}

TEST( every_word_is_the_enumerator_of_its_name )
{
    static const char* const policies[] = { "even", "exact" };
    static const char* const roundings[] = { "down", "nearest", "up" };
    static const char* const levels[] = { "exact", "triangles", "spheres" };
    // One word for each enumerator, in its order.
    assert_int_equal( WISP_COUNT( policies ), WISP_SPACING_COUNT );
    assert_int_equal( WISP_COUNT( roundings ), WISP_ROUND_COUNT );
    assert_int_equal( WISP_COUNT( levels ), WISP_CONTACT_LEVEL_COUNT );
    char mapping[64];
    for ( int i = 0; i < WISP_ROUND_COUNT; ++i )
    {
        snprintf( mapping, sizeof mapping, "{ policy: %s, rounding: %s }", policies[i % 2], roundings[i] );
        SCOPED( wisp_scene_release ) wisp_scene scene = with_block( "boundary", mapping );
        assert_int_equal( scene.surfaces[0].boundary.policy, i % 2 );
        assert_int_equal( scene.surfaces[0].boundary.rounding, i );
    }
    for ( int i = 0; i < WISP_CONTACT_LEVEL_COUNT; ++i )
    {
        snprintf( mapping, sizeof mapping, "{ level: %s }", levels[i] );
        SCOPED( wisp_scene_release ) wisp_scene scene = with_settings( mapping );
        assert_int_equal( scene.contact.level, i );
    }
}

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

TEST( a_scene_with_every_key_of_boundary_and_contact_is_read )
{
    SCOPED( wisp_scene_release ) wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    if ( wisp_scene_read( WISP_SOURCE_ROOT "/tests/app/scenes/boundary_and_contact.yaml", &scene, &error ) !=
         WISP_OK )
    {
        fail_msg( "refused: %s", error.message );
    }
    assert_true( scene.has_contact && scene.request_contact_stats && scene.request_intersections );
    assert_true( scene.surfaces[0].has_boundary && scene.surfaces[0].has_contact && scene.surfaces[1].has_contact );
    assert_true( scene.strands[0].has_contact );
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

TEST( the_ends_of_all_ranges_are_taken_by_the_modules )
{
    static const char* const blocks[] = {
        "boundary: { spacing: 1e-6, hysteresis: 0, max_points: 1, min_spacing: 1e-6, max_spacing: 1e-6 }",
        "boundary: { spacing: 1e6, hysteresis: 0.5, max_points: 134217728, min_spacing: 1e6, max_spacing: 1e6 }",
        "boundary: { curvature_gain: 1e6, strain_gain: 1e6, eye_angle: 1e-6, max_points: 1000 }",
        "boundary: { curvature_gain: 1e6, strain_gain: -1e6, eye_angle: 1, eye: [1e6, -1e6, 1e6] }",
        "contact: { thickness: 0, friction: 0, max_push_out_speed: 0, layers: [0], mask: [31] }",
        "contact: { thickness: 1e6, friction: 1e6, max_push_out_speed: 1e6, layers: [], mask: [] }",
    };
    for ( int i = 0; i < WISP_COUNT( blocks ); ++i )
    {
        SCOPED( release ) fixture f = { .scene = { 0 } };
        char text[512];
        snprintf( text, sizeof text,
                  "wisp: 1\nsurfaces:\n  - name: cloth\n    generate: { shape: plane, columns: 3, rows: 3 }\n"
                  "    cloth: {}\n    %s\n",
                  blocks[i] );
        build( &f, text );
    }
    static const char* const settings[] = {
        "{ level: triangles, margin: 0.01 }",
        "{ level: spheres, margin: 100 }",
        "{ margin: 0.01 }",
        "{ margin: 100 }",
    };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        SCOPED( release ) fixture f;
        char text[128];
        snprintf( text, sizeof text, "wisp: 1\ncontact: %s\n", settings[i] );
        build( &f, text );
    }
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

// ---- missing keys ----

TEST( an_implicit_cloth_without_keys_has_the_defaults_of_its_module )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = with_block( "implicit", "{}" );
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
}

TEST( a_surface_without_the_key_is_no_implicit_cloth )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed( "wisp: 1\nsurfaces:\n  - { name: cloth, generate: { shape: plane }, cloth: {} }\n" );
    assert_false( scene.surfaces[0].has_implicit || scene.surfaces[0].has_quad_links );
}

// ---- given keys ----

TEST( every_key_of_an_implicit_cloth_reaches_its_place )
{
    SCOPED( wisp_scene_release )
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
}

TEST( every_word_of_implicit_cloth_is_the_enumerator_of_its_name )
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
        SCOPED( wisp_scene_release ) wisp_scene scene = with_block( "implicit", words[i].mapping );
        int value = -1;
        memcpy( &value, (const char*)&scene.surfaces[0].implicit + words[i].at, sizeof value );
        assert_int_equal( value, words[i].value );
    }
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

TEST( a_scene_with_every_key_of_implicit_cloth_is_read )
{
    SCOPED( wisp_scene_release ) wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_scene_read( WISP_SOURCE_ROOT "/tests/app/scenes/implicit_cloth.yaml", &scene, &error ), error );
    assert_int_equal( scene.surface_count, 2 );
    assert_true( scene.surfaces[0].has_implicit && scene.surfaces[1].has_implicit );
    assert_true( !scene.surfaces[0].has_quad_links && scene.surfaces[1].has_quad_links );
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
        SCOPED( release ) fixture f = { .scene = with_block( "implicit", mappings[i] ) };
        create( &f, 1 );
    }
}
