// Boundary particles and contact of scenes: every key sets its field, layers follow their surfaces and do not change
// them, statistics exist where requested, and the scenes of the project run.
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
    wisp_scene scene = with_block( "boundary", "{}" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_boundary_def *b = &s->boundary, def = wisp_default_boundary_def();
    assert_true( s->has_boundary && !s->has_contact );
    assert_true( b->spacing == def.spacing && b->policy == def.policy && b->rounding == def.rounding );
    assert_true( b->hysteresis == def.hysteresis );
    assert_true( b->max_points == def.max_points && b->min_spacing == def.min_spacing );
    assert_true( b->max_spacing == def.max_spacing && b->curvature_gain == def.curvature_gain );
    assert_true( b->strain_gain == def.strain_gain && b->eye_angle == def.eye_angle );
    assert_int_equal( b->size, def.size );
    wisp_scene_release( &scene );
}

TEST( a_participant_without_keys_has_the_defaults_of_its_module )
{
    wisp_scene scene = with_block( "contact", "{}" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_contact_def *c = &s->contact, def = wisp_default_contact_def();
    assert_true( s->has_contact && !s->has_boundary && !scene.has_contact );
    assert_true( c->thickness == def.thickness && c->friction == def.friction && c->self == def.self );
    assert_true( c->max_push_out_speed == def.max_push_out_speed && c->enabled == def.enabled );
    assert_true( c->layers == def.layers && c->mask == def.mask );
    assert_int_equal( c->size, def.size );
    wisp_scene_release( &scene );
}

TEST( contact_of_a_scene_has_the_defaults_of_its_module )
{
    const wisp_contact_settings def = wisp_default_contact_settings();
    const char* const texts[] = { "wisp: 1\n", "wisp: 1\ncontact: {}\n" };
    for ( int i = 0; i < WISP_COUNT( texts ); ++i )
    {
        wisp_scene scene = parsed( texts[i] );
        assert_int_equal( scene.has_contact, i );
        assert_true( scene.contact.primitives == def.primitives );
        assert_true( scene.contact.particle_spacing == def.particle_spacing && scene.contact.margin == def.margin );
        assert_true( scene.contact.displacement_limit == def.displacement_limit );
        assert_int_equal( scene.contact.size, def.size );
        assert_false( scene.request_contact_stats || scene.request_intersections );
        wisp_scene_release( &scene );
    }
}

// ---- given keys ----

TEST( every_key_of_a_layer_reaches_its_place )
{
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
    wisp_scene_release( &scene );
}

TEST( every_key_of_a_participant_reaches_its_place )
{
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
    wisp_scene_release( &scene );
}

TEST( every_key_of_the_contact_of_a_scene_reaches_its_place )
{
    wisp_scene scene = with_settings( "{ primitives: particles, particle_spacing: 0.004, margin: 0.5, "
                                      "compute: [intersections] }" );
    assert_int_equal( scene.contact.primitives, WISP_CONTACT_PARTICLES );
    assert_true( scene.contact.particle_spacing == 0.004f && scene.contact.margin == 0.5f );
    assert_true( scene.request_intersections && !scene.request_contact_stats );
    wisp_scene_release( &scene );

    scene = with_settings( "{ displacement_limit: false, compute: [stats] }" );
    assert_true( scene.has_contact && !scene.contact.displacement_limit && scene.request_contact_stats &&
                 !scene.request_intersections );
    wisp_scene_release( &scene );
}

TEST( every_word_is_the_enumerator_of_its_name )
{
    static const char* const policies[] = { "even", "exact" };
    static const char* const roundings[] = { "down", "nearest", "up" };
    static const char* const primitives[] = { "triangles", "particles" };
    // One word for each enumerator, in its order.
    assert_int_equal( WISP_COUNT( policies ), WISP_SPACING_COUNT );
    assert_int_equal( WISP_COUNT( roundings ), WISP_ROUND_COUNT );
    assert_int_equal( WISP_COUNT( primitives ), WISP_CONTACT_PRIMITIVES_COUNT );
    char mapping[64];
    for ( int i = 0; i < WISP_ROUND_COUNT; ++i )
    {
        snprintf( mapping, sizeof mapping, "{ policy: %s, rounding: %s }", policies[i % 2], roundings[i] );
        wisp_scene scene = with_block( "boundary", mapping );
        assert_int_equal( scene.surfaces[0].boundary.policy, i % 2 );
        assert_int_equal( scene.surfaces[0].boundary.rounding, i );
        wisp_scene_release( &scene );
    }
    for ( int i = 0; i < WISP_CONTACT_PRIMITIVES_COUNT; ++i )
    {
        snprintf( mapping, sizeof mapping, "{ primitives: %s }", primitives[i] );
        wisp_scene scene = with_settings( mapping );
        assert_int_equal( scene.contact.primitives, i );
        wisp_scene_release( &scene );
    }
}

TEST( an_instance_has_a_layer_and_a_contact_of_its_own )
{
    wisp_scene scene =
        parsed( "wisp: 1\nsurfaces:\n"
                "  - { name: a, generate: { shape: icosphere, level: 1 }, boundary: { spacing: 0.1 } }\n"
                "  - { name: b, instance_of: a, contact: { friction: 0.9 } }\n" );
    assert_true( scene.surfaces[0].has_boundary && !scene.surfaces[1].has_boundary );
    assert_true( !scene.surfaces[0].has_contact && scene.surfaces[1].has_contact );
    assert_true( scene.surfaces[1].contact.friction == 0.9f );
    wisp_scene_release( &scene );
}

TEST( a_scene_with_every_key_of_boundary_and_contact_is_read )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    if ( wisp_scene_read( WISP_SOURCE_ROOT "/tests/app/scenes/boundary_and_contact.yaml", &scene, &error ) !=
         WISP_OK )
    {
        fail_msg( "refused: %s", error.message );
    }
    assert_true( scene.has_contact && scene.request_contact_stats && scene.request_intersections );
    assert_true( scene.surfaces[0].has_boundary && scene.surfaces[0].has_contact && scene.surfaces[1].has_contact );
    assert_true( scene.strands[0].has_contact );
    wisp_scene_release( &scene );
}

// ---- worlds ----

#define BALL                                                                                                         \
    "wisp: 1\nsubsteps: 4\nsurfaces:\n"                                                                              \
    "  - name: ball\n    generate: { shape: icosphere, level: 2, radius: 0.2 }\n    balloon: { gas_ratio: 1.2 }\n"   \
    "    compute: [points, normals]\n"

TEST( a_surface_without_a_layer_is_named )
{
    fixture f;
    build( &f, BALL );
    wisp_boundary_view view;
    assert_int_equal( scene_world_layer( &f.world, 0, &view, &f.error ), WISP_CONFLICT );
    assert_non_null( strstr( f.error.message, "test.yaml: 'ball': " ) );
    release( &f );
}

TEST( a_layer_is_there_from_the_start_and_lies_on_its_surface )
{
    fixture f;
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
    release( &f );
}

TEST( a_layer_changes_no_bit_of_its_surface )
{
    fixture with, without;
    build( &with, BALL "    boundary: { spacing: 0.02, curvature_gain: 1, hysteresis: 0.2 }\n" );
    build( &without, BALL );
    step( &with, 5 );
    step( &without, 5 );
    wisp_vec3 a[162], b[162];
    assert_int_equal( scene_world_points( &with.world, 0, a, &with.error ), WISP_OK );
    assert_int_equal( scene_world_points( &without.world, 0, b, &without.error ), WISP_OK );
    assert_memory_equal( a, b, sizeof a );
    release( &with );
    release( &without );
}

TEST( a_surface_without_a_layer_has_none )
{
    fixture f;
    build( &f, BALL );
    step( &f, 1 );
    wisp_boundary_view view;
    assert_int_equal( scene_world_layer( &f.world, 0, &view, &f.error ), WISP_CONFLICT );
    release( &f );
}

// ---- contact in worlds ----

#define TWO_SHEETS                                                                                                   \
    "surfaces:\n"                                                                                                    \
    "  - { name: low, generate: { shape: plane, columns: 8, rows: 8 }, cloth: {}, pins: [0, 7, 56, 63], contact: "   \
    "{} }\n"                                                                                                         \
    "  - { name: high, instance_of: low, transform: { translate: [0, 0.02, 0] }, cloth: {}, contact: {} }\n"

TEST( stats_of_contact_are_there_where_they_are_requested )
{
    fixture f;
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
    release( &f );
}

TEST( implicit_cloth_takes_part_in_contact )
{
    fixture f;
    build( &f, "wisp: 1\ncontact: { compute: [stats] }\nsurfaces:\n"
               "  - { name: cloth, generate: { shape: plane }, implicit: {}, contact: {} }\n" );
    step( &f, 1 );
    wisp_contact_stats stats;
    assert_int_equal( wisp_read_contact_stats( f.world.world, &stats ), WISP_OK );
    assert_int_equal( stats.participants, 1 );
    release( &f );
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
        fixture f = { .scene = { 0 } };
        char text[512];
        snprintf( text, sizeof text,
                  "wisp: 1\nsurfaces:\n  - name: cloth\n    generate: { shape: plane, columns: 3, rows: 3 }\n"
                  "    cloth: {}\n    %s\n",
                  blocks[i] );
        build( &f, text );
        release( &f );
    }
    static const char* const settings[] = {
        "{ primitives: particles, particle_spacing: 1e-6, margin: 0.01 }",
        "{ primitives: particles, particle_spacing: 1e6, margin: 100 }",
        "{ margin: 0.01 }",
        "{ margin: 100 }",
    };
    for ( int i = 0; i < WISP_COUNT( settings ); ++i )
    {
        fixture f;
        char text[128];
        snprintf( text, sizeof text, "wisp: 1\ncontact: %s\n", settings[i] );
        build( &f, text );
        release( &f );
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

// ---- scenes of the project ----

TEST( the_scenes_of_the_project_with_boundary_particles_or_contact_run )
{
    static const struct
    {
        const char* file;
        bool has_layer;
        int participants;
    } files[] = {
        { "boundary_sphere.yaml", true, 0 },  { "boundary_bunny.yaml", true, 0 },
        { "balloons_press.yaml", false, 2 },  { "balloon_stack.yaml", false, 10 },
        { "cloth_fold.yaml", false, 1 },      { "balloon_under_cloth.yaml", false, 2 },
        { "hair_on_balloon.yaml", false, 2 }, { "implicit_contact.yaml", false, 2 },
    };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        fixture f = { .scene = read_good( files[i].file ) };
        assert_int_equal( f.scene.surfaces[0].has_boundary, files[i].has_layer );
        create( &f, 2 );
        step( &f, 3 );
        wisp_boundary_stats layer;
        wisp_contact_stats contact;
        if ( files[i].has_layer )
        {
            assert_int_equal( wisp_read_boundary_stats( f.world.world, f.world.surfaces[0].entity, &layer ),
                              WISP_OK );
            assert_true( layer.points > 1000 && !layer.refused && layer.skipped_elements == 0 );
        }
        if ( files[i].participants > 0 )
        {
            assert_int_equal( wisp_read_contact_stats( f.world.world, &contact ), WISP_OK );
            assert_int_equal( contact.participants, files[i].participants );
        }
        assert_true( wisp_world_counter( f.world.world, WISP_COUNT_HALTED ) == 0 );
        release( &f );
    }
}
