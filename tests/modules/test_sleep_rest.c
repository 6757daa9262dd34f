// Sleep: when entities fall asleep, what they forget of how they moved, and what snapshots of them hold.
#include "sleep_fixture.h"

#include "saved_world.h"

static const float TEN_FRAMES = 10.0f / 60.0f;

// ---- when ----

TEST( a_surface_at_rest_falls_asleep_in_the_step_in_which_its_seconds_have_passed )
{
    enum
    {
        SURFACES = 40,
    };
    hosted h;
    open_stage( &h, 1 );
    wisp_entity surfaces[SURFACES];
    for ( int i = 0; i < SURFACES; ++i )
    {
        // away from the origin: its first step is measured from where it is
        const wisp_vec3 a = { 2.0f, 1.0f, (float)i }, b = { 2.5f, 1.0f, (float)i }, c = { 2.0f, 1.5f, (float)i };
        test_mesh mesh = triangle_mesh( a, b, c );
        surfaces[i] = add_mesh( h.world, &mesh, NULL, 0, 0.15f );
        wisp_sleep_def sleep = wisp_default_sleep_def();
        sleep.seconds = (float)( i + 1 ) * FRAME;
        assert_status( h.world, wisp_set_sleep( h.world, surfaces[i], &sleep ), WISP_OK );
    }
    for ( int step = 1; step <= SURFACES; ++step )
    {
        run_steps( h.world, 1, FRAME );
        for ( int i = 0; i < SURFACES; ++i )
        {
            assert_int_equal( wisp_is_asleep( h.world, surfaces[i] ), i < step );
        }
    }
    close_world( &h );
}

TEST( what_falls_does_not_sleep_even_within_no_seconds )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity sheet = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 2.0f, 0.0f }, false );
    wisp_sleep_def sleep = wisp_default_sleep_def();
    sleep.seconds = 0.0f;
    assert_status( h.world, wisp_set_sleep( h.world, sheet, &sleep ), WISP_OK );
    for ( int i = 0; i < 10; ++i )
    {
        assert_wakes( h.world, sheet );
    }
    close_world( &h );
}

TEST( what_is_halted_does_not_fall_asleep )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity lower = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.02f, 0.0f }, true );
    const wisp_entity upper = add_sheet( h.world, ( wisp_vec3 ){ 0.05f, 0.04f, 0.02f }, false ); // keeps it awake
    const wisp_contact_def contact = contact_of( 0.01f );
    set_contact( h.world, lower, &contact );
    set_contact( h.world, upper, &contact );
    run_steps( h.world, 120, FRAME );
    assert_false( wisp_is_asleep( h.world, lower ) );
    float* velocity = wisp_world_column( h.world, lower, WISP_PARTICLE_VELOCITY, 0 );
    velocity[0] = NAN;
    assert_status( h.world, wisp_remove( h.world, upper ), WISP_OK );
    for ( int i = 0; i < 5; ++i )
    {
        run_steps( h.world, 1, FRAME );
        assert_true( wisp_is_halted( h.world, lower ) );
        assert_false( wisp_is_asleep( h.world, lower ) );
    }
    close_world( &h );
}

// ---- what they forget ----

// Any speed is slow enough: it falls asleep on its way, after ten steps.
static void sleep_on_the_way( wisp_world* world, wisp_entity e )
{
    wisp_sleep_def sleep = wisp_default_sleep_def();
    sleep.max_speed = 1e3f;
    sleep.seconds = TEN_FRAMES;
    assert_status( world, wisp_set_sleep( world, e, &sleep ), WISP_OK );
    run_steps( world, 9, FRAME );
    assert_false( wisp_is_asleep( world, e ) );
    run_steps( world, 4, FRAME );
    assert_true( wisp_is_asleep( world, e ) );
}

// What starts at rest falls by g dt^2 / 2 in a step, and by less than g dt^2 in the substeps of one. At 1.6 m/s it would go on by 27 mm.
static const double FROM_REST = 9.81 / 3600.0;

TEST( implicit_cloth_wakes_without_the_velocities_that_it_had )
{
    hosted h;
    open_stage( &h, 1 );
    test_mesh mesh = level_sheet( 6, 0.2f, ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f } );
    const wisp_entity sheet = add_mesh( h.world, &mesh, NULL, 0, 0.15f );
    wisp_implicit_cloth_def def = wisp_default_implicit_cloth_def();
    def.integrator = WISP_INTEGRATOR_BDF2;
    def.stretch_stiffness = 1.0f;  // soft enough for it
    def.max_newton_iterations = 1; // no second try of what gains energy
    assert_status( h.world, wisp_set_implicit_cloth( h.world, sheet, &def ), WISP_OK );
    assert_status( h.world, wisp_set_gravity( h.world, sheet, EARTH ), WISP_OK );
    sleep_on_the_way( h.world, sheet );
    const double before = (double)place_of( h.world, sheet, 0 )[1];
    assert_true( before < 2.9 ); // it was fast
    assert_status( h.world, wisp_set_gravity( h.world, sheet, ( wisp_vec3 ){ 0.0f, -9.8f, 0.0f } ), WISP_OK );
    assert_wakes( h.world, sheet );
    const double fallen = before - (double)place_of( h.world, sheet, 0 )[1];
    assert_true( fallen > 0.5 * FROM_REST && fallen < 0.7 * FROM_REST ); // 5 / 8 of it in four substeps of Euler
    close_world( &h );
}

// A strand that starts level and swings down.
static wisp_entity add_strand( wisp_world* world )
{
    const int32_t offsets[] = { 0, 6 };
    wisp_vec3 points[6];
    for ( int i = 0; i < 6; ++i )
    {
        points[i] = ( wisp_vec3 ){ 0.1f * (float)i, 3.0f, 0.0f };
    }
    wisp_strands_def def = wisp_default_strands_def();
    def.points = points;
    def.offsets = offsets;
    def.strand_count = 1;
    wisp_entity hair;
    assert_status( world, wisp_add_strands( world, &def, &hair ), WISP_OK );
    wisp_strand_dynamics_def dynamics = wisp_default_strand_dynamics_def();
    dynamics.integrator = WISP_INTEGRATOR_BDF2;
    dynamics.bending = WISP_STRAND_BEND_NONE;
    assert_status( world, wisp_set_strand_dynamics( world, hair, &dynamics ), WISP_OK );
    assert_status( world, wisp_request( world, hair, WISP_STRAND_POINTS ), WISP_OK );
    return hair;
}

TEST( hair_wakes_without_the_velocities_that_it_had )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity hair = add_strand( h.world );
    sleep_on_the_way( h.world, hair );
    const wisp_vec3 before = ( (const wisp_vec3*)view_of( h.world, hair, WISP_STRAND_POINTS ).data )[5];
    assert_true( before.y < 2.9f );
    assert_status( h.world, wisp_set_strand_gravity( h.world, hair, ( wisp_vec3 ){ 0.0f, -9.8f, 0.0f } ), WISP_OK );
    assert_wakes( h.world, hair );
    const wisp_vec3 after = ( (const wisp_vec3*)view_of( h.world, hair, WISP_STRAND_POINTS ).data )[5];
    assert_true( hypot( (double)( after.x - before.x ), (double)( after.y - before.y ) ) < FROM_REST );
    close_world( &h );
}

// What fails before the step that ends its fall asleep is restored to what the host saw last: without a velocity.
TEST( what_fails_as_it_wakes_is_restored_at_rest )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity sheet = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 3.0f, 0.0f }, false ),
                      hair = add_strand( h.world );
    wisp_sleep_def sleep = wisp_default_sleep_def();
    sleep.max_speed = 1e3f;
    sleep.seconds = TEN_FRAMES;
    assert_status( h.world, wisp_set_sleep( h.world, sheet, &sleep ), WISP_OK );
    assert_status( h.world, wisp_set_sleep( h.world, hair, &sleep ), WISP_OK );
    run_steps( h.world, 10, FRAME );
    assert_true( wisp_is_asleep( h.world, sheet ) && wisp_is_asleep( h.world, hair ) );
    const int rows = wisp_world_strands( h.world, hair )->row_count;
    const struct
    {
        wisp_entity entity;
        float* velocity;
        int count, damaged;
    } failing[] = { { sheet, wisp_world_column( h.world, sheet, WISP_PARTICLE_VELOCITY, 0 ), 4 * SIDE * SIDE, 0 },
                    { hair, wisp_world_column( h.world, hair, WISP_STRAND_VELOCITY, 0 ), rows * 3 * WISP_LANES,
                      3 * 3 * WISP_LANES } };
    for ( int i = 0; i < WISP_COUNT( failing ); ++i )
    {
        failing[i].velocity[failing[i].damaged] = NAN;
    }
    run_steps( h.world, 1, FRAME );
    for ( int i = 0; i < WISP_COUNT( failing ); ++i )
    {
        assert_true( wisp_is_halted( h.world, failing[i].entity ) );
        for ( int k = 0; k < failing[i].count; ++k )
        {
            assert_true( failing[i].velocity[k] == 0.0f );
        }
    }
    close_world( &h );
}

// ---- snapshots ----

TEST( a_snapshot_leaves_the_hash_of_what_sleeps )
{
    bed b;
    open_bed( &b, 1 );
    assert_status( b.world, wisp_set_gravity( b.world, b.sheet, EARTH ), WISP_OK ); // changes nothing
    const uint64_t before = wisp_world_hash( b.world );
    free( save_world( b.world ).bytes );
    assert_true( wisp_world_hash( b.world ) == before );
    close_world( &b.h );
}
