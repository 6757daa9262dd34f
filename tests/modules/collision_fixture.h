/// Worlds of cloth and bodies, on a host that counts its memory.
#pragma once

#include "surface_fixture.h"

#include "collision.h"

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

#define COLLISION_TEST( test ) HOSTED_TEST( test, open_colliding )

static inline void run_for( wisp_world* world, float dt, int steps )
{
    run_steps( world, steps, dt );
}

/// Add a surface of a mesh that collides according to `def`; its points and statistics are requested.
static inline wisp_entity add_colliding( wisp_world* world, const test_mesh* mesh, const wisp_collision_def* def )
{
    wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
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

/// A square cloth centred at `middle`.
static inline wisp_entity add_cloth( wisp_world* world, int n, float side, wisp_vec3 middle, float gravity )
{
    test_mesh mesh = test_plane( n, side / (float)( n - 1 ) );
    move_mesh( &mesh, 1.0f, ( wisp_vec3 ){ middle.x - 0.5f * side, middle.y, middle.z - 0.5f * side } );
    wisp_collision_def collision = wisp_default_collision_def();
    wisp_entity e = add_colliding( world, &mesh, &collision );
    test_mesh_free( &mesh );
    SET( world, e, cloth, d.internal_damping = 0.0f );
    give_gravity( world, e, gravity );
    return e;
}

static inline wisp_collider_def body_of( wisp_collider_kind kind )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = kind;
    def.radius = 0.3f;
    def.half_length = 0.2f;
    def.half_extent = ( wisp_vec3 ){ 0.3f, 0.2f, 0.25f };
    return def;
}

static inline wisp_collider_def mesh_body( const test_mesh* mesh )
{
    wisp_collider_def def = wisp_default_collider_def();
    def.kind = WISP_COLLIDER_MESH;
    def.points = mesh->points;
    def.triangles = mesh->triangles;
    def.point_count = mesh->vertex_count;
    def.triangle_count = mesh->triangle_count;
    return def;
}

/// Steps of 1/60 s with a collider that turns and moves.
static inline void run_busy( wisp_world* world, wisp_entity ball, int from, int to )
{
    for ( int n = from; n < to; ++n )
    {
        const wisp_transform pose = { about_z( 0.1 * n ), { 0.01f * (float)n, 0.0f, 0.005f * (float)n } };
        assert_int_equal( wisp_move_collider( world, ball, pose ), WISP_OK );
        run_for( world, 1.0f / 60.0f, 1 );
    }
}
