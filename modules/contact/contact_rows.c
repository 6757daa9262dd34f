// The planes between pairs that may meet in this substep, found where nothing crossed yet. The closest points of two convex
// pieces have a plane between them that separates the pieces whole, so that whoever stays behind it has not crossed.
#include "contact_internal.h"

#include <stdlib.h>
#include <string.h>

enum
{
    ROW_GRAIN = 256,
};

void contact_set_points( const contact_work* work, const contact_candidate* c, bool is_edge, contact_row* row )
{
    const contact_soup* s = work->soup;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        row->count = 6;
        row->split = 3;
        memcpy( row->point, s->sample_parents[c->a], 3 * sizeof( int32_t ) );
        memcpy( row->point + 3, s->sample_parents[c->b], 3 * sizeof( int32_t ) );
        return;
    }
    row->count = 4;
    row->split = is_edge ? 2 : 1;
    const int32_t* a = is_edge ? s->edges + 2 * (size_t)c->a : &c->a;
    const int32_t* b = is_edge ? s->edges + 2 * (size_t)c->b : s->triangles + 3 * (size_t)c->b;
    memcpy( row->point, a, (size_t)row->split * sizeof( int32_t ) );
    memcpy( row->point + row->split, b, (size_t)( 4 - row->split ) * sizeof( int32_t ) );
}

// Closest points of up to a batch of pairs whose rows have their points.
static void measure_pieces( const contact_work* work, int count, bool are_edges, contact_row* rows )
{
    _Alignas( 64 ) float weight[CONTACT_BATCH / WISP_SLICE][4][WISP_SLICE];
    _Alignas( 64 ) float normal[CONTACT_BATCH / WISP_SLICE][3][WISP_SLICE];
    contact_pieces pieces;
    pieces.are_edges = are_edges;
    for ( int i = 0; i < count; ++i )
    {
        contact_put_pieces( &pieces, i, rows[i].point );
    }
    const float* distance = contact_measure_pieces( work, work->soup->safe, &pieces, count, weight, normal );
    for ( int i = 0; i < count; ++i )
    {
        contact_row* row = rows + i;
        row->distance = distance[i];
        for ( int k = 0; k < 4; ++k )
        {
            row->weight[k] = weight[i / WISP_SLICE][k][i % WISP_SLICE];
        }
        for ( int k = 0; k < 3; ++k )
        {
            row->normal[k] = normal[i / WISP_SLICE][k][i % WISP_SLICE];
        }
    }
}

// Points, weights, normals and distances of up to a batch of pairs, all of one kind, where they are safe.
static void measure_pairs( const contact_work* work, const contact_candidate* const* candidates, int count,
                           bool are_edges, contact_row* rows )
{
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    for ( int i = 0; i < count; ++i )
    {
        contact_set_points( work, candidates[i], are_edges, rows + i );
        if ( are_samples )
        {
            contact_measure_samples( work->soup, work->soup->safe, candidates[i], rows + i );
        }
    }
    if ( are_samples == false )
    {
        measure_pieces( work, count, are_edges, rows );
    }
}

static void begin_row( const contact_work* work, const contact_candidate* c, contact_row* row )
{
    row->a = c->a;
    row->b = c->b;
    row->gap = contact_smaller( c->gap, row->distance );
    row->wanted = c->gap;
    row->friction = sqrtf( contact_guest_of( work, row->point[0] )->settings.friction *
                           contact_guest_of( work, row->point[row->split] )->settings.friction );
    row->pushed = row->rubbed[0] = row->rubbed[1] = row->rubbed[2] = 0.0f;
    row->cut = 1.0f;
}

// ---- rows ----

// By the first side, then by the second.
static int order_of( const contact_candidate* c, int32_t a, int32_t b )
{
    const int first = ( c->a > a ) - ( c->a < a );
    return first != 0 ? first : ( c->b > b ) - ( c->b < b );
}

static int compare( const void* a, const void* b )
{
    const contact_candidate* other = *(const contact_candidate* const*)b;
    return order_of( *(const contact_candidate* const*)a, other->a, other->b );
}

static int take_near( const contact_list* list, const contact_candidate** met )
{
    int count = 0;
    for ( int batch = 0; batch * CONTACT_BATCH < list->count; ++batch )
    {
        for ( int i = 0; i < list->near_count[batch]; ++i )
        {
            met[count++] = list->items + list->near[batch * CONTACT_BATCH + i];
        }
    }
    return count;
}

// @return 1, or 0 if the pair is the last one already
static int put( const contact_candidate** met, int count, const contact_candidate* c )
{
    const bool is_new = count == 0 || compare( met + count - 1, &c ) != 0;
    met[count] = c;
    return is_new ? 1 : 0;
}

// Late pairs are few and in no order, and some are in both lists. @param spare room for the late ones @return how many
static int merge_near( const contact_list* list, const contact_list* late, const contact_candidate** met,
                       const contact_candidate** spare )
{
    const int late_count = take_near( late, spare );
    if ( late_count == 0 )
    {
        return take_near( list, met );
    }
    qsort( spare, (size_t)late_count, sizeof( *spare ), compare );
    int count = 0, next = 0;
    for ( int batch = 0; batch * CONTACT_BATCH < list->count; ++batch )
    {
        for ( int i = 0; i < list->near_count[batch]; ++i )
        {
            const contact_candidate* c = list->items + list->near[batch * CONTACT_BATCH + i];
            for ( ; next < late_count && compare( spare + next, &c ) <= 0; ++next )
            {
                count += put( met, count, spare[next] );
            }
            count += put( met, count, c );
        }
    }
    for ( ; next < late_count; ++next )
    {
        count += put( met, count, spare[next] );
    }
    return count;
}

typedef struct row_loop
{
    const contact_work* work;
    const contact_candidate* const* met;
    contact_row* rows;
    bool are_edges;
} row_loop;

static void fill_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const row_loop* loop = context;
    for ( int first = begin; first < end; first += CONTACT_BATCH )
    {
        const int count = end - first < CONTACT_BATCH ? end - first : CONTACT_BATCH;
        contact_row* rows = loop->rows + first;
        measure_pairs( loop->work, loop->met + first, count, loop->are_edges, rows );
        for ( int i = 0; i < count; ++i )
        {
            begin_row( loop->work, loop->met[first + i], rows + i );
        }
    }
}

wisp_status contact_find_rows( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    s->row_count = s->late_row_count = s->split = 0;
    const size_t most = (size_t)contact_search_lists( work, false );
    const contact_candidate** met;
    if ( contact_reserve( work, CONTACT_MET, 2 * most * sizeof( *met ), (void**)&met ) == false ||
         contact_reserve( work, CONTACT_ROWS, most * sizeof( contact_row ), (void**)&s->rows ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %zu pairs that may meet", most );
    }
    const contact_list* l = s->lists;
    s->split = merge_near( l + CONTACT_POINTS, l + CONTACT_LATE_POINTS, met, met + most );
    const contact_candidate** edges = met + s->split;
    s->row_count = s->split + merge_near( l + CONTACT_EDGES_LIST, l + CONTACT_LATE_EDGES, edges, met + most );
    row_loop of_points = { work, met, s->rows, false }, of_edges = { work, edges, s->rows + s->split, true };
    wisp_parallel_for( work->parallel, s->split, ROW_GRAIN, fill_rows, &of_points );
    wisp_parallel_for( work->parallel, s->row_count - s->split, ROW_GRAIN, fill_rows, &of_edges );
    return contact_make_blocks( work )
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for blocks of %zu pairs", most );
}

// ---- late rows ----

static int compare_with_row( const void* candidate, const void* row )
{
    const contact_row* r = row;
    return order_of( candidate, r->a, r->b );
}

// Those of two lists that are no rows yet, in order. @return how many
static int take_missing( const contact_soup* s, const contact_list* list, const contact_list* late, bool are_edges,
                         const contact_candidate** out )
{
    int found = take_near( list, out ), count = 0;
    found += take_near( late, out + found );
    qsort( out, (size_t)found, sizeof( *out ), compare );
    const contact_row* rows = s->rows + ( are_edges ? s->split : 0 );
    const size_t row_count = (size_t)( are_edges ? s->row_count - s->split : s->split );
    for ( int i = 0; i < found; ++i )
    {
        const bool is_row =
            row_count > 0 && bsearch( out[i], rows, row_count, sizeof( *rows ), compare_with_row ) != NULL;
        count += is_row ? 0 : put( out, count, out[i] );
    }
    return count;
}

wisp_status contact_find_late_rows( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    s->late_row_count = 0;
    const size_t most = (size_t)contact_search_lists( work, true );
    const contact_candidate** out;
    if ( contact_reserve( work, CONTACT_MET, most * sizeof( *out ), (void**)&out ) == false ||
         contact_reserve( work, CONTACT_LATE_ROWS, most * sizeof( contact_row ), (void**)&s->late_rows ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %zu pairs that may meet", most );
    }
    const contact_list* l = s->lists;
    const int split = take_missing( s, l + CONTACT_POINTS, l + CONTACT_LATE_POINTS, false, out );
    const int edges = take_missing( s, l + CONTACT_EDGES_LIST, l + CONTACT_LATE_EDGES, true, out + split );
    s->late_row_count = split + edges;
    row_loop of_points = { work, out, s->late_rows, false },
             of_edges = { work, out + split, s->late_rows + split, true };
    wisp_parallel_for( work->parallel, split, ROW_GRAIN, fill_rows, &of_points );
    wisp_parallel_for( work->parallel, edges, ROW_GRAIN, fill_rows, &of_edges );
    return WISP_OK;
}
