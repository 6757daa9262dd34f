#include "constraint_oracle.h"

#include <math.h>
#include <stddef.h>

// ---- seams ----

double seam_oracle_close( double rest, double distance, double step )
{
    return fabs( rest - distance ) <= step ? distance : rest > distance ? rest - step : rest + step;
}

void seam_oracle_project( seam_oracle_pair* pair, double3* a, double3* b, const double w[2], double alpha )
{
    const double3 d = double3_sub( *a, *b );
    const double length = double3_length( d ), sum = w[0] + w[1];
    if ( sum == 0.0 || ( pair->rest > 0.0 && length == 0.0 ) )
    {
        return;
    }
    double3 change;
    if ( pair->rest > 0.0 )
    {
        const double3 n = double3_scale( 1.0 / length, d );
        const double C = length - pair->rest, lambda = double3_dot( n, pair->lambda );
        change = double3_scale( -( C + alpha * lambda ) / ( sum + alpha ), n );
    }
    else
    {
        change = double3_scale( -1.0 / ( sum + alpha ), double3_add_scaled( d, alpha, pair->lambda ) );
    }
    pair->lambda = double3_add( pair->lambda, change );
    *a = double3_add_scaled( *a, w[0], change );
    *b = double3_add_scaled( *b, -w[1], change );
}

double seam_oracle_force( const seam_oracle_pair* pair, double dt )
{
    return double3_length( pair->lambda ) / ( dt * dt );
}

// ---- skins ----

typedef struct quat
{
    double w, x, y, z;
} quat;

double3 skin_oracle_linear( const skin_oracle_bone* bones, const double* weights, int count, double3 p )
{
    double sum[3] = { 0.0 };
    for ( int k = 0; k < count; ++k )
    {
        for ( int r = 0; r < 3; ++r )
        {
            const double* m = bones[k].m[r];
            sum[r] += weights[k] * ( m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3] );
        }
    }
    return double3_make( sum[0], sum[1], sum[2] );
}

static quat multiply( quat a, quat b )
{
    return ( quat ){ a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                     a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w };
}

static quat add_scaled( quat a, double s, quat b )
{
    return ( quat ){ a.w + s * b.w, a.x + s * b.x, a.y + s * b.y, a.z + s * b.z };
}

static double dot( quat a, quat b )
{
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}

// Bar-Itzhack's way: the column of largest length of 4 q q^T, whose entries are sums of those of the matrix.
static quat rotation_of( const skin_oracle_bone* b )
{
    const double( *m )[4] = b->m;
    const double trace = m[0][0] + m[1][1] + m[2][2];
    const quat columns[4] = {
        { 1.0 + trace, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1] },
        { m[2][1] - m[1][2], 1.0 + 2.0 * m[0][0] - trace, m[0][1] + m[1][0], m[0][2] + m[2][0] },
        { m[0][2] - m[2][0], m[0][1] + m[1][0], 1.0 + 2.0 * m[1][1] - trace, m[1][2] + m[2][1] },
        { m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1.0 + 2.0 * m[2][2] - trace },
    };
    quat best = columns[0];
    for ( int i = 1; i < 4; ++i )
    {
        best = dot( columns[i], columns[i] ) > dot( best, best ) ? columns[i] : best;
    }
    const double scale = 1.0 / sqrt( dot( best, best ) );
    return ( quat ){ scale * best.w, scale * best.x, scale * best.y, scale * best.z };
}

double3 skin_oracle_dual_quaternion( const skin_oracle_bone* bones, const double* weights, int count, double3 p )
{
    int pivot = 0;
    for ( int k = 1; k < count; ++k )
    {
        pivot = weights[k] > weights[pivot] ? k : pivot;
    }
    const quat near = rotation_of( &bones[pivot] );
    quat real = { 0 }, dual = { 0 };
    for ( int k = 0; k < count; ++k )
    {
        const quat q = rotation_of( &bones[k] );
        const quat t = { 0.0, bones[k].m[0][3], bones[k].m[1][3], bones[k].m[2][3] };
        const double weight = dot( q, near ) < 0.0 ? -weights[k] : weights[k];
        real = add_scaled( real, weight, q );
        dual = add_scaled( dual, 0.5 * weight, multiply( t, q ) );
    }
    const double length = sqrt( dot( real, real ) );
    const quat none = { 0 }, q = add_scaled( none, 1.0 / length, real ), d = add_scaled( none, 1.0 / length, dual );
    const quat conjugate = { q.w, -q.x, -q.y, -q.z };
    const quat turned = multiply( multiply( q, ( quat ){ 0.0, p.x, p.y, p.z } ), conjugate );
    const quat moved = multiply( d, conjugate );
    return double3_make( turned.x + 2.0 * moved.x, turned.y + 2.0 * moved.y, turned.z + 2.0 * moved.z );
}

// ---- motion constraints ----

// Displacement along the gradient of a constraint C <= 0 that is violated by `excess`.
static double respond( motion_oracle* m, int k, double excess, double w, bool keeps_lambda )
{
    if ( keeps_lambda && m->alpha[k] > 0.0 )
    {
        const double change = ( excess - m->alpha[k] * m->lambda[k] ) / ( w + m->alpha[k] );
        const double after = fmax( 0.0, m->lambda[k] + change );
        const double moved = w * ( after - m->lambda[k] );
        m->lambda[k] = after;
        return moved;
    }
    const double fraction = m->alpha[k] > 0.0 ? w / ( w + m->alpha[k] ) : m->stiffness[k];
    return fraction * fmax( 0.0, excess );
}

static double3 hold_near( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    const double3 e = double3_sub( x, m->target );
    const double length = double3_length( e );
    if ( isinf( m->max_distance ) || length == 0.0 )
    {
        return x;
    }
    const double moved = respond( m, 0, length - m->max_distance, w, keeps_lambda );
    return double3_add( x, double3_scale( -moved / length, e ) );
}

static double3 stop_behind( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    const double length = double3_length( m->normal );
    if ( isinf( m->backstop_distance ) || length == 0.0 )
    {
        return x;
    }
    const double3 n = double3_scale( 1.0 / length, m->normal );
    if ( isinf( m->backstop_radius ) )
    {
        const double depth = -( double3_dot( double3_sub( x, m->target ), n ) + m->backstop_distance );
        return double3_add( x, double3_scale( respond( m, 1, depth, w, keeps_lambda ), n ) );
    }
    const double behind = m->backstop_distance + m->backstop_radius;
    const double3 a = double3_sub( x, double3_add( m->target, double3_scale( -behind, n ) ) );
    const double rho = double3_length( a );
    const double moved = respond( m, 1, m->backstop_radius - rho, w, keeps_lambda );
    return double3_add( x, rho > 0.0 ? double3_scale( moved / rho, a ) : double3_scale( moved, n ) );
}

double3 motion_oracle_project( motion_oracle* m, double3 x, double w, bool keeps_lambda )
{
    return w > 0.0 ? stop_behind( m, hold_near( m, x, w, keeps_lambda ), w, keeps_lambda ) : x;
}

// ---- constraints ----

static const double pi = 3.14159265358979323846;

static const double3 zero = { 0.0, 0.0, 0.0 };

static double squared_length( double3 a )
{
    return double3_dot( a, a );
}

static constraint_oracle_term faulty( int count, constraint_oracle_fault fault )
{
    constraint_oracle_term term = { .count = count, .fault = fault };
    return term;
}

// Constraints of two vertices.

constraint_oracle_term constraint_oracle_distance( double3 p1, double3 p2, double rest_length )
{
    double3 between = double3_sub( p1, p2 );
    double length = double3_length( between );
    if ( length == 0.0 )
    {
        return faulty( 2, CONSTRAINT_ORACLE_ZERO_LENGTH );
    }
    double3 u = double3_scale( 1.0 / length, between );
    constraint_oracle_term term = { .count = 2, .value = length - rest_length };
    term.gradient[0] = u;
    term.gradient[1] = double3_scale( -1.0, u );
    return term;
}

constraint_oracle_term constraint_oracle_strain_limit( double3 p1, double3 p2, double rest_length, double lower,
                                                       double upper )
{
    double length = double3_distance( p1, p2 );
    double nearest_allowed = fmin( fmax( length, lower * rest_length ), upper * rest_length );
    return constraint_oracle_distance( p1, p2, nearest_allowed );
}

// Constraints of two triangles that share the edge p0 p1.

// The angle between the two normals, rad, in (-pi, pi]: 0 when flat, positive when the edge is convex on the side of
// the normals. theta = atan2( e.(n0 x n1)/|e|, n0.n1 ), which is accurate at 0 and at pi, where the arc cosine of
// Mueller et al. 2007, appendix A, loses its gradient.
static double constraint_oracle_dihedral_angle( const double3 p[4] )
{
    double3 e = double3_sub( p[1], p[0] );
    double3 n0 = double3_cross( e, double3_sub( p[2], p[0] ) );
    double3 n1 = double3_cross( double3_sub( p[3], p[0] ), e );
    double sine = double3_dot( e, double3_cross( n0, n1 ) );
    double cosine = double3_length( e ) * double3_dot( n0, n1 );
    return atan2( sine, cosine );
}

constraint_oracle_term constraint_oracle_dihedral( const double3 p[4], double rest_angle )
{
    double3 e = double3_sub( p[1], p[0] );
    double3 n0 = double3_cross( e, double3_sub( p[2], p[0] ) );
    double3 n1 = double3_cross( double3_sub( p[3], p[0] ), e );
    double ee = squared_length( e ), nn0 = squared_length( n0 ), nn1 = squared_length( n1 );
    if ( ee == 0.0 )
    {
        return faulty( 4, CONSTRAINT_ORACLE_ZERO_LENGTH );
    }
    if ( nn0 == 0.0 || nn1 == 0.0 )
    {
        return faulty( 4, CONSTRAINT_ORACLE_ZERO_AREA );
    }

    // where the feet of p2 and p3 stand on the edge: 0 at p0, 1 at p1
    double t2 = double3_dot( double3_sub( p[2], p[0] ), e ) / ee;
    double t3 = double3_dot( double3_sub( p[3], p[0] ), e ) / ee;

    // A rotating vertex moves along its tangent: a quarter turn lengthens its lever by 3 %, half a turn threefold.
    constraint_oracle_term term = { .count = 4, .max_change = 0.25 };
    term.value = remainder( constraint_oracle_dihedral_angle( p ) - rest_angle, 2.0 * pi );
    double3 g2 = double3_scale( -sqrt( ee ) / nn0, n0 );
    double3 g3 = double3_scale( -sqrt( ee ) / nn1, n1 );
    term.gradient[0] = double3_add_scaled( double3_scale( t2 - 1.0, g2 ), t3 - 1.0, g3 );
    term.gradient[1] = double3_add_scaled( double3_scale( -t2, g2 ), -t3, g3 );
    term.gradient[2] = g2;
    term.gradient[3] = g3;
    return term;
}

static double cotangent( double3 a, double3 b )
{
    return double3_dot( a, b ) / double3_length( double3_cross( a, b ) );
}

bool constraint_oracle_isometric_matrix( const double3 rest[4], double q[4][4] )
{
    double3 e0 = double3_sub( rest[1], rest[0] ), back = double3_sub( rest[0], rest[1] );
    double3 e1 = double3_sub( rest[2], rest[0] ), e2 = double3_sub( rest[3], rest[0] );
    double3 e3 = double3_sub( rest[2], rest[1] ), e4 = double3_sub( rest[3], rest[1] );
    double area0 = 0.5 * double3_length( double3_cross( e0, e1 ) );
    double area1 = 0.5 * double3_length( double3_cross( e0, e2 ) );
    bool sound = area0 > 0.0 && area1 > 0.0;
    double k[4] = { 0.0, 0.0, 0.0, 0.0 };
    if ( sound )
    {
        double c01 = cotangent( e0, e1 ), c02 = cotangent( e0, e2 );
        double c03 = cotangent( back, e3 ), c04 = cotangent( back, e4 );
        k[0] = c03 + c04;
        k[1] = c01 + c02;
        k[2] = -c01 - c03;
        k[3] = -c02 - c04;
    }
    for ( int i = 0; i < 4; ++i )
    {
        for ( int j = 0; j < 4; ++j )
        {
            q[i][j] = sound ? 3.0 / ( area0 + area1 ) * ( k[i] * k[j] ) : 0.0;
        }
    }
    return sound;
}

constraint_oracle_term constraint_oracle_isometric_energy( const double3 p[4], double q[4][4] )
{
    constraint_oracle_term term = { .count = 4 };
    for ( int i = 0; i < 4; ++i )
    {
        // rows of Q sum to zero, so positions may be taken from p0: no digits are lost far from the origin
        for ( int j = 1; j < 4; ++j )
        {
            term.gradient[i] = double3_add_scaled( term.gradient[i], q[i][j], double3_sub( p[j], p[0] ) );
        }
        term.value += 0.5 * double3_dot( double3_sub( p[i], p[0] ), term.gradient[i] );
    }
    return term;
}

constraint_oracle_term constraint_oracle_isometric_root( const double3 p[4], double q[4][4] )
{
    constraint_oracle_term term = constraint_oracle_isometric_energy( p, q );
    // Q is positive semidefinite; rounding may still leave a flat hinge below zero
    term.value = sqrt( fmax( 0.0, 2.0 * term.value ) );
    for ( int i = 0; i < 4; ++i )
    {
        term.gradient[i] = term.value > 0.0 ? double3_scale( 1.0 / term.value, term.gradient[i] ) : zero;
    }
    return term;
}

// Projection of terms.

static double weighted_gradient_square( const constraint_oracle_term* term, const int* vertices, const double* w )
{
    double sum = 0.0;
    for ( int n = 0; n < term->count; ++n )
    {
        sum += w[vertices[n]] * squared_length( term->gradient[n] );
    }
    return sum;
}

static double gradient_square( const constraint_oracle_term* term )
{
    double sum = 0.0;
    for ( int n = 0; n < term->count; ++n )
    {
        sum += squared_length( term->gradient[n] );
    }
    return sum;
}

// Whether the term can be projected with this denominator; counts the fault if not. A satisfied term without a
// gradient is no fault.
static bool may_project( double value, double denominator, double all_gradients, constraint_oracle_fault fault,
                         constraint_oracle_skips* skips )
{
    if ( fault == CONSTRAINT_ORACLE_SOUND && denominator > 0.0 )
    {
        return true;
    }
    if ( fault == CONSTRAINT_ORACLE_SOUND )
    {
        fault = all_gradients > 0.0 ? CONSTRAINT_ORACLE_PINNED : CONSTRAINT_ORACLE_ZERO_GRADIENT;
    }
    bool satisfied = fault == CONSTRAINT_ORACLE_ZERO_GRADIENT && value == 0.0;
    skips->count[fault] += satisfied ? 0 : 1;
    return false;
}

static void move( const constraint_oracle_term* term, const int* vertices, const double* w, double lambda,
                  double3* p )
{
    for ( int n = 0; n < term->count; ++n )
    {
        int i = vertices[n];
        p[i] = double3_add_scaled( p[i], lambda * w[i], term->gradient[n] );
    }
}

// Eq. 4: s = C / sum_j w_j |grad_j C|^2, 0 where the sum is 0.
static double constraint_oracle_scale( const constraint_oracle_term* term, const int* vertices, const double* w )
{
    double sum = weighted_gradient_square( term, vertices, w );
    return sum > 0.0 ? term->value / sum : 0.0;
}

// Limit a change of lambda to the allowed change of the constraint.
static double limited( const constraint_oracle_term* term, double sum, double delta )
{
    double most = term->max_change > 0.0 ? term->max_change / sum : INFINITY;
    return fmax( -most, fmin( most, delta ) );
}

double constraint_oracle_project( const constraint_oracle_term* term, const int* vertices, const double* w,
                                  double stiffness, double3* p, constraint_oracle_skips* skips )
{
    double sum = weighted_gradient_square( term, vertices, w );
    if ( !may_project( term->value, sum, gradient_square( term ), term->fault, skips ) )
    {
        return 0.0;
    }
    double lambda = limited( term, sum, -stiffness * constraint_oracle_scale( term, vertices, w ) );
    move( term, vertices, w, lambda, p );
    return lambda;
}

void constraint_oracle_project_compliant( const constraint_oracle_term* term, const int* vertices, const double* w,
                                          double alpha, double* lambda, double3* p, constraint_oracle_skips* skips )
{
    double sum = weighted_gradient_square( term, vertices, w );
    if ( !may_project( term->value, sum, gradient_square( term ), term->fault, skips ) )
    {
        return;
    }
    double delta = limited( term, sum, -( term->value + alpha * *lambda ) / ( sum + alpha ) );
    *lambda += delta;
    move( term, vertices, w, delta, p );
}

// Volume of a closed mesh.

double constraint_oracle_volume( const double3* p, const int* triangles, int triangle_count )
{
    double sum = 0.0;
    for ( int t = 0; t < triangle_count; ++t )
    {
        const int* corner = triangles + 3 * t;
        double3 origin = p[triangles[0]];
        double3 a = double3_sub( p[corner[0]], origin );
        double3 b = double3_sub( p[corner[1]], origin );
        double3 c = double3_sub( p[corner[2]], origin );
        sum += double3_dot( double3_cross( a, b ), c );
    }
    return sum / 6.0;
}

void constraint_oracle_volume_gradient( const double3* p, int vertex_count, const int* triangles, int triangle_count,
                                        double3* gradient )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        gradient[i] = zero;
    }
    for ( int t = 0; t < triangle_count; ++t )
    {
        const int* corner = triangles + 3 * t;
        for ( int k = 0; k < 3; ++k )
        {
            double3 a = p[corner[k]], b = p[corner[( k + 1 ) % 3]], c = p[corner[( k + 2 ) % 3]];
            double3 fraction = double3_cross( double3_sub( b, a ), double3_sub( c, a ) );
            gradient[corner[k]] = double3_add_scaled( gradient[corner[k]], 1.0 / 6.0, fraction );
        }
    }
}

// Dlambda of the volume. For pbd alpha and lambda are 0 and the caller applies the stiffness.
static double volume_delta( const double3* p, const double* w, int vertex_count, const int* triangles,
                            int triangle_count, double target, double alpha, double lambda, double3* gradient,
                            constraint_oracle_skips* skips )
{
    double value = constraint_oracle_volume( p, triangles, triangle_count ) - target;
    constraint_oracle_volume_gradient( p, vertex_count, triangles, triangle_count, gradient );
    double sum = 0.0, all = 0.0;
    for ( int i = 0; i < vertex_count; ++i )
    {
        sum += w[i] * squared_length( gradient[i] );
        all += squared_length( gradient[i] );
    }
    if ( !may_project( value, sum, all, CONSTRAINT_ORACLE_SOUND, skips ) )
    {
        return 0.0;
    }
    return -( value + alpha * lambda ) / ( sum + alpha );
}

static void move_all( double3* p, const double* w, int vertex_count, double lambda, const double3* gradient )
{
    for ( int i = 0; i < vertex_count; ++i )
    {
        p[i] = double3_add_scaled( p[i], lambda * w[i], gradient[i] );
    }
}

double constraint_oracle_project_volume( double3* p, const double* w, int vertex_count, const int* triangles,
                                         int triangle_count, double target, double stiffness, double3* gradient,
                                         constraint_oracle_skips* skips )
{
    double lambda =
        stiffness * volume_delta( p, w, vertex_count, triangles, triangle_count, target, 0.0, 0.0, gradient, skips );
    move_all( p, w, vertex_count, lambda, gradient );
    return lambda;
}

void constraint_oracle_project_volume_compliant( double3* p, const double* w, int vertex_count, const int* triangles,
                                                 int triangle_count, double target, double alpha, double* lambda,
                                                 double3* gradient, constraint_oracle_skips* skips )
{
    double delta =
        volume_delta( p, w, vertex_count, triangles, triangle_count, target, alpha, *lambda, gradient, skips );
    *lambda += delta;
    move_all( p, w, vertex_count, delta, gradient );
}
