// Entities that are not solved: rigid motions of their pins, frame or head in closed form, and what they do when they are solved again.
#include "detail_fixture.h"

// Two pins leave the rotation about their line open, and none is added to it.
static void a_surface_that_is_not_solved_goes_along_with_its_pins( void** state )
{
    (void)state;
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
static void what_is_solved_again_goes_on_with_the_velocity_that_it_was_carried_with( void** state )
{
    (void)state;
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

static void a_surface_without_pins_goes_along_with_its_frame( void** state )
{
    (void)state;
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

static void strands_that_are_not_solved_go_along_with_their_head( void** state )
{
    (void)state;
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

// What rests, and is solved again, goes on resting.
static void a_surface_at_rest_is_at_rest_after_a_pause( void** state )
{
    (void)state;
    hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_effect( h.world, cloth_of_links ), ball = add_effect( h.world, balloon );
    run_steps( h.world, 300, FRAME );
    set_level( h.world, e, WISP_DETAIL_NOTHING );
    set_level( h.world, ball, WISP_DETAIL_NOTHING );
    run_steps( h.world, 40, FRAME );
    set_level( h.world, e, WISP_DETAIL_FULL );
    set_level( h.world, ball, WISP_DETAIL_FULL );
    for ( int i = 0; i < 40; ++i )
    {
        int count;
        wisp_vec3 *a = copy_points( h.world, e, &count ), *b = copy_points( h.world, ball, &count );
        assert_true( step_and_measure( h.world, e ) < 2e-3f );
        assert_true( largest_distance_to_turned( h.world, ball, b, 0.0f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } ) <
                     1e-3f );
        free( a );
        free( b );
    }
    close_world( &h );
}

int main( void )
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test( a_surface_that_is_not_solved_goes_along_with_its_pins ),
        cmocka_unit_test( what_is_solved_again_goes_on_with_the_velocity_that_it_was_carried_with ),
        cmocka_unit_test( a_surface_without_pins_goes_along_with_its_frame ),
        cmocka_unit_test( strands_that_are_not_solved_go_along_with_their_head ),
        cmocka_unit_test( a_surface_at_rest_is_at_rest_after_a_pause ),
    };
    return cmocka_run_group_tests( tests, NULL, NULL );
}
