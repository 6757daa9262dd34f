/// Shared by all searches of a mesh. A search proposes triangles, in any order and repeatedly; here the smallest pair of distance
/// (or time) and number wins, so the order does not matter.
#pragma once

#include "mesh_surface.h"

/// Margin, relative and in metres, by which a search goes beyond the best distance so far.
#define SEARCH_SLACK 1e-6
#define MIN_SEARCH_SLACK 1e-18 // its square is still a normal float
/// Of the mesh's largest coordinate: by so much a path outlasts its first intersection and the box around the mesh.
#define SEARCH_PATH_SLACK 1e-5
/// m, beyond any distance within the reach.
#define SEARCH_FARTHEST 4e9

/// One question for the closest triangle. Zero is no question: see mesh_closest_begin().
typedef struct mesh_closest
{
    const mesh_surface* surface;
    double3 point;
    int32_t triangle; ///< -1 while nothing is found
    uint64_t tested;
    triangle_nearest best; ///< while nothing is found, squared is that of the radius
} mesh_closest;

static inline mesh_closest mesh_closest_begin( const mesh_surface* surface, const wisp_mesh_query* query )
{
    double radius = fmin( (double)query->radius, SEARCH_FARTHEST );
    return ( mesh_closest ){ .surface = surface,
                             .point = double3_widen( query->point ),
                             .triangle = -1,
                             .best = { .squared = radius * radius } };
}

/// m: triangles farther away than this need not be proposed any more.
static inline double mesh_closest_radius( const mesh_closest* search )
{
    return sqrt( search->best.squared ) * ( 1.0 + SEARCH_SLACK ) + MIN_SEARCH_SLACK;
}

/// @return whether the triangle is the answer for the time being
static inline bool mesh_closest_propose( mesh_closest* search, int32_t triangle )
{
    triangle_corners t = triangle_load( search->surface->xyzw, search->surface->triangles, triangle );
    triangle_nearest nearest;
    triangle_find_nearest( &nearest, &t, search->point );
    ++search->tested;
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

/// One question for the first intersection of a path that has a length.
typedef struct mesh_cast
{
    const mesh_surface* surface;
    double3 from, to;
    double length;    ///< m
    double slack;     ///< m: intersections so far behind the best need not be proposed any more
    int32_t triangle; ///< -1 while nothing is found
    uint64_t tested;
    triangle_intersection best;
} mesh_cast;

static inline mesh_cast mesh_cast_begin( const mesh_surface* surface, const wisp_mesh_path* path )
{
    double3 from = double3_widen( path->from ), to = double3_widen( path->to ), step = double3_sub( to, from );
    return ( mesh_cast ){ .surface = surface,
                          .from = from,
                          .to = to,
                          .length = sqrt( double3_dot( step, step ) ),
                          .slack = SEARCH_PATH_SLACK * surface->largest + MIN_SEARCH_SLACK,
                          .triangle = -1 };
}

/// @return whether the triangle is the answer for the time being
static inline bool mesh_cast_propose( mesh_cast* search, int32_t triangle )
{
    triangle_corners t = triangle_load( search->surface->xyzw, search->surface->triangles, triangle );
    triangle_intersection intersection;
    ++search->tested;
    if ( !triangle_cross( &t, search->from, search->to, &intersection ) )
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

/// The part of a path that runs through a box, as fractions. @return false if there is none
static inline bool mesh_cast_clip( const mesh_cast* search, const double lower[3], const double upper[3],
                                   double* begin, double* end )
{
    const double from[3] = { search->from.x, search->from.y, search->from.z };
    const double to[3] = { search->to.x, search->to.y, search->to.z };
    *begin = 0.0;
    *end = 1.0;
    for ( int k = 0; k < 3; ++k )
    {
        double first = lower[k] - from[k], last = upper[k] - from[k], step = to[k] - from[k];
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
