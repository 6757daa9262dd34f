/// A mesh as a user provides it.
#pragma once

#include "unit.h"

#include "wisp/fabric.h"

typedef struct test_mesh
{
    wisp_vec3* points;
    int32_t* triangles;
    int vertex_count, triangle_count;
} test_mesh;

/// Zeros. Free with test_mesh_free().
static inline test_mesh test_mesh_make( int vertex_count, int triangle_count )
{
    return ( test_mesh ){
        .points = checked_calloc( (size_t)vertex_count + 1, sizeof( wisp_vec3 ) ),
        .triangles = checked_calloc( 3 * (size_t)triangle_count + 1, sizeof( int32_t ) ),
        .vertex_count = vertex_count,
        .triangle_count = triangle_count,
    };
}

static inline void test_mesh_free( test_mesh* mesh )
{
    free( mesh->points );
    free( mesh->triangles );
}

static inline wisp_fabric_def test_fabric_def( const test_mesh* mesh )
{
    wisp_fabric_def def = wisp_default_fabric_def();
    def.points = mesh->points;
    def.triangles = mesh->triangles;
    def.vertex_count = mesh->vertex_count;
    def.triangle_count = mesh->triangle_count;
    return def;
}
