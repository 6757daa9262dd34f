// Level of detail: what is not solved goes along with its pins, its frame or its head, as rigid motions in closed form do.
#include "detail_fixture.h"

#include "wisp/moving_frame.h"

// Two pins leave the rotation about their line open, and none is added to it.
TEST( a_surface_that_is_not_solved_goes_along_with_its_pins )
{
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    run_steps( h.world, 20, FRAME );
    int count;
    set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
    wisp_vec3* from = copy_points( h.world, e, &count );
    for ( int i = 1; i <= 60; ++i )
    {
        const float angle = 0.05f * (float)i;
        const wisp_vec3 shift = { 0.01f * (float)i, -0.02f * (float)i, 0.03f * (float)i };
        wisp_vec3 targets[2];
        for ( int k = 0; k < 2; ++k )
        {
            targets[k] = turned_about_y( from[pins[k]], angle, shift );
        }
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        run_steps( h.world, 1, FRAME );
        assert_true( largest_distance_to_turned( h.world, e, from, angle, shift ) < 2e-5f ); // 60 roundings of 3 m
    }
    const int solved[] = { items_of( h.world, "links.xpbd" ), items_of( h.world, "particles.predict" ),
                           items_of( h.world, "surface.levels" ) };
    for ( int k = 0; k < WISP_COUNT( solved ); ++k )
    {
        assert_int_equal( solved[k], 0 );
    }
    // pins that rest: not a bit moves, and there is no velocity left
    run_steps( h.world, 1, FRAME );
    const uint64_t hash = hash_of( h.world, e, WISP_SURFACE_POINTS );
    run_steps( h.world, 5, FRAME );
    assert_true( hash_of( h.world, e, WISP_SURFACE_POINTS ) == hash );
    assert_float_equal( velocity_of( h.world, e, 500 )[1], 0.0f, 0.0f );
    free( from );
    close_world( &h );
}

// A body that moves along when it is solved again: it has the velocity of the pins.
TEST( what_is_solved_again_goes_on_with_the_velocity_that_it_was_carried_with )
{
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true ), strands = add_effect( h.world, hair_of_rods );
    const int32_t pins[2] = { 0, SIDE - 1 };
    run_steps( h.world, 60, FRAME );
    int count, strand_count;
    const wisp_vec3* p = points_now( h.world, e, &count );
    const wisp_vec3 from[2] = { p[pins[0]], p[pins[1]] };
    set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
    set_level_at_once( h.world, strands, WISP_DETAIL_NOTHING );
    for ( int i = 1; i <= 20; ++i )
    {
        const float x = 0.05f * (float)i; // 3 m/s
        const wisp_vec3 targets[2] = { { from[0].x + x, from[0].y, from[0].z },
                                       { from[1].x + x, from[1].y, from[1].z } };
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        assert_status( h.world,
                       wisp_move_strand_head( h.world, strands,
                                              ( wisp_transform ){ { 0.0f, 0.0f, 0.0f, 1.0f }, { x, 0.0f, 0.0f } } ),
                       WISP_OK );
        if ( i == 20 )
        {
            set_level_at_once( h.world, e, WISP_DETAIL_FULL );
            set_level_at_once( h.world, strands, WISP_DETAIL_FULL );
        }
        wisp_vec3 *before = copy_points( h.world, e, &count ), *hair = copy_points( h.world, strands, &strand_count );
        run_steps( h.world, 1, FRAME );
        const wisp_vec3 *now = points_now( h.world, e, &count ), *hair_now = points_now( h.world, strands, &count );
        for ( int v = 0; v < SIDE * SIDE; v += 37 )
        {
            assert_float_equal( now[v].x - before[v].x, 0.05f, i == 20 ? 3e-3f : 1e-5f );
        }
        for ( int v = 0; v < strand_count; v += 5 )
        {
            assert_float_equal( hair_now[v].x - hair[v].x, 0.05f, i == 20 ? 5e-4f : 1e-5f );
        }
        free( before );
        free( hair );
    }
    close_world( &h );
}

TEST( a_surface_without_pins_goes_along_with_its_frame )
{
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    assert_status( h.world, wisp_unpin( h.world, e, pins, 2 ), WISP_OK );
    wisp_moving_frame_def frame = wisp_default_moving_frame_def();
    frame.linear_inertia = 0.3f;
    assert_status( h.world, wisp_set_moving_frame( h.world, e, &frame ), WISP_OK );
    run_steps( h.world, 10, FRAME );
    int count;
    set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
    wisp_vec3* from = copy_points( h.world, e, &count );
    for ( int i = 1; i <= 40; ++i )
    {
        const float angle = 0.04f * (float)i;
        const wisp_vec3 shift = { 0.0f, 0.02f * (float)i, 0.0f };
        const wisp_quat turn = { 0.0f, sinf( 0.5f * angle ), 0.0f, cosf( 0.5f * angle ) };
        assert_status( h.world, wisp_move_frame( h.world, e, wisp_transform_make( turn, shift ) ), WISP_OK );
        run_steps( h.world, 1, FRAME );
        assert_true( largest_distance_to_turned( h.world, e, from, angle, shift ) < 1e-5f );
    }
    free( from );
    close_world( &h );
}

// A sheet at rest, pinned at some vertices, of which nothing is solved from the first step on.
static wisp_entity open_still( hosted* h, const int32_t* pins, int count )
{
    open_levels( h, 1, 1 );
    const wisp_entity e = add_sheet( h->world, false );
    const int32_t corners[2] = { 0, SIDE - 1 };
    assert_status( h->world, wisp_unpin( h->world, e, corners, 2 ), WISP_OK );
    if ( count > 0 )
    {
        assert_status( h->world, wisp_pin( h->world, e, pins, count ), WISP_OK );
    }
    set_level( h->world, e, WISP_DETAIL_NOTHING );
    run_steps( h->world, 1, FRAME );
    return e;
}

static void move_to_turned( wisp_world* world, wisp_entity e, const int32_t* pins, int count, const wisp_vec3* from,
                            float angle )
{
    wisp_vec3 targets[3];
    for ( int k = 0; k < count; ++k )
    {
        targets[k] = turned_about_y( from[pins[k]], angle, ( wisp_vec3 ){ 0 } );
    }
    assert_status( world, wisp_move_pins( world, e, pins, targets, count ), WISP_OK );
    run_steps( world, 1, FRAME );
}

TEST( pins_may_turn_by_much_in_a_step )
{
    const float angles[] = { 1.0f, 1.57079633f, 2.5f, -1.57079633f };
    const int32_t pins[3] = { 0, SIDE - 1, SIDE * SIDE - 1 };
    for ( int i = 0; i < 2 * WISP_COUNT( angles ); ++i )
    {
        hosted h;
        const int pin_count = 2 + i % 2;
        const wisp_entity e = open_still( &h, pins, pin_count );
        int count;
        wisp_vec3* from = copy_points( h.world, e, &count );
        move_to_turned( h.world, e, pins, pin_count, from, angles[i / 2] );
        assert_true( largest_distance_to_turned( h.world, e, from, angles[i / 2], ( wisp_vec3 ){ 0 } ) < 2e-6f );
        free( from );
        close_world( &h );
    }
}

// Not by a bit, and without a velocity, wherever they are.
TEST( pins_that_rest_move_nothing )
{
    const int32_t pins[3] = { 7, SIDE - 2, SIDE * SIDE - 5 };
    hosted h;
    const wisp_entity e = open_still( &h, pins, 3 );
    int count;
    wisp_vec3* from = copy_points( h.world, e, &count );
    move_to_turned( h.world, e, pins, 3, from, 0.7f );
    run_steps( h.world, 1, FRAME );
    const uint64_t hash = hash_of( h.world, e, WISP_SURFACE_POINTS );
    move_to_turned( h.world, e, pins, 3, from, 0.7f );
    assert_true( hash_of( h.world, e, WISP_SURFACE_POINTS ) == hash );
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const float* velocity = velocity_of( h.world, e, v );
        assert_true( velocity[0] == 0.0f && velocity[1] == 0.0f && velocity[2] == 0.0f );
    }
    free( from );
    close_world( &h );
}

TEST( pins_that_go_apart_are_at_their_targets )
{
    const int32_t pins[2] = { 0, SIDE - 1 };
    hosted h;
    const wisp_entity e = open_still( &h, pins, 2 );
    int count;
    wisp_vec3* from = copy_points( h.world, e, &count );
    const wisp_vec3 targets[2] = { { from[0].x - 0.1f, from[0].y, from[0].z },
                                   { from[SIDE - 1].x + 0.1f, from[SIDE - 1].y + 0.2f, from[SIDE - 1].z } };
    assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
    run_steps( h.world, 1, FRAME );
    const wisp_vec3* now = points_now( h.world, e, &count );
    for ( int k = 0; k < 2; ++k )
    {
        assert_memory_equal( &now[pins[k]], &targets[k], sizeof( targets[k] ) );
        assert_float_equal( velocity_of( h.world, e, pins[k] )[1], 0.0f, 0.0f ); // as where it is solved
    }
    assert_true( velocity_of( h.world, e, SIDE * SIDE - 1 )[1] != 0.0f );
    free( from );
    close_world( &h );
}

// The pins tell where it is, the frame how it is turned where they leave that open.
TEST( a_frame_turns_what_hangs_on_a_pin )
{
    const int32_t pin[1] = { 0 };
    hosted h;
    const wisp_entity e = open_still( &h, pin, 1 );
    wisp_moving_frame_def frame = wisp_default_moving_frame_def();
    frame.angular_inertia = 0.3f;
    assert_status( h.world, wisp_set_moving_frame( h.world, e, &frame ), WISP_OK );
    int count;
    wisp_vec3* from = copy_points( h.world, e, &count );
    move_to_turned( h.world, e, pin, 1, from, 0.0f );
    const wisp_quat turn = { 0.0f, sinf( 0.2f ), 0.0f, cosf( 0.2f ) };
    assert_status( h.world,
                   wisp_move_frame( h.world, e, wisp_transform_make( turn, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } ) ),
                   WISP_OK );
    run_steps( h.world, 1, FRAME );
    // the pin is at the origin, and stays there
    assert_true( largest_distance_to_turned( h.world, e, from, 0.4f, ( wisp_vec3 ){ 0 } ) < 1e-6f );
    // a frame that has come to rest moves nothing, not by a bit
    const wisp_quat askew = { 0.31f, -0.22f, 0.57f, 0.7282f };
    assert_status( h.world,
                   wisp_move_frame( h.world, e, wisp_transform_make( askew, ( wisp_vec3 ){ 1.0f, 0.3f, 0.0f } ) ),
                   WISP_OK );
    run_steps( h.world, 2, FRAME );
    const uint64_t hash = hash_of( h.world, e, WISP_SURFACE_POINTS );
    run_steps( h.world, 20, FRAME );
    assert_true( hash_of( h.world, e, WISP_SURFACE_POINTS ) == hash );
    for ( int v = 0; v < SIDE * SIDE; ++v )
    {
        const float* velocity = velocity_of( h.world, e, v );
        assert_true( velocity[0] == 0.0f && velocity[1] == 0.0f && velocity[2] == 0.0f );
    }
    free( from );
    close_world( &h );
}

// On the way to a motion of 3 m/s, velocities come to that of the motion and not to none.
TEST( what_comes_to_rest_relative_to_pins_has_their_velocity )
{
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    int count;
    run_steps( h.world, 1, FRAME );
    wisp_vec3* from = copy_points( h.world, e, &count );
    for ( int i = 1; i <= 45; ++i )
    {
        const wisp_vec3 targets[2] = { { from[0].x + 0.05f * (float)i, from[0].y, from[0].z },
                                       { from[pins[1]].x + 0.05f * (float)i, from[pins[1]].y, from[pins[1]].z } };
        assert_status( h.world, wisp_move_pins( h.world, e, pins, targets, 2 ), WISP_OK );
        if ( i == 31 )
        {
            set_level( h.world, e, WISP_DETAIL_NOTHING );
        }
        run_steps( h.world, 1, FRAME );
    }
    assert_true( is_blending( h.world, e ) );
    for ( int v = 4 * SIDE; v < SIDE * SIDE; ++v )
    {
        assert_float_equal( velocity_of( h.world, e, v )[0], 3.0f, 0.5f );
    }
    free( from );
    close_world( &h );
}

TEST( strands_that_are_not_solved_go_along_with_their_head )
{
    effect_setup* const setups[] = { hair_of_links, hair_of_rods };
    for ( int k = 0; k < WISP_COUNT( setups ); ++k )
    {
        hosted h;
        open_levels( &h, 10, 1 );
        const wisp_entity e = add_effect( h.world, setups[k] );
        run_steps( h.world, 20, FRAME );
        set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
        int count;
        wisp_vec3* from = copy_points( h.world, e, &count );
        for ( int i = 1; i <= 40; ++i )
        {
            const float angle = 0.05f * (float)i;
            const wisp_vec3 shift = { 0.01f * (float)i, 0.0f, 0.02f * (float)i };
            const wisp_quat turn = { 0.0f, sinf( 0.5f * angle ), 0.0f, cosf( 0.5f * angle ) };
            assert_status( h.world, wisp_move_strand_head( h.world, e, wisp_transform_make( turn, shift ) ),
                           WISP_OK );
            run_steps( h.world, 1, FRAME );
            assert_true( largest_distance_to_turned( h.world, e, from, angle, shift ) < 1e-5f );
        }
        assert_int_equal( items_of( h.world, "strands.predict" ), 0 );
        free( from );
        close_world( &h );
    }
}
