/// Measures of clumping for strands that all have the same number of vertices.
#pragma once

#include "unit.h"

#include "oracle/double3.h"

typedef struct clumping
{
    int locks;          ///< sets of strands that run side by side; a strand alone is one
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

/// Whether most vertices of a strand, its root left out, are nearer to another strand than half of the distance that roots
/// have. A threshold that roots fulfil joins all strands before any clumping.
static inline bool runs_along( const double3* strand, const double3* other, int length, double spacing )
{
    int near = 0;
    for ( int i = 1; i < length; ++i )
    {
        double nearest = INFINITY;
        for ( int k = 0; k < length; ++k )
        {
            nearest = fmin( nearest, double3_distance( strand[i], other[k] ) );
        }
        near += nearest < spacing / 2.0;
    }
    return 2 * near > length - 1;
}

static inline int count_locks( const double3* p, int strand_count, int length, double spacing )
{
    SCOPED( free_local ) int* parent = checked_malloc( (size_t)strand_count * sizeof( int ) );
    int locks = 0;
    for ( int s = 0; s < strand_count; ++s )
    {
        parent[s] = s;
        for ( int q = 0; q < s; ++q )
        {
            const double3 *a = p + s * length, *b = p + q * length;
            if ( runs_along( a, b, length, spacing ) && runs_along( b, a, length, spacing ) )
            {
                parent[root_of( parent, q )] = root_of( parent, s );
            }
        }
    }
    for ( int s = 0; s < strand_count; ++s )
    {
        locks += root_of( parent, s ) == s;
    }
    return locks;
}

/// @param spacing m, between neighbouring roots
static inline clumping measure_clumping( const double3* p, int vertex_count, int length, double spacing )
{
    clumping result = { count_locks( p, vertex_count / length, length, spacing ), 0.0, INFINITY };
    int moving = 0;
    for ( int v = 0; v < vertex_count; ++v )
    {
        if ( v % length == 0 )
        {
            continue;
        }
        double nearest = INFINITY;
        for ( int q = 0; q < vertex_count; ++q )
        {
            nearest = v / length == q / length ? nearest : fmin( nearest, double3_distance( p[v], p[q] ) );
        }
        result.mean_gap += nearest;
        result.nearest_gap = fmin( result.nearest_gap, nearest );
        moving += 1;
    }
    result.mean_gap /= moving;
    return result;
}
