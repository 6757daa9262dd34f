/// Triangles of a surface as elastic constraints, in the order in which they are projected, with their rest shapes.
#pragma once

#include "wisp/fabric.h"
#include "wisp/module/surface_kernels.h"

WISP_BEGIN_C

typedef struct wisp_elastic_triangles wisp_elastic_triangles;

/// @param with_stress room for the stress of a substep, which several iterations need
/// @param out receives the triangles of a fabric, null on failure
WISP_API wisp_status wisp_elastic_triangles_create( const wisp_fabric* fabric, bool with_stress,
                                                    const wisp_allocator* allocator, wisp_elastic_triangles** out );
WISP_API void wisp_elastic_triangles_release( wisp_elastic_triangles* mesh, const wisp_allocator* allocator );
/// @return bytes that it holds; 0 of null
WISP_API size_t wisp_elastic_triangles_bytes( const wisp_elastic_triangles* mesh );
/// @return tiles of triangles that can run in parallel; valid as long as the mesh
WISP_API const wisp_schedule* wisp_elastic_triangles_order( const wisp_elastic_triangles* mesh );
/// @return arguments of the kernels with slots, shapes and stress; the caller adds the rest
WISP_API wisp_elastic_triangle_args wisp_elastic_triangles_args( const wisp_elastic_triangles* mesh );

WISP_END_C
