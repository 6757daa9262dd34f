// The stages of frozen hair, made of the equations of frozen_hair_oracle.c.
#include "frozen_hair_oracle.h"

#include <stdlib.h>
#include <string.h>

static const double3* base_shape( const frozen_oracle_hair* hair, const frozen_oracle_options* options )
{
    return options->base == FROZEN_ORACLE_BASE_PREVIOUS ? hair->previous : hair->rest;
}

void frozen_oracle_deform_strand( const frozen_oracle_hair* hair, const frozen_oracle_options* options, int strand,
                                  double3* out )
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

void frozen_oracle_align_strand( const frozen_oracle_hair* hair, const frozen_oracle_options* options, int strand,
                                 const double3* in, double3* out )
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
