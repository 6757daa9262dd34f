/// Edges that intersect triangles: exact for any finite floats.
#pragma once

#include "wisp/module/aabb_pairs.h"

WISP_BEGIN_C

/// @return true if the segment p q passes through the triangle a b c: its ends strictly on both sides of the plane, its line
/// strictly within the three edges. Exact; touching is no intersection
/// @param p, q, a, b, c three floats each, finite
WISP_API bool wisp_segment_intersects( const float* p, const float* q, const float* a, const float* b,
                                       const float* c );

typedef struct wisp_intersection
{
    int32_t edge, triangle;
} wisp_intersection;

/// Edges and triangles over shared points.
typedef struct wisp_intersection_args
{
    const float*
        xyzw; ///< [point][4] x, y, z in m; the fourth is ignored. Points that are not finite intersect nothing
    const int32_t* edges; ///< [edge_count][2] points
    int edge_count;
    const int32_t* triangles; ///< [triangle_count][3] points
    int triangle_count;
    const wisp_kernels* kernels; ///< null: scalar C, with the same result
} wisp_intersection_args;

/// Zero-initialised is empty.
typedef struct wisp_intersections
{
    int count;
    const wisp_intersection* list; ///< [count] by edge, then by triangle. Pairs that share a point are left out
    wisp_aabb_pairs pairs;
    wisp_buffer buffers[4];
} wisp_intersections;

/// @return WISP_NO_MEMORY
WISP_API wisp_status wisp_intersections_find( wisp_intersections* intersections, const wisp_parallel* parallel,
                                              const wisp_intersection_args* args, wisp_error* error );
WISP_API void wisp_intersections_release( wisp_intersections* intersections, const wisp_allocator* allocator );
/// @return bytes that it holds of its allocator
WISP_API size_t wisp_intersections_bytes( const wisp_intersections* intersections );

WISP_END_C
