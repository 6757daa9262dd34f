// Pairs of points that keep a distance, as sixteen points against the lists of others that each of them has. Both points of a pair
// compute the same correction with opposite signs, bit by bit.
#include "kernel_isa.h"

enum
{
    LANES = 16,
};

static _Alignas( 64 ) const int32_t BITS[LANES] = { 1 << 0,  1 << 1,  1 << 2,  1 << 3, 1 << 4,  1 << 5,
                                                    1 << 6,  1 << 7,  1 << 8,  1 << 9, 1 << 10, 1 << 11,
                                                    1 << 12, 1 << 13, 1 << 14, 1 << 15 };

// A point per lane.
typedef struct points
{
    lane16v at;
    lane16 w;
} points;

LANE_INLINE points join( const lane8 low[4], const lane8 high[4] )
{
    return (
        points ){ { lane16_join( low[0], high[0] ), lane16_join( low[1], high[1] ), lane16_join( low[2], high[2] ) },
                  lane16_join( low[3], high[3] ) };
}

LANE_INLINE points load_points( const float* xyzw, const int32_t* index_x4 )
{
    lane8 q[2][4];
    for ( int half = 0; half < 2; ++half )
    {
        lane8_load_xyzw( xyzw, index_x4 + 8 * half, q[half], q[half] + 1, q[half] + 2, q[half] + 3 );
    }
    return join( q[0], q[1] );
}

LANE_INLINE void store_own( float* xyzw, int first, lane16v v, lane16 w )
{
    float rows[4][LANES];
    lane16_storeu( rows[0], v.x );
    lane16_storeu( rows[1], v.y );
    lane16_storeu( rows[2], v.z );
    lane16_storeu( rows[3], w );
    for ( int half = 0; half < 2; ++half )
    {
        const int at = 8 * half;
        lane8_store_xyzw_contiguous( xyzw + (size_t)( first + at ) * 4, lane8_loadu( rows[0] + at ),
                                     lane8_loadu( rows[1] + at ), lane8_loadu( rows[2] + at ),
                                     lane8_loadu( rows[3] + at ) );
    }
}

// A row of pairs. All but `motion` are along the line between the points at the start.
typedef struct pair_row
{
    lane16v normal, motion;  // unit, to the own point; m, of the own point relative to the other
    lane16 start, now;       // m, distances
    lane16 kept, recovered;  // m, to keep without and with recovery
    lane16 gap, friction, w; // m; coefficient; 1/kg, sum
} pair_row;

LANE_INLINE pair_row measure( const wisp_point_pair_args* args, points start, points now, int row )
{
    const int32_t* index_x4 = args->other_x4 + (size_t)row * LANES;
    const points from = load_points( args->start, index_x4 ), to = load_points( args->now, index_x4 );
    const lane16v before = lane16v_sub( start.at, from.at ), after = lane16v_sub( now.at, to.at );
    pair_row p;
    p.start = lane16_sqrt( lane16v_dot( before, before ) );
    p.normal = lane16v_scale( before, lane16_div( lane16_set1( 1.0f ), p.start ) );
    p.motion = lane16v_sub( after, before );
    p.now = lane16v_dot( p.normal, after );
    p.gap = lane16_loadu( args->gap + (size_t)row * LANES );
    p.kept = lane16_min( p.gap, p.start );
    p.recovered = lane16_min( p.gap, lane16_add( p.start, lane16_mul( lane16_set1( args->recovery ), p.gap ) ) );
    p.friction = lane16_mul( start.w, from.w );
    p.w = lane16_add( now.w, to.w );
    return p;
}

// Return the square of how near the points of a row come on straight paths.
LANE_INLINE lane16 nearest( const pair_row* p )
{
    const lane16 zero = lane16_zero(), squared = lane16v_dot( p->motion, p->motion );
    const lane16 along = lane16_mul( p->start, lane16_sub( p->start, p->now ) );
    const lane16 part = lane16_select( lane16_gt( squared, zero ), lane16_div( along, squared ), zero );
    const lane16 time = lane16_min( lane16_max( part, zero ), lane16_set1( 1.0f ) );
    const lane16v least = lane16v_add( lane16v_scale( p->normal, p->start ), lane16v_scale( p->motion, time ) );
    return lane16v_dot( least, least );
}

void KERNEL( find_near_pairs )( const wisp_point_pair_args* args, int begin, int end )
{
    const lane16 reach = lane16_set1( args->reach );
    for ( int pack = begin; pack < end; ++pack )
    {
        const int32_t* own_x4 = args->own_x4 + (size_t)pack * LANES;
        const points start = load_points( args->start, own_x4 ), now = load_points( args->now, own_x4 );
        for ( int row = args->begin[pack]; row < args->begin[pack + 1]; ++row )
        {
            const pair_row p = measure( args, start, now, row );
            const lane16 within = lane16_mul( reach, p.gap );
            args->found[row] = (uint16_t)lane16m_bits( lane16_lt( nearest( &p ), lane16_mul( within, within ) ) );
        }
    }
}

void KERNEL( find_pressing_points )( const wisp_point_pair_args* args, int begin, int end )
{
    const lane16 zero = lane16_zero(), one = lane16_set1( 1.0f );
    for ( int pack = begin; pack < end; ++pack )
    {
        const int32_t* own_x4 = args->own_x4 + (size_t)pack * LANES;
        const points start = load_points( args->start, own_x4 ), now = load_points( args->now, own_x4 );
        lane16 count = zero;
        for ( int row = args->begin[pack]; row < args->begin[pack + 1]; ++row )
        {
            const pair_row p = measure( args, start, now, row );
            const lane16m presses = lane16m_and( lane16_le( nearest( &p ), lane16_mul( p.gap, p.gap ) ),
                                                 lane16_lt( p.now, p.recovered ) );
            args->found[row] = (uint16_t)lane16m_bits( presses );
            count = lane16_add( count, lane16_select( presses, one, zero ) );
        }
        lane16_storeu( args->count + (size_t)pack * LANES, count );
    }
}

void KERNEL( push_points )( const wisp_point_pair_args* args, int begin, int end )
{
    const lane16 zero = lane16_zero();
    const lane16v none = { zero, zero, zero };
    for ( int pack = begin; pack < end; ++pack )
    {
        const int32_t* own_x4 = args->own_x4 + (size_t)pack * LANES;
        const points start = load_points( args->start, own_x4 ), now = load_points( args->now, own_x4 );
        lane16v push = none, shift = none;
        lane16 sum = zero;
        for ( int row = args->begin[pack]; row < args->begin[pack + 1]; ++row )
        {
            if ( args->found[row] == 0 )
            {
                continue;
            }
            const pair_row p = measure( args, start, now, row );
            const lane16i bit = lane16i_and( lane16i_set1( args->found[row] ), lane16i_load( BITS ) );
            const lane16m moves = lane16m_and_not( lane16_gt( p.w, zero ), lane16i_eq( bit, lane16i_set1( 0 ) ) );
            const lane16 short_by = lane16_max( lane16_sub( p.kept, p.now ), zero );
            const lane16 left = lane16_max( lane16_sub( p.recovered, lane16_max( p.now, p.kept ) ), zero );
            const lane16 normal = lane16_div( short_by, p.w );
            // friction takes back the tangential motion, at most by Coulomb's cone
            const lane16v slip = lane16v_sub( p.motion, lane16v_scale( p.normal, lane16_sub( p.now, p.start ) ) );
            const lane16 length = lane16_sqrt( lane16v_dot( slip, slip ) ), most = lane16_mul( p.friction, short_by );
            const lane16 part = lane16_div(
                lane16_select( lane16_gt( length, most ), lane16_div( most, length ), lane16_set1( 1.0f ) ), p.w );
            const lane16v by =
                lane16v_sub( lane16v_scale( p.normal, normal ),
                             lane16v_scale( slip, lane16_select( lane16_gt( short_by, zero ), part, zero ) ) );
            push = lane16v_add( push, lane16v_select( moves, by, none ) );
            sum = lane16_add( sum, lane16_select( moves, lane16_sqrt( lane16v_dot( by, by ) ), zero ) );
            shift = lane16v_add( shift,
                                 lane16v_select( moves, lane16v_scale( p.normal, lane16_div( left, p.w ) ), none ) );
        }
        store_own( args->push, pack * LANES, push, sum );
        store_own( args->shift, pack * LANES, shift, zero );
    }
}
