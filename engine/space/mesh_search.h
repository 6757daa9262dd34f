/// Common interface of mesh searches. A search proposes triangles in any order, possibly repeatedly. The smallest
/// pair of distance (or time) and triangle index is selected, so the order does not matter.
#pragma once

#include "mesh_surface.h"

/// Margins, relative and in metres, by which a search extends beyond the best distance so far.
#define SEARCH_SLACK 1e-6
#define MESH_WIDENING                                                                                                \
    4e-6 // of boxes, relative to the mesh's largest coordinate: more than the rounding of a distance to a box
#define MIN_SEARCH_SLACK 1e-18 // its square is a normal float
/// Length by which a path extends beyond its first intersection and the box of the mesh, relative to the mesh's
/// largest coordinate.
#define SEARCH_PATH_SLACK 1e-5
/// m, larger than any distance in range.
#define SEARCH_FARTHEST 4e9

/// State of a closest-triangle query. Initialise with mesh_closest_begin(); zero is not a valid query.
typedef struct mesh_closest
{
    const mesh_surface* surface;
    double3 point;
    double time;      ///< of the motion of the mesh
    int32_t triangle; ///< -1 until one is found
    uint64_t tested;
    double measured;       ///< m^2, of the triangle that was tested last
    triangle_nearest best; ///< squared is that of the radius until a triangle is found
} mesh_closest;

static inline mesh_closest mesh_closest_begin( const mesh_surface* surface, const wisp_mesh_query* query )
{
    double radius = fmin( (double)query->radius, SEARCH_FARTHEST );
    return ( mesh_closest ){ .surface = surface,
                             .point = double3_widen( query->point ),
                             .time = surface->start != NULL ? (double)query->time : 0.0,
                             .triangle = -1,
                             .best = { .squared = radius * radius } };
}

/// Return the distance in m beyond which triangles need not be proposed.
static inline double mesh_closest_radius( const mesh_closest* search )
{
    return sqrt( search->best.squared ) * ( 1.0 + SEARCH_SLACK ) + MIN_SEARCH_SLACK;
}

/// Test a triangle.
/// @return whether it is the best so far
static inline bool mesh_closest_propose( mesh_closest* search, int32_t triangle )
{
    triangle_corners t = mesh_surface_triangle( search->surface, triangle, search->time );
    triangle_nearest nearest;
    triangle_find_nearest( &nearest, &t, search->point );
    ++search->tested;
    search->measured = nearest.squared;
    bool is_closer = nearest.squared < search->best.squared;
    bool is_first =
        nearest.squared == search->best.squared && ( search->triangle < 0 || triangle < search->triangle );
    if ( is_closer || is_first )
    {
        search->best = nearest;
        search->triangle = triangle;
    }
    return is_closer || is_first;
}

/// State of a query for the first intersection of a path with a length above 0.
typedef struct mesh_cast
{
    const mesh_surface* surface;
    double3 from, to;
    double begin_time, end_time; ///< of the motion of the mesh
    double length;               ///< m
    double slack;                ///< m, intersections farther than this behind the best need not be proposed
    int32_t triangle;            ///< -1 until one is found
    uint64_t tested;
    triangle_intersection best;
} mesh_cast;

static inline mesh_cast mesh_cast_begin( const mesh_surface* surface, const wisp_mesh_path* path )
{
    double3 from = double3_widen( path->from ), to = double3_widen( path->to ), step = double3_sub( to, from );
    return ( mesh_cast ){ .surface = surface,
                          .from = from,
                          .to = to,
                          .begin_time = (double)path->begin_time,
                          .end_time = (double)path->end_time,
                          .length = double3_length( step ),
                          .slack = SEARCH_PATH_SLACK * surface->largest + MIN_SEARCH_SLACK,
                          .triangle = -1 };
}

/// Test a triangle.
/// @return whether it is the best so far
static inline bool mesh_cast_propose( mesh_cast* search, int32_t triangle )
{
    const mesh_surface* s = search->surface;
    const triangle_corners end = mesh_surface_triangle( s, triangle, search->end_time );
    const bool moves = s->start != NULL && search->begin_time != search->end_time;
    const triangle_corners begin = moves ? mesh_surface_triangle( s, triangle, search->begin_time ) : end;
    triangle_intersection intersection;
    ++search->tested;
    if ( moves ? !triangle_sweep( &begin, &end, search->from, search->to, &intersection )
               : !triangle_cross( &end, search->from, search->to, &intersection ) )
    {
        return false;
    }
    bool is_first = search->triangle < 0 || intersection.time < search->best.time ||
                    ( intersection.time == search->best.time && triangle < search->triangle );
    if ( is_first )
    {
        search->triangle = triangle;
        search->best = intersection;
    }
    return is_first;
}

/// Clip a path to the box of its mesh, over the whole motion; the result is in fractions of the path.
/// @return false if they do not meet
static inline bool mesh_cast_clip( const mesh_cast* search, double* begin, double* end )
{
    const mesh_surface* s = search->surface;
    const double from[3] = { search->from.x, search->from.y, search->from.z };
    const double to[3] = { search->to.x, search->to.y, search->to.z };
    *begin = 0.0;
    *end = 1.0;
    for ( int k = 0; k < 3; ++k )
    {
        double first = (double)s->lower[k] - search->slack - from[k];
        double last = (double)s->upper[k] + search->slack - from[k], step = to[k] - from[k];
        if ( step == 0.0 )
        {
            *end = first > 0.0 || last < 0.0 ? -1.0 : *end;
            continue;
        }
        *begin = fmax( *begin, ( step > 0.0 ? first : last ) / step );
        *end = fmin( *end, ( step > 0.0 ? last : first ) / step );
    }
    return *begin <= *end;
}
