/// Worlds of cloth and bodies, on a host that counts its memory.
#pragma once

#include "surface_fixture.h"

#include "collision.h"

static inline void assert_near( double actual, double expected, double tolerance )
{
    if ( !( fabs( actual - expected ) <= tolerance ) )
    {
        fail_msg( "%.9g is not within %g of %.9g", actual, tolerance, expected );
    }
}

static inline wisp_world_def colliding_def( hosted* h )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_collision_module };
    wisp_world_def def = hosted_def( h );
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    return def;
}

static inline hosted* new_colliding( int substeps, int iterations, int workers )
{
    hosted* h = checked_calloc( 1, sizeof( hosted ) );
    h->def = colliding_def( h );
    h->def.substeps = substeps;
    h->def.iterations = iterations;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
    return h;
}

static inline int open_colliding( void** state )
{
    *state = new_colliding( 1, 1, 1 );
    return 0;
}

static inline void free_colliding( hosted* h )
{
    void* state = h;
    close_hosted( &state );
}

#define COLLISION_TEST( test ) cmocka_unit_test_setup_teardown( test, open_colliding, close_hosted )

static inline void run_for( wisp_world* world, float dt, int steps )
{
    for ( int i = 0; i < steps; ++i )
    {
        if ( wisp_world_step( world, dt ) != WISP_OK )
        {
            fail_msg( "no step: %s", wisp_world_message( world ) );
        }
    }
}

/// A surface of a mesh that collides as `def` says; its points and figures are wanted.
static inline wisp_entity add_colliding( wisp_world* world, const test_mesh* mesh, const wisp_collision_def* def )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = wisp_default_surface_def();
    wisp_entity e = test_surface_of( world, &fabric, surface );
    assert_int_equal( wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    assert_int_equal( wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    assert_int_equal( wisp_set_collision( world, e, def ), WISP_OK );
    assert_int_equal( wisp_request_collision_stats( world, e, true ), WISP_OK );
    return e;
}

static inline void give_gravity( wisp_world* world, wisp_entity e, float gravity )
{
    assert_int_equal( wisp_set_gravity( world, e, ( wisp_vec3 ){ 0.0f, -gravity, 0.0f } ), WISP_OK );
}

static inline wisp_entity add_collider( wisp_world* world, const wisp_collider_def* def )
{
    wisp_entity e;
    if ( wisp_add_collider( world, def, &e ) != WISP_OK )
    {
        fail_msg( "no collider: %s", wisp_world_message( world ) );
    }
    return e;
}

static inline wisp_collision_stats collision_of( wisp_world* world, wisp_entity e )
{
    wisp_collision_stats stats;
    assert_int_equal( wisp_read_collision_stats( world, e, &stats ), WISP_OK );
    return stats;
}

static inline wisp_vec3 point_of( wisp_world* world, wisp_entity e, int vertex )
{
    return ( (const wisp_vec3*)view_of( world, e, WISP_SURFACE_POINTS ).data )[vertex];
}

/// One triangle with a corner at `at`, edges of about `size`.
static inline test_mesh test_triangle( wisp_vec3 at, float size )
{
    test_mesh m = { calloc( 3, sizeof( wisp_vec3 ) ), calloc( 3, sizeof( int32_t ) ), 3, 1 };
    m.points[0] = at;
    m.points[1] = ( wisp_vec3 ){ at.x, at.y, at.z + size };
    m.points[2] = ( wisp_vec3 ){ at.x + size, at.y, at.z };
    for ( int i = 0; i < 3; ++i )
    {
        m.triangles[i] = i;
    }
    return m;
}

static inline void move_mesh( test_mesh* m, float scale, wisp_vec3 by )
{
    for ( int v = 0; v < m->vertex_count; ++v )
    {
        const wisp_vec3 p = m->points[v];
        m->points[v] = ( wisp_vec3 ){ scale * p.x + by.x, scale * p.y + by.y, scale * p.z + by.z };
    }
}

static inline wisp_quat about_z( double angle )
{
    return ( wisp_quat ){ 0.0f, 0.0f, (float)sin( 0.5 * angle ), (float)cos( 0.5 * angle ) };
}
