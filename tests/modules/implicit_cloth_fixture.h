/// Worlds of implicit cloth on a host that counts its memory: hanging chains of vertices, sheets, chosen links.
#pragma once

#include "cloth_fixture.h"

#include "balloon.h"
#include "collision.h"
#include "implicit_linked.h"

static const float GRAVITY = 9.81f; // m/s^2

static inline wisp_world_def implicit_def( hosted* h )
{
    static const wisp_module* const MODULES[] = { &wisp_balloon_module, &wisp_cloth_module, &wisp_collision_module,
                                                  &wisp_implicit_cloth_module };
    wisp_world_def def = hosted_def( h );
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    return def;
}

/// Close with close_world().
static inline void open_implicit( hosted* h, int substeps )
{
    *h = ( hosted ){ 0 };
    h->def = implicit_def( h );
    h->def.substeps = substeps;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static inline int open_implicit_world( void** state )
{
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    open_implicit( h, 1 );
    *state = h;
    return 0;
}

#define IMPLICIT_TEST( test ) HOSTED_TEST( test, open_implicit_world )

/// Solved to the limit of single precision.
static inline wisp_implicit_cloth_def exact_def( void )
{
    wisp_implicit_cloth_def def = linked_def();
    def.tolerance = 1e-7f;
    def.max_iterations = 1000;
    return def;
}

/// Statistics and points are requested.
static inline void set_implicit( wisp_world* world, wisp_entity e, const wisp_implicit_cloth_def* def )
{
    assert_status( world, wisp_set_implicit_cloth( world, e, def ), WISP_OK );
    assert_status( world, wisp_request_implicit_cloth_stats( world, e, true ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
}

static inline wisp_implicit_cloth_stats stats_of( wisp_world* world, wisp_entity e )
{
    wisp_implicit_cloth_stats stats;
    assert_status( world, wisp_read_implicit_cloth_stats( world, e, &stats ), WISP_OK );
    return stats;
}

static inline uint64_t count_of( wisp_world* world, wisp_counter counter )
{
    return wisp_world_counter( world, counter );
}

// ---- chains ----

enum
{
    CHAIN_FREE = 3,
    CHAIN_VERTICES = CHAIN_FREE + 2,
};

static const float CHAIN_LINK = 0.125f; // m

/// Vertices 0 to 3 hang from 0, which is pinned. So is 4, a vertex that only completes the triangles.
static inline test_mesh chain_mesh( void )
{
    static const int32_t TRIANGLES[9] = { 0, 1, 4, 1, 2, 4, 2, 3, 4 };
    test_mesh m = { calloc( CHAIN_VERTICES, sizeof( wisp_vec3 ) ), calloc( 9, sizeof( int32_t ) ), CHAIN_VERTICES,
                    3 };
    assert_non_null( m.points );
    assert_non_null( m.triangles );
    for ( int i = 0; i <= CHAIN_FREE; ++i )
    {
        m.points[i] = ( wisp_vec3 ){ 0.0f, -CHAIN_LINK * (float)i, 0.0f };
    }
    m.points[4] = ( wisp_vec3 ){ 0.25f, -CHAIN_LINK, 0.0f };
    memcpy( m.triangles, TRIANGLES, sizeof( TRIANGLES ) );
    return m;
}

/// Links 0-1, 1-2, 2-3, of which the first `links` exist; each vertex has this `mass`. @param points null: at rest
static inline wisp_entity add_chain( wisp_world* world, wisp_implicit_cloth_def* def, int links, float mass,
                                     const wisp_vec3* points )
{
    static const int32_t PAIRS[6] = { 0, 1, 1, 2, 2, 3 }, PINS[2] = { 0, 4 };
    SCOPED( test_mesh_free ) test_mesh mesh = chain_mesh();
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.points = points;
    surface.vertex_mass = mass;
    surface.pins = PINS;
    surface.pin_count = WISP_COUNT( PINS );
    def->stretch_pairs = PAIRS;
    def->stretch_pair_count = links;
    wisp_entity e = test_surface_of( world, &fabric, surface );
    set_implicit( world, e, def );
    return e;
}

// ---- sheets ----

/// n x n vertices, a 32nd of a metre apart, that hang by two corners unless they are free. Points and statistics are
/// requested.
static inline wisp_entity add_sheet( wisp_world* world, const wisp_implicit_cloth_def* def, int n, bool pinned )
{
    SCOPED( test_mesh_free ) test_mesh mesh = test_plane( n, 0.03125f );
    const int32_t pins[2] = { 0, n - 1 };
    const wisp_fabric_def fabric = test_fabric_def( &mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = pinned ? 2 : 0;
    wisp_entity e = test_surface_of( world, &fabric, surface );
    set_implicit( world, e, def );
    assert_status( world, wisp_set_gravity( world, e, EARTH ), WISP_OK );
    return e;
}

/// Set points, in the user's order, with their velocities.
static inline void place_vertex( wisp_world* world, wisp_entity e, int vertex, wisp_vec3 at, wisp_vec3 velocity )
{
    const size_t quad = (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex] * 4;
    float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    float* moves = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    memcpy( position + quad, &at, sizeof( at ) );
    memcpy( moves + quad, &velocity, sizeof( velocity ) );
}

/// Displace every vertex by up to `by`, with a velocity of up to `speed`.
static inline void crumple_sheet( wisp_world* world, wisp_entity e, float by, float speed )
{
    const wisp_fabric* fabric = wisp_world_fabric( world, e );
    const float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    for ( int v = 0; v < fabric->vertex_count; ++v )
    {
        const float* x = position + (size_t)fabric->vertex_slot[v] * 4;
        wisp_vec3 off[2];
        for ( int k = 0; k < 2; ++k )
        {
            off[k] = ( wisp_vec3 ){ test_random_float( v, 80 + 3 * k, -1.0f, 1.0f ),
                                    test_random_float( v, 81 + 3 * k, -1.0f, 1.0f ),
                                    test_random_float( v, 82 + 3 * k, -1.0f, 1.0f ) };
        }
        if ( x[3] > 0.0f )
        {
            place_vertex( world, e, v,
                          ( wisp_vec3 ){ x[0] + by * off[0].x, x[1] + by * off[0].y, x[2] + by * off[0].z },
                          ( wisp_vec3 ){ speed * off[1].x, speed * off[1].y, speed * off[1].z } );
        }
    }
}
