// What is refused of maps of thickness and friction; what they do is in tests/claims/contact_maps.yaml.
#include "contact_fixture.h"

#include "wisp/maps.h"

enum
{
    N = 5,
    COUNT = N * N,
};

static const float H = 0.02f; // m, thickness

// Vertices that nothing joins.
static wisp_entity add_loose( wisp_world* world, float height )
{
    test_mesh mesh = level_sheet( N, 0.4f, ( wisp_vec3 ){ 0.0f, height, 0.0f } );
    const wisp_entity e = add_mesh( world, &mesh, NULL, 0, 0.15f );
    assert_status( world, wisp_set_gravity( world, e, EARTH ), WISP_OK );
    return e;
}

// ---- refusals ----

TEST( wrong_maps_are_refused )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 2, 1, 1 );
    const wisp_entity e = add_loose( h.world, 0.1f );
    float factors[COUNT];
    for ( int v = 0; v < COUNT; ++v )
    {
        factors[v] = 1.0f;
    }
    for ( wisp_component map = WISP_MAP_COLLISION_THICKNESS; map <= WISP_MAP_CONTACT_FRICTION; ++map )
    {
        expect_refusal( h.world, wisp_set_map( h.world, e, map, factors, COUNT ), WISP_CONFLICT,
                        "has no such constant" );
    }
    SET( h.world, e, collision, d.thickness = H );
    SET( h.world, e, contact, d.thickness = H );
    const uint64_t hash = wisp_world_hash( h.world );
    assert_null( wisp_world_column( h.world, e, WISP_MAP_COLLISION_THICKNESS, 0 ) );
    factors[7] = 1.5f;
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_COLLISION_THICKNESS, factors, COUNT ), WISP_BAD_INPUT,
                    "map.collision_thickness: vertex 7: got the factor 1.5, expected 0 to 1" );
    factors[7] = 0.001f;
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_CONTACT_THICKNESS, factors, COUNT ), WISP_BAD_INPUT,
                    "map.contact_thickness: vertex 7: got the factor 0.001, expected 0.01 to 1" );
    factors[7] = -1.0f;
    expect_refusal( h.world, wisp_set_map( h.world, e, WISP_MAP_CONTACT_FRICTION, factors, COUNT ), WISP_BAD_INPUT,
                    "vertex 7: got the factor -1, expected 0 to 1e+06" );
    assert_true( wisp_world_hash( h.world ) == hash );
}
