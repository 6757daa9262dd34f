// Low-cost length constraints along strands: a sweep of distances from the root. Sixteen strands at a time; nothing is
// gathered and no two lanes share a particle.
#include "strand_loop.h"
#include "strand_history.h"

static const size_t STRIDE = 3 * WISP_LANES;

// Minimum squared length, m^2, of a segment with a direction.
#define MIN_SQUARE 1e-30f

// Change of the multiplier divided by the length: pbd -k C / (l (wa + wb)), xpbd -(C + alpha lambda) / (l (wa + wb
// + alpha)).
typedef struct link_rule
{
    lane16 stiffness, alpha; // pbd: alpha 0 and stiffness k; xpbd: stiffness 1
    lane16 dt, inverse_dt;   // s, 1/s
} link_rule;

// State of a sweep in one group. What links moved a row by stays in registers until no later link moves it, because
// each link depends on the one `stride` before it. Row r of the group is correction[r % stride].
typedef struct sweep
{
    lane16v correction[2];
    lane16 w[2];
    lane16v segment; // of the next link's first row, before the sweep
    lane16v done;    // what links moved the row by that was put last
} sweep;

LANE_INLINE place_columns columns_of( const wisp_strand_link_args* args )
{
    return ( place_columns ){ args->position, args->previous, args->low, args->velocity, args->inverse_mass };
}

LANE_INLINE sweep begin_sweep( const wisp_strand_link_args* args, int first, int stride )
{
    const lane16 zero = lane16_zero();
    sweep s;
    for ( int k = 0; k < 2; ++k )
    {
        const int row = k < stride ? first + k : first;
        s.correction[k] = ( lane16v ){ zero, zero, zero };
        s.w[k] = lane16_load( args->inverse_mass + (size_t)row * WISP_LANES );
    }
    s.segment = lane16v_load( args->segment + (size_t)first * STRIDE );
    s.done = ( lane16v ){ zero, zero, zero };
    return s;
}

// Adds what links moved a row by to its velocity and to the segment before it, and lets a predicted position follow.
LANE_INLINE void put_row( const wisp_strand_link_args* args, const link_rule* rule, sweep* s, lane16v correction,
                          int first, int row )
{
    if ( row > first )
    {
        float* segment = args->segment + (size_t)( row - 1 ) * STRIDE;
        lane16v_store( segment, lane16v_add( lane16v_load( segment ), lane16v_sub( s->done, correction ) ) );
    }
    s->done = correction;
    float* velocity = args->velocity + (size_t)row * STRIDE;
    lane16v_store( velocity, lane16v_mul_add( lane16v_load( velocity ), rule->inverse_dt, correction ) );
    if ( args->previous != NULL )
    {
        const place_columns c = columns_of( args );
        place16_follow( &c, args->position, row, rule->dt );
    }
}

// Finds the vector from the row `stride` after it to this one; the sweep has not moved the rows after it yet.
LANE_INLINE lane16v vector_of( const wisp_strand_link_args* args, sweep* s, int row, int stride )
{
    const float* at = args->segment + (size_t)row * STRIDE;
    if ( stride == 1 )
    {
        return lane16v_load( at );
    }
    const lane16v next = lane16v_load( at + STRIDE ), both = lane16v_add( s->segment, next );
    s->segment = next;
    return both;
}

// Projects the link from `row`, which is correction[k].
LANE_INLINE void sweep_row( const wisp_strand_link_args* args, const link_rule* rule, sweep* s, int k, int first,
                            int row, int stride, bool has_lambda )
{
    const lane16 zero = lane16_zero();
    const size_t lanes = (size_t)row * WISP_LANES, other = lanes + (size_t)stride * WISP_LANES;
    const lane16 wa = s->w[k], wb = lane16_load( args->inverse_mass + other );
    const lane16 rest = lane16_load( args->rest + lanes ), weight = lane16_add( wa, wb );
    const lane16v along = lane16v_add( vector_of( args, s, row, stride ), s->correction[k] );
    const lane16 squared = lane16v_dot( along, along );
    // two pinned ends, no direction, or no link: no correction
    const lane16m holds = lane16m_and( lane16m_and( lane16_lt( zero, weight ), lane16_lt( zero, rest ) ),
                                       lane16_lt( lane16_set1( MIN_SQUARE ), squared ) );
    const lane16 length = lane16_sqrt( squared );
    lane16 error = lane16_sub( rest, length ), lambda = zero;
    if ( has_lambda )
    {
        lambda = lane16_load( args->lambda + lanes );
        error = lane16_sub( error, lane16_mul( rule->alpha, lambda ) );
    }
    const lane16 denominator = lane16_mul( length, lane16_add( weight, rule->alpha ) );
    const lane16 change =
        lane16_select( holds, lane16_div( lane16_mul( rule->stiffness, error ), denominator ), zero );
    if ( has_lambda )
    {
        lane16_store( args->lambda + lanes, lane16_mul_add( change, length, lambda ) );
    }
    put_row( args, rule, s, lane16v_mul_add( s->correction[k], lane16_mul( wa, change ), along ), first, row );
    s->correction[k] = lane16v_scale( along, lane16_neg( lane16_mul( wb, change ) ) );
    s->w[k] = wb;
}

// Sweeps groups with equal numbers of rows, interleaved row by row, since their links are independent.
LANE_INLINE void sweep_groups( const wisp_strand_link_args* args, const link_rule* rule, const int* first, int rows,
                               int stride, int count, bool has_lambda )
{
    sweep s[CHAINS];
    for ( int c = 0; c < count; ++c )
    {
        s[c] = begin_sweep( args, first[c], stride );
    }
    int row = 0;
    for ( ; row + 2 * stride <= rows; row += stride )
    {
        for ( int k = 0; k < stride; ++k )
        {
            for ( int c = 0; c < count; ++c )
            {
                sweep_row( args, rule, &s[c], k, first[c], first[c] + row + k, stride, has_lambda );
            }
        }
    }
    // remaining rows end before the second place gets another link
    const bool is_odd = row + stride < rows;
    for ( int c = 0; c < count; ++c )
    {
        if ( is_odd )
        {
            sweep_row( args, rule, &s[c], 0, first[c], first[c] + row, stride, has_lambda );
        }
        for ( int k = 0; k < stride; ++k )
        {
            // the place that got the last link is of the last row
            const int place = is_odd ? stride - 1 - k : k;
            put_row( args, rule, &s[c], s[c].correction[place], first[c], first[c] + row + k + ( is_odd ? 1 : 0 ) );
        }
    }
}

// Takes what other passes did to positions. Strands with history that they moved begin again.
static void take_corrections( const wisp_strand_link_args* args, int group, int count )
{
    const place_columns c = columns_of( args );
    const restarted_columns out = { args->position, args->low, args->velocity };
    for ( int g = group; g < group + count && args->previous != NULL; ++g )
    {
        const int first = args->group_row[g], last = args->group_row[g + 1];
        const bool has_history = args->history.step != NULL;
        const lane16 dt = history16_dt( &args->history, first, args->dt ), zero = lane16_zero();
        const lane16m moved = has_history ? history16_find_moved( &c, first, last, dt ) : lane16_lt( zero, zero );
        place16_take_all( &c, args->velocity, args->segment, first, last, dt, lane16_div( lane16_set1( 1.0f ), dt ) );
        if ( lane16m_any( moved ) )
        {
            history16_follow_all( &c, args->position, first, last, dt );
            history16_break( &args->history, &c, &out, first, last, args->dt, moved );
        }
    }
}

static link_rule rule_of( const wisp_strand_link_args* args )
{
    const bool compliant = args->inverse_dt2 > 0.0f;
    return ( link_rule ){ lane16_set1( compliant ? 1.0f : args->stiffness ),
                          lane16_set1( args->compliance * args->inverse_dt2 ), lane16_set1( args->dt ),
                          lane16_set1( 1.0f / args->dt ) };
}

// Finds the rule of a group whose strands have steps of their own.
static link_rule own_rule( const wisp_strand_link_args* args, int group )
{
    link_rule rule = rule_of( args );
    rule.dt = history16_dt( &args->history, args->group_row[group], args->dt );
    rule.inverse_dt = lane16_div( lane16_set1( 1.0f ), rule.dt );
    const lane16 ratio = lane16_mul( lane16_set1( args->dt ), rule.inverse_dt );
    rule.alpha = lane16_mul( rule.alpha, lane16_mul( ratio, ratio ) );
    return rule;
}

LANE_INLINE void sweep_all( const wisp_strand_link_args* args, int begin, int end, int stride, bool has_lambda )
{
    const bool has_history = args->history.step != NULL;
    link_rule rule = rule_of( args );
    for ( int g = begin; g < end; )
    {
        const int count = has_history ? 1 : strand_groups_alike( args->group_row, g, end );
        const int rows = args->group_row[g + 1] - args->group_row[g];
        take_corrections( args, g, count );
        if ( has_history )
        {
            rule = own_rule( args, g );
        }
        if ( rows > stride && count == CHAINS )
        {
            sweep_groups( args, &rule, args->group_row + g, rows, stride, CHAINS, has_lambda );
        }
        else if ( rows > stride )
        {
            sweep_groups( args, &rule, args->group_row + g, rows, stride, 1, has_lambda );
        }
        g += count;
    }
}

void KERNEL( strand_link )( const wisp_strand_link_args* args, int begin, int end )
{
    const wisp_strand_link_args mine = *args;
    if ( mine.stride == 1 && mine.lambda == NULL )
    {
        sweep_all( &mine, begin, end, 1, false );
    }
    else if ( mine.stride == 1 )
    {
        sweep_all( &mine, begin, end, 1, true );
    }
    else if ( mine.lambda == NULL )
    {
        sweep_all( &mine, begin, end, 2, false );
    }
    else
    {
        sweep_all( &mine, begin, end, 2, true );
    }
}

int KERNEL( strand_count_stretched )( const wisp_strand_link_args* args, float fraction, int begin, int end )
{
    const lane16 zero = lane16_zero(), most = lane16_set1( 1.0f + fraction );
    int count = 0;
    for ( int g = begin; g < end; ++g )
    {
        lane16 length = zero, length_at_rest = zero;
        for ( int row = args->group_row[g]; row + 1 < args->group_row[g + 1]; ++row )
        {
            const lane16 rest = lane16_load( args->rest + (size_t)row * WISP_LANES );
            const lane16m is_link = lane16_lt( zero, rest );
            const lane16 now = lane16v_length( lane16v_load( args->segment + (size_t)row * STRIDE ) );
            length = lane16_add( length, lane16_select( is_link, now, zero ) );
            length_at_rest = lane16_add( length_at_rest, lane16_select( is_link, rest, zero ) );
        }
        uint32_t bits = lane16m_bits( lane16_lt( lane16_mul( length_at_rest, most ), length ) );
        for ( ; bits != 0; bits &= bits - 1 )
        {
            count += 1;
        }
    }
    return count;
}
