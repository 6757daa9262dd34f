/// Clouds of items, and neighbours by brute force.
#pragma once

#include "support.h"

#include "jobs.h"
#include "kernel_tables.h"

#include "wisp/module/space.h"

// ---- clouds ----

typedef enum cloud_shape
{
    CLOUD_BALL,      // uniform in a cube around the origin
    CLOUD_SHEET,     // the same with z = 0
    CLOUD_NEGATIVE,  // a cube far on the negative side
    CLOUD_CLUSTERS,  // dense clusters far apart
    CLOUD_LINE,      // along a diagonal
    CLOUD_AXIS,      // along y alone
    CLOUD_ONE_POINT, // all items coincide
    CLOUD_LATTICE,   // a cubic lattice of a quarter: distances of exactly the radius, items exactly on cells' borders
    CLOUD_SPREAD,    // two clusters a million apart, so that cells must widen
    CLOUD_SHAPE_COUNT,
} cloud_shape;

typedef struct cloud
{
    int count;
    float* xyzw;
} cloud;

static inline wisp_vec3 cloud_point( cloud_shape shape, int i, int count )
{
    wisp_vec3 u = { test_random_float( i, 0, -1.0f, 1.0f ), test_random_float( i, 1, -1.0f, 1.0f ),
                    test_random_float( i, 2, -1.0f, 1.0f ) };
    float t = (float)i / (float)count;
    switch ( shape )
    {
        case CLOUD_SHEET:
            return ( wisp_vec3 ){ u.x, u.y, 0.0f };
        case CLOUD_NEGATIVE:
            return ( wisp_vec3 ){ u.x - 900.0f, u.y - 700.0f, u.z - 800.0f };
        case CLOUD_CLUSTERS:
        {
            float heap = (float)( i % 5 );
            return ( wisp_vec3 ){ 7.0f * heap + 0.1f * u.x, -3.0f * heap + 0.1f * u.y, 0.1f * u.z };
        }
        case CLOUD_LINE:
            return ( wisp_vec3 ){ 5.0f * t, 5.0f * t, -5.0f * t };
        case CLOUD_AXIS:
            return ( wisp_vec3 ){ 2.0f, 9.0f * u.y, 2.0f };
        case CLOUD_ONE_POINT:
            return ( wisp_vec3 ){ 0.3f, -0.4f, 0.5f };
        case CLOUD_LATTICE:
            return ( wisp_vec3 ){ 0.25f * (float)( i % 9 ), 0.25f * (float)( i / 9 % 9 ), 0.25f * (float)( i / 81 ) };
        case CLOUD_SPREAD:
            return ( wisp_vec3 ){ ( i % 2 == 0 ? -5e5f : 5e5f ) + u.x, u.y, i % 7 == 0 ? 3e5f : u.z };
        default:
            return u;
    }
}

// Owners of about four items each, so that some near items are the query's own.
static inline cloud make_cloud( cloud_shape shape, int count )
{
    cloud c = { count, calloc( 4 * (size_t)count + 4, sizeof( float ) ) };
    assert_non_null( c.xyzw );
    for ( int i = 0; i < count; ++i )
    {
        wisp_vec3 p = cloud_point( shape, i, count );
        int32_t owner = test_random( i, 3, count / 4 + 1 );
        memcpy( c.xyzw + 4 * (size_t)i, &p, sizeof( p ) );
        memcpy( c.xyzw + 4 * (size_t)i + 3, &owner, sizeof( owner ) );
    }
    return c;
}

static inline int32_t owner_of( const float* quad )
{
    int32_t owner;
    memcpy( &owner, quad + 3, sizeof( owner ) );
    return owner;
}

// The radius at which every shape has items near each other, also where cells had to be widened.
static inline float cloud_radius( cloud_shape shape )
{
    return shape == CLOUD_CLUSTERS ? 0.04f : ( shape == CLOUD_LATTICE ? 0.25f : 0.125f );
}

// ---- builds, with an active pool of workers ----

static const int COUNTS[] = { 0, 1, 7, 8, 9, 100, 1000, 5000 };
static const int WORKER_COUNTS[] = { 1, 2, 3, 8 };

static inline const wisp_kernels* baseline( void )
{
    return kernels_select( "baseline", NULL );
}

/// Builds run inside an entered pool, as in a step.
typedef struct space
{
    test_host host;
    wisp_allocator allocator;
    jobs_pool* pool;
    const wisp_kernels* kernels;
    wisp_grid grid;
    wisp_neighbours found;
    // of the running build
    const cloud* items;
    float cell;
    int fine; // 0 is 1
    const wisp_neighbour_query* query;
    wisp_status status;
} space;

static inline space* space_open( int workers, const wisp_kernels* kernels )
{
    space* s = checked_calloc( 1, sizeof( space ) );
    s->allocator = test_host_allocator( &s->host );
    s->pool = jobs_create( &s->allocator, workers, NULL, NULL );
    s->kernels = kernels;
    return s;
}

static inline void space_close( space* s )
{
    wisp_grid_release( &s->grid, &s->allocator );
    wisp_neighbours_release( &s->found, &s->allocator );
    jobs_destroy( s->pool );
    assert_host_memory_is_released( &s->host );
    free( s );
}

static inline void run_grid_build( void* context )
{
    space* s = context;
    int fine = s->fine > 0 ? s->fine : 1;
    s->status = wisp_grid_build( &s->grid, jobs_everyone( s->pool ), s->items->xyzw, s->items->count, s->cell, fine );
}

static inline wisp_status build_grid( space* s, const cloud* items, float cell )
{
    s->items = items;
    s->cell = cell;
    jobs_enter( s->pool, run_grid_build, s );
    return s->status;
}

static inline void run_search( void* context )
{
    space* s = context;
    s->status = wisp_neighbours_build( &s->found, jobs_everyone( s->pool ), s->kernels, &s->grid, s->query );
}

static inline wisp_status search( space* s, const wisp_neighbour_query* query )
{
    s->query = query;
    jobs_enter( s->pool, run_search, s );
    return s->status;
}
