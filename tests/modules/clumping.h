/// Measures of clumping for strands that all have the same number of vertices.
#pragma once

#include "unit.h"

#include "oracle/double3.h"

typedef struct clumping
{
    int clusters;       ///< sets of vertices joined by distances below h/2 between strands
    double mean_gap;    ///< m, mean over moving vertices of the distance to the nearest vertex of another strand
    double nearest_gap; ///< m, the smallest of these
} clumping;

static inline int root_of( int* parent, int v )
{
    while ( parent[v] != v )
    {
        parent[v] = parent[parent[v]];
        v = parent[v];
    }
    return v;
}

static inline clumping measure_clumping( const double3* p, int vertex_count, int strand_length, double h )
{
    clumping result = { 0, 0.0, INFINITY };
    int* parent = checked_malloc( (size_t)vertex_count * sizeof( int ) );
    for ( int v = 0; v < vertex_count; ++v )
    {
        parent[v] = v;
    }
    int moving = 0;
    for ( int v = 0; v < vertex_count; ++v )
    {
        double nearest = INFINITY;
        for ( int q = 0; q < vertex_count; ++q )
        {
            double r = v / strand_length == q / strand_length ? INFINITY : double3_distance( p[v], p[q] );
            nearest = fmin( nearest, r );
            if ( r < h / 2.0 )
            {
                parent[root_of( parent, q )] = root_of( parent, v );
            }
        }
        if ( v % strand_length > 0 )
        {
            result.mean_gap += nearest;
            result.nearest_gap = fmin( result.nearest_gap, nearest );
            moving += 1;
        }
    }
    for ( int v = 0; v < vertex_count; ++v )
    {
        result.clusters += root_of( parent, v ) == v;
    }
    result.mean_gap /= moving;
    free( parent );
    return result;
}
