// Surfaces that start as another file has them: order, transforms, instances, repairs, pins, and what is refused.
#include "scene_world_fixture.h"

#include "files.h"
#include "record.h"

#include <math.h>

#define REST "scene_start_rest.obj"
#define START "scene_start.obj"
#define SHORT "scene_start_short.obj"

// A square of two triangles, with a vertex of no triangle in front and one that is welded at the end.
static int write_files( void** state )
{
    (void)state;
    write_text( REST, "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nf 2 4 3\nf 6 4 5\n" );
    write_text( START, "v 5 5 5\nv 0 0.5 0\nv 0.5 0 0\nv 0 0 0.25\nv 1 2 3\nv 7 7 7\nf 1 2 3\n" );
    write_text( SHORT, "v 0 0.5 0\nv 0.5 0 0\nv 0 0 0.25\nv 1 2 3\nf 1 2 3\n" );
    return 0;
}

static int remove_files( void** state )
{
    (void)state;
    return remove( REST ) | remove( START ) | remove( SHORT );
}

static const wisp_vec3 PLACES[4] = { { 0, 0.5f, 0 }, { 0.5f, 0, 0 }, { 0, 0, 0.25f }, { 1, 2, 3 } };

// In the user's order, scaled and moved along x. All numbers are sums of powers of two.
static void assert_starts( fixture* f, int surface, float scale, float x )
{
    const scene_world_surface* s = &f->world.surfaces[surface];
    assert_int_equal( s->mesh.vertex_count, 4 );
    wisp_vec3 points[4];
    assert_int_equal( scene_world_points( &f->world, surface, points, &f->error ), WISP_OK );
    for ( int v = 0; v < 4; ++v )
    {
        const wisp_vec3 p = PLACES[v];
        const wisp_vec3 expected = { scale * p.x + x, scale * p.y, scale * p.z };
        if ( points[v].x != expected.x || points[v].y != expected.y || points[v].z != expected.z )
        {
            fail_msg( "surface %d, vertex %d: (%g, %g, %g) is not (%g, %g, %g)", surface, v, (double)points[v].x,
                      (double)points[v].y, (double)points[v].z, (double)expected.x, (double)expected.y,
                      (double)expected.z );
        }
    }
    // The rest shape stays that of the mesh.
    const wisp_vec3 a = s->fabric->rest[s->fabric->vertex_slot[0]], b = s->fabric->rest[s->fabric->vertex_slot[1]];
    assert_true( b.x - a.x == scale && a.y == b.y && a.z == b.z );
}

TEST( a_start_has_the_vertices_of_the_file_or_of_the_repaired_mesh )
{
    static const char* const FILES[] = { START, SHORT };
    for ( int i = 0; i < 2; ++i )
    {
        char text[600];
        snprintf( text, sizeof text,
                  "wisp: 1\nsurfaces:\n"
                  "  - { name: a, file: " REST ", repair: [weld, unreferenced], start: { file: %s }, cloth: {},"
                  " transform: { scale: 2, translate: [4, 0, 0] }, pins: [4] }\n"
                  "  - { name: b, instance_of: a, start: { file: %s }, cloth: {} }\n"
                  "  - { name: c, instance_of: a, cloth: {} }\n",
                  FILES[i], FILES[1 - i] );
        fixture f;
        build( &f, text );
        assert_starts( &f, 0, 2.0f, 4.0f );
        assert_starts( &f, 1, 2.0f, 0.0f );
        assert_true( f.world.surfaces[2].mesh.points[1].x == 2.0f && f.world.surfaces[2].mesh.points[3].z == 2.0f );
        step( &f, 2 );
        wisp_vec3 points[4];
        assert_int_equal( scene_world_points( &f.world, 0, points, &f.error ), WISP_OK );
        // The pin holds where the file has it.
        assert_true( points[3].x == 6.0f && points[3].y == 4.0f && points[3].z == 6.0f );
        release( &f );
    }
}

TEST( scale_and_shake_come_after_the_file )
{
    fixture f;
    build( &f, "wisp: 1\nsurfaces:\n  - { name: a, file: " REST ", repair: [weld, unreferenced],"
               " start: { file: " SHORT ", scale: [2, 1, 0] } }\n" );
    // About the middle of the file's bounds: x 0 .. 1, z 0 .. 3.
    const wisp_vec3* p = f.world.surfaces[0].mesh.points;
    assert_true( p[0].x == -0.5f && p[1].x == 0.5f && p[3].x == 1.5f );
    assert_true( p[0].z == 1.5f && p[3].z == 1.5f && p[3].y == 2.0f );
    release( &f );
}

TEST( a_host_gives_a_start_as_arrays )
{
    static const int32_t triangles[] = { 0, 1, 2 };
    const wisp_scene_arrays arrays = {
        .file = "memory", .points = PLACES, .point_count = 4, .triangles = triangles, .triangle_count = 1
    };
    fixture f = { .scene = parsed( "wisp: 1\nsurfaces:\n  - { name: a, start: { file: memory },"
                                   " generate: { shape: plane, columns: 2, rows: 2, spacing: 1 } }\n" ) };
    assert_ok( wisp_scene_set_arrays( &f.scene, &arrays, 1, &f.error ), f.error );
    create( &f, 1 );
    assert_starts( &f, 0, 1.0f, 0.0f );
    release( &f );
}

static wisp_status list_file( void* user, const char* file, wisp_error* error )
{
    strcat( strcat( user, file ), " " );
    return strcmp( file, "stop.glb" ) == 0 ? wisp_fail( error, WISP_CONFLICT, "stopped" ) : WISP_OK;
}

TEST( all_files_of_a_scene_are_listed_without_names_of_meshes )
{
    wisp_scene scene = parsed( "wisp: 1\nsurfaces:\n  - { name: a, file: a.glb#skin, start: { file: 'b#1.obj' }, "
                               "area_density: { map: m.txt },"
                               " animation: { file: motion.glb, clips: [{ clip: walk }] } }\n"
                               "  - { name: b, file: stop.glb, start: { file: not.obj } }\n"
                               "colliders:\n  - { name: c, shape: mesh, file: c.glb#stone }\n"
                               "strands:\n  - { name: s, file: s.hair }\n" );
    char names[200] = "";
    wisp_error error = { 0 };
    assert_int_equal( wisp_scene_files( &scene, list_file, names, &error ), WISP_CONFLICT );
    assert_string_equal( names, "s.hair a.glb b#1.obj motion.glb m.txt stop.glb " );
    assert_string_equal( error.message, "stopped" );
    wisp_scene_release( &scene );
}

TEST( a_start_that_does_not_fit_is_refused )
{
    static const char* const BAD[][2] = {
        { "file: " REST ", start: { file: " SHORT " }",
          "start.file: " SHORT ": got 4 vertices, expected 6 as the mesh has" },
        { "file: " REST ", repair: [weld], start: { file: " SHORT " }",
          "start.file: " SHORT ": got 4 vertices, expected 5 as the mesh has, or 6 as before its repair" },
        { "generate: { shape: plane, columns: 2, rows: 3 }, start: { file: " SHORT " }",
          "start.file: " SHORT ": got 4 vertices, expected 6 as the mesh has" },
        { "file: " REST ", start: { file: none.obj }", "none.obj: cannot open: No such file or directory" },
        { "file: " REST ", start: { file: none.txt }",
          "none.txt: not a mesh, expected a file that ends in .obj, .ply, .glb or .gltf" },
    };
    for ( int i = 0; i < WISP_COUNT( BAD ); ++i )
    {
        char text[500], message[300];
        snprintf( text, sizeof text, "wisp: 1\nsurfaces:\n  - { name: a, %s }\n", BAD[i][0] );
        snprintf( message, sizeof message, "test.yaml:3:5: surface 'a': %s", BAD[i][1] );
        fixture f;
        assert_true( try_build( &f, text ) != WISP_OK );
        assert_string_equal( f.error.message, message );
        wisp_scene_release( &f.scene );
    }
}

// A recording of cloth goes on where a frame of it stopped: the vertices are those of the scene, in its order.
TEST( a_frame_of_a_recording_is_a_start )
{
    static const char TEXT[] =
        "wisp: 1\nsteps: 4\nsurfaces:\n  - { name: sheet, generate: { shape: plane, columns: 5, rows: 4 },"
        " pins: [0, 4], cloth: {}%s }\n";
    char text[600];
    snprintf( text, sizeof text, TEXT, "" );
    fixture f;
    build( &f, text );
    wisp_vec3 points[5][20];
    const scene_body body = scene_world_body( &f.world, 0 );
    const wisp_record_body recorded = { .name = "sheet",
                                        .triangles = body.triangles,
                                        .vertex_count = body.vertex_count,
                                        .triangle_count = body.triangle_count };
    const wisp_recorder_def def = { .bodies = &recorded, .body_count = 1, .dt = 1.0 / 60.0 };
    wisp_recorder* recorder;
    assert_ok( wisp_recorder_open( "scene_start.glb", WISP_RECORD_BY_NAME, &def, &recorder, &f.error ), f.error );
    for ( int i = 0; i < 5; ++i )
    {
        step( &f, i > 0 ? 1 : 0 );
        assert_int_equal( scene_world_points( &f.world, 0, points[i], &f.error ), WISP_OK );
        const wisp_vec3* all[] = { points[i] };
        assert_ok( wisp_recorder_frame( recorder, i / 60.0, 0, all, &f.error ), f.error );
    }
    assert_ok( wisp_recorder_close( recorder, &f.error ), f.error );
    release( &f );
    snprintf( text, sizeof text, TEXT, ", start: { file: 'scene_start.glb#@frame_0005' }" );
    build( &f, text );
    wisp_vec3 began[20];
    assert_int_equal( scene_world_points( &f.world, 0, began, &f.error ), WISP_OK );
    double moved = 0.0;
    for ( int v = 0; v < 20; ++v )
    {
        const double x = (double)began[v].x - (double)points[4][v].x, y = (double)began[v].y - (double)points[4][v].y,
                     z = (double)began[v].z - (double)points[4][v].z;
        assert_true( sqrt( x * x + y * y + z * z ) < 1e-7 ); // m, of a sheet 0.08 m wide
        moved = fmax( moved, fabs( (double)points[4][v].y - (double)points[0][v].y ) );
    }
    assert_true( moved > 0.01 );
    release( &f );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 5, rows: 4 },"
        " start: { file: 'scene_start.glb#@frame_0006' } }\n",
        "test.yaml:3:5: surface 'a': scene_start.glb: got 'frame_0006' behind @, expected a time in s or one of "
        "the 4 morph targets 'frame_0002' .. 'frame_0005'" );
    // a body that moves as recorded, at half the speed from the third step on, and cloth of which one pin does
    build( &f, "wisp: 1\nsteps: 20\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 5, rows: 4 }, "
               "collider: { double_sided: true },"
               " animation: { file: 'scene_start.glb#sheet', clips: [{ clip: recording, time: 0.05, speed: 0.5 }] },"
               " transform: { scale: 2, translate: [1, 0, 0] } }\n"
               "  - { name: b, generate: { shape: plane, columns: 5, rows: 4 }, cloth: {}, pins: [19],"
               " animation: { file: scene_start.glb, clips: [{ clip: recording }] } }\n" );
    for ( int i = 1; i <= 20; ++i )
    {
        wisp_vec3 now[20];
        step( &f, 1 );
        const double at = fmin( fmax( ( i - 3 ) * 0.5, 0.0 ), 4.0 ), part = at - floor( at );
        const int frame = (int)at, next = frame < 4 ? frame + 1 : 4;
        assert_int_equal( scene_world_points( &f.world, 0, now, &f.error ), WISP_OK );
        for ( int v = 0; v < 20; ++v )
        {
            const wisp_vec3 p = points[frame][v], q = points[next][v];
            assert_true( fabs( (double)now[v].x - 1.0 -
                               2.0 * ( (double)p.x + part * ( (double)q.x - (double)p.x ) ) ) < 1e-6 );
            assert_true( fabs( (double)now[v].y - 2.0 * ( (double)p.y + part * ( (double)q.y - (double)p.y ) ) ) <
                         1e-6 );
        }
        assert_int_equal( scene_world_points( &f.world, 1, now, &f.error ), WISP_OK );
        assert_true( fabs( (double)now[19].y - (double)points[i < 4 ? i : 4][19].y ) < 1e-6 );
    }
    release( &f );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 5, rows: 5 },"
        " animation: { file: scene_start.glb, clips: [{ clip: recording }] } }\n",
        "test.yaml:3:5: surface 'a': animation: scene_start.glb: got 20 vertices, expected 25 as the mesh has" );
    demand_refusal(
        "wisp: 1\nsurfaces:\n  - { name: a, generate: { shape: plane, columns: 5, rows: 4 },"
        " animation: { file: scene_start.glb, clips: [{ clip: recording }, { clip: recording, time: 1 }] } }\n",
        "test.yaml:3:5: surface 'a': animation: got 2 clips, expected one of a mesh with morph targets" );
    // and one that does not move
    build( &f, "wisp: 1\ncolliders:\n  - { name: c, shape: mesh, file: 'scene_start.glb#sheet@0.05', double_sided: "
               "true }\n" );
    release( &f );
    remove( "scene_start.glb" );
}

TEST_GROUP( write_files, remove_files )
