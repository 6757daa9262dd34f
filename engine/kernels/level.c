// Coarse sheets: their links, and how the next finer sheet follows them. Rows and particles are xyzw quads.
#include "kernel_isa.h"

#include "wisp/fabric.h"

// Quads of eight rows in a row.
static const int32_t EIGHT_ROWS[8] = { 0, 4, 8, 12, 16, 20, 24, 28 };

// Most of its rest length that a link makes up for in a substep by pushing. A collapsed sheet does not burst open.
#define MAX_PUSHED 0.1f
// Fraction of a push that is applied: links along a compressed line all push, so that whole pushes overshoot.
#define PUSH 0.5f
// Minimum length, m. A shorter link is projected more slowly, and not at all at length 0.
#define MIN_LENGTH 1e-9f

// Eight links as xyzw rows, and derived values.
typedef struct level_pairs
{
    lane8 a[4], b[4];
    lane8 along[4]; // a - b as rows
    lane8 length;   // m
} level_pairs;

LANE_INLINE level_pairs load_pairs( const wisp_level_link_args* args, const float* position, int link )
{
    level_pairs p;
    lane8 d[4];
    lane8_load_quads( position, args->a_x4 + link, p.a );
    lane8_load_quads( position, args->b_x4 + link, p.b );
    for ( int r = 0; r < 4; ++r )
    {
        p.along[r] = d[r] = lane8_sub( p.a[r], p.b[r] );
    }
    lane8_transpose_quads( d );
    const lane8v between = { d[0], d[1], d[2] };
    p.length = lane8v_length( between );
    return p;
}

// Sums the lengths of the edges of eight chains.
LANE_INLINE lane8 measure_chains( const wisp_level_link_args* args, int group )
{
    lane8 last[4], sum = lane8_zero();
    int e = args->chain_begin[group];
    lane8_load_quads( args->particle, args->chain_x4[e], last );
    for ( ++e; e < args->chain_begin[group + 1]; ++e )
    {
        lane8 at[4], d[4];
        lane8_load_quads( args->particle, args->chain_x4[e], at );
        for ( int r = 0; r < 4; ++r )
        {
            d[r] = lane8_sub( at[r], last[r] );
            last[r] = at[r];
        }
        lane8_transpose_quads( d );
        const lane8v edge = { d[0], d[1], d[2] };
        sum = lane8_add( sum, lane8_sqrt( lane8v_dot( edge, edge ) ) );
    }
    return sum;
}

// Finds the length below which a link pushes. From where the substep begins, it may make up for what its chain of mesh edges is
// compressed, and no more: a link whose ends came together while the chain kept its length spans wrinkles, which are no error. It
// also keeps the length that it begins with, but for what it shortens faster than slowly: what wrinkles moves on, what rests stays.
void KERNEL( level_band )( const wisp_level_link_args* args, int begin, int end )
{
    const wisp_level_link_args mine = *args;
    const lane8 zero = lane8_zero(), held = lane8_set1( mine.held ), tiny = lane8_set1( 1e-30f );
    for ( int link = begin; link < end; link += 8 )
    {
        const lane8 rest = lane8_loadu( mine.rest + link );
        const lane8 first = lane8_min( load_pairs( &mine, mine.start, link ).length, rest );
        lane8 lower = first;
        if ( lane8m_any( lane8_lt( first, rest ) ) )
        {
            const lane8 chain_rest = lane8_max( lane8_loadu( mine.chain_rest + link ), tiny );
            const lane8 chain = measure_chains( &mine, link / 8 );
            const lane8 change = lane8_div( lane8_sub( chain, chain_rest ), chain_rest );
            const lane8 missing = lane8_min( lane8_max( lane8_sub( zero, change ), zero ), lane8_set1( MAX_PUSHED ) );
            lower = lane8_min( rest, lane8_add( first, lane8_mul( rest, missing ) ) );
        }
        const lane8 shorter = lane8_sub( first, load_pairs( &mine, mine.position, link ).length );
        const lane8 free = lane8_sub( shorter, lane8_mul( held, rest ) ); // what wrinkles
        lane8_storeu( mine.lower + link, lane8_sub( lower, lane8_max( free, zero ) ) );
    }
}

// Prepares the links of a substep: lambda is 0, and factor is r / (wa + wb + a), with a = compliance / dt^2. A pinned pair has no
// step.
void KERNEL( level_prepare )( const wisp_level_link_args* args, int begin, int end )
{
    const wisp_level_link_args mine = *args;
    const lane8 inverse_dt2 = lane8_set1( mine.inverse_dt2 ), zero = lane8_zero();
    for ( int link = begin; link < end; link += 8 )
    {
        lane8 a[4], b[4];
        lane8_load_quads( mine.position, mine.a_x4 + link, a );
        lane8_load_quads( mine.position, mine.b_x4 + link, b );
        lane8_transpose_quads( a );
        lane8_transpose_quads( b );
        const lane8 weight = lane8_add( a[3], b[3] );
        const lane8 alpha = lane8_mul( lane8_loadu( mine.compliance + link ), inverse_dt2 );
        const lane8m moves = lane8_lt( zero, weight );
        const lane8 sum = lane8_select( moves, lane8_add( weight, alpha ), lane8_set1( 1.0f ) );
        lane8_storeu( mine.factor + link,
                      lane8_select( moves, lane8_div( lane8_set1( mine.relaxation ), sum ), zero ) );
        lane8_storeu( mine.lambda + link, zero );
    }
}

// Projects with C = length - rest, or length - lower where that is negative, and change of lambda = - factor (C + a lambda).
void KERNEL( level_link )( const wisp_level_link_args* args, int begin, int end )
{
    const wisp_level_link_args mine = *args;
    const lane8 inverse_dt2 = lane8_set1( mine.inverse_dt2 ), zero = lane8_zero();
    for ( int link = begin; link < end; link += 8 )
    {
        level_pairs p = load_pairs( &mine, mine.position, link );
        const lane8 alpha = lane8_mul( lane8_loadu( mine.compliance + link ), inverse_dt2 );
        const lane8 lambda = lane8_loadu( mine.lambda + link );
        const lane8 above = lane8_max( lane8_sub( p.length, lane8_loadu( mine.rest + link ) ), zero );
        const lane8 below = lane8_min( lane8_sub( p.length, lane8_loadu( mine.lower + link ) ), zero );
        const lane8 error = lane8_mul_add( alpha, lambda, lane8_add( above, below ) );
        const lane8 whole = lane8_sub( lambda, lane8_mul( lane8_loadu( mine.factor + link ), error ) );

        // lambda above 0 pushes, and where it rises there is half of the step
        const lane8 pushed = lane8_max( lane8_sub( whole, lane8_max( lambda, zero ) ), zero );
        const lane8 pushes = lane8_min( pushed, lane8_max( whole, zero ) );
        const lane8m has_direction = lane8_lt( zero, p.length );
        const lane8 moved = lane8_sub( whole, lane8_mul( lane8_set1( 1.0f - PUSH ), pushes ) );
        const lane8 next = lane8_select( has_direction, moved, lambda );
        lane8_storeu( mine.lambda + link, next );

        const lane8 step = lane8_div( lane8_sub( next, lambda ), lane8_max( p.length, lane8_set1( MIN_LENGTH ) ) );
        lane8 steps[4];
        lane8_spread_xyz( step, steps );
        for ( int r = 0; r < 4; ++r )
        {
            const lane8 move = lane8_mul( steps[r], p.along[r] );
            p.a[r] = lane8_add( p.a[r], lane8_mul( lane8_spread_last( p.a[r] ), move ) );
            p.b[r] = lane8_sub( p.b[r], lane8_mul( lane8_spread_last( p.b[r] ), move ) );
        }
        lane8_store_quads( mine.position, mine.a_x4 + link, p.a );
        lane8_store_quads( mine.position, mine.b_x4 + link, p.b );
    }
}

// Applies prolongation. Rows and parents are four registers of two quads, so nothing is transposed. A row of zero weights adds
// nothing.
void KERNEL( prolong )( const wisp_prolong_args* args, int begin, int end )
{
    const wisp_prolong_args mine = *args;
    for ( int slice = begin; slice < end; ++slice )
    {
        lane8 sum[4] = { lane8_zero(), lane8_zero(), lane8_zero(), lane8_zero() };
        for ( int k = 0; k < WISP_FABRIC_PARENTS; ++k )
        {
            const size_t row = ( (size_t)slice * WISP_FABRIC_PARENTS + (size_t)k ) * 8;
            const lane8 weight = lane8_loadu( mine.weight + row );
            if ( lane8m_all( lane8_eq( weight, lane8_zero() ) ) )
            {
                continue;
            }
            lane8 weights[4], parents[4];
            lane8_spread_xyz( weight, weights );
            lane8_load_quads( mine.value, mine.parent_x4 + row, parents );
            for ( int r = 0; r < 4; ++r )
            {
                sum[r] = lane8_mul_add( weights[r], parents[r], sum[r] );
            }
        }
        lane8 position[4], target[4];
        lane8_load_quads( mine.position + (size_t)slice * 32, EIGHT_ROWS, position );
        lane8_load_quads( mine.target + (size_t)slice * 32, EIGHT_ROWS, target );
        for ( int r = 0; r < 4; ++r )
        {
            const lane8m moves = lane8_lt( lane8_zero(), lane8_spread_last( position[r] ) );
            target[r] = lane8_select( moves, lane8_add( target[r], sum[r] ), target[r] );
        }
        lane8_store_quads( mine.target + (size_t)slice * 32, EIGHT_ROWS, target );
    }
}
