/// Shared by the tests of the boundary oracle: the reference sphere, layers that must succeed.
#pragma once

#include "oracle_support.h"

#include "oracle/boundary_oracle.h"

static const uint64_t random_seed = 61;

static const double3 zero = { 0.0, 0.0, 0.0 };

// of the reference program
static const double RADIUS = 2.5;

static inline balloon_mesh reference_sphere( void )
{
    balloon_mesh mesh;
    assert_true( boundary_oracle_sphere( &mesh, 30, 30, RADIUS ) );
    return mesh;
}

/// The caller's own triangles, in memory that balloon_mesh_destroy() takes back.
static inline balloon_mesh mesh_of( const double3* points, int vertex_count, const int* triangles,
                                    int triangle_count )
{
    balloon_mesh mesh = { .vertex_count = vertex_count, .triangle_count = triangle_count };
    const size_t n = (size_t)vertex_count, t = 3 * (size_t)triangle_count;
    mesh.positions = calloc( n, sizeof( double3 ) );
    mesh.triangles = calloc( t, sizeof( int ) );
    assert_true( mesh.positions != NULL && mesh.triangles != NULL );
    memcpy( mesh.positions, points, n * sizeof( double3 ) );
    memcpy( mesh.triangles, triangles, t * sizeof( int ) );
    return mesh;
}

static inline balloon_mesh one_triangle( double3 a, double3 b, double3 c )
{
    return mesh_of( ( const double3[3] ){ a, b, c }, 3, ( const int[3] ){ 0, 1, 2 }, 1 );
}

static inline void must_update( boundary_oracle_layer* layer, const double3* x )
{
    assert_true( boundary_oracle_update( layer, x ) );
}

/// A layer on a mesh at its present positions, updated once.
static inline boundary_oracle_layer layer_on( const balloon_mesh* mesh, const boundary_oracle_options* options )
{
    boundary_oracle_layer layer;
    assert_int_equal( boundary_oracle_create( mesh, options, &layer, NULL ), WISP_OK );
    must_update( &layer, mesh->positions );
    return layer;
}

static inline int inner_points( const boundary_oracle_layer* layer )
{
    return layer->point_count - layer->edge_point_count;
}
