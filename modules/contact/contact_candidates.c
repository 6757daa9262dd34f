// The lists of pairs: what each keeps, which is never more than it has at rest.
#include "contact_internal.h"

#include <string.h>

enum
{
    FILL_GRAIN = 1024, // askers
    THIN_GRAIN = 2048, // candidates
};

bool contact_reserve_list( const contact_work* work, contact_kind kind, size_t count )
{
    contact_list* list = work->soup->lists + kind;
    const contact_place at = (contact_place)kind;
    const size_t batches = count / CONTACT_BATCH + 1, number = sizeof( int32_t );
    *list = ( contact_list ){ .are_edges = kind == CONTACT_EDGES_LIST || kind == CONTACT_LATE_EDGES };
    const bool enough =
        count <= INT32_MAX / 2 &&
        contact_reserve( work, CONTACT_ITEMS + at, count * sizeof( contact_candidate ), (void**)&list->items ) &&
        contact_reserve( work, CONTACT_NEAR + at, count * number, (void**)&list->near ) &&
        contact_reserve( work, CONTACT_NEAR_COUNT + at, batches * number, (void**)&list->near_count );
    list->most = enough ? (int)count : 0;
    return enough;
}

// ---- filling ----

typedef struct fill_loop
{
    const contact_work* work;
    const contact_list* list;
    const wisp_box_pairs* pairs;
    const int32_t* askers;
    bool turned;
    contact_candidate* items; // [pair]
} fill_loop;

static contact_candidate candidate_of( const contact_work* work, bool are_edges, int a, int b )
{
    const contact_soup* s = work->soup;
    contact_candidate c = { .a = a, .b = b, .due = -INFINITY };
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        c.gap = contact_sample_gap_of( work, a, b );
    }
    else if ( are_edges )
    {
        c.gap = contact_gap_of( work, s->edges[(size_t)a * 2], s->edges[(size_t)b * 2] );
        c.drift = contact_drift_between( s->edge_drift + (size_t)a * 4, s->edge_drift + (size_t)b * 4 );
    }
    else
    {
        c.gap = contact_gap_of( work, a, s->triangles[(size_t)b * 3] );
        c.drift = contact_drift_between( s->drift + (size_t)a * 4, s->triangle_drift + (size_t)b * 4 );
    }
    return c;
}

static void fill_items( void* context, int begin, int end, int worker )
{
    (void)worker;
    const fill_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        const int asker = loop->askers != NULL ? loop->askers[i] : i;
        for ( int k = loop->pairs->begin[i]; k < loop->pairs->begin[i + 1]; ++k )
        {
            const int item = loop->pairs->item[k];
            // of two edges the lower is the first
            const bool turned = loop->list->are_edges ? item < asker : loop->turned;
            loop->items[k] =
                candidate_of( loop->work, loop->list->are_edges, turned ? item : asker, turned ? asker : item );
        }
    }
}

// ---- what is thin at rest ----

// Are the boxes around the two sides of a pair nearer than a distance?
static bool boxes_are_within( const float* quads, const int32_t points[4], int split, float distance )
{
    bool within = true;
    for ( size_t k = 0; k < 3 && within; ++k )
    {
        float low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
        for ( int i = 0; i < 4; ++i )
        {
            const float x = quads[(size_t)points[i] * 4 + k];
            low[i >= split] = contact_smaller( low[i >= split], x );
            high[i >= split] = contact_larger( high[i >= split], x );
        }
        within = low[0] - high[1] < distance && low[1] - high[0] < distance;
    }
    return within;
}

// A guest is not pushed apart where it is thinner at rest.
static void thin_gaps( void* context, int begin, int end, int worker )
{
    static const float REST_SHARE = 0.9f; // so that nothing presses at rest
    (void)worker;
    const fill_loop* loop = context;
    const contact_work* work = loop->work;
    const contact_soup* s = work->soup;
    contact_pieces pieces;
    pieces.are_edges = loop->list->are_edges;
    for ( int next = begin; next < end; )
    {
        contact_candidate* thin[CONTACT_BATCH];
        int count = 0;
        for ( ; next < end && count < CONTACT_BATCH; ++next )
        {
            contact_candidate* c = loop->items + next;
            contact_row row;
            contact_set_points( work, c, loop->list->are_edges, &row );
            const bool is_own = contact_guest_of( work, row.point[0] ) == contact_guest_of( work, row.point[3] );
            if ( is_own && boxes_are_within( s->rest, row.point, row.split, 2.0f * c->gap ) )
            {
                contact_put_pieces( &pieces, count, row.point );
                thin[count++] = c;
            }
        }
        const float* distance = contact_measure_distances( work, s->rest, &pieces, count );
        for ( int i = 0; i < count; ++i )
        {
            thin[i]->gap = contact_smaller( thin[i]->gap, REST_SHARE * distance[i] );
        }
    }
}

// What keeps nothing is no pair. @return how many are left
static int close_ranks( contact_candidate* items, int count )
{
    int kept = 0;
    while ( kept < count && items[kept].gap > 0.0f )
    {
        kept += 1;
    }
    for ( int c = kept; c < count; ++c )
    {
        items[kept] = items[c];
        kept += items[c].gap > 0.0f ? 1 : 0;
    }
    return kept;
}

void contact_fill_list( const contact_work* work, contact_kind kind, const wisp_box_pairs* pairs,
                        const int32_t* askers, bool turned )
{
    contact_list* list = work->soup->lists + kind;
    fill_loop loop = { work, list, pairs, askers, turned, list->items + list->count };
    WISP_ASSERT( pairs->pair_count <= (size_t)( list->most - list->count ) );
    wisp_parallel_for( work->parallel, pairs->asker_count, FILL_GRAIN, fill_items, &loop );
    if ( work->state->world.features == WISP_CONTACT_EXACT )
    {
        wisp_parallel_for( work->parallel, (int)pairs->pair_count, THIN_GRAIN, thin_gaps, &loop );
    }
    list->count += close_ranks( loop.items, (int)pairs->pair_count );
}
