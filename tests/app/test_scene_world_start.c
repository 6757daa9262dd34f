// From a scene with surfaces to a world: start positions, cooked data, vertices by number and place.
#include "scene_world_fixture.h"

#include "wisp/module/components.h"
#include "wisp/module/module.h"

#include "files.h"

// An upright sheet of 2 m x 4 m about (0, 1, 0): vertex 0 is its upper left corner, 14 its lower right one.
static void build_start( fixture* f, const char* start )
{
    char text[600];
    snprintf( text, sizeof text,
              "wisp: 1\nsurfaces:\n"
              "  - name: sheet\n"
              "    generate: { shape: plane, columns: 3, rows: 5, spacing: 1 }\n"
              "    transform: { rotate: { degrees: [90, 0, 0] }, translate: [0, 1, 0] }\n"
              "    pins: [0]\n"
              "    start: { %s }\n"
              "    cloth: {}\n",
              start );
    build( f, text );
}

TEST( a_surface_starts_away_from_rest_and_its_pins_are_only_scaled )
{
    static const struct
    {
        const char* start;
        float pin[3], corner[3];
    } rows[] = {
        { "scale: [1.5, 1, 2]", { -1.5f, 3.0f, 0.0f }, { 1.5f, -1.0f, 0.0f } },
        { "shape: plane", { -1.0f, 3.0f, 0.0f }, { 1.0f, 1.0f, 0.0f } },
        { "shape: point", { -1.0f, 3.0f, 0.0f }, { 0.0f, 1.0f, 0.0f } },
        { "shape: inside_out", { -1.0f, 3.0f, 0.0f }, { -1.0f, 7.0f, 0.0f } },
        { "shape: twisted, turns: 0.25", { -1.0f, 3.0f, 0.0f }, { 0.0f, -1.0f, -1.0f } },
    };
    for ( int i = 0; i < WISP_COUNT( rows ); ++i )
    {
        fixture f;
        build_start( &f, rows[i].start );
        assert_point_at( point_of( &f, 0, 0 ), rows[i].pin[0], rows[i].pin[1], rows[i].pin[2] );
        assert_point_at( point_of( &f, 0, 14 ), rows[i].corner[0], rows[i].corner[1], rows[i].corner[2] );
        // lengths at rest are those of the mesh
        const wisp_fabric* fabric = f.world.surfaces[0].fabric;
        assert_int_equal( wisp_fabric_need( fabric, WISP_FABRIC_EDGES ), WISP_OK );
        const wisp_vec3 a = fabric->rest[fabric->edges[0]], b = fabric->rest[fabric->edges[1]];
        assert_true( fabsf( hypotf( hypotf( a.x - b.x, a.y - b.y ), a.z - b.z ) - 1.0f ) < 1e-5f );
        release( &f );
    }
}

TEST( a_random_start_belongs_to_its_seed )
{
    wisp_vec3 corners[3];
    for ( int i = 0; i < 3; ++i )
    {
        fixture f;
        build_start( &f, i < 2 ? "shape: random, seed: 7" : "shape: random, seed: 8" );
        corners[i] = point_of( &f, 0, 14 );
        assert_true( fabsf( corners[i].x ) <= 2.0f && fabsf( corners[i].y - 1.0f ) <= 2.0f &&
                     fabsf( corners[i].z ) <= 2.0f );
        release( &f );
    }
    assert_memory_equal( &corners[0], &corners[1], sizeof corners[0] );
    assert_memory_not_equal( &corners[0], &corners[2], sizeof corners[0] );
}

TEST( a_shaken_start_is_near_and_belongs_to_its_seed )
{
    wisp_vec3 corners[2];
    for ( int i = 0; i < 2; ++i )
    {
        fixture f;
        build_start( &f, i == 0 ? "shake: 0.01, seed: 1" : "shake: 0.01, seed: 2" );
        corners[i] = point_of( &f, 0, 14 );
        assert_true( fabsf( corners[i].x - 1.0f ) <= 0.0101f && fabsf( corners[i].y + 1.0f ) <= 0.0101f );
        assert_point_at( point_of( &f, 0, 0 ), -1.0f, 3.0f, 0.0f ); // a pin
        release( &f );
    }
    assert_memory_not_equal( &corners[0], &corners[1], sizeof corners[0] );
}

TEST( masses_of_a_surface_grow_downwards_by_its_ratio )
{
    fixture f;
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
    release( &f );
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
        fixture f;
        build( &f, text );
        wisp_vec3 points[3];
        assert_ok( scene_world_points( &f.world, 0, points, &f.error ), f.error );
        assert_point_at( points[2], rows[i].tip[0], rows[i].tip[1], rows[i].tip[2] );
        // the state of the engine is there too, and tips weigh four times as much as by density, which is half a segment
        const float* x = wisp_world_column( f.world.world, f.world.entities[0], WISP_STRAND_POSITION, 0 );
        const float* w = wisp_world_column( f.world.world, f.world.entities[0], WISP_STRAND_INVERSE_MASS, 0 );
        assert_true( fabsf( x[( 2 * 3 + 1 ) * 16] - rows[i].tip[1] ) < 1e-5f );
        assert_true( fabsf( w[16] / w[2 * 16] - 1.0f ) < 1e-4f );
        release( &f );
    }
}

TEST( a_surface_starts_scaled_then_turned_then_moved )
{
    fixture f;
    build( &f, "wisp: 1\nsurfaces:\n"
               "  - name: a\n    generate: { shape: plane, columns: 3, rows: 3, spacing: 1 }\n"
               "    transform: { scale: 2, rotate: { axis: [0, 1, 0], degrees: 90 }, translate: [10, 0, 0] }\n"
               "  - { name: b, instance_of: a, transform: { translate: [0, 5, 0] } }\n" );
    // vertex 0 of the plane is at (-1, 0, -1)
    assert_point_at( point_of( &f, 0, 0 ), 8.0f, 0.0f, 2.0f );
    assert_point_at( point_of( &f, 1, 0 ), -2.0f, 5.0f, -2.0f );
    assert_ptr_equal( f.world.surfaces[0].fabric, f.world.surfaces[1].fabric );
    release( &f );
}

TEST( a_fabric_is_cooked_with_what_its_effects_need_and_nothing_else )
{
    fixture f;
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
                   { .cross = true, .hinges = true },
                   { .hinges = true },
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
    release( &f );
}

TEST( an_instance_that_needs_coarse_sheets_is_enough_for_its_source_to_have_them )
{
    fixture f;
    build( &f, "wisp: 1\nsurfaces:\n"
               "  - { name: plain, generate: { shape: plane, columns: 33, rows: 33 }, cloth: {} }\n"
               "  - { name: carried, instance_of: plain, cloth: { coarse_substeps: 1, coarse_passes: 7 } }\n" );
    assert_true( f.world.surfaces[0].fabric->level_count > 0 );
    assert_false( wisp_world_has( f.world.world, f.world.surfaces[0].entity, WISP_SURFACE_LEVELS ) );
    const wisp_entity carried = f.world.surfaces[1].entity;
    assert_int_equal( *(const int32_t*)wisp_world_column( f.world.world, carried, WISP_SURFACE_LEVELS, 0 ), 1 );
    assert_int_equal( *(const int32_t*)wisp_world_column( f.world.world, carried, WISP_SURFACE_LEVELS, 1 ), 7 );
    release( &f );
}

TEST( pins_are_named_by_number_by_place_and_by_box )
{
    fixture f;
    build( &f,
           "wisp: 1\nsurfaces:\n"
           "  - name: a\n    generate: { shape: plane, columns: 3, rows: 3, spacing: 1 }\n"
           "    transform: { translate: [0, 2, 0] }\n"
           "    pins: [4, 4]\n    pin_nearest: [[0.9, 2.3, 0.8]]\n"
           "    pin_box: [{ min: [-2, 1, -2], max: [-0.5, 3, -0.5] }, { min: [0.5, 1, -2], max: [2, 3, -0.5] }]\n" );
    static const int32_t pins[] = { 0, 2, 4, 8 };
    assert_int_equal( f.world.surfaces[0].pin_count, 4 );
    assert_memory_equal( f.world.surfaces[0].pins, pins, sizeof pins );
    release( &f );
}

// A file whose first vertex belongs to no triangle: a repair drops it and renumbers the others.
TEST( numbers_of_vertices_are_those_of_the_file_also_after_a_repair )
{
    write_text( "scene_world_loose.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 0 1\nf 2 4 3\n" );
    fixture f;
    build(
        &f,
        "wisp: 1\nsurfaces:\n  - { name: a, file: scene_world_loose.obj, repair: [unreferenced], pins: [1, 3] }\n" );
    static const int32_t pins[] = { 0, 2 };
    assert_int_equal( f.world.surfaces[0].mesh.vertex_count, 3 );
    assert_int_equal( f.world.surfaces[0].pin_count, 2 );
    assert_memory_equal( f.world.surfaces[0].pins, pins, sizeof pins );
    release( &f );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, file: scene_world_loose.obj, repair: [unreferenced], pins: [0] }\n",
        "test.yaml:3:5: surface 'a': pins: got vertex 0, which the mesh does not have or which repair removed" );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, file: scene_world_loose.obj, require: [clean] }\n",
        "test.yaml:3:5: surface 'a': scene_world_loose.obj: unreferenced vertices: 1, the first is vertex 0" );
    remove( "scene_world_loose.obj" );
}

TEST( an_outlet_near_a_point_has_the_vertices_within_its_radius )
{
    fixture f;
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
    release( &f );
}

// Two triangles with corners of their own: those that are merged keep both of their numbers.
TEST( a_merged_vertex_is_named_by_each_of_its_numbers )
{
    write_text( "scene_world_split.obj",
                "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 0\nv 1 0 1\nv 0.001 0 1\nf 1 3 2\nf 4 6 5\n" );
    fixture f;
    build(
        &f,
        "wisp: 1\nsurfaces:\n  - { name: a, file: scene_world_split.obj, repair: [weld, flip], weld_distance: 0.01,"
        " transform: { scale: 2 }, pins: [3, 5] }\n  - { name: b, instance_of: a, pins: [1, 2, 4] }\n" );
    static const int32_t pins[] = { 1, 2, 3 };
    assert_int_equal( f.world.surfaces[0].mesh.vertex_count, 4 );
    assert_int_equal( f.world.surfaces[0].mesh.triangle_count, 2 );
    assert_int_equal( f.world.surfaces[0].mesh.triangles[1], 1 ); // flipped
    assert_int_equal( f.world.surfaces[0].pin_count, 2 );
    assert_memory_equal( f.world.surfaces[0].pins, pins, 2 * sizeof *pins );
    assert_int_equal( f.world.surfaces[1].pin_count, 3 );
    assert_memory_equal( f.world.surfaces[1].pins, pins, sizeof pins );
    release( &f );
    build( &f, "wisp: 1\ncolliders:\n  - { name: a, shape: mesh, file: scene_world_split.obj, double_sided: true,"
               " repair: [weld], weld_distance: 0.01, require: [one_component] }\n" );
    release( &f );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, file: scene_world_split.obj, repair: [weld], pins: [6] }\n",
        "test.yaml:3:5: surface 'a': pins: got vertex 6, which the mesh does not have or which repair removed" );
    remove( "scene_world_split.obj" );
}
