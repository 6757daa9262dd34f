// One Newton iteration of lengths, part of strand_stretch.c: elimination from root to tip, substitution back.
#pragma once

#include "strand_history.h"
#include "strand_loop.h"

#include <math.h>

static const size_t STRIDE = 3 * WISP_LANES;

// Values of a row kept in scratch for the sweep back: the multiplier of its segment so far and the coupling to the
// next one.
enum
{
    ROW = 2 * WISP_LANES,
    MULTIPLIER = 0,
    COUPLING = WISP_LANES,
};
_Static_assert( CHAINS* ROW <= WISP_STRAND_SCRATCH, "groups in turns share the scratch of one" );

// Relative error of the squared length at single precision; another iteration would not improve it.
#define EXACT 4e-5f
// Minimum pivot, m^2/kg. A smaller one belongs to a segment without length or between two pinned ends, which is
// skipped.
#define MIN_PIVOT 1e-30f
// Factor of the diagonal where strands may be held at both ends. A taut one has no other solution than one that pulls
// everywhere alike, which moves nothing; rounding would make its last pivot any number. Newton converges to the same
// lengths.
#define HELD_DIAGONAL ( 1.0f + 1e-5f )

// What an iteration is told of the whole call, so that each kind is compiled apart.
typedef struct iteration_kind
{
    bool is_first;     // takes the segments that it is given, later ones find them where vertices are
    bool is_predicted; // positions are predicted ones, which other passes see
    bool has_tension;
    bool is_held; // strands may be held at both ends
} iteration_kind;

// A group of rows and its scratch.
typedef struct chain
{
    int first, last;
    lane16 dt, inverse_dt, per_tension; // s, 1/s, 1/s^2, of the implicit steps of its strands

    float* values; // [row - first][ROW]
} chain;

static chain chain_of( const wisp_strand_stretch_args* args, int group, float* values )
{
    chain c = { .first = args->group_row[group],
                .last = args->group_row[group + 1],
                .dt = lane16_set1( args->dt ),
                .inverse_dt = lane16_set1( 1.0f / args->dt ),
                .per_tension = lane16_set1( 1.0f / ( args->dt * args->dt ) ),
                .values = values };
    if ( args->history.step != NULL )
    {
        c.dt = history16_dt( &args->history, args->group_row[group], args->dt );
        c.inverse_dt = lane16_div( lane16_set1( 1.0f ), c.dt );
        c.per_tension = lane16_mul( c.inverse_dt, c.inverse_dt );
    }
    return c;
}

LANE_INLINE place_columns columns_of( const wisp_strand_stretch_args* args )
{
    return ( place_columns ){ args->position, args->previous, args->low, args->velocity, args->inverse_mass };
}

LANE_INLINE place16 load_place( const wisp_strand_stretch_args* args, int row, lane16 dt, iteration_kind kind )
{
    const place_columns c = columns_of( args );
    return place16_load( &c, row, dt, kind.is_predicted );
}

// State of an elimination in one group.
typedef struct elimination
{
    place16 p; // of the row; not loaded in the first iteration
    lane16v e_before;
    lane16 w, inverse_before, multiplier_before;
} elimination;

LANE_INLINE elimination begin_elimination( const wisp_strand_stretch_args* args, const chain* c, iteration_kind kind )
{
    const lane16 zero = lane16_zero();
    elimination s = { .e_before = { zero, zero, zero }, // beyond a tip
                      .w = lane16_load( args->inverse_mass + (size_t)c->first * WISP_LANES ),
                      .inverse_before = zero,
                      .multiplier_before = zero };
    if ( kind.is_first == false )
    {
        s.p = load_place( args, c->first, c->dt, kind );
    }
    return s;
}

// Finds the segment from a row to the next one, which becomes the row of the state.
LANE_INLINE lane16v next_segment( const wisp_strand_stretch_args* args, elimination* s, lane16 dt, int row, float* at,
                                  iteration_kind kind )
{
    if ( kind.is_first )
    {
        return lane16v_load( at );
    }
    const place16 next = load_place( args, row + 1, dt, kind );
    const lane16v e = place16_sub( &s->p, &next );
    lane16v_store( at, e );
    s->p = next;
    return e;
}

LANE_INLINE void eliminate_row( const wisp_strand_stretch_args* args, const chain* c, elimination* s, int row,
                                iteration_kind kind )
{
    const lane16 zero = lane16_zero();
    const lane16 w_next = lane16_load( args->inverse_mass + (size_t)( row + 1 ) * WISP_LANES );
    const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
    const lane16v none = { zero, zero, zero },
                  given = next_segment( args, s, c->dt, row, args->segment + (size_t)row * STRIDE, kind );
    // beyond a tip there is no segment; its multiplier is 0 then
    const lane16v e = lane16v_select( lane16_lt( zero, length ), given, none );
    const lane16 squared = lane16v_dot( e, e );
    const lane16 deficit = lane16_mul( lane16_set1( 0.5f ), lane16_sub( lane16_mul( length, length ), squared ) );
    // off is minus the coefficient, and off^2 / previous pivot is written as off times coupling, to shorten the
    // dependency between segments
    const lane16 off = lane16_mul( s->w, lane16v_dot( s->e_before, e ) );
    const lane16 exact = lane16_mul( lane16_add( s->w, w_next ), squared );
    const lane16 own = kind.is_held ? lane16_mul( exact, lane16_set1( HELD_DIAGONAL ) ) : exact;
    const lane16 pivot = lane16_sub( own, lane16_mul( lane16_mul( off, off ), s->inverse_before ) );
    const lane16m solvable = lane16_lt( lane16_set1( MIN_PIVOT ), pivot );
    const lane16 inverse = lane16_select( solvable, lane16_div( lane16_set1( 1.0f ), pivot ), zero );
    const lane16 coupling = lane16_mul( off, s->inverse_before );
    const lane16 multiplier = lane16_mul( lane16_add( deficit, lane16_mul( off, s->multiplier_before ) ), inverse );
    float* out = c->values + (size_t)( row - c->first ) * ROW;
    lane16_store( out + MULTIPLIER, multiplier );
    lane16_store( out + COUPLING, coupling );
    s->e_before = e;
    s->w = w_next;
    s->inverse_before = inverse;
    s->multiplier_before = multiplier;
}

// Eliminates groups with equal numbers of rows, interleaved row by row. Two rows per pass, so that state passes
// between rows without register moves, which saves a tenth of this kernel.
LANE_INLINE void eliminate( const wisp_strand_stretch_args* args, const chain* chains, int count,
                            iteration_kind kind )
{
    const int rows = chains[0].last - chains[0].first;
    elimination s[CHAINS];
    for ( int c = 0; c < count; ++c )
    {
        s[c] = begin_elimination( args, &chains[c], kind );
    }
    int row = 0;
    for ( ; row + 2 < rows; row += 2 )
    {
        for ( int c = 0; c < count; ++c )
        {
            eliminate_row( args, &chains[c], &s[c], chains[c].first + row, kind );
        }
        for ( int c = 0; c < count; ++c )
        {
            eliminate_row( args, &chains[c], &s[c], chains[c].first + row + 1, kind );
        }
    }
    for ( int c = 0; c < count && row + 1 < rows; ++c )
    {
        eliminate_row( args, &chains[c], &s[c], chains[c].first + row, kind );
    }
}

// State of the sweep back.
typedef struct substitution
{
    lane16v pull, moved; // of the next row: correction by the segment up to this row, and of the vertex
    lane16v e;           // of the segment to the next row, before the iteration
    lane16 multiplier, coupling, length;
    lane16m inexact; // lanes with a segment that is not exact yet
} substitution;

// Tests whether the relative error of the squared length of e is within the limit; false for NaN.
LANE_INLINE lane16m is_within( lane16v e, lane16 length, lane16 limit )
{
    const lane16 square = lane16_mul( length, length );
    const lane16 error = lane16_abs( lane16_sub( lane16v_dot( e, e ), square ) );
    return lane16_le( error, lane16_mul( square, limit ) );
}

// Values shared by all rows of a sweep back.
typedef struct substitution_terms
{
    lane16 limit;          // of the relative error of a squared length
    lane16 dt, inverse_dt; // s, 1/s
    lane16 per_tension;    // 1/s^2
} substitution_terms;

// Moves a vertex by the multipliers of its two segments, and tests the segment after it.
LANE_INLINE void move_row( const wisp_strand_stretch_args* args, const substitution_terms* terms, substitution* s,
                           int row, lane16v pull, iteration_kind kind )
{
    float* at = args->velocity + (size_t)row * STRIDE;
    const lane16 w = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES );
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    // pinned vertices stay even if the multipliers overflow
    const lane16v moved =
        lane16v_select( lane16_lt( zero, w ), lane16v_scale( lane16v_sub( s->pull, pull ), w ), none );
    const lane16v velocity = lane16v_load( at );
    lane16v_store( at, lane16v_mul_add( velocity, terms->inverse_dt, moved ) );
    if ( kind.is_predicted )
    {
        const place_columns columns = columns_of( args );
        place16_follow( &columns, args->position, row, terms->dt );
    }
    const lane16v e = lane16v_add( s->e, lane16v_sub( moved, s->moved ) );
    if ( kind.is_predicted )
    {
        lane16v_store( args->segment + (size_t)row * STRIDE, e ); // for another iteration
    }
    const lane16m exact = is_within( e, s->length, terms->limit );
    s->inexact = lane16m_or( s->inexact, lane16m_and_not( lane16_lt( lane16_zero(), s->length ), exact ) );
    s->pull = pull;
    s->moved = moved;
}

// Solves the segment from the previous row to this one, whose elimination stored its values.
LANE_INLINE void substitute_row( const wisp_strand_stretch_args* args, const chain* c,
                                 const substitution_terms* terms, substitution* s, int row, iteration_kind kind )
{
    const float* in = c->values + (size_t)( row - 1 - c->first ) * ROW;
    const lane16 multiplier = lane16_add( lane16_load( in + MULTIPLIER ), lane16_mul( s->coupling, s->multiplier ) );
    const lane16v e = lane16v_load( args->segment + (size_t)( row - 1 ) * STRIDE );
    move_row( args, terms, s, row, lane16v_scale( e, multiplier ), kind );
    s->e = e;
    s->multiplier = multiplier;
    s->coupling = lane16_load( in + COUPLING );
    s->length = lane16_load( args->length + (size_t)( row - 1 ) * WISP_LANES );
    if ( kind.has_tension )
    {
        float* tension = args->tension + (size_t)( row - 1 ) * WISP_LANES;
        const lane16 change = lane16_mul( lane16_mul( multiplier, lane16v_length( e ) ), terms->per_tension );
        lane16_store( tension, lane16_sub( lane16_load( tension ), change ) );
    }
}

// Substitutes from tip to root, and moves each vertex by the multipliers of its two segments. Two rows per pass, as
// above.
// @return lanes with a segment that is not exact
LANE_INLINE lane16m substitute( const wisp_strand_stretch_args* args, const chain* c, iteration_kind kind )
{
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    const substitution_terms terms = { lane16_set1( fminf( EXACT, 2.0f * args->tolerance ) ), c->dt, c->inverse_dt,
                                       c->per_tension };
    // beyond the tip there is no segment to test
    substitution s = { none, none, none, zero, zero, zero, lane16_lt( zero, zero ) };
    int row = c->last - 1;
    for ( ; row > c->first + 1; row -= 2 )
    {
        substitute_row( args, c, &terms, &s, row, kind );
        substitute_row( args, c, &terms, &s, row - 1, kind );
    }
    if ( row > c->first )
    {
        substitute_row( args, c, &terms, &s, row, kind );
    }
    move_row( args, &terms, &s, c->first, none, kind );
    return s.inexact;
}

// Runs one Newton iteration over interleaved groups.
LANE_INLINE void iterate( const wisp_strand_stretch_args* args, const chain* chains, int count, iteration_kind kind,
                          lane16m* inexact )
{
    eliminate( args, chains, count, kind );
    iteration_kind with_tension = kind;
    with_tension.has_tension = true;
    for ( int c = 0; c < count; ++c )
    {
        inexact[c] = args->tension != NULL ? substitute( args, &chains[c], with_tension )
                                           : substitute( args, &chains[c], kind );
    }
}
