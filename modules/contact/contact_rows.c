// The planes between pairs that may meet in this substep, found where nothing crossed yet. The closest points of two convex
// pieces have a plane between them that separates the pieces whole, so that whoever stays behind it has not crossed.
#include "contact_internal.h"

#include <stdlib.h>
#include <string.h>

enum
{
    ROW_GRAIN = 256,
    DIGIT_BITS = 8,
    DIGITS = 1 << DIGIT_BITS,
};

void contact_set_points( const contact_work* work, const contact_pair* c, bool is_edge, contact_row* row )
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
static void measure_pairs( const contact_work* work, const contact_pair* pairs, int count, bool are_edges,
                           contact_row* rows )
{
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    for ( int i = 0; i < count; ++i )
    {
        contact_set_points( work, pairs + i, are_edges, rows + i );
        if ( are_samples )
        {
            contact_measure_samples( work->soup, work->soup->safe, pairs + i, rows + i );
        }
    }
    if ( are_samples == false )
    {
        measure_pieces( work, count, are_edges, rows );
    }
}

static void begin_row( const contact_work* work, const contact_pair* c, contact_row* row )
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
static int order_of( const contact_pair* c, int32_t a, int32_t b )
{
    const int first = ( c->a > a ) - ( c->a < a );
    return first != 0 ? first : ( c->b > b ) - ( c->b < b );
}

static int compare_with_row( const void* pair, const void* row )
{
    const contact_row* r = row;
    return order_of( pair, r->a, r->b );
}

static void count_digits( const contact_pair* from, int count, bool by_a, int shift, int32_t begin[DIGITS + 1] )
{
    memset( begin, 0, ( DIGITS + 1 ) * sizeof( *begin ) );
    for ( int i = 0; i < count; ++i )
    {
        const int32_t number = by_a ? from[i].a : from[i].b;
        begin[( number >> shift & ( DIGITS - 1 ) ) + 1] += 1;
    }
    for ( int d = 0; d < DIGITS; ++d )
    {
        begin[d + 1] += begin[d];
    }
}

// Radix sort: no two pairs are equal. @param spare [near->count]
static void sort_pairs( contact_near* near, contact_pair* spare )
{
    contact_pair *from = near->items, *to = spare;
    int32_t most[2] = { 0, 0 }, begin[DIGITS + 1];
    for ( int i = 0; i < near->count; ++i )
    {
        most[0] = from[i].b > most[0] ? from[i].b : most[0];
        most[1] = from[i].a > most[1] ? from[i].a : most[1];
    }
    for ( int side = 0; side < 2; ++side )
    {
        for ( int shift = 0; most[side] >> shift > 0; shift += DIGIT_BITS )
        {
            count_digits( from, near->count, side == 1, shift, begin );
            for ( int i = 0; i < near->count; ++i )
            {
                const int32_t number = side == 1 ? from[i].a : from[i].b;
                to[begin[number >> shift & ( DIGITS - 1 )]++] = from[i];
            }
            contact_pair* const sorted = to;
            to = from;
            from = sorted;
        }
    }
    if ( from != near->items )
    {
        memcpy( near->items, from, (size_t)near->count * sizeof( *from ) );
    }
}

static wisp_status find_sorted( const contact_work* work, bool late_only, wisp_error* error )
{
    contact_soup* s = work->soup;
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    const wisp_status status = are_samples ? contact_find_near_samples( work, late_only, error )
                                           : contact_find_near( work, late_only, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const int most = s->near[0].count > s->near[1].count ? s->near[0].count : s->near[1].count;
    contact_pair* spare;
    if ( contact_reserve( work, CONTACT_NEAR_SPARE, (size_t)most * sizeof( *spare ), (void**)&spare ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d pairs that may meet", most );
    }
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        sort_pairs( s->near + kind, spare );
    }
    return WISP_OK;
}

typedef struct row_loop
{
    const contact_work* work;
    const contact_pair* pairs;
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
        measure_pairs( loop->work, loop->pairs + first, count, loop->are_edges, rows );
        for ( int i = 0; i < count; ++i )
        {
            begin_row( loop->work, loop->pairs + first + i, rows + i );
        }
    }
}

static wisp_status fill_all( const contact_work* work, contact_place place, contact_row** rows, wisp_error* error )
{
    contact_soup* s = work->soup;
    const int split = s->near[CONTACT_POINTS].count, edges = s->near[CONTACT_EDGES].count;
    if ( contact_reserve( work, place, (size_t)( split + edges ) * sizeof( **rows ), (void**)rows ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d pairs that may meet", split + edges );
    }
    row_loop of_points = { work, s->near[CONTACT_POINTS].items, *rows, false },
             of_edges = { work, s->near[CONTACT_EDGES].items, *rows + split, true };
    wisp_parallel_for( work->parallel, split, ROW_GRAIN, fill_rows, &of_points );
    wisp_parallel_for( work->parallel, edges, ROW_GRAIN, fill_rows, &of_edges );
    return WISP_OK;
}

wisp_status contact_find_rows( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    s->row_count = s->late_row_count = s->split = 0;
    wisp_status status = find_sorted( work, false, error );
    status = status == WISP_OK ? fill_all( work, CONTACT_ROWS, &s->rows, error ) : status;
    if ( status != WISP_OK )
    {
        return status;
    }
    s->split = s->near[CONTACT_POINTS].count;
    s->row_count = s->split + s->near[CONTACT_EDGES].count;
    return contact_make_blocks( work )
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "no memory for blocks of %d pairs", s->row_count );
}

// ---- late rows ----

// Those that are no rows yet.
static void keep_missing( contact_near* near, const contact_row* rows, int row_count )
{
    int kept = 0;
    for ( int i = 0; i < near->count; ++i )
    {
        const bool is_row = row_count > 0 && bsearch( near->items + i, rows, (size_t)row_count, sizeof( *rows ),
                                                      compare_with_row ) != NULL;
        near->items[kept] = near->items[i];
        kept += is_row ? 0 : 1;
    }
    near->count = kept;
}

wisp_status contact_find_late_rows( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    s->late_row_count = 0;
    wisp_status status = find_sorted( work, true, error );
    if ( status == WISP_OK )
    {
        keep_missing( s->near + CONTACT_POINTS, s->rows, s->split );
        keep_missing( s->near + CONTACT_EDGES, s->rows + s->split, s->row_count - s->split );
        status = fill_all( work, CONTACT_LATE_ROWS, &s->late_rows, error );
    }
    s->late_row_count = status == WISP_OK ? s->near[CONTACT_POINTS].count + s->near[CONTACT_EDGES].count : 0;
    return status;
}
