// Invalid frozen hair is rejected with one message that names the error, and the rejected call changes nothing.
#include "frozen_hair_engine_fixture.h"

// X( what the message must name, the statement that breaks a definition )
#define BROKEN_DEFS( X )                                                                                             \
    X( "stretch_stiffness: got 0,", d->stretch_stiffness = 0.0f )                                                    \
    X( "stretch_stiffness: got -7,", d->stretch_stiffness = -7.0f )                                                  \
    X( "stretch_stiffness: got 2e+12,", d->stretch_stiffness = 2e12f )                                               \
    X( "stretch_stiffness: got", d->stretch_stiffness = NAN )                                                        \
    X( "bend_stiffness: got 0.0009,", d->bend_stiffness = 9e-4f )                                                    \
    X( "bend_stiffness: got inf,", d->bend_stiffness = INFINITY )                                                    \
    X( "max_bend_angle: got 3.15,", d->max_bend_angle = 3.15f )                                                      \
    X( "max_bend_angle: got -0.1,", d->max_bend_angle = -0.1f )                                                      \
    X( "intensity: got 1.01,", d->intensity = 1.01f )                                                                \
    X( "intensity: got -0.01,", d->intensity = -0.01f )                                                              \
    X( "cursor.x: got 1.1e+06,", d->cursor.x = 1.1e6f )                                                              \
    X( "cursor.y: got", d->cursor.y = NAN )                                                                          \
    X( "cursor.z: got -inf,", d->cursor.z = -INFINITY )                                                              \
    X( "reach: got -1,", d->reach = -1.0f )                                                                          \
    X( "clump_radius: got 0,", d->clump_radius = 0.0f )                                                              \
    X( "clump_radius: got -0.01,", d->clump_radius = -0.01f )                                                        \
    X( "clump_radius: got", d->clump_radius = NAN )                                                                  \
    X( "clump_iterations: got -1,", d->clump_iterations = -1 )                                                       \
    X( "clump_iterations: got 1001,", d->clump_iterations = 1001 )                                                   \
    X( "clump_step_length: got -0.5,", d->clump_step_length = -0.5f )                                                \
    X( "clump_step_length: got inf,", d->clump_step_length = INFINITY )                                              \
    X( "min_distance: got -2,", d->min_distance = -2.0f )                                                            \
    X( "min_lambda: got 1.5,", d->min_lambda = 1.5f )                                                                \
    X( "max_neighbours: got 0,", d->max_neighbours = 0 )                                                             \
    X( "max_neighbours: got 4097,", d->max_neighbours = 4097 )                                                       \
    X( "max_depth_change: got -0.5,", d->max_depth_change = -0.5f )                                                  \
    X( "max_depth_change: got nan,", d->max_depth_change = NAN )                                                     \
    X( "max_depth_change: got 2e+06,", d->max_depth_change = 2e6f )                                                  \
    X( "gap: got 2,", d->gap = WISP_GAP_COUNT )                                                                      \
    X( "base: got 2,", d->base = WISP_FROZEN_BASE_COUNT )                                                            \
    X( "update_on: got 2,", d->update_on = WISP_FROZEN_UPDATE_COUNT )                                                \
    X( "stretch_stiffness of strand 3: got 0,", d->strand_stretch_stiffness = with_a_zero )                          \
    X( "bend_stiffness of strand 3: got 0,", d->strand_bend_stiffness = with_a_zero )                                \
    X( "intensity of strand 0: got 5,", d->strand_intensity = with_a_zero )

static const float with_a_zero[] = { 5.0f, 5.0f, 5.0f, 0.0f, 5.0f };

#define BROKEN_TYPE wisp_frozen_hair_def
#include "broken_defs.h"

TEST( a_parameter_out_of_range_is_named_and_changes_nothing )
{
    SCOPED( hair_groom_destroy ) hair_groom groom = hair_groom_create( HAIR_WAVY, 3, 5, 10, 0.004f );
    wisp_frozen_hair_def good = wisp_default_frozen_hair_def();
    SCOPED( destroy_local ) wisp_world* world = hair_world_create( NULL );
    wisp_entity entity = hair_add_frozen( world, &groom, &good );
    hair_step( world );
    uint64_t hash = wisp_world_hash( world );
    for ( int n = 0; n < BROKEN_COUNT; ++n )
    {
        wisp_frozen_hair_def bad = good;
        const char* expected = break_def( n, &bad );
        assert_int_equal( wisp_set_frozen_hair( world, entity, &bad ), WISP_BAD_INPUT );
        assert_contains( wisp_world_message( world ), expected );
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
