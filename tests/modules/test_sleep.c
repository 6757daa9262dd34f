// Sleep: what lies still costs nothing, and wakes by the calls that change it; motion that wakes is in tests/claims/sleep.yaml. Level of
// detail of what others hold, touch or sleep on.
#include "sleep_fixture.h"

#include "wisp/detail.h"

TEST( a_sheet_on_the_ground_falls_asleep_and_no_pass_visits_it )
{
    bed b;
    open_bed( &b, 1 );
    const uint64_t points = hash_of( b.world, b.sheet, WISP_SURFACE_POINTS );
    const uint64_t all = wisp_world_hash( b.world );
    run_steps( b.world, 20, FRAME );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_int_equal( count_items( b.world ), 0 );
    assert_true( points == hash_of( b.world, b.sheet, WISP_SURFACE_POINTS ) );
    assert_true( all == wisp_world_hash( b.world ) );
    assert_true( motion_stats_of( b.world, b.sheet ).kinetic_energy == 0.0 );
    assert_true( motion_stats_of( b.world, b.sheet ).speed_max == 0.0 );
    close_world( &b.h );
}

TEST( a_body_that_appears_or_disappears_wakes_what_touches_it )
{
    bed b;
    open_bed( &b, 1 );
    const wisp_entity far = add_ball( b.world, ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f } );
    run_steps( b.world, 2, FRAME );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_status( b.world, wisp_remove( b.world, far ), WISP_OK );
    run_steps( b.world, 2, FRAME );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    const wisp_entity near = add_ball( b.world, ( wisp_vec3 ){ 0.0f, 0.04f, 0.0f } );
    assert_wakes( b.world, b.sheet );
    run_to_sleep( b.world, b.sheet );
    assert_status( b.world, wisp_remove( b.world, near ), WISP_OK );
    assert_wakes( b.world, b.sheet );
    close_world( &b.h );
}

typedef struct pile
{
    hosted h;
    wisp_entity lower, upper;
} pile;

// A sheet that sleeps on the ground, and one that never sleeps 0.3 m above, free or held. Both have contact.
static void open_pile( pile* p, bool is_held )
{
    open_stage( &p->h, 1 );
    const wisp_contact_def contact = contact_of( 0.01f );
    p->lower = add_sheet( p->h.world, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, true );
    set_contact( p->h.world, p->lower, &contact );
    run_to_sleep( p->h.world, p->lower );
    p->upper = add_sheet( p->h.world, ( wisp_vec3 ){ 0.05f, 0.3f, 0.02f }, false );
    set_contact( p->h.world, p->upper, &contact );
    for ( int32_t v = 0; is_held && v < SIDE * SIDE; ++v )
    {
        assert_status( p->h.world, wisp_pin( p->h.world, p->upper, &v, 1 ), WISP_OK );
    }
}

TEST( what_is_halted_keeps_nobody_awake )
{
    pile p;
    open_pile( &p, false );
    for ( int i = 0; wisp_is_asleep( p.h.world, p.lower ) && i < PATIENCE; ++i )
    {
        run_steps( p.h.world, 1, FRAME );
    }
    run_steps( p.h.world, 30, FRAME ); // it lies on the other by now
    assert_false( wisp_is_asleep( p.h.world, p.lower ) );
    float* velocity = wisp_world_column( p.h.world, p.upper, WISP_PARTICLE_VELOCITY, 0 );
    velocity[0] = NAN;
    run_steps( p.h.world, 1, FRAME );
    assert_true( wisp_is_halted( p.h.world, p.upper ) );
    run_to_sleep( p.h.world, p.lower );
    close_world( &p.h );
}

// ---- calls of the host ----

typedef void change_fn( bed* b );

static void set_wind( bed* b )
{
    SET( b->world, b->sheet, cloth, d.internal_damping = 1.0f, d.drag_coefficient = 1.0f, d.wind.y = 3.0f );
}

static void teleport( bed* b )
{
    const wisp_transform up = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.5f, 0.0f } };
    assert_status( b->world, wisp_teleport( b->world, b->sheet, up, true ), WISP_OK );
}

static void pin( bed* b )
{
    const int32_t corner[] = { 0 };
    assert_status( b->world, wisp_pin( b->world, b->sheet, corner, 1 ), WISP_OK );
}

static void throw_a_vertex( bed* b )
{
    const int32_t corner[] = { 0 };
    const wisp_vec3 up[] = { { 0.0f, 1.0f, 0.0f } };
    assert_status( b->world, wisp_set_vertex_velocities( b->world, b->sheet, corner, up, 1 ), WISP_OK );
}

static void request_normals( bed* b )
{
    assert_status( b->world, wisp_request( b->world, b->sheet, WISP_SURFACE_NORMALS ), WISP_OK );
}

static void no_longer_sleep( bed* b )
{
    SET( b->world, b->sheet, sleep, d.enabled = false );
}

TEST( every_call_that_changes_an_entity_wakes_it )
{
    static change_fn* const CHANGES[] = { set_wind, set_gravity,     set_velocity,    teleport,
                                          pin,      request_normals, no_longer_sleep, throw_a_vertex };
    for ( int i = 0; i < WISP_COUNT( CHANGES ); ++i )
    {
        bed b;
        open_bed( &b, 1 );
        CHANGES[i]( &b );
        assert_wakes( b.world, b.sheet );
        close_world( &b.h );
    }
}

TEST( a_call_that_changes_nothing_wakes_nobody )
{
    bed b;
    open_bed( &b, 1 );
    assert_status( b.world, wisp_set_gravity( b.world, b.sheet, EARTH ), WISP_OK );
    assert_status( b.world, wisp_set_damping( b.world, b.sheet, 2.0f ), WISP_OK );
    move_ball( b.world, b.ball, ( wisp_vec3 ){ 0.0f, 2.0f, 0.0f } );
    run_steps( b.world, 2, FRAME );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    close_world( &b.h );
}

// ---- what other entities hold ----

// A flag whose corners are on a pinned sheet.
static wisp_entity hang_on_sheet( wisp_world* world, wisp_entity* base )
{
    test_mesh mesh = level_sheet( 4, 0.4f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    *base = add_pinned( world, &mesh );
    const int32_t corners[] = { 0, SIDE - 1 };
    mesh = level_sheet( SIDE, 0.4f, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    const wisp_entity flag = add_draping( world, &mesh, corners, 2, EARTH );
    assert_status( world, wisp_attach_pins( world, flag, corners, 2, *base ), WISP_OK );
    return flag;
}

// ---- detail ----

static void set_level( wisp_world* world, wisp_entity e, wisp_detail level )
{
    SET( world, e, detail, d.level = level, d.blend_steps = 0 );
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

// A sheet of pinned vertices that is moved, and cloth that hangs on it. The base is solved, or it is not.
TEST( attached_cloth_that_is_not_solved_goes_along )
{
    for ( int k = 0; k < 2; ++k )
    {
        SCOPED( close_world ) hosted h;
        open_stage( &h, 1 );
        wisp_world* world = h.world;
        wisp_entity base;
        const wisp_entity flag = hang_on_sheet( world, &base );
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
    }
}

// A sheet that falls on one that is not solved comes to lie on it, and does not move it.
TEST( a_sheet_that_is_not_solved_holds_what_falls_on_it )
{
    SCOPED( close_world ) hosted h;
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
