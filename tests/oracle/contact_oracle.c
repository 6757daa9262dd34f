#include "contact_oracle.h"

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

double contact_oracle_mobility( const contact_oracle_contact* contact, const double* w )
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
