// Constraints: a separating plane for each active pair. In: active pairs in any order. Out: rows with points,
// weights, normal, gap, in the order of their primitives.
//
// The closest points of two convex primitives have a plane between them that separates the primitives as a whole. It
// is found at the intersection-free positions, the end of the substep before, and holds for the substep. So a point
// on the wrong side in the middle of a substep does not turn it round. With weights s_i (those of the second side
// negative),
//
//   C = n . sum s_i x_i - gap >= 0
//
// The gap is half the sum of the thicknesses, less where the pair is closer at rest, and never more than the distance
// at the intersection-free positions: so contact takes away approach and adds no energy.
#include "constraints.h"

#include "narrow_phase.h"

#include <string.h>

enum
{
    ROW_GRAIN = 256,
    DIGIT_BITS = 11, // of a number that pairs are sorted by
    DIGITS = 1 << DIGIT_BITS,
};

// Set the points of a pair.
static void set_points( const contact_work* work, const contact_pair* c, bool is_edge, contact_row* row )
{
    const contact_contact_mesh* s = work->contact_mesh;
    row->split = is_edge ? 2 : 1;
    const int32_t* a = is_edge ? s->edges + 2 * (size_t)c->a : &c->a;
    const int32_t* b = is_edge ? s->edges + 2 * (size_t)c->b : s->triangles + 3 * (size_t)c->b;
    memcpy( row->point, a, (size_t)row->split * sizeof( int32_t ) );
    memcpy( row->point + row->split, b, (size_t)( 4 - row->split ) * sizeof( int32_t ) );
}

// Return the mean of a map over the points of one side, by their weights: 1 without a map.
static float factor_of( const contact_participant* participant, const float* map, const contact_row* row, int begin,
                        int end )
{
    float sum = map != NULL ? 0.0f : 1.0f;
    for ( int k = begin; k < end && map != NULL; ++k )
    {
        sum += fabsf( row->weight[k] ) * map[row->point[k] - participant->first_point];
    }
    return sum;
}

// Return a number for a pair that does not change with the contact mesh, never 0. Two pairs of a point that share one would only
// begin with each other's impulse.
static uint32_t key_of( const contact_work* work, const contact_row* row, bool are_edges )
{
    const contact_participant *a = contact_participant_of( work, row->point[0] ),
                              *b = contact_participant_of( work, row->point[row->split] );
    const uint32_t numbers[] = { (uint32_t)( a - work->participants ), (uint32_t)( b - work->participants ),
                                 (uint32_t)( row->a - ( are_edges ? a->first_edge : a->first_point ) ),
                                 (uint32_t)( row->b - ( are_edges ? b->first_edge : b->first_triangle ) ) };
    uint32_t key = are_edges ? 1 : 0;
    for ( int i = 0; i < 4; ++i )
    {
        key = ( key ^ numbers[i] ) * UINT32_C( 0x9e3779b1 );
        key ^= key >> 15;
    }
    return key | 1;
}

static void begin_row( const contact_work* work, const contact_active* active, bool is_edge, contact_row* row )
{
    const contact_pair* c = &active->pair;
    set_points( work, c, is_edge, row );
    row->distance = active->distance;
    memcpy( row->weight, active->weight, sizeof( active->weight ) );
    memcpy( row->normal, active->normal, sizeof( active->normal ) );
    const contact_participant *a = contact_participant_of( work, row->point[0] ),
                              *b = contact_participant_of( work, row->point[row->split] );
    float gap = c->gap;
    if ( a->thickness != NULL || b->thickness != NULL )
    {
        const float sum = a->settings.thickness * factor_of( a, a->thickness, row, 0, row->split ) +
                          b->settings.thickness * factor_of( b, b->thickness, row, row->split, CONTACT_MAX_POINTS );
        gap = contact_smaller( gap, 0.5f * sum );
    }
    row->a = c->a;
    row->b = c->b;
    row->key = key_of( work, row, is_edge );
    row->gap = contact_smaller( gap, row->distance );
    row->requested = gap;
    row->friction =
        sqrtf( a->settings.friction * factor_of( a, a->friction, row, 0, row->split ) *
               ( b->settings.friction * factor_of( b, b->friction, row, row->split, CONTACT_MAX_POINTS ) ) );
    row->normal_impulse = 0.0f;
    row->is_lever = row->is_squeezed = row->is_passed = false;
    memset( row->tangential_impulse, 0, sizeof( row->tangential_impulse ) );
    row->closing = active->closing;
}

// ---- order ----

// Compare by the first side, then by the second.
static int order_of( const contact_place* c, int32_t a, int32_t b )
{
    const int first = ( c->a > a ) - ( c->a < a );
    return first != 0 ? first : ( c->b > b ) - ( c->b < b );
}

// Sort pairs by a digit of one of their sides; those with the same one stay in their order.
static void sort_by( const contact_place* from, contact_place* to, int pairs, bool by_a, int shift )
{
    int32_t begin[DIGITS + 1] = { 0 };
    for ( int i = 0; i < pairs; ++i )
    {
        begin[( ( by_a ? from[i].a : from[i].b ) >> shift ) % DIGITS + 1] += 1;
    }
    for ( int digit = 0; digit < DIGITS; ++digit )
    {
        begin[digit + 1] += begin[digit];
    }
    for ( int i = 0; i < pairs; ++i )
    {
        to[begin[( ( by_a ? from[i].a : from[i].b ) >> shift ) % DIGITS]++] = from[i];
    }
}

// Sort pairs by their first side, then by their second. No two are equal. @param most index of a side
// @param order [near->count] out, and spare [near->count] scratch
static void sort_pairs( const contact_near* near, int most, contact_place* order, contact_place* spare )
{
    contact_place *from = order, *to = spare;
    for ( int i = 0; i < near->count; ++i )
    {
        order[i] = ( contact_place ){ near->items[i].pair.a, near->items[i].pair.b, i };
    }
    for ( int by_a = 0; by_a < 2; ++by_a )
    {
        for ( int shift = 0; most >> shift > 0; shift += DIGIT_BITS )
        {
            contact_place* sorted = to;
            sort_by( from, to, near->count, by_a != 0, shift );
            to = from;
            from = sorted;
        }
    }
}

static wisp_status find_sorted( const contact_work* work, bool missed_only, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    const wisp_status status = contact_find_near( work, missed_only, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    contact_constraints* constraints = s->constraints;
    const contact_near* near = s->primitives->near;
    const size_t room[3] = { (size_t)near[0].count, (size_t)near[1].count,
                             (size_t)( near[0].count > near[1].count ? near[0].count : near[1].count ) };
    contact_place* order;
    if ( contact_reserve( work, &constraints->order_buffer, ( room[0] + room[1] + room[2] ) * sizeof( *order ),
                          (void**)&order ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %zu contact pairs", room[0] + room[1] );
    }
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        constraints->order[kind] = order + ( kind > 0 ? room[0] : 0 );
        constraints->order_count[kind] = near[kind].count;
        sort_pairs( near + kind, s->point_count + s->edge_count + s->triangle_count, constraints->order[kind],
                    order + room[0] + room[1] );
    }
    return WISP_OK;
}

// ---- rows ----

typedef struct row_loop
{
    const contact_work* work;
    const contact_active* near;
    const contact_place* order;
    contact_row* rows;
    bool are_edges;
} row_loop;

static void fill_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const row_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        begin_row( loop->work, loop->near + loop->order[i].at, loop->are_edges, loop->rows + i );
    }
}

static wisp_status fill_all( const contact_work* work, wisp_buffer* buffer, contact_row** rows, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    const contact_near* near = s->primitives->near;
    contact_place* const* order = s->constraints->order;
    const int split = s->constraints->order_count[CONTACT_POINTS], edges = s->constraints->order_count[CONTACT_EDGES];
    if ( contact_reserve( work, buffer, (size_t)( split + edges ) * sizeof( **rows ), (void**)rows ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d contact pairs", split + edges );
    }
    row_loop of_points = { work, near[CONTACT_POINTS].items, order[CONTACT_POINTS], *rows, false },
             of_edges = { work, near[CONTACT_EDGES].items, order[CONTACT_EDGES], *rows + split, true };
    wisp_parallel_for( work->parallel, split, ROW_GRAIN, fill_rows, &of_points );
    wisp_parallel_for( work->parallel, edges, ROW_GRAIN, fill_rows, &of_edges );
    return WISP_OK;
}

wisp_status contact_find_rows( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    s->constraints->row_count = s->constraints->missed_row_count = s->constraints->split = 0;
    wisp_status status = find_sorted( work, false, error );
    status = status == WISP_OK ? fill_all( work, &s->constraints->row_buffer, &s->constraints->rows, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    s->constraints->split = s->constraints->order_count[CONTACT_POINTS];
    s->constraints->row_count = s->constraints->split + s->constraints->order_count[CONTACT_EDGES];
    return WISP_OK;
}

// ---- missed rows ----

// Return the first row from `at` on that is not before a pair. Rows and pairs are both in order, so the steps grow.
static int skip_rows( const contact_place* pair, const contact_row* rows, int at, int row_count )
{
    int step = 1;
    while ( at + step < row_count && order_of( pair, rows[at + step].a, rows[at + step].b ) > 0 )
    {
        at += step;
        step *= 2;
    }
    int end = at + step < row_count ? at + step : row_count;
    while ( at < end )
    {
        const int middle = at + ( end - at ) / 2;
        const bool is_before = order_of( pair, rows[middle].a, rows[middle].b ) > 0;
        at = is_before ? middle + 1 : at;
        end = is_before ? end : middle;
    }
    return at;
}

// Remove pairs that are rows already.
static void keep_new( contact_constraints* constraints, contact_kind kind, const contact_row* rows, int row_count )
{
    contact_place* order = constraints->order[kind];
    int kept = 0, at = 0;
    for ( int i = 0; i < constraints->order_count[kind]; ++i )
    {
        at = skip_rows( order + i, rows, at, row_count );
        const bool is_row = at < row_count && order_of( order + i, rows[at].a, rows[at].b ) == 0;
        order[kept] = order[i];
        kept += is_row ? 0 : 1;
    }
    constraints->order_count[kind] = kept;
}

wisp_status contact_find_missed_rows( const contact_work* work, wisp_error* error )
{
    contact_constraints* c = work->contact_mesh->constraints;
    c->missed_row_count = 0;
    wisp_status status = find_sorted( work, true, error );
    if ( status == WISP_OK )
    {
        keep_new( c, CONTACT_POINTS, c->rows, c->split );
        keep_new( c, CONTACT_EDGES, c->rows + c->split, c->row_count - c->split );
        status = fill_all( work, &c->missed_buffer, &c->missed_rows, error );
    }
    c->missed_row_count = status == WISP_OK ? c->order_count[CONTACT_POINTS] + c->order_count[CONTACT_EDGES] : 0;
    return status;
}
