// Pins in groups with a motion each: where they are after every step, how fast, and what events make of them.
#define _XOPEN_SOURCE 700

#include "scene_world_fixture.h"

#include "wisp/module/module.h"

enum
{
    COLUMNS = 9,
    STEPS = 60,
};

#define SHEET                                                                                                        \
    "wisp: 1\ndt: 0.02\nsteps: 60\nsurfaces:\n"                                                                      \
    "  - name: cloth\n    generate: { shape: plane, columns: 9, rows: 9, spacing: 0.05 }\n"                          \
    "    compute: [points, speed]\n"

// Two grippers on opposite edges, x = -0.2 and x = 0.2; one pulls, one pulls and turns about the vertical through its middle.
#define GRIPPERS                                                                                                     \
    SHEET "    cloth: { bending: bend_links }\n    collision: {}\n    pin_groups:\n"                                 \
          "      - name: left\n        pin_box: { min: [-0.21, -1, -1], max: [-0.19, 1, 1] }\n"                      \
          "        pin_keyframes: [ { time: 0.4, translate: [-0.08, 0.02, 0] } ]\n"                                  \
          "      - name: right\n        pin_box: { min: [0.19, -1, -1], max: [0.21, 1, 1] }\n"                       \
          "        pin_keyframes: [ { time: 0.2, translate: [0, 0, 0] },\n"                                          \
          "          { time: 1, translate: [0.06, 0, 0.04], rotate: { axis: [0, 1, 0], degrees: 40 } } ]\n"

typedef struct point
{
    double x, y, z;
} point;

static wisp_vec3 at( fixture* f, int body, int vertex )
{
    wisp_vec3* points = checked_calloc( (size_t)scene_world_body( &f->world, body ).vertex_count, sizeof *points );
    assert_ok( scene_world_points( &f->world, body, points, &f->error ), f->error );
    const wisp_vec3 out = points[vertex];
    free( points );
    return out;
}

static double speed_of( fixture* f, int vertex )
{
    wisp_view view;
    assert_ok( scene_world_view( &f->world, 0, SCENE_REQUEST_SPEED, &view, &f->error ), f->error );
    return (double)*(const float*)(const void*)( (const char*)view.data + (size_t)vertex * view.stride );
}

static void assert_at( wisp_vec3 p, point expected, double tolerance )
{
    const double x = (double)p.x - expected.x, y = (double)p.y - expected.y, z = (double)p.z - expected.z;
    if ( !( sqrt( x * x + y * y + z * z ) <= tolerance ) )
    {
        fail_msg( "(%.7g, %.7g, %.7g) is not (%.7g, %.7g, %.7g)", (double)p.x, (double)p.y, (double)p.z, expected.x,
                  expected.y, expected.z );
    }
}

static double clamped( double x )
{
    return fmin( 1.0, fmax( 0.0, x ) );
}

// Between keyframes quaternions are interpolated linearly, and normalised. @param degrees between them
static double turned_to( double fraction, double degrees )
{
    const double half = 0.5 * degrees * acos( -1.0 ) / 180.0;
    return 2.0 * atan2( fraction * sin( half ), 1.0 - fraction + fraction * cos( half ) );
}

static point left_at( double time, int row )
{
    const double s = clamped( time / 0.4 );
    return ( point ){ -0.2 - 0.08 * s, 0.02 * s, -0.2 + 0.05 * row };
}

static point right_at( double time, int row )
{
    const double s = clamped( ( time - 0.2 ) / 0.8 ), angle = turned_to( s, 40.0 ), z = -0.2 + 0.05 * row;
    return ( point ){ 0.2 + z * sin( angle ) + 0.06 * s, 0.0, z * cos( angle ) + 0.04 * s };
}

TEST( each_group_is_where_its_own_keyframes_take_it_after_every_step )
{
    fixture f;
    build( &f, GRIPPERS );
    for ( int k = 1; k <= STEPS; ++k )
    {
        step( &f, 1 );
        for ( int row = 0; row < COLUMNS; ++row )
        {
            assert_at( at( &f, 0, row * COLUMNS ), left_at( 0.02 * k, row ), 1e-6 );
            assert_at( at( &f, 0, row * COLUMNS + COLUMNS - 1 ), right_at( 0.02 * k, row ), 1e-6 );
        }
    }
    release( &f );
}

// Without cloth and gravity a vertex that is let go flies on in a straight line.
TEST( one_group_lets_go_with_its_velocity_and_the_other_holds_on )
{
    fixture f;
    build( &f, SHEET "    gravity: [0, 0, 0]\n    pin_groups:\n"
                     "      - { name: a, pins: [0, 1], pin_keyframes: [ { time: 1, translate: [0, 0.5, 0] } ] }\n"
                     "      - { name: b, pins: [2], pin_keyframes: [ { time: 1, translate: [1, 0, 0] } ] }\n"
                     "events:\n  - { step: 10, surface: cloth, pin_group: a, release: true }\n" );
    for ( int k = 1; k <= 30; ++k )
    {
        const double time = 0.02 * k;
        step( &f, 1 );
        assert_at( at( &f, 0, 0 ), ( point ){ -0.2, 0.5 * time, -0.2 }, 2e-6 );
        assert_at( at( &f, 0, 2 ), ( point ){ -0.1 + time, 0, -0.2 }, 1e-6 );
        assert_true( k <= 10 || fabs( speed_of( &f, 1 ) - 0.5 ) < 1e-4 ); // friction sees it
    }
    release( &f );
}

TEST( a_group_that_starts_free_falls_until_it_is_held_and_goes_on_from_there )
{
    fixture f;
    build( &f, SHEET "    pin_groups:\n"
                     "      - name: grip\n        starts_free: true\n        pins: [0, 8]\n"
                     "        pin_pivot: [0, 0, -0.2]\n"
                     "        pin_keyframes: [ { time: 0.4, translate: [0, 0, 0] },\n"
                     "          { time: 0.8, translate: [0.4, 0.2, 0], rotate: { axis: [0, 0, 1], degrees: 90 } } ]\n"
                     "events:\n  - { step: 30, surface: cloth, pin_group: grip, hold: true }\n" );
    step( &f, 30 );
    const wisp_vec3 left = at( &f, 0, 0 ), right = at( &f, 0, 8 );
    assert_true( left.y < -1.0f ); // g t^2 / 2 = 1.8 m, and what the substeps add
    // Halfway the keyframes have turned it by 45 degrees; from there it turns by 45 more. Where it would have had to start:
    const double pi = acos( -1.0 ), c = cos( 0.25 * pi ), s = sin( 0.25 * pi );
    const point from = { (double)right.x - 0.2, (double)right.y - 0.1, 0.0 };
    const point start = { c * from.x + s * from.y, -s * from.x + c * from.y, 0.0 };
    step( &f, 1 ); // it moves at once
    const double first = turned_to( 0.55, 90.0 );
    assert_at( at( &f, 0, 8 ),
               ( point ){ cos( first ) * start.x - sin( first ) * start.y + 0.22,
                          sin( first ) * start.x + cos( first ) * start.y + 0.11, -0.2 },
               2e-6 );
    step( &f, 4 );
    const double angle = turned_to( 0.75, 90.0 );
    assert_at( at( &f, 0, 8 ),
               ( point ){ cos( angle ) * start.x - sin( angle ) * start.y + 0.3,
                          sin( angle ) * start.x + cos( angle ) * start.y + 0.15, -0.2 },
               2e-6 );
    step( &f, 25 );
    assert_at( at( &f, 0, 8 ), ( point ){ -start.y + 0.4, start.x + 0.2, -0.2 }, 2e-6 );
    release( &f );
}

TEST( an_event_attaches_a_group_to_a_surface_and_another_detaches_it )
{
    fixture f;
    build( &f, SHEET "    pins: [72]\n    pin_groups:\n      - { name: grip, pins: [0, 8] }\n"
                     "  - name: tray\n    generate: { shape: plane, columns: 2, rows: 2, spacing: 1 }\n"
                     "    pin_box: { min: [-2, -2, -2], max: [2, 2, 2] }\n"
                     "    pin_keyframes: [ { time: 1, translate: [0, 1, 0] } ]\n"
                     "events:\n  - { step: 10, surface: cloth, pin_group: grip, attach_pins: tray }\n"
                     "  - { step: 30, surface: cloth, pin_group: grip, detach_pins: true }\n"
                     "  - { step: 40, surface: cloth, pin_group: grip, release: true }\n" );
    for ( int k = 1; k <= 40; ++k )
    {
        const double way = 0.02 * ( k < 10 ? 0 : k > 30 ? 20 : k - 10 );
        step( &f, 1 );
        assert_at( at( &f, 0, 8 ), ( point ){ 0.2, way, -0.2 }, 2e-6 );
        assert_at( at( &f, 0, 72 ), ( point ){ -0.2, 0, 0.2 }, 1e-6 );
    }
    step( &f, 10 );
    assert_true( at( &f, 0, 8 ).y < 0.3f );
    assert_at( at( &f, 0, 72 ), ( point ){ -0.2, 0, 0.2 }, 1e-6 );
    release( &f );
}

TEST( an_event_without_a_group_is_for_all_pins )
{
    fixture f;
    build( &f, SHEET "    pins: [4]\n    pin_groups:\n      - { name: a, pins: [0] }\n"
                     "      - { name: b, pins: [8], starts_free: true }\n"
                     "events:\n  - { step: 5, surface: cloth, hold: true }\n"
                     "  - { step: 10, surface: cloth, release: true }\n" );
    step( &f, 5 );
    const float height = at( &f, 0, 8 ).y;
    assert_true( height < -0.01f );
    step( &f, 5 );
    assert_true( at( &f, 0, 8 ).y == height && at( &f, 0, 0 ).y == 0.0f && at( &f, 0, 4 ).y == 0.0f );
    step( &f, 5 );
    assert_true( at( &f, 0, 8 ).y < height && at( &f, 0, 0 ).y < -0.01f && at( &f, 0, 4 ).y < -0.01f );
    release( &f );
}

TEST( copies_have_groups_of_their_own )
{
    fixture f;
    build( &f, SHEET "    copies: { count: 2, spacing: [2, 0, 0] }\n    pin_groups:\n"
                     "      - { name: a, pin_nearest: [[0.2, 0, -0.2]],\n"
                     "          pin_keyframes: [ { time: 0.2, translate: [0, 0.1, 0] } ] }\n" );
    step( &f, 10 );
    assert_at( at( &f, 0, 8 ), ( point ){ 0.2, 0.1, -0.2 }, 1e-6 );
    assert_at( at( &f, 1, 8 ), ( point ){ 2.2, 0.1, -0.2 }, 1e-6 );
    release( &f );
}

// The surface jumps by a metre before step 10; what is let go then or in the step behind does not fly on at 50 m/s. A jump of pins that
// were let go before is none.
TEST( a_jump_gives_no_velocity_to_what_is_let_go )
{
    for ( int release_at = 9; release_at <= 12; ++release_at )
    {
        char text[900];
        snprintf( text, sizeof text,
                  SHEET "    gravity: [0, 0, 0]\n    pins: [0, 8]\n"
                        "    pin_keyframes: [ { time: 0.2, translate: [1, 0, 0], jump: true } ]\n"
                        "events:\n  - { step: %d, surface: cloth, release: true }\n",
                  release_at );
        fixture f;
        build( &f, text );
        step( &f, 30 );
        const double way = release_at < 10 ? 0.0 : 1.0;
        assert_at( at( &f, 0, 0 ), ( point ){ -0.2 + way, 0, -0.2 }, 1e-6 );
        assert_at( at( &f, 0, 80 ), ( point ){ 0.2 + way, 0, 0.2 }, 1e-6 );
        release( &f );
    }
}

TEST( what_nothing_holds_gets_no_velocity_when_it_is_let_go )
{
    fixture f;
    build( &f, SHEET "    gravity: [0, 0, 0]\n    pin_groups:\n"
                     "      - { name: a, pins: [0], pin_keyframes: [ { time: 1, translate: [0, 1, 0] } ] }\n"
                     "      - { name: b, pins: [8], starts_free: true,\n"
                     "          pin_keyframes: [ { time: 1, translate: [0, 1, 0] } ] }\n"
                     "events:\n  - { step: 0, surface: cloth, pin_group: a, release: true }\n"
                     "  - { step: 10, surface: cloth, release: true }\n" );
    step( &f, 20 );
    assert_at( at( &f, 0, 0 ), ( point ){ -0.2, 0, -0.2 }, 1e-7 ); // before the first step nothing moves
    assert_at( at( &f, 0, 8 ), ( point ){ 0.2, 0, -0.2 }, 1e-7 );
    release( &f );
}

// All vertices are pins that go at 0.5 m/s, so that nothing is strained when they are let go. It is soft enough for BDF2.
TEST( implicit_cloth_by_bdf2_goes_on_with_the_velocity_of_its_pins )
{
    fixture f;
    build( &f, SHEET "    gravity: [0, 0, 0]\n    implicit: { integrator: bdf2, stretch_stiffness: 1 }\n"
                     "    pin_box: { min: [-1, -1, -1], max: [1, 1, 1] }\n"
                     "    pin_keyframes: [ { time: 1, translate: [0, 0.5, 0] } ]\n"
                     "events:\n  - { step: 10, surface: cloth, release: true }\n"
                     "  - { step: 20, surface: cloth, velocity: [0, 0.3, 0] }\n" );
    for ( int k = 1; k <= 30; ++k )
    {
        step( &f, 1 );
        const double height = 0.5 * 0.02 * fmin( k, 20 ) + 0.3 * 0.02 * fmax( k - 20, 0 );
        assert_at( at( &f, 0, 40 ), ( point ){ 0, height, 0 }, 2e-6 );
    }
    release( &f );
}

TEST( a_pivot_is_what_the_pins_of_a_group_turn_about )
{
    fixture f;
    build( &f, SHEET "    pin_groups:\n      - { name: a, pins: [0, 8], pin_pivot: [0.2, 0, -0.2],\n"
                     "          pin_keyframes: [ { time: 0.2, translate: [0, 0, 0],\n"
                     "            rotate: { axis: [0, 0, 1], degrees: -90 } } ] }\n" );
    step( &f, 10 );
    assert_at( at( &f, 0, 0 ), ( point ){ 0.2, 0.4, -0.2 }, 1e-6 );
    assert_at( at( &f, 0, 8 ), ( point ){ 0.2, 0, -0.2 }, 1e-6 );
    release( &f );
}

// Of what is held already, and of what an event has attached.
TEST( holding_again_changes_no_bit )
{
    uint64_t hashes[2];
    for ( int k = 0; k < 2; ++k )
    {
        char text[2000];
        snprintf( text, sizeof text,
                  GRIPPERS "      - { name: third, pins: [40], starts_free: true }\n"
                           "events:\n  - { step: 20, surface: cloth, %s hold: true }\n",
                  k == 0 ? "pin_group: third," : "" );
        fixture f = { .scene = parsed( text ) };
        create( &f, 1 );
        step( &f, 40 );
        hashes[k] = wisp_world_hash( f.world.world );
        release( &f );
    }
    assert_true( hashes[0] == hashes[1] );
    fixture f;
    build( &f, SHEET "    pin_groups:\n      - { name: grip, pins: [0], starts_free: true }\n"
                     "  - name: tray\n    generate: { shape: plane, columns: 2, rows: 2, spacing: 1 }\n"
                     "    pin_box: { min: [-2, -2, -2], max: [2, 2, 2] }\n"
                     "events:\n  - { step: 2, surface: cloth, pin_group: grip, attach_pins: tray }\n" );
    assert_int_equal( scene_pins_holding( &f.world.surfaces[0], 0 ), -1 );
    step( &f, 3 );
    assert_int_equal( scene_pins_holding( &f.world.surfaces[0], 0 ), 1 );
    release( &f );
}

// @param restore_at step after which the world goes on in another one; 0: never
static uint64_t hash_after( int workers, int steps, int restore_at )
{
    fixture f = { .scene =
                      parsed( GRIPPERS "events:\n  - { step: 20, surface: cloth, pin_group: right, release: true }\n"
                                       "  - { step: 25, surface: cloth, pin_group: right, hold: true }\n" ) };
    create( &f, workers );
    step( &f, restore_at > 0 ? restore_at : steps );
    if ( restore_at > 0 ) // into a world that has made one step
    {
        fixture g = { .scene = f.scene };
        create( &g, workers );
        step( &g, 1 );
        const size_t size = wisp_world_snapshot_size( f.world.world ), front = scene_pins_state_size( &f.world );
        char* bytes = checked_calloc( size + front, 1 );
        scene_pins_save( &f.world, bytes );
        assert_int_equal( wisp_world_snapshot( f.world.world, bytes + front, size ), WISP_OK );
        assert_int_equal( scene_pins_state_size( &g.world ), front );
        scene_pins_load( &g.world, bytes );
        assert_int_equal( wisp_world_restore( g.world.world, bytes + front, size ), WISP_OK );
        g.world.next_step = f.world.next_step;
        g.world.next_event = f.world.next_event;
        free( bytes );
        g.world.scene = &f.scene; // that of g ends here
        scene_world_destroy( &f.world );
        f.world = g.world;
        step( &f, steps - restore_at );
    }
    const uint64_t hash = wisp_world_hash( f.world.world );
    release( &f );
    return hash;
}

TEST( workers_and_snapshots_change_no_bit )
{
    const uint64_t expected = hash_after( 1, 50, 0 );
    assert_true( hash_after( 3, 50, 0 ) == expected );
    assert_true( hash_after( 2, 50, 22 ) == expected ); // let go
    assert_true( hash_after( 2, 50, 30 ) == expected ); // held again
}

TEST( a_vertex_in_two_groups_and_an_empty_box_are_refused )
{
    demand_refusal(
        SHEET "    pins: [3]\n    pin_groups: [ { name: a, pins: [4, 3] } ]\n",
        "test.yaml:5:5: surface 'cloth': vertex 3 of the group 'a' is also pinned by the surface or by a group "
        "before it" );
    // the number in the file, of a vertex that a repair has moved up
    demand_refusal(
        SHEET
        "    repair: [weld]\n    weld_distance: 0.06\n    pins: [8]\n    pin_groups: [ { name: a, pins: [8] } ]\n",
        "test.yaml:5:5: surface 'cloth': vertex 8 of the group 'a' is also pinned by the surface or by a group "
        "before it" );
    demand_refusal( SHEET "    pin_groups: [ { name: a, pin_box: { min: [5, 5, 5], max: [6, 6, 6] } } ]\n",
                    "test.yaml:5:5: surface 'cloth': group 'a': no vertex starts in pin_box 0" );
}
