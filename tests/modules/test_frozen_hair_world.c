// Frozen hair in a world: several grooms next to each other, the plan, memory, rejected input.
#include "frozen_hair_engine_fixture.h"
#include "plan_says.h"

#include <stdatomic.h>

// ---- grooms next to each other ----

// Groom n of many, and its parameters: every shape, size and switch occurs.
static hair_groom groom_of( int n )
{
    return hair_groom_create( (hair_shape)( n % 3 ), 2 + n / 3 % 2, 3 + n * 7 % 40, 2 + n * 5 % 19, 0.004f );
}

static wisp_frozen_hair_def def_of( int n )
{
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    def.freeze = n % 5 != 1;
    def.align = n % 4 != 1;
    def.clump = n % 6 != 1;
    def.gap = (wisp_gap)( n / 2 % 2 );
    def.clump_radius = 0.006f + 0.0005f * (float)( n % 11 );
    def.clump_step_length = n % 8 == 0 ? 0.004f : -1.0f;
    def.seed = (uint64_t)n;
    def.cursor = ( wisp_vec3 ){ 0.05f, -0.05f, n / 3 % 2 == 0 ? 0.0f : 0.02f };
    return def;
}

static void assert_alike_in_company( int first, int count, const hair_host* host )
{
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( host );
    wisp_entity entities[64];
    for ( int n = 0; n < count; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = groom_of( first + n );
        wisp_frozen_hair_def def = def_of( first + n );
        entities[n] = hair_add_frozen( world, &groom, &def );
    }
    hair_step( world );
    for ( int n = 0; n < count; ++n )
    {
        SCOPED( hair_groom_destroy ) hair_groom groom = groom_of( first + n );
        wisp_frozen_hair_def def = def_of( first + n );
        SCOPED( free_local ) wisp_vec3* alone = hair_run( NULL, &groom, &def );
        if ( !hair_same_bits( alone, hair_view( world, entities[n], groom.vertex_count ), groom.vertex_count ) )
        {
            fail_msg( "groom %d of %d with %d workers is not what it is alone", n, count, host->workers );
        }
    }
}

TEST( fifty_small_grooms_are_what_each_is_alone_for_any_workers )
{
    const int workers[] = { 1, 2, 5 };
    for ( int n = 0; n < WISP_COUNT( workers ); ++n )
    {
        assert_alike_in_company( 0, 50, &( hair_host ){ .workers = workers[n] } );
    }
}

TEST( an_instance_shares_the_rest_shape_and_lives_its_own_life )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 40, 20, 0.005f );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def(), other = def;
    other.seed = 77;
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity source = hair_add_frozen( world, &groom, &def ), instance;
    hair_step( world );
    size_t before = wisp_world_memory( world );
    assert_int_equal( wisp_add_instance( world, source, NULL, &instance ), WISP_OK );
    assert_int_equal( wisp_request( world, instance, WISP_STRAND_POINTS ), WISP_OK );
    print_message( "           an instance of %d vertices takes %zu bytes\n", groom.vertex_count,
                   wisp_world_memory( world ) - before );
    SCOPED( free_local )
    wisp_vec3 *first = hair_run( NULL, &groom, &def ), *second = hair_run( NULL, &groom, &other );

    // it starts at rest, not at the shape of its source
    hair_step( world );
    assert_true( hair_same_bits( hair_view( world, instance, 800 ), groom.points, 800 ) );
    hair_set( world, instance, &other );
    hair_step( world );
    assert_true( hair_same_bits( hair_view( world, source, 800 ), first, 800 ) );
    assert_true( hair_same_bits( hair_view( world, instance, 800 ), second, 800 ) );

    // and outlives it
    assert_int_equal( wisp_remove( world, source ), WISP_OK );
    assert_int_equal( wisp_replay_frozen_hair( world, instance, other.cursor, 0 ), WISP_OK );
    hair_step( world );
    assert_true( hair_same_bits( hair_view( world, instance, 800 ), second, 800 ) );
    assert_int_equal( wisp_command_frozen_hair( world, source, def.cursor ), WISP_STALE_ID );
}

TEST( empty_hair_is_no_work_and_no_failure )
{
    const int none[] = { 0, 0, 0 };
    for ( int strands = 0; strands <= 3; strands += 3 )
    {
        SCOPED( hair_groom_destroy )
        hair_groom groom = hair_groom_from( 3, strands, none, &( wisp_vec3 ){ 0, 0, 0 } );
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        wisp_entity entity = hair_add_frozen( world, &groom, &def );
        for ( int n = 0; n < 3; ++n )
        {
            hair_command( world, entity, def.cursor );
            hair_step( world );
            hair_view( world, entity, 0 );
            assert_int_equal( hair_stats( world, entity ).neighbours, 0 );
            assert_int_equal( hair_stats( world, entity ).event, n );
        }
    }
}

// ---- the plan ----

TEST( a_stage_that_is_not_queried_for_does_not_exist )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 20, 10, 0.005f );
    for ( int n = 0; n < 16; ++n )
    {
        wisp_frozen_hair_def def = hair_no_stages();
        def.freeze = ( n & 1 ) != 0;
        def.align = ( n & 2 ) != 0;
        def.clump = ( n & 4 ) != 0;
        def.clump_iterations = ( n & 8 ) != 0 ? 0 : 4;
        const bool clumps = def.clump && def.clump_iterations > 0;
        SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
        wisp_entity entity = hair_add_frozen( world, &groom, &def );
        hair_step( world );

        // command, start and points are there for any stage
        assert_int_equal( wisp_world_plan_passes( world ), 3 + def.freeze + def.align + clumps );
        assert_int_equal( wisp_world_profile( world ).count, 3 + def.freeze + def.align + clumps );
        assert_true( plan_says( world, "frozen_hair.command", "wave" ) &&
                     plan_says( world, "frozen_hair.start", "wave" ) );
        assert_int_equal( plan_says( world, "frozen_hair.freeze", "wave" ), def.freeze );
        assert_int_equal( plan_says( world, "frozen_hair.align", "wave" ), def.align );
        assert_int_equal( plan_says( world, "frozen_hair.clump", "wave" ), clumps );
        assert_false( plan_says( world, "environment.stiffness", "wave" ) );
        assert_int_equal( wisp_world_counter( world, WISP_COUNT_SEARCHES ) > 0, clumps );

        // switched off later, a stage disappears; the plan is compiled once
        def = hair_freeze_only();
        uint64_t plans = wisp_world_counter( world, WISP_COUNT_PLANS );
        hair_set( world, entity, &def );
        hair_step( world );
        hair_step( world );
        assert_int_equal( wisp_world_plan_passes( world ), 4 );
        assert_true( wisp_world_counter( world, WISP_COUNT_PLANS ) <= plans + 1 );
        SCOPED( free_local ) wisp_vec3* fresh = hair_run( NULL, &groom, &def );
        assert_int_equal( wisp_replay_frozen_hair( world, entity, def.cursor, 0 ), WISP_OK );
        hair_step( world );
        assert_true( hair_same_bits( fresh, hair_view( world, entity, 200 ), 200 ) );
    }
}

TEST( a_scene_that_asks_for_nothing_has_no_passes )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 20, 10, 0.005f );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    assert_int_equal( wisp_world_plan_passes( world ), 6 );
    assert_int_equal( wisp_cancel_request( world, entity, WISP_STRAND_POINTS ), WISP_OK );
    assert_int_equal( wisp_world_plan_passes( world ), 0 );
    hair_step( world );
    assert_int_equal( wisp_world_profile( world ).count, 0 );
    assert_int_equal( wisp_world_counter( world, WISP_COUNT_SEARCHES ), 0 );

    // after the next request, the pending command runs
    assert_int_equal( wisp_request( world, entity, WISP_STRAND_POINTS ), WISP_OK );
    hair_step( world );
    SCOPED( free_local ) wisp_vec3* alone = hair_run( NULL, &groom, &def );
    assert_true( hair_same_bits( alone, hair_view( world, entity, 200 ), 200 ) );
}

// ---- values ----

// Those of all strands are in test_calls.c.
TEST( a_parameter_of_a_strand_out_of_range_is_named_and_changes_nothing )
{
    static const float with_a_zero[] = { 5.0f, 5.0f, 5.0f, 0.0f, 5.0f };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 5, 10, 0.004f );
    const wisp_frozen_hair_def good = wisp_default_frozen_hair_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &good );
    hair_step( world );
    uint64_t hash = wisp_world_hash( world );
    wisp_frozen_hair_def bad[] = { good, good, good };
    static const char* const messages[] = { "stretch_stiffness of strand 3: got 0,",
                                            "bend_stiffness of strand 3: got 0,", "intensity of strand 0: got 5," };
    bad[0].strand_stretch_stiffness = with_a_zero;
    bad[1].strand_bend_stiffness = with_a_zero;
    bad[2].strand_intensity = with_a_zero;
    for ( int n = 0; n < WISP_COUNT( bad ); ++n )
    {
        expect_refusal( world, wisp_set_frozen_hair( world, entity, bad + n ), WISP_BAD_INPUT, messages[n] );
        hair_step( world );
        assert_int_equal( wisp_world_hash( world ), hash );
    }
}

TEST( the_ends_of_every_range_are_accepted_and_give_numbers )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_CURLY, 3, 20, 10, 0.004f );
    for ( int upper = 0; upper <= 1; ++upper )
    {
        wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
        def.stretch_stiffness = def.bend_stiffness = upper ? 1e12f : 1e-3f;
        def.max_bend_angle = upper ? 3.14159274f : 0.0f;
        def.intensity = upper ? 1.0f : 0.0f;
        def.cursor = upper ? ( wisp_vec3 ){ 1e6f, -1e6f, 1e6f } : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
        def.reach = upper ? 1e7f : 0.0f;
        def.clump_radius = upper ? 1e6f : 1e-6f;
        def.clump_iterations = upper ? 1000 : 1;
        def.clump_step_length = upper ? 1e3f : 0.0f;
        def.min_lambda = upper ? 1.0f : 0.0f;
        def.max_neighbours = upper ? 4096 : 1;
        def.max_depth_change = upper ? 1e6f : 0.0f;
        SCOPED( free_local ) wisp_vec3* out = hair_run( NULL, &groom, &def );
        hair_assert_finite( out, groom.vertex_count );
    }
}

TEST( a_cursor_that_is_no_place_is_refused_and_no_command_waits )
{
    const wisp_vec3 nowhere[] = { { NAN, 0, 0 }, { 0, INFINITY, 0 }, { 0, 0, -1.5e6f } };
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 5, 10, 0.004f );
    wisp_frozen_hair_def def = wisp_default_frozen_hair_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &def );
    hair_step( world );
    uint64_t hash = wisp_world_hash( world );
    for ( int n = 0; n < WISP_COUNT( nowhere ); ++n )
    {
        assert_int_equal( wisp_command_frozen_hair( world, entity, nowhere[n] ), WISP_BAD_INPUT );
        assert_non_null( strstr( wisp_world_message( world ), "cursor" ) );
        assert_int_equal( wisp_replay_frozen_hair( world, entity, nowhere[n], 0 ), WISP_BAD_INPUT );
        hair_step( world );
        assert_int_equal( wisp_world_hash( world ), hash );
    }
}
