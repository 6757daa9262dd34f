// Pieces of surfaces near each other: points, edges and triangles, one against eight. Two pieces are apart by at least what is
// between them along the line through their middles, which costs a third of their distance and leaves few to ask for it.
#include "kernel_isa.h"

enum
{
    LANES = 8,
};

// What is shorter, squared, is no direction: below it a square loses digits, and then all of them.
#define LEAST_SQUARED 1e-30f

LANE_INLINE lane8v row_of( const float row[3][8] )
{
    return lane8v_load( row[0] );
}

LANE_INLINE lane8v one_of( const float row[3][8], int lane )
{
    return ( lane8v ){ lane8_set1( row[0][lane] ), lane8_set1( row[1][lane] ), lane8_set1( row[2][lane] ) };
}

LANE_INLINE lane8v point_of( const float* quads, const int32_t* point4 )
{
    lane8v p;
    lane8_load_xyz( quads, point4, &p.x, &p.y, &p.z );
    return p;
}

LANE_INLINE void store( float to[3][8], lane8v v )
{
    lane8v_store( to[0], v );
}

LANE_INLINE void place_triangle( wisp_piece_row* row, lane8v a, lane8v b, lane8v c )
{
    const lane8v across = lane8v_cross( lane8v_sub( b, a ), lane8v_sub( c, a ) );
    const lane8 squared = lane8v_dot( across, across ), zero = lane8_zero();
    const lane8m wide = lane8_gt( squared, lane8_set1( LEAST_SQUARED ) );
    const lane8 one_over = lane8_div( lane8_set1( 1.0f ), lane8_sqrt( squared ) );
    const lane8v normal = lane8v_scale( across, lane8_select( wide, one_over, zero ) );
    lane8 rounded = lane8_abs( lane8v_dot( normal, a ) );
    rounded = lane8_max( rounded, lane8_abs( lane8v_dot( normal, b ) ) );
    rounded = lane8_max( rounded, lane8_abs( lane8v_dot( normal, c ) ) );
    store( row->other_arm[0], b );
    store( row->other_arm[1], c );
    store( row->normal, normal );
    lane8_store( row->rounded, rounded );
}

void KERNEL( piece_place )( const float* quads, wisp_piece_row* rows, int points, int begin, int end )
{
    const lane8 half = lane8_set1( 0.5f ), third = lane8_set1( 1.0f / 3.0f );
    for ( int r = begin; r < end; ++r )
    {
        wisp_piece_row* row = rows + r;
        const lane8v a = point_of( quads, row->point4[0] );
        if ( points == 1 )
        {
            store( row->middle, a );
            continue;
        }
        const lane8v b = point_of( quads, row->point4[1] );
        lane8v middle = lane8v_scale( lane8v_add( a, b ), half );
        if ( points == 3 )
        {
            const lane8v c = point_of( quads, row->third4 );
            middle = lane8v_scale( lane8v_add( lane8v_add( a, b ), c ), third );
            place_triangle( row, lane8v_sub( a, middle ), lane8v_sub( b, middle ), lane8v_sub( c, middle ) );
        }
        store( row->arm, lane8v_sub( a, middle ) );
        store( row->middle, middle );
    }
}

// How far pieces are apart at least that span so much along a way on which their middles are apart by `between`.
LANE_INLINE lane8 bound_of( lane8 between, lane8 spans, lane8 squared )
{
    return lane8_div( lane8_sub( between, spans ), lane8_sqrt( squared ) );
}

LANE_INLINE lane8 bound_along( lane8v way, lane8 spans )
{
    const lane8 squared = lane8v_dot( way, way );
    return bound_of( squared, spans, squared );
}

// Of two edges, across both where that is a direction.
LANE_INLINE lane8 bound_of_edges( lane8v way, lane8v a, lane8v b )
{
    const lane8v across = lane8v_cross( a, b );
    const lane8 squared = lane8v_dot( across, across );
    const lane8 spans = lane8_add( lane8_abs( lane8v_dot( across, a ) ), lane8_abs( lane8v_dot( across, b ) ) );
    const lane8 aside = bound_of( lane8_abs( lane8v_dot( across, way ) ), spans, squared );
    const lane8 along =
        bound_along( way, lane8_add( lane8_abs( lane8v_dot( a, way ) ), lane8_abs( lane8v_dot( b, way ) ) ) );
    const lane8m better = lane8m_and( lane8_gt( squared, lane8_set1( LEAST_SQUARED ) ), lane8_gt( aside, along ) );
    return lane8_select( better, aside, along );
}

// Of a point and a triangle.
LANE_INLINE lane8 bound_of_triangle( lane8v way, const wisp_piece_row* row )
{
    const lane8 aside =
        lane8_sub( lane8_abs( lane8v_dot( row_of( row->normal ), way ) ), lane8_load( row->rounded ) );
    lane8 span = lane8_max( lane8v_dot( row_of( row->arm ), way ), lane8v_dot( row_of( row->other_arm[0] ), way ) );
    span = lane8_max( span, lane8v_dot( row_of( row->other_arm[1] ), way ) );
    return lane8_max( aside, bound_along( way, span ) );
}

// Which of a row are not apart, as bits; how far the others are. What is no number is not apart.
LANE_INLINE uint32_t bits_near( lane8 bound, lane8 within, lane8m others, lane8* least )
{
    const lane8m apart = lane8_gt( bound, within );
    *least = lane8_min( *least, lane8_select( lane8m_and_not( apart, others ), bound, lane8_set1( INFINITY ) ) );
    return ~lane8m_bits( lane8m_or( apart, others ) ) & 255u;
}

LANE_INLINE lane8m has_point( lane8i point4, const wisp_piece_row* row )
{
    return lane8m_or( lane8i_eq( point4, lane8i_load( row->point4[0] ) ),
                      lane8i_eq( point4, lane8i_load( row->point4[1] ) ) );
}

// Which of a row do not come within reach of a box.
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

enum
{
    ROWS_MOST = 3,
};

// The rows that come within reach of the askers, and which of their pieces do not.
typedef struct asked_rows
{
    const wisp_piece_row* row[ROWS_MOST];
    lane8m out[ROWS_MOST];
    int count;
} asked_rows;

LANE_INLINE asked_rows asked_of( const wisp_piece_near_job* job, int corners, lane8 within )
{
    asked_rows asked;
    asked.count = 0;
    for ( int r = 0; r < job->row_count; ++r )
    {
        const lane8m out = out_of( job->rows + r, corners, job->asker_box, within );
        asked.row[asked.count] = job->rows + r;
        asked.out[asked.count] = out;
        asked.count += lane8m_all( out ) ? 0 : 1;
    }
    return asked;
}

// One piece against a row, and who of the row is near. What is kept is kept in a second loop: a branch that waits for a root and
// a quotient would hold up all that comes after.
typedef struct near_test
{
    const wisp_piece_row *asker, *row;
    int lane;
    uint32_t bits;
} near_test;

enum
{
    TESTS_MOST = ROWS_MOST * LANES * ROWS_MOST,
};

// `are_edges` is a constant where this is inlined: edges ask edges, or points triangles.
LANE_INLINE int keep( const wisp_piece_near_job* job, const near_test* tests, int count, bool are_edges )
{
    const wisp_piece_pairs* to = &job->found;
    const int second = are_edges ? 2 : 1; // where the points of the second side begin
    int found = 0;
    for ( int t = 0; t < count; ++t )
    {
        const wisp_piece_row *asker = tests[t].asker, *row = tests[t].row;
        const int lane = tests[t].lane;
        const uint32_t bits = tests[t].bits;
        if ( bits != 0 )
        {
            lane8i_storeu( to->first + found, lane8i_set1( asker->item[lane] ) );
            lane8i_storeu( to->point4[0] + found, lane8i_set1( asker->point4[0][lane] ) );
            if ( are_edges )
            {
                lane8i_storeu( to->point4[1] + found, lane8i_set1( asker->point4[1][lane] ) );
            }
            else
            {
                lane8i_compress_store( to->point4[3] + found, lane8i_load( row->third4 ), bits );
            }
            lane8i_compress_store( to->point4[second] + found, lane8i_load( row->point4[0] ), bits );
            lane8i_compress_store( to->point4[second + 1] + found, lane8i_load( row->point4[1] ), bits );
            found += lane8i_compress_store( to->second + found, lane8i_load( row->item ), bits );
        }
    }
    return found;
}

LANE_INLINE lane8m shares_a_point( const wisp_piece_row* asker, int lane, const wisp_piece_row* row, bool are_edges )
{
    const lane8i first = lane8i_set1( asker->point4[0][lane] ), second = lane8i_set1( asker->point4[1][lane] );
    return lane8m_or( has_point( first, row ),
                      are_edges ? has_point( second, row ) : lane8i_eq( first, lane8i_load( row->third4 ) ) );
}

LANE_INLINE int find( const wisp_piece_near_job* job, bool are_edges )
{
    const lane8 within = lane8_set1( job->within ), seen = lane8_set1( job->seen );
    const asked_rows asked = asked_of( job, are_edges ? 2 : 3, seen );
    lane8 least = lane8_loadu( job->least );
    near_test tests[TESTS_MOST];
    int count = 0;
    for ( int a = 0; a < job->asker_rows && asked.count > 0; ++a )
    {
        const wisp_piece_row* asker = job->askers + a;
        uint32_t left = ~lane8m_bits( out_of( asker, are_edges ? 2 : 1, job->box, seen ) ) & 255u;
        for ( ; left != 0; left &= left - 1 )
        {
            const int lane = __builtin_ctz( left );
            const lane8v middle = one_of( asker->middle, lane ), arm = one_of( asker->arm, lane );
            const lane8i above = lane8i_set1( are_edges && job->is_own ? asker->item[lane] : -1 );
            for ( int r = 0; r < asked.count; ++r )
            {
                const wisp_piece_row* row = asked.row[r];
                const lane8v way = lane8v_sub( middle, row_of( row->middle ) );
                const lane8 bound =
                    are_edges ? bound_of_edges( way, arm, row_of( row->arm ) ) : bound_of_triangle( way, row );
                const lane8m lower = lane8m_not( lane8i_lt( above, lane8i_load( row->item ) ) );
                const lane8m others =
                    lane8m_or( lane8m_or( shares_a_point( asker, lane, row, are_edges ), asked.out[r] ), lower );
                tests[count++] = ( near_test ){ asker, row, lane, bits_near( bound, within, others, &least ) };
            }
        }
    }
    lane8_storeu( job->least, least );
    return keep( job, tests, count, are_edges );
}

int KERNEL( edges_near )( const wisp_piece_near_job* job )
{
    return find( job, true );
}

int KERNEL( points_near )( const wisp_piece_near_job* job )
{
    return find( job, false );
}

// The least of each of eight.
LANE_INLINE lane8 least_of_each( const lane8 v[8] )
{
    lane8i rows[8];
    for ( int i = 0; i < 8; ++i )
    {
        rows[i] = lane8_cast_int( v[i] );
    }
    lane8i_transpose( rows );
    lane8 least = lane8_cast_float( rows[0] );
    for ( int i = 1; i < 8; ++i )
    {
        least = lane8_min( least, lane8_cast_float( rows[i] ) );
    }
    return least;
}

float KERNEL( apart )( const wisp_apart_job* job )
{
    enum
    {
        AXES = 3,
    };
    // where each set begins along each direction, and where it ends, against it
    lane8 low[8], high[8];
    for ( int i = 0; i < 8; ++i )
    {
        low[i] = high[i] = lane8_set1( INFINITY );
    }
    for ( int set = 0; set < 2; ++set )
    {
        for ( int i = 0; i < job->count[set]; i += LANES )
        {
            const lane8v p = point_of( job->quads, job->point4[set] + i );
            for ( int k = 0; k < AXES; ++k )
            {
                const float* a = job->along[k];
                const lane8v axis = { lane8_set1( a[0] ), lane8_set1( a[1] ), lane8_set1( a[2] ) };
                const lane8 at = lane8v_dot( p, axis );
                low[AXES * set + k] = lane8_min( at, low[AXES * set + k] );
                high[AXES * set + k] = lane8_min( lane8_neg( at ), high[AXES * set + k] );
            }
        }
    }
    float least[8], most[8], apart = -1.0f;
    lane8_storeu( least, least_of_each( low ) );
    lane8_storeu( most, least_of_each( high ) );
    for ( int k = 0; k < AXES; ++k )
    {
        const float* a = job->along[k];
        const float one = least[k] + most[AXES + k], other = least[AXES + k] + most[k];
        const float squared = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
        const float here = squared > LEAST_SQUARED ? ( one > other ? one : other ) / sqrtf( squared ) : -1.0f;
        apart = here > apart ? here : apart;
    }
    return apart;
}
