// Points that keep a distance: which of them may meet in a step, packs of sixteen against packs of sixteen, and the projection of pairs,
// sixteen at a time.
#include "kernel_isa.h"

#include <math.h>

enum
{
    LANES = 16,
};

LANE_INLINE lane16v load_points( const float* xyzw, const int32_t* index_x4 )
{
    lane8 q[2][3];
    for ( int half = 0; half < 2; ++half )
    {
        lane8_load_xyz( xyzw, index_x4 + 8 * half, q[half], q[half] + 1, q[half] + 2 );
    }
    return ( lane16v ){ lane16_join( q[0][0], q[1][0] ), lane16_join( q[0][1], q[1][1] ),
                        lane16_join( q[0][2], q[1][2] ) };
}

LANE_INLINE lane16v spread( const float* rows, int stride )
{
    return ( lane16v ){ lane16_set1( rows[0] ), lane16_set1( rows[stride] ), lane16_set1( rows[2 * stride] ) };
}

// ---- search ----

// Return how many points a pack has.
static int count_points( const wisp_point_list_args* args, int pack )
{
    const int left = args->point_count - pack * LANES;
    return left < LANES ? left : LANES;
}

// Box the points of a pack, each as far as it reaches.
static void box_points( const wisp_point_list_args* args, int at )
{
    const wisp_point_pack* pack = args->packs + at;
    const int count = count_points( args, at );
    for ( int k = 0; k < 3; ++k )
    {
        float lower = INFINITY, upper = -INFINITY;
        for ( int i = 0; i < count; ++i )
        {
            const float l = pack->at[k][i] - pack->reach[i], u = pack->at[k][i] + pack->reach[i];
            lower = l < lower ? l : lower;
            upper = u > upper ? u : upper;
        }
        args->boxes[at].lower[k] = lower;
        args->boxes[at].upper[k] = upper;
    }
}

void KERNEL( predict_points )( const wisp_point_list_args* args, int begin, int end )
{
    const lane16 zero = lane16_zero(), half = lane16_set1( 0.5f );
    const lane16v none = { zero, zero, zero };
    for ( int at = begin; at < end; ++at )
    {
        wisp_point_pack* pack = args->packs + at;
        const lane16v from = load_points( args->start, pack->point_x4 ),
                      displacement = lane16v_sub( load_points( args->now, pack->point_x4 ), from );
        // the engine halts what moves farther
        const lane16m is_likely = lane16_lt( lane16v_dot( displacement, displacement ), lane16_set1( 1e12f ) );
        const lane16v motion = lane16v_select( is_likely,
                                               lane16v_scale( displacement, lane16_set1( args->substeps ) ), none ),
                      own = lane16v_sub( motion, spread( args->common, 1 ) );
        const lane16 thickness = lane16_loadu( pack->half ), length = lane16_sqrt( lane16v_dot( own, own ) ),
                     keeps = lane16_max( lane16_add( thickness, thickness ), lane16_loadu( pack->cover ) ),
                     stray = lane16_add( lane16_mul( lane16_set1( args->stray_by_gap ), keeps ),
                                         lane16_mul( lane16_set1( args->stray_by_motion ), length ) ),
                     most = lane16_max( thickness, lane16_set1( 0.5f * args->largest_cover ) );
        lane16v_store( pack->at[0], lane16v_mul_add( from, half, motion ) );
        lane16v_store( pack->motion[0], motion );
        lane16_storeu( pack->stray, stray );
        lane16_storeu( pack->reach, lane16_add( lane16_add( most, stray ), lane16_mul( half, length ) ) );
        box_points( args, at );
    }
}

int KERNEL( count_strayed )( const wisp_point_list_args* args, float progress, int begin, int end )
{
    int count = 0;
    for ( int at = begin; at < end; ++at )
    {
        const wisp_point_pack* pack = args->packs + at;
        const lane16v path =
            lane16v_mul_add( lane16v_load( pack->at[0] ), lane16_set1( progress ), lane16v_load( pack->motion[0] ) );
        const lane16v d = lane16v_sub( load_points( args->now, pack->point_x4 ), path );
        const lane16 stray = lane16_loadu( pack->stray );
        const lane16m beyond = lane16_gt( lane16v_dot( d, d ), lane16_mul( stray, stray ) );
        count +=
            __builtin_popcount( lane16m_bits( lane16m_and( beyond, lane16m_first( count_points( args, at ) ) ) ) );
    }
    return count;
}

// Return the points of a pack that reach a box.
LANE_INLINE uint32_t reach_box( const wisp_point_pack* pack, const wisp_aabb* box, lane16m valid )
{
    const lane16 reach = lane16_loadu( pack->reach );
    for ( int k = 0; k < 3; ++k )
    {
        const lane16 at = lane16_loadu( pack->at[k] );
        valid = lane16m_and( valid, lane16_ge( lane16_add( at, reach ), lane16_set1( box->lower[k] ) ) );
        valid = lane16m_and( valid, lane16_le( lane16_sub( at, reach ), lane16_set1( box->upper[k] ) ) );
    }
    return lane16m_bits( valid );
}

// Return the points of a pack that may come as near to a point as both keep, beside its neighbours at rest.
LANE_INLINE uint32_t meet( const wisp_point_list_args* args, const wisp_point_pack* a, int lane,
                           const wisp_point_pack* b, lane16m valid )
{
    const lane16v d = lane16v_sub( lane16v_load( b->at[0] ), spread( a->at[0] + lane, LANES ) ),
                  u = lane16v_sub( lane16v_load( b->motion[0] ), spread( a->motion[0] + lane, LANES ) );
    const lane16 gap = lane16_max( lane16_add( lane16_loadu( b->half ), lane16_set1( a->half[lane] ) ),
                                   lane16_max( lane16_loadu( b->cover ), lane16_set1( a->cover[lane] ) ) ),
                 within = lane16_add( gap, lane16_add( lane16_loadu( b->stray ), lane16_set1( a->stray[lane] ) ) ),
                 apart = lane16_sub( lane16v_dot( d, d ), lane16_mul( within, within ) ),
                 along = lane16_abs( lane16v_dot( d, u ) ), path = lane16v_dot( u, u );
    // the nearest is inside of the paths, or at an end
    const lane16m inside = lane16_lt( lane16_add( along, along ), path ),
                  crosses = lane16_le( lane16_mul( apart, path ), lane16_mul( along, along ) ),
                  ends = lane16_le( apart, lane16_sub( along, lane16_mul( lane16_set1( 0.25f ), path ) ) );
    valid = lane16m_and( valid, lane16m_or( lane16m_and( inside, crosses ), lane16m_and_not( ends, inside ) ) );
    if ( lane16m_any( valid ) == false )
    {
        return 0;
    }
    const lane16v r = lane16v_sub( lane16v_load( b->rest[0] ), spread( a->rest[0] + lane, LANES ) );
    const lane16 near = lane16_mul( gap, lane16_set1( args->neighbours ) );
    const lane16m is_neighbour = lane16m_and( lane16_le( lane16v_dot( r, r ), lane16_mul( near, near ) ),
                                              lane16_eq( lane16_loadu( b->group ), lane16_set1( a->group[lane] ) ) );
    return lane16m_bits( lane16m_and_not( valid, is_neighbour ) );
}

void KERNEL( list_point_pairs )( const wisp_point_list_args* args, int begin, int end )
{
    for ( int pair = begin; pair < end; ++pair )
    {
        const int first = args->first[pair], second = args->second[pair];
        const wisp_point_pack *a = args->packs + first, *b = args->packs + second;
        uint32_t queries = reach_box( a, args->boxes + second, lane16m_first( count_points( args, first ) ) );
        int count = 0;
        memset( args->found[pair], 0, sizeof( args->found[pair] ) );
        for ( ; queries != 0; queries &= queries - 1 )
        {
            const int lane = __builtin_ctz( queries );
            const uint32_t behind = first == second ? ~0u << lane << 1 : ~0u,
                           bits = meet( args, a, lane, b, lane16m_first( count_points( args, second ) ) ) & behind;
            args->found[pair][lane] = (uint16_t)bits;
            count += __builtin_popcount( bits & 0xffffu );
        }
        args->count[pair] = count;
    }
}

// ---- projection ----

LANE_INLINE void store_pairs( float* rows, int pack, lane16v v )
{
    _Alignas( 64 ) float xyz[3][LANES];
    lane16v_store( xyz[0], v );
    for ( int at = 0; at < LANES; at += 8 )
    {
        lane8_store_xyzw_contiguous( rows + (size_t)( pack * LANES + at ) * 4, lane8_loadu( xyz[0] + at ),
                                     lane8_loadu( xyz[1] + at ), lane8_loadu( xyz[2] + at ), lane8_zero() );
    }
}

// Sixteen pairs. All but `motion` are along the line between the points at the start.
typedef struct pair_row
{
    lane16v normal, motion; // unit, to the first point; m, of the first point relative to the second
    lane16 start, now, gap; // m, distances
} pair_row;

LANE_INLINE pair_row measure( const wisp_point_pair_args* args, int pack )
{
    const int32_t *a = args->point_x4[0] + (size_t)pack * LANES, *b = args->point_x4[1] + (size_t)pack * LANES;
    const lane16v before = lane16v_sub( load_points( args->start, a ), load_points( args->start, b ) ),
                  after = lane16v_sub( load_points( args->now, a ), load_points( args->now, b ) );
    pair_row p;
    p.start = lane16_sqrt( lane16v_dot( before, before ) );
    p.normal = lane16v_scale( before, lane16_div( lane16_set1( 1.0f ), p.start ) );
    p.motion = lane16v_sub( after, before );
    p.now = lane16v_dot( p.normal, after );
    p.gap = lane16_loadu( args->gap + (size_t)pack * LANES );
    return p;
}

// Return the square of how near the points of pairs come on straight paths.
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
        const pair_row p = measure( args, pack );
        const lane16 within = lane16_mul( reach, p.gap );
        args->found[pack] = (uint16_t)lane16m_bits( lane16_lt( nearest( &p ), lane16_mul( within, within ) ) );
    }
}

bool KERNEL( push_points )( const wisp_point_pair_args* args, int begin, int end )
{
    const lane16 zero = lane16_zero(), recovery = lane16_set1( args->recovery );
    bool any = false;
    for ( int pack = begin; pack < end; ++pack )
    {
        const pair_row p = measure( args, pack );
        const lane16 kept = lane16_min( p.gap, p.start ),
                     recovered = lane16_min( p.gap, lane16_add( p.start, lane16_mul( recovery, p.gap ) ) );
        const lane16m presses =
            lane16m_and( lane16_le( nearest( &p ), lane16_mul( p.gap, p.gap ) ), lane16_lt( p.now, recovered ) );
        args->found[pack] = (uint16_t)lane16m_bits( presses );
        if ( args->found[pack] == 0 )
        {
            continue;
        }
        any = true;
        const lane16 short_by = lane16_max( lane16_sub( kept, p.now ), zero ),
                     left = lane16_max( lane16_sub( recovered, lane16_max( p.now, kept ) ), zero );
        // friction takes back the tangential motion, at most by Coulomb's cone
        const lane16v slip = lane16v_sub( p.motion, lane16v_scale( p.normal, lane16_sub( p.now, p.start ) ) );
        const lane16 length = lane16_sqrt( lane16v_dot( slip, slip ) ),
                     most = lane16_mul( lane16_loadu( args->friction + (size_t)pack * LANES ), short_by ),
                     part =
                         lane16_select( lane16_gt( length, most ), lane16_div( most, length ), lane16_set1( 1.0f ) ),
                     held = lane16_select( lane16_gt( short_by, zero ), part, zero );
        store_pairs( args->push, pack,
                     lane16v_sub( lane16v_scale( p.normal, short_by ), lane16v_scale( slip, held ) ) );
        if ( args->recovery > 0.0f )
        {
            store_pairs( args->shift, pack, lane16v_scale( p.normal, left ) );
        }
    }
    return any;
}
