/// Meshes with normals, and layers of points on them.
#pragma once

#include "support.h"

#include "jobs.h"
#include "kernel_tables.h"

#include "wisp/module/sampling.h"

typedef struct samples_mesh
{
    int vertex_count, edge_count, triangle_count;
    float *position, *normal; // [vertex][4]
    int32_t *edges, *triangles;
} samples_mesh;

static inline void* samples_array( size_t count, size_t row )
{
    void* memory = aligned_alloc( 64, ( count * row + 64 ) / 64 * 64 );
    assert_non_null( memory );
    memset( memory, 0, ( count * row + 64 ) / 64 * 64 );
    return memory;
}

static inline int samples_compare_edges( const void* a, const void* b )
{
    const int32_t *p = a, *q = b;
    return p[0] != q[0] ? p[0] - q[0] : p[1] - q[1];
}

/// Edges of the triangles, each once, lower end first, rising.
static inline void samples_find_edges( samples_mesh* m )
{
    int32_t* all = samples_array( (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ) );
    for ( int side = 0; side < 3 * m->triangle_count; ++side )
    {
        const int32_t a = m->triangles[side], b = m->triangles[side / 3 * 3 + ( side + 1 ) % 3];
        all[2 * side] = a < b ? a : b;
        all[2 * side + 1] = a < b ? b : a;
    }
    qsort( all, (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ), samples_compare_edges );
    m->edges = samples_array( (size_t)m->triangle_count * 3, 2 * sizeof( int32_t ) );
    for ( int side = 0; side < 3 * m->triangle_count; ++side )
    {
        if ( side == 0 || memcmp( all + 2 * side, all + 2 * side - 2, 2 * sizeof( int32_t ) ) != 0 )
        {
            memcpy( m->edges + 2 * m->edge_count++, all + 2 * side, 2 * sizeof( int32_t ) );
        }
    }
    free( all );
}

static inline samples_mesh samples_mesh_of( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                            int triangle_count )
{
    samples_mesh m = { .vertex_count = vertex_count, .triangle_count = triangle_count };
    m.position = samples_array( (size_t)vertex_count, 4 * sizeof( float ) );
    m.normal = samples_array( (size_t)vertex_count, 4 * sizeof( float ) );
    m.triangles = samples_array( (size_t)triangle_count * 3, sizeof( int32_t ) );
    memcpy( m.triangles, triangles, (size_t)triangle_count * 3 * sizeof( int32_t ) );
    for ( int v = 0; v < vertex_count; ++v )
    {
        const float quad[4] = { points[v].x, points[v].y, points[v].z, 1.0f }, up[4] = { 0.0f, 0.0f, 1.0f, 0.0f };
        memcpy( m.position + 4 * v, quad, sizeof( quad ) );
        memcpy( m.normal + 4 * v, up, sizeof( up ) );
    }
    samples_find_edges( &m );
    return m;
}

/// The reference: 872 vertices, 1740 triangles and 2610 edges for 30 slices and 30 stacks. Poles on the y axis.
static inline samples_mesh samples_sphere( int slices, int stacks, double radius )
{
    const double pi = 3.14159265358979323846;
    const int vertex_count = slices * ( stacks - 1 ) + 2, top = vertex_count - 2, bottom = vertex_count - 1;
    wisp_vec3* points = samples_array( (size_t)vertex_count, sizeof( wisp_vec3 ) );
    int32_t* triangles = samples_array( (size_t)slices * (size_t)stacks * 6, sizeof( int32_t ) );
    int count = 0;
    for ( int v = 0; v < vertex_count - 2; ++v )
    {
        const double down = pi * ( v / slices + 1 ) / stacks, around = 2.0 * pi * ( v % slices ) / slices;
        points[v] = ( wisp_vec3 ){ (float)( radius * sin( down ) * cos( around ) ), (float)( radius * cos( down ) ),
                                   (float)( radius * sin( down ) * sin( around ) ) };
    }
    points[top] = ( wisp_vec3 ){ 0.0f, (float)radius, 0.0f };
    points[bottom] = ( wisp_vec3 ){ 0.0f, (float)-radius, 0.0f };
    for ( int s = 0; s < slices; ++s )
    {
        const int next = ( s + 1 ) % slices, last = slices * ( stacks - 2 );
        for ( int k = 0; k + 2 < stacks; ++k )
        {
            const int a = k * slices + s, b = k * slices + next;
            const int32_t two[6] = { a, b, b + slices, a, b + slices, a + slices };
            memcpy( triangles + 3 * count, two, sizeof( two ) );
            count += 2;
        }
        const int32_t caps[6] = { top, next, s, last + s, last + next, bottom };
        memcpy( triangles + 3 * count, caps, sizeof( caps ) );
        count += 2;
    }
    samples_mesh m = samples_mesh_of( points, vertex_count, triangles, count );
    for ( int v = 0; v < vertex_count; ++v )
    {
        for ( int k = 0; k < 3; ++k )
        {
            m.normal[4 * v + k] = m.position[4 * v + k] / (float)radius;
        }
    }
    free( points );
    free( triangles );
    return m;
}

static inline void samples_mesh_free( samples_mesh* m )
{
    free( m->position );
    free( m->normal );
    free( m->edges );
    free( m->triangles );
}

// ---- a layer, with an active pool of workers ----

typedef struct layer
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    wisp_samples samples;
    wisp_samples_args args;
    wisp_status status;
} layer;

static inline layer* layer_open( const samples_mesh* m, float spacing, int workers )
{
    layer* l = checked_calloc( 1, sizeof( layer ) );
    l->allocator = test_host_allocator( &l->host );
    l->pool = jobs_create( &l->allocator, workers, NULL, NULL );
    const size_t edges = (size_t)m->edge_count, triangles = (size_t)m->triangle_count;
    l->args = ( wisp_samples_args ){
        .position = m->position,
        .normal = m->normal,
        .edges = m->edges,
        .edge_count = m->edge_count,
        .triangles = m->triangles,
        .triangle_count = m->triangle_count,
        .spacing = spacing,
        .limit = 1000000,
        .edge_length = samples_array( edges, sizeof( float ) ),
        .edge_points = samples_array( edges, sizeof( int32_t ) ),
        .triangle_extent = samples_array( triangles, 2 * sizeof( float ) ),
        .triangle_axis = samples_array( triangles, sizeof( int32_t ) ),
        .triangle_points = samples_array( triangles, sizeof( int32_t ) ),
    };
    return l;
}

static inline void layer_close( layer* l )
{
    free( l->args.edge_length );
    free( l->args.edge_points );
    free( l->args.triangle_extent );
    free( l->args.triangle_axis );
    free( l->args.triangle_points );
    wisp_samples_release( &l->samples, &l->allocator );
    jobs_destroy( l->pool );
    assert_host_memory_is_released( &l->host );
    free( l );
}

static inline void layer_run( void* context )
{
    layer* l = context;
    l->status = wisp_samples_update( &l->samples, jobs_everyone( l->pool ), kernels_select( NULL, NULL ), &l->args );
}

static inline wisp_status layer_try( layer* l )
{
    jobs_enter( l->pool, layer_run, l );
    return l->status;
}

static inline void layer_update( layer* l )
{
    assert_int_equal( layer_try( l ), WISP_OK );
}

static inline int32_t layer_element( const layer* l, int point )
{
    int32_t element;
    memcpy( &element, l->samples.xyzw + 4 * point + 3, sizeof( element ) );
    return element;
}

/// Every array of two layers has the same bits.
static inline void assert_same_points( const wisp_samples* a, const wisp_samples* b, int elements )
{
    const size_t bytes = (size_t)a->count * 4 * sizeof( float );
    assert_int_equal( a->count, b->count );
    assert_int_equal( a->edge_count, b->edge_count );
    assert_memory_equal( a->begin, b->begin, ( (size_t)elements + 1 ) * sizeof( int32_t ) );
    if ( bytes > 0 )
    {
        assert_memory_equal( a->xyzw, b->xyzw, bytes );
        assert_memory_equal( a->normals, b->normals, bytes );
        assert_memory_equal( a->parents, b->parents, bytes );
        assert_memory_equal( a->weights, b->weights, bytes );
    }
}
