#include "frozen_hair_oracle.h"

#include "wisp/module/random.h"
#include <stdlib.h>
#include <string.h>

// ---- stages ----

// The stages of frozen hair, made of the equations of frozen_hair_oracle.c.

static const double3* base_shape( const frozen_oracle_hair* hair, const frozen_oracle_options* options )
{
    return options->base == FROZEN_ORACLE_BASE_PREVIOUS ? hair->previous : hair->rest;
}

// Stage 1 for one strand; strands are independent.
static void frozen_oracle_deform_strand( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                         int strand, double3* out )
{
    const double3* base = base_shape( hair, options );
    int first = hair->offsets[strand];
    int count = hair->offsets[strand + 1] - first;
    double3 tangent = { 0.0, 0.0, 0.0 };
    if ( count > 0 )
    {
        out[first] = base[first];
    }
    for ( int i = 1; i < count; ++i )
    {
        frozen_oracle_segment g = frozen_oracle_jitter( hair, options, base, strand, i, tangent );
        out[first + i] = double3_add( out[first + i - 1], g.step );
        tangent = g.tangent;
    }
    if ( frozen_oracle_has_depth( options ) )
    {
        frozen_oracle_limit_depth( hair->rest + first, count, options->max_depth_change, out + first );
    }
}

void frozen_oracle_deform( const frozen_oracle_hair* hair, const frozen_oracle_options* options, double3* out )
{
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        frozen_oracle_deform_strand( hair, options, s, out );
    }
}

// In the plane, the cursor is as deep as each vertex, and strands turn about z.
static bool reaches( const frozen_oracle_options* options, const double3* points, int count )
{
    if ( !frozen_oracle_is_in_plane( options ) )
    {
        return frozen_oracle_in_reach( points, count, options->cursor, options->cursor_radius, options->reach );
    }
    int first = options->reach == FROZEN_ORACLE_REACH_TIP ? count - 1 : 0;
    bool is_reached = false;
    for ( int i = first; i < count; ++i )
    {
        double3 cursor = double3_make( options->cursor.x, options->cursor.y, points[i].z );
        is_reached = is_reached || double3_distance( points[i], cursor ) <= options->cursor_radius;
    }
    return is_reached;
}

static void turn_points( const frozen_oracle_options* options, double3 target, double intensity, int count,
                         const double3* p, double3* out )
{
    double3 v = frozen_oracle_without_depth( options, frozen_oracle_representative( p, count, options->direction ) ),
            axis;
    double phi;
    bool turns = frozen_oracle_turn( v, frozen_oracle_without_depth( options, target ),
                                     frozen_oracle_is_in_plane( options ) ? 2 : 3, &axis, &phi );
    for ( int i = 0; i < count; ++i )
    {
        out[i] = turns ? frozen_oracle_blend_point( options->blend, p[0], p[i], axis, phi,
                                                    frozen_oracle_weight( i, count, intensity ) )
                       : p[i];
        out[i].z = frozen_oracle_is_in_plane( options ) ? p[i].z : out[i].z;
    }
}

// Stage 2 for one strand.
static void frozen_oracle_align_strand( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                        int strand, const double3* in, double3* out )
{
    int first = hair->offsets[strand];
    int count = hair->offsets[strand + 1] - first;
    memcpy( out + first, in + first, (size_t)count * sizeof( double3 ) );
    if ( count >= 2 && reaches( options, in + first, count ) )
    {
        turn_points( options, double3_sub( options->cursor, in[first] ), hair->intensity[strand], count, in + first,
                     out + first );
    }
}

// R(a, angle) of the shape as a whole, then the smallest rotation that takes the direction of the strand along; or both
// backwards.
static double3 follow_strand( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                              const frozen_oracle_stroke* stroke, int strand, bool back, double3 v )
{
    int first = hair->offsets[strand];
    int count = hair->offsets[strand + 1] - first;
    double3 from = frozen_oracle_representative( hair->rest + first, count, options->direction );
    double3 to = frozen_oracle_representative( stroke->moved + first, count, options->direction ), axis;
    double phi;
    if ( !frozen_oracle_turn( frozen_oracle_rotate( stroke->axis, stroke->angle, from ), to, options->dimension,
                              &axis, &phi ) )
    {
        axis = double3_make( 0.0, 0.0, 1.0 );
        phi = 0.0;
    }
    return back ? frozen_oracle_rotate( stroke->axis, -stroke->angle, frozen_oracle_rotate( axis, -phi, v ) )
                : frozen_oracle_rotate( axis, phi, frozen_oracle_rotate( stroke->axis, stroke->angle, v ) );
}

void frozen_oracle_align_in_stroke( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                    frozen_oracle_stroke* stroke, bool sweeps, int strand, const double3* in,
                                    double3* out )
{
    int first = hair->offsets[strand];
    int count = hair->offsets[strand + 1] - first;
    if ( count < 1 )
    {
        return;
    }
    double3 target = stroke->target[strand];
    if ( stroke->moved != NULL )
    {
        target = follow_strand( hair, options, stroke, strand, false, target );
    }
    turn_points( options, target, stroke->intensity[strand], count, in + first, out + first );
    double3 wanted = double3_sub( options->cursor, in[first] );
    if ( sweeps && count > 1 && double3_length( frozen_oracle_without_depth( options, wanted ) ) >= 1e-12 &&
         reaches( options, out + first, count ) )
    {
        stroke->intensity[strand] = hair->intensity[strand];
        stroke->target[strand] =
            stroke->moved != NULL ? follow_strand( hair, options, stroke, strand, true, wanted ) : wanted;
        turn_points( options, wanted, stroke->intensity[strand], count, in + first, out + first );
    }
}

void frozen_oracle_align( const frozen_oracle_hair* hair, const frozen_oracle_options* options, const double3* in,
                          double3* out )
{
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        frozen_oracle_align_strand( hair, options, s, in, out );
    }
}

// Steps of all vertices before the brake; roots stay where they are.
static void tentative_steps( const frozen_oracle_hair* hair, const frozen_oracle_options* options, const double3* in,
                             const int* order, double3* step, double3* tentative )
{
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        for ( int v = hair->offsets[s]; v < hair->offsets[s + 1]; ++v )
        {
            int i = v - hair->offsets[s];
            step[v] = double3_make( 0.0, 0.0, 0.0 );
            if ( i > 0 )
            {
                step[v] =
                    frozen_oracle_tentative_step( options, frozen_oracle_adhere( hair, options, in, s, i, order ) );
            }
            tentative[v] = double3_add( in[v], step[v] );
        }
    }
}

wisp_status frozen_oracle_clump_step( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                      int iteration, const double3* reference, const double3* in, const int* order,
                                      double* delta, double* lambda, double3* out )
{
    size_t count = (size_t)hair->offsets[hair->strand_count];
    double3* step = malloc( ( 2 * count + 1 ) * sizeof( double3 ) );
    if ( step == NULL )
    {
        return WISP_NO_MEMORY;
    }
    double3* tentative = step + count;
    tentative_steps( hair, options, in, order, step, tentative );

    const double3* r0_shape = options->gap_reference == FROZEN_ORACLE_GAP_REFERENCE_STAGE ? reference : in;
    for ( int s = 0; s < hair->strand_count; ++s )
    {
        for ( int v = hair->offsets[s]; v < hair->offsets[s + 1]; ++v )
        {
            int i = v - hair->offsets[s];
            double change = 0.0, remaining = 0.0;
            if ( i > 0 )
            {
                double zeta = frozen_oracle_zeta( options, s, i, iteration );
                change = frozen_oracle_vertex_delta( hair, options, r0_shape, tentative, s, i, order );
                remaining = frozen_oracle_lambda( options->gap, change, zeta, options->lambda_min );
            }
            out[v] = double3_add( in[v], double3_scale( remaining, step[v] ) );
            if ( delta != NULL )
            {
                delta[v] = change;
            }
            if ( lambda != NULL )
            {
                lambda[v] = remaining;
            }
        }
    }
    free( step );
    return WISP_OK;
}

wisp_status frozen_oracle_clump( const frozen_oracle_hair* hair, const frozen_oracle_options* options,
                                 const double3* in, const int* order, double3* out )
{
    size_t bytes = (size_t)hair->offsets[hair->strand_count] * sizeof( double3 );
    double3* p = malloc( bytes + 1 );
    if ( p == NULL )
    {
        return WISP_NO_MEMORY;
    }
    wisp_status status = WISP_OK;
    memcpy( out, in, bytes );
    for ( int k = 0; k < options->clump_iterations && status == WISP_OK; ++k )
    {
        memcpy( p, out, bytes );
        status = frozen_oracle_clump_step( hair, options, k, in, p, order, NULL, NULL, out );
    }
    free( p );
    return status;
}

wisp_status frozen_oracle_run( const frozen_oracle_hair* hair, const frozen_oracle_options* options, const int* order,
                               double3* out )
{
    if ( hair->strand_count == 0 )
    {
        return WISP_OK;
    }
    size_t bytes = (size_t)hair->offsets[hair->strand_count] * sizeof( double3 );
    double3* p = malloc( bytes + 1 );
    if ( p == NULL )
    {
        return WISP_NO_MEMORY;
    }

    // FreezeDeform: p'
    memcpy( p, base_shape( hair, options ), bytes );
    if ( options->deform )
    {
        frozen_oracle_deform( hair, options, p );
    }

    // UserAlign: p''
    memcpy( out, p, bytes );
    if ( options->align )
    {
        frozen_oracle_align( hair, options, p, out );
    }

    // ClumpWithGaps: p^(K)
    wisp_status status = WISP_OK;
    if ( options->clump )
    {
        memcpy( p, out, bytes );
        status = frozen_oracle_clump( hair, options, p, order, out );
    }
    free( p );
    return status;
}

// ---- frozen hair ----

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

// Eq. 2: unit tangent of a segment, or the previous tangent when the segment has no length.
static double3 frozen_oracle_tangent( double3 segment, double3 previous_tangent )
{
    double length = double3_length( segment );
    return length > 1e-12 ? double3_scale( 1.0 / length, segment ) : previous_tangent;
}

// alpha = 1 / (k + eps), the softness that goes with a stiffness.
static double frozen_oracle_softness( double stiffness, double epsilon )
{
    return 1.0 / ( stiffness + epsilon );
}

// Eq. 3 with a floor: l* = max( l0 (1 + alpha eta), floor l0 ).
static double frozen_oracle_target_length( double rest_length, double alpha, double eta, double floor_fraction )
{
    return fmax( rest_length * ( 1.0 + alpha * eta ), floor_fraction * rest_length );
}

// Eq. 4, first part: theta = theta_max alpha xi.
static double frozen_oracle_bend_angle( double theta_max, double alpha, double xi )
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

// 2.5D: the unit vector perpendicular to a tangent that is nearest to z, in place of the fallback: the tangent bends along x
// and y alone. Along z any perpendicular is.
static double3 frozen_oracle_upright_axis( double3 tangent )
{
    double across = hypot( tangent.x, tangent.y );
    double3 b1, b2;
    frozen_oracle_frame( tangent, &b1, &b2 );
    return across > 1e-6 ? double3_make( -tangent.z * tangent.x / across, -tangent.z * tangent.y / across, across )
                         : b1;
}

// Eq. 4, second part: the unit axis of a bend, with a fallback for straight hair and for the first segment.
static double3 frozen_oracle_bend_axis( double3 previous_tangent, double3 tangent, int vertex, int dimension,
                                        double psi )
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

// Eq. 5: the rotation matrix R(axis, angle), rows first; the axis must be of unit length.
static void frozen_oracle_rodrigues( double3 axis, double angle, double matrix[3][3] )
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
