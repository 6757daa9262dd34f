// Invalid frozen hair is rejected with one message that names the error, and the rejected call changes nothing.
#include "frozen_hair_engine_fixture.h"

// Numbers of single parameters are in test_calls.c.
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
