// Maps of thickness and friction, against bodies and between surfaces: where vertices come to rest, how they slow down, that a
// map of one value is that value, the same bits for any number of workers and kernels.
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

// From 0 to 1 over the vertices, or the same everywhere.
static void fill( float* factors, float from, float to )
{
    for ( int v = 0; v < COUNT; ++v )
    {
        factors[v] = from + ( to - from ) * (float)v / (float)( COUNT - 1 );
    }
}

static void set_map( wisp_world* world, wisp_entity e, wisp_component map, float from, float to )
{
    float factors[COUNT];
    fill( factors, from, to );
    assert_status( world, wisp_set_map( world, e, map, factors, COUNT ), WISP_OK );
}

// Vertices that nothing joins, on or above y = 0.
static wisp_entity add_loose( wisp_world* world, float height, wisp_vec3 gravity )
{
    test_mesh mesh = level_sheet( N, 0.4f, ( wisp_vec3 ){ 0.0f, height, 0.0f } );
    const wisp_entity e = add_mesh( world, &mesh, NULL, 0, 0.15f );
    assert_status( world, wisp_set_gravity( world, e, gravity ), WISP_OK );
    return e;
}

static void collide( wisp_world* world, wisp_entity e, float thickness, wisp_collision_features features )
{
    SET( world, e, collision, d.thickness = thickness, d.features = features );
    assert_status( world, wisp_request_collision_stats( world, e, true ), WISP_OK );
}

static wisp_entity add_body( wisp_world* world, wisp_collider_kind kind, float size )
{
    wisp_collider_def def = wisp_default_collider_def();
    wisp_entity e;
    def.kind = kind;
    def.radius = size;
    def.half_length = 1.0f;
    def.half_extent = ( wisp_vec3 ){ size, 0.1f, size };
    def.pose.translation.y = kind == WISP_COLLIDER_BOX ? -0.1f : kind == WISP_COLLIDER_CAPSULE ? -size : 0.0f;
    def.pose.rotation =
        kind == WISP_COLLIDER_CAPSULE ? ( wisp_quat ){ 0.0f, 0.0f, sqrtf( 0.5f ), sqrtf( 0.5f ) } : def.pose.rotation;
    def.thickness = 0.004f;
    assert_status( world, wisp_add_collider( world, &def, &e ), WISP_OK );
    return e;
}

// ---- against bodies ----

TEST( each_vertex_rests_at_its_own_thickness_and_that_of_the_body )
{
    static const wisp_collider_kind KINDS[] = { WISP_COLLIDER_PLANE, WISP_COLLIDER_BOX };
    for ( int i = 0; i < WISP_COUNT( KINDS ); ++i )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 4, 1, 1 );
        add_body( h.world, KINDS[i], 1.0f );
        const wisp_entity e = add_loose( h.world, 0.03f, EARTH );
        collide( h.world, e, H, WISP_COLLISION_VERTICES );
        set_map( h.world, e, WISP_MAP_COLLISION_THICKNESS, 0.0f, 1.0f );
        run_steps( h.world, 60, FRAME );
        for ( int v = 0; v < COUNT; ++v )
        {
            const double expected = (double)H * v / ( COUNT - 1 ) + 0.004;
            assert_within( (double)place_of( h.world, e, v )[1], expected, 1e-6 );
        }
        wisp_collision_stats stats;
        assert_status( h.world, wisp_read_collision_stats( h.world, e, &stats ), WISP_OK );
        assert_within( (double)stats.penetration, 0.0, 1e-6 );
        assert_int_equal( stats.contacts, COUNT );
    }
}

// What starts inside is moved out to its own thickness, at the push-out speed, and gets no velocity by that.
TEST( what_starts_inside_is_moved_out_to_its_own_thickness )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 2, 1, 1 );
    add_body( h.world, WISP_COLLIDER_PLANE, 1.0f );
    const wisp_entity e = add_loose( h.world, -0.01f, ( wisp_vec3 ){ 0 } );
    collide( h.world, e, H, WISP_COLLISION_VERTICES );
    set_map( h.world, e, WISP_MAP_COLLISION_THICKNESS, 0.0f, 1.0f );
    run_steps( h.world, 120, FRAME );
    for ( int v = 0; v < COUNT; ++v )
    {
        assert_within( (double)place_of( h.world, e, v )[1], (double)H * v / ( COUNT - 1 ) + 0.004, 1e-5 );
    }
}

// What leaves from inside gets its velocity only beyond a fraction of its thickness: mapped as if that were the constant.
TEST( what_leaves_from_inside_does_as_with_that_thickness )
{
    float height[WAYS], speed[WAYS];
    for ( int w = 0; w < WAYS; ++w )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 2, 1, 1 );
        add_body( h.world, WISP_COLLIDER_PLANE, 1.0f );
        const wisp_entity e = add_loose( h.world, -0.01f, ( wisp_vec3 ){ 0 } );
        collide( h.world, e, w == MAPPED ? H : 0.5f * H, WISP_COLLISION_VERTICES );
        if ( w == MAPPED )
        {
            set_map( h.world, e, WISP_MAP_COLLISION_THICKNESS, 0.5f, 0.5f );
        }
        assert_status( h.world, wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 0, 0.3f, 0 }, ( wisp_vec3 ){ 0 } ),
                       WISP_OK );
        run_steps( h.world, 1, FRAME );
        height[w] = place_of( h.world, e, 3 )[1];
        speed[w] = velocity_of( h.world, e, 3 )[1];
    }
    assert_within( (double)speed[MAPPED], (double)speed[CONSTANT], 0.03 ); // a tenth of the thickness is not the same
    assert_within( (double)height[MAPPED], (double)height[CONSTANT], 1e-3 );
    assert_true( speed[CONSTANT] < 0.2f );
}

// Coulomb: the velocity falls by mu g t.
TEST( each_vertex_slows_down_by_its_own_friction )
{
    SCOPED( close_world ) hosted h;
    open_contact( &h, 4, 1, 1 );
    add_body( h.world, WISP_COLLIDER_PLANE, 1.0f ); // of friction 0.5
    const wisp_entity e = add_loose( h.world, H + 0.004f, EARTH );
    collide( h.world, e, H, WISP_COLLISION_VERTICES );
    set_map( h.world, e, WISP_MAP_COLLISION_FRICTION, 0.0f, 2.0f );
    run_steps( h.world, 10, FRAME );
    assert_status( h.world, wisp_set_velocity( h.world, e, ( wisp_vec3 ){ 3.0f, 0.0f, 0.0f }, ( wisp_vec3 ){ 0 } ),
                   WISP_OK );
    const int steps = 12;
    run_steps( h.world, steps, FRAME );
    for ( int v = 0; v < COUNT; ++v )
    {
        const double mu = 0.5 * 2.0 * v / ( COUNT - 1 );
        assert_within( (double)velocity_of( h.world, e, v )[0], 3.0 - mu * 9.81 * steps / 60.0, 2e-4 );
    }
}

// A sheet over a rail: one map of a half everywhere is half of the constant.
static void assert_same_rest( bool is_implicit, wisp_collision_features features, wisp_collider_kind kind,
                              float size )
{
    float height[WAYS][COUNT];
    for ( int w = 0; w < WAYS; ++w )
    {
        SCOPED( close_world ) hosted h;
        open_contact( &h, 8, 2, 1 );
        add_body( h.world, kind, size );
        test_mesh mesh = level_sheet( N, 0.4f, ( wisp_vec3 ){ 0.0f, 0.02f, 0.03f } );
        const wisp_entity e = add_mesh( h.world, &mesh, NULL, 0, 0.15f );
        assert_status( h.world, wisp_set_gravity( h.world, e, EARTH ), WISP_OK );
        wisp_implicit_cloth_def implicit = wisp_default_implicit_cloth_def();
        wisp_cloth_def cloth = wisp_default_cloth_def();
        assert_status( h.world,
                       is_implicit ? wisp_set_implicit_cloth( h.world, e, &implicit )
                                   : wisp_set_cloth( h.world, e, &cloth ),
                       WISP_OK );
        collide( h.world, e, w == MAPPED ? H : 0.5f * H, features );
        if ( w == MAPPED )
        {
            set_map( h.world, e, WISP_MAP_COLLISION_THICKNESS, 0.5f, 0.5f );
        }
        run_steps( h.world, 20, FRAME );
        for ( int v = 0; v < COUNT; ++v )
        {
            height[w][v] = place_of( h.world, e, v )[1];
        }
    }
    for ( int v = 0; v < COUNT; ++v )
    {
        // not of the whole thickness, which would be higher by 0.01
        assert_within( (double)height[MAPPED][v], (double)height[CONSTANT][v], 2e-4 );
    }
}

TEST( a_map_of_one_value_is_that_thickness_for_each_kind_of_collision )
{
    assert_same_rest( false, WISP_COLLISION_VERTICES, WISP_COLLIDER_PLANE, 1.0f );
    assert_same_rest( false, WISP_COLLISION_VERTICES, WISP_COLLIDER_CAPSULE, 0.2f );
    assert_same_rest( false, WISP_COLLISION_ALL, WISP_COLLIDER_CAPSULE, 0.003f );
    assert_same_rest( true, WISP_COLLISION_VERTICES, WISP_COLLIDER_PLANE, 1.0f );
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
        const wisp_entity ground = add_ground( h.world ), e = add_loose( h.world, 0.03f, EARTH );
        give_contact( h.world, ground, H, 0.0f );
        give_contact( h.world, e, H, 0.0f );
        set_map( h.world, ground, WISP_MAP_CONTACT_THICKNESS, 0.5f, 0.5f );
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
        const wisp_entity ground = add_ground( h.world ), e = add_loose( h.world, H, EARTH );
        give_contact( h.world, ground, H, 0.3f );
        give_contact( h.world, e, H, w == CONSTANT ? 0.075f : 0.3f );
        if ( w == MAPPED )
        {
            set_map( h.world, e, WISP_MAP_CONTACT_FRICTION, 0.25f, 0.25f );
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
    const wisp_entity e = add_loose( h.world, 0.1f, EARTH );
    float factors[COUNT];
    fill( factors, 0.5f, 1.0f );
    for ( wisp_component map = WISP_MAP_COLLISION_THICKNESS; map <= WISP_MAP_CONTACT_FRICTION; ++map )
    {
        expect_refusal( h.world, wisp_set_map( h.world, e, map, factors, COUNT ), WISP_CONFLICT,
                        "has no such constant" );
    }
    collide( h.world, e, H, WISP_COLLISION_VERTICES );
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
