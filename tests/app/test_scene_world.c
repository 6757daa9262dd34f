// From a scene with surfaces to a running world: requests, masses, cooked data, defaults that are those of a host; events of
// balloons and of frozen hair, which do what a host does by calls. Points that scenes lead to are in tests/app/transcripts/scenes.t.
#define _XOPEN_SOURCE 700

#include "saved_world.h"
#include "scene_world_fixture.h"

#include "create.h"
#include "wisp/module/components.h"
#include "wisp/module/module.h"

// ---- bodies ----

TEST( a_plane_is_shown_as_a_square_that_looks_up )
{
    SCOPED( release ) fixture f;
    build( &f,
           "wisp: 1\ncolliders:\n"
           "  - { name: wall, shape: plane, position: [0, 1, 0], rotation: { axis: [0, 0, 1], degrees: 90 } }\n" );
    const int32_t* t = scene_world_body( &f.world, 0 ).triangles;
    wisp_vec3 a = point_of( &f, 0, t[0] ), b = point_of( &f, 0, t[1] ), c = point_of( &f, 0, t[2] );
    wisp_vec3 e = { b.x - a.x, b.y - a.y, b.z - a.z }, d = { c.x - a.x, c.y - a.y, c.z - a.z };
    // up, turned by 90 degrees about z, is -x; the triangle is half of a square of 2 m
    assert_point_at( ( wisp_vec3 ){ e.y * d.z - e.z * d.y, e.z * d.x - e.x * d.z, e.x * d.y - e.y * d.x }, -4, 0, 0 );
}

// ---- requests ----

TEST( what_a_body_does_not_have_cannot_be_queried_for )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nstrands:\n  - { name: hair, generate: { strands: 2 } }\n"
               "surfaces:\n  - { name: cloth, generate: { shape: plane } }\n"
               "colliders:\n  - { name: ground, shape: plane }\n" );
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_STRAIN, &f.error ), WISP_BAD_INPUT );
    assert_string_equal( f.error.message, "test.yaml: 'hair' has no strain" );
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_WIDTH, &f.error ), WISP_BAD_INPUT );
    assert_int_equal( scene_world_request( &f.world, 1, SCENE_REQUEST_COLOUR, &f.error ), WISP_BAD_INPUT );
    assert_int_equal( scene_world_request( &f.world, 2, SCENE_REQUEST_POINTS, &f.error ), WISP_BAD_INPUT );
}

TEST( what_is_queried_for_is_there_after_a_step )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsteps: 5\nsurfaces:\n  - { name: cloth, generate: { shape: plane, columns: 3, rows: 3 }, "
               "compute: [] }\n" );
    float speeds[9] = { 1.0f };
    wisp_motion_stats motion_stats;
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_SPEED, &f.error ), WISP_OK );
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_MOTION_STATS, &f.error ), WISP_OK );
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_SPEED, speeds, &f.error ), WISP_OK );
    assert_true( speeds[0] == 0.0f );
    step( &f, 1 );
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_SPEED, speeds, &f.error ), WISP_OK );
    assert_int_equal( scene_world_motion_stats( &f.world, 0, &motion_stats, &f.error ), WISP_OK );
    // g over 1/60 s
    assert_true( fabsf( speeds[8] - 9.81f / 60.0f ) < 1e-6f );
    assert_true( fabs( motion_stats.speed_max - 9.81 / 60.0 ) < 1e-6 );
    assert_true( fabs( scene_world_time( &f.world ) - 1.0 / 60.0 ) < 1e-8 );
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_STRAIN, speeds, &f.error ), WISP_CONFLICT );
    assert_non_null( strstr( f.error.message, "'cloth'" ) );
}

// ---- start positions ----

TEST( masses_of_a_surface_grow_downwards_by_its_ratio )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsurfaces:\n"
               "  - name: sheet\n    generate: { shape: plane, columns: 2, rows: 3, spacing: 1 }\n"
               "    transform: { rotate: { degrees: [90, 0, 0] } }\n    vertex_mass: 2\n    mass_ratio: 100\n"
               "    cloth: {}\n" );
    const float* x = wisp_world_column( f.world.world, f.world.surfaces[0].entity, WISP_PARTICLE_POSITION, 0 );
    for ( int v = 0; v < 6; ++v )
    {
        const float weight = x[4 * f.world.surfaces[0].fabric->vertex_slot[v] + 3];
        const float mass = 2.0f * powf( 10.0f, (float)( v / 2 ) );
        assert_true( fabsf( weight * mass - 1.0f ) < 1e-4f );
    }
}

TEST( strands_start_away_from_rest_and_their_roots_are_only_scaled )
{
    static const struct
    {
        const char* start;
        float tip[3];
    } rows[] = { { "scale: [1, 2, 1]", { 0.0f, -3.0f, 0.0f } },
                 { "shape: point", { 0.0f, -1.0f, 0.0f } },
                 { "shape: inside_out", { 0.0f, 2.0f, 0.0f } } };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        char text[600];
        snprintf(
            text, sizeof text,
            "wisp: 1\nstrands:\n  - name: hair\n    generate: { dimension: 2, strands: 1, vertices: 3, length: 2, "
            "length_variation: 0 }\n    start: { %s }\n    dynamics: { rest: straight, mass_ratio: 4 }\n",
            rows[i].start );
        SCOPED( release ) fixture f;
        build( &f, text );
        wisp_vec3 points[3];
        assert_ok( scene_world_points( &f.world, 0, points, &f.error ), f.error );
        assert_point_at( points[2], rows[i].tip[0], rows[i].tip[1], rows[i].tip[2] );
        // the state of the engine is there too, and tips weigh four times as much as by density, which is half a segment
        const float* x = wisp_world_column( f.world.world, f.world.entities[0], WISP_STRAND_POSITION, 0 );
        const float* w = wisp_world_column( f.world.world, f.world.entities[0], WISP_STRAND_INVERSE_MASS, 0 );
        assert_true( fabsf( x[( 2 * 3 + 1 ) * 16] - rows[i].tip[1] ) < 1e-5f );
        assert_true( fabsf( w[16] / w[2 * 16] - 1.0f ) < 1e-4f );
    }
}

TEST( a_fabric_is_cooked_with_what_its_effects_need_and_nothing_else )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsurfaces:\n"
               "  - { name: free, generate: { shape: plane } }\n"
               "  - { name: cross, generate: { shape: plane }, cloth: {} }\n"
               "  - { name: angle, generate: { shape: plane }, cloth: { bending: dihedral } }\n"
               "  - { name: held, generate: { shape: plane, columns: 33, rows: 33 }, pins: [0], "
               "cloth: { bending: none, tethers: true, coarse_substeps: 1 } }\n"
               "  - { name: ball, generate: { shape: icosphere }, balloon: {} }\n"
               "  - { name: stiff, instance_of: cross, cloth: { bending: isometric } }\n" );
    static const struct
    {
        bool cross, hinges, tethers, sheets;
    } cooked[] = { { 0 },
                   { .cross = true, .hinges = true, .sheets = true },
                   { .hinges = true, .sheets = true },
                   { .tethers = true, .sheets = true },
                   { .cross = true } };
    for ( int i = 0; i < 5; ++i )
    {
        const wisp_fabric* fabric = f.world.surfaces[i].fabric;
        assert_int_equal( fabric->link_count > fabric->edge_count, cooked[i].cross );
        assert_int_equal( fabric->hinge_order.slot_count > 0, cooked[i].hinges );
        assert_int_equal( fabric->tether_count > 0, cooked[i].tethers );
        assert_int_equal( fabric->level_count > 0, cooked[i].sheets );
    }
}

// A block with nothing in it and a definition with its defaults: gravity, coarse sheets, bending, collision, hair.
TEST( what_a_scene_and_a_host_make_of_defaults_is_the_same_bits )
{
    fixture f;
    build(
        &f,
        "wisp: 1\nstrands:\n  - { name: hair, generate: { strands: 9, vertices: 12 }, dynamics: {} }\n"
        "surfaces:\n  - { name: cloth, generate: { shape: plane, columns: 33, rows: 33, spacing: 0.03 }, pins: [0, "
        "32], "
        "cloth: {} }\n"
        "colliders:\n  - { name: ball, shape: sphere, radius: 0.2, position: [0, -0.3, 0.3] }\n" );
    wisp_world_def world_def = wisp_default_world_def();
    wisp_create_cloth_def cloth_def = wisp_default_create_cloth_def();
    wisp_create_hair_def hair_def = wisp_default_create_hair_def();
    wisp_collider_def ball_def = wisp_default_collider_def();
    const wisp_mesh* mesh = &f.world.surfaces[0].mesh;
    const wisp_groom* groom = &f.world.grooms[0];
    const int32_t pins[] = { 0, 32 };
    wisp_world* host;
    wisp_entity cloth, hair, ball;
    world_def.modules = wisp_all_modules( &world_def.module_count );
    assert_ok( wisp_world_create( &world_def, &host, &f.error ), f.error );
    hair_def.points = groom->points, hair_def.offsets = groom->offsets, hair_def.strand_count = groom->strand_count;
    cloth_def.points = mesh->points, cloth_def.vertex_count = mesh->vertex_count;
    cloth_def.triangles = mesh->triangles, cloth_def.triangle_count = mesh->triangle_count;
    cloth_def.pins = pins, cloth_def.pin_count = 2;
    ball_def.kind = WISP_COLLIDER_SPHERE, ball_def.radius = 0.2f;
    ball_def.pose.translation = ( wisp_vec3 ){ 0.0f, -0.3f, 0.3f };
    assert_int_equal( wisp_create_hair( host, &hair_def, &hair ), WISP_OK );
    assert_int_equal( wisp_create_cloth( host, &cloth_def, &cloth ), WISP_OK );
    assert_int_equal( wisp_add_collider( host, &ball_def, &ball ), WISP_OK );
    step( &f, 60 );
    for ( int i = 0; i < 60; ++i )
    {
        assert_int_equal( wisp_world_step( host, f.scene.dt ), WISP_OK );
    }
    uint64_t hashes[4];
    const wisp_entity of_scene = f.world.surfaces[0].entity;
    assert_int_equal( wisp_world_hash_column( host, cloth, WISP_SURFACE_POINTS, &hashes[0] ), WISP_OK );
    assert_int_equal( wisp_world_hash_column( f.world.world, of_scene, WISP_SURFACE_POINTS, &hashes[1] ), WISP_OK );
    assert_int_equal( wisp_world_hash_column( host, hair, WISP_STRAND_POINTS, &hashes[2] ), WISP_OK );
    assert_int_equal( wisp_world_hash_column( f.world.world, f.world.entities[0], WISP_STRAND_POINTS, &hashes[3] ),
                      WISP_OK );
    assert_true( hashes[0] == hashes[1] && hashes[2] == hashes[3] );
    wisp_world_destroy( host );
    release( &f );
}

TEST( an_instance_that_needs_coarse_sheets_is_enough_for_its_source_to_have_them )
{
    SCOPED( release ) fixture f;
    build( &f,
           "wisp: 1\nsurfaces:\n"
           "  - { name: plain, generate: { shape: plane, columns: 33, rows: 33 }, cloth: { coarse_substeps: 0 } }\n"
           "  - { name: carried, instance_of: plain, cloth: { coarse_substeps: 1, coarse_passes: 7 } }\n" );
    assert_true( f.world.surfaces[0].fabric->level_count > 0 );
    assert_ptr_equal( f.world.surfaces[1].fabric, f.world.surfaces[0].fabric );
    assert_ptr_equal( scene_world_body( &f.world, 1 ).triangles, scene_world_body( &f.world, 0 ).triangles );
    assert_false( wisp_world_has( f.world.world, f.world.surfaces[0].entity, WISP_SURFACE_LEVELS ) );
    const wisp_entity carried = f.world.surfaces[1].entity;
    assert_int_equal( *(const int32_t*)wisp_world_column( f.world.world, carried, WISP_SURFACE_LEVELS, 0 ), 1 );
    assert_int_equal( *(const int32_t*)wisp_world_column( f.world.world, carried, WISP_SURFACE_LEVELS, 1 ), 7 );
}

TEST( an_outlet_near_a_point_has_the_vertices_within_its_radius )
{
    SCOPED( release ) fixture f;
    build( &f,
           "wisp: 1\ndt: 0.001\nsteps: 3\nsurfaces:\n"
           "  - { name: a, generate: { shape: icosphere, level: 3, radius: 1 }, compute: [effect_stats], gravity: "
           "[0, 0, 0], "
           "balloon: { gas_ratio: 1.5, outlet_nearest: [0, 2, 0], outlet_radius: 1.2, outlet_open: true } }\n" );
    step( &f, 2 );
    wisp_balloon_stats stats;
    assert_int_equal( wisp_read_balloon_stats( f.world.world, f.world.surfaces[0].entity, &stats ), WISP_OK );
    // the jet leaves upwards through the top, so it pushes down
    assert_true( stats.jet[1] < 0.0 && fabs( stats.jet[0] ) < 0.1 * fabs( stats.jet[1] ) );
}

// ---- events ----

TEST( keyframes_tell_the_fill_and_leave_the_gas_alone_afterwards )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\ndt: 0.1\nsteps: 40\nsubsteps: 4\nsurfaces:\n"
               "  - { name: a, generate: { shape: icosphere, level: 1 }, compute: [effect_stats], "
               "balloon: { gas_ratio: 1.5, gas_ratio_keyframes: [[1, 1], [2, 2]] } }\n"
               "events: [{ step: 25, surface: a, gas_ratio: 1.25 }]\n" );
    static const struct
    {
        int steps;
        double gas_ratio;
    } story[] = { { 5, 1.5 }, { 5, 1.0 }, { 5, 1.5 }, { 5, 2.0 }, { 5, 2.0 }, { 1, 1.25 }, { 5, 1.25 } };
    for ( int i = 0; i < WISP_COUNT( story ); ++i )
    {
        step( &f, story[i].steps );
        wisp_balloon_stats stats;
        assert_int_equal( wisp_read_balloon_stats( f.world.world, f.world.surfaces[0].entity, &stats ), WISP_OK );
        // times and fills are floats
        assert_true( fabs( stats.target_volume / stats.rest_volume - story[i].gas_ratio ) < 1e-5 );
    }
}

// ---- frozen hair ----

// What an editor does between two steps, and what it writes of that into a scene.
static void edit_hair( wisp_world* world, wisp_entity hair, wisp_frozen_hair_def* def, int n, char* entry,
                       size_t size )
{
    const wisp_vec3 cursor = { -0.05f + 0.01f * (float)n, -0.2f + 0.005f * (float)( n % 5 ), 0.0f };
    char changes[200] = "", place[100] = "";
    if ( n % 7 == 0 )
    {
        def->intensity = 0.1f * (float)( n % 10 );
        def->reach = 0.03f + 0.001f * (float)n;
        def->stretch_stiffness = 3.0f + 0.1f * (float)n;
        def->bend_stiffness = 5.0f + 0.1f * (float)n;
        def->clump_radius = 0.004f + 0.0002f * (float)n;
        snprintf( changes, sizeof changes,
                  ", intensity: %.9g, reach: %.9g, stretch_stiffness: %.9g, bend_stiffness: %.9g, clump_radius: %.9g",
                  (double)def->intensity, (double)def->reach, (double)def->stretch_stiffness,
                  (double)def->bend_stiffness, (double)def->clump_radius );
        assert_int_equal( wisp_set_frozen_hair( world, hair, def ), WISP_OK );
    }
    if ( n == 20 )
    {
        assert_int_equal( wisp_begin_frozen_hair_stroke( world, hair ), WISP_OK );
    }
    if ( n % 14 != 7 )
    {
        snprintf( place, sizeof place, ", cursor: [%.9g, %.9g, 0]", (double)cursor.x, (double)cursor.y );
        assert_int_equal( wisp_command_frozen_hair( world, hair, cursor ), WISP_OK );
    }
    snprintf( entry, size, "  - { step: %d, strands: hair%s%s%s }\n", n, place, n == 20 ? ", begin_stroke: true" : "",
              changes );
}

// Strokes by calls, with snapshots and restores in between, are what a scene of their commands computes.
TEST( a_scene_repeats_the_strokes_of_a_host_bit_for_bit )
{
    enum
    {
        steps = 40
    };
    static const char begin[] = "wisp: 1\nsteps: 40\nstrands:\n  - name: hair\n"
                                "    generate: { shape: wavy, dimension: 2, strands: 60, vertices: 20 }\n"
                                "    frozen_hair: { base: stroke, freeze: {}, align: {}, clump: {} }\n";
    char text[16384];
    size_t used = (size_t)snprintf( text, sizeof text, "%shair_events:\n", begin );
    SCOPED( release ) fixture host, scene;
    build( &host, begin );
    wisp_world* world = host.world.world;
    const wisp_entity hair = host.world.entities[0];
    wisp_frozen_hair_def def = host.scene.strands[0].frozen_hair;
    uint64_t hashes[steps];
    for ( int n = 0; n < steps; ++n )
    {
        char entry[400], unused[400];
        edit_hair( world, hair, &def, n, entry, sizeof entry );
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        assert_int_equal( wisp_world_hash_column( world, hair, WISP_STRAND_POINTS, &hashes[n] ), WISP_OK );
        used += (size_t)snprintf( text + used, sizeof text - used, "%s", entry );
        assert_true( used < sizeof text );

        // a sample that the user takes back
        const saved_world saved = save_world( world );
        wisp_frozen_hair_def taken_back = def;
        edit_hair( world, hair, &taken_back, 35 - n % 3, unused, sizeof unused );
        assert_int_equal( wisp_world_step( world, 1.0f / 60.0f ), WISP_OK );
        assert_int_equal( wisp_world_restore( world, saved.bytes, saved.size ), WISP_OK );
        free( saved.bytes );
    }
    build( &scene, text );
    for ( int n = 0; n < steps; ++n )
    {
        uint64_t hash;
        step( &scene, 1 );
        assert_int_equal(
            wisp_world_hash_column( scene.world.world, scene.world.entities[0], WISP_STRAND_POINTS, &hash ),
            WISP_OK );
        if ( hash != hashes[n] )
        {
            fail_msg( "step %d of the scene differs from what the host saw", n );
        }
    }
}
