/// Meshes shared by the mesh tests.
#pragma once

#include "unit.h"

#include "mesh.h"

/// A mesh with memory of its own, so that it may be repaired and released.
static inline wisp_mesh fixture_mesh( const wisp_vec3* points, int vertex_count, const int32_t* triangles,
                                      int triangle_count )
{
    wisp_mesh mesh = { .points = malloc( (size_t)vertex_count * sizeof *points ),
                       .triangles = malloc( (size_t)triangle_count * 3 * sizeof *triangles ),
                       .vertex_count = vertex_count,
                       .triangle_count = triangle_count };
    assert_non_null( mesh.points );
    assert_non_null( mesh.triangles );
    memcpy( mesh.points, points, (size_t)vertex_count * sizeof *points );
    memcpy( mesh.triangles, triangles, (size_t)triangle_count * 3 * sizeof *triangles );
    return mesh;
}

/// The origin and the three unit vectors.
static const wisp_vec3 fixture_corners[] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

/// Outward.
static const int32_t fixture_tetrahedron_faces[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };

/// Closed, outward, a sixth of a cubic metre.
static inline wisp_mesh fixture_tetrahedron( void )
{
    return fixture_mesh( fixture_corners, 4, fixture_tetrahedron_faces, 4 );
}

static inline wisp_mesh fixture_made( const wisp_mesh_generator* generator )
{
    wisp_mesh mesh;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_generate( generator, &mesh, &error ), error );
    return mesh;
}

static inline wisp_mesh_diagnostics fixture_report( const wisp_mesh* mesh )
{
    wisp_mesh_diagnostics report;
    wisp_error error = { .status = WISP_OK };
    assert_ok( wisp_mesh_examine( mesh, &report, &error ), error );
    return report;
}

static inline void assert_same_mesh( const wisp_mesh* a, const wisp_mesh* b )
{
    assert_int_equal( a->vertex_count, b->vertex_count );
    assert_int_equal( a->triangle_count, b->triangle_count );
    assert_memory_equal( a->points, b->points, (size_t)a->vertex_count * sizeof *a->points );
    assert_memory_equal( a->triangles, b->triangles, (size_t)a->triangle_count * 3 * sizeof *a->triangles );
}
