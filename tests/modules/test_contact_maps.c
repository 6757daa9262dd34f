// Maps of thickness and friction between surfaces, and what is refused. Against bodies they are in tests/claims/contact_maps.yaml.
#include "contact_fixture.h"

#include "wisp/maps.h"

enum
{
    N = 5,
    COUNT = N * N,
};

enum
{
    CONSTANT,
    MAPPED,
    WAYS
};

static const float H = 0.02f; // m, thickness

static void set_map( wisp_world* world, wisp_entity e, wisp_component map, float factor )
{
    float factors[COUNT];
    for ( int v = 0; v < COUNT; ++v )
    {
        factors[v] = factor;
    }
    assert_status( world, wisp_set_map( world, e, map, factors, COUNT ), WISP_OK );
}

// Vertices that nothing joins.
static wisp_entity add_loose( wisp_world* world, float height )
{
    test_mesh mesh = level_sheet( N, 0.4f, ( wisp_vec3 ){ 0.0f, height, 0.0f } );
    const wisp_entity e = add_mesh( world, &mesh, NULL, 0, 0.15f );
    assert_status( world, wisp_set_gravity( world, e, EARTH ), WISP_OK );
    return e;
}

// ---- between surfaces ----

static wisp_entity add_ground( wisp_world* world )
{
    test_mesh mesh = level_sheet( N, 0.8f, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    return add_pinned( world, &mesh );
}

static void give_contact( wisp_world* world, wisp_entity e, float thickness, float friction )
{
    wisp_contact_def def = contact_of( thickness );
    def.friction = friction;
    def.self = false;
    set_contact( world, e, &def );
}

TEST( each_point_keeps_half_the_sum_of_both_thicknesses )
{
    for ( int level = 0; level < WISP_CONTACT_LEVEL_COUNT; ++level )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 8, 2, 1 );
        wisp_contact_settings settings = wisp_default_contact_settings();
        settings.level = (wisp_contact_level)level;
        assert_status( h.world, wisp_set_contact_settings( h.world, &settings ), WISP_OK );
        const wisp_entity ground = add_ground( h.world ), e = add_loose( h.world, 0.03f );
        give_contact( h.world, ground, H, 0.0f );
        give_contact( h.world, e, H, 0.0f );
        set_map( h.world, ground, WISP_MAP_CONTACT_THICKNESS, 0.5f );
        float factors[COUNT]; // rows of vertices: thick and thin
        for ( int v = 0; v < COUNT; ++v )
        {
            factors[v] = v / N < 2 ? 1.0f : 0.1f;
        }
        assert_status( h.world, wisp_set_map( h.world, e, WISP_MAP_CONTACT_THICKNESS, factors, COUNT ), WISP_OK );
        request_stats( h.world );
        run_steps( h.world, level == WISP_CONTACT_SPHERES ? 20 : 60, FRAME );
        const double thick = 0.5 * ( 0.5 + 1.0 ) * (double)H, thin = 0.5 * ( 0.5 + 0.1 ) * (double)H;
        for ( int v = 0; v < COUNT && level != WISP_CONTACT_SPHERES; ++v )
        {
            // edges between the halves hold both of their ends at what they have where they cross an edge
            const bool is_between = v / N == 1 || v / N == 2;
            assert_within( (double)place_of( h.world, e, v )[1],
                           is_between ? 0.5 * ( thick + thin ) : ( v / N < 2 ? thick : thin ),
                           is_between ? 0.5 * ( thick - thin ) + 1e-4 : 1e-4 );
        }
        assert_true( contact_stats( h.world ).min_gap > 0.98f );
    }
}

// The friction of two surfaces is the geometric mean: with maps, of what both have where they touch.
TEST( a_map_of_friction_slows_as_the_constant_does )
{
    double velocity[WAYS + 1];
    for ( int w = 0; w <= WAYS; ++w )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 8, 2, 1 );
        const wisp_entity ground = add_ground( h.world ), e = add_loose( h.world, H );
        give_contact( h.world, ground, H, 0.3f );
        give_contact( h.world, e, H, w == CONSTANT ? 0.075f : 0.3f );
        if ( w == MAPPED )
        {
            set_map( h.world, e, WISP_MAP_CONTACT_FRICTION, 0.25f );
        }
        run_steps( h.world, 10, FRAME );
        assert_status( h.world,
                       wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 0.6f, 0.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                       WISP_OK );
        run_steps( h.world, 8, FRAME );
        velocity[w] = 0.0;
        for ( int v = 0; v < COUNT; ++v )
        {
            velocity[w] += (double)velocity_of( h.world, e, v )[0] / COUNT;
        }
    }
    assert_within( velocity[MAPPED], velocity[CONSTANT], 1e-4 );
    assert_within( velocity[CONSTANT], 0.6 - 0.15 * 9.81 * 8.0 / 60.0, 0.02 );
    assert_true( velocity[WAYS] < velocity[CONSTANT] - 0.1 );
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
    give_contact( h.world, e, H, 0.3f );
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
