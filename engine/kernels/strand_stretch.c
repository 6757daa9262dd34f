// Inextensible strands by a direct solve, sixteen at a time. The constraints C_s = (|e_s|^2 - l_s^2) / 2 have the
// gradients e_s and -e_s at the ends of a segment, so J W J^T is tridiagonal:
//
//   A_ss = (w_s + w_{s+1}) |e_s|^2,   A_{s-1,s} = -w_s e_{s-1} . e_s
//
// A sweep from root to tip eliminates, and a sweep back substitutes. Squared lengths avoid the square root, and
// Newton's method converges as fast. Corrections go into the velocities, which say where vertices are
// (strand_place.h).
#include "strand_stretch_reset.h"

// Relative error of a squared length in the prediction beyond which a strand of second order goes on by Euler: it turns
// too fast for an extrapolation. Beyond it swinging chains gain energy.
#define UNPREDICTED 0.5f

static void clear_tension( const wisp_strand_stretch_args* args, int first, int last )
{
    for ( int row = first; row < last && args->tension != NULL && args->accumulates_tension == false; ++row )
    {
        lane16_store( args->tension + (size_t)row * WISP_LANES, lane16_zero() );
    }
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
