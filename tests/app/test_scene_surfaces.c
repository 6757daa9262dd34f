// Surfaces, colliders and events of valid scenes, moving strands, ghosts, scattered strands and curves: what no field of a table
// describes, which test_scene_keys.c walks.
#define _XOPEN_SOURCE 700

#include "scene_fixture.h"

#include "scene_parts.h"

#include "wisp/module/vec.h"

// ---- surfaces ----

static wisp_scene good( const char* text )
{
    return parsed_as( "scenes/test.yaml", text );
}

static void demand_refusal( const char* text, const char* message )
{
    wisp_scene scene;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_scene_parse( text, strlen( text ), "scenes/test.yaml", &scene, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message, message );
}

// A turn consists of a sine and a cosine within 1e-7 of the exact ones, and a few roundings.
static void assert_near( wisp_vec3 v, float x, float y, float z )
{
    const float tolerance = 1e-6f;
    assert_true( fabsf( v.x - x ) < tolerance && fabsf( v.y - y ) < tolerance && fabsf( v.z - z ) < tolerance );
}

// ---- missing keys ----

TEST( bodies_take_the_gravity_of_the_scene_wherever_that_stands )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsurfaces:\n"
                             "  - { name: a, generate: { shape: plane } }\n"
                             "  - { name: b, generate: { shape: plane }, gravity: [1, 0, 0] }\n"
                             "strands: [{ name: hair, generate: {}, dynamics: {} }]\n"
                             "gravity: [0, 0, -1.62]\n" );
    assert_vector( scene.strands[0].dynamics.gravity, 0.0f, 0.0f, -1.62f );
    assert_vector( scene.surfaces[0].gravity, 0.0f, 0.0f, -1.62f );
    assert_vector( scene.surfaces[1].gravity, 1.0f, 0.0f, 0.0f );
}

// ---- given keys ----

TEST( lists_of_surfaces_reach_their_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good(
        "wisp: 1\nsurfaces:\n  - name: cloth\n    file: meshes/cloth.ply\n    repair: [unreferenced, winding]\n"
        "    require: [oriented, one_component]\n    pins: [7, 3]\n    strain_limit: [0.75, 1.25]\n    tile_size: "
        "128\n"
        "    pin_keyframes: [{ time: 0.5, translate: [0, 1, 0] }, { time: 1, rotate: { degrees: [0, 90, 0] } }]\n"
        "    collision: { mask: [0, 5] }\n    contact: { layers: [1, 3], mask: [0, 2, 31] }\n    cloth: {}\n"
        "    compute: [motion_stats, speed, strain, normals, points, collision_stats]\n"
        "  - name: a\n    generate: { shape: icosphere, level: 2 }\n    compute: [effect_stats]\n"
        "    balloon: { outlet: [4, 2, 9], gas_ratio_keyframes: [[1, 1.25], [2, 3]] }\n"
        "contact: { compute: [intersections] }\n" );
    const wisp_scene_surface *s = &scene.surfaces[0], *ball = &scene.surfaces[1];
    assert_string_equal( s->mesh.file, "scenes/meshes/cloth.ply" );
    assert_int_equal( s->mesh.repairs, WISP_MESH_DROP_UNREFERENCED | WISP_MESH_TURN_TRIANGLES );
    assert_int_equal( s->mesh.demands, WISP_MESH_ORIENTED | WISP_MESH_ONE_COMPONENT );
    assert_true( s->pins.vertex_count == 2 && s->pins.vertices[0] == 7 && s->pins.vertices[1] == 3 );
    assert_true( s->strain_limit[0] == 0.75f && s->strain_limit[1] == 1.25f && s->tile_size == 128 );
    assert_true( ball->strain_limit[0] == 0.0f && isinf( ball->strain_limit[1] ) );
    // values missing in the second keyframe are those of the first
    assert_int_equal( s->pins.path.count, 2 );
    assert_vector( s->pins.path.poses[1].pose.translation, 0.0f, 1.0f, 0.0f );
    assert_near( wisp_quat_rotate( s->pins.path.poses[1].pose.rotation, ( wisp_vec3 ){ 1, 0, 0 } ), 0.0f, 0.0f,
                 -1.0f );
    assert_int_equal( s->collision.mask, 33 );
    assert_true( s->contact.layers == ( 1u << 1 | 1u << 3 ) && s->contact.mask == ( 1u | 1u << 2 | 1u << 31 ) );
    assert_true( s->request_points && s->request_normals && s->request_strain && s->request_speed &&
                 s->request_motion_stats && s->request_contacts && !s->request_stats );
    assert_true( ball->request_stats && !ball->request_points && !ball->request_contacts );
    assert_true( ball->balloon.outlet_count == 3 && ball->balloon.outlet[0] == 4 && ball->balloon.outlet[2] == 9 );
    assert_true( ball->gas_ratio_keyframe_count == 2 && ball->gas_ratio_keyframes[0].gas_ratio == 1.25f &&
                 ball->gas_ratio_keyframes[1].time == 2.0f );
    assert_true( scene.request_intersections && !scene.request_contact_stats );
}

TEST( lists_of_colliders_reach_their_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\ncolliders:\n  - { name: p, shape: plane, friction: 0.25, layers: [1] }\n"
              "  - { name: c, shape: capsule, friction: [0.75, 0.5] }\n"
              "  - { name: b, shape: box, rotation: { degrees: [0, 0, 90] }, keyframes: [{ time: 1, position: [4, 5, "
              "6] }] }\n"
              "  - { name: m, shape: mesh, file: rock.obj, repair: [unreferenced], require: [manifold] }\n" );
    const wisp_scene_collider* c = scene.colliders;
    assert_true( c[0].def.layers == 2 && c[0].def.static_friction == 0.25f && c[0].def.kinetic_friction == 0.25f );
    assert_true( c[1].def.static_friction == 0.75f && c[1].def.kinetic_friction == 0.5f );
    // a keyframe without a rotation keeps that of the start
    assert_near( wisp_transform_to_world( c[2].path.poses[0].pose, ( wisp_vec3 ){ 1, 0, 0 } ), 4.0f, 6.0f, 6.0f );
    assert_string_equal( c[3].mesh.file, "scenes/rock.obj" );
    assert_true( c[3].mesh.repairs == WISP_MESH_DROP_UNREFERENCED && c[3].mesh.demands == WISP_MESH_MANIFOLD );
}

TEST( an_instance_knows_its_source_and_has_effects_of_its_own )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nsurfaces:\n"
              "  - { name: ball, generate: { shape: icosphere }, balloon: {} }\n"
              "  - { name: twin, instance_of: ball, transform: { translate: [1, 0, 0] }, cloth: {} }\n" );
    assert_int_equal( scene.surfaces[0].instance_of, -1 );
    assert_int_equal( scene.surfaces[1].instance_of, 0 );
    assert_true( scene.surfaces[1].has_cloth && !scene.surfaces[1].has_balloon );
}

// ---- turns ----

TEST( three_angles_turn_about_x_then_y_then_z )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\ncolliders:\n"
                             "  - { name: a, shape: plane, rotation: { degrees: [90, 90, 0] } }\n"
                             "  - { name: b, shape: plane, rotation: { degrees: [0, 90, 90] } }\n"
                             "  - { name: c, shape: plane, rotation: { axis: [1, 1, 1], degrees: -240 } }\n" );
    // y goes to z by the first turn and to x by the second; x goes to -z, which the third leaves alone
    assert_near( wisp_quat_rotate( scene.colliders[0].def.pose.rotation, ( wisp_vec3 ){ 0, 1, 0 } ), 1, 0, 0 );
    assert_near( wisp_quat_rotate( scene.colliders[1].def.pose.rotation, ( wisp_vec3 ){ 1, 0, 0 } ), 0, 0, -1 );
    // a third of a turn about the diagonal takes each axis to the next
    assert_near( wisp_quat_rotate( scene.colliders[2].def.pose.rotation, ( wisp_vec3 ){ 1, 0, 0 } ), 0, 1, 0 );
}

// ---- generators ----

TEST( vertices_are_counted_as_the_maker_makes_them )
{
    for ( int shape = 0; shape < WISP_MESH_SHAPE_COUNT; ++shape )
    {
        wisp_mesh_generator generator = wisp_default_mesh_generator( (wisp_mesh_shape)shape );
        generator.columns = 9;
        generator.rows = 7;
        generator.level = 2;
        generator.segments = 11;
        generator.rings = 5;
        generator.length_segments = 3;
        SCOPED( wisp_mesh_release ) wisp_mesh mesh;
        assert_int_equal( wisp_mesh_generate( &generator, &mesh, NULL ), WISP_OK );
        const int count = (int)scene_generator_vertices( &generator );
        assert_int_equal( count, mesh.vertex_count );
    }
}

// ---- events ----

TEST( events_come_in_the_order_of_their_steps )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nsteps: 100\n"
              "surfaces:\n"
              "  - { name: a, generate: { shape: plane }, pins: [0], cloth: { drag_coefficient: 1 } }\n"
              "  - { name: b, generate: { shape: icosphere }, balloon: { outlet: [0] } }\n"
              "events:\n"
              "  - { time: 1.5, surface: b, outlet_open: true, gas_ratio: 1.5, inflation_rate: 0.25 }\n"
              "  - { time: 0.5, surface: a, release: true, wind: [1, 2, 3] }\n"
              "  - { step: 0, surface: b, velocity: [0, 1, 0], angular_velocity: [0, 0, 2] }\n"
              "  - { time: 0.51, surface: a, velocity: [0, 2, 0] }\n" );
    static const int steps[] = { 0, 30, 31, 90 };
    assert_int_equal( scene.event_count, 4 );
    for ( int i = 0; i < 4; ++i )
    {
        // 0.5 s and 1.5 s are 30 and 90 steps of 1/60 s, whatever the rounding; the first that begins after 0.51 s is 31
        assert_int_equal( scene.events[i].step, steps[i] );
    }
    assert_vector( scene.events[0].angular_velocity, 0.0f, 0.0f, 2.0f );
    assert_true( scene.events[0].has_velocity && !scene.events[0].has_gas_ratio && !scene.events[0].release );
    assert_true( scene.events[1].release && scene.events[1].has_wind && !scene.events[1].has_velocity );
    assert_vector( scene.events[1].wind, 1.0f, 2.0f, 3.0f );
    assert_true( scene.events[3].has_open && scene.events[3].open && scene.events[3].gas_ratio == 1.5f );
    assert_true( scene.events[3].has_inflation_rate && scene.events[3].inflation_rate == 0.25f );
    assert_int_equal( scene.events[3].surface, 1 );
}

TEST( a_fill_after_its_keyframes_is_taken )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nsteps: 100\n"
              "surfaces:\n"
              "  - { name: b, generate: { shape: icosphere }, balloon: { gas_ratio_keyframes: [[0, 1], [1, 2]] } }\n"
              "events: [ { step: 61, surface: b, gas_ratio: 1 } ]\n" );
    assert_int_equal( scene.event_count, 1 );
}

TEST( points_are_requested_where_an_output_writes_a_surface )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsurfaces: [ { name: a, generate: { shape: plane } } ]\n"
                             "output: [ { surface: a, file: a.ply } ]\n" );
    assert_true( scene.surfaces[0].request_points );
    assert_int_equal( scene.outputs[0].surface, 0 );
    assert_int_equal( scene.outputs[0].strands, -1 );
}

// ---- limits ----

static char* repeat( const char* head, const char* part, int count )
{
    size_t at = strlen( head ), length = strlen( part );
    char* text = checked_malloc( at + length * (size_t)count + 1 );
    memcpy( text, head, at + 1 );
    for ( int i = 0; i < count; ++i, at += length )
    {
        memcpy( text + at, part, length + 1 );
    }
    return text;
}

TEST( lists_of_surfaces_and_colliders_have_an_end )
{
    SCOPED( free_local ) char* text = repeat( "wisp: 1\nsurfaces:\n", "  - 0\n", WISP_SCENE_MAX_SURFACES + 1 );
    demand_refusal( text, "scenes/test.yaml:3:3: surfaces: got 10001 entries, expected at most 10000" );
    free( text );
    text = repeat( "wisp: 1\ncolliders:\n", "  - 0\n", WISP_SCENE_MAX_COLLIDERS + 1 );
    demand_refusal( text, "scenes/test.yaml:3:3: colliders: got 10001 entries, expected at most 10000" );
}

TEST( a_long_list_of_keyframes_is_read_in_one_walk )
{
    // Times that do not increase are found at the second entry, so a long list of equal ones costs nothing.
    SCOPED( free_local )
    char* text = repeat( "wisp: 1\nsurfaces:\n  - name: b\n    generate: { shape: icosphere }\n    balloon:\n"
                         "      gas_ratio_keyframes:\n",
                         "        - [1, 1]\n", 200000 );
    demand_refusal( text,
                    "scenes/test.yaml:8:12: surfaces[0].balloon.gas_ratio_keyframes[1]: got time 1, expected more "
                    "than the time before, 1" );
}

// ---- strands ----

TEST( lists_and_names_of_motion_reach_their_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed(
        "wisp: 1\nsteps: 9\n"
        "events: [ { step: 3, strands: hair, wind: [7, 8, 9] }, { step: 3, surface: cloth, velocity: [1, 0, 0] } ]\n"
        "strands:\n  - name: hair\n    generate: { dimension: 2, strands: 2, vertices: 3 }\n"
        "    dynamics: { vertex_masses: [1, 2, 3, 4, 5, 6], pins: [2, 5], drag_coefficient: 9 }\n"
        "    head: { pivot: [1, 1, 1], keyframes: [ { time: 1, position: [2, 0, 0], rotation: { axis: [0, 0, 1], "
        "degrees: 180 } }, { time: 2, position: [3, 0, 0] } ] }\n"
        "    collision: { mask: [0, 3] }\n    compute: [motion_stats, collision_stats, strain, speed]\n    show: "
        "true\n"
        "  - name: ghosts\n    scatter: { around: hair, count: 3, radius: 0.125, seed: 18446744073709551615 }\n"
        "    ghosts: { targets: hair }\n"
        "  - name: drawn\n    curves: { of: ghosts }\n    show: false\n"
        "  - { name: rooted, generate: {}, dynamics: {}, on_surface: cloth }\n"
        "surfaces: [ { name: other, generate: { shape: plane } }, { name: cloth, generate: { shape: plane } } ]\n" );
    const wisp_scene_strands *hair = &scene.strands[0], *ghosts = &scene.strands[1], *drawn = &scene.strands[2];
    assert_true( hair->mass_count == 6 && hair->dynamics.vertex_masses[5] == 6.0f && hair->dynamics.pin_count == 2 );
    assert_true( hair->dynamics.pins[0] == 2 && hair->dynamics.pins[1] == 5 && hair->collision.mask == 9u );
    assert_true( hair->has_head && hair->has_head_pivot && hair->head.count == 2 );
    assert_vector( hair->head.poses[1].pose.translation, 3, 0, 0 );
    // a missing turn is that of the previous keyframe
    assert_memory_equal( &hair->head.poses[0].pose.rotation, &hair->head.poses[1].pose.rotation,
                         sizeof( wisp_quat ) );
    assert_true( hair->request_contacts && hair->request_strain && hair->request_speed &&
                 hair->request_motion_stats && !hair->request_points );
    assert_true( ghosts->is_scattered && ghosts->scatter.around == 0 && ghosts->scatter.seed == UINT64_MAX );
    assert_true( ghosts->has_ghosts && ghosts->targets == 0 && drawn->is_curves && drawn->curves_of == 1 );
    assert_true( scene.strands[3].on_surface == 1 && hair->on_surface == -1 && hair->targets == -1 );
    // what others draw is hidden unless it says that it is shown: hair has ghosts, and curves run through them
    assert_true( hair->is_shown && !ghosts->is_shown && !drawn->is_shown && scene.strands[3].is_shown );
    // events are for strands as well as for surfaces, which come first
    assert_true( scene.event_count == 2 && scene.events[0].strands == -1 && scene.events[0].surface == 1 );
    assert_true( scene.events[1].strands == 0 && scene.events[1].surface == -1 );
    assert_vector( scene.events[1].wind, 7, 8, 9 );
}

TEST( scattered_ghosts_follow_what_they_are_scattered_around )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: a, generate: {}, dynamics: {} }\n"
                "  - { name: b, generate: {}, dynamics: {} }\n"
                "  - { name: c, scatter: { around: b, count: 2, radius: 0 }, ghosts: {} }\n"
                "  - { name: d, scatter: { around: b, count: 2, radius: 0 }, ghosts: { targets: a } }\n"
                "  - { name: e, scatter: { around: b, count: 2, radius: 0 } }\n" );
    assert_int_equal( scene.strands[2].targets, 1 );
    assert_int_equal( scene.strands[3].targets, 0 );
    assert_int_equal( scene.strands[4].targets, -1 );
}

TEST( frozen_hair_on_ghosts_is_new_in_every_frame_unless_it_says_otherwise )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: a, generate: {}, dynamics: {} }\n"
                "  - { name: b, frozen_hair: {}, generate: {}, ghosts: { targets: a } }\n"
                "  - { name: c, generate: {}, ghosts: { targets: a }, frozen_hair: { update_on: hair_event } }\n"
                "  - { name: d, generate: {}, frozen_hair: {} }\n" );
    assert_int_equal( scene.strands[1].frozen_hair.update_on, WISP_FROZEN_UPDATE_FRAME );
    assert_int_equal( scene.strands[2].frozen_hair.update_on, WISP_FROZEN_UPDATE_HAIR_EVENT );
    assert_int_equal( scene.strands[3].frozen_hair.update_on, WISP_FROZEN_UPDATE_HAIR_EVENT );
}

// ---- scattered strands ----

static wisp_groom straight_groom( int dimension )
{
    wisp_groom_generator generator = wisp_default_groom_generator( WISP_GROOM_STRAIGHT, dimension );
    generator.strand_count = 5;
    generator.vertices_per_strand = 4;
    wisp_groom groom;
    wisp_error error = { .status = WISP_OK };
    assert_int_equal( wisp_groom_generate( &generator, &groom, &error ), WISP_OK );
    return groom;
}

TEST( scattered_strands_are_their_targets_moved_across_the_root_within_the_radius )
{
    const wisp_scene_scatter scatter = { .around = 0, .count = 200, .radius = 0.01f, .seed = 3 };
    for ( int dimension = 2; dimension <= 3; ++dimension )
    {
        SCOPED( wisp_groom_release ) wisp_groom source = straight_groom( dimension ), out;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &out, &error ), WISP_OK );
        assert_int_equal( out.strand_count, 1000 );
        assert_int_equal( out.vertex_count, 4000 );
        assert_int_equal( out.dimension, dimension );
        assert_non_null( out.thickness );
        int outer = 0;
        for ( int g = 0; g < out.strand_count; ++g )
        {
            const wisp_vec3 *y = out.points + out.offsets[g], *x = source.points + source.offsets[g / 200];
            const wisp_vec3 offset = wisp_v3_sub( y[0], x[0] ), along = wisp_v3_sub( x[1], x[0] );
            // coordinates are below 0.5 m, so that a difference of two is within 6e-8 m
            assert_true( sqrtf( wisp_v3_dot( offset, offset ) ) <= 0.01f + 1e-7f );
            assert_true( fabsf( wisp_v3_dot( offset, along ) ) <=
                         1e-7f * sqrtf( wisp_v3_dot( along, along ) ) * 4.0f );
            for ( int v = 1; v < 4; ++v )
            {
                const wisp_vec3 slip = wisp_v3_sub( wisp_v3_sub( y[v], x[v] ), offset );
                assert_true( wisp_v3_dot( slip, slip ) <= 1e-7f * 1e-7f );
            }
            outer += wisp_v3_dot( offset, offset ) > 0.5f * 0.01f * 0.01f;
        }
        // Half of a disc lies beyond radius / sqrt 2, and 1 - 1 / sqrt 2 of a line; five sigma of 1000 draws are 79.
        assert_true( abs( outer - ( dimension == 3 ? 500 : 293 ) ) < 79 );
    }
}

TEST( scattering_more_strands_around_each_keeps_those_that_there_were )
{
    SCOPED( wisp_groom_release ) wisp_groom source = straight_groom( 3 ), few, many;
    wisp_error error = { .status = WISP_OK };
    wisp_scene_scatter scatter = { .around = 0, .count = 2, .radius = 0.01f, .seed = 3 };
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &few, &error ), WISP_OK );
    scatter.count = 7;
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &many, &error ), WISP_OK );
    for ( int g = 0; g < 5 * 2; ++g )
    {
        const int same = g / 2 * 7 + g % 2;
        assert_memory_equal( few.points + few.offsets[g], many.points + many.offsets[same], 4 * sizeof( wisp_vec3 ) );
    }
}

TEST( scattering_too_many_strands_is_refused_before_memory_is_queried_for )
{
    wisp_groom source = straight_groom( 3 ), out;
    wisp_error error = { .status = WISP_OK };
    const wisp_scene_scatter scatter = { .around = 0, .count = 6710887, .radius = 0.01f, .seed = 3 };
    assert_int_equal( wisp_scene_make_scatter( &scatter, &source, &out, &error ), WISP_BAD_INPUT );
    assert_string_equal( error.message,
                         "6710887 strands around each of 5 have 134217740 vertices, expected at most 134217728" );
    assert_null( out.points );
    wisp_groom_release( &source );
}

// ---- curves at the start ----

TEST( curves_begin_and_end_where_their_strands_do_and_pass_through_what_they_promise )
{
    // strands of 1, 2, 3, 4 and 6 vertices: no curve, a line, a quadratic, a whole group, a group and a remainder
    static const int counts[] = { 1, 2, 3, 4, 6 };
    static const int bezier[] = { 0, 5, 5, 5, 9 }, catmull_rom[] = { 0, 5, 9, 13, 21 };
    wisp_vec3 points[16];
    int offsets[6] = { 0 };
    for ( int s = 0; s < 5; ++s )
    {
        offsets[s + 1] = offsets[s] + counts[s];
    }
    for ( int v = 0; v < 16; ++v )
    {
        points[v] = ( wisp_vec3 ){ (float)v, (float)( v * v % 7 ), (float)( v % 3 ) };
    }
    const wisp_groom source = { 5, 16, 3, offsets, points, NULL, NULL, NULL };
    for ( int kind = 0; kind < WISP_CURVE_KIND_COUNT; ++kind )
    {
        wisp_curves_def def = wisp_default_curves_def();
        def.kind = (wisp_curve_kind)kind;
        def.samples = 4;
        SCOPED( wisp_groom_release ) wisp_groom out;
        wisp_error error = { .status = WISP_OK };
        assert_int_equal( wisp_scene_make_curves( &def, &source, &out, &error ), WISP_OK );
        assert_int_equal( out.strand_count, 5 );
        for ( int s = 0; s < 5; ++s )
        {
            const int count = out.offsets[s + 1] - out.offsets[s];
            const int stride = kind == WISP_CURVE_CATMULL_ROM ? 1 : 3;
            assert_int_equal( count, kind == WISP_CURVE_CATMULL_ROM ? catmull_rom[s] : bezier[s] );
            for ( int n = 0; n < count; n += def.samples )
            {
                int vertex = n / def.samples * stride;
                vertex = vertex < counts[s] ? vertex : counts[s] - 1;
                const wisp_vec3 slip = wisp_v3_sub( out.points[out.offsets[s] + n], points[offsets[s] + vertex] );
                assert_true( wisp_v3_dot( slip, slip ) == 0.0f ); // weights at the ends are 0 and 1
            }
        }
    }
}
