// From a scene with surfaces to a running world: bodies, requests, outputs, reports.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "files.h"

#include <unistd.h>

// ---- bodies ----

TEST( bodies_are_strands_then_surfaces_then_colliders )
{
    fixture f;
    build( &f, "wisp: 1\n"
               "colliders:\n  - { name: ground, shape: plane, position: [0, -1, 0] }\n"
               "  - { name: crate, shape: box, half_extent: [1, 2, 3] }\n"
               "surfaces:\n  - { name: ball, generate: { shape: icosphere, level: 1 }, balloon: {} }\n"
               "  - { name: twin, instance_of: ball, cloth: {} }\n"
               "strands:\n  - { name: hair, generate: { strands: 3, vertices: 5 } }\n" );
    static const scene_body_kind kinds[] = { SCENE_BODY_STRANDS, SCENE_BODY_BALLOON, SCENE_BODY_CLOTH,
                                             SCENE_BODY_PLANE, SCENE_BODY_COLLIDER };
    static const char* const names[] = { "hair", "ball", "twin", "ground", "crate" };
    static const int vertices[] = { 15, 42, 42, 4, 8 };
    assert_int_equal( scene_world_body_count( &f.world ), 5 );
    assert_int_equal( scene_world_moving_count( &f.world ), 3 );
    for ( int i = 0; i < 5; ++i )
    {
        scene_body body = scene_world_body( &f.world, i );
        assert_int_equal( body.kind, kinds[i] );
        assert_string_equal( body.name, names[i] );
        assert_int_equal( body.vertex_count, vertices[i] );
        assert_int_equal( body.offsets != NULL, i == 0 );
        assert_int_equal( body.triangles != NULL, i > 0 );
    }
    assert_ptr_equal( scene_world_body( &f.world, 2 ).triangles, scene_world_body( &f.world, 1 ).triangles );
    assert_int_equal( scene_world_vertices( &f.world ), 99 );
    assert_int_equal( scene_world_triangles( &f.world ), 160 );
    release( &f );
}

// Volume of a closed mesh, m^3: positive if its triangles look outwards.
static double volume_of( const scene_body* body, const wisp_vec3* p )
{
    double sum = 0.0;
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        const wisp_vec3 a = p[body->triangles[3 * t]], b = p[body->triangles[3 * t + 1]],
                        c = p[body->triangles[3 * t + 2]];
        sum += (double)( a.x * ( b.y * c.z - b.z * c.y ) + a.y * ( b.z * c.x - b.x * c.z ) +
                         a.z * ( b.x * c.y - b.y * c.x ) );
    }
    return sum / 6.0;
}

TEST( meshes_of_colliders_look_outwards_and_have_their_size )
{
    fixture f;
    build( &f, "wisp: 1\ncolliders:\n"
               "  - { name: box, shape: box, half_extent: [1, 2, 3] }\n"
               "  - { name: ball, shape: sphere, radius: 0.5 }\n"
               "  - { name: pill, shape: capsule, radius: 0.5, half_length: 1 }\n"
               "  - { name: dot, shape: capsule, radius: 0.5, half_length: 0 }\n" );
    const double third = 4.0 / 3.0 * 3.14159265358979 * 0.125;
    const double volumes[] = { 48.0, third, third + 3.14159265358979 * 0.5, third };
    for ( int i = 0; i < 4; ++i )
    {
        scene_body body = scene_world_body( &f.world, i );
        wisp_vec3* points = checked_calloc( (size_t)body.vertex_count, sizeof *points );
        assert_int_equal( scene_world_points( &f.world, i, points, &f.error ), WISP_OK );
        // an icosphere of level 4 lacks 0.2 % of the ball's volume, a capsule of 48 segments 0.4 %
        assert_true( fabs( volume_of( &body, points ) / volumes[i] - 1.0 ) < 0.006 );
        free( points );
    }
    release( &f );
}

TEST( a_plane_is_shown_as_a_square_that_looks_up )
{
    fixture f;
    build( &f,
           "wisp: 1\ncolliders:\n"
           "  - { name: wall, shape: plane, position: [0, 1, 0], rotation: { axis: [0, 0, 1], degrees: 90 } }\n" );
    const int32_t* t = scene_world_body( &f.world, 0 ).triangles;
    wisp_vec3 a = point_of( &f, 0, t[0] ), b = point_of( &f, 0, t[1] ), c = point_of( &f, 0, t[2] );
    wisp_vec3 e = { b.x - a.x, b.y - a.y, b.z - a.z }, d = { c.x - a.x, c.y - a.y, c.z - a.z };
    // up, turned by 90 degrees about z, is -x; the triangle is half of a square of 2 m
    assert_point_at( ( wisp_vec3 ){ e.y * d.z - e.z * d.y, e.z * d.x - e.x * d.z, e.x * d.y - e.y * d.x }, -4, 0, 0 );
    release( &f );
}

// ---- requests ----

TEST( what_a_body_does_not_have_cannot_be_queried_for )
{
    fixture f;
    build( &f, "wisp: 1\nstrands:\n  - { name: hair, generate: { strands: 2 } }\n"
               "surfaces:\n  - { name: cloth, generate: { shape: plane } }\n"
               "colliders:\n  - { name: ground, shape: plane }\n" );
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_STRAIN, &f.error ), WISP_BAD_INPUT );
    assert_string_equal( f.error.message, "test.yaml: 'hair' has no strain" );
    assert_int_equal( scene_world_request( &f.world, 0, SCENE_REQUEST_WIDTH, &f.error ), WISP_BAD_INPUT );
    assert_int_equal( scene_world_request( &f.world, 1, SCENE_REQUEST_COLOUR, &f.error ), WISP_BAD_INPUT );
    assert_int_equal( scene_world_request( &f.world, 2, SCENE_REQUEST_POINTS, &f.error ), WISP_BAD_INPUT );
    release( &f );
}

TEST( what_is_queried_for_is_there_after_a_step )
{
    fixture f;
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
    assert_true( fabsf( speeds[8] - 9.8f / 60.0f ) < 1e-6f );
    assert_true( fabs( motion_stats.speed_max - 9.8 / 60.0 ) < 1e-6 );
    assert_true( fabs( scene_world_time( &f.world ) - 1.0 / 60.0 ) < 1e-8 );
    wisp_vec3 points[9];
    assert_int_equal( scene_world_points( &f.world, 0, points, &f.error ), WISP_CONFLICT );
    assert_non_null( strstr( f.error.message, "'cloth'" ) );
    release( &f );
}

// ---- outputs ----

TEST( a_written_surface_is_read_back_where_it_was )
{
    fixture f;
    build( &f, "wisp: 1\nsteps: 5\nsurfaces:\n  - { name: cloth, generate: { shape: plane, columns: 3, rows: 3 } }\n"
               "output: [{ surface: cloth, file: scene_world_out.ply }]\n" );
    step( &f, 3 );
    assert_int_equal( scene_world_write_outputs( &f.world, &f.error ), WISP_OK );
    wisp_mesh mesh;
    assert_int_equal( wisp_mesh_read( "scene_world_out.ply", &mesh, &f.error ), WISP_OK );
    assert_int_equal( mesh.vertex_count, 9 );
    assert_int_equal( mesh.triangle_count, 8 );
    wisp_vec3 now = point_of( &f, 0, 8 );
    assert_true( mesh.points[8].x == now.x && mesh.points[8].y == now.y && mesh.points[8].z == now.z );
    assert_true( now.y < 0.0f );
    wisp_mesh_release( &mesh );
    remove( "scene_world_out.ply" );
    release( &f );
}

// ---- rejected scenes ----

TEST( what_only_the_mesh_can_tell_is_refused_at_the_line_of_its_surface )
{
    demand_refusal( "wisp: 1\nsurfaces:\n"
                    "  - { name: a, generate: { shape: plane }, pin_box: { min: [5, 5, 5], max: [6, 6, 6] } }\n",
                    "test.yaml:3:5: surface 'a': no vertex starts in pin_box 0" );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 3, rows: 3 }, balloon: {} }\n",
        "test.yaml:3:5: surface 'a': balloon: got 8 open edges, the first from vertex 0 to vertex 3, "
        "expected a closed mesh; allow_open closes holes" );
    demand_refusal( "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: icosphere, level: 1 } }\n"
                    "  - { name: b, instance_of: a, pins: [42] }\n",
                    "test.yaml:4:5: surface 'b': pins: got vertex 42, but the mesh has 42 vertices, counted from 0" );
    demand_refusal( "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: icosphere, level: 5 }, "
                    "balloon: { outlet_nearest: [0, 0, 0], outlet_radius: 1 } }\n",
                    "test.yaml:3:5: surface 'a': balloon.outlet_radius: got more than 64 vertices within 1 m, which "
                    "is the limit" );
}

TEST( a_missing_mesh_is_an_error_of_the_system_at_its_line )
{
    fixture f;
    assert_int_equal( try_build( &f, "wisp: 1\nsurfaces:\n  - { name: a, file: no_such_mesh.obj }\n" ),
                      WISP_IO_ERROR );
    assert_non_null( strstr( f.error.message, "test.yaml:3:5: surface 'a': no_such_mesh.obj" ) );
    wisp_scene_release( &f.scene );
    assert_int_equal( try_build( &f, "wisp: 1\ncolliders:\n  - { name: a, shape: mesh, file: no_such_mesh.obj }\n" ),
                      WISP_IO_ERROR );
    assert_non_null( strstr( f.error.message, "test.yaml:3:5: collider 'a': no_such_mesh.obj" ) );
    wisp_scene_release( &f.scene );
}

// ---- scenes of the project ----

TEST( the_scenes_of_the_project_run )
{
    static const char* const files[] = { "bunny_balloon.yaml", "hanging_cloth.yaml", "cloth_on_ball.yaml",
                                         "flag.yaml",          "balloons.yaml",      "pear_jet.yaml" };
    for ( int i = 0; i < WISP_COUNT( files ); ++i )
    {
        fixture f;
        open_scene( &f, files[i], 2 );
        step( &f, 3 );
        assert_true( wisp_world_counter( f.world.world, WISP_COUNT_STEPS ) == 3 );
        release( &f );
    }
}
