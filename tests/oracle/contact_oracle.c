#include "contact_oracle.h"

#include <stddef.h>

// ---- gaps of meshes ----

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

// ---- deepest point ----

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

// Distance to the ball whose centre and radius lie at t between those of both ends.
static double ball_distance( const deepest_oracle_body* b, double3 p, double t )
{
    return length( double3_make( p.x, p.y - ( 2.0 * t - 1.0 ) * b->half_length, p.z ) ) -
           ( b->bottom_radius + t * ( b->top_radius - b->bottom_radius ) );
}

// The hull of two balls is the union of the balls between them, whose distance is convex along the axis.
static double tapered_distance( const deepest_oracle_body* b, double3 p )
{
    double from = 0.0, to = 1.0;
    for ( int round = 0; round < 50; ++round )
    {
        const double third = ( to - from ) / 3.0;
        const bool is_lower = ball_distance( b, p, from + third ) < ball_distance( b, p, to - third );
        from = is_lower ? from : from + third;
        to = is_lower ? to - third : to;
    }
    return ball_distance( b, p, 0.5 * ( from + to ) );
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

// ---- contact ----

// ---- closest points: the nearest of all candidates ----

static contact_oracle_closest measured( const double* a, const double3* corners_a, int count_a, const double* b,
                                        const double3* corners_b, int count_b )
{
    contact_oracle_closest c = { .distance = 0.0 };
    for ( int i = 0; i < count_a; ++i )
    {
        c.a[i] = a[i];
        c.on_a = double3_add_scaled( c.on_a, a[i], corners_a[i] );
    }
    for ( int j = 0; j < count_b; ++j )
    {
        c.b[j] = b[j];
        c.on_b = double3_add_scaled( c.on_b, b[j], corners_b[j] );
    }
    const double3 between = double3_sub( c.on_a, c.on_b );
    c.distance = double3_length( between );
    c.normal = c.distance > 0.0 ? double3_scale( 1.0 / c.distance, between ) : between;
    return c;
}

static void keep_nearer( contact_oracle_closest* best, contact_oracle_closest candidate )
{
    if ( candidate.distance < best->distance )
    {
        *best = candidate;
    }
}

// Position of a point's foot on p q, 0 at p and 1 at q. On a segment without length it is the first end.
static double foot_on( double3 point, double3 p, double3 q )
{
    const double3 along = double3_sub( q, p );
    const double squared = double3_dot( along, along );
    const double t = squared > 0.0 ? double3_dot( double3_sub( point, p ), along ) / squared : 0.0;
    return fmin( fmax( t, 0.0 ), 1.0 );
}

contact_oracle_closest contact_oracle_point_triangle( double3 point, const double3 triangle[3] )
{
    const double one = 1.0;
    contact_oracle_closest best = measured( &one, &point, 1, ( double[] ){ 1.0, 0.0, 0.0 }, triangle, 3 );

    // edges, and with them the corners
    for ( int i = 0; i < 3; ++i )
    {
        const int k = ( i + 1 ) % 3;
        double weights[3] = { 0.0, 0.0, 0.0 };
        weights[k] = foot_on( point, triangle[i], triangle[k] );
        weights[i] = 1.0 - weights[k];
        keep_nearer( &best, measured( &one, &point, 1, weights, triangle, 3 ) );
    }

    // the inside: barycentric weights of the point's foot, from areas
    const double3 ab = double3_sub( triangle[1], triangle[0] ), ac = double3_sub( triangle[2], triangle[0] );
    const double3 n = double3_cross( ab, ac ), ap = double3_sub( point, triangle[0] );
    const double nn = double3_dot( n, n );
    if ( nn > 0.0 )
    {
        const double v = double3_dot( double3_cross( ap, ac ), n ) / nn;
        const double w = double3_dot( double3_cross( ab, ap ), n ) / nn;
        if ( v > 0.0 && w > 0.0 && v + w < 1.0 )
        {
            keep_nearer( &best, measured( &one, &point, 1, ( double[] ){ 1.0 - v - w, v, w }, triangle, 3 ) );
        }
    }
    return best;
}

contact_oracle_closest contact_oracle_segments( const double3 a[2], const double3 b[2] )
{
    contact_oracle_closest best = measured( ( double[] ){ 1.0, 0.0 }, a, 2, ( double[] ){ 1.0, 0.0 }, b, 2 );

    // each end and the other segment
    for ( int i = 0; i < 2; ++i )
    {
        const double end[2] = { 1.0 - i, i };
        const double t = foot_on( a[i], b[0], b[1] ), s = foot_on( b[i], a[0], a[1] );
        keep_nearer( &best, measured( end, a, 2, ( double[] ){ 1.0 - t, t }, b, 2 ) );
        keep_nearer( &best, measured( ( double[] ){ 1.0 - s, s }, a, 2, end, b, 2 ) );
    }

    // both insides: the connecting line is perpendicular to both segments
    const double3 u = double3_sub( a[1], a[0] ), v = double3_sub( b[1], b[0] ), r = double3_sub( a[0], b[0] );
    const double3 n = double3_cross( u, v );
    const double nn = double3_dot( n, n );
    if ( nn > 0.0 )
    {
        const double s = double3_dot( double3_cross( v, r ), n ) / nn,
                     t = double3_dot( double3_cross( u, r ), n ) / nn;
        if ( s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0 )
        {
            keep_nearer( &best, measured( ( double[] ){ 1.0 - s, s }, a, 2, ( double[] ){ 1.0 - t, t }, b, 2 ) );
        }
    }
    return best;
}

// ---- contact and friction ----

double3 contact_oracle_point_of( const contact_oracle_side* side, const double3* x )
{
    double3 point = double3_make( 0.0, 0.0, 0.0 );
    for ( int i = 0; i < side->count; ++i )
    {
        point = double3_add_scaled( point, side->weight[i], x[side->vertex[i]] );
    }
    return point;
}

static double3 between( const contact_oracle_contact* contact, const double3* x )
{
    return double3_sub( contact_oracle_point_of( &contact->a, x ), contact_oracle_point_of( &contact->b, x ) );
}

double contact_oracle_value( const contact_oracle_contact* contact, const double3* x )
{
    return double3_dot( contact->normal, between( contact, x ) ) - contact->gap;
}

static double mobility_of( const contact_oracle_side* side, const double* w )
{
    double sum = 0.0;
    for ( int i = 0; i < side->count; ++i )
    {
        sum += w[side->vertex[i]] * side->weight[i] * side->weight[i];
    }
    return sum;
}

// Return the farthest that a correction of 1 moves one vertex.
static double farthest_of( const contact_oracle_side* side, const double* w )
{
    double farthest = 0.0;
    for ( int i = 0; i < side->count; ++i )
    {
        farthest = fmax( farthest, w[side->vertex[i]] * fabs( side->weight[i] ) );
    }
    return farthest;
}

// S, 1/kg: 0 when every vertex is pinned.
static double contact_oracle_mobility( const contact_oracle_contact* contact, const double* w )
{
    const double max_lever = 4.0;
    return fmax( mobility_of( &contact->a, w ) + mobility_of( &contact->b, w ),
                 fmax( farthest_of( &contact->a, w ), farthest_of( &contact->b, w ) ) / max_lever );
}

static void move_side( const contact_oracle_side* side, const double* w, double3 push, double3* x )
{
    for ( int i = 0; i < side->count; ++i )
    {
        const int vertex = side->vertex[i];
        x[vertex] = double3_add_scaled( x[vertex], w[vertex] * side->weight[i], push );
    }
}

static void move( const contact_oracle_contact* contact, const double* w, double3 push, double3* x )
{
    move_side( &contact->a, w, push, x );
    move_side( &contact->b, w, double3_scale( -1.0, push ), x );
}

double contact_oracle_push( contact_oracle_contact* contact, const double* w, double3* x )
{
    const double mobility = contact_oracle_mobility( contact, w );
    if ( mobility == 0.0 )
    {
        return 0.0;
    }
    const double next = fmax( 0.0, contact->lambda - contact_oracle_value( contact, x ) / mobility );
    const double change = next - contact->lambda;
    contact->lambda = next;
    move( contact, w, double3_scale( change, contact->normal ), x );
    return change;
}

double3 contact_oracle_rub( contact_oracle_contact* contact, const double* w, const double3* before, double3* x )
{
    const double mobility = contact_oracle_mobility( contact, w );
    if ( mobility == 0.0 )
    {
        return double3_make( 0.0, 0.0, 0.0 );
    }
    const double3 way = double3_sub( between( contact, x ), between( contact, before ) );
    const double3 across = double3_add_scaled( way, -double3_dot( contact->normal, way ), contact->normal );
    double3 next = double3_add_scaled( contact->rubbed, -1.0 / mobility, across );
    const double requested = double3_length( next ), allowed = contact->friction * contact->lambda;
    if ( requested > allowed )
    {
        next = double3_scale( allowed / requested, next );
    }
    const double3 change = double3_sub( next, contact->rubbed );
    contact->rubbed = next;
    move( contact, w, change, x );
    return change;
}
