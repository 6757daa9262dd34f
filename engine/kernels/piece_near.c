// Primitives near each other: one edge against sixteen, one point against eight triangles. Their extents along the line through
// their centres bound the distance from below at a third of its cost, so few distances are computed.
//
// Several jobs run at a time. Candidates are first written without a branch and compacted when all are done: a branch that waits
// for a root and a quotient would stall the rest.
#include "kernel_isa.h"

enum
{
    LANES = 8,
    JOBS_MOST = WISP_PIECE_JOBS,
    ROWS_MOST = WISP_PIECE_ROWS,
    HITS_MOST =
        JOBS_MOST * ROWS_MOST * LANES * ( ROWS_MOST + 1 ), // a last row alone is looked at with one that has nothing
};

static const _Alignas( 64 ) wisp_piece_row NOTHING = { .item = { -1, -1, -1, -1, -1, -1, -1, -1 } };

// One that asks, and who of a row is near.
typedef struct near_hit
{
    int32_t job, row;
    int32_t asker; // row and lane
    uint32_t bits;
} near_hit;

// ---- within reach of a box ----

// Which of a row do not come within reach of a box. A piece has so many corners.
LANE_INLINE lane8m out_of( const wisp_piece_row* row, int corners, const wisp_box* box, lane8 within )
{
    lane8m apart = lane8i_lt( lane8i_load( row->item ), lane8i_set1( 0 ) );
    for ( int k = 0; k < 3; ++k )
    {
        const lane8 middle = lane8_load( row->middle[k] );
        lane8 wide = within;
        if ( corners > 1 )
        {
            lane8 arm = lane8_abs( lane8_load( row->arm[k] ) );
            for ( int i = 0; i < 2 && corners > 2; ++i )
            {
                arm = lane8_max( arm, lane8_abs( lane8_load( row->other_arm[i][k] ) ) );
            }
            wide = lane8_add( wide, arm );
        }
        const lane8m below = lane8_lt( lane8_add( middle, wide ), lane8_set1( box->low[k] ) );
        const lane8m above = lane8_gt( lane8_sub( middle, wide ), lane8_set1( box->high[k] ) );
        apart = lane8m_or( apart, lane8m_or( below, above ) );
    }
    return apart;
}

// Rows and lanes of those that ask. @return how many
LANE_INLINE int list_askers( const wisp_piece_near_job* job, int corners, int32_t askers[ROWS_MOST * LANES + LANES] )
{
    int count = 0;
    for ( int r = 0; r < job->asker_rows; ++r )
    {
        const lane8m out = out_of( job->askers + r, corners, job->box, lane8_set1( job->seen ) );
        const lane8i lanes = lane8i_add( lane8i_set1( r * LANES ), lane8i_iota() );
        count += lane8i_compress_store( askers + count, lanes, ~lane8m_bits( out ) & 255u );
    }
    return count;
}

// What those of a row are called that may be near, else -1.
LANE_INLINE lane8i items_of( const wisp_piece_near_job* job, const wisp_piece_row* row, int corners )
{
    const lane8m out = out_of( row, corners, job->asker_box, lane8_set1( job->seen ) );
    return lane8i_select( out, lane8i_set1( -1 ), lane8i_load( row->item ) );
}

// ---- edges and edges ----

// Two rows that are asked, the second of which may have nothing.
typedef struct edges16
{
    lane16v middle, arm;
    lane16i item, point4[2];
} edges16;

LANE_INLINE lane16 join_rows( const float first[LANES], const float second[LANES] )
{
    return lane16_join( lane8_load( first ), lane8_load( second ) );
}

LANE_INLINE lane16v join_vectors( const float first[3][LANES], const float second[3][LANES] )
{
    return ( lane16v ){ join_rows( first[0], second[0] ), join_rows( first[1], second[1] ),
                        join_rows( first[2], second[2] ) };
}

LANE_INLINE edges16 edges_of( const wisp_piece_near_job* job, const wisp_piece_row* first,
                              const wisp_piece_row* second )
{
    edges16 e = {
        .middle = join_vectors( first->middle, second->middle ),
        .arm = join_vectors( first->arm, second->arm ),
        .item = lane16i_join( items_of( job, first, 2 ), items_of( job, second, 2 ) ),
    };
    for ( int k = 0; k < 2; ++k )
    {
        e.point4[k] = lane16i_join( lane8i_load( first->point4[k] ), lane8i_load( second->point4[k] ) );
    }
    return e;
}

// How far pieces are apart at least that span so much along a way on which their middles are apart by `between`.
LANE_INLINE lane16 bound_of( lane16 between, lane16 spans, lane16 squared )
{
    return lane16_div( lane16_sub( between, spans ), lane16_sqrt( squared ) );
}

// Of two edges: along the way between their middles, or across both where that is a direction.
LANE_INLINE lane16 bound_of_edges( lane16v way, lane16v a, lane16v b )
{
    const lane16v across = lane16v_cross( a, b );
    const lane16 squared = lane16v_dot( across, across ), way_squared = lane16v_dot( way, way );
    const lane16 spans_across =
        lane16_add( lane16_abs( lane16v_dot( across, a ) ), lane16_abs( lane16v_dot( across, b ) ) );
    const lane16 spans_along = lane16_add( lane16_abs( lane16v_dot( a, way ) ), lane16_abs( lane16v_dot( b, way ) ) );
    const lane16 aside = bound_of( lane16_abs( lane16v_dot( across, way ) ), spans_across, squared );
    const lane16 along = bound_of( way_squared, spans_along, way_squared );
    const lane16m better =
        lane16m_and( lane16_gt( squared, lane16_set1( KERNEL_LEAST_SQUARED ) ), lane16_gt( aside, along ) );
    return lane16_select( better, aside, along );
}

LANE_INLINE lane16m has_point( lane16i point4, const edges16* edges )
{
    return lane16m_or( lane16i_eq( point4, edges->point4[0] ), lane16i_eq( point4, edges->point4[1] ) );
}

// How far one is from sixteen; those that it is not looked at with go to `others`.
LANE_INLINE lane16 ask_edges( const wisp_piece_row* asker, int lane, bool is_own, const edges16* edges,
                              lane16m* others )
{
    const lane16v middle = { lane16_set1( asker->middle[0][lane] ), lane16_set1( asker->middle[1][lane] ),
                             lane16_set1( asker->middle[2][lane] ) };
    const lane16v arm = { lane16_set1( asker->arm[0][lane] ), lane16_set1( asker->arm[1][lane] ),
                          lane16_set1( asker->arm[2][lane] ) };
    const lane16m shared = lane16m_or( has_point( lane16i_set1( asker->point4[0][lane] ), edges ),
                                       has_point( lane16i_set1( asker->point4[1][lane] ), edges ) );
    const int32_t least = is_own ? asker->item[lane] + 1 : 0;
    *others = lane16m_or( shared, lane16i_lt( edges->item, lane16i_set1( least ) ) );
    return bound_of_edges( lane16v_sub( middle, edges->middle ), arm, edges->arm );
}

static void lower_least( float least[LANES], lane16 by )
{
    float both[2 * LANES];
    lane16_storeu( both, by );
    lane8_storeu( least,
                  lane8_min( lane8_loadu( least ), lane8_min( lane8_loadu( both ), lane8_loadu( both + LANES ) ) ) );
}

// Behind hits that there are. What is no number is not apart. @return how many there are then
LANE_INLINE int find_edges( const wisp_piece_near_job* job, int number, near_hit* hits, int count )
{
    int32_t askers[ROWS_MOST * LANES + LANES];
    const int asker_count = list_askers( job, 2, askers );
    const lane16 within = lane16_set1( job->within );
    lane16 least = lane16_set1( INFINITY );
    for ( int r = 0; r < job->row_count; r += 2 )
    {
        const edges16 edges = edges_of( job, job->rows + r, r + 1 < job->row_count ? job->rows + r + 1 : &NOTHING );
        const int asking = lane16m_all( lane16i_lt( edges.item, lane16i_set1( 0 ) ) ) ? 0 : asker_count;
        for ( int i = 0; i < asking; ++i )
        {
            lane16m others;
            const lane16 bound =
                ask_edges( job->askers + askers[i] / LANES, askers[i] % LANES, job->is_own, &edges, &others );
            const lane16m apart = lane16_gt( bound, within );
            const uint32_t bits = ~lane16m_bits( lane16m_or( apart, others ) );
            least = lane16_min( least,
                                lane16_select( lane16m_and_not( apart, others ), bound, lane16_set1( INFINITY ) ) );
            hits[count] = ( near_hit ){ number, r, askers[i], bits & 255u };
            count += ( bits & 255u ) != 0 ? 1 : 0;
            hits[count] = ( near_hit ){ number, r + 1, askers[i], bits >> LANES & 255u };
            count += ( bits >> LANES & 255u ) != 0 ? 1 : 0;
        }
    }
    lower_least( job->least, least );
    return count;
}

// ---- points and triangles ----

LANE_INLINE lane8v row_of( const float row[3][LANES] )
{
    return lane8v_load( row[0] );
}

LANE_INLINE lane8 bound_of_triangle( lane8v way, const wisp_piece_row* row )
{
    const lane8 aside =
        lane8_sub( lane8_abs( lane8v_dot( row_of( row->normal ), way ) ), lane8_load( row->rounded ) );
    lane8 span = lane8_max( lane8v_dot( row_of( row->arm ), way ), lane8v_dot( row_of( row->other_arm[0] ), way ) );
    span = lane8_max( span, lane8v_dot( row_of( row->other_arm[1] ), way ) );
    const lane8 squared = lane8v_dot( way, way );
    return lane8_max( aside, lane8_div( lane8_sub( squared, span ), lane8_sqrt( squared ) ) );
}

LANE_INLINE lane8m has_corner( lane8i point4, const wisp_piece_row* row )
{
    const lane8m first = lane8i_eq( point4, lane8i_load( row->point4[0] ) ),
                 second = lane8i_eq( point4, lane8i_load( row->point4[1] ) );
    return lane8m_or( lane8m_or( first, second ), lane8i_eq( point4, lane8i_load( row->third4 ) ) );
}

LANE_INLINE int find_triangles( const wisp_piece_near_job* job, int number, near_hit* hits, int count )
{
    int32_t askers[ROWS_MOST * LANES + LANES];
    const int asker_count = list_askers( job, 1, askers );
    const lane8 within = lane8_set1( job->within );
    lane8 least = lane8_loadu( job->least );
    for ( int r = 0; r < job->row_count; ++r )
    {
        const wisp_piece_row* row = job->rows + r;
        const lane8m out = lane8i_lt( items_of( job, row, 3 ), lane8i_set1( 0 ) );
        const int asking = lane8m_all( out ) ? 0 : asker_count;
        for ( int i = 0; i < asking; ++i )
        {
            const wisp_piece_row* asker = job->askers + askers[i] / LANES;
            const int lane = askers[i] % LANES;
            const lane8v point = { lane8_set1( asker->middle[0][lane] ), lane8_set1( asker->middle[1][lane] ),
                                   lane8_set1( asker->middle[2][lane] ) };
            const lane8 bound = bound_of_triangle( lane8v_sub( point, row_of( row->middle ) ), row );
            const lane8m others = lane8m_or( has_corner( lane8i_set1( asker->point4[0][lane] ), row ), out ),
                         apart = lane8_gt( bound, within );
            const uint32_t bits = ~lane8m_bits( lane8m_or( apart, others ) ) & 255u;
            least =
                lane8_min( least, lane8_select( lane8m_and_not( apart, others ), bound, lane8_set1( INFINITY ) ) );
            hits[count] = ( near_hit ){ number, r, askers[i], bits };
            count += bits != 0 ? 1 : 0;
        }
    }
    lane8_storeu( job->least, least );
    return count;
}

// ---- what is found ----

// Behind pairs that there are. @param sides points of the first side, a constant where this is inlined @return how many there are
// then
LANE_INLINE int keep( const wisp_piece_near_job* job, const near_hit* hit, int sides, const wisp_piece_pairs* to,
                      int found )
{
    const wisp_piece_row *asker = job->askers + hit->asker / LANES, *row = job->rows + hit->row;
    const int32_t* const points[3] = { row->point4[0], row->point4[1], row->third4 };
    const int lane = hit->asker % LANES;
    lane8i_storeu( to->of + found, lane8i_set1( job->number ) );
    lane8i_storeu( to->first + found, lane8i_set1( asker->item[lane] ) );
    for ( int k = 0; k < sides; ++k )
    {
        lane8i_storeu( to->point4[k] + found, lane8i_set1( asker->point4[k][lane] ) );
    }
    for ( int k = sides; k < 4; ++k )
    {
        lane8i_compress_store( to->point4[k] + found, lane8i_load( points[k - sides] ), hit->bits );
    }
    return found + lane8i_compress_store( to->second + found, lane8i_load( row->item ), hit->bits );
}

// `are_edges` is a constant where this is inlined.
LANE_INLINE int find( const wisp_piece_near_job* jobs, int count, const wisp_piece_pairs* to, bool are_edges )
{
    near_hit hits[HITS_MOST + 1];
    int hit_count = 0, found = 0;
    for ( int j = 0; j < count; ++j )
    {
        hit_count =
            are_edges ? find_edges( jobs + j, j, hits, hit_count ) : find_triangles( jobs + j, j, hits, hit_count );
    }
    for ( int h = 0; h < hit_count; ++h )
    {
        found = keep( jobs + hits[h].job, hits + h, are_edges ? 2 : 1, to, found );
    }
    return found;
}

int KERNEL( edges_near )( const wisp_piece_near_job* jobs, int count, const wisp_piece_pairs* to )
{
    return find( jobs, count, to, true );
}

int KERNEL( points_near )( const wisp_piece_near_job* jobs, int count, const wisp_piece_pairs* to )
{
    return find( jobs, count, to, false );
}
