// Points of a strand at any arc length, so that a ghost may have another number of vertices than its target.
#include "guide_internal.h"

#include <math.h>

static double segment_length( const wisp_vec3* points, int end )
{
    const guide_point d = guide_sub( guide_widen( points[end] ), guide_widen( points[end - 1] ) );
    return sqrt( guide_dot( d, d ) );
}

void guide_arc( const wisp_vec3* points, int count, double* arc )
{
    double length = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        length += i > 0 ? segment_length( points, i ) : 0.0;
        arc[i] = length;
    }
    for ( int i = 1; i < count; ++i )
    {
        arc[i] = length > 0.0 ? arc[i] / length : (double)i / ( count - 1 );
    }
}

// Add `weight` times the Catmull-Rom tangent of a vertex: the mean of the differences at both sides, one at an end.
static void add_tangent( guide_stencil* stencil, int first, int vertex, int count, double weight )
{
    const int before = vertex > 0 ? vertex - 1 : 0, after = vertex < count - 1 ? vertex + 1 : count - 1;
    weight /= after - before;
    stencil->weight[after - first] += weight;
    stencil->weight[before - first] -= weight;
}

guide_stencil guide_spline_stencil( const wisp_vec3* points, int count, double arc )
{
    guide_stencil stencil = { { 0, 0, 0, 0 }, { 1.0, 0.0, 0.0, 0.0 } };
    if ( count < 2 )
    {
        return stencil;
    }

    // last segment that begins at or before the place
    int segment = 0;
    double length = 0.0, begin = 0.0, walked = 0.0;
    for ( int i = 1; i < count; ++i )
    {
        length += segment_length( points, i );
    }
    for ( int i = 0; i < count - 1 && walked <= arc * length; ++i )
    {
        segment = i;
        begin = walked;
        walked += segment_length( points, i + 1 );
    }
    const double extent = segment_length( points, segment + 1 );
    const double u = extent > 0.0 ? fmin( 1.0, ( arc * length - begin ) / extent ) : 0.0, u2 = u * u, u3 = u2 * u;

    // Hermite between the segment's ends; slots outside the strand repeat its ends with weight 0
    const int first = segment - 1;
    for ( int n = 0; n < 4; ++n )
    {
        const int vertex = first + n;
        stencil.vertex[n] = vertex < 0 ? 0 : vertex < count ? vertex : count - 1;
        stencil.weight[n] = 0.0;
    }
    stencil.weight[1] = 2.0 * u3 - 3.0 * u2 + 1.0;
    stencil.weight[2] = 3.0 * u2 - 2.0 * u3;
    add_tangent( &stencil, first, segment, count, u3 - 2.0 * u2 + u );
    add_tangent( &stencil, first, segment + 1, count, u3 - u2 );
    return stencil;
}

guide_point guide_gather( const guide_stencil* stencil, const wisp_vec3* points )
{
    guide_point sum = { 0.0, 0.0, 0.0 };
    for ( int n = 0; n < 4; ++n )
    {
        sum = guide_mul_add( sum, stencil->weight[n], guide_widen( points[stencil->vertex[n]] ) );
    }
    return sum;
}
