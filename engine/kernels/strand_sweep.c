// The cheap ways to keep lengths along strands: a sweep of distances from the root, and follow the leader. Sixteen strands at
// once, so nothing is gathered and no two lanes share a particle.
#include "strand_chains.h"

static const size_t STRIDE = 3 * WISP_LANES;

// Below this squared length, m^2, a segment has no direction.
#define LEAST_SQUARE 1e-30f

// What the multiplier changes by, over the length: pbd -k C / (l (wa + wb)), xpbd -(C + alpha lambda) / (l (wa + wb + alpha)).
typedef struct link_rule
{
    lane16 stiffness, alpha; // alpha is 0 and stiffness k in pbd; in xpbd stiffness is 1
} link_rule;

LANE_INLINE lane16 change_over_length( const link_rule* rule, lane16 weight, lane16 length, lane16 rest,
                                       lane16 lambda )
{
    const lane16 error = lane16_mul_add( rule->alpha, lambda, lane16_sub( rest, length ) );
    const lane16 denominator = lane16_mul( length, lane16_add( weight, rule->alpha ) );
    return lane16_div( lane16_mul( rule->stiffness, error ), denominator );
}

// Where a sweep has come to in one group: the rows that links have moved and not left yet stay in registers, because each link
// waits for the one `stride` before it.
typedef struct sweep
{
    lane16v p[2];
    lane16 w[2];
} sweep;

LANE_INLINE sweep begin_sweep( const wisp_strand_link_job* job, int first, int stride )
{
    sweep s;
    for ( int k = 0; k < 2; ++k )
    {
        const int row = k < stride ? first + k : first;
        s.p[k] = lane16v_load( job->position + (size_t)row * STRIDE );
        s.w[k] = lane16_load( job->weight + (size_t)row * WISP_LANES );
    }
    return s;
}

LANE_INLINE void sweep_row( const wisp_strand_link_job* job, const link_rule* rule, sweep* s, int row, int stride )
{
    const lane16 zero = lane16_zero();
    const size_t lanes = (size_t)row * WISP_LANES, other = lanes + (size_t)stride * WISP_LANES;
    const lane16v pa = s->p[0], pb = lane16v_load( job->position + (size_t)( row + stride ) * STRIDE );
    const lane16 wa = s->w[0], wb = lane16_load( job->weight + other );
    const lane16 rest = lane16_load( job->rest + lanes ), weight = lane16_add( wa, wb );
    const lane16v along = lane16v_sub( pa, pb );
    const lane16 squared = lane16v_dot( along, along );
    // two pinned ends, no direction, or no link: nothing to say
    const lane16m holds = lane16m_and( lane16m_and( lane16_lt( zero, weight ), lane16_lt( zero, rest ) ),
                                       lane16_lt( lane16_set1( LEAST_SQUARE ), squared ) );
    const lane16 length = lane16_sqrt( squared );
    const lane16 lambda = job->lambda != NULL ? lane16_neg( lane16_load( job->lambda + lanes ) ) : zero;
    const lane16 change = lane16_select( holds, change_over_length( rule, weight, length, rest, lambda ), zero );
    if ( job->lambda != NULL )
    {
        lane16_store( job->lambda + lanes, lane16_sub( lane16_mul( change, length ), lambda ) );
    }
    lane16v_store( job->position + (size_t)row * STRIDE, lane16v_mul_add( pa, lane16_mul( wa, change ), along ) );
    const lane16v moved = lane16v_mul_add( pb, lane16_neg( lane16_mul( wb, change ) ), along );
    s->p[0] = stride == 2 ? s->p[1] : moved;
    s->w[0] = stride == 2 ? s->w[1] : wb;
    s->p[1] = moved;
    s->w[1] = wb;
}

LANE_INLINE void end_sweep( const wisp_strand_link_job* job, const sweep* s, int last, int stride )
{
    lane16v_store( job->position + (size_t)( last - 1 ) * STRIDE, s->p[1] );
    if ( stride == 2 )
    {
        lane16v_store( job->position + (size_t)( last - 2 ) * STRIDE, s->p[0] );
    }
}

// Groups of as many rows each, row by row in turns: their links do not wait for each other.
LANE_INLINE void sweep_groups( const wisp_strand_link_job* job, const link_rule* rule, const int* first, int rows,
                               int stride, int count )
{
    sweep s[CHAINS];
    for ( int c = 0; c < count; ++c )
    {
        s[c] = begin_sweep( job, first[c], stride );
    }
    for ( int row = 0; row + stride < rows; ++row )
    {
        for ( int c = 0; c < count; ++c )
        {
            sweep_row( job, rule, &s[c], first[c] + row, stride );
        }
    }
    for ( int c = 0; c < count; ++c )
    {
        end_sweep( job, &s[c], first[c] + rows, stride );
    }
}

LANE_INLINE void sweep_all( const wisp_strand_link_job* job, const link_rule* rule, int begin, int end, int stride )
{
    for ( int g = begin; g < end; )
    {
        const int count = strand_groups_alike( job->group_row, g, end );
        const int rows = job->group_row[g + 1] - job->group_row[g];
        if ( rows > stride && count == CHAINS )
        {
            sweep_groups( job, rule, job->group_row + g, rows, stride, CHAINS );
        }
        else if ( rows > stride )
        {
            sweep_groups( job, rule, job->group_row + g, rows, stride, 1 );
        }
        g += count;
    }
}

void KERNEL( strand_link )( const wisp_strand_link_job* job, int begin, int end )
{
    const wisp_strand_link_job mine = *job;
    const bool compliant = mine.inverse_dt2 > 0.0f;
    const link_rule rule = { lane16_set1( compliant ? 1.0f : mine.stiffness ),
                             lane16_set1( mine.compliance * mine.inverse_dt2 ) };
    if ( mine.stride == 1 )
    {
        sweep_all( &mine, &rule, begin, end, 1 );
    }
    else
    {
        sweep_all( &mine, &rule, begin, end, 2 );
    }
}

// The follower's correction d is added to where its leader came from: read back, the leader's velocity loses share d / dt.
static void follow_group( const wisp_strand_follow_job* job, lane16 share, int first, int last )
{
    const lane16 zero = lane16_zero(), least = lane16_set1( LEAST_SQUARE );
    lane16v leader = lane16v_load( job->position + (size_t)first * STRIDE );
    lane16m leader_is_free = lane16_lt( zero, lane16_load( job->weight + (size_t)first * WISP_LANES ) );
    for ( int row = first; row + 1 < last; ++row )
    {
        const size_t at = (size_t)row * STRIDE, next = at + STRIDE;
        const lane16v p = lane16v_load( job->position + next ), along = lane16v_sub( p, leader );
        const lane16 squared = lane16v_dot( along, along );
        const lane16m is_free = lane16_lt( zero, lane16_load( job->weight + (size_t)( row + 1 ) * WISP_LANES ) );
        const lane16m moves = lane16m_and( is_free, lane16_lt( least, squared ) );
        const lane16 scale =
            lane16_div( lane16_load( job->length + (size_t)row * WISP_LANES ), lane16_sqrt( squared ) );
        const lane16v put = lane16v_select( moves, lane16v_mul_add( leader, scale, along ), p );
        const lane16v correction = lane16v_scale( lane16v_sub( put, p ), share );
        const lane16v previous = lane16v_load( job->previous + at );
        lane16v_store( job->previous + at,
                       lane16v_select( leader_is_free, lane16v_add( previous, correction ), previous ) );
        lane16v_store( job->position + next, put );
        leader = put;
        leader_is_free = is_free;
    }
}

void KERNEL( strand_follow )( const wisp_strand_follow_job* job, int begin, int end )
{
    const wisp_strand_follow_job mine = *job;
    for ( int g = begin; g < end; ++g )
    {
        follow_group( &mine, lane16_set1( mine.share ), mine.group_row[g], mine.group_row[g + 1] );
    }
}
