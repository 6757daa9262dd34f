#include "frozen_hair_oracle.h"

#include "wisp/module/random.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

frozen_oracle_options frozen_oracle_default_options( void )
{
    frozen_oracle_options options = {
        .theta_max = pi / 4.0,
        .cursor_radius = 0.15,
        .clump_radius = 0.01,
        .clump_iterations = 4,
        .clump_step = 0.1 * 0.01,
        .min_distance = 0.02 * 0.01,
        .lambda_min = 0.0,
        .length_floor = 0.05,
        .epsilon = 0.0,
        .max_depth_change = -1.0,
        .dimension = 3,
        .min_distance_clamp = true,
        .deform = true,
        .align = true,
        .clump = true,
    };
    return options;
}

// Random numbers: u = hash( seed, stream, event; strand, vertex, iteration ).

static double draw( const frozen_oracle_options* o, uint64_t stream, uint64_t event, int s, int i, int k )
{
    wisp_random_key key = wisp_random_make_key( o->seed, stream, event );
    return wisp_random_unit( key, (uint32_t)s, (uint32_t)i, (uint32_t)k );
}

double frozen_oracle_eta( const frozen_oracle_options* options, int strand, int vertex )
{
    return 2.0 * draw( options, 1, options->event, strand, vertex, 0 ) - 1.0;
}

double frozen_oracle_xi( const frozen_oracle_options* options, int strand, int vertex )
{
    return 2.0 * draw( options, 2, options->event, strand, vertex, 0 ) - 1.0;
}

double frozen_oracle_zeta( const frozen_oracle_options* options, int strand, int vertex, int iteration )
{
    return draw( options, 3, options->event, strand, vertex, iteration );
}

// The fallback axis depends on the hair, not on the command: the event is left out.
double frozen_oracle_psi( const frozen_oracle_options* options, int strand, int vertex )
{
    return 2.0 * pi * draw( options, 4, 0, strand, vertex, 0 );
}

// Equations 2 to 7.

double3 frozen_oracle_tangent( double3 segment, double3 previous_tangent )
{
    double length = double3_length( segment );
    return length > 1e-12 ? double3_scale( 1.0 / length, segment ) : previous_tangent;
}

double frozen_oracle_softness( double stiffness, double epsilon )
{
    return 1.0 / ( stiffness + epsilon );
}

double frozen_oracle_target_length( double rest_length, double alpha, double eta, double floor_fraction )
{
    return fmax( rest_length * ( 1.0 + alpha * eta ), floor_fraction * rest_length );
}

double frozen_oracle_bend_angle( double theta_max, double alpha, double xi )
{
    return theta_max * alpha * xi;
}

void frozen_oracle_frame( double3 unit, double3* b1, double3* b2 )
{
    double sign = unit.z >= 0.0 ? 1.0 : -1.0;
    double a = -1.0 / ( sign + unit.z );
    double b = unit.x * unit.y * a;
    *b1 = double3_make( 1.0 + sign * unit.x * unit.x * a, sign * b, -sign * unit.x );
    *b2 = double3_make( b, sign + unit.y * unit.y * a, -unit.y );
}

bool frozen_oracle_has_depth( const frozen_oracle_options* options )
{
    return options->max_depth_change >= 0.0;
}

double3 frozen_oracle_upright_axis( double3 tangent )
{
    double across = hypot( tangent.x, tangent.y );
    double3 b1, b2;
    frozen_oracle_frame( tangent, &b1, &b2 );
    return across > 1e-6 ? double3_make( -tangent.z * tangent.x / across, -tangent.z * tangent.y / across, across )
                         : b1;
}

double3 frozen_oracle_bend_axis( double3 previous_tangent, double3 tangent, int vertex, int dimension, double psi )
{
    double3 cross = double3_cross( previous_tangent, tangent );
    double length = double3_length( cross );
    if ( vertex > 1 && length >= 1e-8 )
    {
        return double3_scale( 1.0 / length, cross );
    }
    if ( dimension == 2 )
    {
        return double3_make( 0.0, 0.0, 1.0 );
    }
    double3 b1, b2;
    frozen_oracle_frame( tangent, &b1, &b2 );
    return double3_add( double3_scale( cos( psi ), b1 ), double3_scale( sin( psi ), b2 ) );
}

void frozen_oracle_rodrigues( double3 axis, double angle, double matrix[3][3] )
{
    const double a[3] = { axis.x, axis.y, axis.z };
    const double cross[3][3] = { { 0.0, -axis.z, axis.y }, { axis.z, 0.0, -axis.x }, { -axis.y, axis.x, 0.0 } };
    for ( int row = 0; row < 3; ++row )
    {
        for ( int column = 0; column < 3; ++column )
        {
            double identity = row == column ? 1.0 : 0.0;
            matrix[row][column] = cos( angle ) * identity + ( 1.0 - cos( angle ) ) * a[row] * a[column] +
                                  sin( angle ) * cross[row][column];
        }
    }
}

double3 frozen_oracle_rotate( double3 axis, double angle, double3 v )
{
    double m[3][3];
    frozen_oracle_rodrigues( axis, angle, m );
    return double3_make( m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                         m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z );
}

frozen_oracle_segment frozen_oracle_jitter( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                            const double3* base, int strand, int vertex, double3 previous_tangent )
{
    int v = hair->offsets[strand] + vertex;
    double alpha_s = frozen_oracle_softness( hair->stretch_stiffness[strand], options->epsilon );
    double alpha_b = frozen_oracle_softness( hair->bend_stiffness[strand], options->epsilon );
    double eta = frozen_oracle_eta( options, strand, vertex );
    double xi = frozen_oracle_xi( options, strand, vertex );
    double psi = frozen_oracle_psi( options, strand, vertex );
    double3 d = double3_sub( base[v], base[v - 1] );
    double length = double3_length( d );

    frozen_oracle_segment g;
    g.rest_length = double3_distance( hair->rest[v], hair->rest[v - 1] );
    g.target_length = frozen_oracle_target_length( g.rest_length, alpha_s, eta, options->length_floor );
    g.tangent = frozen_oracle_tangent( d, previous_tangent );
    bool is_bent = vertex > 1 && double3_length( double3_cross( previous_tangent, g.tangent ) ) >= 1e-8;
    g.axis = frozen_oracle_has_depth( options ) && !is_bent
                 ? frozen_oracle_upright_axis( g.tangent )
                 : frozen_oracle_bend_axis( previous_tangent, g.tangent, vertex, options->dimension, psi );
    g.angle = frozen_oracle_bend_angle( options->theta_max, alpha_b, xi );
    g.direction = frozen_oracle_rotate( g.axis, g.angle, g.tangent );

    // The printed division by |d~| + eps shortens the step a little; without eps it is exactly one.
    double shrink = options->epsilon > 0.0 ? length / ( length + options->epsilon ) : 1.0;
    g.step = double3_scale( g.target_length * shrink, g.direction );
    return g;
}

void frozen_oracle_limit_depth( const double3* base, int count, double limit, double3* points )
{
    double3 before = count > 0 ? points[0] : double3_make( 0.0, 0.0, 0.0 );
    for ( int i = 1; i < count; ++i )
    {
        double3 d = double3_sub( points[i], before );
        before = points[i];
        double z = fmin( fmax( points[i].z, base[i].z - limit ), base[i].z + limit );
        double dz = z - points[i - 1].z;
        if ( dz != d.z )
        {
            double across = hypot( d.x, d.y ), wanted = double3_dot( d, d ) - dz * dz;
            double factor = across > 1e-12 && wanted > 0.0 ? sqrt( wanted ) / across : 0.0;
            d = double3_make( factor * d.x, factor * d.y, dz );
        }
        points[i] = double3_make( points[i - 1].x + d.x, points[i - 1].y + d.y, z );
    }
}

// Equations 8 to 13.

// In the plane and with a limit of depth, z turns and moves nothing.
bool frozen_oracle_is_in_plane( const frozen_oracle_options* options )
{
    return options->dimension == 2 || frozen_oracle_has_depth( options );
}

double3 frozen_oracle_without_depth( const frozen_oracle_options* options, double3 v )
{
    return frozen_oracle_is_in_plane( options ) ? double3_make( v.x, v.y, 0.0 ) : v;
}

double3 frozen_oracle_representative( const double3* points, int count, frozen_oracle_direction direction )
{
    double3 from = points[0];
    if ( direction == FROZEN_ORACLE_DIRECTION_MEAN )
    {
        double3 sum = { 0.0, 0.0, 0.0 };
        for ( int i = 0; i < count; ++i )
        {
            sum = double3_add( sum, points[i] );
        }
        from = double3_scale( 1.0 / count, sum );
    }
    return double3_sub( points[count - 1], from );
}

bool frozen_oracle_in_reach( const double3* points, int count, double3 cursor, double radius,
                             frozen_oracle_reach reach )
{
    int first = reach == FROZEN_ORACLE_REACH_TIP ? count - 1 : 0;
    for ( int i = first; i < count; ++i )
    {
        if ( double3_distance( points[i], cursor ) <= radius )
        {
            return true;
        }
    }
    return false;
}

bool frozen_oracle_turn( double3 v, double3 u, int dimension, double3* axis, double* phi )
{
    double v_length = double3_length( v ), u_length = double3_length( u );
    if ( v_length < 1e-12 || u_length < 1e-12 )
    {
        return false;
    }
    double3 cross = double3_cross( v, u );
    double cross_length = double3_length( cross );
    *phi = atan2( cross_length, double3_dot( v, u ) );
    if ( cross_length > 1e-12 * v_length * u_length )
    {
        *axis = double3_scale( 1.0 / cross_length, cross );
    }
    else if ( dimension == 2 )
    {
        *axis = double3_make( 0.0, 0.0, 1.0 );
    }
    else
    {
        double3 unused;
        frozen_oracle_frame( double3_scale( 1.0 / v_length, v ), axis, &unused );
    }
    return true;
}

double frozen_oracle_weight( int vertex, int count, double intensity )
{
    if ( count <= 1 )
    {
        return intensity;
    }
    double t = (double)vertex / ( count - 1 );
    return t * ( 1.0 - intensity ) + intensity;
}

double3 frozen_oracle_blend_point( frozen_oracle_blend blend, double3 root, double3 point, double3 axis, double phi,
                                   double weight )
{
    double3 arm = double3_sub( point, root );
    if ( blend == FROZEN_ORACLE_BLEND_ARC )
    {
        return double3_add( root, frozen_oracle_rotate( axis, weight * phi, arm ) );
    }
    double3 turned = double3_scale( weight, frozen_oracle_rotate( axis, phi, arm ) );
    return double3_add( double3_add( root, turned ), double3_scale( 1.0 - weight, arm ) );
}

// Equations 14 to 19.

double frozen_oracle_kernel( double distance, double radius )
{
    double rest = 1.0 - distance / radius;
    return distance >= 0.0 && distance < radius ? rest * rest : 0.0;
}

static bool belongs_to( const frozen_oracle_hair* hair, int strand, int v )
{
    return v >= hair->offsets[strand] && v < hair->offsets[strand + 1];
}

frozen_oracle_adhesion frozen_oracle_adhere( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                             const double3* points, int strand, int vertex, const int* order )
{
    frozen_oracle_adhesion sum = { { 0.0, 0.0, 0.0 }, INFINITY, 0 };
    double3 p = points[hair->offsets[strand] + vertex];
    int count = hair->offsets[hair->strand_count];
    for ( int n = 0; n < count; ++n )
    {
        int q = order != NULL ? order[n] : n;
        double3 d = double3_sub( points[q], p );
        double r = double3_length( d );

        // A vertex of the same strand is no neighbour; a coincident vertex has no direction.
        if ( belongs_to( hair, strand, q ) || r == 0.0 || r >= options->clump_radius )
        {
            continue;
        }
        double g = frozen_oracle_kernel( r, options->clump_radius );
        sum.force = double3_add( sum.force, double3_scale( g / ( r + options->epsilon ), d ) );
        sum.nearest = fmin( sum.nearest, r );
        sum.neighbours += 1;
    }
    return sum;
}

double3 frozen_oracle_tentative_step( const frozen_oracle_options* options, frozen_oracle_adhesion adhesion )
{
    double3 step = frozen_oracle_without_depth( options, double3_scale( options->clump_step, adhesion.force ) );
    double length = double3_length( step );
    double limit = fmax( 0.0, ( adhesion.nearest - options->min_distance ) / 2.0 );
    if ( options->min_distance_clamp && length > limit )
    {
        step = double3_scale( limit / length, step );
    }
    return step;
}

static double clamp_unit( double value )
{
    return fmin( fmax( value, 0.0 ), 1.0 );
}

double frozen_oracle_pair_delta( frozen_oracle_gap gap, double r0, double r1, double radius )
{
    switch ( gap )
    {
        case FROZEN_ORACLE_GAP_SIGNED:
            return clamp_unit( ( r1 - r0 ) / radius );
        case FROZEN_ORACLE_GAP_REVERSED:
            return clamp_unit( ( r0 - r1 ) / radius );
        case FROZEN_ORACLE_GAP_ABSOLUTE:
            return clamp_unit( fabs( r1 - r0 ) / radius );
        case FROZEN_ORACLE_GAP_NONE:
            break;
    }
    return 0.0;
}

double frozen_oracle_vertex_delta( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                   const double3* reference, const double3* tentative, int strand, int vertex,
                                   const int* order )
{
    double h = options->clump_radius, weighted = 0.0, weights = 0.0;
    int v = hair->offsets[strand] + vertex;
    int count = hair->offsets[hair->strand_count];
    for ( int n = 0; n < count; ++n )
    {
        int q = order != NULL ? order[n] : n;
        double r0 = double3_distance( reference[q], reference[v] );
        if ( belongs_to( hair, strand, q ) || r0 == 0.0 || r0 >= h )
        {
            continue;
        }
        double r1 = double3_distance( tentative[q], tentative[v] );
        weighted += frozen_oracle_kernel( r0, h ) * frozen_oracle_pair_delta( options->gap, r0, r1, h );
        weights += frozen_oracle_kernel( r0, h );
    }
    return weights > 0.0 ? weighted / weights : 0.0;
}

double frozen_oracle_lambda( frozen_oracle_gap gap, double delta, double zeta, double lambda_min )
{
    if ( gap == FROZEN_ORACLE_GAP_NONE )
    {
        return 1.0;
    }
    double at_full_change = gap == FROZEN_ORACLE_GAP_ABSOLUTE ? lambda_min : 1.0;
    return ( 1.0 - delta ) * zeta + delta * at_full_change;
}
