// Strands that do not converge or begin again, part of strand_stretch.c.
#pragma once

#include "strand_stretch_iterate.h"

// Loads the vertices of a row after the iterations.
static place16 solved_place( const wisp_strand_stretch_args* args, const chain* c, int row )
{
    const place_columns columns = columns_of( args );
    return place16_load( &columns, row, c->dt, args->previous != NULL );
}

// Selects lanes with a segment that is not within the tolerance. Called only for groups that are not exact.
static lane16m find_inexact( const wisp_strand_stretch_args* args, const chain* c )
{
    const int first = c->first, last = c->last;
    const lane16 zero = lane16_zero(), tolerance = lane16_set1( 2.0f * args->tolerance );
    lane16m bad = lane16_lt( zero, zero );
    place16 p = solved_place( args, c, first );
    for ( int row = first; row + 1 < last; ++row )
    {
        const place16 next = solved_place( args, c, row + 1 );
        const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
        const lane16m good = is_within( place16_sub( &p, &next ), length, tolerance );
        bad = lane16m_or( bad, lane16m_and_not( lane16_lt( zero, length ), good ) );
        p = next;
    }
    return bad;
}

// Selects lanes with a pin beyond the root, which cannot be reset.
static lane16m further_pins( const wisp_strand_stretch_args* args, int first, int last )
{
    const lane16 zero = lane16_zero();
    lane16m pinned = lane16_lt( zero, zero );
    for ( int row = first + 1; row < last; ++row )
    {
        const lane16m is_vertex = lane16_lt( zero, lane16_load( args->length + (size_t)( row - 1 ) * WISP_LANES ) );
        const lane16m holds = lane16_le( lane16_load( args->inverse_mass + (size_t)row * WISP_LANES ), zero );
        pinned = lane16m_or( pinned, lane16m_and( is_vertex, holds ) );
    }
    return pinned;
}

static lane16 whole_length( const wisp_strand_stretch_args* args, int first, int last )
{
    lane16 sum = lane16_zero();
    for ( int row = first; row + 1 < last; ++row )
    {
        sum = lane16_add( sum, lane16_load( args->length + (size_t)row * WISP_LANES ) );
    }
    return sum;
}

// Moves the vertices of a row by `path` from their start, at no more than their predicted speed: the rest moves their
// start. Those that move farther than the strand is long have no velocity.
static void reset_row( const wisp_strand_stretch_args* args, const chain* c, int row, lane16v path,
                       lane16 squared_speed, lane16 reach2, lane16m lanes )
{
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f ), dt = c->dt;
    const size_t at = (size_t)row * STRIDE;
    const place16 p = solved_place( args, c, row );
    const lane16 squared = lane16v_dot( path, path );
    const lane16 predicted = lane16_mul( squared_speed, lane16_mul( dt, dt ) );
    // NaN stays, for the state check to find
    const lane16 slowed =
        lane16_select( lane16_le( squared, predicted ), one, lane16_sqrt( lane16_div( predicted, squared ) ) );
    const lane16 fraction = lane16_select( lane16_le( squared, reach2 ), slowed, zero );
    const lane16v shifted = lane16v_mul_add( p.low, lane16_sub( one, fraction ), path );
    const lane16v start = lane16v_add( p.start, shifted ), low = place16_remainder( p.start, shifted, start );
    const lane16v velocity = lane16v_scale( path, lane16_mul( fraction, c->inverse_dt ) );
    const lane16m moves = lane16m_and( lanes, lane16_lt( zero, p.inverse_mass ) );
    float* from = args->previous != NULL ? args->previous + at : args->position + at;
    lane16v_store( args->velocity + at, lane16v_select( moves, velocity, p.velocity ) );
    lane16v_store( args->low + at, lane16v_select( moves, low, p.low ) );
    lane16v_store( from, lane16v_select( moves, start, lane16v_load( from ) ) );
    if ( args->history.displacement != NULL )
    {
        // the new start is shifted already
        float* shift = args->history.displacement + at;
        const lane16v none = { zero, zero, zero };
        lane16v_store( shift, lane16v_select( moves, none, lane16v_load( shift ) ) );
    }
    if ( args->previous != NULL )
    {
        const place_columns columns = columns_of( args );
        place16_follow( &columns, args->position, row, dt );
    }
}

static void reset_strands( const wisp_strand_stretch_args* args, const chain* c, lane16m lanes )
{
    const int first = c->first, last = c->last;
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f );
    const lane16 reach = whole_length( args, first, last ), reach2 = lane16_mul( reach, reach );
    const place16 root = solved_place( args, c, first );
    place16 before = root;
    lane16v put = root.moved; // relative to the start of the root
    lane16v direction = lane16v_set1( ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
    for ( int row = first; row + 1 < last; ++row )
    {
        const place16 p = solved_place( args, c, row + 1 );
        const lane16v e = place16_sub( &p, &before );
        const lane16 squared = lane16v_dot( e, e );
        // long enough to have a direction, no overflow of the square, not NaN
        const lane16m has_direction =
            lane16m_and( lane16_lt( lane16_set1( 1e-30f ), squared ), lane16_lt( squared, lane16_set1( FLT_MAX ) ) );
        const lane16 inverse = lane16_div( one, lane16_sqrt( squared ) );
        direction = lane16v_select( has_direction, lane16v_scale( e, inverse ), direction );
        put = lane16v_mul_add( put, lane16_load( args->length + (size_t)row * WISP_LANES ), direction );
        const lane16v start = lane16v_add( lane16v_sub( p.start, root.start ), p.low );
        const lane16 speed = lane16_load( args->speed + (size_t)( row + 1 ) * WISP_LANES );
        reset_row( args, c, row + 1, lane16v_sub( put, start ), speed, reach2, lanes );
        before = p;
    }
    // multipliers of iterations that did not converge are not tensions
    for ( int row = first; row < last && args->tension != NULL; ++row )
    {
        float* at = args->tension + (size_t)row * WISP_LANES;
        lane16_store( at, lane16_select( lanes, zero, lane16_load( at ) ) );
    }
}

static int count_lanes( lane16m lanes )
{
    uint32_t bits = lane16m_bits( lanes );
    int count = 0;
    for ( ; bits != 0; bits &= bits - 1 )
    {
        count += 1;
    }
    return count;
}

// Finds segments again where vertices are.
static void find_segments( const wisp_strand_stretch_args* args, const chain* c )
{
    place16 p = solved_place( args, c, c->first );
    for ( int row = c->first; row + 1 < c->last; ++row )
    {
        const place16 next = solved_place( args, c, row + 1 );
        lane16v_store( args->segment + (size_t)row * STRIDE, place16_sub( &p, &next ) );
        p = next;
    }
}

// Makes the substep of some strands one of Euler.
static void break_history( const wisp_strand_stretch_args* args, chain* c, int group, lane16m lanes )
{
    const place_columns columns = columns_of( args );
    const restarted_columns out = { args->previous != NULL ? args->position : NULL, args->low, args->velocity };
    history16_break( &args->history, &columns, &out, c->first, c->last, args->dt, lanes );
    *c = chain_of( args, group, c->values );
}

// Resets strands that did not converge.
// @return number of strands
static int reset_diverged( const wisp_strand_stretch_args* args, chain* c, int group )
{
    const lane16m diverged = lane16m_and_not( find_inexact( args, c ), further_pins( args, c->first, c->last ) );
    if ( lane16m_any( diverged ) )
    {
        reset_strands( args, c, diverged );
        find_segments( args, c );
        if ( args->history.step != NULL )
        {
            break_history( args, c, group, diverged );
        }
    }
    return count_lanes( diverged );
}
