// Sleep: the same bits for any number of workers and after snapshots, and what is refused.
#include "sleep_fixture.h"

#include "saved_world.h"

static uint64_t run_pile( int workers, bool sleeps, bool restores, bool* slept )
{
    hosted h;
    open_stage( &h, workers );
    wisp_world* world = h.world;
    const wisp_contact_def contact = contact_of( 0.01f );
    const wisp_entity ball = add_ball( world, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    wisp_entity sheets[2];
    for ( int i = 0; i < 2; ++i )
    {
        sheets[i] = add_sheet( world, ( wisp_vec3 ){ 0.05f * (float)i, 0.02f + 0.03f * (float)i, 0.0f }, sleeps );
        set_contact( world, sheets[i], &contact );
    }
    *slept = false;
    for ( int i = 0; i < 200; ++i )
    {
        if ( i == 160 )
        {
            move_ball( world, ball, ( wisp_vec3 ){ 0.0f, 0.05f, 0.0f } );
        }
        if ( restores && i % 40 == 39 )
        {
            saved_world saved = save_world( world );
            run_steps( world, 7, FRAME );
            assert_status( world, wisp_world_restore( world, saved.bytes, saved.size ), WISP_OK );
            free( saved.bytes );
        }
        run_steps( world, 1, FRAME );
        *slept = *slept || wisp_is_asleep( world, sheets[0] );
    }
    uint64_t hash = 0;
    for ( int i = 0; i < 2; ++i )
    {
        hash = 3 * hash + hash_of( world, sheets[i], WISP_SURFACE_POINTS );
    }
    close_world( &h );
    return hash;
}

TEST( bits_do_not_depend_on_workers_nor_on_snapshots )
{
    bool slept;
    const uint64_t expected = run_pile( 1, true, false, &slept );
    assert_true( slept );
    assert_true( run_pile( 3, true, false, &slept ) == expected );
    assert_true( slept );
    assert_true( run_pile( 1, true, true, &slept ) == expected );
    assert_true( run_pile( 1, false, false, &slept ) != expected ); // what slept has missed some trembling
}

TEST( a_snapshot_of_sleep_goes_on_in_another_world )
{
    bed a, b;
    open_bed( &a, 1 );
    set_gravity( &a ); // a change that waits for the next step
    saved_world saved = save_world( a.world );
    open_bed( &b, 2 );
    set_velocity( &b );
    run_steps( b.world, 3, FRAME );
    assert_status( b.world, wisp_world_restore( b.world, saved.bytes, saved.size ), WISP_OK );
    free( saved.bytes );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( wisp_world_hash( a.world ) == wisp_world_hash( b.world ) );
    run_steps( a.world, 5, FRAME );
    run_steps( b.world, 5, FRAME );
    assert_false( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( hash_of( a.world, a.sheet, WISP_SURFACE_POINTS ) ==
                 hash_of( b.world, b.sheet, WISP_SURFACE_POINTS ) );
    close_world( &a.h );
    close_world( &b.h );
}

enum
{
    CROWD = 9,
};

// Sheets that hang from a pin and come to rest one after another. Several have substep loops of their own.
static void run_crowd( int first, int count, int workers, uint64_t hashes[CROWD], int asleep[CROWD] )
{
    hosted h;
    open_stage( &h, workers );
    wisp_entity sheets[CROWD];
    for ( int i = first; i < first + count; ++i )
    {
        const int32_t pins[] = { 0, 5 };
        test_mesh mesh = hanging_mesh( 6, 6, 0.05f, 0.05f );
        for ( int v = 0; v < mesh.vertex_count; ++v )
        {
            mesh.points[v].z = 0.02f * (float)( v / 6 ) * (float)( i % 3 );
        }
        sheets[i] = add_draping( h.world, &mesh, pins, 2, EARTH );
        assert_status( h.world, wisp_set_damping( h.world, sheets[i], 2.0f + (float)i ), WISP_OK );
        let_sleep( h.world, sheets[i] );
    }
    run_steps( h.world, 130, FRAME );
    for ( int i = first; i < first + count; ++i )
    {
        hashes[i] = hash_of( h.world, sheets[i], WISP_SURFACE_POINTS );
        asleep[i] = wisp_is_asleep( h.world, sheets[i] ) ? 1 : 0;
    }
    close_world( &h );
}

TEST( a_crowd_of_which_some_sleep_has_the_bits_of_each_alone )
{
    uint64_t alone[CROWD], together[CROWD], with_workers[CROWD];
    int asleep[CROWD], asleep_together[CROWD], sum = 0;
    for ( int i = 0; i < CROWD; ++i )
    {
        run_crowd( i, 1, 1, alone, asleep );
        sum += asleep[i];
    }
    assert_true( sum > 0 && sum < CROWD );
    run_crowd( 0, CROWD, 1, together, asleep_together );
    run_crowd( 0, CROWD, 3, with_workers, asleep_together );
    for ( int i = 0; i < CROWD; ++i )
    {
        assert_int_equal( asleep[i], asleep_together[i] );
        assert_true( alone[i] == together[i] );
        assert_true( alone[i] == with_workers[i] );
    }
}

static uint64_t fall_for( int steps, bool sleeps, int* passes )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity e = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.3f, 0.0f }, sleeps );
    run_steps( h.world, steps, FRAME );
    assert_false( wisp_is_asleep( h.world, e ) );
    const uint64_t hash = hash_of( h.world, e, WISP_SURFACE_POINTS );
    *passes = wisp_world_plan_passes( h.world );
    close_world( &h );
    return hash;
}

TEST( what_never_sleeps_has_the_same_bits_and_one_pass_more )
{
    int with, without;
    assert_true( fall_for( 40, true, &with ) == fall_for( 40, false, &without ) );
    assert_int_equal( with, without + 1 );
}

TEST( sleep_without_memory_changes_nothing )
{
    hosted h;
    open_stage( &h, 1 );
    const wisp_entity e = add_sheet( h.world, ( wisp_vec3 ){ 0.0f, 0.3f, 0.0f }, false );
    run_steps( h.world, 1, FRAME );
    const uint64_t before = wisp_world_hash( h.world );
    const wisp_sleep_def def = wisp_default_sleep_def();
    int refused = 0;
    for ( int after = 0; after < 20; ++after )
    {
        h.host.refuse = h.host.queried + 1 + after;
        const wisp_status status = wisp_set_sleep( h.world, e, &def );
        h.host.refuse = 0;
        if ( status == WISP_OK )
        {
            break;
        }
        assert_int_equal( status, WISP_NO_MEMORY );
        assert_true( wisp_world_hash( h.world ) == before );
        refused += 1;
    }
    assert_true( refused > 0 );
    close_world( &h );
}

TEST( what_cannot_sleep_is_refused )
{
    bed b;
    open_bed( &b, 1 );
    const uint64_t before = wisp_world_hash( b.world );
    wisp_sleep_def def = wisp_default_sleep_def();
    def.max_speed = -1.0f;
    expect_refusal( b.world, wisp_set_sleep( b.world, b.sheet, &def ), WISP_BAD_INPUT, "max_speed: got -1" );
    def.max_speed = NAN;
    expect_refusal( b.world, wisp_set_sleep( b.world, b.sheet, &def ), WISP_BAD_INPUT, "max_speed: got nan" );
    def = wisp_default_sleep_def();
    def.seconds = INFINITY;
    expect_refusal( b.world, wisp_set_sleep( b.world, b.sheet, &def ), WISP_BAD_INPUT, "seconds: got inf" );
    def = wisp_default_sleep_def();
    expect_refusal( b.world, wisp_set_sleep( b.world, b.ball, &def ), WISP_CONFLICT, "is neither a surface nor" );
    assert_true( wisp_is_asleep( b.world, b.sheet ) );
    assert_true( wisp_world_hash( b.world ) == before );
    assert_false( wisp_is_asleep( b.world, ( wisp_entity ){ 99, 1 } ) );
    assert_false( wisp_is_asleep( NULL, b.sheet ) );
    close_world( &b.h );
}
