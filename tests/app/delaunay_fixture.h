/// Properties of every triangulation of an outline, checked by the definition, independently of the tested code.
#pragma once

#include "mesh_fixture.h"

#include "delaunay.h"

__extension__ typedef __int128 fixture_wide;

/// Twice the area, counter-clockwise positive. Differences are below 2^26 in size, products below 2^52.
static inline int64_t fixture_turn( delaunay_point a, delaunay_point b, delaunay_point c )
{
    return (int64_t)( b.x - a.x ) * ( c.y - a.y ) - (int64_t)( c.x - a.x ) * ( b.y - a.y );
}

/// Whether p is inside the circle around the counter-clockwise triangle a b c: the determinant of the rows (x, y, x^2
/// + y^2) of b, c and p relative to a. Below 3 * 2^26 * 2^26 * 2^53 * 2, which is below 2^108.
static inline bool fixture_in_circle( delaunay_point a, delaunay_point b, delaunay_point c, delaunay_point p )
{
    const delaunay_point seen[] = { b, c, p };
    fixture_wide x[3], y[3], z[3];
    for ( int i = 0; i < 3; ++i )
    {
        x[i] = seen[i].x - a.x;
        y[i] = seen[i].y - a.y;
        z[i] = x[i] * x[i] + y[i] * y[i];
    }
    return x[0] * ( y[1] * z[2] - y[2] * z[1] ) - y[0] * ( x[1] * z[2] - x[2] * z[1] ) +
               z[0] * ( x[1] * y[2] - x[2] * y[1] ) <
           0;
}

/// Whether two segments cross in a point inside of both.
static inline bool fixture_cross( delaunay_point a, delaunay_point b, delaunay_point c, delaunay_point d )
{
    int64_t ca = fixture_turn( a, b, c ), da = fixture_turn( a, b, d );
    int64_t ac = fixture_turn( c, d, a ), bc = fixture_turn( c, d, b );
    return ( ( ca > 0 && da < 0 ) || ( ca < 0 && da > 0 ) ) && ( ( ac > 0 && bc < 0 ) || ( ac < 0 && bc > 0 ) );
}

/// A triangulation to check. The outline is the first points.
typedef struct fixture_net
{
    const delaunay_point* points;
    int count, outline_count;
    const int32_t* triangles;
    int triangle_count;
} fixture_net;

static inline delaunay_point fixture_corner( const fixture_net* n, int t, int k )
{
    return n->points[n->triangles[3 * t + k % 3]];
}

/// The areas sum to that of the outline and none is reversed: they cover it once, without holes and without overlap.
static inline void assert_covers( const fixture_net* n )
{
    fixture_wide outline = 0, sum = 0;
    for ( int i = 0; i < n->outline_count; ++i )
    {
        delaunay_point p = n->points[i], q = n->points[( i + 1 ) % n->outline_count];
        outline += (int64_t)p.x * q.y - (int64_t)q.x * p.y;
    }
    for ( int t = 0; t < n->triangle_count; ++t )
    {
        int64_t area =
            fixture_turn( fixture_corner( n, t, 0 ), fixture_corner( n, t, 1 ), fixture_corner( n, t, 2 ) );
        assert_true( area > 0 );
        sum += area;
    }
    assert_true( sum == outline );
}

typedef struct fixture_edge
{
    int32_t lower, upper, triangle, apex;
    bool rises; // runs from low to high
} fixture_edge;

static inline int fixture_compare_edges( const void* left, const void* right )
{
    const fixture_edge *a = left, *b = right;
    return a->lower != b->lower ? ( a->lower < b->lower ? -1 : 1 ) : a->upper < b->upper ? -1 : a->upper > b->upper;
}

/// Every inner edge occurs once in each direction, and every edge of the outline once, in its direction. No point
/// across an edge is in the circle of the triangle on this side, which for all inner edges is equivalent to
/// constrained Delaunay (Lee and Lin 1986). Vertices, edges and triangles satisfy Euler's formula.
static inline void assert_joined_and_delaunay( const fixture_net* n )
{
    size_t halves = 3 * (size_t)n->triangle_count;
    SCOPED( free_local ) fixture_edge* edges = checked_malloc( halves * sizeof *edges );
    for ( int h = 0; h < (int)halves; ++h )
    {
        int32_t p = n->triangles[h], q = n->triangles[h - h % 3 + ( h + 1 ) % 3];
        assert_true( p >= 0 && p < n->count && q >= 0 && q < n->count && p != q );
        edges[h] =
            ( fixture_edge ){ p < q ? p : q, p < q ? q : p, h / 3, n->triangles[h - h % 3 + ( h + 2 ) % 3], p < q };
    }
    qsort( edges, halves, sizeof *edges, fixture_compare_edges );
    int edge_count = 0, border_count = 0;
    for ( size_t i = 0; i < halves; ++edge_count )
    {
        const fixture_edge *e = &edges[i], *other = e + 1;
        bool is_pair = i + 1 < halves && fixture_compare_edges( e, other ) == 0;
        if ( is_pair )
        {
            assert_true( e->rises != other->rises );
            assert_false( fixture_in_circle( fixture_corner( n, e->triangle, 0 ), fixture_corner( n, e->triangle, 1 ),
                                             fixture_corner( n, e->triangle, 2 ), n->points[other->apex] ) );
        }
        else
        {
            int32_t from = e->rises ? e->lower : e->upper, to = e->rises ? e->upper : e->lower;
            assert_true( from < n->outline_count && to == ( from + 1 ) % n->outline_count );
            ++border_count;
        }
        i += is_pair ? 2 : 1;
    }
    assert_int_equal( border_count, n->outline_count );
    assert_int_equal( n->count - edge_count + n->triangle_count, 1 );
}

/// Whether the outline separates a triangle's centre from a point. Scaled by three, the centre has integer
/// coordinates; differences are then below 2^28.
static inline bool fixture_is_hidden( const fixture_net* n, int t, delaunay_point p )
{
    delaunay_point middle = { 0, 0 };
    for ( int k = 0; k < 3; ++k )
    {
        middle.x += fixture_corner( n, t, k ).x;
        middle.y += fixture_corner( n, t, k ).y;
    }
    p = ( delaunay_point ){ 3 * p.x, 3 * p.y };
    for ( int i = 0; i < n->outline_count; ++i )
    {
        delaunay_point a = n->points[i], b = n->points[( i + 1 ) % n->outline_count];
        if ( fixture_cross( middle, p, ( delaunay_point ){ 3 * a.x, 3 * a.y },
                            ( delaunay_point ){ 3 * b.x, 3 * b.y } ) )
        {
            return true;
        }
    }
    return false;
}

/// Every triangle against every point: only points hidden by the outline may be inside a circle.
/// @return number of hidden points
static inline int assert_empty_circles( const fixture_net* n )
{
    int hidden = 0;
    for ( int t = 0; t < n->triangle_count; ++t )
    {
        delaunay_point a = fixture_corner( n, t, 0 ), b = fixture_corner( n, t, 1 ), c = fixture_corner( n, t, 2 );
        for ( int v = 0; v < n->count; ++v )
        {
            if ( fixture_in_circle( a, b, c, n->points[v] ) )
            {
                assert_true( fixture_is_hidden( n, t, n->points[v] ) );
                ++hidden;
            }
        }
    }
    return hidden;
}
