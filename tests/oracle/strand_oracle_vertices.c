// Bending and twist at a vertex of a rod, its energy and gradient.
#include "strand_oracle_rod.h"

strand_oracle_quaternion rod_frame_before( const strand_oracle* strand, int i )
{
    const int before = i > 0 || strand->closed == false ? i - 1 : strand->count - 2;
    return before >= 0 ? strand->frame[before] : strand_oracle_product( strand->turn, strand->clamp );
}

double3 rod_tangent( const strand_oracle* strand, const double3* p, int s )
{
    s = s < 0 && strand->closed ? strand->count - 2 : s;
    if ( s < 0 )
    {
        return strand_oracle_turned( rod_frame_before( strand, 0 ), rod_z );
    }
    if ( s + 1 == strand->count )
    {
        return strand_oracle_turned( strand->frame[s], rod_z );
    }
    return double3_scale( 1.0 / strand->length[s], double3_sub( p[s + 1], p[s] ) );
}

static double3 unit_tangent( const strand_oracle* strand, const double3* p, int s )
{
    const double3 t = rod_tangent( strand, p, s );
    const double length = double3_length( t );
    s = s < 0 && strand->closed ? strand->count - 2 : s;
    return length > 1e-15 ? double3_scale( 1.0 / length, t ) : strand_oracle_turned( strand->frame[s], rod_z );
}

strand_oracle_quaternion rod_middle_frame( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const double sign = quaternion_dot( a, b ) < 0.0 ? -1.0 : 1.0;
    const strand_oracle_quaternion sum = { a.x + sign * b.x, a.y + sign * b.y, a.z + sign * b.z, a.w + sign * b.w };
    return quaternion_normalised( sum, a );
}

// conj( q_{i-1} ) q_i, with the sign that makes it a small rotation.
static strand_oracle_quaternion relative_frame( strand_oracle_quaternion a, strand_oracle_quaternion b )
{
    const strand_oracle_quaternion r = strand_oracle_product( quaternion_conjugate( a ), b );
    return r.w < 0.0 ? ( strand_oracle_quaternion ){ -r.x, -r.y, -r.z, -r.w } : r;
}

static double curvature_denominator( double3 before, double3 behind )
{
    return fmax( 1.0 + double3_dot( before, behind ), 0.1 );
}

// w = f (2 - f): 1 up to a fold of a quarter of that at rest, and falling where the vertex folds further.
static void fade( const strand_oracle* strand, int i, rod_vertex* v )
{
    const double at_rest = 2.0 - 0.5 * double3_dot( strand->rest[i], strand->rest[i] );
    const double begin = 0.25 * fmax( 0.2, fmin( 1.0, at_rest ) );
    const double f = fmax( 0.1, fmin( 1.0, ( 1.0 + double3_dot( v->before, v->behind ) ) / begin ) );
    v->share = f * ( 2.0 - f );
    v->unfolding = 2.0 * ( 1.0 - f ) / begin;
}

rod_vertex rod_measure( const strand_oracle* strand, const double3* p, int i )
{
    rod_vertex v = { .bend = double3_sub( rod_tangent( strand, p, i ), rod_tangent( strand, p, i - 1 ) ) };
    if ( strand->framed == false )
    {
        return v;
    }
    const strand_oracle_quaternion a = rod_frame_before( strand, i ), b = strand->frame[i],
                                   middle = rod_middle_frame( a, b );
    const double3 before = unit_tangent( strand, p, i - 1 ), behind = unit_tangent( strand, p, i );
    v.before = before;
    v.behind = behind;
    fade( strand, i, &v );
    v.ratio = 0.5 * fabs( quaternion_dot( a, b ) ) / ( 1.0 + fabs( quaternion_dot( a, b ) ) );
    v.rest = double3_scale( v.share, strand_oracle_turned( middle, strand->rest[i] ) );
    v.turned = double3_cross( strand_oracle_turned( middle, rod_z ), v.rest );
    v.kb = double3_scale( 2.0 / curvature_denominator( before, behind ), double3_cross( before, behind ) );

    const strand_oracle_quaternion r = relative_frame( a, b );
    const double c = cos( 0.5 * strand->rest_twist[i] ), s = sin( 0.5 * strand->rest_twist[i] );
    const double z = r.z * c - r.w * s, w = r.w * c + r.z * s;
    v.twist = 2.0 * z / copysign( fmax( fabs( w ), 0.087 ), w );
    v.moment = v.share * strand->twist_stiffness[i] * v.twist;
    const double3 bend = double3_sub( behind, before );
    v.soft = double3_scale( strand->flatness * sqrt( v.share ), strand_oracle_turned( middle, rod_x ) );
    v.edge = double3_cross( strand_oracle_turned( middle, rod_z ), v.soft );
    v.across = double3_dot( double3_sub( bend, v.rest ), v.soft );
    v.along = double3_dot( bend, v.edge );
    v.load = -strand->stiffness[i] * ( double3_dot( bend, v.turned ) + v.across * v.along );
    const double slope = double3_dot( bend, v.rest ) + v.across * double3_dot( bend, v.soft ) - v.along * v.along;
    v.slope = 0.25 * strand->stiffness[i] * fmax( 0.0, slope );
    return v;
}

void rod_measure_all( const strand_oracle* strand, const double3* p, rod_vertex* v )
{
    v[strand->count - 1] = ( rod_vertex ){ .twist = 0.0 };
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        v[i] = rod_measure( strand, p, i );
    }
}

double strand_oracle_twist( const strand_oracle* strand, int vertex )
{
    const strand_oracle_quaternion r = relative_frame( rod_frame_before( strand, vertex ), strand->frame[vertex] );
    return 2.0 * atan2( r.z, r.w );
}

double strand_oracle_rod_energy( const strand_oracle* strand )
{
    double energy = 0.0;
    for ( int i = 0; i < rod_bending_count( strand ); ++i )
    {
        const rod_vertex v = rod_measure( strand, strand->position, i );
        const double3 c = double3_sub( v.bend, v.rest );
        const double half = strand->framed ? 0.5 * ( strand_oracle_twist( strand, i ) - strand->rest_twist[i] ) : 0.0;
        const double across = double3_dot( c, v.soft );
        energy += 0.5 * strand->stiffness[i] * ( double3_dot( c, c ) - across * across );
        energy -= strand->framed ? 4.0 * v.share * strand->twist_stiffness[i] * log( fabs( cos( half ) ) ) : 0.0;
    }
    return energy;
}

// Twice what twist and rest curvature of a vertex add to the gradient by one of its segments, times its length:
// `side` is -1 before it and 1 behind it.
static double3 turning_of( const strand_oracle* strand, int i, const rod_vertex* v, double side )
{
    double3 sum = double3_scale( v->moment + side * v->ratio * v->load, v->kb );
    if ( v->unfolding > 0.0 )
    {
        const double3 bend = double3_sub( v->behind, v->before );
        double energy = strand->stiffness[i] * double3_dot( v->rest, double3_sub( v->rest, bend ) );
        energy += strand->stiffness[i] * v->across * ( double3_dot( v->rest, v->soft ) - 0.5 * v->across );
        energy += strand->twist_stiffness[i] > 0.0
                      ? 0.5 * v->moment * v->moment / ( v->share * strand->twist_stiffness[i] )
                      : 0.0;
        const double3 own = side < 0.0 ? v->before : v->behind, other = side < 0.0 ? v->behind : v->before;
        const double3 across = double3_add_scaled( other, -double3_dot( own, other ), own );
        sum = double3_add_scaled( sum, 2.0 * energy * v->unfolding / v->share, across );
    }
    return sum;
}

// M_i: bending against the part that an elliptic section leaves.
static double3 moment_of( const strand_oracle* strand, int i, const rod_vertex* v )
{
    const double3 c = double3_add_scaled( double3_sub( v->bend, v->rest ), -v->across, v->soft );
    return double3_scale( strand->stiffness[i], c );
}

void rod_gradient_of( const strand_oracle* strand, const rod_vertex* v, double3* gradient )
{
    gradient[0] = rod_none;
    for ( int s = 0; s + 1 < strand->count; ++s )
    {
        const int next = strand->closed && s + 2 == strand->count ? 0 : s + 1;
        const rod_vertex *a = v + s, *b = v + next;
        const double3 ma = moment_of( strand, s, a ), mb = moment_of( strand, next, b );
        double3 turning = rod_none;
        if ( strand->framed )
        {
            turning = turning_of( strand, s, a, 1.0 );
            turning = next < rod_bending_count( strand ) ? double3_add( turning, turning_of( strand, next, b, -1.0 ) )
                                                         : turning;
        }
        const double3 sum = double3_add_scaled( double3_sub( ma, mb ), 0.5, turning );
        const double3 g = double3_scale( 1.0 / strand->length[s], sum );
        gradient[s] = double3_sub( gradient[s], g );
        gradient[s + 1] = g;
    }
    if ( strand->closed )
    {
        gradient[0] = double3_add( gradient[0], gradient[strand->count - 1] );
    }
}

void strand_oracle_rod_gradient( const strand_oracle* strand, double3* gradient )
{
    rod_vertex v[MAX_STRAND_ORACLE];
    rod_measure_all( strand, strand->position, v );
    rod_gradient_of( strand, v, gradient );
}
