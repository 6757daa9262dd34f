/// Flat meshes and their copies rolled up, for tests of distances along a mesh.
#pragma once

#include "fabric_fixture.h"

/// A plane of any triangulation: `jitter` of a cell, at most 0.24, moves inner vertices, `squash` scales z, diagonals
/// are random when there is jitter.
static inline test_mesh test_mesh_uneven_plane( int width, int height, float jitter, float squash )
{
    test_mesh mesh = test_mesh_plane( width, height );
    int next = 0;
    for ( int y = 0; y < height && jitter > 0.0f; ++y )
    {
        for ( int x = 0; x < width; ++x )
        {
            int v = y * width + x;
            bool inner_x = x > 0 && x + 1 < width, inner_y = y > 0 && y + 1 < height;
            mesh.points[v].x += inner_x ? test_random_float( v, 3, -jitter, jitter ) : 0.0f;
            mesh.points[v].z += inner_y ? test_random_float( v, 4, -jitter, jitter ) : 0.0f;
            if ( x + 1 < width && y + 1 < height )
            {
                test_mesh_cell( &mesh, &next, v, v + 1, v + width + 1, v + width, test_random( v, 5, 2 ) == 0 );
            }
        }
    }
    for ( int v = 0; v < mesh.vertex_count; ++v )
    {
        mesh.points[v].z *= squash;
    }
    return mesh;
}

/// Roll a regular plane about the z axis, so that each cell bends by `angle` and distances along it stay: its flat
/// points become the points of a prism. The flat points are returned, [vertex_count], to be freed.
static inline wisp_vec3* test_mesh_roll( test_mesh* mesh, double angle )
{
    size_t bytes = (size_t)mesh->vertex_count * sizeof( wisp_vec3 );
    wisp_vec3* flat = checked_malloc( bytes );
    memcpy( flat, mesh->points, bytes );
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        double x = 0.0, y = 0.0;
        for ( int cell = 0; cell < (int)flat[v].x; ++cell )
        {
            x += cos( angle * cell );
            y += sin( angle * cell );
        }
        mesh->points[v] = ( wisp_vec3 ){ (float)x, (float)y, flat[v].z };
    }
    return flat;
}

/// Join two meshes; both are freed.
static inline test_mesh test_mesh_join( test_mesh a, test_mesh b )
{
    test_mesh both = test_mesh_make( a.vertex_count + b.vertex_count, a.triangle_count + b.triangle_count );
    memcpy( both.points, a.points, (size_t)a.vertex_count * sizeof( wisp_vec3 ) );
    memcpy( both.points + a.vertex_count, b.points, (size_t)b.vertex_count * sizeof( wisp_vec3 ) );
    memcpy( both.triangles, a.triangles, 3 * (size_t)a.triangle_count * sizeof( int32_t ) );
    for ( int i = 0; i < 3 * b.triangle_count; ++i )
    {
        both.triangles[3 * a.triangle_count + i] = b.triangles[i] + a.vertex_count;
    }
    test_mesh_free( &a );
    test_mesh_free( &b );
    return both;
}
