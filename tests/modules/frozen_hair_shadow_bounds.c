// Bounds of the rounding error in one step of the method, operation by operation. u = 2^-24 bounds the relative error
// of every float operation; a constant in front of it counts operations, rounded up. All errors are added as if they
// had the same sign, so a bound is never too small, and about ten times the observed error.
#include "frozen_hair_shadow.h"

static const double u = HAIR_ROUNDING;

static const double pi = 3.14159265358979323846;

// ---- freeze ----

// Error of the bend axis. The cross product of two unit tangents, each known within 6 u, is known within 14 u, and
// its direction within that over its length. Where both precisions find a straight strand the axis is cos psi b1 +
// sin psi b2: psi within 2 pi 3 u, sine and cosine within 2 u, b1 and b2 within 8 u.
static double axis_error( double sine, int vertex )
{
    bool straight_in_any_precision = vertex == 1 || sine == 0.0;
    return straight_in_any_precision ? 36.0 * u : fmin( 2.0, 14.0 * u / sine );
}

// l* = l0 max( 1 + alpha eta, floor ): eta within 2 u (24 of its 53 bits), alpha within 2 u, l0 within 4 u, and four
// operations on numbers up to 1 + alpha.
static double length_error( const frozen_oracle_segment* g, double alpha )
{
    return g->rest_length * u * ( 12.0 * alpha + 12.0 );
}

// The direction: tangent 6 u; sine and cosine 2 u each; products and sums 8 u; the angle theta_max alpha xi within 8
// u of its largest value; the axis enters with the sine of the angle.
static double direction_error( const frozen_oracle_segment* g, double max_angle, double sine, int vertex )
{
    return 24.0 * u + 8.0 * u * max_angle + axis_error( sine, vertex ) * fabs( sin( g->angle ) );
}

void hair_bound_freeze( const hair_oracle* oracle, const double3* base, double* bound )
{
    const frozen_oracle_hair* hair = &oracle->hair;
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        double alpha = 1.0 / hair->stretch_stiffness[s],
               max_angle = oracle->options.theta_max / hair->bend_stiffness[s];
        double3 tangent = { 0.0, 0.0, 0.0 }, p = { 0.0, 0.0, 0.0 };
        double sum = 0.0;
        for ( int v = hair->offsets[s]; v < hair->offsets[s + 1]; ++v )
        {
            int i = v - hair->offsets[s];
            if ( i == 0 )
            {
                bound[v] = 0.0;
                p = base[v];
                continue;
            }
            frozen_oracle_segment g = frozen_oracle_jitter( hair, &oracle->options, base, s, i, tangent );
            double sine = double3_length( double3_cross( tangent, g.tangent ) );
            p = double3_add( p, g.step );
            sum += double3_length( g.step ) * direction_error( &g, max_angle, sine, i ) + length_error( &g, alpha ) +
                   u * double3_length( p );
            bound[v] = sum;
            tangent = g.tangent;
        }
    }
}

// ---- align ----

static void check_reach( const frozen_oracle_options* o, const double3* p, int count )
{
    for ( int i = o->reach == FROZEN_ORACLE_REACH_TIP ? count - 1 : 0; i < count; ++i )
    {
        double distance = double3_distance( p[i], o->cursor );
        double error = 8.0 * u * ( double3_length( p[i] ) + double3_length( o->cursor ) );
        if ( distance != o->cursor_radius && fabs( distance - o->cursor_radius ) < error )
        {
            fail_msg( "the scene has a vertex on the border of the cursor's reach" );
        }
    }
}

typedef struct turn_error
{
    double angle; // rad
    double axis;  // of a unit vector
    double phi;   // rad
} turn_error;

// The mean is a sum of N coordinates, each partial sum rounded, then two more operations; v and u are differences.
// The cross and the inner product of unit vectors round by 6 u, the arc tangent is within 3e-7 = 5 u. The axis is the
// cross product's direction. The engine takes v and u for parallel where the sine is below 1e-6, the oracle below
// 1e-12.
static turn_error find_turn_error( const double3* p, int count, double3 v, double3 t )
{
    double coordinate = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        coordinate = fmax( coordinate, double3_length( p[i] ) );
    }
    double v_error = u * coordinate * ( count / 2.0 + 4.0 ) / double3_length( v ) + u;
    double direction = v_error + u;
    double phi = double3_angle( v, t ), sine = sin( phi ), seen = direction + 6.0 * u;
    turn_error e = { .angle = direction + 12.0 * u, .phi = phi };
    bool parallel_in_both =
        double3_length( double3_cross( v, t ) ) <= 1e-12 * double3_length( v ) * double3_length( t );
    if ( parallel_in_both && seen < 1e-6 )
    {
        e.axis = 10.0 * seen;
        return e;
    }
    if ( sine < 1e-6 + seen && phi > pi / 2.0 )
    {
        fail_msg( "the scene has a strand that is antiparallel in one precision only" );
    }
    e.axis = sine < 1e-6 + seen ? 2.0 : fmin( 2.0, seen / sine );
    return e;
}

// R - 1 = sin a x + (1 - cos)(a a - 1) changes with its axis by at most the sum of its coefficients; products, sums,
// sine and cosine, and the rounding of w phi make the 34 u.
static double blend_error( turn_error e, double arm, double weight )
{
    double angle = weight * e.phi;
    double turned = weight * e.angle + ( fabs( sin( angle ) ) + 2.0 - 2.0 * cos( angle ) ) * e.axis;
    return arm * ( turned + 40.0 * u );
}

void hair_bound_align( const hair_oracle* oracle, const double3* in, double* bound )
{
    const frozen_oracle_hair* hair = &oracle->hair;
    const frozen_oracle_options* o = &oracle->options;
    memset( bound, 0, (size_t)oracle->vertex_count * sizeof( double ) );
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        const double3* p = in + hair->offsets[s];
        int count = hair->offsets[s + 1] - hair->offsets[s];
        if ( count < 2 )
        {
            continue;
        }
        check_reach( o, p, count );
        double3 v = frozen_oracle_representative( p, count, o->direction ), t = double3_sub( o->cursor, p[0] );
        double3 axis;
        double phi;
        if ( frozen_oracle_in_reach( p, count, o->cursor, o->cursor_radius, o->reach ) == false ||
             frozen_oracle_turn( v, t, o->dimension, &axis, &phi ) == false )
        {
            continue;
        }
        turn_error e = find_turn_error( p, count, v, t );
        for ( int i = 1; i < count; ++i )
        {
            double arm = double3_distance( p[i], p[0] ), w = frozen_oracle_weight( i, count, hair->intensity[s] );
            bound[hair->offsets[s] + i] = blend_error( e, arm, w ) + u * ( double3_length( p[0] ) + arm );
        }
    }
}

// ---- clump ----

// Data of one iteration for every vertex.
typedef struct clump_errors
{
    const hair_oracle* oracle;
    const double3 *reference, *in;
    const double* in_bound;
    int* strand;
    double3 *step, *tentative; // of the oracle
    double *step_error, *tentative_error;
    double max_in;
} clump_errors;

// The force adds N vectors (1 - r/h)^2 (q - p)/r. With r within 4 u and r/h within 6 u, a square is within 14 u of
// its root U and the vector within 24 u U; adding N of them rounds by N u of the sum of lengths. An error of the
// input changes the vector by its steepest slopes 2 U/h and U^2/r, or reverses it.
static double force_error( const clump_errors* c, int v )
{
    const double h = c->oracle->options.clump_radius;
    double sum = 0.0, lengths = 0.0, count = 0.0;
    for ( int q = 0; q < c->oracle->vertex_count; ++q )
    {
        double r = double3_distance( c->in[v], c->in[q] ), off = c->in_bound[v] + c->in_bound[q];
        if ( c->strand[q] == c->strand[v] || r >= h * ( 1.0 + 8.0 * u ) + off || ( r == 0.0 && off == 0.0 ) )
        {
            continue;
        }
        double root = fmax( 0.0, 1.0 - r / h ) + 8.0 * u + off / h;
        double slope = fmax( 2.0 * root / h, root * root / fmax( r, 1e-30 ) );
        sum += 24.0 * u * root + fmin( slope * off, 2.0 * root * root );
        lengths += root * root;
        count += 1.0;
    }
    return sum + count * u * lengths;
}

// The guard projects the step onto a ball. A projection does not increase the distance of its arguments, and one from
// far outside keeps only the error of the direction; the ball's radius is half of a distance.
static double guarded_error( const clump_errors* c, frozen_oracle_adhesion a, double error )
{
    const frozen_oracle_options* o = &c->oracle->options;
    double length = o->clump_step * double3_length( a.force ), room = ( a.nearest - o->min_distance ) / 2.0;
    if ( isinf( a.nearest ) )
    {
        return error + 6.0 * u * length;
    }
    double room_error = 4.0 * u * a.nearest + u * o->min_distance + c->max_in;
    room = fmax( room, 0.0 );
    if ( length - error > room + room_error )
    {
        return fmin( error, 2.0 * ( room + room_error ) * error / length ) + room_error + 8.0 * u * room;
    }
    return error + room_error + 8.0 * u * fmin( length, room );
}

static void find_steps( clump_errors* c )
{
    const frozen_oracle_hair* hair = &c->oracle->hair;
    const frozen_oracle_options* o = &c->oracle->options;
    for ( int v = 0; v < c->oracle->vertex_count; ++v )
    {
        int s = c->strand[v], i = v - hair->offsets[s];
        c->step[v] = double3_make( 0.0, 0.0, 0.0 );
        c->step_error[v] = 0.0;
        if ( i > 0 )
        {
            frozen_oracle_adhesion a = frozen_oracle_adhere( hair, o, c->in, s, i, NULL );
            c->step[v] = frozen_oracle_tentative_step( o, a );
            c->step_error[v] = guarded_error( c, a, o->clump_step * force_error( c, v ) );
        }
        c->tentative[v] = double3_add( c->in[v], c->step[v] );
        c->tentative_error[v] = c->step_error[v] + c->in_bound[v] + u * double3_length( c->tentative[v] );
    }
}

// delta is a mean of changes |r1 - r0| / h, weighted by g(r0). A change is known within the errors of its two ends;
// the mean moves with its weights by at most twice their errors over their sum. A clamp and an absolute value do not
// increase errors.
static double delta_error( const clump_errors* c, int v )
{
    const frozen_oracle_options* o = &c->oracle->options;
    const double h = o->clump_radius;
    double most = 0.0, weights = 0.0, weight_errors = 0.0, count = 0.0;
    for ( int q = 0; q < c->oracle->vertex_count; ++q )
    {
        double r0 = double3_distance( c->reference[v], c->reference[q] );
        if ( c->strand[q] == c->strand[v] || r0 >= h * ( 1.0 + 8.0 * u ) || r0 == 0.0 )
        {
            continue;
        }
        double r1 = double3_distance( c->tentative[v], c->tentative[q] );
        double ends = c->tentative_error[v] + c->tentative_error[q] + 4.0 * u * ( r0 + r1 );
        double root = fmax( 0.0, 1.0 - r0 / h ), max_root = root + 8.0 * u;
        most = fmax( most, ends / h + 3.0 * u );
        weights += root * root;
        weight_errors += max_root * max_root - root * root + 6.0 * u * root * root;
        count += 1.0;
    }
    if ( count == 0.0 )
    {
        return 0.0;
    }
    return weights > 0.0 ? fmin( 1.0, most + 2.0 * weight_errors / weights + 2.0 * count * u ) : 1.0;
}

static clump_errors make_errors( const hair_oracle* oracle, const double3* reference, const double3* in,
                                 const double* in_bound )
{
    size_t count = (size_t)oracle->vertex_count + 1;
    clump_errors c = { .oracle = oracle, .reference = reference, .in = in, .in_bound = in_bound };
    c.step = malloc( 2 * count * sizeof( double3 ) );
    c.step_error = malloc( 2 * count * sizeof( double ) );
    c.strand = malloc( count * sizeof( int ) );
    assert_true( c.step != NULL && c.step_error != NULL && c.strand != NULL );
    c.tentative = c.step + count;
    c.tentative_error = c.step_error + count;
    for ( int s = 0; s < oracle->hair.strand_count; ++s )
    {
        for ( int v = oracle->hair.offsets[s]; v < oracle->hair.offsets[s + 1]; ++v )
        {
            c.strand[v] = s;
            c.max_in = fmax( c.max_in, in_bound[v] );
        }
    }
    return c;
}

void hair_bound_clump( const hair_oracle* oracle, int iteration, const double3* reference, const double3* in,
                       const double* in_bound, double* bound )
{
    const frozen_oracle_options* o = &oracle->options;
    clump_errors c = make_errors( oracle, reference, in, in_bound );
    find_steps( &c );
    for ( int v = 0; v < oracle->vertex_count; ++v )
    {
        int s = c.strand[v], i = v - oracle->hair.offsets[s];
        double length = double3_length( c.step[v] );
        if ( o->gap == FROZEN_ORACLE_GAP_NONE || i == 0 )
        {
            bound[v] = i > 0 ? c.tentative_error[v] : 0.0;
            continue;
        }
        // lambda = (1 - delta) zeta + delta floor: zeta within u, four operations on numbers up to 1
        double change = frozen_oracle_vertex_delta( &oracle->hair, o, reference, c.tentative, s, i, NULL );
        double zeta = frozen_oracle_zeta( o, s, i, iteration );
        double lambda = frozen_oracle_lambda( o->gap, change, zeta, o->lambda_min );
        double lambda_error = delta_error( &c, v ) + 6.0 * u;
        bound[v] = lambda * c.step_error[v] + lambda_error * ( length + c.step_error[v] ) + c.in_bound[v] +
                   u * ( double3_length( in[v] ) + 2.0 * length );
    }
    free( c.step );
    free( c.step_error );
    free( c.strand );
}
