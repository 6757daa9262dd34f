// Eq. 1-5 of guide hair, frames and target strands. Curves are in guide_oracle_curves.c, the ghosts that step through
// all of it in guide_oracle_body.c.
#include "guide_oracle.h"

#include <stdlib.h>
#include <string.h>

static const double slow_speed = 1e-6; // m/s; below it a velocity has no direction (section 4.3)

static const double3 zero = { 0.0, 0.0, 0.0 };

// Eq. 1.

double guide_oracle_strand_distance( const double3* detail, int detail_nodes, const double3* guide, int guide_nodes )
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

guide_oracle_rotation guide_oracle_compose( const guide_oracle_rotation* a, const guide_oracle_rotation* b )
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

guide_oracle_rotation guide_oracle_smallest_rotation( double3 from, double3 to, bool* reversed )
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
