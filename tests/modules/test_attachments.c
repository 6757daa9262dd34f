// Pins that go along with another surface: which are attached, and refusals. Motions are in tests/claims/pins.yaml.
#include "collision_fixture.h"

#include "attachments_state.h"

static const float DT = 1.0f / 60.0f;
static const int32_t FIRST[] = { 0 };

static int open_attached( void** state )
{
    static const wisp_module* const MODULES[] = { &wisp_attachments_module, &wisp_cloth_module,
                                                  &wisp_collision_module };
    *state = new_hosted( MODULES, WISP_COUNT( MODULES ), 2, 1, 1 );
    return 0;
}

static int count_attached( wisp_world* world, wisp_entity surface )
{
    const attachments_state* state = wisp_world_module_state( world, "attachments" );
    const attachments_place* place = wisp_world_column( world, surface, state->place, 0 );
    int count = 0;
    for ( int slot = 0; place != NULL && slot < wisp_world_fabric( world, surface )->slot_count; ++slot )
    {
        count += place[slot].to.index != 0 ? 1 : 0;
    }
    return count;
}

static wisp_entity add_triangle( wisp_world* world, wisp_vec3 at )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_triangle( at, 0.1f );
    wisp_fabric_def fabric = test_fabric_def( &mesh );
    const wisp_entity e = test_surface_of( world, &fabric, support_weightless_surface_def() );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    return e;
}

HOSTED_TEST( pins_stay_when_they_are_detached_and_when_the_other_surface_is_removed, open_attached )
{
    wisp_world* world = h->world;
    const wisp_vec3 at = { 0.12f, 0.05f, 0.17f };
    const wisp_entity other = add_triangle( world, ( wisp_vec3 ){ 0.1f, 0.0f, 0.1f } ), e = add_triangle( world, at );
    const int32_t both[] = { 0, 1 };
    assert_int_equal( wisp_attach_pins( world, e, both, 2, other ), WISP_OK );
    assert_int_equal( count_attached( world, e ), 2 );
    assert_int_equal( wisp_detach_pins( world, e, FIRST, 1 ), WISP_OK );
    assert_int_equal( count_attached( world, e ), 1 );
    assert_int_equal( wisp_unpin( world, e, both + 1, 1 ), WISP_OK );
    run_for( world, DT, 1 );
    assert_int_equal( count_attached( world, e ), 0 );
    assert_int_equal( wisp_attach_pins( world, e, FIRST, 1, other ), WISP_OK );
    run_for( world, DT, 1 );
    assert_int_equal( wisp_remove( world, other ), WISP_OK );
    assert_int_equal( count_attached( world, e ), 0 );
    run_for( world, DT, 2 );
    const wisp_vec3 now = point_of( world, e, 0 );
    assert_memory_equal( &now, &at, sizeof at );
    assert_int_equal( wisp_remove( world, e ), WISP_OK );
    run_for( world, DT, 1 );
}

HOSTED_TEST( wrong_attachments_are_refused, open_attached )
{
    wisp_world* world = h->world;
    const wisp_vec3 at = { 0.0f, 0.0f, 0.0f };
    const wisp_entity b = add_triangle( world, at ), c = add_triangle( world, at ), e = add_triangle( world, at );
    const int32_t beyond[] = { 3 };
    assert_int_equal( wisp_attach_pins( world, e, beyond, 1, b ), WISP_BAD_INPUT );
    assert_non_null( strstr( wisp_world_message( world ), "vertex 3" ) );
    assert_int_equal( wisp_attach_pins( world, e, NULL, 1, b ), WISP_BAD_INPUT );
    assert_int_equal( wisp_attach_pins( world, e, FIRST, 1, e ), WISP_CONFLICT );
    assert_int_equal( wisp_attach_pins( world, e, FIRST, 1, ( wisp_entity ){ 0, 0 } ), WISP_STALE_ID );
    assert_int_equal( count_attached( world, e ), 0 );
    // chains
    assert_int_equal( wisp_attach_pins( world, e, FIRST, 1, b ), WISP_OK );
    assert_int_equal( wisp_attach_pins( world, c, FIRST, 1, e ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( world ), "attached pins itself" ) );
    assert_int_equal( wisp_attach_pins( world, b, FIRST, 1, c ), WISP_CONFLICT );
    assert_non_null( strstr( wisp_world_message( world ), "other pins are attached" ) );
    run_for( world, DT, 1 );
}
