// Coarse sheets: their links, and how the next finer sheet follows them. Rows and particles are xyzw quads.
#include "kernel_isa.h"

#include "wisp/fabric.h"

// Masses of two rows in a register.
static const float LAST_OF_ROWS[8] = { 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f };

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

// Finds links whose ends were moved apart.
bool KERNEL( level_is_torn )( const wisp_level_link_args* args, float most, int begin, int end )
{
    const wisp_level_link_args mine = *args;
    bool torn = false;
    for ( int link = begin; link < end && torn == false; link += 8 )
    {
        const lane8 limit = lane8_mul( lane8_set1( most ), lane8_loadu( mine.rest + link ) );
        torn = lane8m_any( lane8_gt( load_pairs( &mine, mine.position, link ).length, limit ) );
    }
    return torn;
}

// ---- rows of the coarsest sheet ----

// Predicts by Euler or BDF2. Two rows fill a register, so nothing is transposed.
void KERNEL( level_predict )( const wisp_level_rows_args* args, int begin, int end )
{
    const wisp_level_rows_args mine = *args;
    const lane8 zero = lane8_zero(), three = lane8_set1( 3.0f ), h = lane8_set1( mine.dt ), h2 = lane8_mul( h, h );
    const lane8 he = lane8_set1( mine.solve_dt ), progress = lane8_set1( mine.progress );
    const lane8m is_mass = lane8_lt( zero, lane8_loadu( LAST_OF_ROWS ) );
    for ( int i = 4 * begin; i < 4 * end; i += 8 )
    {
        const lane8 x = lane8_loadu( mine.position + i ), v = lane8_loadu( mine.velocity + i );
        lane8 moved = zero, faster = zero;
        if ( mine.is_second_order )
        {
            const lane8 lag = lane8_mul( h2, lane8_loadu( mine.lag + i ) );
            moved = lane8_div( lane8_sub( lane8_mul( h, v ), lag ), three );
            faster = lane8_div( lane8_mul( h, lane8_loadu( mine.change + i ) ), three );
        }
        const lane8 gained =
            lane8_add( lane8_add( v, faster ), lane8_mul( he, lane8_loadu( mine.acceleration + i ) ) );
        const lane8 free = lane8_add( lane8_add( x, moved ), lane8_mul( he, gained ) );
        const lane8 held = lane8_add( x, lane8_mul( progress, lane8_sub( lane8_loadu( mine.target + i ), x ) ) );
        const lane8 next = lane8_select( lane8_le( lane8_spread_last( x ), zero ), held, free );
        lane8_storeu( mine.start + i, x );
        lane8_storeu( mine.position + i, lane8_select( is_mass, x, next ) );
    }
}

LANE_INLINE lane8v load_rows( const float* rows, int row, lane8* last )
{
    lane8v v;
    lane8_load_xyzw_contiguous( rows + 4 * row, &v.x, &v.y, &v.z, last );
    return v;
}

LANE_INLINE void store_rows( float* rows, int row, lane8v v, lane8 last )
{
    lane8_store_xyzw_contiguous( rows + 4 * row, v.x, v.y, v.z, last );
}

// Shortens vectors that are longer than a limit, the more, the longer they are.
LANE_INLINE lane8v shorten( lane8v v, lane8 limit2 )
{
    const lane8 d2 = lane8v_dot( v, v );
    return lane8v_scale( v, lane8_select( lane8_gt( d2, limit2 ), lane8_div( limit2, d2 ), lane8_set1( 1.0f ) ) );
}

// Finds velocities at the end of a substep, and what the next one remembers.
void KERNEL( level_finish )( const wisp_level_rows_args* args, int begin, int end )
{
    const wisp_level_rows_args mine = *args;
    const lane8 zero = lane8_zero(), half = lane8_set1( 0.5f ), h = lane8_set1( mine.dt );
    const lane8 inverse = lane8_set1( 1.0f / mine.dt );
    const lane8 change2 = lane8_set1( mine.most_change * mine.most_change );
    const lane8 added2 = lane8_set1( mine.most_added * mine.most_added );
    const lane8v none = { zero, zero, zero };
    for ( int row = begin; row < end; row += 8 )
    {
        lane8 inverse_mass, last, end_last, lag_last;
        const lane8v at = load_rows( mine.position, row, &inverse_mass ), start = load_rows( mine.start, row, &last );
        const lane8v velocity = load_rows( mine.velocity, row, &end_last ),
                     lag = load_rows( mine.lag, row, &lag_last );
        const lane8v mean = lane8v_scale( lane8v_sub( at, start ), inverse );
        lane8v added = none;
        if ( mine.is_second_order )
        {
            const lane8v excess = lane8v_sub( mean, lane8v_sub( velocity, lane8v_scale( lag, h ) ) );
            added = lane8v_select( lane8_lt( zero, inverse_mass ), lane8v_scale( excess, half ), none );
            added = shorten( added, added2 );
        }
        const lane8v next = lane8v_add( mean, added );
        store_rows( mine.change, row, shorten( lane8v_scale( lane8v_sub( next, velocity ), inverse ), change2 ),
                    zero );
        store_rows( mine.lag, row, shorten( lane8v_scale( added, inverse ), change2 ), lag_last );
        store_rows( mine.velocity, row, next, end_last );
    }
}

// Fraction of the change of a velocity that is rounding, where first order has none.
#define ROUNDING_FRACTION 1e-4f

// Limits what second order adds to a velocity, d, by what the surface did: half of the change of its mean velocity since its last
// substep, c. Both are half of the acceleration times dt where the surface follows the sheet. A row gets the fraction
// 2 c . d / d^2, within 0 and 1. It gets nothing where the surface did not follow: in contact, in folds, or at rest where both
// do not quite agree; second order would give it a velocity there that it does not have.
LANE_INLINE lane8 followed_fraction( lane8v d, lane8v c )
{
    const lane8 zero = lane8_zero(), one = lane8_set1( 1.0f ), d2 = lane8v_dot( d, d ), c2 = lane8v_dot( c, c );
    const lane8 both = lane8_mul( lane8_set1( 2.0f ), lane8v_dot( c, d ) );
    const lane8m is_noise = lane8_le( d2, lane8_mul( lane8_set1( ROUNDING_FRACTION * ROUNDING_FRACTION ), c2 ) );
    const lane8 part = lane8_select( lane8_gt( both, zero ), lane8_div( both, d2 ), zero );
    return lane8_select( lane8_ge( both, d2 ), one, lane8_select( is_noise, one, part ) );
}

// Parts of what is added to a row that the mean over it and its neighbours has at least for it to keep any, and all.
#define SHARED_BY_SOME 0.3f
#define SHARED_BY_ALL 0.6f

// The fraction that a row keeps of what is added to it, by the mean over it and its neighbours. A corner that gets it alone would
// be driven to and fro by what the sheets do to it.
LANE_INLINE lane8 shared_fraction( lane8v added, lane8v sum, lane8 count )
{
    const lane8 a2 = lane8v_dot( added, added ), both = lane8_div( lane8v_dot( sum, added ), count );
    const lane8 part = lane8_div( lane8_sub( lane8_div( both, a2 ), lane8_set1( SHARED_BY_SOME ) ),
                                  lane8_set1( SHARED_BY_ALL - SHARED_BY_SOME ) );
    const lane8m has_some = lane8_gt( both, lane8_mul( lane8_set1( SHARED_BY_SOME ), a2 ) );
    const lane8m has_all = lane8_ge( both, lane8_mul( lane8_set1( SHARED_BY_ALL ), a2 ) );
    return lane8_select( has_all, lane8_set1( 1.0f ), lane8_select( has_some, part, lane8_zero() ) );
}

// Sums of a row and its neighbours: the last number of a row counts them.
LANE_INLINE void sum_neighbours( const wisp_level_added_args* args )
{
    for ( int link = 0; link < args->link_count; link += 8 )
    {
        const lane8 f = lane8_loadu( args->fraction + link );
        const lane8 fraction[4] = { lane8_spread_first( f ), lane8_spread_second( f ), lane8_spread_third( f ),
                                    lane8_spread_last( f ) };
        lane8 a[4], b[4], sum_a[4], sum_b[4];
        lane8_load_quads( args->added, args->a_x4 + link, a );
        lane8_load_quads( args->added, args->b_x4 + link, b );
        lane8_load_quads( args->sum, args->a_x4 + link, sum_a );
        lane8_load_quads( args->sum, args->b_x4 + link, sum_b );
        for ( int r = 0; r < 4; ++r )
        {
            sum_a[r] = lane8_mul_add( fraction[r], b[r], sum_a[r] );
            sum_b[r] = lane8_mul_add( fraction[r], a[r], sum_b[r] );
        }
        lane8_store_quads( args->sum, args->a_x4 + link, sum_a );
        lane8_store_quads( args->sum, args->b_x4 + link, sum_b );
    }
}

// Finds what second order adds to velocities, limited by what the surface did and by what is added to the neighbours of a row.
bool KERNEL( level_add )( const wisp_level_added_args* args, int row_count )
{
    const wisp_level_added_args mine = *args;
    const lane8 one = lane8_set1( 1.0f ), half = lane8_set1( 0.5f );
    lane8 whole = lane8_zero(), left = lane8_zero();
    for ( int row = 0; row < row_count; row += 8 )
    {
        lane8v v;
        lane8 last, before_last, change_last, lag_last;
        lane8_load_xyz( mine.surface, mine.slot_x4 + row, &v.x, &v.y, &v.z );
        const lane8v before = load_rows( mine.before, row, &before_last );
        const lane8v d = lane8v_sub( load_rows( mine.end, row, &last ), load_rows( mine.mean, row, &last ) );
        const lane8 fraction = followed_fraction( d, lane8v_scale( lane8v_sub( v, before ), half ) );
        const lane8v change = load_rows( mine.change, row, &change_last ),
                     lag = load_rows( mine.lag, row, &lag_last );
        store_rows( mine.before, row, v, before_last );
        store_rows( mine.change, row, lane8v_scale( change, fraction ), change_last );
        store_rows( mine.lag, row, lane8v_scale( lag, fraction ), lag_last );
        store_rows( mine.added, row, lane8v_scale( d, fraction ), one );
        store_rows( mine.sum, row, lane8v_scale( d, fraction ), one );
        whole = lane8_add( whole, lane8v_dot( d, d ) );
    }
    sum_neighbours( &mine );
    for ( int row = 0; row < row_count; row += 8 )
    {
        lane8 count, last;
        const lane8v added = load_rows( mine.added, row, &last ), sum = load_rows( mine.sum, row, &count );
        const lane8v kept = lane8v_scale( added, shared_fraction( added, sum, count ) );
        store_rows( mine.added, row, kept, lane8_zero() );
        left = lane8_add( left, lane8v_dot( kept, kept ) );
    }
    const double all = lane8_sum_doubles( whole );
    return all > 0.0 && lane8_sum_doubles( left ) >= 0.25 * all;
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
        lane8_load_quads( mine.position + (size_t)slice * 32, lane_quad_iota, position );
        lane8_load_quads( mine.target + (size_t)slice * 32, lane_quad_iota, target );
        for ( int r = 0; r < 4; ++r )
        {
            const lane8m moves = lane8_lt( lane8_zero(), lane8_spread_last( position[r] ) );
            target[r] = lane8_select( moves, lane8_add( target[r], sum[r] ), target[r] );
        }
        lane8_store_quads( mine.target + (size_t)slice * 32, lane_quad_iota, target );
    }
}
