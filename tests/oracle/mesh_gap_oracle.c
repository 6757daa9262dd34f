#include "mesh_gap_oracle.h"

enum
{
    THIRDS = 50, // ( 2 / 3 )^50 is 2e-9
};

// Distance of p from the point of a segment that is nearest.
static double from_segment( const double3 a[2], double3 p )
{
    const double3 u = double3_sub( a[1], a[0] );
    const double square = double3_dot( u, u ),
                 s = square > 0.0 ? double3_dot( double3_sub( p, a[0] ), u ) / square : 0.0;
    return double3_distance( p, double3_blend( a[0], a[1], fmin( 1.0, fmax( 0.0, s ) ) ) );
}

// The distance from b( t ) to a convex set is a convex function of t.
double mesh_gap_oracle_segments( const double3 a[2], const double3 b[2] )
{
    double lower = 0.0, upper = 1.0;
    for ( int i = 0; i < THIRDS; ++i )
    {
        const double s = lower + ( upper - lower ) / 3.0, t = upper - ( upper - lower ) / 3.0;
        const bool is_falling =
            from_segment( a, double3_blend( b[0], b[1], s ) ) > from_segment( a, double3_blend( b[0], b[1], t ) );
        *( is_falling ? &lower : &upper ) = is_falling ? s : t;
    }
    return from_segment( a, double3_blend( b[0], b[1], 0.5 * ( lower + upper ) ) );
}

double mesh_gap_oracle_triangle( const double3 t[3], double3 p )
{
    double lower = 0.0, upper = 1.0, least = INFINITY;
    for ( int i = 0; i < THIRDS + 1; ++i )
    {
        double at[2], distance[2];
        for ( int k = 0; k < 2; ++k )
        {
            at[k] = k == 0 ? lower + ( upper - lower ) / 3.0 : upper - ( upper - lower ) / 3.0;
            const double3 row[2] = { double3_blend( t[0], t[1], at[k] ), double3_blend( t[0], t[2], at[k] ) };
            distance[k] = from_segment( row, p );
            least = fmin( least, distance[k] );
        }
        *( distance[0] > distance[1] ? &lower : &upper ) = distance[0] > distance[1] ? at[0] : at[1];
    }
    return least;
}

bool mesh_gap_oracle_crosses( const double3 segment[2], const double3 t[3] )
{
    const double3 n = double3_cross( double3_sub( t[1], t[0] ), double3_sub( t[2], t[0] ) );
    const double a = double3_dot( n, double3_sub( segment[0], t[0] ) ),
                 b = double3_dot( n, double3_sub( segment[1], t[0] ) );
    if ( !( a * b < 0.0 ) )
    {
        return false;
    }
    const double3 p = double3_blend( segment[0], segment[1], a / ( a - b ) );
    for ( int k = 0; k < 3; ++k )
    {
        const double3 side = double3_sub( t[( k + 1 ) % 3], t[k] );
        if ( double3_dot( n, double3_cross( side, double3_sub( p, t[k] ) ) ) < 0.0 )
        {
            return false;
        }
    }
    return true;
}

typedef struct corners_of
{
    double3 at[3], middle;
    double radius;
} corners_of;

static corners_of load( const mesh_gap_oracle_mesh* m, int triangle )
{
    corners_of c = { .radius = 0.0 };
    double3 sum = { 0.0, 0.0, 0.0 };
    for ( int k = 0; k < 3; ++k )
    {
        c.at[k] = m->points[m->triangles[3 * triangle + k]];
        sum = double3_add_scaled( sum, 1.0 / 3.0, c.at[k] );
    }
    c.middle = sum;
    for ( int k = 0; k < 3; ++k )
    {
        c.radius = fmax( c.radius, double3_distance( c.at[k], sum ) );
    }
    return c;
}

static double segments_if_near( const double3 a[2], const double3 b[2], double within )
{
    const double apart = double3_distance( double3_blend( a[0], a[1], 0.5 ), double3_blend( b[0], b[1], 0.5 ) );
    const double reach = 0.5 * ( double3_distance( a[0], a[1] ) + double3_distance( b[0], b[1] ) );
    return apart - reach < within ? fmin( within, mesh_gap_oracle_segments( a, b ) ) : within;
}

static double point_if_near( const corners_of* t, double3 p, double within )
{
    return double3_distance( t->middle, p ) - t->radius < within
               ? fmin( within, mesh_gap_oracle_triangle( t->at, p ) )
               : within;
}

// @param within of no interest is what is farther
static double of_triangles( const corners_of* a, const corners_of* b, double within )
{
    double least = within;
    for ( int i = 0; i < 3; ++i )
    {
        const double3 e[2] = { a->at[i], a->at[( i + 1 ) % 3] }, f[2] = { b->at[i], b->at[( i + 1 ) % 3] };
        if ( mesh_gap_oracle_crosses( e, b->at ) || mesh_gap_oracle_crosses( f, a->at ) )
        {
            return -1.0;
        }
        least = point_if_near( b, a->at[i], point_if_near( a, b->at[i], least ) );
        for ( int k = 0; k < 3; ++k )
        {
            const double3 g[2] = { b->at[k], b->at[( k + 1 ) % 3] };
            least = segments_if_near( e, g, least );
        }
    }
    return least;
}

double mesh_gap_oracle_find( const mesh_gap_oracle_mesh* a, const mesh_gap_oracle_mesh* b )
{
    double least = INFINITY;
    for ( int i = 0; i < a->triangle_count; ++i )
    {
        const corners_of p = load( a, i );
        for ( int k = 0; k < b->triangle_count && least >= 0.0; ++k )
        {
            const corners_of q = load( b, k );
            const double apart = double3_distance( p.middle, q.middle ) - p.radius - q.radius;
            least = apart < least ? of_triangles( &p, &q, least ) : least;
        }
    }
    return least;
}
