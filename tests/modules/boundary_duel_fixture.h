/// The engine's boundary points compared with those of the oracle, on the same floats.
#pragma once

#include "support.h"

#include "boundary_oracle_fixture.h"
#include "jobs.h"
#include "kernel_tables.h"

#include "wisp/module/sampling.h"

/// Settings of both.
typedef struct duel_def
{
    double spacing; ///< m, exactly a float
    wisp_spacing policy;
    wisp_rounding rounding;
    double hysteresis;          ///< exactly a float
    int workers;                ///< default 0: 2
    const char* isa;            ///< the widest instruction set; null: the processor's
    const double* edge_spacing; ///< [edge_count] exactly floats; null: `spacing`
    const double* triangle_spacing;
} duel_def;

typedef struct duel
{
    balloon_mesh mesh; ///< owned by the caller
    duel_def def;
    double3* x; ///< widened floats
    boundary_oracle_layer oracle;
    boundary_oracle_point* before; ///< memory of the oracle before its last update
    int before_count;
    boundary_oracle_memory* memory_before; ///< [element_count], only counts are used
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    wisp_samples samples;
    wisp_samples_args args;
    float *position, *normal, *edge_spacing, *triangle_spacing;
    int32_t *edges, *triangles;
    wisp_status status;
} duel;

static inline void* duel_memory( int count, size_t row )
{
    void* memory = aligned_alloc( 64, ( (size_t)( count + 8 ) * row + 63 ) / 64 * 64 );
    assert_non_null( memory );
    memset( memory, 0, (size_t)( count + 8 ) * row );
    return memory;
}

static inline float* duel_floats( const double* from, int count )
{
    float* to = duel_memory( count, sizeof( float ) );
    for ( int i = 0; i < count; ++i )
    {
        to[i] = (float)from[i];
    }
    return to;
}

static inline void duel_fill_args( duel* d )
{
    const int edges = d->oracle.edge_count, triangles = d->oracle.triangle_count;
    d->edges = duel_memory( 2 * edges, sizeof( int32_t ) );
    d->triangles = duel_memory( 3 * triangles, sizeof( int32_t ) );
    for ( int e = 0; e < edges; ++e )
    {
        d->edges[2 * e] = d->oracle.topology.edges[e].a;
        d->edges[2 * e + 1] = d->oracle.topology.edges[e].b;
    }
    memcpy( d->triangles, d->mesh.triangles, 3 * (size_t)triangles * sizeof( int32_t ) );
    d->edge_spacing = d->def.edge_spacing != NULL ? duel_floats( d->def.edge_spacing, edges ) : NULL;
    d->triangle_spacing = d->def.triangle_spacing != NULL ? duel_floats( d->def.triangle_spacing, triangles ) : NULL;
    d->args = ( wisp_samples_args ){
        .position = d->position,
        .normal = d->normal,
        .edges = d->edges,
        .edge_count = edges,
        .triangles = d->triangles,
        .triangle_count = triangles,
        .edge_spacing = d->edge_spacing,
        .triangle_spacing = d->triangle_spacing,
        .spacing = (float)d->def.spacing,
        .policy = d->def.policy,
        .rounding = d->def.rounding,
        .hysteresis = (float)d->def.hysteresis,
        .limit = 4000000,
        .edge_length = duel_memory( edges, sizeof( float ) ),
        .edge_points = duel_memory( edges, sizeof( int32_t ) ),
        .triangle_extent = duel_memory( 2 * triangles, sizeof( float ) ),
        .triangle_axis = duel_memory( triangles, sizeof( int32_t ) ),
        .triangle_points = duel_memory( triangles, sizeof( int32_t ) ),
    };
}

/// Close with duel_close(). The caller keeps the mesh.
static inline duel* duel_open( const balloon_mesh* mesh, const duel_def* def )
{
    duel* d = checked_calloc( 1, sizeof( duel ) );
    d->mesh = *mesh;
    d->def = *def;
    const boundary_oracle_options options = {
        .spacing = def->spacing,
        .policy = (boundary_oracle_policy)def->policy,
        .rounding = (boundary_oracle_rounding)def->rounding,
        .hysteresis = def->hysteresis,
        .cap = 1e9,
        .edge_spacing = def->edge_spacing,
        .triangle_spacing = def->triangle_spacing,
    };
    assert_int_equal( boundary_oracle_create( mesh, &options, &d->oracle, NULL ), WISP_OK );
    d->x = checked_calloc( (size_t)mesh->vertex_count, sizeof( double3 ) );
    d->position = duel_memory( 4 * mesh->vertex_count, sizeof( float ) );
    d->normal = duel_memory( 4 * mesh->vertex_count, sizeof( float ) );
    d->allocator = test_host_allocator( &d->host );
    d->pool = jobs_create( &d->allocator, def->workers > 0 ? def->workers : 2, NULL, NULL );
    duel_fill_args( d );
    return d;
}

static inline void duel_close( duel* d )
{
    wisp_samples_release( &d->samples, &d->allocator );
    jobs_destroy( d->pool );
    assert_host_memory_is_released( &d->host );
    boundary_oracle_destroy( &d->oracle );
    void* blocks[] = { d->x,
                       d->before,
                       d->memory_before,
                       d->position,
                       d->normal,
                       d->edge_spacing,
                       d->triangle_spacing,
                       d->edges,
                       d->triangles,
                       d->args.edge_length,
                       d->args.edge_points,
                       d->args.triangle_extent,
                       d->args.triangle_axis,
                       d->args.triangle_points };
    for ( size_t k = 0; k < sizeof( blocks ) / sizeof( blocks[0] ); ++k )
    {
        free( blocks[k] );
    }
    free( d );
}

static inline void duel_run( void* context )
{
    duel* d = context;
    d->status =
        wisp_samples_update( &d->samples, jobs_everyone( d->pool ), kernels_select( d->def.isa, NULL ), &d->args );
}

// Update the oracle at these positions and keep its previous memory.
static inline void duel_remember( duel* d )
{
    const boundary_oracle_layer* o = &d->oracle;
    free( d->before );
    free( d->memory_before );
    d->before_count = o->point_count;
    d->before = calloc( (size_t)o->point_count + 1, sizeof( boundary_oracle_point ) );
    d->memory_before = calloc( (size_t)o->element_count + 1, sizeof( boundary_oracle_memory ) );
    assert_true( d->before != NULL && d->memory_before != NULL );
    memcpy( d->memory_before, o->memory, (size_t)o->element_count * sizeof( boundary_oracle_memory ) );
    if ( o->point_count > 0 )
    {
        memcpy( d->before, o->points, (size_t)o->point_count * sizeof( boundary_oracle_point ) );
    }
}

/// Update both at these positions, rounded to floats. Vertex normals are the oracle's, rounded. @return of the engine
static inline wisp_status duel_try( duel* d, const double3* x )
{
    for ( int i = 0; i < d->mesh.vertex_count; ++i )
    {
        const float quad[4] = { (float)x[i].x, (float)x[i].y, (float)x[i].z, 1.0f };
        memcpy( d->position + 4 * (size_t)i, quad, sizeof( quad ) );
    }
    // in a separate loop: gcc 12 does not round a pair of doubles that is converted to floats and back in one
    // expression
    for ( int i = 0; i < d->mesh.vertex_count; ++i )
    {
        const float* quad = d->position + 4 * (size_t)i;
        d->x[i] = double3_make( (double)quad[0], (double)quad[1], (double)quad[2] );
    }
    duel_remember( d );
    must_update( &d->oracle, d->x );
    for ( int i = 0; i < d->mesh.vertex_count; ++i )
    {
        const double3 n = d->oracle.vertex_normal[i];
        const float quad[4] = { (float)n.x, (float)n.y, (float)n.z, 0.0f };
        memcpy( d->normal + 4 * (size_t)i, quad, sizeof( quad ) );
    }
    jobs_enter( d->pool, duel_run, d );
    return d->status;
}

static inline void duel_update( duel* d, const double3* x )
{
    assert_int_equal( duel_try( d, x ), WISP_OK );
}
