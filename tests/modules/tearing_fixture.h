/// Shared by the tests of tearing: strips that hang with a weight, spare vertices, what makes a torn mesh valid.
#pragma once

#include "cloth_fixture.h"
#include "engine/fabric_fixture.h"

#include "tearing.h"
#include "wisp/maps.h"

static inline hosted* open_tearing( int substeps, int iterations, int workers )
{
    static const wisp_module* const MODULES[] = { &wisp_cloth_module, &wisp_tearing_module };
    return new_hosted( MODULES, WISP_COUNT( MODULES ), substeps, iterations, workers );
}

static inline void close_tearing( hosted* h )
{
    void* state = h;
    close_hosted( &state );
}

/// Add vertices that are in no triangle.
static inline void add_spares( test_mesh* m, int count )
{
    m->points = realloc( m->points, (size_t)( m->vertex_count + count ) * sizeof( wisp_vec3 ) );
    assert_non_null( m->points );
    for ( int i = 0; i < count; ++i )
    {
        m->points[m->vertex_count + i] = m->points[0];
    }
    m->vertex_count += count;
}

static inline wisp_tearing_stats tearing_stats_of( wisp_world* world, wisp_entity e )
{
    wisp_tearing_stats stats;
    assert_status( world, wisp_read_tearing_stats( world, e, &stats ), WISP_OK );
    return stats;
}

static inline int32_t* read_triangles( wisp_world* world, wisp_entity e, int count )
{
    int32_t* triangles = calloc( (size_t)count * 3 + 1, sizeof( int32_t ) );
    assert_non_null( triangles );
    assert_status( world, wisp_read_triangles( world, e, triangles, count ), WISP_OK );
    return triangles;
}

static inline int root_of( int* parent, int v )
{
    while ( parent[v] != v )
    {
        v = parent[v] = parent[parent[v]];
    }
    return v;
}

/// What a mesh is made of.
typedef struct mesh_report
{
    int pieces;               ///< of triangles that share edges
    int nonmanifold_edges;    ///< that more than two triangles have, or two in one direction
    int nonmanifold_vertices; ///< whose triangles are several fans, without pinned ones
    int used_vertices;
} mesh_report;

static inline int count_uses( const int32_t* t, int count, int from, int to )
{
    int uses = 0;
    for ( int i = 0; i < 3 * count; ++i )
    {
        uses += t[i] == from && t[i - i % 3 + ( i + 1 ) % 3] == to ? 1 : 0;
    }
    return uses;
}

// Triangles at a vertex that no chain of edges at the vertex leads to from the first one, by union of neighbours.
static inline int count_fans_at( const int32_t* t, int count, int vertex, int vertex_count )
{
    SCOPED( free_local ) int* parent = calloc( (size_t)vertex_count, sizeof( int ) );
    int neighbours = 0, joined = 0;
    assert_non_null( parent );
    for ( int v = 0; v < vertex_count; ++v )
    {
        parent[v] = -1;
    }
    for ( int i = 0; i < 3 * count; ++i )
    {
        if ( t[i] == vertex )
        {
            for ( int k = 1; k < 3; ++k )
            {
                const int n = t[i - i % 3 + ( i + k ) % 3];
                neighbours += parent[n] < 0 ? 1 : 0;
                parent[n] = parent[n] < 0 ? n : parent[n];
            }
            const int a = root_of( parent, t[i - i % 3 + ( i + 1 ) % 3] ),
                      b = root_of( parent, t[i - i % 3 + ( i + 2 ) % 3] );
            joined += a != b ? 1 : 0;
            parent[a] = b;
        }
    }
    return neighbours - joined;
}

static inline mesh_report report_mesh( const int32_t* t, int count, int vertex_count, wisp_world* world,
                                       wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    mesh_report r = { 0 };
    SCOPED( free_local ) int* parent = calloc( (size_t)vertex_count, sizeof( int ) );
    assert_non_null( parent );
    for ( int v = 0; v < vertex_count; ++v )
    {
        parent[v] = v;
    }
    for ( int i = 0; i < 3 * count; ++i )
    {
        const int a = t[i], b = t[i - i % 3 + ( i + 1 ) % 3];
        r.nonmanifold_edges += count_uses( t, count, a, b ) > 1 ? 1 : 0;
        parent[root_of( parent, a )] = root_of( parent, b );
    }
    for ( int v = 0; v < vertex_count; ++v )
    {
        const int fans = count_fans_at( t, count, v, vertex_count );
        r.used_vertices += fans > 0 ? 1 : 0;
        r.nonmanifold_vertices += fans > 1 && position[4 * (size_t)f->vertex_slot[v] + 3] > 0.0f ? 1 : 0;
        r.pieces += fans > 0 && root_of( parent, v ) == v ? 1 : 0;
    }
    return r;
}

/// Sums over the vertices that are not pinned, in double.
typedef struct mass_sums
{
    double mass, momentum[3], centre[3];
} mass_sums;

static inline mass_sums sum_masses( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    const float* position = wisp_world_column( world, e, WISP_PARTICLE_POSITION, 0 );
    const float* velocity = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    mass_sums sums = { 0 };
    for ( int i = 0; i < f->vertex_count; ++i )
    {
        const float *p = position + 4 * (size_t)i, *v = velocity + 4 * (size_t)i;
        const double mass = p[3] > 0.0f ? 1.0 / (double)p[3] : 0.0;
        sums.mass += mass;
        for ( int k = 0; k < 3; ++k )
        {
            sums.momentum[k] += mass * (double)v[k];
            sums.centre[k] += mass * (double)p[k];
        }
    }
    for ( int k = 0; k < 3; ++k )
    {
        sums.centre[k] /= sums.mass;
    }
    return sums;
}

/// The fabric of a surface has complete lists of its triangles and no conflicts in its schedules.
static inline void assert_sound_fabric( wisp_world* world, wisp_entity e )
{
    const wisp_fabric* f = wisp_world_fabric( world, e );
    assert_int_equal( wisp_fabric_need( f, WISP_FABRIC_EDGES | WISP_FABRIC_RINGS ), WISP_OK );
    assert_edges_are_those_of_the_triangles( f );
    assert_hinges_are_two_triangles( f );
    assert_lanes_hold_their_constraints( f, f->link_count > f->edge_count );
    assert_rings_are_those_of_the_triangles( f );
    assert_fabric_is_safe( f );
}
