// Inextensible strands by a direct solve, sixteen at a time. The constraints C_s = (|e_s|^2 - l_s^2) / 2 have the
// gradients e_s and -e_s at the ends of a segment, so J W J^T is tridiagonal:
//
//   A_ss = (w_s + w_{s+1}) |e_s|^2,   A_{s-1,s} = -w_s e_{s-1} . e_s
//
// A sweep from root to tip eliminates, and a sweep back substitutes. Squared lengths avoid the square root, and
// Newton's method converges as fast.
#include "strand_chains.h"

#include <math.h>

static const size_t STRIDE = 3 * WISP_LANES;

// Values of a segment kept in scratch for the sweep back: its vector, its multiplier so far, the coupling to the
// next segment.
enum
{
    SEGMENT = 5 * WISP_LANES,
    MULTIPLIER = 3 * WISP_LANES,
    COUPLING = 4 * WISP_LANES,
};
_Static_assert( CHAINS* SEGMENT <= WISP_STRAND_SCRATCH, "groups in turns share the scratch of one" );

LANE_INLINE float* scratch_of( const wisp_strand_stretch_args* args, int chain, int rows )
{
    return args->scratch + (size_t)chain * (size_t)rows * SEGMENT;
}

// Relative error of the squared length at single precision; another iteration would not improve it.
#define EXACT 4e-5f
// Minimum pivot, m^2/kg. A smaller one belongs to a segment without length or between two pinned ends, which is
// skipped.
#define MIN_PIVOT 1e-30f

// State of an elimination in one group.
typedef struct elimination
{
    lane16v p, e_before;
    lane16 w, inverse_before, multiplier_before;
} elimination;

LANE_INLINE elimination begin_elimination( const wisp_strand_stretch_args* args, int first )
{
    const lane16 zero = lane16_zero();
    return ( elimination ){ .p = lane16v_load( args->position + (size_t)first * STRIDE ),
                            .e_before = { zero, zero, zero }, // beyond a tip
                            .w = lane16_load( args->inverse_mass + (size_t)first * WISP_LANES ),
                            .inverse_before = zero,
                            .multiplier_before = zero };
}

LANE_INLINE void eliminate_row( const wisp_strand_stretch_args* args, elimination* s, int row, float* out )
{
    const lane16 zero = lane16_zero();
    const lane16v next = lane16v_load( args->position + (size_t)( row + 1 ) * STRIDE ), none = { zero, zero, zero };
    const lane16 w_next = lane16_load( args->inverse_mass + (size_t)( row + 1 ) * WISP_LANES );
    const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
    const lane16v e = lane16v_select( lane16_lt( zero, length ), lane16v_sub( s->p, next ), none );
    const lane16 squared = lane16v_dot( e, e );
    const lane16 deficit = lane16_mul( lane16_set1( 0.5f ), lane16_sub( lane16_mul( length, length ), squared ) );
    // off is minus the coefficient, and off^2 / previous pivot is written as off times coupling, to shorten the
    // dependency between segments
    const lane16 off = lane16_mul( s->w, lane16v_dot( s->e_before, e ) );
    const lane16 own = lane16_mul( lane16_add( s->w, w_next ), squared );
    const lane16 pivot = lane16_sub( own, lane16_mul( lane16_mul( off, off ), s->inverse_before ) );
    const lane16m solvable = lane16_lt( lane16_set1( MIN_PIVOT ), pivot );
    const lane16 inverse = lane16_select( solvable, lane16_div( lane16_set1( 1.0f ), pivot ), zero );
    const lane16 coupling = lane16_mul( off, s->inverse_before );
    const lane16 multiplier = lane16_mul( lane16_add( deficit, lane16_mul( off, s->multiplier_before ) ), inverse );
    lane16v_store( out, e );
    lane16_store( out + MULTIPLIER, multiplier );
    lane16_store( out + COUPLING, coupling );
    *s = ( elimination ){ next, e, w_next, inverse, multiplier };
}

// Eliminates groups with equal numbers of rows, interleaved row by row; their scratch is stored one after the
// other. Two rows per pass, so that state passes between rows without register moves, which saves a tenth of this
// kernel.
LANE_INLINE void eliminate( const wisp_strand_stretch_args* args, const int* first, int rows, int count )
{
    elimination s[CHAINS];
    for ( int c = 0; c < count; ++c )
    {
        s[c] = begin_elimination( args, first[c] );
    }
    int row = 0;
    for ( ; row + 2 < rows; row += 2 )
    {
        for ( int c = 0; c < count; ++c )
        {
            eliminate_row( args, &s[c], first[c] + row, scratch_of( args, c, rows ) + (size_t)row * SEGMENT );
        }
        for ( int c = 0; c < count; ++c )
        {
            eliminate_row( args, &s[c], first[c] + row + 1,
                           scratch_of( args, c, rows ) + (size_t)( row + 1 ) * SEGMENT );
        }
    }
    for ( int c = 0; c < count && row + 1 < rows; ++c )
    {
        eliminate_row( args, &s[c], first[c] + row, scratch_of( args, c, rows ) + (size_t)row * SEGMENT );
    }
}

// State of the sweep back.
typedef struct substitution
{
    lane16v pull, moved; // of the next row: correction by the segment up to this row, and new position
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

// Moves a vertex by the multipliers of its two segments, and tests the segment after it.
LANE_INLINE void move_row( const wisp_strand_stretch_args* args, substitution* s, int row, lane16v pull,
                           lane16 limit )
{
    float* at = args->position + (size_t)row * STRIDE;
    const lane16 w = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES );
    const lane16v moved = lane16v_mul_add( lane16v_load( at ), w, lane16v_sub( s->pull, pull ) );
    lane16v_store( at, moved );
    const lane16m exact = is_within( lane16v_sub( moved, s->moved ), s->length, limit );
    s->inexact = lane16m_or( s->inexact, lane16m_and_not( lane16_lt( lane16_zero(), s->length ), exact ) );
    s->pull = pull;
    s->moved = moved;
}

// Values shared by all rows of a sweep back.
typedef struct substitution_terms
{
    lane16 limit;       // of the relative error of a squared length
    lane16 per_tension; // 1/s^2
    bool has_tension;
} substitution_terms;

// Solves the segment from the previous row to this one, whose elimination stored `in`.
LANE_INLINE void substitute_row( const wisp_strand_stretch_args* args, const substitution_terms* terms,
                                 substitution* s, int row, const float* in )
{
    const lane16 multiplier = lane16_add( lane16_load( in + MULTIPLIER ), lane16_mul( s->coupling, s->multiplier ) );
    const lane16v e = lane16v_load( in );
    move_row( args, s, row, lane16v_scale( e, multiplier ), terms->limit );
    s->multiplier = multiplier;
    s->coupling = lane16_load( in + COUPLING );
    s->length = lane16_load( args->length + (size_t)( row - 1 ) * WISP_LANES );
    if ( terms->has_tension )
    {
        float* tension = args->tension + (size_t)( row - 1 ) * WISP_LANES;
        const lane16 change = lane16_mul( lane16_mul( multiplier, lane16v_length( e ) ), terms->per_tension );
        lane16_store( tension, lane16_sub( lane16_load( tension ), change ) );
    }
}

// Substitutes from tip to root, and moves each vertex by the multipliers of its two segments. Two rows per pass, as
// above.
// @return lanes with a segment that is not exact
LANE_INLINE lane16m substitute( const wisp_strand_stretch_args* args, const float* scratch, int first, int last,
                                bool has_tension )
{
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    const substitution_terms terms = { lane16_set1( fminf( EXACT, 2.0f * args->tolerance ) ),
                                       lane16_set1( 1.0f / ( args->dt * args->dt ) ), has_tension };
    // beyond the tip there is no segment to test
    substitution s = { none, none, zero, zero, zero, lane16_lt( zero, zero ) };
    int row = last - 1;
    for ( ; row > first + 1; row -= 2 )
    {
        const float* in = scratch + (size_t)( row - 1 - first ) * SEGMENT;
        substitute_row( args, &terms, &s, row, in );
        substitute_row( args, &terms, &s, row - 1, in - SEGMENT );
    }
    if ( row > first )
    {
        substitute_row( args, &terms, &s, row, scratch );
    }
    move_row( args, &s, first, none, terms.limit );
    return s.inexact;
}

// ---- strands that do not converge ----

// Selects lanes with a segment that is not within the tolerance. Called only for groups that are not exact.
static lane16m find_inexact( const wisp_strand_stretch_args* args, int first, int last )
{
    const lane16 zero = lane16_zero(), tolerance = lane16_set1( 2.0f * args->tolerance );
    lane16m bad = lane16_lt( zero, zero );
    for ( int row = first; row + 1 < last; ++row )
    {
        const float* at = args->position + (size_t)row * STRIDE;
        const lane16 length = lane16_load( args->length + (size_t)row * WISP_LANES );
        const lane16v e = lane16v_sub( lane16v_load( at ), lane16v_load( at + STRIDE ) );
        const lane16m good = is_within( e, length, tolerance );
        bad = lane16m_or( bad, lane16m_and_not( lane16_lt( zero, length ), good ) );
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

// Sets the previous position of a reset vertex: the reset gives it no more than its predicted speed, and no
// velocity if it moves farther than the strand is long.
static lane16v start_of( const wisp_strand_stretch_args* args, int row, lane16v put, lane16 reach2 )
{
    lane16v start = lane16v_load( args->previous + (size_t)row * STRIDE );
    const lane16v path = lane16v_sub( put, start );
    const lane16 squared = lane16v_dot( path, path );
    if ( args->velocity != NULL )
    {
        const lane16v v = lane16v_load( args->velocity + (size_t)row * STRIDE );
        const lane16 predicted = lane16_mul( lane16v_dot( v, v ), lane16_set1( args->dt * args->dt ) );
        const lane16 fraction = lane16_sqrt( lane16_div( predicted, squared ) );
        start = lane16v_select( lane16_lt( predicted, squared ), lane16v_sub( put, lane16v_scale( path, fraction ) ),
                                start );
    }
    return lane16v_select( lane16_le( squared, reach2 ), start, put );
}

static void reset_strands( const wisp_strand_stretch_args* args, lane16m lanes, int first, int last )
{
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f );
    const lane16 reach = whole_length( args, first, last ), reach2 = lane16_mul( reach, reach );
    lane16v before = lane16v_load( args->position + (size_t)first * STRIDE ), put = before;
    lane16v direction = lane16v_set1( ( wisp_vec3 ){ 0.0f, -1.0f, 0.0f } );
    for ( int row = first; row + 1 < last; ++row )
    {
        float* at = args->position + (size_t)( row + 1 ) * STRIDE;
        float* from = args->previous + (size_t)( row + 1 ) * STRIDE;
        const lane16v p = lane16v_load( at ), e = lane16v_sub( p, before );
        const lane16 squared = lane16v_dot( e, e );
        // long enough to have a direction, no overflow of the square, not NaN
        const lane16m has_direction =
            lane16m_and( lane16_lt( lane16_set1( 1e-30f ), squared ), lane16_lt( squared, lane16_set1( FLT_MAX ) ) );
        const lane16 inverse = lane16_div( one, lane16_sqrt( squared ) );
        direction = lane16v_select( has_direction, lane16v_scale( e, inverse ), direction );
        put = lane16v_mul_add( put, lane16_load( args->length + (size_t)row * WISP_LANES ), direction );
        const lane16 weight = lane16_load( args->inverse_mass + (size_t)( row + 1 ) * WISP_LANES );
        const lane16m moves = lane16m_and( lanes, lane16_lt( zero, weight ) );
        lane16v_store( at, lane16v_select( moves, put, p ) );
        lane16v_store( from, lane16v_select( moves, start_of( args, row + 1, put, reach2 ), lane16v_load( from ) ) );
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

// Resets strands that did not converge.
// @return number of strands
static int reset_diverged( const wisp_strand_stretch_args* args, int first, int last )
{
    const lane16m diverged = lane16m_and_not( find_inexact( args, first, last ), further_pins( args, first, last ) );
    if ( lane16m_any( diverged ) )
    {
        reset_strands( args, diverged, first, last );
    }
    return count_lanes( diverged );
}

// Runs one Newton iteration over interleaved groups.
LANE_INLINE void iterate( const wisp_strand_stretch_args* args, const int* first, int rows, int count,
                          lane16m* inexact )
{
    eliminate( args, first, rows, count );
    for ( int c = 0; c < count; ++c )
    {
        const float* scratch = scratch_of( args, c, rows );
        inexact[c] = args->tension != NULL ? substitute( args, scratch, first[c], first[c] + rows, true )
                                           : substitute( args, scratch, first[c], first[c] + rows, false );
    }
}

// Iterates each group until it is exact, independently of the others, so its result depends only on its own
// strands.
LANE_INLINE int stretch_groups( const wisp_strand_stretch_args* args, const int* first, int rows, int count )
{
    lane16m inexact[CHAINS];
    for ( int c = 0; c < count; ++c )
    {
        clear_tension( args, first[c], first[c] + rows );
    }
    iterate( args, first, rows, count, inexact );
    int laid = 0;
    for ( int c = 0; c < count; ++c )
    {
        for ( int pass = 1; pass < args->iterations && lane16m_any( inexact[c] ); ++pass )
        {
            iterate( args, first + c, rows, 1, inexact + c );
        }
        laid += lane16m_any( inexact[c] ) ? reset_diverged( args, first[c], first[c] + rows ) : 0;
    }
    return laid;
}

int KERNEL( strand_stretch )( const wisp_strand_stretch_args* args, int begin, int end )
{
    const wisp_strand_stretch_args mine = *args;
    int laid = 0;
    for ( int g = begin; g < end; )
    {
        const int count = strand_groups_alike( mine.group_row, g, end );
        const int rows = mine.group_row[g + 1] - mine.group_row[g];
        laid += count == CHAINS ? stretch_groups( &mine, mine.group_row + g, rows, CHAINS )
                                : stretch_groups( &mine, mine.group_row + g, rows, 1 );
        g += count;
    }
    return laid;
}
