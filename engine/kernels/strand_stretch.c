// Inextensible strands by a direct solve, sixteen at a time. The constraints C_s = (|e_s|^2 - l_s^2) / 2 have the
// gradients e_s and -e_s at the ends of a segment, so J W J^T is tridiagonal:
//
//   A_ss = (w_s + w_{s+1}) |e_s|^2,   A_{s-1,s} = -w_s e_{s-1} . e_s
//
// A sweep from root to tip eliminates, and a sweep back substitutes. Squared lengths avoid the square root, and
// Newton's method converges as fast. Corrections go into the velocities, which say where vertices are
// (strand_place.h).
#include "strand_chains.h"
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
// Relative error of a squared length in the prediction beyond which a strand of second order goes on by Euler: it turns
// too fast for an extrapolation. Beyond it swinging chains gain energy.
#define UNPREDICTED 0.5f
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

// ---- strands that do not converge ----

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

static void clear_tension( const wisp_strand_stretch_args* args, int first, int last )
{
    for ( int row = first; row < last && args->tension != NULL && args->accumulates_tension == false; ++row )
    {
        lane16_store( args->tension + (size_t)row * WISP_LANES, lane16_zero() );
    }
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

// Takes what other passes did to positions. Strands with history that they moved begin again.
static void take_moves( const wisp_strand_stretch_args* args, chain* c, int group )
{
    const place_columns columns = columns_of( args );
    const lane16 zero = lane16_zero();
    const lane16m moved = args->history.step != NULL ? history16_find_moved( &columns, c->first, c->last, c->dt )
                                                     : lane16_lt( zero, zero );
    place16_take_all( &columns, args->velocity, args->segment, c->first, c->last, c->dt, c->inverse_dt );
    if ( lane16m_any( moved ) )
    {
        history16_follow_all( &columns, args->position, c->first, c->last, c->dt );
        break_history( args, c, group, moved );
    }
}

// Computes the displacement of a free vertex by the acceleration; 0 of pinned ones.
LANE_INLINE lane16v accelerated( const wisp_strand_stretch_args* args, const chain* c, int row )
{
    const lane16 zero = lane16_zero(), w = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES );
    const lane16 fraction = lane16_select( lane16_lt( zero, w ), lane16_mul( c->dt, c->dt ), zero );
    return lane16v_scale( lane16v_set1( args->acceleration ), fraction );
}

// Strands with a segment that the prediction, without acceleration, takes far from its length begin again.
static void break_unpredicted( const wisp_strand_stretch_args* args, chain* c, int group )
{
    const lane16 zero = lane16_zero(), most = lane16_set1( UNPREDICTED );
    lane16m far = lane16_lt( zero, zero );
    lane16v own = accelerated( args, c, c->first );
    for ( int row = c->first; row + 1 < c->last; ++row )
    {
        const lane16v next = accelerated( args, c, row + 1 );
        const lane16v e = lane16v_load( args->segment + (size_t)row * STRIDE );
        const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
        const lane16m is_near = is_within( lane16v_sub( e, lane16v_sub( own, next ) ), length, most );
        far = lane16m_or( far, lane16m_and_not( lane16_lt( zero, length ), is_near ) );
        own = next;
    }
    if ( lane16m_any( far ) )
    {
        break_history( args, c, group, far );
    }
}

// Iterates each group until it is exact, independently of the others, so its result depends only on its own
// strands.
LANE_INLINE int stretch_groups( const wisp_strand_stretch_args* args, int group, int count, iteration_kind kind )
{
    lane16m inexact[CHAINS];
    chain chains[CHAINS];
    const size_t rows = (size_t)( args->group_row[group + 1] - args->group_row[group] );
    for ( int c = 0; c < count; ++c )
    {
        chains[c] = chain_of( args, group + c, args->scratch + (size_t)c * rows * ROW );
        if ( kind.is_predicted )
        {
            take_moves( args, &chains[c], group + c );
        }
        if ( args->history.step != NULL )
        {
            break_unpredicted( args, &chains[c], group + c );
        }
        clear_tension( args, chains[c].first, chains[c].last );
    }
    iterate( args, chains, count, kind, inexact );
    kind.is_first = false;
    int laid = 0;
    for ( int c = 0; c < count; ++c )
    {
        for ( int pass = 1; pass < args->iterations && lane16m_any( inexact[c] ); ++pass )
        {
            iterate( args, &chains[c], 1, kind, &inexact[c] );
        }
        laid += lane16m_any( inexact[c] ) ? reset_diverged( args, &chains[c], group + c ) : 0;
    }
    return laid;
}

LANE_INLINE int stretch_all( const wisp_strand_stretch_args* args, int begin, int end, iteration_kind kind )
{
    int laid = 0;
    for ( int g = begin; g < end; )
    {
        const int count = strand_groups_alike( args->group_row, g, end );
        laid += count == CHAINS ? stretch_groups( args, g, CHAINS, kind ) : stretch_groups( args, g, 1, kind );
        g += count;
    }
    return laid;
}

#include "strand_stretch_closed.h"

int KERNEL( strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end )
{
    const wisp_strand_stretch_args mine = *args;
    if ( mine.is_closed )
    {
        stretch_closed( &mine, begin, end );
        return 0;
    }
    if ( mine.is_held )
    {
        const iteration_kind kind = { .is_first = true, .is_predicted = mine.previous != NULL, .is_held = true };
        return stretch_all( &mine, begin, end, kind );
    }
    if ( mine.previous != NULL )
    {
        return stretch_all( &mine, begin, end, ( iteration_kind ){ .is_first = true, .is_predicted = true } );
    }
    return stretch_all( &mine, begin, end, ( iteration_kind ){ .is_first = true } );
}
