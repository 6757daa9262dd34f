// Lengths of closed strands; part of strand_stretch.c. J W J^T is that of an open strand with free ends and two corners,
// A_{0,n-1} = -w_0 e_{n-1} . e_0 = c. With T' = A - u v^T, u = (-A_00, 0 .., c), v = (1, 0 .., -c / A_00), which is
// tridiagonal and as definite, two right-hand sides are solved at once (Sherman and Morrison 1950):
//
//   T' y = -C,   T' z = u,   dlambda = y - z (v . y) / (1 + v . z)
#pragma once

#include "strand_stretch_reset.h"

// Values of a row of a closed strand in scratch.
enum
{
    CLOSED_ROW = 3 * WISP_LANES,
    CLOSED_MULTIPLIER = 0,
    CLOSED_RESPONSE = WISP_LANES, // z
    CLOSED_COUPLING = 2 * WISP_LANES,
};
_Static_assert( CLOSED_ROW <= WISP_STRAND_SCRATCH, "a closed strand has the scratch of its group" );

// Least 1 + v . z, which is above 0 but for rounding.
#define MIN_CLOSING 1e-6f

static float* closed_row( const chain* c, int row )
{
    return c->values + (size_t)( row - c->first ) * CLOSED_ROW;
}

static float* segment_at( const wisp_strand_stretch_args* args, int row )
{
    return args->segment + (size_t)row * STRIDE;
}

// Finds segments where vertices are. A segment beyond the last one is 0.
// @return lanes with a segment that is not exact
static lane16m measure_closed( const wisp_strand_stretch_args* args, const chain* c )
{
    const lane16 zero = lane16_zero(), limit = lane16_set1( fminf( EXACT, 2.0f * args->tolerance ) );
    const lane16v none = { zero, zero, zero };
    lane16m inexact = lane16_lt( zero, zero );
    place16 p = solved_place( args, c, c->first );
    for ( int row = c->first; row + 1 < c->last; ++row )
    {
        const place16 next = solved_place( args, c, row + 1 );
        const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
        const lane16m is_segment = lane16_lt( zero, length );
        const lane16v e = lane16v_select( is_segment, place16_sub( &p, &next ), none );
        lane16v_store( segment_at( args, row ), e );
        inexact = lane16m_or( inexact, lane16m_and_not( is_segment, is_within( e, length, limit ) ) );
        p = next;
    }
    return inexact;
}

// Eliminates both right-hand sides. @return v_{n-1}, the last entry of v
static lane16 eliminate_closed( const wisp_strand_stretch_args* args, const chain* c )
{
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), held = lane16_set1( HELD_DIAGONAL );
    const lane16v e0 = lane16v_load( segment_at( args, c->first ) );
    const lane16v end = loop16_gather( args->length, args->segment, c->first, c->last );
    lane16 w = lane16_load( args->inverse_mass + (size_t)c->first * WISP_LANES );
    const lane16 w1 = lane16_load( args->inverse_mass + (size_t)( c->first + 1 ) * WISP_LANES );
    const lane16 corner = lane16_neg( lane16_mul( w, lane16v_dot( end, e0 ) ) );
    const lane16 own0 = lane16_mul( lane16_mul( lane16_add( w, w1 ), lane16v_dot( e0, e0 ) ), held );
    const lane16m has_first = lane16_lt( lane16_set1( MIN_PIVOT ), own0 );
    const lane16 v_end = lane16_select( has_first, lane16_neg( lane16_div( corner, own0 ) ), zero );
    lane16v before = { zero, zero, zero };
    lane16 inverse_before = zero, y = zero, z = zero;
    for ( int row = c->first; row + 1 < c->last; ++row )
    {
        const lane16v e = lane16v_load( segment_at( args, row ) );
        const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
        const lane16 w_next = lane16_load( args->inverse_mass + (size_t)( row + 1 ) * WISP_LANES );
        const lane16m ends = loop16_ends( args->length, row );
        const lane16 squared = lane16v_dot( e, e ), off = lane16_mul( w, lane16v_dot( before, e ) );
        const lane16 deficit = lane16_mul( lane16_set1( 0.5f ), lane16_sub( lane16_mul( length, length ), squared ) );
        const lane16 own = lane16_mul( lane16_mul( lane16_add( w, w_next ), squared ), held );
        // A - u v^T: A_00 twice, and - c v_{n-1} at the end
        const lane16 extra =
            row == c->first ? own0 : lane16_select( ends, lane16_neg( lane16_mul( corner, v_end ) ), zero );
        const lane16 u = row == c->first ? lane16_neg( own0 ) : lane16_select( ends, corner, zero );
        const lane16 coupling = lane16_mul( off, inverse_before );
        const lane16 pivot = lane16_sub( lane16_add( own, extra ), lane16_mul( off, coupling ) );
        const lane16m solvable = lane16_lt( lane16_set1( MIN_PIVOT ), pivot );
        const lane16 inverse = lane16_select( solvable, lane16_div( one, pivot ), zero );
        y = lane16_mul( lane16_mul_add( off, y, deficit ), inverse );
        z = lane16_mul( lane16_mul_add( off, z, u ), inverse );
        float* out = closed_row( c, row );
        lane16_store( out + CLOSED_MULTIPLIER, y );
        lane16_store( out + CLOSED_RESPONSE, z );
        lane16_store( out + CLOSED_COUPLING, coupling );
        before = e;
        w = w_next;
        inverse_before = inverse;
    }
    return v_end;
}

// Substitutes back. @return the factor of z: (v . y) / (1 + v . z)
static lane16 substitute_closed( const wisp_strand_stretch_args* args, const chain* c, lane16 v_end )
{
    const lane16 zero = lane16_zero();
    lane16 y = zero, z = zero, coupling = zero, vy = zero, vz = zero;
    for ( int row = c->last - 2; row >= c->first; --row )
    {
        float* at = closed_row( c, row );
        y = lane16_mul_add( coupling, y, lane16_load( at + CLOSED_MULTIPLIER ) );
        z = lane16_mul_add( coupling, z, lane16_load( at + CLOSED_RESPONSE ) );
        lane16_store( at + CLOSED_MULTIPLIER, y );
        lane16_store( at + CLOSED_RESPONSE, z );
        const lane16m ends = loop16_ends( args->length, row );
        vy = lane16_select( ends, lane16_mul( v_end, y ), vy );
        vz = lane16_select( ends, lane16_mul( v_end, z ), vz );
        coupling = lane16_load( at + CLOSED_COUPLING );
    }
    const lane16 closing = lane16_add( lane16_set1( 1.0f ), lane16_add( z, vz ) );
    return lane16_div( lane16_add( y, vy ), lane16_max( closing, lane16_set1( MIN_CLOSING ) ) );
}

// Returns the correction of a vertex by the segment from its row, and adds the tension.
static lane16v pull_closed( const wisp_strand_stretch_args* args, const chain* c, int row, lane16 factor )
{
    const float* at = closed_row( c, row );
    const lane16v e = lane16v_load( segment_at( args, row ) );
    const lane16 multiplier = lane16_sub( lane16_load( at + CLOSED_MULTIPLIER ),
                                          lane16_mul( factor, lane16_load( at + CLOSED_RESPONSE ) ) );
    if ( args->tension != NULL )
    {
        float* tension = args->tension + (size_t)row * WISP_LANES;
        const lane16 change = lane16_mul( lane16_mul( multiplier, lane16v_length( e ) ), c->per_tension );
        lane16_store( tension, lane16_sub( lane16_load( tension ), change ) );
    }
    return lane16v_scale( e, multiplier );
}

static void move_closed( const wisp_strand_stretch_args* args, const chain* c, int row, lane16v pull )
{
    float* at = args->velocity + (size_t)row * STRIDE;
    const lane16 w = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ), zero = lane16_zero();
    const lane16v v = lane16v_load( at );
    const lane16v faster = lane16v_mul_add( v, c->inverse_dt, lane16v_scale( pull, w ) );
    lane16v_store( at, lane16v_select( lane16_lt( zero, w ), faster, v ) );
}

// Moves the vertices by the multipliers of both of their segments, around the loop.
static void apply_closed( const wisp_strand_stretch_args* args, const chain* c, lane16 factor )
{
    const lane16 zero = lane16_zero();
    const lane16v own = pull_closed( args, c, c->first, factor );
    lane16v before = own, end = { zero, zero, zero };
    for ( int row = c->first + 1; row + 1 < c->last; ++row )
    {
        const lane16v pull = pull_closed( args, c, row, factor );
        end = lane16v_select( loop16_ends( args->length, row ), pull, end );
        move_closed( args, c, row, lane16v_sub( pull, before ) );
        before = pull;
    }
    move_closed( args, c, c->first, lane16v_sub( own, end ) );
}

static loop_columns loop_columns_of( const wisp_strand_stretch_args* args )
{
    return ( loop_columns ){ columns_of( args ), args->position, args->previous, args->low, args->velocity };
}

// Lets predicted positions follow, and the last vertex its first.
static void follow_closed( const wisp_strand_stretch_args* args, const chain* c )
{
    const loop_columns columns = loop_columns_of( args );
    for ( int row = c->first; row < c->last && args->previous != NULL; ++row )
    {
        place16_follow( &columns.read, args->position, row, c->dt );
    }
    loop16_copy( &columns, args->length, c->first, c->last );
}

static void stretch_closed_group( const wisp_strand_stretch_args* args, int group )
{
    chain c = chain_of( args, group, args->scratch );
    const loop_columns columns = loop_columns_of( args );
    if ( args->previous != NULL )
    {
        take_moves( args, &c, group );
        for ( int row = c.first; row < c.last; ++row )
        {
            place16_follow( &columns.read, args->position, row, c.dt );
        }
    }
    loop16_join( &columns, args->length, c.first, c.last, c.dt );
    clear_tension( args, c.first, c.last );
    for ( int pass = 0; pass < args->iterations && lane16m_any( measure_closed( args, &c ) ); ++pass )
    {
        const lane16 v_end = eliminate_closed( args, &c );
        apply_closed( args, &c, substitute_closed( args, &c, v_end ) );
        follow_closed( args, &c );
    }
}

static void stretch_closed( const wisp_strand_stretch_args* args, int begin, int end )
{
    for ( int g = begin; g < end; ++g )
    {
        if ( args->group_row[g + 1] - args->group_row[g] > 1 )
        {
            stretch_closed_group( args, g );
        }
    }
}
