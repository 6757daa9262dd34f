// From a scene with moving strands to a running world: heads, roots on surfaces, ghosts, curves, and rejected scenes. What
// a user does to the world of a scene: holds vertices, moves colliders, changes gravity and wind.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "world_from_scene.h"

/// To be freed.
static wisp_vec3* points_of( fixture* f, int body )
{
    wisp_vec3* points =
        checked_calloc( (size_t)scene_world_body( &f->world, body ).vertex_count + 1, sizeof *points );
    if ( scene_world_points( &f->world, body, points, &f->error ) != WISP_OK )
    {
        fail_msg( "no points: %s", f->error.message );
    }
    return points;
}

static float distance( wisp_vec3 a, wisp_vec3 b )
{
    return sqrtf( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
}

static void assert_near( wisp_vec3 v, wisp_vec3 expected, float tolerance )
{
    if ( !( distance( v, expected ) <= tolerance ) )
    {
        fail_msg( "(%g, %g, %g) is not (%g, %g, %g)", (double)v.x, (double)v.y, (double)v.z, (double)expected.x,
                  (double)expected.y, (double)expected.z );
    }
}

// The largest displacement of a vertex of a body.
static float largest_way( const wisp_vec3* before, const wisp_vec3* after, int count )
{
    float largest = 0.0f;
    for ( int v = 0; v < count; ++v )
    {
        largest = fmaxf( largest, distance( before[v], after[v] ) );
    }
    return largest;
}

// ---- start positions ----

TEST( curves_are_bodies_wherever_their_source_stands )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsteps: 2\nstrands:\n"
               "  - { name: drawn, curves: { of: hair, samples: 3 }, compute: [points] }\n"
               "  - { name: hair, generate: { strands: 4, vertices: 6 } }\n" );
    const scene_body body = scene_world_body( &f.world, 0 );
    assert_int_equal( body.kind, SCENE_BODY_STRANDS );
    assert_int_equal( body.vertex_count, 4 * ( 5 * 3 + 1 ) );
    assert_int_equal( body.strand_count, 4 );
    assert_int_equal( body.offsets[1], 16 );
    assert_int_equal( scene_world_strands( &f.world ), 8 );
}

// Curves drawn before the first step are the same as those of the engine for static strands.
TEST( the_first_frame_of_curves_is_what_the_engine_draws )
{
    static const char* const kinds[] = { "bezier", "catmull_rom" };
    for ( int kind = 0; kind < WISP_COUNT( kinds ); ++kind )
    {
        char text[400];
        snprintf( text, sizeof text,
                  "wisp: 1\nsteps: 1\nstrands:\n"
                  "  - { name: hair, generate: { shape: curly, strands: 5, vertices: 12 } }\n"
                  "  - { name: drawn, curves: { of: hair, kind: %s, samples: 5 }, compute: [points] }\n",
                  kinds[kind] );
        SCOPED( release ) fixture f;
        build( &f, text );
        const int count = scene_world_body( &f.world, 1 ).vertex_count;
        SCOPED( free_local ) wisp_vec3* before = points_of( &f, 1 );
        step( &f, 1 );
        SCOPED( free_local ) wisp_vec3* after = points_of( &f, 1 );
        // coordinates are below 0.5 m; a point is a sum of a dozen products
        assert_true( largest_way( before, after, count ) <= 4e-7f );
    }
}

// ---- heads ----

static const char TURNING_HEAD[] =
    "wisp: 1\nsteps: 20\ndt: 0.1\nsubsteps: 2\nstrands:\n"
    "  - name: hair\n    generate: { strands: 20, vertices: 5, scalp_radius: 0.1 }\n"
    "    transform: { translate: [1, 2, 3] }\n    dynamics: {}\n    compute: [points]\n"
    "    head: { keyframes: [ { time: 0.5, position: [1, 2, 3] }, { time: 1.5, position: [2, 2, 3], rotation: { "
    "axis: [0, "
    "0, 1], degrees: 90 } } ] }\n"
    "colliders:\n"
    "  - name: head\n    shape: box\n    half_extent: [0.1, 0.1, 0.1]\n    position: [1, 2, 3]\n"
    "    keyframes: [ { time: 0.5, position: [1, 2, 3] }, { time: 1.5, position: [2, 2, 3], rotation: { axis: [0, 0, "
    "1], "
    "degrees: 90 } } ]\n";

TEST( roots_go_with_a_collider_of_the_same_keyframes )
{
    SCOPED( release ) fixture f;
    build( &f, TURNING_HEAD );
    SCOPED( free_local ) wisp_vec3* start = points_of( &f, 0 );
    for ( int i = 0; i < 20; ++i )
    {
        step( &f, 1 );
        SCOPED( free_local ) wisp_vec3* now = points_of( &f, 0 );
        for ( int s = 0; s < 20; ++s )
        {
            const wisp_vec3 p = start[5 * s], own = { p.x - 1.0f, p.y - 2.0f, p.z - 3.0f };
            const wisp_vec3 held = wisp_transform_to_world( f.world.colliders[0].pose, own );
            // coordinates are below 4 m, where a float is within 2.4e-7, and a pose is a few sums of them
            assert_near( now[5 * s], held, 2e-6f );
        }
    }
    const wisp_vec3 first = start[0], end = { 2.0f - ( first.y - 2.0f ), 2.0f + ( first.x - 1.0f ), first.z };
    assert_near( point_of( &f, 0, 0 ), end, 2e-6f );
}

TEST( roots_stay_on_the_surface_that_is_named_below_them )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsteps: 20\ndt: 0.05\nstrands:\n"
               "  - { name: hair, generate: { dimension: 2, strands: 3, vertices: 4, spacing: 0.01 }, dynamics: {}, "
               "on_surface: "
               "board, compute: [points] }\n"
               "surfaces:\n"
               "  - name: board\n    generate: { shape: plane, columns: 4, rows: 4, spacing: 0.1 }\n"
               "    pin_box: { min: [-1, -1, -1], max: [1, 1, 1] }\n"
               "    pin_keyframes: [ { time: 0.5, translate: [0.25, 0.5, 0] } ]\n" );
    SCOPED( free_local ) wisp_vec3* start = points_of( &f, 0 );
    step( &f, 20 );
    SCOPED( free_local ) wisp_vec3* now = points_of( &f, 0 );
    for ( int s = 0; s < 3; ++s )
    {
        const wisp_vec3 p = start[4 * s];
        // three barycentric weights, each within half an ulp of a value below 1
        assert_near( now[4 * s], ( wisp_vec3 ){ p.x + 0.25f, p.y + 0.5f, p.z }, 1e-6f );
    }
}

// ---- ghosts ----

static const char FOLLOWED[] =
    "wisp: 1\nsteps: 10\ndt: 0.02\nsubsteps: 2\nstrands:\n"
    "  - name: guides\n    generate: { strands: 6, vertices: 8, length: 0.1 }\n    dynamics: {}\n"
    "    head: { keyframes: [ { time: 0.1, position: [0, 0.05, 0] } ] }\n    compute: [points]\n"
    "  - { name: ghosts, scatter: { around: guides, count: 3, radius: 0.01 }, ghosts: {}, compute: [points] }\n"
    "  - name: frozen\n    scatter: { around: guides, count: 3, radius: 0.01 }\n    ghosts: {}\n"
    "    frozen_hair: { freeze: {} }\n    compute: [points]\n";

// The mean of three roots.
static wisp_vec3 middle_root( const wisp_vec3* points )
{
    const wisp_vec3 a = points[0], b = points[8], c = points[16];
    return ( wisp_vec3 ){ ( a.x + b.x + c.x ) / 3.0f, ( a.y + b.y + c.y ) / 3.0f, ( a.z + b.z + c.z ) / 3.0f };
}

TEST( roots_of_ghosts_stand_around_that_of_their_target_with_and_without_frozen_hair )
{
    SCOPED( release ) fixture f;
    build( &f, FOLLOWED );
    SCOPED( free_local ) wisp_vec3 *guides = points_of( &f, 0 ), *start = points_of( &f, 1 );
    step( &f, 10 );
    for ( int body = 1; body < 3; ++body )
    {
        SCOPED( free_local ) wisp_vec3* now = points_of( &f, body );
        for ( int g = 0; g < 18; ++g )
        {
            // The mean of a group is its target, which the head has raised by 0.05 m. A root is out of the sway of eq. 5,
            // and its frame is not turned: what remains is the rounding of sums of coordinates below 0.3 m.
            const wisp_vec3 p = start[8 * g], mean = middle_root( &start[24 * ( g / 3 )] ), x = guides[8 * ( g / 3 )];
            const wisp_vec3 expected = { x.x + p.x - mean.x, x.y + p.y - mean.y + 0.05f, x.z + p.z - mean.z };
            assert_near( now[8 * g], expected, 1e-6f );
        }
    }
}

TEST( frozen_hair_changes_what_ghosts_look_like_and_not_where_they_are_carried )
{
    SCOPED( release ) fixture f;
    build( &f, FOLLOWED );
    step( &f, 10 );
    SCOPED( free_local ) wisp_vec3 *ghosts = points_of( &f, 1 ), *frozen = points_of( &f, 2 );
    assert_true( largest_way( ghosts, frozen, 8 * 18 ) > 1e-4f );
    // A frozen vertex may differ from its position by part of its strand's length, 0.1 m, but not by more.
    assert_true( largest_way( ghosts, frozen, 8 * 18 ) < 0.1f );
}

TEST( ghosts_of_other_lengths_are_refused_at_their_line )
{
    fixture f;
    assert_int_equal(
        try_build( &f, "wisp: 1\nstrands:\n"
                       "  - { name: guides, generate: { strands: 2, vertices: 8 }, dynamics: {} }\n"
                       "  - { name: ghosts, generate: { strands: 5, vertices: 9 }, ghosts: { targets: guides } }\n" ),
        WISP_BAD_INPUT );
    const char* place = "test.yaml:4:5: strands 'ghosts': ";
    assert_memory_equal( f.error.message, place, strlen( place ) );
    assert_null( f.world.world );
    wisp_scene_release( &f.scene );
}

TEST( ghosts_of_other_lengths_follow_if_they_are_resampled )
{
    SCOPED( release ) fixture f;
    build( &f, "wisp: 1\nsteps: 2\nstrands:\n"
               "  - { name: guides, generate: { strands: 2, vertices: 8 }, dynamics: {} }\n"
               "  - { name: ghosts, generate: { strands: 5, vertices: 9 }, ghosts: { targets: guides, resample: true "
               "}, compute: "
               "[points] }\n" );
    step( &f, 2 );
    assert_true( isfinite( point_of( &f, 1, 44 ).x ) );
}

TEST( masses_of_scattered_strands_are_counted_once_there_are_any )
{
    demand_refusal(
        "wisp: 1\nstrands:\n"
        "  - { name: guides, generate: { dimension: 2, strands: 1, vertices: 2 } }\n"
        "  - { name: more, scatter: { around: guides, count: 2, radius: 0.01 }, dynamics: { vertex_masses: "
        "[1e-8, 1e-8] } }\n",
        "test.yaml:4:5: strands 'more': dynamics.vertex_masses: got 2 masses, expected one for each of 4 vertices" );
}

// ---- requests ----

TEST( strands_that_move_tell_strain_speed_and_motion_stats_and_others_do_not )
{
    SCOPED( release ) fixture f;
    build(
        &f,
        "wisp: 1\nsteps: 3\nstrands:\n"
        "  - name: hair\n    generate: { dimension: 2, strands: 4, vertices: 6, length: 0.2, length_variation: 0 }\n"
        "    transform: { rotate: { axis: [1, 0, 0], degrees: 90 } }\n"
        "    dynamics: { bending: none }\n    compute: [strain, speed, motion_stats]\n"
        "  - { name: still, generate: { strands: 2, vertices: 2 } }\n" );
    step( &f, 3 );
    float speed[24], strain[24];
    wisp_motion_stats motion_stats;
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_SPEED, speed, &f.error ), WISP_OK );
    assert_int_equal( scene_world_numbers( &f.world, 0, SCENE_REQUEST_STRAIN, strain, &f.error ), WISP_OK );
    assert_int_equal( scene_world_motion_stats( &f.world, 0, &motion_stats, &f.error ), WISP_OK );
    // a chain released level falls at least as fast as a stone: g t = 0.49 m/s after 3 steps, from the tip, 2/3 of it
    // on the way
    assert_true( speed[5] > 0.3f && speed[0] == 0.0f );
    assert_true( strain[3] >= 0.0f && strain[3] <= 1e-3f ); // the tolerance of the direct solve
    assert_true( fabs( motion_stats.speed_max - (double)speed[5] ) < 0.2 );
    assert_int_equal( scene_world_request( &f.world, 1, SCENE_REQUEST_SPEED, &f.error ), WISP_BAD_INPUT );
    assert_string_equal( f.error.message, "test.yaml: 'still' has no speed" );
}

// ---- jumps ----

static void run_until( fixture* f, int end )
{
    while ( f->world.next_step < end )
    {
        step( f, 1 );
    }
}

static const char JUMPS[] =
    "wisp: 1\nsteps: 90\ndt: 0.01\nsurfaces:\n"
    "  - name: cloth\n    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n    pins: [0, 8]\n"
    "    pin_keyframes: [{ time: 0.3, translate: [3, 0, 0], jump: true },\n"
    "                    { time: 0.405, translate: [3, 7, 0], rotate: { axis: [0, 1, 0], degrees: 90 }, jump: true "
    "}]\n"
    "    cloth: { bending: bend_links }\n    damping: 5\n"
    "  - { name: ball, generate: { shape: icosphere, level: 1, radius: 0.1 }, balloon: {}, gravity: [0, 0, 0] }\n"
    "strands:\n"
    "  - name: hair\n    generate: { strands: 3, vertices: 8, length: 0.1 }\n    dynamics: { damping: 5 }\n"
    "    head: { keyframes: [{ time: 0.3, position: [0, 0, 4], jump: true }] }\n"
    "colliders:\n"
    "  - name: body\n    shape: sphere\n    radius: 0.1\n    position: [0, -2, 0]\n"
    "    keyframes: [{ time: 0.3, position: [0, 2, 0], jump: true }, { time: 0.4, position: [1, 2, 0] }]\n"
    "events: [{ step: 30, surface: ball, teleport: [0, 0, 9] }]\n";

// Bodies are strands, surfaces and colliders, in this order.
TEST( keyframes_that_jump_and_events_teleport )
{
    SCOPED( release ) fixture f;
    build( &f, JUMPS );
    run_until( &f, 30 );
    wisp_vec3* before[4] = { points_of( &f, 0 ), points_of( &f, 1 ), points_of( &f, 2 ), points_of( &f, 3 ) };
    run_until( &f, 31 );
    wisp_vec3* after[4] = { points_of( &f, 0 ), points_of( &f, 1 ), points_of( &f, 2 ), points_of( &f, 3 ) };
    const wisp_vec3 ways[4] = { { 0, 0, 4 }, { 3, 0, 0 }, { 0, 0, 9 }, { 0.1f, 4, 0 } };
    for ( int body = 0; body < 4; ++body )
    {
        const int count = scene_world_body( &f.world, body ).vertex_count;
        for ( int v = 0; v < count; ++v )
        {
            const wisp_vec3 p = before[body][v], way = ways[body];
            // Other motion in a step of 10 ms is below 5 cm.
            assert_near( after[body][v], ( wisp_vec3 ){ p.x + way.x, p.y + way.y, p.z + way.z }, 0.05f );
        }
        free( before[body] );
        free( after[body] );
    }
    // Between two steps a jump waits for the next one, and the pins stay until then.
    run_until( &f, 41 );
    const wisp_vec3 pin = point_of( &f, 1, 0 );
    assert_near( pin, ( wisp_vec3 ){ 2.8f, 0, -0.2f }, 1e-5f );
    run_until( &f, 42 );
    // The pins lie 0.4 m apart along x and turn about their middle, at z = -0.2.
    assert_near( point_of( &f, 1, 0 ), ( wisp_vec3 ){ 3, 7, 0 }, 1e-5f );
    run_until( &f, 90 );
    assert_near( point_of( &f, 1, 8 ), ( wisp_vec3 ){ 3, 7, -0.4f }, 1e-5f );
}

// A collider whose last keyframe jumps is drawn where it is.
TEST( a_collider_stays_where_its_last_jump_has_taken_it )
{
    SCOPED( release ) fixture f;
    build( &f,
           "wisp: 1\nsteps: 20\ndt: 0.01\ncolliders:\n"
           "  - name: body\n    shape: sphere\n    radius: 0.1\n"
           "    keyframes: [{ time: 0.05, position: [0, 1, 0] }, { time: 0.1, position: [5, 2, 0], jump: true }]\n" );
    run_until( &f, 20 );
    const wisp_vec3 p = f.world.colliders[0].pose.translation;
    assert_near( p, ( wisp_vec3 ){ 5, 2, 0 }, 1e-6f );
}

TEST( levels_of_detail_are_set_and_changed_by_events )
{
    SCOPED( release ) fixture f;
    build(
        &f,
        "wisp: 1\nsteps: 20\nsubsteps: 8\nstrands:\n"
        "  - { name: guides, generate: { strands: 4, vertices: 6 }, dynamics: {}, detail: { level: fewer_substeps } "
        "}\n"
        "  - { name: hair, generate: { strands: 8, vertices: 6 }, ghosts: { targets: guides }, detail: { level: "
        "coarse } }\n"
        "surfaces:\n"
        "  - name: sheet\n    generate: { shape: plane, columns: 24, rows: 24, spacing: 0.02 }\n    pins: [0, 23]\n"
        "    cloth: { coarse_substeps: 1 }\n    detail: { substep_divisor: 2, blend_steps: 4 }\n"
        "events:\n"
        "  - { step: 3, surface: sheet, detail: coarse }\n"
        "  - { step: 5, strands: guides, detail: nothing }\n" );
    wisp_world* world = f.world.world;
    const wisp_entity guides = f.world.entities[0], hair = f.world.entities[1], sheet = f.world.surfaces[0].entity;
    assert_int_equal( wisp_detail_of( world, guides ), WISP_DETAIL_FEWER_SUBSTEPS );
    assert_int_equal( wisp_detail_of( world, hair ), WISP_DETAIL_COARSE );
    assert_int_equal( wisp_detail_of( world, sheet ), WISP_DETAIL_FULL );
    step( &f, 3 );
    assert_int_equal( scene_world_substeps( &f.world, 0 ), 2 );
    assert_int_equal( scene_world_substeps( &f.world, 2 ), 8 );
    step( &f, 4 );
    assert_int_equal( wisp_detail_of( world, sheet ), WISP_DETAIL_COARSE );
    assert_int_equal( scene_world_substeps( &f.world, 2 ), 4 );
    assert_int_equal( wisp_detail_of( world, guides ), WISP_DETAIL_NOTHING );
}

// ---- input of a user ----

static const char hanging[] = "wisp: 1\n"
                              "steps: 60\n"
                              "substeps: 4\n"
                              "surfaces:\n"
                              "  - name: cloth\n"
                              "    generate: { shape: plane, columns: 6, rows: 6, spacing: 0.1 }\n"
                              "    pins: [0, 5]\n"
                              "    cloth: {}\n"
                              "  - name: waved\n"
                              "    generate: { shape: plane, columns: 3, rows: 3, spacing: 0.1 }\n"
                              "    transform: { translate: [2, 0, 0] }\n"
                              "    pins: [0]\n"
                              "    pin_keyframes: [{ time: 1, translate: [0, 1, 0] }]\n"
                              "    cloth: {}\n"
                              "strands:\n"
                              "  - name: hair\n"
                              "    generate: { shape: straight, strands: 3, vertices: 6, length: 0.2 }\n"
                              "    dynamics: { drag_coefficient: 1 }\n"
                              "  - name: still\n"
                              "    generate: { shape: straight, strands: 3, vertices: 6, length: 0.2 }\n"
                              "    frozen_hair: { freeze: {} }\n"
                              "colliders:\n"
                              "  - { name: ball, shape: sphere, radius: 0.1, position: [0, -2, 0] }\n"
                              "  - { name: led, shape: sphere, radius: 0.1, position: [0, -3, 0],\n"
                              "      keyframes: [{ time: 1, position: [0, -4, 0] }] }\n";

enum
{
    HAIR,
    STILL,
    CLOTH,
    WAVED,
    BALL,
    LED
};

static wisp_vec3 point( fixture* f, int body, int vertex )
{
    wisp_vec3 points[4096]; // a ball has the most
    assert_ok( scene_world_points( &f->world, body, points, &f->error ), f->error );
    return points[vertex];
}

static void assert_at( wisp_vec3 p, float x, float y, float z )
{
    assert_float_equal( p.x, x, 1e-5f );
    assert_float_equal( p.y, y, 1e-5f );
    assert_float_equal( p.z, z, 1e-5f );
}

TEST( a_held_vertex_goes_where_it_is_dragged_and_is_free_afterwards )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    scene_hold hold;
    assert_ok( scene_world_grab( &f.world, CLOTH, 35, &hold, &f.error ), f.error );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.4f, 0.1f, 0.5f }, &f.error ), f.error );
    step( &f, 1 );
    assert_at( point( &f, CLOTH, 35 ), 0.4f, 0.1f, 0.5f );
    step( &f, 5 ); // without another call it stays
    assert_at( point( &f, CLOTH, 35 ), 0.4f, 0.1f, 0.5f );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 20 );
    assert_true( point( &f, CLOTH, 35 ).y < 0.0f );
}

TEST( a_vertex_that_the_scene_pins_stays_where_it_was_left )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    scene_hold hold;
    assert_ok( scene_world_grab( &f.world, CLOTH, 5, &hold, &f.error ), f.error );
    assert_true( hold.was_pinned );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.4f, 0.2f, 0.0f }, &f.error ), f.error );
    step( &f, 1 );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 20 );
    assert_at( point( &f, CLOTH, 5 ), 0.4f, 0.2f, 0.0f );
}

TEST( strands_come_along_with_their_head_and_a_second_drag_starts_from_there )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    const wisp_vec3 root = point( &f, HAIR, 0 );
    for ( int turn = 1; turn <= 2; ++turn )
    {
        scene_hold hold;
        assert_ok( scene_world_grab( &f.world, HAIR, 5, &hold, &f.error ), f.error );
        const wisp_vec3 tip = point( &f, HAIR, 5 );
        const wisp_vec3 target = { tip.x + 0.05f, tip.y, tip.z };
        assert_ok( scene_world_drag( &f.world, &hold, target, &f.error ), f.error );
        step( &f, 1 );
        assert_at( point( &f, HAIR, 0 ), root.x + 0.05f * (float)turn, root.y, root.z );
        assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
        step( &f, 3 );
    }
}

TEST( what_keyframes_move_or_what_stands_still_is_refused_with_its_name )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    scene_hold hold;
    const wisp_vec3 away = { 0.0f, 0.0f, 0.0f };
    static const struct
    {
        int body, vertex;
        wisp_status status;
        const char* message;
    } cases[] = {
        { WAVED, 0, WISP_CONFLICT, "vertex 0 of 'waved' follows the keyframes of its pins" },
        { STILL, 0, WISP_CONFLICT, "strands 'still' do not move by themselves" },
        { CLOTH, 36, WISP_BAD_INPUT, "got vertex 36, but 'cloth' has 36 vertices, counted from 0" },
        { CLOTH, -1, WISP_BAD_INPUT, "got vertex -1, but 'cloth' has 36 vertices, counted from 0" },
        { BALL, 0, WISP_BAD_INPUT, "got body 4, expected one of the 4 that move" },
    };
    for ( int i = 0; i < WISP_COUNT( cases ); ++i )
    {
        assert_int_equal( scene_world_grab( &f.world, cases[i].body, cases[i].vertex, &hold, &f.error ),
                          cases[i].status );
        assert_string_equal( f.error.message, cases[i].message );
    }
    assert_int_equal( scene_world_move_collider( &f.world, LED, away, &f.error ), WISP_CONFLICT );
    assert_string_equal( f.error.message, "collider 'led' follows its keyframes" );
    assert_int_equal( scene_world_move_collider( &f.world, CLOTH, away, &f.error ), WISP_CONFLICT );
    assert_int_equal( scene_world_move_collider( &f.world, 6, away, &f.error ), WISP_BAD_INPUT );
}

TEST( a_collider_is_where_it_was_moved )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    const wisp_vec3 before = point( &f, BALL, 0 );
    wisp_vec3 place = { 0.0f, 0.0f, -0.05f };
    for ( int i = 0; i <= 15; ++i )
    {
        place.y = -0.15f + 0.01f * (float)i;
        assert_ok( scene_world_move_collider( &f.world, BALL, place, &f.error ), f.error );
        step( &f, 1 );
    }
    assert_at( point( &f, BALL, 0 ), before.x, before.y + 2.0f, before.z - 0.05f );
    const wisp_vec3 p = point( &f, CLOTH, 14 ); // carried by it, where it would have fallen by 20 cm
    assert_true( p.y > -0.05f );
    assert_true( hypotf( hypotf( p.x - place.x, p.y - place.y ), p.z - place.z ) > 0.099f );
}

TEST( gravity_acts_on_cloth_and_strands )
{
    SCOPED( release ) fixture f;
    build( &f, hanging );
    const wisp_vec3 tip = point( &f, HAIR, 5 );
    assert_ok( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ 5.0f, 0.0f, 0.0f }, &f.error ), f.error );
    step( &f, 20 );
    assert_true( point( &f, HAIR, 5 ).x > tip.x + 0.02f );
    assert_true( point( &f, CLOTH, 35 ).x > 0.255f && fabsf( point( &f, CLOTH, 35 ).y ) < 1e-3f );
    assert_int_equal( scene_world_set_gravity( &f.world, ( wisp_vec3 ){ NAN, 0.0f, 0.0f }, &f.error ),
                      WISP_BAD_INPUT );
}

TEST( wind_gives_cloth_air_that_slows_it_in_a_calm )
{
    SCOPED( release ) fixture f;
    int felt = 0;
    build( &f, hanging );
    step( &f, 1 ); // which has passes of its own
    const int passes = wisp_world_plan_passes( f.world.world );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 0.0f, 5.0f, 0.0f }, &felt, &f.error ), f.error );
    assert_int_equal( felt, 3 ); // hair and both cloths
    assert_true( wisp_world_plan_passes( f.world.world ) > passes );
    step( &f, 20 );
    assert_true( point( &f, CLOTH, 35 ).y > -0.1f );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f }, &felt, &f.error ), f.error );
    assert_true( wisp_world_plan_passes( f.world.world ) > passes );
}

static uint64_t hash_of_a_drag( int workers )
{
    SCOPED( release ) fixture f = { .scene = parsed( hanging ) };
    create( &f, workers );
    scene_hold hold;
    int felt;
    step( &f, 5 );
    assert_ok( scene_world_grab( &f.world, CLOTH, 35, &hold, &f.error ), f.error );
    assert_ok( scene_world_drag( &f.world, &hold, ( wisp_vec3 ){ 0.3f, 0.3f, 0.3f }, &f.error ), f.error );
    assert_ok( scene_world_set_wind( &f.world, ( wisp_vec3 ){ 1.0f, 0.0f, 2.0f }, &felt, &f.error ), f.error );
    step( &f, 5 );
    assert_ok( scene_world_let_go( &f.world, &hold, &f.error ), f.error );
    step( &f, 5 );
    return wisp_world_hash( f.world.world );
}

TEST( equal_input_gives_equal_bits )
{
    const uint64_t one = hash_of_a_drag( 1 );
    assert_int_equal( hash_of_a_drag( 1 ), one );
    assert_int_equal( hash_of_a_drag( 3 ), one );
}
