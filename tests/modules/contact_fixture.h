/// Shared by the tests of contact: worlds of cloth, balloons, strands and bodies that meet, meshes at given
/// positions, and intersections counted by testing every edge against every triangle.
#pragma once

#include "cloth_fixture.h"

#include "balloon.h"
#include "collision.h"
#include "contact.h"
#include "implicit_cloth.h"
#include "strands.h"
#include "wisp/module/intersections.h"

static const float FRAME = 1.0f / 60.0f; // s

static inline wisp_world_def contact_world_def( hosted* h )
{
    static const wisp_module* const MODULES[] = { &wisp_balloon_module,        &wisp_cloth_module,
                                                  &wisp_implicit_cloth_module, &wisp_strands_module,
                                                  &wisp_collision_module,      &wisp_contact_module };
    wisp_world_def def = hosted_def( h );
    def.modules = MODULES;
    def.module_count = WISP_COUNT( MODULES );
    return def;
}

/// Close with close_world().
static inline void open_contact( hosted* h, int substeps, int iterations, int workers )
{
    *h = ( hosted ){ 0 };
    h->def = contact_world_def( h );
    h->def.substeps = substeps;
    h->def.iterations = iterations;
    h->def.workers = workers;
    assert_int_equal( wisp_world_create( &h->def, &h->world, NULL ), WISP_OK );
}

static inline void set_contact( wisp_world* world, wisp_entity e, const wisp_contact_def* def )
{
    assert_status( world, wisp_set_contact( world, e, def ), WISP_OK );
}

/// A definition with this thickness, without friction.
static inline wisp_contact_def contact_of( float thickness )
{
    wisp_contact_def def = wisp_default_contact_def();
    def.thickness = thickness;
    def.friction = 0.0f;
    return def;
}

static inline wisp_contact_stats contact_stats( wisp_world* world )
{
    wisp_contact_stats f;
    assert_status( world, wisp_read_contact_stats( world, &f ), WISP_OK );
    return f;
}

static inline void request_stats( wisp_world* world )
{
    assert_status( world, wisp_request_contact_stats( world, true, true ), WISP_OK );
}

// ---- meshes ----

/// n x n vertices about `centre`, level, `size` wide.
static inline test_mesh level_sheet( int n, float size, wisp_vec3 centre )
{
    test_mesh m = test_plane( n, size / (float)( n - 1 ) );
    for ( int v = 0; v < m.vertex_count; ++v )
    {
        const wisp_vec3 p = m.points[v];
        m.points[v] = ( wisp_vec3 ){ centre.x + p.x - 0.5f * size, centre.y, centre.z + p.z - 0.5f * size };
    }
    return m;
}

/// A ball of radius r.
static inline test_mesh ball_of( int level, float radius, wisp_vec3 centre )
{
    test_mesh m = test_ball( level );
    for ( int v = 0; v < m.vertex_count; ++v )
    {
        const wisp_vec3 p = m.points[v];
        m.points[v] = ( wisp_vec3 ){ centre.x + radius * p.x, centre.y + radius * p.y, centre.z + radius * p.z };
    }
    return m;
}

/// Add particles of a mesh, whose points and statistics are requested. Frees the mesh.
static inline wisp_entity add_mesh( wisp_world* world, test_mesh* mesh, const int32_t* pins, int pin_count,
                                    float area_density )
{
    const wisp_fabric_def fabric = test_fabric_def( mesh );
    wisp_surface_def surface = support_weightless_surface_def();
    surface.pins = pins;
    surface.pin_count = pin_count;
    surface.area_density = area_density;
    const wisp_entity e = test_surface_of( world, &fabric, surface );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    test_mesh_free( mesh );
    return e;
}

/// The same, every vertex pinned.
static inline wisp_entity add_pinned( wisp_world* world, test_mesh* mesh )
{
    SCOPED( free_local ) int32_t* all = checked_calloc( (uint32_t)mesh->vertex_count, sizeof( int32_t ) );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        all[v] = v;
    }
    return add_mesh( world, mesh, all, mesh->vertex_count, 0.15f );
}

/// Add cloth of a mesh. Frees the mesh.
static inline wisp_entity add_draping( wisp_world* world, test_mesh* mesh, const int32_t* pins, int pin_count,
                                       wisp_vec3 gravity )
{
    const wisp_entity e = add_mesh( world, mesh, pins, pin_count, 0.15f );
    SET( world, e, cloth, d.internal_damping = 1.0f );
    assert_status( world, wisp_set_gravity( world, e, gravity ), WISP_OK );
    return e;
}

/// Add a balloon of 0.1 kg/m^2, taut, with drag and without buoyancy. Frees the mesh.
static inline wisp_entity add_balloon( wisp_world* world, test_mesh* mesh, wisp_vec3 gravity )
{
    const wisp_entity e = add_mesh( world, mesh, NULL, 0, 0.1f );
    SET( world, e, balloon, d.gas_ratio = 1.3f, d.buoyancy = false );
    assert_status( world, wisp_set_gravity( world, e, gravity ), WISP_OK );
    return e;
}

/// Add a static plane, its normal y turned to `up` (a unit vector along an axis), with which `e` and others collide.
static inline void add_floor( wisp_world* world, wisp_vec3 at, wisp_vec3 up )
{
    wisp_collider_def def = wisp_default_collider_def();
    const float half = sqrtf( 0.5f );
    def.kind = WISP_COLLIDER_PLANE;
    def.pose.translation = at;
    if ( up.y < -0.5f )
    {
        def.pose.rotation = ( wisp_quat ){ 1.0f, 0.0f, 0.0f, 0.0f };
    }
    else if ( up.y <= 0.5f )
    {
        def.pose.rotation = ( wisp_quat ){ up.z * half, 0.0f, -up.x * half, half };
    }
    wisp_entity e;
    assert_status( world, wisp_add_collider( world, &def, &e ), WISP_OK );
}

static inline void set_collision( wisp_world* world, wisp_entity e )
{
    SET_DEFAULT( world, e, collision );
}

// ---- intersections ----

typedef struct bounds_of
{
    float lower[3], upper[3];
} bounds_of;

// Bounds of two or three points. @param slots of the points
static inline bounds_of find_bounds( const float* position, const int32_t* slots, int count )
{
    const float* first = position + 4 * (size_t)slots[0];
    bounds_of b = { { first[0], first[1], first[2] }, { first[0], first[1], first[2] } };
    for ( int i = 1; i < count; ++i )
    {
        const float* p = position + 4 * (size_t)slots[i];
        for ( int k = 0; k < 3; ++k )
        {
            b.lower[k] = p[k] < b.lower[k] ? p[k] : b.lower[k];
            b.upper[k] = p[k] > b.upper[k] ? p[k] : b.upper[k];
        }
    }
    return b;
}

static inline bool bounds_part( const bounds_of* a, const bounds_of* b )
{
    return a->lower[0] > b->upper[0] || b->lower[0] > a->upper[0] || a->lower[1] > b->upper[1] ||
           b->lower[1] > a->upper[1] || a->lower[2] > b->upper[2] || b->lower[2] > a->upper[2];
}

/// Edges of one surface that pass through triangles of another, or of itself: every edge is tested against every
/// triangle.
static inline int count_passing( wisp_world* world, wisp_entity edges_of, wisp_entity triangles_of )
{
    const wisp_fabric *f = wisp_world_fabric( world, edges_of ), *g = wisp_world_fabric( world, triangles_of );
    const float* x = wisp_world_column( world, edges_of, WISP_PARTICLE_POSITION, 0 );
    const float* y = wisp_world_column( world, triangles_of, WISP_PARTICLE_POSITION, 0 );
    bounds_of* bounds = checked_calloc( (size_t)g->triangle_count, sizeof( *bounds ) );
    for ( int t = 0; t < g->triangle_count; ++t )
    {
        bounds[t] = find_bounds( y, g->triangles + 3 * (size_t)t, 3 );
    }
    int count = 0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        const int32_t* ends = f->edges + 2 * (size_t)e;
        const bounds_of edge = find_bounds( x, ends, 2 );
        const float *p = x + 4 * (size_t)ends[0], *q = x + 4 * (size_t)ends[1];
        for ( int t = 0; t < g->triangle_count; ++t )
        {
            if ( bounds_part( &edge, bounds + t ) )
            {
                continue;
            }
            const int32_t* corners = g->triangles + 3 * (size_t)t;
            const float *a = y + 4 * (size_t)corners[0], *b = y + 4 * (size_t)corners[1],
                        *c = y + 4 * (size_t)corners[2];
            const bool shares = p == a || p == b || p == c || q == a || q == b || q == c;
            count += shares == false && wisp_segment_intersects( p, q, a, b, c ) ? 1 : 0;
        }
    }
    free( bounds );
    return count;
}

// ---- state ----

/// Position of a vertex, three floats, by the user's index.
static inline const float* place_of( wisp_world* world, wisp_entity e, int vertex )
{
    const float* column = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    assert_non_null( column );
    return column + (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex] * 4;
}

/// The mean of a coordinate over all vertices.
static inline double mean_of( wisp_world* world, wisp_entity e, int axis )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    double sum = 0.0;
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        sum += (double)place_of( world, e, v )[axis];
    }
    return sum / f->vertex_count;
}

/// J, sum over several surfaces.
static inline double energy_of( wisp_world* world, const wisp_entity* surfaces, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        sum += motion_stats_of( world, surfaces[i] ).kinetic_energy;
    }
    return sum;
}

static inline void momentum_of( wisp_world* world, const wisp_entity* surfaces, int count, double out[3] )
{
    memset( out, 0, 3 * sizeof( double ) );
    for ( int i = 0; i < count; ++i )
    {
        const wisp_motion_stats q = motion_stats_of( world, surfaces[i] );
        for ( int k = 0; k < 3; ++k )
        {
            out[k] += q.momentum[k];
        }
    }
}
