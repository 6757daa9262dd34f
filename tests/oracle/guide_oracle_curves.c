// Eq. 6 and the splines: all curves of the guide hair oracle.
#include "guide_oracle.h"

// Eq. 6.

void guide_oracle_bezier_weights( double t, bool printed, double weight[4] )
{
    double s = 1.0 - t;
    weight[0] = s * s * s;
    weight[1] = ( printed ? 2.0 : 3.0 ) * s * s * t;
    weight[2] = 3.0 * s * t * t;
    weight[3] = t * t * t;
}

double3 guide_oracle_bezier( const double3 control[4], double t, bool printed )
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

double3 guide_oracle_hermite( double3 p0, double3 m0, double3 p1, double3 m1, double u )
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
