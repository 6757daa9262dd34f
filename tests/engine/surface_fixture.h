/// Meshes and surfaces for tests: a plane of n x n vertices and a ball of eight times four to the level triangles.
#pragma once

#include "test_mesh.h"
#include "world_fixture.h"

#include "cloth.h"
#include "wisp/fabric.h"
#include "wisp/module/components.h"

/// The cloth of a test of free motion.
static inline wisp_cloth_def undamped_cloth( void )
{
    wisp_cloth_def cloth = wisp_default_cloth_def();
    cloth.internal_damping = 0.0f;
    return cloth;
}

/// In the plane y = 0, vertex j n + i at (i, 0, j) spacing, diagonals alternating.
static inline test_mesh test_plane( int n, float spacing )
{
    test_mesh m = { calloc( (size_t)( n * n ), sizeof( wisp_vec3 ) ),
                    calloc( (size_t)( 6 * ( n - 1 ) * ( n - 1 ) ), sizeof( int32_t ) ), n * n, 0 };
    assert_non_null( m.points );
    assert_non_null( m.triangles );
    for ( int v = 0; v < n * n; ++v )
    {
        m.points[v] = ( wisp_vec3 ){ (float)( v % n ) * spacing, 0.0f, (float)( v / n ) * spacing };
    }
    for ( int j = 0; j + 1 < n; ++j )
    {
        for ( int i = 0; i + 1 < n; ++i )
        {
            int a = j * n + i, b = a + 1, c = a + n, d = c + 1;
            const int32_t even[6] = { a, c, d, a, d, b }, odd[6] = { a, c, b, b, c, d };
            memcpy( m.triangles + 3 * (size_t)m.triangle_count, ( i + j ) % 2 == 0 ? even : odd, sizeof( even ) );
            m.triangle_count += 2;
        }
    }
    return m;
}

static inline int test_midpoint( test_mesh* m, int32_t* made, int* made_count, int a, int b )
{
    int lower = a < b ? a : b, upper = a < b ? b : a;
    for ( int k = 0; k < *made_count; ++k )
    {
        if ( made[3 * k] == lower && made[3 * k + 1] == upper )
        {
            return made[3 * k + 2];
        }
    }
    const wisp_vec3 p = m->points[a], q = m->points[b];
    wisp_vec3 r = { p.x + q.x, p.y + q.y, p.z + q.z };
    float length = sqrtf( r.x * r.x + r.y * r.y + r.z * r.z );
    m->points[m->vertex_count] = ( wisp_vec3 ){ r.x / length, r.y / length, r.z / length };
    const int32_t row[3] = { lower, upper, m->vertex_count };
    memcpy( made + 3 * ( *made_count )++, row, sizeof( row ) );
    return m->vertex_count++;
}

/// A unit ball about the origin, outward.
static inline test_mesh test_ball( int level )
{
    int triangles = 8;
    for ( int l = 0; l < level; ++l )
    {
        triangles *= 4;
    }
    test_mesh m = { calloc( (size_t)triangles, sizeof( wisp_vec3 ) ),
                    calloc( (size_t)triangles * 3, sizeof( int32_t ) ), 6, 8 };
    SCOPED( free_local ) int32_t* next = calloc( (size_t)triangles * 3, sizeof( int32_t ) );
    SCOPED( free_local ) int32_t* made = calloc( (size_t)triangles * 9, sizeof( int32_t ) );
    static const wisp_vec3 CORNERS[6] = { { 1, 0, 0 },  { -1, 0, 0 }, { 0, 1, 0 },
                                          { 0, -1, 0 }, { 0, 0, 1 },  { 0, 0, -1 } };
    static const int32_t FACES[24] = { 0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5 };
    memcpy( m.points, CORNERS, sizeof( CORNERS ) );
    memcpy( m.triangles, FACES, sizeof( FACES ) );
    for ( int l = 0; l < level; ++l )
    {
        int count = 0, made_count = 0;
        for ( int t = 0; t < m.triangle_count; ++t )
        {
            const int32_t* c = m.triangles + 3 * (size_t)t;
            int ab = test_midpoint( &m, made, &made_count, c[0], c[1] ),
                bc = test_midpoint( &m, made, &made_count, c[1], c[2] );
            int ca = test_midpoint( &m, made, &made_count, c[2], c[0] );
            const int32_t four[12] = { c[0], ab, ca, ab, c[1], bc, ca, bc, c[2], ab, bc, ca };
            memcpy( next + 3 * (size_t)count, four, sizeof( four ) );
            count += 4;
        }
        m.triangle_count = count;
        memcpy( m.triangles, next, (size_t)count * 3 * sizeof( int32_t ) );
    }
    return m;
}

/// A surface of a mesh; the fabric lives as long as the world.
static inline wisp_entity test_surface_of( wisp_world* world, const wisp_fabric_def* fabric_def,
                                           wisp_surface_def def )
{
    wisp_error error = { 0 };
    if ( wisp_fabric_cook( fabric_def, NULL, &def.fabric, &error ) != WISP_OK )
    {
        fail_msg( "no fabric: %s", error.message );
    }
    wisp_entity e;
    if ( wisp_add_surface( world, &def, &e ) != WISP_OK )
    {
        fail_msg( "no surface: %s", wisp_world_message( world ) );
    }
    wisp_fabric_release( def.fabric );
    return e;
}

static inline wisp_motion_stats motion_stats_of( wisp_world* world, wisp_entity e )
{
    wisp_motion_stats q;
    assert_int_equal( wisp_read_motion_stats( world, e, &q ), WISP_OK );
    return q;
}

static inline wisp_vec3 point_of( wisp_world* world, wisp_entity e, int vertex )
{
    return ( (const wisp_vec3*)view_of( world, e, WISP_SURFACE_POINTS ).data )[vertex];
}
