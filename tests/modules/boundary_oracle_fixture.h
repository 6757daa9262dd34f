/// Shared by the tests of the boundary oracle: the reference sphere, layers that must succeed, comparisons.
#pragma once

#include "oracle_support.h"

#include "oracle/boundary_oracle.h"

static const uint64_t random_seed = 61;

static const double3 zero = { 0.0, 0.0, 0.0 };

// of the reference program
static const double RADIUS = 2.5;
static const double SPACING = 0.1;

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

/// Compare points and their identities bit by bit.
static inline void assert_same_points( const boundary_oracle_layer* a, const boundary_oracle_layer* b )
{
    assert_int_equal( a->point_count, b->point_count );
    for ( int n = 0; n < a->point_count; ++n )
    {
        const boundary_oracle_point *p = a->points + n, *q = b->points + n;
        assert_true( p->element == q->element && p->line == q->line && p->step == q->step );
        assert_memory_equal( p->parent, q->parent, sizeof( p->parent ) );
        assert_memory_equal( p->weight, q->weight, sizeof( p->weight ) );
        assert_memory_equal( &p->y, &q->y, sizeof( p->y ) );
        assert_memory_equal( &p->normal, &q->normal, sizeof( p->normal ) );
    }
}

static inline void scale_all( double3* x, const double3* rest, int count, double factor )
{
    for ( int i = 0; i < count; ++i )
    {
        x[i] = double3_scale( factor, rest[i] );
    }
}

static inline double doubled_area( const double3 c[3] )
{
    return double3_length( double3_cross( double3_sub( c[1], c[0] ), double3_sub( c[2], c[0] ) ) );
}

/// Weights, plane, sum and normal of a point.
static inline void assert_on_its_parents( const boundary_oracle_layer* layer, const double3* x,
                                          const boundary_oracle_point* p )
{
    double sum = 0.0, by_area[3];
    double3 y = zero, corner[3];
    for ( int k = 0; k < 3; ++k )
    {
        assert_true( p->weight[k] >= 0.0 );
        sum += p->weight[k];
        corner[k] = x[p->parent[k]];
        y = double3_add( y, double3_scale( p->weight[k], corner[k] ) );
    }
    assert_close( sum, 1.0, 1e-12 );
    assert_close( double3_distance( y, p->y ), 0.0, 1e-12 * ( 1.0 + double3_length( p->y ) ) );
    assert_close( double3_length( p->normal ), 1.0, 1e-12 );
    if ( p->element >= layer->edge_count && boundary_oracle_weights_by_area( corner, p->y, by_area ) )
    {
        const double3 n = boundary_oracle_face_normal( corner );
        assert_true( fabs( double3_dot( n, double3_sub( p->y, corner[0] ) ) ) < 1e-6 * layer->options.spacing );
        for ( int k = 0; k < 3; ++k )
        {
            assert_close( by_area[k], p->weight[k], 1e-11 );
        }
    }
}
