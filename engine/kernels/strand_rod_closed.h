// Closed rods; part of strand_rod.c. Vertex 0 is between the last segment and the first. The twist is a cyclic tridiagonal
// system, solved as the lengths of closed strands (strand_stretch_closed.h). Bending is F, that of the vertices from 2 on,
// and the response of those to the vertices 0 and 1 (modules/strands/rod_factors.c).
#pragma once

#include "strand_rod_twist.h"

// Factor of the diagonal of twist: a rod without rest curvature may turn about itself as a whole, and nothing holds it.
#define CLOSED_DIAGONAL ( 1.0f + 1e-5f )

enum
{
    RESPONSE_ROW = 2 * WISP_LANES,
};

LANE_INLINE float* scratch_at( const wisp_strand_rod_args* args, int row, int first )
{
    return args->scratch + (size_t)( row - first ) * ROW;
}

// Assembles a segment of the balance of twist: its diagonal and what is out of balance.
static void twist_row( const float* own, const float* next, lane16 own_twist, lane16 next_twist, lane16* diagonal,
                       lane16* residual )
{
    const lane16 half = lane16_set1( 0.5f );
    const lane16 slopes = lane16_add( lane16_load( own + SLOPE ), lane16_load( next + SLOPE ) );
    *diagonal =
        lane16_mul( lane16_add( lane16_add( own_twist, next_twist ), slopes ), lane16_set1( CLOSED_DIAGONAL ) );
    *residual = lane16_add( lane16_sub( lane16_load( own + MOMENT ), lane16_load( next + MOMENT ) ),
                            lane16_mul( half, lane16_add( lane16_load( own + LOAD ), lane16_load( next + LOAD ) ) ) );
}

// Eliminates the turns of all segments and their response to u. @return v_{n-1}
static lane16 eliminate_closed_twist( const wisp_strand_rod_args* args, int first, int last )
{
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), least = lane16_set1( 1e-30f );
    const float* root = args->scratch;
    const lane16 root_twist = lanes_of( args->twist_stiffness, first );
    const lane16 corner = lane16_sub( lane16_load( root + SLOPE ), root_twist );
    lane16 own0, v_end = zero, coupling = zero, y = zero, z = zero, unused;
    twist_row( root, root + ROW, root_twist, lanes_of( args->twist_stiffness, first + 1 ), &own0, &unused );
    v_end = lane16_select( lane16_lt( least, own0 ), lane16_neg( lane16_div( corner, own0 ) ), zero );
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = scratch_at( args, row, first );
        const lane16m ends = loop16_ends( args->inverse_length, row );
        lane16 diagonal, residual, end_diagonal, end_residual;
        const lane16 own_twist = lanes_of( args->twist_stiffness, row );
        const float* next = row + 2 < last ? at + ROW : root; // the last row of scratch is not measured
        twist_row( at, next, own_twist, lanes_of( args->twist_stiffness, row + 1 ), &diagonal, &residual );
        twist_row( at, root, own_twist, root_twist, &end_diagonal, &end_residual );
        diagonal = lane16_select( ends, end_diagonal, diagonal );
        residual = lane16_select( ends, end_residual, residual );
        const lane16 extra =
            row == first ? own0 : lane16_select( ends, lane16_neg( lane16_mul( corner, v_end ) ), zero );
        const lane16 u = row == first ? lane16_neg( own0 ) : lane16_select( ends, corner, zero );
        // beyond the last segment nothing turns
        const lane16m is_segment = lane16_lt( zero, lanes_of( args->inverse_length, row ) );
        const lane16 off = row > first
                               ? lane16_select( is_segment, lane16_sub( lane16_load( at + SLOPE ), own_twist ), zero )
                               : zero;
        const lane16 pivot = lane16_sub( lane16_add( diagonal, extra ), lane16_mul( off, coupling ) );
        const lane16m turns = lane16m_and( is_segment, lane16_lt( least, pivot ) );
        const lane16 inverse = lane16_select( turns, lane16_div( one, pivot ), zero );
        y = lane16_mul( lane16_neg( lane16_add( residual, lane16_mul( off, y ) ) ), inverse );
        z = lane16_mul( lane16_sub( u, lane16_mul( off, z ) ), inverse );
        const lane16 next_off = lane16_select(
            ends, zero, lane16_sub( lane16_load( next + SLOPE ), lanes_of( args->twist_stiffness, row + 1 ) ) );
        coupling = lane16_mul( next_off, inverse );
        lane16_store( at + TURN, y );
        lane16_store( at + COUPLING, coupling );
        lane16_store( section_of( args, row, first ), z );
    }
    return v_end;
}

// Brings twist to balance all around; turns are left for turn_segments().
static void balance_closed_twist( const wisp_strand_rod_args* args, int first, int last )
{
    const lane16 zero = lane16_zero(), least = lane16_set1( 1e-6f );
    const lane16 v_end = eliminate_closed_twist( args, first, last );
    lane16 y = zero, z = zero, vy = zero, vz = zero;
    for ( int row = last - 2; row >= first; --row )
    {
        float *at = scratch_at( args, row, first ), *response = section_of( args, row, first );
        const lane16 coupling = lane16_load( at + COUPLING );
        y = lane16_sub( lane16_load( at + TURN ), lane16_mul( coupling, y ) );
        z = lane16_sub( lane16_load( response ), lane16_mul( coupling, z ) );
        lane16_store( at + TURN, y );
        lane16_store( response, z );
        const lane16m ends = loop16_ends( args->inverse_length, row );
        vy = lane16_select( ends, lane16_mul( v_end, y ), vy );
        vz = lane16_select( ends, lane16_mul( v_end, z ), vz );
    }
    const lane16 closing = lane16_add( lane16_set1( 1.0f ), lane16_add( z, vz ) );
    const lane16 factor = lane16_div( lane16_add( y, vy ), lane16_max( closing, least ) );
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = scratch_at( args, row, first );
        const lane16 response = lane16_load( section_of( args, row, first ) );
        lane16_store( at + TURN, lane16_sub( lane16_load( at + TURN ), lane16_mul( factor, response ) ) );
        lane16_store( at + COUPLING, zero );
    }
}

// ---- tension ----

static void pull_closed( const wisp_strand_rod_args* args, const step_lanes* step, int group, int first, int last )
{
    const lane16 zero = lane16_zero(), minus_dt2 = lane16_mul( lane16_neg( step->dt ), step->dt );
    const lane16 back = acceleration_offset( args, step, group );
    lane16v end = { zero, zero, zero };
    for ( int row = first; row + 1 < last; ++row )
    {
        const lane16 most = lanes_of( args->max_tension, row );
        float* at = args->tension + (size_t)row * WISP_LANES;
        const lane16 tension = lane16_max( lane16_neg( most ), lane16_min( most, lane16_load( at ) ) );
        const lane16 fraction = lane16_mul( tension, lanes_of( args->inverse_length, row ) );
        const lane16v behind = lane16v_scale( unaccelerated( args, row, back ), lane16_mul( fraction, minus_dt2 ) );
        lane16_store( at, tension );
        lane16v_store( scratch_at( args, row, first ) + SOLVED, behind );
        end = lane16v_select( loop16_ends( args->inverse_length, row ), behind, end );
    }
    // of vertices whose moves change the segments, once all pulls are known
    lane16v before = end, moved_before = { zero, zero, zero }, root = moved_before;
    for ( int row = first; row < last; ++row )
    {
        const lane16v none = { zero, zero, zero };
        const lane16v behind = row + 1 < last ? lane16v_load( scratch_at( args, row, first ) + SOLVED ) : none;
        lane16v moved = lane16v_scale( lane16v_sub( behind, before ), lanes_of( args->inverse_mass, row ) );
        if ( row > first )
        {
            moved = lane16v_select( loop16_ends( args->inverse_length, row - 1 ), root, moved );
            stretch_segment( args, row - 1, moved_before, moved );
        }
        root = row > first ? root : moved;
        accelerate( args, step, row, moved );
        before = behind;
        moved_before = moved;
    }
}

// ---- bending ----

// The right-hand side of the vertices 0 and 1, less what the others respond with.
typedef struct joint_load
{
    lane16v r0, r1;
} joint_load;

// Stores the gradient of each segment by its vector. @return that of the last segment
static lane16v load_closed( const wisp_strand_rod_args* args, const step_lanes* step, int first, int last )
{
    const lane16 zero = lane16_zero(), dt2 = lane16_mul( step->dt, step->dt );
    const lane16 half_dt2 = lane16_mul( lane16_set1( 0.5f ), dt2 );
    const lane16 damping = lane16_mul( lane16_set1( args->damping ), step->dt );
    const lane16v none = { zero, zero, zero };
    lane16v t_end = none, change_end = none, end = none;
    for ( int row = first; row + 1 < last; ++row )
    {
        const lane16m ends = loop16_ends( args->inverse_length, row );
        t_end = lane16v_select( ends, direction_of( args, row, lane16v_load( segment_of( args, row ) ) ), t_end );
        change_end = lane16v_select( ends, args->damping > 0.0f ? change_of( args, step, row ) : none, change_end );
    }
    lane16v t = direction_of( args, first, lane16v_load( segment_of( args, first ) ) );
    lane16v change = args->damping > 0.0f ? change_of( args, step, first ) : none;
    const lane16v joint =
        bend_vertex( args, dt2, first, first, t_end, t, lane16v_scale( lane16v_sub( change, change_end ), damping ) );
    lane16v own = joint;
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = scratch_at( args, row, first );
        const lane16m ends = loop16_ends( args->inverse_length, row );
        lane16v next = none;
        if ( row + 2 < last )
        {
            const lane16v u = direction_of( args, row + 1, lane16v_load( segment_of( args, row + 1 ) ) );
            const lane16v now = args->damping > 0.0f ? change_of( args, step, row + 1 ) : none;
            next =
                bend_vertex( args, dt2, row + 1, first, t, u, lane16v_scale( lane16v_sub( now, change ), damping ) );
            t = u;
            change = now;
        }
        next = lane16v_select( ends, joint, next );
        const lane16v turned = lane16v_mul_add( lane16v_sub( own, next ), half_dt2, lane16v_load( at + TURNING ) );
        const lane16v gradient = lane16v_scale( turned, lanes_of( args->inverse_length, row ) );
        lane16v_store( at + SOLVED, gradient );
        end = lane16v_select( ends, gradient, end );
        own = next;
    }
    return end;
}

LANE_INLINE const float* response_at( const wisp_strand_rod_args* args, int row )
{
    return args->response + (size_t)row * RESPONSE_ROW;
}

// Forms the right-hand side of each vertex from the gradients, and eliminates those of F.
static joint_load eliminate_closed( const wisp_strand_rod_args* args, int first, int last, lane16v end )
{
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    lane16v before = end;
    joint_load joint = { none, none };
    forward_sweep sweep = { none, none };
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = scratch_at( args, row, first );
        const lane16v gradient = lane16v_load( at + SOLVED ), r = lane16v_sub( gradient, before );
        const float* factor = args->factor + (size_t)row * STRIDE;
        const float* response = response_at( args, row );
        const lane16m is_segment = lane16_lt( zero, lanes_of( args->inverse_length, row ) );
        lane16v y = none;
        if ( row < first + 2 )
        {
            joint.r0 = row == first ? r : joint.r0;
            joint.r1 = row == first ? joint.r1 : lane16v_add( joint.r1, r );
        }
        else
        {
            const lane16v z = lane16v_select( is_segment, r, none ); // of a vertex, not of the joint again
            joint.r0 = lane16v_sub( joint.r0, lane16v_scale( z, lane16_load( response ) ) );
            joint.r1 = lane16v_sub( joint.r1, lane16v_scale( z, lane16_load( response + WISP_LANES ) ) );
            y = forward_row( &sweep, factor, z );
        }
        lane16v_store( at + SOLVED, y );
        before = gradient;
    }
    return joint;
}

// Substitutes back. @return the displacements of the vertices 0 and 1
static joint_load substitute_closed( const wisp_strand_rod_args* args, int first, int last, joint_load joint )
{
    const float *s0 = response_at( args, first ), *s1 = response_at( args, first + 1 );
    const lane16 s00 = lane16_load( s0 ), s01 = lane16_load( s0 + WISP_LANES ), s11 = lane16_load( s1 + WISP_LANES );
    const joint_load moved = { lane16v_add( lane16v_scale( joint.r0, s00 ), lane16v_scale( joint.r1, s01 ) ),
                               lane16v_add( lane16v_scale( joint.r0, s01 ), lane16v_scale( joint.r1, s11 ) ) };
    backward_sweep sweep = backward_begin();
    for ( int row = last - 2; row >= first + 2; --row )
    {
        const float* factor = args->factor + (size_t)row * STRIDE;
        float* at = scratch_at( args, row, first ) + SOLVED;
        lane16v_store( at, backward_row( &sweep, factor, lane16v_load( at ) ) );
    }
    return moved;
}

static void move_closed( const wisp_strand_rod_args* args, const step_lanes* step, int first, int last,
                         joint_load moved )
{
    const loop_columns columns = { columns_of( args ), args->position, NULL, NULL, args->velocity };
    lane16v before = moved.r0;
    for ( int row = first; row < last; ++row )
    {
        const lane16 zero = lane16_zero();
        lane16v x = { zero, zero, zero };
        if ( row < first + 2 )
        {
            x = row == first ? moved.r0 : moved.r1;
        }
        else if ( row + 1 < last )
        {
            const float* response = response_at( args, row );
            x = lane16v_load( scratch_at( args, row, first ) + SOLVED );
            x = lane16v_sub( x, lane16v_scale( moved.r0, lane16_load( response ) ) );
            x = lane16v_sub( x, lane16v_scale( moved.r1, lane16_load( response + WISP_LANES ) ) );
        }
        if ( row > first )
        {
            x = lane16v_select( loop16_ends( args->inverse_length, row - 1 ), moved.r0, x );
            stretch_segment( args, row - 1, before, x );
        }
        accelerate( args, step, row, x );
        if ( args->previous != NULL )
        {
            place16_follow( &columns.read, args->position, row, step->dt );
        }
        before = x;
    }
}

static void bend_closed_group( const wisp_strand_rod_args* args, const step_lanes* step, int group, int first,
                               int last )
{
    const bool folds = measure_frames( args, step, group, first, last );
    balance_closed_twist( args, first, last );
    turn_vertices( args, group, first, last, turn_segments( args, first, last ), folds );
    pull_closed( args, step, group, first, last );
    const lane16v end = load_closed( args, step, first, last );
    const joint_load joint = eliminate_closed( args, first, last, end );
    move_closed( args, step, first, last, substitute_closed( args, first, last, joint ) );
}
