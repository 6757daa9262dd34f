// Eq. 1-5 of guide hair, frames and target strands. Curves are in guide_oracle.c, the ghosts that step through
// all of it in guide_oracle_body.c.
#include "guide_oracle.h"

#include <stdlib.h>
#include <string.h>

// ---- curves ----

// Eq. 6 and the splines: all curves of the guide hair oracle.

// Eq. 6.

void guide_oracle_bezier_weights( double t, bool printed, double weight[4] )
{
    double s = 1.0 - t;
    weight[0] = s * s * s;
    weight[1] = ( printed ? 2.0 : 3.0 ) * s * s * t;
    weight[2] = 3.0 * s * t * t;
    weight[3] = t * t * t;
}

static double3 guide_oracle_bezier( const double3 control[4], double t, bool printed )
{
    double weight[4];
    guide_oracle_bezier_weights( t, printed, weight );
    double3 sum = double3_scale( weight[0], control[0] );
    for ( int n = 1; n < 4; ++n )
    {
        sum = double3_add_scaled( sum, weight[n], control[n] );
    }
    return sum;
}

int guide_oracle_curve_count( int node_count, guide_oracle_curve curve )
{
    if ( node_count < 2 )
    {
        return 0;
    }
    return curve == GUIDE_ORACLE_CURVE_SMOOTH ? node_count - 1 : ( node_count + 1 ) / 3;
}

// A line or a quadratic as a cubic, so that one formula draws all of them.
static void raise_degree( const double3* nodes, int degree, double3 control[4] )
{
    double3 end = nodes[degree];
    control[0] = nodes[0];
    control[1] =
        degree == 1 ? double3_blend( nodes[0], end, 1.0 / 3.0 ) : double3_blend( nodes[0], nodes[1], 2.0 / 3.0 );
    control[2] = degree == 1 ? double3_blend( nodes[0], end, 2.0 / 3.0 ) : double3_blend( nodes[1], end, 1.0 / 3.0 );
    control[3] = end;
}

static void group_controls( const double3* nodes, int node_count, int group, double3 control[4] )
{
    int first = 3 * group, left = node_count - 1 - first;
    if ( left < 3 )
    {
        raise_degree( nodes + first, left, control );
        return;
    }
    for ( int n = 0; n < 4; ++n )
    {
        control[n] = nodes[first + n];
    }
}

// The control point next to a joint, as far from it as before, in the direction of a tangent.
static double3 along_tangent( double3 joint, double3 control, double3 tangent )
{
    double length = double3_length( tangent );
    return length > 0.0 ? double3_add_scaled( joint, double3_distance( joint, control ) / length, tangent ) : control;
}

static void joined_controls( const double3* nodes, int node_count, int group, double3 control[4] )
{
    int first = 3 * group, end = first + 3;
    group_controls( nodes, node_count, group, control );
    if ( first > 0 )
    {
        control[1] = along_tangent( control[0], control[1], double3_sub( nodes[first + 1], nodes[first - 1] ) );
    }
    if ( end < node_count - 1 )
    {
        control[2] = along_tangent( control[3], control[2], double3_sub( nodes[end - 1], nodes[end + 1] ) );
    }
}

// the Bezier form of the Hermite curve between nodes k and k + 1.
static void smooth_controls( const double3* nodes, int node_count, int k, double3 control[4] )
{
    control[0] = nodes[k];
    control[1] = double3_add_scaled( nodes[k], 1.0 / 3.0, guide_oracle_tangent( nodes, node_count, k ) );
    control[2] = double3_add_scaled( nodes[k + 1], -1.0 / 3.0, guide_oracle_tangent( nodes, node_count, k + 1 ) );
    control[3] = nodes[k + 1];
}

void guide_oracle_curve_controls( const double3* nodes, int node_count, guide_oracle_curve curve, double3* controls )
{
    int count = guide_oracle_curve_count( node_count, curve );
    for ( int n = 0; n < count; ++n )
    {
        if ( curve == GUIDE_ORACLE_CURVE_SMOOTH )
        {
            smooth_controls( nodes, node_count, n, controls + 4 * n );
        }
        else if ( curve == GUIDE_ORACLE_CURVE_JOINED )
        {
            joined_controls( nodes, node_count, n, controls + 4 * n );
        }
        else
        {
            group_controls( nodes, node_count, n, controls + 4 * n );
        }
    }
}

int guide_oracle_draw( const double3* controls, int curve_count, int samples, bool printed, double3* points )
{
    if ( curve_count <= 0 )
    {
        return 0;
    }
    int count = 0;
    points[count++] = guide_oracle_bezier( controls, 0.0, printed );
    for ( int n = 0; n < curve_count; ++n )
    {
        for ( int k = 1; k <= samples; ++k )
        {
            points[count++] = guide_oracle_bezier( controls + 4 * n, (double)k / samples, printed );
        }
    }
    return count;
}

double guide_oracle_largest_turn( const double3* points, int count )
{
    double largest = 0.0;
    double3 last = { 0.0, 0.0, 0.0 };
    bool has_last = false;
    for ( int n = 1; n < count; ++n )
    {
        double3 segment = double3_sub( points[n], points[n - 1] );
        if ( double3_length( segment ) == 0.0 )
        {
            continue;
        }
        largest = has_last ? fmax( largest, double3_angle( last, segment ) ) : 0.0;
        last = segment;
        has_last = true;
    }
    return largest;
}

// Hermite, in time and along the strand.

// Cubic Hermite curve from p0 to p1 with derivatives m0, m1 by u in [0, 1], and its derivative.
static double3 guide_oracle_hermite( double3 p0, double3 m0, double3 p1, double3 m1, double u )
{
    double u2 = u * u, u3 = u2 * u;
    double3 points = double3_add_scaled( double3_scale( 2.0 * u3 - 3.0 * u2 + 1.0, p0 ), 3.0 * u2 - 2.0 * u3, p1 );
    return double3_add_scaled( double3_add_scaled( points, u3 - 2.0 * u2 + u, m0 ), u3 - u2, m1 );
}

double3 guide_oracle_between_frames( double3 x0, double3 v0, double3 x1, double3 v1, double dt, double u )
{
    return guide_oracle_hermite( x0, double3_scale( dt, v0 ), x1, double3_scale( dt, v1 ), u );
}

double3 guide_oracle_tangent( const double3* nodes, int node_count, int node )
{
    if ( node_count < 2 )
    {
        return double3_make( 0.0, 0.0, 0.0 );
    }
    int before = node > 0 ? node - 1 : 0, after = node < node_count - 1 ? node + 1 : node_count - 1;
    return double3_scale( 1.0 / ( after - before ), double3_sub( nodes[after], nodes[before] ) );
}

// Different node counts.

void guide_oracle_arc( const double3* nodes, int node_count, double* arc )
{
    double length = 0.0;
    for ( int i = 0; i < node_count; ++i )
    {
        length += i > 0 ? double3_distance( nodes[i], nodes[i - 1] ) : 0.0;
        arc[i] = length;
    }
    for ( int i = 1; i < node_count; ++i )
    {
        arc[i] = length > 0.0 ? arc[i] / length : (double)i / ( node_count - 1 );
    }
}

// Add `weight` times the tangent of a node: the differences of guide_oracle_tangent() as weights of nodes.
static void add_tangent( guide_oracle_stencil* stencil, int first, int node, int node_count, double weight )
{
    int before = node > 0 ? node - 1 : 0, after = node < node_count - 1 ? node + 1 : node_count - 1;
    weight /= after - before;
    stencil->weight[after - first] += weight;
    stencil->weight[before - first] -= weight;
}

guide_oracle_stencil guide_oracle_spline_stencil( const double3* rest, int node_count, double arc )
{
    guide_oracle_stencil stencil = { { 0, 0, 0, 0 }, { 1.0, 0.0, 0.0, 0.0 } };
    if ( node_count < 2 )
    {
        return stencil;
    }

    // the last segment that begins at or before the arc length, by walking from the root
    int k = 0;
    double begin = 0.0, length = 0.0, walked = 0.0;
    for ( int i = 1; i < node_count; ++i )
    {
        length += double3_distance( rest[i], rest[i - 1] );
    }
    for ( int i = 0; i < node_count - 1 && walked <= arc * length; ++i )
    {
        k = i;
        begin = walked;
        walked += double3_distance( rest[i + 1], rest[i] );
    }
    double segment = double3_distance( rest[k + 1], rest[k] );
    double u = segment > 0.0 ? fmin( 1.0, ( arc * length - begin ) / segment ) : 0.0;
    double u2 = u * u, u3 = u2 * u;

    // four slots from the node before the segment; slots outside the strand repeat its ends with weight 0
    int first = k - 1;
    for ( int n = 0; n < 4; ++n )
    {
        int node = first + n;
        stencil.node[n] = node < 0 ? 0 : node < node_count ? node : node_count - 1;
        stencil.weight[n] = 0.0;
    }
    stencil.weight[1] = 2.0 * u3 - 3.0 * u2 + 1.0;
    stencil.weight[2] = 3.0 * u2 - 2.0 * u3;
    add_tangent( &stencil, first, k, node_count, u3 - 2.0 * u2 + u );
    add_tangent( &stencil, first, k + 1, node_count, u3 - u2 );
    return stencil;
}

guide_oracle_stencil guide_oracle_nearest_stencil( const double3* rest, int node_count, double3 point )
{
    guide_oracle_stencil stencil = { { 0, 0, 0, 0 }, { 1.0, 0.0, 0.0, 0.0 } };
    for ( int i = 1; i < node_count; ++i )
    {
        if ( double3_distance( rest[i], point ) < double3_distance( rest[stencil.node[0]], point ) )
        {
            stencil.node[0] = i;
        }
    }
    return stencil;
}

double3 guide_oracle_gather( const guide_oracle_stencil* stencil, const double3* nodes )
{
    double3 sum = double3_scale( stencil->weight[0], nodes[stencil->node[0]] );
    for ( int n = 1; n < 4; ++n )
    {
        sum = double3_add_scaled( sum, stencil->weight[n], nodes[stencil->node[n]] );
    }
    return sum;
}

// ---- guides ----

static const double slow_speed = 1e-6; // m/s; below it a velocity has no direction (section 4.3)

static const double3 zero = { 0.0, 0.0, 0.0 };

// Eq. 1.

// Eq. 1: sum over the detail nodes of the squared distance to the nearest guide particle, m^2.
static double guide_oracle_strand_distance( const double3* detail, int detail_nodes, const double3* guide,
                                            int guide_nodes )
{
    double sum = 0.0;
    for ( int k = 0; k < detail_nodes; ++k )
    {
        double nearest = HUGE_VAL;
        for ( int i = 0; i < guide_nodes; ++i )
        {
            double3 d = double3_sub( detail[k], guide[i] );
            nearest = fmin( nearest, double3_dot( d, d ) );
        }
        sum += nearest;
    }
    return sum;
}

static bool is_among( const int* list, int count, int value )
{
    for ( int n = 0; n < count; ++n )
    {
        if ( list[n] == value )
        {
            return true;
        }
    }
    return false;
}

void guide_oracle_links( const double3* detail, int detail_nodes, const double3* guides, int guide_count,
                         int guide_nodes, int link_count, int* link, double* weight )
{
    // choose the nearest that is not yet chosen; `weight` holds the distances until all are known
    for ( int k = 0; k < link_count; ++k )
    {
        weight[k] = HUGE_VAL;
        link[k] = -1;
        for ( int a = 0; a < guide_count; ++a )
        {
            double d = guide_oracle_strand_distance( detail, detail_nodes, guides + (size_t)a * (size_t)guide_nodes,
                                                     guide_nodes );
            if ( d < weight[k] && !is_among( link, k, a ) )
            {
                weight[k] = d;
                link[k] = a;
            }
        }
    }

    // (1/d_k) / sum (1/d_j), with both sides multiplied by the least distance: no overflow and no division by 0
    double least = weight[0], sum = 0.0;
    for ( int k = 0; k < link_count; ++k )
    {
        weight[k] = weight[k] == least ? 1.0 : least / weight[k];
        sum += weight[k];
    }
    for ( int k = 0; k < link_count; ++k )
    {
        weight[k] /= sum;
    }
}

// Eq. 2-3.

double3 guide_oracle_mean( const double3* points, int count )
{
    double3 sum = zero;
    for ( int n = 1; n < count; ++n )
    {
        sum = double3_add( sum, double3_sub( points[n], points[0] ) );
    }
    return count > 0 ? double3_add_scaled( points[0], 1.0 / count, sum ) : zero;
}

double guide_oracle_spread( const double3* points, int count )
{
    double3 c = guide_oracle_mean( points, count );
    double sum = 0.0;
    for ( int n = 0; n < count; ++n )
    {
        double3 d = double3_sub( points[n], c );
        sum += double3_dot( d, d );
    }
    return sum;
}

double guide_oracle_spread_energy( double stiffness, double spread, double requested )
{
    return stiffness * ( spread - requested ) * ( spread - requested );
}

void guide_oracle_spread_gradient( double stiffness, const double3* points, int count, double requested,
                                   double3* gradient )
{
    double3 c = guide_oracle_mean( points, count );
    double factor = 4.0 * stiffness * ( guide_oracle_spread( points, count ) - requested );
    for ( int n = 0; n < count; ++n )
    {
        gradient[n] = double3_scale( factor, double3_sub( points[n], c ) );
    }
}

guide_oracle_spread_fault guide_oracle_spread_project( double3* points, int count, double requested, bool exact )
{
    if ( count < 2 )
    {
        return GUIDE_ORACLE_SPREAD_SINGLE;
    }
    double v = guide_oracle_spread( points, count );
    if ( v == 0.0 )
    {
        return GUIDE_ORACLE_SPREAD_COINCIDENT;
    }
    if ( !( requested > 0.0 ) )
    {
        return GUIDE_ORACLE_SPREAD_BAD_TARGET;
    }
    double3 c = guide_oracle_mean( points, count );
    double growth = exact ? sqrt( requested / v ) - 1.0 : -( v - requested ) / ( 2.0 * v );
    for ( int n = 0; n < count; ++n )
    {
        points[n] = double3_add_scaled( points[n], growth, double3_sub( points[n], c ) );
    }
    return GUIDE_ORACLE_SPREAD_SOUND;
}

// Eq. 4-5.

double guide_oracle_elastic_weight( guide_oracle_elastic elastic, double3 v, double3 v0 )
{
    if ( elastic == GUIDE_ORACLE_ELASTIC_PRINTED_RAW )
    {
        return double3_dot( v, v0 ) * 0.5 + 0.5;
    }
    double speed = double3_length( v ), speed0 = double3_length( v0 );
    if ( speed < slow_speed || speed0 < slow_speed )
    {
        return elastic == GUIDE_ORACLE_ELASTIC_CHANGE ? 0.0 : 0.5;
    }
    double cosine = fmax( -1.0, fmin( 1.0, double3_dot( v, v0 ) / ( speed * speed0 ) ) );
    return elastic == GUIDE_ORACLE_ELASTIC_CHANGE ? 0.5 - 0.5 * cosine : 0.5 + 0.5 * cosine;
}

double guide_oracle_tip_weight( double gain, int node, int node_count )
{
    return node_count > 1 ? gain * node / ( node_count - 1 ) : 0.0;
}

double guide_oracle_centre_weight( double gain, double3 b, double3 c, double largest_offset )
{
    return largest_offset > 0.0 ? gain * double3_distance( b, c ) / largest_offset : 0.0;
}

double3 guide_oracle_displacement( double3 v, double weight, double largest_weight, double tau, double longest,
                                   bool* cut )
{
    double3 move = double3_scale( tau * weight, v );
    double length = tau * largest_weight * double3_length( v );
    if ( longest >= 0.0 && length > longest )
    {
        *cut = true;
        move = double3_scale( longest / length, move );
    }
    return move;
}

void guide_oracle_track( double3* members, int count, double3 goal )
{
    double3 shift = double3_sub( goal, guide_oracle_mean( members, count ) );
    for ( int n = 0; n < count; ++n )
    {
        members[n] = double3_add( members[n], shift );
    }
}

int guide_oracle_repair_lengths( double3* strand, int node_count, const double* segment_lengths )
{
    int skipped = 0;
    for ( int i = 1; i < node_count; ++i )
    {
        double3 segment = double3_sub( strand[i], strand[i - 1] );
        double length = double3_length( segment );
        if ( length == 0.0 )
        {
            skipped += 1;
            continue;
        }
        strand[i] = double3_add_scaled( strand[i - 1], segment_lengths[i] / length, segment );
    }
    return skipped;
}

// The frame of a segment.

guide_oracle_rotation guide_oracle_no_rotation( void )
{
    guide_oracle_rotation none = { { { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 0.0, 1.0 } } };
    return none;
}

double3 guide_oracle_rotate( const guide_oracle_rotation* rotation, double3 v )
{
    const double( *m )[3] = rotation->m;
    return double3_make( m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                         m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z );
}

// first `b`, then `a`
static guide_oracle_rotation guide_oracle_compose( const guide_oracle_rotation* a, const guide_oracle_rotation* b )
{
    guide_oracle_rotation c = { { { 0.0 } } };
    for ( int n = 0; n < 27; ++n )
    {
        c.m[n / 9][n / 3 % 3] += a->m[n / 9][n % 3] * b->m[n % 3][n / 3 % 3];
    }
    return c;
}

guide_oracle_rotation guide_oracle_turn_about( double3 axis, double angle )
{
    double length = double3_length( axis );
    if ( length == 0.0 )
    {
        return guide_oracle_no_rotation();
    }
    double3 u = double3_scale( 1.0 / length, axis );
    double c = cos( angle ), s = sin( angle );
    const double n[3] = { u.x, u.y, u.z };
    guide_oracle_rotation r = { { { c, -s * u.z, s * u.y }, { s * u.z, c, -s * u.x }, { -s * u.y, s * u.x, c } } };
    for ( int k = 0; k < 9; ++k )
    {
        r.m[k / 3][k % 3] += ( 1.0 - c ) * n[k / 3] * n[k % 3];
    }
    return r;
}

// The coordinate axis along which a vector is shortest: certainly not parallel to it.
static double3 min_axis( double3 v )
{
    double x = fabs( v.x ), y = fabs( v.y ), z = fabs( v.z );
    if ( x <= y && x <= z )
    {
        return double3_make( 1.0, 0.0, 0.0 );
    }
    return y <= z ? double3_make( 0.0, 1.0, 0.0 ) : double3_make( 0.0, 0.0, 1.0 );
}

// The smallest rotation that takes one direction to another; identity when one of them has no length. For opposite
// directions, a half turn about a perpendicular axis: the projection of the coordinate axis along which `from` is
// shortest.
// @param reversed set to true for opposite directions, otherwise left alone
static guide_oracle_rotation guide_oracle_smallest_rotation( double3 from, double3 to, bool* reversed )
{
    double from_length = double3_length( from ), to_length = double3_length( to );
    if ( from_length == 0.0 || to_length == 0.0 )
    {
        return guide_oracle_no_rotation();
    }
    double3 a = double3_scale( 1.0 / from_length, from ), b = double3_scale( 1.0 / to_length, to );
    double3 axis = double3_cross( a, b );

    // opposite within rounding: every perpendicular axis is equally good, so choose one that does not depend on noise
    if ( double3_length( axis ) < 1e-12 && double3_dot( a, b ) < 0.0 )
    {
        *reversed = true;
        double3 least = min_axis( a );
        return guide_oracle_turn_about( double3_add_scaled( least, -double3_dot( least, a ), a ), acos( -1.0 ) );
    }
    return guide_oracle_turn_about( axis, double3_angle( a, b ) );
}

int guide_oracle_parallel_frames( const double3* rest, const double3* present, int node_count,
                                  const guide_oracle_rotation* root, guide_oracle_rotation* frames )
{
    int reversed_count = 0;
    frames[0] = *root;
    for ( int i = 1; i < node_count; ++i )
    {
        double3 carried = guide_oracle_rotate( &frames[i - 1], double3_sub( rest[i], rest[i - 1] ) );
        bool reversed = false;
        guide_oracle_rotation turn =
            guide_oracle_smallest_rotation( carried, double3_sub( present[i], present[i - 1] ), &reversed );
        frames[i] = guide_oracle_compose( &turn, &frames[i - 1] );
        reversed_count += reversed ? 1 : 0;
    }
    return reversed_count;
}

// Targets.

static int project_pairs( const guide_oracle_strand* strand, int apart, double stiffness, double3* p,
                          constraint_oracle_skips* skips )
{
    int count = 0;
    for ( int i = 0; i + apart < strand->node_count; ++i )
    {
        const int pair[2] = { i, i + apart };
        double rest = double3_distance( strand->rest[i], strand->rest[i + apart] );
        constraint_oracle_term term = constraint_oracle_distance( p[i], p[i + apart], rest );
        constraint_oracle_project( &term, pair, strand->w, stiffness, p, skips );
        count += 1;
    }
    return count;
}

int guide_oracle_strand_step( const guide_oracle_strand* strand, double3* x, double3* v,
                              constraint_oracle_skips* skips )
{
    int n = strand->node_count, projected = 0;
    double h = strand->dt / strand->substeps;
    double3* before = calloc( (size_t)n + 1, sizeof( double3 ) );
    if ( before == NULL )
    {
        return -1;
    }
    double3 head_velocity = double3_scale( 1.0 / strand->dt, double3_sub( strand->root, x[0] ) );
    for ( int substep = 0; substep < strand->substeps; ++substep )
    {
        memcpy( before, x, (size_t)n * sizeof( double3 ) );
        for ( int i = 0; i < n; ++i )
        {
            bool pinned = strand->w[i] == 0.0;
            v[i] = !pinned ? double3_add_scaled( v[i], h, strand->gravity ) : i == 0 ? head_velocity : zero;
            x[i] = double3_add_scaled( x[i], h, v[i] );
        }
        for ( int k = 0; k < strand->iterations; ++k )
        {
            projected += project_pairs( strand, 1, 1.0, x, skips );
            projected +=
                strand->bend_stiffness > 0.0 ? project_pairs( strand, 2, strand->bend_stiffness, x, skips ) : 0;
        }
        for ( int i = 0; i < n; ++i )
        {
            v[i] = double3_scale( 1.0 / h, double3_sub( x[i], before[i] ) );
        }
    }
    free( before );
    return projected;
}
