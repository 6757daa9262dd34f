// Level of detail: what is not solved goes along with its pins, its frame or its head, as rigid motions in closed form do;
// ghosts with the roots of their targets, and the way back.
#include "detail_fixture.h"
#include "strands_fixture.h"

#include "guide_hair.h"

#include "wisp/detail.h"
#include "wisp/moving_frame.h"

// ---- rigid ----

// Two pins leave the rotation about their line open, and none is added to it.
TEST( a_surface_that_is_not_solved_goes_along_with_its_pins )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    run_steps( h.world, 20, FRAME );
    int count;
    set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
}

// A body that moves along when it is solved again: it has the velocity of the pins.
TEST( what_is_solved_again_goes_on_with_the_velocity_that_it_was_carried_with )
{
    SCOPED( close_world ) hosted h;
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
        SCOPED( free_local )
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
    }
}

TEST( a_surface_without_pins_goes_along_with_its_frame )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    assert_status( h.world, wisp_unpin( h.world, e, pins, 2 ), WISP_OK );
    SET( h.world, e, moving_frame, d.linear_inertia = 0.3f );
    run_steps( h.world, 10, FRAME );
    int count;
    set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
    for ( int i = 1; i <= 40; ++i )
    {
        const float angle = 0.04f * (float)i;
        const wisp_vec3 shift = { 0.0f, 0.02f * (float)i, 0.0f };
        const wisp_quat turn = { 0.0f, sinf( 0.5f * angle ), 0.0f, cosf( 0.5f * angle ) };
        assert_status( h.world, wisp_move_frame( h.world, e, wisp_transform_make( turn, shift ) ), WISP_OK );
        run_steps( h.world, 1, FRAME );
        assert_true( largest_distance_to_turned( h.world, e, from, angle, shift ) < 1e-5f );
    }
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
        SCOPED( close_world ) hosted h;
        const int pin_count = 2 + i % 2;
        const wisp_entity e = open_still( &h, pins, pin_count );
        int count;
        SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
        move_to_turned( h.world, e, pins, pin_count, from, angles[i / 2] );
        assert_true( largest_distance_to_turned( h.world, e, from, angles[i / 2], ( wisp_vec3 ){ 0 } ) < 2e-6f );
    }
}

// Not by a bit, and without a velocity, wherever they are.
TEST( pins_that_rest_move_nothing )
{
    const int32_t pins[3] = { 7, SIDE - 2, SIDE * SIDE - 5 };
    SCOPED( close_world ) hosted h;
    const wisp_entity e = open_still( &h, pins, 3 );
    int count;
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
}

TEST( pins_that_go_apart_are_at_their_targets )
{
    const int32_t pins[2] = { 0, SIDE - 1 };
    SCOPED( close_world ) hosted h;
    const wisp_entity e = open_still( &h, pins, 2 );
    int count;
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
}

// The pins tell where it is, the frame how it is turned where they leave that open.
TEST( a_frame_turns_what_hangs_on_a_pin )
{
    const int32_t pin[1] = { 0 };
    SCOPED( close_world ) hosted h;
    const wisp_entity e = open_still( &h, pin, 1 );
    wisp_moving_frame_def frame = wisp_default_moving_frame_def();
    frame.angular_inertia = 0.3f;
    assert_status( h.world, wisp_set_moving_frame( h.world, e, &frame ), WISP_OK );
    int count;
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
}

// On the way to a motion of 3 m/s, velocities come to that of the motion and not to none.
TEST( what_comes_to_rest_relative_to_pins_has_their_velocity )
{
    SCOPED( close_world ) hosted h;
    open_levels( &h, 10, 1 );
    const wisp_entity e = add_sheet( h.world, true );
    const int32_t pins[2] = { 0, SIDE - 1 };
    int count;
    run_steps( h.world, 1, FRAME );
    SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
}

TEST( strands_that_are_not_solved_go_along_with_their_head )
{
    effect_setup* const setups[] = { hair_of_links, hair_of_rods };
    for ( int k = 0; k < WISP_COUNT( setups ); ++k )
    {
        SCOPED( close_world ) hosted h;
        open_levels( &h, 10, 1 );
        const wisp_entity e = add_effect( h.world, setups[k] );
        run_steps( h.world, 20, FRAME );
        set_level_at_once( h.world, e, WISP_DETAIL_NOTHING );
        int count;
        SCOPED( free_local ) wisp_vec3* from = copy_points( h.world, e, &count );
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
    }
}

// ---- ghosts ----

typedef struct grown
{
    hosted h;
    wisp_entity guides, ghosts;
} grown;

static wisp_vec3 beside( int strand, int i, int count, float length )
{
    const wisp_vec3 p = straight_out( strand / 4, i, count, length );
    return ( wisp_vec3 ){ p.x, p.y + 0.002f * (float)( strand % 4 ), p.z + 0.001f * (float)( strand % 3 ) };
}

static void grow( grown* g, int workers, bool has_head )
{
    static const wisp_module* const MODULES[] = { &wisp_strands_module, &wisp_guide_hair_module };
    prepare_strands( &g->h, MODULES, WISP_COUNT( MODULES ) );
    g->h.def.workers = workers;
    g->h.def.substeps = 4;
    open_prepared( &g->h );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.damping = 2.0f;
    int counts[80];
    for ( int s = 0; s < WISP_COUNT( counts ); ++s )
    {
        counts[s] = 12;
    }
    g->guides = has_head ? add_moving( g->h.world, 20, 12, straight_out, 0.12f, &dynamics )
                         : add_strands( g->h.world, counts, 20, straight_out, 0.12f );
    g->ghosts = add_strands( g->h.world, counts, 80, beside, 0.12f );
    SET( g->h.world, g->ghosts, ghosts, d.targets = g->guides );
    assert_status( g->h.world, wisp_request( g->h.world, g->ghosts, WISP_STRAND_POINTS ), WISP_OK );
}

static wisp_transform pose_of_head( int step )
{
    const float angle = 0.04f * (float)step;
    return wisp_transform_make( ( wisp_quat ){ 0.0f, sinf( 0.5f * angle ), 0.0f, cosf( 0.5f * angle ) },
                                ( wisp_vec3 ){ 0.01f * (float)step, 0.0f, 0.0f } );
}

static void move_and_step( grown* g, int step )
{
    assert_status( g->h.world, wisp_move_strand_head( g->h.world, g->guides, pose_of_head( step ) ), WISP_OK );
    strand_steps( g->h.world, 1, FRAME );
}

static const wisp_vec3* ghosts_now( grown* g )
{
    return view_of( g->h.world, g->ghosts, WISP_STRAND_POINTS ).data;
}

enum
{
    POINTS = 80 * 12,
};

static float largest_distance( const wisp_vec3* a, const wisp_vec3* b )
{
    float most = 0.0f;
    for ( int v = 0; v < POINTS; ++v )
    {
        most = fmaxf( most, distance( a[v], b[v] ) );
    }
    return most;
}

static bool runs( grown* g, const char* pass )
{
    const wisp_profile profile = wisp_world_profile( g->h.world );
    bool found = false;
    for ( int i = 0; i < profile.count; ++i )
    {
        found = found || ( strcmp( profile.lines[i].pass, pass ) == 0 && profile.lines[i].items > 0 );
    }
    return found;
}

// The guides go on moving, and what ghosts would do is not computed.
TEST( coarse_ghosts_go_along_with_the_head )
{
    grown g;
    grow( &g, 1, true );
    int step = 0;
    set_level( g.h.world, g.ghosts, WISP_DETAIL_FULL ); // the shape that is kept is not that of the first call
    while ( step < 20 )
    {
        move_and_step( &g, ++step );
    }
    wisp_vec3 from[POINTS], expected[POINTS];
    memcpy( from, ghosts_now( &g ), sizeof( from ) );
    const wisp_transform before = pose_of_head( step );
    set_level( g.h.world, g.ghosts, WISP_DETAIL_COARSE );
    while ( step < 60 )
    {
        move_and_step( &g, ++step );
        for ( int v = 0; v < POINTS; ++v )
        {
            expected[v] = wisp_transform_to_world( pose_of_head( step ), wisp_transform_to_local( before, from[v] ) );
        }
        assert_true( largest_distance( ghosts_now( &g ), expected ) < 1e-6f );
        assert_false( runs( &g, "guide_hair.ghosts" ) );
        assert_true( runs( &g, "strands.predict" ) );
    }
    close_world( &g.h );
}

// A ghost has no state of its own, so after the blend it has the bits that it would have had.
TEST( ghosts_that_are_computed_again_come_back )
{
    grown a, b;
    grow( &a, 1, true );
    grow( &b, 1, true );
    float apart = 0.0f, closest = 0.0f;
    wisp_vec3 offset[POINTS] = { { 0.0f, 0.0f, 0.0f } }, before[POINTS];
    for ( int step = 1; step <= 60; ++step )
    {
        if ( step == 10 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_COARSE );
        }
        if ( step == 30 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_FULL );
        }
        if ( step == 37 )
        {
            set_level( a.h.world, a.ghosts, WISP_DETAIL_FEWER_SUBSTEPS ); // the same for ghosts
        }
        move_and_step( &a, step );
        move_and_step( &b, step );
        const wisp_vec3 *p = ghosts_now( &a ), *full = ghosts_now( &b );
        memcpy( before, offset, sizeof( before ) );
        for ( int v = 0; v < POINTS; ++v )
        {
            offset[v] = ( wisp_vec3 ){ p[v].x - full[v].x, p[v].y - full[v].y, p[v].z - full[v].z };
        }
        apart = step < 30 ? largest_distance( p, full ) : apart;
        closest = step >= 30 ? fmaxf( closest, largest_distance( offset, before ) ) : closest;
        if ( step >= 44 )
        {
            assert_memory_equal( p, full, sizeof( offset ) );
        }
    }
    assert_true( apart > 0.01f && closest < apart / 5.0f ); // it comes nearer in fifteen steps
    close_world( &a.h );
    close_world( &b.h );
}

TEST( hair_at_nothing_goes_along_with_the_head )
{
    grown g;
    grow( &g, 2, true );
    set_level( g.h.world, g.ghosts, WISP_DETAIL_NOTHING );
    set_level( g.h.world, g.guides, WISP_DETAIL_NOTHING );
    wisp_vec3 expected[POINTS];
    for ( int step = 1; step <= 30; ++step )
    {
        move_and_step( &g, step );
        for ( int v = 0; v < POINTS; ++v )
        {
            expected[v] = wisp_transform_to_world( pose_of_head( step ), beside( v / 12, v % 12, 12, 0.12f ) );
        }
        assert_true( largest_distance( ghosts_now( &g ), expected ) < 1e-6f );
        assert_false( runs( &g, "strands.predict" ) );
        assert_false( runs( &g, "guide_hair.ghosts" ) );
    }
    close_world( &g.h );
}

TEST( ghosts_of_strands_without_roots_stay )
{
    grown g;
    grow( &g, 1, false );
    strand_steps( g.h.world, 2, FRAME );
    wisp_vec3 from[POINTS];
    memcpy( from, ghosts_now( &g ), sizeof( from ) );
    set_level( g.h.world, g.ghosts, WISP_DETAIL_COARSE );
    strand_steps( g.h.world, 5, FRAME );
    assert_true( largest_distance( ghosts_now( &g ), from ) < 1e-7f );
    wisp_detail_def def = wisp_default_detail_def();
    def.level = WISP_DETAIL_COARSE;
    expect_refusal( g.h.world, wisp_set_detail( g.h.world, g.guides, &def ), WISP_CONFLICT,
                    "strands that follow others" );
    assert_status( g.h.world, wisp_remove( g.h.world, g.guides ), WISP_OK );
    strand_steps( g.h.world, 2, FRAME ); // nothing to follow
    close_world( &g.h );
}
