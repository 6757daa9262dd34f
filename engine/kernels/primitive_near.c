// Near primitives: one edge against sixteen, one point against eight triangles. Their extents along the line
// through their centres give a lower bound of the distance at a third of its cost, so few distances are computed.
//
// Several calls are batched. Candidates are first written without branches and compacted at the end: a branch that
// depends on a square root and a division would stall the rest.
#include "kernel_isa.h"

enum
{
    LANES = 8,
    MAX_JOBS = WISP_PRIMITIVE_BATCH,
    MAX_ROWS = WISP_PRIMITIVE_PACKS,
    MAX_HITS = MAX_JOBS * MAX_ROWS * LANES * ( MAX_ROWS + 1 ), // a single last pack is paired with an empty one
};

static const _Alignas( 64 ) wisp_primitive_pack NOTHING = { .item = { -1, -1, -1, -1, -1, -1, -1, -1 } };

// A query and the lanes of a pack that are near it.
typedef struct near_hit
{
    int32_t args, row;
    int32_t query; // pack and lane of the query
    uint32_t bits;
} near_hit;

// ---- culling against a box ----

// Selects primitives of a pack that are farther than `within` from a box.
// @param corners per primitive
LANE_INLINE lane8m out_of( const wisp_primitive_pack* row, int corners, const wisp_aabb* box, lane8 within )
{
    lane8m apart = lane8i_lt( lane8i_load( row->item ), lane8i_set1( 0 ) );
    for ( int k = 0; k < 3; ++k )
    {
        const lane8 centre = lane8_load( row->centre[k] );
        lane8 wide = within;
        if ( corners > 1 )
        {
            lane8 edge_vector = lane8_abs( lane8_load( row->edge_vector[k] ) );
            for ( int i = 0; i < 2 && corners > 2; ++i )
            {
                edge_vector = lane8_max( edge_vector, lane8_abs( lane8_load( row->other_edge_vector[i][k] ) ) );
            }
            wide = lane8_add( wide, edge_vector );
        }
        const lane8m below = lane8_lt( lane8_add( centre, wide ), lane8_set1( box->lower[k] ) );
        const lane8m above = lane8_gt( lane8_sub( centre, wide ), lane8_set1( box->upper[k] ) );
        apart = lane8m_or( apart, lane8m_or( below, above ) );
    }
    return apart;
}

// Lists pack and lane of the queries that are near the box.
// @return number of queries
LANE_INLINE int list_queries( const wisp_primitive_near_args* args, int corners,
                              int32_t queries[MAX_ROWS * LANES + LANES] )
{
    int count = 0;
    for ( int r = 0; r < args->query_pack_count; ++r )
    {
        const lane8m out = out_of( args->queries + r, corners, args->box, lane8_set1( args->cull_distance ) );
        const lane8i lanes = lane8i_add( lane8i_set1( r * LANES ), lane8i_iota() );
        count += lane8i_compress_store( queries + count, lanes, ~lane8m_bits( out ) & 255u );
    }
    return count;
}

// Returns the indices of near primitives of a pack, -1 elsewhere.
LANE_INLINE lane8i items_of( const wisp_primitive_near_args* args, const wisp_primitive_pack* row, int corners )
{
    const lane8m out = out_of( row, corners, args->query_aabb, lane8_set1( args->cull_distance ) );
    return lane8i_select( out, lane8i_set1( -1 ), lane8i_load( row->item ) );
}

// ---- edges and edges ----

// Two packs; the second may be empty.
typedef struct edges16
{
    lane16v centre, edge_vector;
    lane16i item, point_x4[2];
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

LANE_INLINE edges16 edges_of( const wisp_primitive_near_args* args, const wisp_primitive_pack* first,
                              const wisp_primitive_pack* second )
{
    edges16 e = {
        .centre = join_vectors( first->centre, second->centre ),
        .edge_vector = join_vectors( first->edge_vector, second->edge_vector ),
        .item = lane16i_join( items_of( args, first, 2 ), items_of( args, second, 2 ) ),
    };
    for ( int k = 0; k < 2; ++k )
    {
        e.point_x4[k] = lane16i_join( lane8i_load( first->point_x4[k] ), lane8i_load( second->point_x4[k] ) );
    }
    return e;
}

// Computes a lower bound of the distance of primitives with the given extents along a direction, whose centres are
// `between` apart.
LANE_INLINE lane16 bound_of( lane16 between, lane16 spans, lane16 squared )
{
    return lane16_div( lane16_sub( between, spans ), lane16_sqrt( squared ) );
}

// Bounds the distance of two edges along the line between their centres, or along the common perpendicular if there
// is one.
LANE_INLINE lane16 bound_of_edges( lane16v offset, lane16v a, lane16v b )
{
    const lane16v across = lane16v_cross( a, b );
    const lane16 squared = lane16v_dot( across, across ), offset_squared = lane16v_dot( offset, offset );
    const lane16 spans_across =
        lane16_add( lane16_abs( lane16v_dot( across, a ) ), lane16_abs( lane16v_dot( across, b ) ) );
    const lane16 spans_along =
        lane16_add( lane16_abs( lane16v_dot( a, offset ) ), lane16_abs( lane16v_dot( b, offset ) ) );
    const lane16 aside = bound_of( lane16_abs( lane16v_dot( across, offset ) ), spans_across, squared );
    const lane16 along = bound_of( offset_squared, spans_along, offset_squared );
    const lane16m better =
        lane16m_and( lane16_gt( squared, lane16_set1( KERNEL_MIN_SQUARED ) ), lane16_gt( aside, along ) );
    return lane16_select( better, aside, along );
}

LANE_INLINE lane16m has_point( lane16i point_x4, const edges16* edges )
{
    return lane16m_or( lane16i_eq( point_x4, edges->point_x4[0] ), lane16i_eq( point_x4, edges->point_x4[1] ) );
}

// Bounds the distance of one edge from sixteen; the bounds of skipped edges go to `others`.
LANE_INLINE lane16 bound_edges( const wisp_primitive_pack* query, int lane, bool is_own, const edges16* edges,
                                lane16m* others )
{
    const lane16v centre = { lane16_set1( query->centre[0][lane] ), lane16_set1( query->centre[1][lane] ),
                             lane16_set1( query->centre[2][lane] ) };
    const lane16v edge_vector = { lane16_set1( query->edge_vector[0][lane] ),
                                  lane16_set1( query->edge_vector[1][lane] ),
                                  lane16_set1( query->edge_vector[2][lane] ) };
    const lane16m shared = lane16m_or( has_point( lane16i_set1( query->point_x4[0][lane] ), edges ),
                                       has_point( lane16i_set1( query->point_x4[1][lane] ), edges ) );
    const int32_t least = is_own ? query->item[lane] + 1 : 0;
    *others = lane16m_or( shared, lane16i_lt( edges->item, lane16i_set1( least ) ) );
    return bound_of_edges( lane16v_sub( centre, edges->centre ), edge_vector, edges->edge_vector );
}

static void min_lower( float least[LANES], lane16 by )
{
    float both[2 * LANES];
    lane16_storeu( both, by );
    lane8_storeu( least,
                  lane8_min( lane8_loadu( least ), lane8_min( lane8_loadu( both ), lane8_loadu( both + LANES ) ) ) );
}

// Appends to the hits. NaN counts as near.
// @return new number of hits
LANE_INLINE int find_edges( const wisp_primitive_near_args* args, int number, near_hit* hits, int count )
{
    int32_t queries[MAX_ROWS * LANES + LANES];
    const int query_count = list_queries( args, 2, queries );
    const lane16 within = lane16_set1( args->max_distance );
    lane16 least = lane16_set1( INFINITY );
    for ( int r = 0; r < args->pack_count; r += 2 )
    {
        const edges16 edges =
            edges_of( args, args->packs + r, r + 1 < args->pack_count ? args->packs + r + 1 : &NOTHING );
        const int asking = lane16m_all( lane16i_lt( edges.item, lane16i_set1( 0 ) ) ) ? 0 : query_count;
        for ( int i = 0; i < asking; ++i )
        {
            lane16m others;
            const lane16 bound =
                bound_edges( args->queries + queries[i] / LANES, queries[i] % LANES, args->is_self, &edges, &others );
            const lane16m apart = lane16_gt( bound, within );
            const uint32_t bits = ~lane16m_bits( lane16m_or( apart, others ) );
            least = lane16_min( least,
                                lane16_select( lane16m_and_not( apart, others ), bound, lane16_set1( INFINITY ) ) );
            hits[count] = ( near_hit ){ number, r, queries[i], bits & 255u };
            count += ( bits & 255u ) != 0 ? 1 : 0;
            hits[count] = ( near_hit ){ number, r + 1, queries[i], bits >> LANES & 255u };
            count += ( bits >> LANES & 255u ) != 0 ? 1 : 0;
        }
    }
    min_lower( args->min_distance, least );
    return count;
}

// ---- points and triangles ----

LANE_INLINE lane8v row_of( const float row[3][LANES] )
{
    return lane8v_load( row[0] );
}

LANE_INLINE lane8 bound_of_triangle( lane8v offset, const wisp_primitive_pack* row )
{
    const lane8 aside =
        lane8_sub( lane8_abs( lane8v_dot( row_of( row->normal ), offset ) ), lane8_load( row->rounding ) );
    lane8 span = lane8_max( lane8v_dot( row_of( row->edge_vector ), offset ),
                            lane8v_dot( row_of( row->other_edge_vector[0] ), offset ) );
    span = lane8_max( span, lane8v_dot( row_of( row->other_edge_vector[1] ), offset ) );
    const lane8 squared = lane8v_dot( offset, offset );
    return lane8_max( aside, lane8_div( lane8_sub( squared, span ), lane8_sqrt( squared ) ) );
}

LANE_INLINE lane8m has_corner( lane8i point_x4, const wisp_primitive_pack* row )
{
    const lane8m first = lane8i_eq( point_x4, lane8i_load( row->point_x4[0] ) ),
                 second = lane8i_eq( point_x4, lane8i_load( row->point_x4[1] ) );
    return lane8m_or( lane8m_or( first, second ), lane8i_eq( point_x4, lane8i_load( row->third_x4 ) ) );
}

LANE_INLINE int find_triangles( const wisp_primitive_near_args* args, int number, near_hit* hits, int count )
{
    int32_t queries[MAX_ROWS * LANES + LANES];
    const int query_count = list_queries( args, 1, queries );
    const lane8 within = lane8_set1( args->max_distance );
    lane8 least = lane8_loadu( args->min_distance );
    for ( int r = 0; r < args->pack_count; ++r )
    {
        const wisp_primitive_pack* row = args->packs + r;
        const lane8m out = lane8i_lt( items_of( args, row, 3 ), lane8i_set1( 0 ) );
        const int asking = lane8m_all( out ) ? 0 : query_count;
        for ( int i = 0; i < asking; ++i )
        {
            const wisp_primitive_pack* query = args->queries + queries[i] / LANES;
            const int lane = queries[i] % LANES;
            const lane8v point = { lane8_set1( query->centre[0][lane] ), lane8_set1( query->centre[1][lane] ),
                                   lane8_set1( query->centre[2][lane] ) };
            const lane8 bound = bound_of_triangle( lane8v_sub( point, row_of( row->centre ) ), row );
            const lane8m others = lane8m_or( has_corner( lane8i_set1( query->point_x4[0][lane] ), row ), out ),
                         apart = lane8_gt( bound, within );
            const uint32_t bits = ~lane8m_bits( lane8m_or( apart, others ) ) & 255u;
            least =
                lane8_min( least, lane8_select( lane8m_and_not( apart, others ), bound, lane8_set1( INFINITY ) ) );
            hits[count] = ( near_hit ){ number, r, queries[i], bits };
            count += bits != 0 ? 1 : 0;
        }
    }
    lane8_storeu( args->min_distance, least );
    return count;
}

// ---- output ----

// Appends to the pairs.
// @param sides points of the first side, a constant after inlining
// @return new number of pairs
LANE_INLINE int keep( const wisp_primitive_near_args* args, const near_hit* hit, int sides,
                      const wisp_primitive_pairs* to, int found )
{
    const wisp_primitive_pack *query = args->queries + hit->query / LANES, *row = args->packs + hit->row;
    const int32_t* const points[3] = { row->point_x4[0], row->point_x4[1], row->third_x4 };
    const int lane = hit->query % LANES;
    lane8i_storeu( to->id + found, lane8i_set1( args->cluster ) );
    lane8i_storeu( to->first + found, lane8i_set1( query->item[lane] ) );
    for ( int k = 0; k < sides; ++k )
    {
        lane8i_storeu( to->point_x4[k] + found, lane8i_set1( query->point_x4[k][lane] ) );
    }
    for ( int k = sides; k < 4; ++k )
    {
        lane8i_compress_store( to->point_x4[k] + found, lane8i_load( points[k - sides] ), hit->bits );
    }
    return found + lane8i_compress_store( to->second + found, lane8i_load( row->item ), hit->bits );
}

// Runs a batch. `are_edges` is a constant after inlining.
LANE_INLINE int find( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to,
                      bool are_edges )
{
    near_hit hits[MAX_HITS + 1];
    int hit_count = 0, found = 0;
    for ( int j = 0; j < count; ++j )
    {
        hit_count =
            are_edges ? find_edges( batch + j, j, hits, hit_count ) : find_triangles( batch + j, j, hits, hit_count );
    }
    for ( int h = 0; h < hit_count; ++h )
    {
        found = keep( batch + hits[h].args, hits + h, are_edges ? 2 : 1, to, found );
    }
    return found;
}

int KERNEL( find_near_edges )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to )
{
    return find( batch, count, to, true );
}

int KERNEL( find_near_points )( const wisp_primitive_near_args* batch, int count, const wisp_primitive_pairs* to )
{
    return find( batch, count, to, false );
}
