/// Queries of one triangle: closest point, and intersection with a path. Inputs are floats, intermediate values are
/// doubles. Values of a shared edge or corner are computed from its own points, in the order of their indices, so
/// that both triangles get the same bits.
#pragma once

#include "wisp/module/double3.h"

/// Minimum squared sine of an angle of a triangle with a normal; below it the triangle counts as a line.
#define TRIANGLE_FLAT 1e-20

/// Corners of a triangle.
typedef struct triangle_corners
{
    const int32_t* number; ///< [3]
    double3 at[3];
} triangle_corners;

/// @param quads [point][4]
/// @param triangles [triangle][3]
static inline triangle_corners triangle_load( const float* xyzw, const int32_t* triangles, int32_t triangle )
{
    const int32_t* number = triangles + 3 * (size_t)triangle;
    return ( triangle_corners ){ number,
                                 { double3_from( xyzw + 4 * (size_t)number[0] ),
                                   double3_from( xyzw + 4 * (size_t)number[1] ),
                                   double3_from( xyzw + 4 * (size_t)number[2] ) } };
}

/// Compute the area vector times two, or zero if the triangle is degenerate.
static inline double3 triangle_normal( const triangle_corners* t )
{
    double3 ab = double3_sub( t->at[1], t->at[0] ), ac = double3_sub( t->at[2], t->at[0] );
    double3 n = double3_cross( ab, ac );
    bool is_flat = double3_dot( n, n ) <= TRIANGLE_FLAT * ( double3_dot( ab, ab ) * double3_dot( ac, ac ) );
    return is_flat ? ( double3 ){ 0.0, 0.0, 0.0 } : n;
}

/// Closest point of a triangle to another point.
typedef struct triangle_nearest
{
    double squared; ///< m^2, squared distance
    double3 point;
    double weights[3];
    int32_t first, second; ///< indices of the edge that contains the point, first < second; second is -1 for a
                           ///< corner, both are -1 for a face
} triangle_nearest;

static inline void triangle_measure( triangle_nearest* n, double3 p )
{
    double3 away = double3_sub( p, n->point );
    n->squared = double3_dot( away, away );
}

static inline void triangle_at_corner( triangle_nearest* n, const triangle_corners* t, int i, double3 p )
{
    *n = ( triangle_nearest ){ .point = t->at[i], .first = t->number[i], .second = -1 };
    n->weights[i] = 1.0;
    triangle_measure( n, p );
}

static inline void triangle_at_edge( triangle_nearest* n, const triangle_corners* t, int i, int j, double3 p )
{
    int lower = t->number[i] < t->number[j] ? i : j, upper = i + j - lower;
    double3 along = double3_sub( t->at[upper], t->at[lower] );
    double run = double3_dot( double3_sub( p, t->at[lower] ), along ), squared = double3_dot( along, along );
    if ( !( run > 0.0 ) || run >= squared )
    {
        triangle_at_corner( n, t, run > 0.0 ? upper : lower, p );
        return;
    }
    double s = run / squared;
    *n = ( triangle_nearest ){ .point = double3_mul_add( t->at[lower], s, along ),
                               .first = t->number[lower],
                               .second = t->number[upper] };
    n->weights[lower] = 1.0 - s;
    n->weights[upper] = s;
    triangle_measure( n, p );
}

// Handles a degenerate triangle: the nearest of its edges, the first of equals.
static inline void triangle_at_line( triangle_nearest* n, const triangle_corners* t, double3 p )
{
    triangle_at_edge( n, t, 0, 1, p );
    for ( int i = 1; i < 3; ++i )
    {
        triangle_nearest other;
        triangle_at_edge( &other, t, i, ( i + 1 ) % 3, p );
        *n = other.squared < n->squared ? other : *n;
    }
}

/// Compute the closest point. Regions as in Ericson 2005, section 5.1.5.
static inline void triangle_find_nearest( triangle_nearest* n, const triangle_corners* t, double3 p )
{
    double3 ab = double3_sub( t->at[1], t->at[0] ), ac = double3_sub( t->at[2], t->at[0] );
    double3 normal = double3_cross( ab, ac );
    double area = double3_dot( normal, normal );
    if ( area <= TRIANGLE_FLAT * ( double3_dot( ab, ab ) * double3_dot( ac, ac ) ) )
    {
        triangle_at_line( n, t, p );
        return;
    }

    double3 ap = double3_sub( p, t->at[0] ), bp = double3_sub( p, t->at[1] ), cp = double3_sub( p, t->at[2] );
    double ab_a = double3_dot( ab, ap ), ac_a = double3_dot( ac, ap );
    double ab_b = double3_dot( ab, bp ), ac_b = double3_dot( ac, bp );
    double ab_c = double3_dot( ab, cp ), ac_c = double3_dot( ac, cp );
    double of_c = ab_a * ac_b - ab_b * ac_a, of_b = ab_c * ac_a - ab_a * ac_c, of_a = ab_b * ac_c - ab_c * ac_b;
    if ( ab_a <= 0.0 && ac_a <= 0.0 )
    {
        triangle_at_corner( n, t, 0, p );
    }
    else if ( ab_b >= 0.0 && ac_b <= ab_b )
    {
        triangle_at_corner( n, t, 1, p );
    }
    else if ( ac_c >= 0.0 && ab_c <= ac_c )
    {
        triangle_at_corner( n, t, 2, p );
    }
    else if ( of_c <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0 )
    {
        triangle_at_edge( n, t, 0, 1, p );
    }
    else if ( of_b <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0 )
    {
        triangle_at_edge( n, t, 0, 2, p );
    }
    else if ( of_a <= 0.0 && ac_b >= ab_b && ab_c >= ac_c )
    {
        triangle_at_edge( n, t, 1, 2, p );
    }
    else
    {
        double scale = 1.0 / ( of_a + of_b + of_c ), v = of_b * scale, w = of_c * scale;
        double3 point = double3_mul_add( double3_mul_add( t->at[0], v, ab ), w, ac );
        *n = ( triangle_nearest ){ .point = point, .weights = { 1.0 - v - w, v, w }, .first = -1, .second = -1 };
        triangle_measure( n, p );
    }
}

/// Intersection of a path with a triangle.
typedef struct triangle_intersection
{
    double time;
    double weights[3];
    bool from_front;
} triangle_intersection;

// Returns the side on which the path passes the edge i -> j; the edge j -> i of a neighbour gets exactly the
// opposite.
static inline double triangle_edge_turn( const triangle_corners* t, int i, int j, double3 from, double3 step )
{
    bool is_ordered = t->number[i] < t->number[j];
    double3 lower = double3_sub( t->at[is_ordered ? i : j], from ),
            upper = double3_sub( t->at[is_ordered ? j : i], from );
    double turn = double3_dot( step, double3_cross( lower, upper ) );
    return is_ordered ? turn : -turn;
}

/// Intersect a path with a triangle. The side of each end depends only on its own coordinates, so that consecutive
/// paths agree about their common point. Zero counts as in front.
static inline bool triangle_cross( const triangle_corners* t, double3 from, double3 to,
                                   triangle_intersection* intersection )
{
    double3 normal = triangle_normal( t ), step = double3_sub( to, from );
    double before = double3_dot( double3_sub( from, t->at[0] ), normal );
    double after = double3_dot( double3_sub( to, t->at[0] ), normal );
    if ( ( before >= 0.0 ) == ( after >= 0.0 ) )
    {
        return false;
    }
    double a = triangle_edge_turn( t, 1, 2, from, step );
    double b = triangle_edge_turn( t, 2, 0, from, step );
    double c = triangle_edge_turn( t, 0, 1, from, step );
    bool is_inside = ( a >= 0.0 && b >= 0.0 && c >= 0.0 ) || ( a <= 0.0 && b <= 0.0 && c <= 0.0 );
    double sum = a + b + c;
    if ( !is_inside || sum == 0.0 )
    {
        return false;
    }
    *intersection = ( triangle_intersection ){ .time = before / ( before - after ),
                                               .weights = { a / sum, b / sum, c / sum },
                                               .from_front = before >= 0.0 };
    return true;
}

/// Interpolate between two places of a triangle.
static inline triangle_corners triangle_between( const triangle_corners* begin, const triangle_corners* end,
                                                 double time )
{
    triangle_corners t = *end;
    for ( int k = 0; k < 3; ++k )
    {
        t.at[k] = double3_mul_add( double3_scale( begin->at[k], 1.0 - time ), time, end->at[k] );
    }
    return t;
}

// Returns six times the volume between a point and a triangle, positive in front.
static inline double triangle_height( const triangle_corners* t, double3 p )
{
    return double3_dot( double3_sub( p, t->at[0] ), triangle_normal( t ) );
}

/// Intersect a path with a triangle whose corners move along straight lines at the same time. The height of the point above
/// the triangle is a cubic of time. A path that begins on one side of the plane and ends on the other meets it in between; one that
/// passes and comes back within the path is left out, as for a triangle that rests. Edges are wide by rounding, so that
/// no path slips between two triangles.
static inline bool triangle_sweep( const triangle_corners* begin, const triangle_corners* end, double3 from,
                                   double3 to, triangle_intersection* intersection )
{
    enum
    {
        HALVINGS = 48,
    };
    const double3 step = double3_sub( to, from );
    const bool from_front = triangle_height( begin, from ) >= 0.0;
    if ( from_front == ( triangle_height( end, to ) >= 0.0 ) )
    {
        return false;
    }
    double early = 0.0, late = 1.0;
    for ( int i = 0; i < HALVINGS; ++i )
    {
        const double middle = 0.5 * ( early + late );
        const triangle_corners t = triangle_between( begin, end, middle );
        const bool is_front = triangle_height( &t, double3_mul_add( from, middle, step ) ) >= 0.0;
        *( is_front == from_front ? &early : &late ) = middle;
    }
    const triangle_corners t = triangle_between( begin, end, late );
    const double3 p = double3_mul_add( from, late, step ), normal = triangle_normal( &t );
    const double area = double3_dot( normal, normal );
    if ( area == 0.0 )
    {
        return false;
    }
    double weights[3];
    for ( int k = 0; k < 3; ++k )
    {
        const double3 a = t.at[( k + 1 ) % 3], b = t.at[( k + 2 ) % 3];
        weights[k] = double3_dot( normal, double3_cross( double3_sub( a, p ), double3_sub( b, p ) ) ) / area;
        if ( !( weights[k] >= -1e-9 ) )
        {
            return false;
        }
    }
    *intersection = ( triangle_intersection ){ late, { weights[0], weights[1], weights[2] }, from_front };
    return true;
}
