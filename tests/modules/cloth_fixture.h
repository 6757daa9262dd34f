/// Shared by the tests of cloth: worlds with chosen substeps, hanging rectangles, cloth that reports its failures.
#pragma once

#include "engine/surface_fixture.h"

static const wisp_vec3 EARTH = { 0.0f, -9.81f, 0.0f };

/// Columns x rows vertices in the plane z = 0 that hang down from row 0: vertex j columns + i at (i dx, -j dy, 0).
/// Right triangles, diagonals alternating.
static inline test_mesh hanging_mesh( int columns, int rows, float dx, float dy )
{
    test_mesh m = { calloc( (size_t)( columns * rows ), sizeof( wisp_vec3 ) ),
                    calloc( (size_t)( 6 * ( columns - 1 ) * ( rows - 1 ) ), sizeof( int32_t ) ), columns * rows, 0 };
    assert_non_null( m.points );
    assert_non_null( m.triangles );
    for ( int v = 0; v < columns * rows; ++v )
    {
        m.points[v] = ( wisp_vec3 ){ (float)( v % columns ) * dx, (float)( v / columns ) * -dy, 0.0f };
    }
    for ( int j = 0; j + 1 < rows; ++j )
    {
        for ( int i = 0; i + 1 < columns; ++i )
        {
            int a = j * columns + i, b = a + 1, c = a + columns, d = c + 1;
            const int32_t even[6] = { a, c, d, a, d, b }, odd[6] = { a, c, b, b, c, d };
            memcpy( m.triangles + 3 * (size_t)m.triangle_count, ( i + j ) % 2 == 0 ? even : odd, sizeof( even ) );
            m.triangle_count += 2;
        }
    }
    return m;
}

/// One triangle.
static inline test_mesh triangle_mesh( wisp_vec3 a, wisp_vec3 b, wisp_vec3 c )
{
    test_mesh m = { calloc( 3, sizeof( wisp_vec3 ) ), calloc( 3, sizeof( int32_t ) ), 3, 1 };
    assert_non_null( m.points );
    assert_non_null( m.triangles );
    const wisp_vec3 points[3] = { a, b, c };
    const int32_t corners[3] = { 0, 1, 2 };
    memcpy( m.points, points, sizeof( points ) );
    memcpy( m.triangles, corners, sizeof( corners ) );
    return m;
}

/// A cloth whose points and statistics are requested.
static inline wisp_entity add_cloth( wisp_world* world, const wisp_fabric_def* fabric, wisp_surface_def surface,
                                     const wisp_cloth_def* cloth, wisp_vec3 gravity )
{
    wisp_entity e = test_surface_of( world, fabric, surface );
    assert_status( world, wisp_set_cloth( world, e, cloth ), WISP_OK );
    assert_status( world, wisp_set_gravity( world, e, gravity ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_SURFACE_POINTS ), WISP_OK );
    assert_status( world, wisp_request( world, e, WISP_MOTION_STATS ), WISP_OK );
    return e;
}

/// Velocity of a vertex in the user's order, readable and writable.
static inline float* velocity_of( wisp_world* world, wisp_entity e, int vertex )
{
    float* column = wisp_world_column( world, e, WISP_PARTICLE_VELOCITY, 0 );
    assert_non_null( column );
    return column + (size_t)wisp_world_fabric( world, e )->vertex_slot[vertex] * 4;
}

/// All coordinates of all vertices are finite.
static inline bool is_finite( wisp_world* world, wisp_entity e )
{
    wisp_view view = view_of( world, e, WISP_SURFACE_POINTS );
    for ( int v = 0; v < view.count; ++v )
    {
        const wisp_vec3 p = ( (const wisp_vec3*)view.data )[v];
        if ( !( isfinite( p.x ) && isfinite( p.y ) && isfinite( p.z ) ) )
        {
            return false;
        }
    }
    return true;
}

static inline int count_passes_named( wisp_world* world, const char* pass )
{
    int count = 0;
    wisp_profile profile = wisp_world_profile( world );
    for ( int i = 0; i < profile.count; ++i )
    {
        count += strcmp( profile.lines[i].pass, pass ) == 0 ? 1 : 0;
    }
    return count;
}

static inline void assert_within( double found, double expected, double tolerance )
{
    if ( !( fabs( found - expected ) <= tolerance ) )
    {
        fail_msg( "%.9g is not %.9g within %g", found, expected, tolerance );
    }
}

static inline float distance( wisp_vec3 a, wisp_vec3 b )
{
    const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
    return sqrtf( x * x + y * y + z * z );
}
