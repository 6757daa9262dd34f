// Surfaces, colliders and events of valid scenes, moving strands, ghosts, scattered strands and curves: every key sets its
// field, and missing keys have their defaults.
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

TEST( a_surface_without_blocks_has_the_defaults_and_computes_points )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsurfaces:\n  - { name: cloth, generate: { shape: plane } }\n" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    assert_int_equal( scene.surface_count, 1 );
    assert_int_equal( s->line, 3 );
    assert_int_equal( s->column, 5 );
    assert_true( s->mesh.is_generated && !s->mesh.file && s->mesh.scale == 1.0f );
    assert_int_equal( s->mesh.generator.columns, wisp_default_mesh_generator( WISP_MESH_PLANE_REGULAR ).columns );
    assert_int_equal( s->mesh.repairs + s->mesh.demands, 0 );
    assert_int_equal( s->instance_of, -1 );
    assert_true( s->pose.rotation.w == 1.0f );
    assert_true( s->area_density == wisp_default_surface_def().area_density && s->vertex_mass == 0.0f );
    assert_vector( s->gravity, 0.0f, -9.81f, 0.0f );
    assert_true( s->strain_limit[0] == 0.0f && isinf( s->strain_limit[1] ) );
    assert_false( s->has_cloth || s->has_balloon || s->has_collision || s->pins.has_pivot || s->has_outlet_nearest );
    assert_int_equal( s->pins.vertex_count + s->pins.box_count + s->pins.nearest_count + s->pins.path.count, 0 );
    assert_true( s->request_points );
    assert_false( s->request_normals || s->request_strain || s->request_speed || s->request_motion_stats );
    assert_int_equal( s->cloth.size, wisp_default_cloth_def().size );
    assert_int_equal( s->balloon.size, wisp_default_balloon_def().size );
    assert_int_equal( s->collision.size, wisp_default_collision_def().size );
}

TEST( a_surface_takes_the_gravity_of_the_scene_wherever_that_stands )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good( "wisp: 1\nsurfaces:\n"
                             "  - { name: a, generate: { shape: plane } }\n"
                             "  - { name: b, generate: { shape: plane }, gravity: [1, 0, 0] }\n"
                             "gravity: [0, 0, -1.62]\n" );
    assert_vector( scene.surfaces[0].gravity, 0.0f, 0.0f, -1.62f );
    assert_vector( scene.surfaces[1].gravity, 1.0f, 0.0f, 0.0f );
}

// ---- given keys ----

static const char CLOTH_KEYS[] =
    "wisp: 1\nsurfaces:\n  - name: cloth\n    file: meshes/cloth.ply\n    repair: [unreferenced, winding]\n"
    "    require: [oriented, one_component]\n    area_density: 0.3\n    vertex_mass: 1e-4\n    pins: [7, 3]\n"
    "    transform: { scale: 0.5, rotate: { axis: [0, 0, 2], degrees: 90 }, translate: [1, 2, 3] }\n"
    "    pin_box: { min: [-1, 0, -1], max: [1, 0.5, 1] }\n    pin_nearest: [[0, 1, 0], [0, 2, 0]]\n"
    "    pin_keyframes: [{ time: 0.5, translate: [0, 1, 0] }, { time: 1, rotate: { degrees: [0, 90, 0] } }]\n"
    "    pin_pivot: [9, 8, 7]\n    velocity: [1, 0, 0]\n    angular_velocity: [0, 2, 0]\n    gravity: [0, 0, 0]\n"
    "    damping: 0.25\n    strain_limit: [0.75, 1.25]\n    solve_order: list\n    tile_size: 128\n"
    "    collision: { thickness: 0.01, friction_scale: 2, max_push_out_speed: 3, features: all, mask: [0, 5] }\n"
    "    compute: [motion_stats, speed, strain, normals, points, collision_stats]\n"
    "    cloth: { solver: pbd, warp_compliance: 1e-3, weft_compliance: 2e-3, shear_compliance: 3e-3, "
    "stretch_stiffness: 0.5, shear_stiffness: 0.25, warp: [0, 0, 1], bending: isometric, bend_stiffness: 0.125, "
    "bend_compliance: 0.5, bend_rigidity: 1e-4, internal_damping: 4, wind: [5, 6, 7], air_density: 1.5, "
    "drag_coefficient: 0.75, "
    "lift_coefficient: 1.75, tethers: true, tether_slack: 1.5, coarse_passes: 20 }\n";

static void assert_cloth( const wisp_cloth_def* c )
{
    assert_int_equal( c->solver, WISP_SOLVER_PBD );
    assert_true( c->warp_compliance == 1e-3f && c->weft_compliance == 2e-3f && c->shear_compliance == 3e-3f );
    assert_true( c->stretch_stiffness == 0.5f && c->shear_stiffness == 0.25f );
    assert_vector( c->warp, 0.0f, 0.0f, 1.0f );
    assert_int_equal( c->bending, WISP_CLOTH_BENDING_ISOMETRIC );
    assert_true( c->bend_stiffness == 0.125f && c->bend_compliance == 0.5f && c->bend_rigidity == 1e-4f );
    assert_true( c->internal_damping == 4.0f && c->air_density == 1.5f && c->drag_coefficient == 0.75f &&
                 c->lift_coefficient == 1.75f );
    assert_vector( c->wind, 5.0f, 6.0f, 7.0f );
    assert_true( c->tethers && c->tether_slack == 1.5f );
    assert_int_equal( c->coarse_passes, 20 );
}

static void assert_pins( const wisp_scene_surface* s )
{
    assert_int_equal( s->pins.vertex_count, 2 );
    assert_true( s->pins.vertices[0] == 7 && s->pins.vertices[1] == 3 );
    assert_int_equal( s->pins.box_count, 1 );
    assert_vector( s->pins.boxes[0].upper, 1.0f, 0.5f, 1.0f );
    assert_int_equal( s->pins.nearest_count, 2 );
    assert_vector( s->pins.nearest[1], 0.0f, 2.0f, 0.0f );
    assert_true( s->pins.has_pivot );
    assert_vector( s->pins.pivot, 9.0f, 8.0f, 7.0f );
    assert_int_equal( s->pins.path.count, 2 );
    const wisp_scene_pose* poses = s->pins.path.poses;
    assert_true( poses[0].time == 0.5f && poses[1].time == 1.0f && poses[0].pose.rotation.w == 1.0f );
    // values missing in the second keyframe are those of the first
    assert_vector( poses[1].pose.translation, 0.0f, 1.0f, 0.0f );
    assert_near( wisp_quat_rotate( poses[1].pose.rotation, ( wisp_vec3 ){ 1, 0, 0 } ), 0.0f, 0.0f, -1.0f );
}

TEST( every_key_of_a_cloth_reaches_its_place )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = good( CLOTH_KEYS );
    const wisp_scene_surface* s = &scene.surfaces[0];
    assert_string_equal( s->mesh.file, "scenes/meshes/cloth.ply" );
    assert_int_equal( s->mesh.repairs, WISP_MESH_DROP_UNREFERENCED | WISP_MESH_TURN_TRIANGLES );
    assert_int_equal( s->mesh.demands, WISP_MESH_ORIENTED | WISP_MESH_ONE_COMPONENT );
    assert_true( s->mesh.scale == 0.5f );
    assert_near( wisp_transform_to_world( s->pose, ( wisp_vec3 ){ 1, 0, 0 } ), 1.0f, 3.0f, 3.0f );
    assert_true( s->area_density == 0.3f && s->vertex_mass == 1e-4f && s->damping == 0.25f );
    assert_vector( s->velocity, 1.0f, 0.0f, 0.0f );
    assert_vector( s->angular_velocity, 0.0f, 2.0f, 0.0f );
    assert_vector( s->gravity, 0.0f, 0.0f, 0.0f );
    assert_true( s->strain_limit[0] == 0.75f && s->strain_limit[1] == 1.25f );
    assert_int_equal( s->solve_order, WISP_SOLVE_ORDER_LIST );
    assert_int_equal( s->tile_size, 128 );
    assert_true( s->has_collision && s->collision.thickness == 0.01f && s->collision.friction_scale == 2.0f );
    assert_true( s->collision.max_push_out_speed == 3.0f && s->collision.features == WISP_COLLISION_ALL );
    assert_int_equal( s->collision.mask, 33 );
    assert_true( s->request_points && s->request_normals && s->request_strain && s->request_speed &&
                 s->request_motion_stats );
    assert_true( s->request_contacts && !s->request_stats );
    assert_true( s->has_cloth && !s->has_balloon );
    assert_cloth( &s->cloth );
    assert_pins( s );
}

TEST( every_key_of_a_balloon_reaches_its_place )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        good( "wisp: 1\nsurfaces:\n"
              "  - name: a\n    generate: { shape: icosphere, level: 2 }\n    compute: [effect_stats]\n"
              "    balloon: { solver: pbd, edge_stiffness: 10, bend_link_stiffness: 11, stretch_stiffness: 0.5, "
              "bend_stiffness: 0.25, "
              "volume: pbd, volume_stiffness: 0.75, gas_ratio: 1.5, gas_ratio_keyframes: [[1, 1.25], [2, 3]], "
              "inflation_rate: -0.5, "
              "min_gas_ratio: 0.125, atmospheric_pressure: 9e4, temperature: 300, gas_molar_mass: 0.002, "
              "air_molar_mass: 0.03, buoyancy: false, drag_coefficient: 0.25, "
              "outlet: [4, 2, 9], outlet_area: 2e-4, outlet_open: true, allow_open: true }\n"
              "  - { name: b, generate: { shape: icosphere }, balloon: { outlet_nearest: [0, 1, 2], outlet_radius: "
              "0.5 } }\n" );
    const wisp_scene_surface* s = &scene.surfaces[0];
    const wisp_balloon_def* b = &s->balloon;
    assert_true( s->has_balloon && s->request_stats && !s->has_outlet_nearest );
    assert_true( b->solver == WISP_SOLVER_PBD && b->volume == WISP_SOLVER_PBD );
    assert_true( b->edge_stiffness == 10.0f && b->bend_link_stiffness == 11.0f && b->stretch_stiffness == 0.5f );
    assert_true( b->bend_stiffness == 0.25f && b->volume_stiffness == 0.75f && b->gas_ratio == 1.5f &&
                 b->inflation_rate == -0.5f );
    assert_true( b->min_gas_ratio == 0.125f && b->atmospheric_pressure == 9e4f && b->temperature == 300.0f );
    assert_true( b->gas_molar_mass == 0.002f && b->air_molar_mass == 0.03f );
    assert_true( !b->buoyancy && b->drag_coefficient == 0.25f );
    assert_int_equal( b->outlet_count, 3 );
    assert_true( b->outlet[0] == 4 && b->outlet[1] == 2 && b->outlet[2] == 9 );
    assert_true( b->outlet_area == 2e-4f && b->outlet_open );
    assert_true( b->allow_open && !scene.surfaces[1].balloon.allow_open );
    assert_int_equal( s->gas_ratio_keyframe_count, 2 );
    assert_true( s->gas_ratio_keyframes[0].time == 1.0f && s->gas_ratio_keyframes[0].gas_ratio == 1.25f &&
                 s->gas_ratio_keyframes[1].gas_ratio == 3.0f );
    assert_true( scene.surfaces[1].has_outlet_nearest && scene.surfaces[1].outlet_radius == 0.5f );
    assert_vector( scene.surfaces[1].outlet_nearest, 0.0f, 1.0f, 2.0f );
}

TEST( colliders_have_the_sizes_of_their_shape )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = good(
        "wisp: 1\ncolliders:\n"
        "  - { name: p, shape: plane, position: [0, -1, 0], friction: 0.25, thickness: 0.5, layers: [1] }\n"
        "  - { name: s, radius: 2, shape: sphere }\n"
        "  - { name: c, shape: capsule, radius: 0.5, half_length: 3, friction: [0.75, 0.5] }\n"
        "  - { name: b, shape: box, half_extent: [1, 2, 3], rotation: { degrees: [0, 0, 90] }, "
        "keyframes: [{ time: 1, position: [4, 5, 6] }] }\n"
        "  - { name: m, shape: mesh, file: rock.obj, scale: 2, double_sided: true, repair: [unreferenced], require: "
        "[manifold] }\n" );
    const wisp_scene_collider* c = scene.colliders;
    assert_int_equal( scene.collider_count, 5 );
    assert_true( c[0].def.kind == WISP_COLLIDER_PLANE && c[0].def.thickness == 0.5f && c[0].def.layers == 2 );
    assert_true( c[0].def.static_friction == 0.25f && c[0].def.kinetic_friction == 0.25f );
    assert_vector( c[0].def.pose.translation, 0.0f, -1.0f, 0.0f );
    assert_true( c[1].def.kind == WISP_COLLIDER_SPHERE && c[1].def.radius == 2.0f );
    assert_true( c[1].def.static_friction == wisp_default_collider_def().static_friction );
    assert_true( c[2].def.radius == 0.5f && c[2].def.half_length == 3.0f );
    assert_true( c[2].def.static_friction == 0.75f && c[2].def.kinetic_friction == 0.5f );
    assert_vector( c[3].def.half_extent, 1.0f, 2.0f, 3.0f );
    assert_int_equal( c[3].path.count, 1 );
    // a keyframe without a rotation keeps that of the start
    assert_near( wisp_transform_to_world( c[3].path.poses[0].pose, ( wisp_vec3 ){ 1, 0, 0 } ), 4.0f, 6.0f, 6.0f );
    assert_string_equal( c[4].mesh.file, "scenes/rock.obj" );
    assert_true( c[4].def.double_sided && c[4].mesh.scale == 2.0f && c[4].mesh.demands == WISP_MESH_MANIFOLD );
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

// ---- files ----

TEST( the_scenes_of_the_project_with_surfaces_are_read )
{
    static const struct
    {
        const char* file;
        int surfaces, colliders, events;
    } files[] = {
        { "bunny_balloon.yaml", 1, 1, 1 }, { "hanging_cloth.yaml", 1, 0, 0 }, { "cloth_on_ball.yaml", 1, 2, 0 },
        { "flag.yaml", 1, 2, 3 },          { "balloons.yaml", 5, 1, 0 },      { "pear_jet.yaml", 1, 0, 1 },
    };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        SCOPED( wisp_scene_release ) wisp_scene scene = read_good( files[i].file );
        assert_int_equal( scene.surface_count, files[i].surfaces );
        assert_int_equal( scene.collider_count, files[i].colliders );
        assert_int_equal( scene.event_count, files[i].events );
        assert_true( scene.surfaces[0].request_points );
    }
}

// ---- strands ----

// ---- missing keys ----

TEST( strands_stand_still_and_are_shown_unless_they_say_otherwise )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( "wisp: 1\nstrands:\n  - { name: hair, generate: {} }\n" );
    const wisp_scene_strands* s = &scene.strands[0];
    assert_false( s->has_dynamics || s->has_head || s->has_grid || s->has_ghosts || s->is_scattered || s->is_curves );
    assert_int_equal( s->on_surface, -1 );
    assert_int_equal( s->targets, -1 );
    assert_int_equal( s->curves_of, -1 );
    assert_int_equal( s->scatter.around, -1 );
    assert_int_equal( s->scatter.count, 4 ); // ghosts per target
    assert_true( s->is_shown );
    assert_true( s->scale == 1.0f );
}

TEST( dynamics_without_keys_are_the_modules_defaults_under_the_gravity_of_the_scene )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene =
        parsed( "wisp: 1\nstrands:\n  - { name: hair, generate: {}, dynamics: {} }\ngravity: [0, -1, 2]\n" );
    const wisp_strand_dynamics_def* def = &scene.strands[0].dynamics;
    const wisp_strand_dynamics_def expected = wisp_default_strand_dynamics_def();
    assert_true( scene.strands[0].has_dynamics );
    assert_vector( def->gravity, 0, -1, 2 );
    assert_true( def->stretch == expected.stretch && def->bending == expected.bending && def->rest == expected.rest );
    assert_true( def->bend_rigidity == expected.bend_rigidity && def->line_density == expected.line_density );
    assert_true( def->clamped == expected.clamped && def->diameter == expected.diameter );
    assert_int_equal( def->stretch_passes, expected.stretch_passes );
    assert_int_equal( def->size, expected.size );
    assert_null( def->pins );
    assert_null( def->vertex_masses );
}

TEST( ghosts_and_curves_without_keys_are_the_modules_defaults )
{
    SCOPED( wisp_scene_release )
    wisp_scene scene = parsed( "wisp: 1\nstrands:\n  - { name: guides, generate: {}, dynamics: {}, grid: {} }\n"
                               "  - { name: ghosts, generate: {}, ghosts: { targets: guides } }\n"
                               "  - { name: drawn, curves: { of: ghosts } }\n" );
    wisp_ghosts_def ghosts = wisp_default_ghosts_def();
    wisp_curves_def curves = wisp_default_curves_def();
    wisp_strand_grid_def grid = wisp_default_strand_grid_def();
    assert_true( scene.strands[0].grid.enabled && scene.strands[0].grid.cell_size == grid.cell_size );
    assert_true( scene.strands[0].grid.friction == grid.friction );
    assert_int_equal( scene.strands[0].grid.size, grid.size );
    assert_int_equal( scene.strands[1].ghosts.target_count, ghosts.target_count );
    assert_true( scene.strands[1].ghosts.tip_gain == ghosts.tip_gain );
    assert_int_equal( scene.strands[1].ghosts.size, ghosts.size );
    assert_int_equal( scene.strands[2].curves.kind, curves.kind );
    assert_int_equal( scene.strands[2].curves.samples, curves.samples );
    assert_int_equal( scene.strands[2].curves.size, curves.size );
}

// ---- given keys ----

static const char EVERY_KEY[] =
    "wisp: 1\nsteps: 9\ndt: 0.5\n"
    "events: [ { step: 3, strands: hair, wind: [7, 8, 9] }, { step: 3, surface: cloth, velocity: [1, 0, 0] } ]\n"
    "strands:\n"
    "  - name: hair\n"
    "    generate: { dimension: 2, strands: 2, vertices: 3 }\n"
    "    transform: { scale: 2, translate: [1, 2, 3], rotate: { axis: [0, 0, 1], degrees: 180 } }\n"
    "    dynamics: { stretch: links, stretch_passes: 5, stretch_tolerance: 0.25, integrator: bdf2, bending: "
    "bend_links, "
    "bend_rigidity: 1, twist_rigidity: 2, bend_damping: 3, rest: straight, clamped: false, solver: pbd, "
    "stretch_compliance: 4, bend_compliance: 5, stretch_stiffness: 0.25, bend_stiffness: 0.75, line_density: 6, "
    "vertex_masses: [1, 2, 3, 4, 5, 6], pins: [2, 5], gravity: [1, 2, 3], damping: 7, wind: [4, 5, 6], "
    "air_density: 8, drag_coefficient: 9, diameter: 10, teleport: 11 }\n"
    "    head: { pivot: [1, 1, 1], keyframes: [ { time: 1, position: [2, 0, 0], rotation: { axis: [0, 0, 1], "
    "degrees: "
    "180 } }, { time: 2, position: [3, 0, 0] } ] }\n"
    "    grid: { cell_size: 0.5, friction: 0.25, repulsion: 12 }\n"
    "    collision: { thickness: 0.5, friction_scale: 0.25, max_push_out_speed: 2, mask: [0, 3] }\n    compute: "
    "[motion_stats, "
    "collision_stats, strain, speed]\n    show: true\n"
    "  - name: ghosts\n"
    "    scatter: { around: hair, count: 3, radius: 0.125, seed: 18446744073709551615 }\n"
    "    ghosts: { targets: hair, target_count: 2, resample: true, elastic: off, tip_gain: 1, centre_gain: 2, time: "
    "3, "
    "spread: 4, repair_length: true }\n"
    "    frozen_hair: { freeze: { stretch_stiffness: [1, 2, 3, 4, 5, 6] } }\n"
    "  - name: drawn\n    curves: { of: ghosts, kind: bezier, samples: 6 }\n    show: false\n"
    "  - { name: rooted, generate: {}, dynamics: { vertex_mass: 13 }, on_surface: cloth }\n"
    "surfaces: [ { name: other, generate: { shape: plane } }, { name: cloth, generate: { shape: plane } } ]\n";

static void assert_dynamics( const wisp_strand_dynamics_def* d )
{
    assert_int_equal( d->stretch, WISP_STRAND_STRETCH_LINKS );
    assert_int_equal( d->bending, WISP_STRAND_BEND_LINKS );
    assert_int_equal( d->rest, WISP_STRAND_REST_STRAIGHT );
    assert_int_equal( d->solver, WISP_SOLVER_PBD );
    assert_int_equal( d->stretch_passes, 5 );
    assert_int_equal( d->integrator, WISP_INTEGRATOR_BDF2 );
    assert_false( d->clamped );
    assert_true( d->stretch_tolerance == 0.25f && d->bend_rigidity == 1.0f );
    assert_true( d->twist_rigidity == 2.0f && d->bend_damping == 3.0f && d->stretch_compliance == 4.0f );
    assert_true( d->bend_compliance == 5.0f && d->stretch_stiffness == 0.25f && d->bend_stiffness == 0.75f );
    assert_true( d->line_density == 6.0f && d->damping == 7.0f && d->air_density == 8.0f &&
                 d->drag_coefficient == 9.0f );
    assert_true( d->diameter == 10.0f && d->teleport == 11.0f );
    assert_vector( d->gravity, 1, 2, 3 );
    assert_vector( d->wind, 4, 5, 6 );
    assert_int_equal( d->pin_count, 2 );
    assert_int_equal( d->pins[0], 2 );
    assert_int_equal( d->pins[1], 5 );
    for ( int v = 0; v < 6; ++v )
    {
        assert_true( d->vertex_masses[v] == (float)( v + 1 ) );
    }
}

static void assert_ghosts( const wisp_ghosts_def* g )
{
    assert_int_equal( g->target_count, 2 );
    assert_int_equal( g->elastic, WISP_GHOST_ELASTIC_OFF );
    assert_true( g->resample && g->repair_length );
    assert_true( g->tip_gain == 1.0f && g->centre_gain == 2.0f && g->time == 3.0f && g->spread == 4.0f );
}

TEST( every_key_of_motion_reaches_its_place )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( EVERY_KEY );
    const wisp_scene_strands *hair = &scene.strands[0], *ghosts = &scene.strands[1], *drawn = &scene.strands[2];
    assert_dynamics( &hair->dynamics );
    assert_int_equal( hair->mass_count, 6 );
    assert_true( hair->scale == 2.0f && fabsf( hair->pose.rotation.z ) == 1.0f );
    assert_vector( hair->pose.translation, 1, 2, 3 );
    assert_true( hair->has_head && hair->has_head_pivot && hair->head.count == 2 );
    assert_vector( hair->head_pivot, 1, 1, 1 );
    assert_vector( hair->head.poses[1].pose.translation, 3, 0, 0 );
    // a missing turn is that of the previous keyframe
    assert_memory_equal( &hair->head.poses[0].pose.rotation, &hair->head.poses[1].pose.rotation,
                         sizeof( wisp_quat ) );
    assert_true( hair->has_grid && hair->grid.cell_size == 0.5f && hair->grid.friction == 0.25f &&
                 hair->grid.repulsion == 12.0f );
    assert_true( hair->has_collision && hair->collision.thickness == 0.5f &&
                 hair->collision.friction_scale == 0.25f );
    assert_true( hair->collision.max_push_out_speed == 2.0f && hair->collision.mask == 9u && hair->request_contacts );
    assert_true( hair->request_strain && hair->request_speed && hair->request_motion_stats && !hair->request_points );

    assert_true( ghosts->is_scattered && ghosts->scatter.around == 0 && ghosts->scatter.count == 3 );
    assert_true( ghosts->scatter.radius == 0.125f && ghosts->scatter.seed == UINT64_MAX );
    assert_true( ghosts->has_ghosts && ghosts->targets == 0 && ghosts->stretch_count == 6 );
    assert_ghosts( &ghosts->ghosts );

    assert_true( drawn->is_curves && drawn->curves_of == 1 && drawn->curves.kind == WISP_CURVE_BEZIER );
    assert_int_equal( drawn->curves.samples, 6 );
    assert_int_equal( scene.strands[3].on_surface, 1 );
    assert_true( scene.strands[3].dynamics.vertex_mass == 13.0f );
}

TEST( what_others_draw_is_hidden_unless_it_says_that_it_is_shown )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( EVERY_KEY );
    assert_true( scene.strands[0].is_shown );  // it has ghosts, but sets the key
    assert_false( scene.strands[1].is_shown ); // curves run through it
    assert_false( scene.strands[2].is_shown ); // it sets the key
    assert_true( scene.strands[3].is_shown );
}

TEST( events_are_for_strands_as_well_as_for_surfaces )
{
    SCOPED( wisp_scene_release ) wisp_scene scene = parsed( EVERY_KEY );
    assert_int_equal( scene.event_count, 2 );
    assert_int_equal( scene.events[0].strands, -1 );
    assert_int_equal( scene.events[0].surface, 1 );
    assert_int_equal( scene.events[1].strands, 0 );
    assert_int_equal( scene.events[1].surface, -1 );
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
