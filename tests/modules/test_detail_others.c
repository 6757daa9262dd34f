// Level of detail of what others hold, touch or sleep on.
#include "sleep_fixture.h"

#include "wisp/detail.h"

static void set_level( wisp_world* world, wisp_entity e, wisp_detail level )
{
    wisp_detail_def def = wisp_default_detail_def();
    def.level = level;
    def.blend_steps = 0;
    assert_status( world, wisp_set_detail( world, e, &def ), WISP_OK );
}

static const wisp_vec3* points_now( wisp_world* world, wisp_entity e )
{
    return view_of( world, e, WISP_SURFACE_POINTS ).data;
}

static wisp_vec3 lowest( wisp_world* world, wisp_entity e )
{
    const wisp_view view = view_of( world, e, WISP_SURFACE_POINTS );
    const wisp_vec3* p = view.data;
    wisp_vec3 least = p[0];
    for ( int v = 1; v < view.count; ++v )
    {
        least = p[v].y < least.y ? p[v] : least;
    }
    return least;
}

static float distance( wisp_vec3 a, wisp_vec3 b )
{
    const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf( x * x + y * y + z * z );
}

// A sheet of pinned vertices that is moved, and cloth that hangs on it. The base is solved, or it is not.
TEST( attached_cloth_that_is_not_solved_goes_along )
{
    for ( int k = 0; k < 2; ++k )
    {
        hosted h;
        open_stage( &h, 1 );
        wisp_world* world = h.world;
        test_mesh mesh = level_sheet( 4, 0.4f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const wisp_entity base = add_pinned( world, &mesh );
        const int32_t corners[] = { 0, SIDE - 1 };
        mesh = level_sheet( SIDE, 0.4f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const wisp_entity flag = add_draping( world, &mesh, corners, 2, EARTH );
        assert_status( world, wisp_attach_pins( world, flag, corners, 2, base ), WISP_OK );
        run_steps( world, 30, FRAME );
        set_level( world, flag, WISP_DETAIL_NOTHING );
        if ( k == 1 )
        {
            set_level( world, base, WISP_DETAIL_NOTHING );
        }
        wisp_vec3 from[SIDE * SIDE], start[16], targets[16];
        int32_t all[16];
        memcpy( from, points_now( world, flag ), sizeof( from ) );
        memcpy( start, points_now( world, base ), sizeof( start ) );
        for ( int step = 1; step <= 20; ++step )
        {
            const wisp_vec3 way = { 0.02f * (float)step, 0.01f * (float)step, 0.0f };
            for ( int v = 0; v < 16; ++v )
            {
                all[v] = v;
                targets[v] = ( wisp_vec3 ){ start[v].x + way.x, start[v].y + way.y, start[v].z };
            }
            assert_status( world, wisp_move_pins( world, base, all, targets, 16 ), WISP_OK );
            run_steps( world, 1, FRAME );
            for ( int v = 0; v < SIDE * SIDE; ++v )
            {
                const wisp_vec3 to = { from[v].x + way.x, from[v].y + way.y, from[v].z };
                assert_true( distance( points_now( world, flag )[v], to ) < 1e-5f );
            }
        }
        close_world( &h );
    }
}

// A sheet that falls on one that is not solved comes to lie on it, and does not move it.
TEST( a_sheet_that_is_not_solved_holds_what_falls_on_it )
{
    hosted h;
    open_stage( &h, 1 );
    wisp_world* world = h.world;
    const wisp_contact_def contact = contact_of( 0.01f );
    const wisp_entity lower = add_sheet( world, ( wisp_vec3 ){ 0.0f, 0.3f, 0.0f }, false );
    const wisp_entity upper = add_sheet( world, ( wisp_vec3 ){ 0.01f, 0.36f, 0.01f }, false );
    set_contact( world, lower, &contact );
    set_contact( world, upper, &contact );
    run_steps( world, 1, FRAME );
    set_level( world, lower, WISP_DETAIL_NOTHING );
    wisp_vec3 from[SIDE * SIDE];
    memcpy( from, points_now( world, lower ), sizeof( from ) );
    run_steps( world, 60, FRAME );
    assert_memory_equal( points_now( world, lower ), from, sizeof( from ) );
    // its border hangs over
    assert_in_range( (int)( 1000.0f * points_now( world, upper )[SIDE * SIDE / 2 + SIDE / 2].y ), 302, 312 );
    set_level( world, lower, WISP_DETAIL_FULL ); // both fall
    run_steps( world, 60, FRAME );
    assert_true( lowest( world, lower ).y < 0.05f );
    close_world( &h );
}

// A sheet that sleeps on the floor wakes when its level lets it go along with its pins, and one that is not solved can be woken.
TEST( sleep_and_detail_do_not_disturb_each_other )
{
    bed b;
    open_bed( &b, 1 );
    set_level( b.world, b.sheet, WISP_DETAIL_NOTHING );
    run_steps( b.world, 10, FRAME );
    wisp_vec3 from[SIDE * SIDE];
    memcpy( from, points_now( b.world, b.sheet ), sizeof( from ) );
    run_steps( b.world, 10, FRAME );
    assert_memory_equal( points_now( b.world, b.sheet ), from, sizeof( from ) );
    set_level( b.world, b.sheet, WISP_DETAIL_FULL );
    set_velocity( &b );
    run_steps( b.world, 5, FRAME );
    assert_true( points_now( b.world, b.sheet )[0].y > from[0].y + 0.02f );
    run_to_sleep( b.world, b.sheet );
    close_world( &b.h );
}
