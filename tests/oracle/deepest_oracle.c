#include "deepest_oracle.h"

#include <stddef.h>

deepest_oracle_body deepest_oracle_body_of( const wisp_shape* s )
{
    return ( deepest_oracle_body ){
        .kind = s->kind,
        .radius = (double)s->radius,
        .half_length = (double)s->half_length,
        .top_radius = (double)s->top_radius,
        .bottom_radius = (double)s->bottom_radius,
        .half_extent = double3_widen( s->half_extent ),
    };
}

static double clamp( double x, double lower, double upper )
{
    return fmin( fmax( x, lower ), upper );
}

static double length( double3 v )
{
    return sqrt( double3_dot( v, v ) );
}

static double3 cross( double3 a, double3 b )
{
    return double3_make( a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x );
}

static double box_distance( double3 h, double3 p )
{
    const double3 d = double3_make( fabs( p.x ) - h.x, fabs( p.y ) - h.y, fabs( p.z ) - h.z );
    const double3 out = double3_make( fmax( d.x, 0.0 ), fmax( d.y, 0.0 ), fmax( d.z, 0.0 ) );
    return length( out ) + fmin( fmax( d.x, fmax( d.y, d.z ) ), 0.0 );
}

// The hull of two balls is the union of the balls whose centre and radius lie between theirs.
static double tapered_distance( const deepest_oracle_body* b, double3 p )
{
    double best = INFINITY, from = 0.0, to = 1.0;
    for ( int round = 0; round < 6; ++round )
    {
        double best_at = from;
        for ( int i = 0; i <= 100; ++i )
        {
            const double t = from + ( to - from ) * i / 100.0;
            const double3 c = double3_make( p.x, p.y - ( 2.0 * t - 1.0 ) * b->half_length, p.z );
            const double d = length( c ) - ( b->bottom_radius + t * ( b->top_radius - b->bottom_radius ) );
            best_at = d < best ? t : best_at;
            best = fmin( best, d );
        }
        const double width = ( to - from ) / 50.0;
        from = clamp( best_at - width, 0.0, 1.0 );
        to = clamp( best_at + width, 0.0, 1.0 );
    }
    return best;
}

static double segment_distance( double3 p, double3 a, double3 b )
{
    const double3 ab = double3_sub( b, a );
    const double t = clamp( double3_dot( double3_sub( p, a ), ab ) / double3_dot( ab, ab ), 0.0, 1.0 );
    return length( double3_sub( p, double3_add_scaled( a, t, ab ) ) );
}

// The largest distance from a face plane inside; outside the nearest face or edge.
static double hull_distance( const deepest_oracle_body* body, double3 p )
{
    double deepest = -INFINITY, nearest = INFINITY;
    for ( int t = 0; t < body->triangle_count; ++t )
    {
        const int32_t* corner = body->triangles + 3 * (size_t)t;
        double3 v[3];
        for ( int k = 0; k < 3; ++k )
        {
            v[k] = double3_widen( body->points[corner[k]] );
        }
        const double3 n = cross( double3_sub( v[1], v[0] ), double3_sub( v[2], v[0] ) );
        const double height = double3_dot( n, double3_sub( p, v[0] ) ) / length( n );
        deepest = fmax( deepest, height );
        int above = 0;
        for ( int k = 0; k < 3; ++k )
        {
            const double3 side = cross( n, double3_sub( v[( k + 1 ) % 3], v[k] ) );
            above += double3_dot( side, double3_sub( p, v[k] ) ) >= 0.0 ? 1 : 0;
            nearest = fmin( nearest, segment_distance( p, v[k], v[( k + 1 ) % 3] ) );
        }
        nearest = above == 3 ? fmin( nearest, fabs( height ) ) : nearest;
    }
    return deepest <= 0.0 ? deepest : nearest;
}

double deepest_oracle_distance( const deepest_oracle_body* b, double3 p )
{
    switch ( b->kind )
    {
        case WISP_SHAPE_PLANE:
            return p.y;
        case WISP_SHAPE_SPHERE:
            return length( p ) - b->radius;
        case WISP_SHAPE_CAPSULE:
            return length( double3_make( p.x, p.y - clamp( p.y, -b->half_length, b->half_length ), p.z ) ) -
                   b->radius;
        case WISP_SHAPE_BOX:
            return box_distance( b->half_extent, p );
        case WISP_SHAPE_TAPERED_CAPSULE:
            return tapered_distance( b, p );
        default:
            return hull_distance( b, p );
    }
}

double deepest_oracle_find( const deepest_oracle_body* body, const double3* corners, int corner_count,
                            double weights[3] )
{
    enum
    {
        STEPS = 24,
        ROUNDS = 7,
    };
    double best = INFINITY, u = 0.5, v = corner_count == 3 ? 0.5 : 0.0, best_u = 0.0, best_v = 0.0, width = 0.5;
    for ( int round = 0; round < ROUNDS; ++round )
    {
        for ( int i = 0; i <= STEPS; ++i )
        {
            for ( int k = 0; k <= ( corner_count == 3 ? STEPS : 0 ); ++k )
            {
                const double a = clamp( u + width * ( 2.0 * i / STEPS - 1.0 ), 0.0, 1.0 );
                const double b =
                    corner_count == 3 ? clamp( v + width * ( 2.0 * k / STEPS - 1.0 ), 0.0, 1.0 - a ) : 0.0;
                double3 p = double3_blend( corners[0], corners[1], a );
                p = corner_count == 3 ? double3_add_scaled( p, b, double3_sub( corners[2], corners[0] ) ) : p;
                const double d = deepest_oracle_distance( body, p );
                if ( d < best )
                {
                    best = d;
                    best_u = a;
                    best_v = b;
                }
            }
        }
        u = best_u;
        v = best_v;
        width *= 0.25;
    }
    if ( weights )
    {
        weights[0] = 1.0 - best_u - best_v;
        weights[1] = best_u;
        weights[2] = best_v;
    }
    return best;
}
