// Broad phase: which clusters may come near each other before the next search. In: intersection-free positions and
// predicted motions. Out: the list of pairs with their cached bounds.
//
// The box of a cluster holds it as long as it keeps to its predicted motion within its margin, in a frame that moves
// with the mean of all points. Pairs are the overlaps of such boxes, found by grids (wisp/module/aabb_pairs.h).
// With too many overlaps the margins are halved until the list fits; displacements must then stay within them
// (displacement_limit.c). A cloth that folds is searched about twice per step; a thousand clusters cost 0.3 ms.
#include "broad_phase.h"

#include "clusters.h"
#include "predicted_motion.h"

#include <string.h>

enum
{
    BOX_GRAIN = 256,
    MAX_PER_CLUSTER = 512, // pairs per cluster before margins are halved
    MAX_HALVINGS = 40,
};

// ---- boxes ----

static wisp_aabb box_of_motion( const contact_work* work, int p )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_predicted_motion* predicted = s->motion->predicted + p;
    const float wide =
        0.5f * work->participants[s->clusters->items[p].participant].settings.thickness + predicted->margin;
    wisp_aabb box = contact_box_around( work, s->clusters->items + p );
    for ( int k = 0; k < 3; ++k )
    {
        const float way = (float)CONTACT_SUBSTEPS_AHEAD * predicted->displacement[k];
        box.lower[k] += contact_smaller( way, 0.0f ) - wide;
        box.upper[k] += contact_larger( way, 0.0f ) + wide;
    }
    return box;
}

static void box_clusters( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    for ( int p = begin; p < end; ++p )
    {
        work->contact_mesh->broad_phase->boxes[p] = box_of_motion( work, p );
    }
}

static int keep_allowed( const void* context, int query, int32_t* items, int count )
{
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        items[kept] = item;
        kept += contact_clusters_may_meet( context, query, item ) ? 1 : 0;
    }
    return kept;
}

// ---- searching ----

static wisp_status find_cluster_pairs( const contact_work* work, wisp_error* error )
{
    contact_broad_phase* b = work->contact_mesh->broad_phase;
    const int count = work->contact_mesh->clusters->count;
    if ( contact_reserve( work, &b->box_buffer, (size_t)count * sizeof( *b->boxes ), (void**)&b->boxes ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for the boxes of %d clusters", count );
    }
    wisp_parallel_for( work->parallel, count, BOX_GRAIN, box_clusters, (void*)(uintptr_t)work );
    const wisp_aabb_args args = {
        .boxes = b->boxes,
        .box_count = count,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = (size_t)count * MAX_PER_CLUSTER,
        .filter = keep_allowed,
        .filter_context = work,
    };
    return wisp_aabb_pairs_find( &b->overlaps, work->parallel, &args, error );
}

static void halve_margins( const contact_contact_mesh* s )
{
    for ( int p = 0; p < s->clusters->count; ++p )
    {
        contact_predicted_motion* predicted = s->motion->predicted + p;
        predicted->margin *= 0.5f;
        for ( int k = 0; k < 3; ++k )
        {
            predicted->displacement[k] *= 0.5f;
        }
    }
}

wisp_status contact_search( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_broad_phase* b = s->broad_phase;
    wisp_status status = WISP_BAD_INPUT;
    b->searches += 1;
    b->is_short = false;
    contact_predict_motion( work );
    for ( int halvings = 0; status == WISP_BAD_INPUT && halvings < MAX_HALVINGS; ++halvings )
    {
        status = find_cluster_pairs( work, error );
        if ( status == WISP_BAD_INPUT ) // more pairs than the limit
        {
            halve_margins( s );
            b->is_short = true;
        }
    }
    if ( status == WISP_OK && contact_list_cluster_pairs( work, &b->overlaps, s->is_listed ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "out of memory for %zu pairs", b->overlaps.pair_count );
    }
    s->is_listed = status == WISP_OK;
    return status;
}

// Cached bounds: of each pair of clusters a lower bound of the distance of its primitives, less their gap. In:
// overlaps of the broad phase; displacements of clusters. Out: the pairs that may reach their gap in this substep,
// for the narrow phase.
//
// A bound that was measured shrinks in each substep by the most that the two clusters approached each other. A pair
// is active when its bound may be used up in this substep, which in a folded cloth is one pair in eight. Bounds
// outlive searches. This is temporal coherence in the manner of conservative advancement (Mirtich 1996), with pairs
// of clusters for pairs of bodies.

enum
{
    LIST_GRAIN = 64,
    PAIRS_PER_BLOCK = 1024,
};

// ---- the list ----

static bool reserve_pairs( const contact_work* work, size_t count )
{
    contact_cached_bounds* b = work->contact_mesh->bounds;
    contact_cluster_pairs* pairs = &b->pairs;
    const size_t begins = (size_t)work->contact_mesh->clusters->count + 1, most = count + WISP_SLICE,
                 index = sizeof( int32_t ), blocks = most / PAIRS_PER_BLOCK + 1;
    return contact_reserve( work, b->buffers + CONTACT_BOUND_BEGIN, begins * index, (void**)&pairs->begin ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_CLUSTER, most * index, (void**)&pairs->cluster ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_OTHER, most * index, (void**)&pairs->other ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_SLACK, most * sizeof( float ), (void**)&pairs->slack ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_LIST, most * sizeof( *pairs->list ),
                            (void**)&pairs->list ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_ACTIVE, most * index, (void**)&b->active ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_SEARCHED, most * index, (void**)&b->searched ) &&
           contact_reserve( work, b->buffers + CONTACT_BOUND_ACTIVE_COUNT, blocks * index, (void**)&b->active_count );
}

// Copy what is known of the pairs to scratch memory. @return false without memory
static bool copy_pairs( const contact_work* work, contact_cluster_pairs* to )
{
    const contact_cluster_pairs* pairs = &work->contact_mesh->bounds->pairs;
    const size_t count = (size_t)pairs->count, begins = (size_t)work->contact_mesh->clusters->count + 1;
    char* scratch =
        wisp_parallel_scratch( work->parallel, work->worker,
                               count * ( sizeof( *to->list ) + sizeof( *to->slack ) + sizeof( *to->other ) ) +
                                   begins * sizeof( *to->begin ) );
    if ( scratch == NULL )
    {
        return false;
    }
    to->list = memcpy( scratch, pairs->list, count * sizeof( *to->list ) );
    to->slack = memcpy( to->list + count, pairs->slack, count * sizeof( *to->slack ) );
    to->other = memcpy( to->slack + count, pairs->other, count * sizeof( *to->other ) );
    to->begin = memcpy( to->other + count, pairs->begin, begins * sizeof( *to->begin ) );
    return true;
}

// @param known where the list before has the pair; -1: nowhere
static void put_pair( const contact_cached_bounds* b, int at, int32_t cluster, int32_t other,
                      const contact_cluster_pairs* before, int known )
{
    const contact_cluster_pairs* pairs = &b->pairs;
    pairs->cluster[at] = cluster;
    pairs->other[at] = other;
    pairs->slack[at] = known >= 0 ? before->slack[known] : -INFINITY;
    pairs->list[at] = known >= 0 ? before->list[known] : ( contact_list ){ 0, 0, 0, 0.0f };
    if ( pairs->list[at].points + pairs->list[at].edges > 0 )
    {
        b->listed[pairs->list[at].first - 1].a = at;
    }
}

// Bounds of a cluster's pairs in the list before, in the order of the other clusters.
typedef struct known_pairs
{
    const contact_cluster_pairs* pairs;
    int next, end;
} known_pairs;

// A pair that was listed before keeps its bound and its list; of a new one nothing is known.
static int place_of( known_pairs* known, int32_t other )
{
    while ( known->next < known->end && known->pairs->other[known->next] < other )
    {
        known->next += 1;
    }
    const bool is_known = known->next < known->end && known->pairs->other[known->next] == other;
    return is_known ? known->next : -1;
}

typedef struct list_loop
{
    const contact_work* work;
    const wisp_aabb_pairs* found;
    const contact_cluster_pairs* before; // null: unknown
} list_loop;

static void list_pairs_of( void* context, int begin, int end, int worker )
{
    (void)worker;
    const list_loop* loop = context;
    contact_contact_mesh* s = loop->work->contact_mesh;
    const wisp_aabb_pairs* found = loop->found;
    for ( int p = begin; p < end; ++p )
    {
        known_pairs known = { .pairs = loop->before };
        if ( known.pairs != NULL )
        {
            known.next = known.pairs->begin[p];
            known.end = known.pairs->begin[p + 1];
        }
        int at = s->bounds->pairs.begin[p];
        if ( contact_clusters_may_meet( loop->work, p, p ) )
        {
            put_pair( s->bounds, at++, p, p, known.pairs, place_of( &known, p ) );
        }
        for ( int i = found->begin[p]; i < found->begin[p + 1]; ++i )
        {
            const int32_t other = found->item[i];
            put_pair( s->bounds, at++, p, other, known.pairs, place_of( &known, other ) );
        }
    }
}

bool contact_list_cluster_pairs( const contact_work* work, const wisp_aabb_pairs* found, bool is_known )
{
    contact_contact_mesh* s = work->contact_mesh;
    contact_cluster_pairs *pairs = &s->bounds->pairs, before;
    if ( ( is_known && copy_pairs( work, &before ) == false ) ||
         reserve_pairs( work, found->pair_count + (size_t)s->clusters->count ) == false )
    {
        return false;
    }
    pairs->count = 0;
    for ( int p = 0; p < s->clusters->count; ++p )
    {
        pairs->begin[p] = pairs->count;
        pairs->count += ( contact_clusters_may_meet( work, p, p ) ? 1 : 0 ) + found->begin[p + 1] - found->begin[p];
    }
    pairs->begin[s->clusters->count] = pairs->count;
    list_loop loop = { work, found, is_known ? &before : NULL };
    wisp_parallel_for( work->parallel, s->clusters->count, LIST_GRAIN, list_pairs_of, &loop );
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        put_pair( s->bounds, pairs->count + i, 0, 0, NULL, -1 );
        pairs->slack[pairs->count + i] = INFINITY;
    }
    return true;
}

bool contact_make_room_for_listed( const contact_work* work, int more )
{
    contact_cached_bounds* b = work->contact_mesh->bounds;
    contact_cluster_pairs* pairs = &b->pairs;
    int kept = 0;
    for ( int at = 0, next; at < b->listed_count; at = next )
    {
        const contact_listed* head = b->listed + at;
        contact_list* list = head->a < pairs->count ? pairs->list + head->a : NULL;
        next = at + 1 + head->b;
        if ( list != NULL && list->first == at + 1 && list->points + list->edges == head->b )
        {
            list->first = kept + 1;
            memmove( b->listed + kept, head, (size_t)( next - at ) * sizeof( *head ) );
            kept += next - at;
        }
    }
    b->listed_count = kept;
    const int64_t needed = (int64_t)kept + more, most = needed > b->listed_most ? 2 * needed : b->listed_most;
    const bool enough =
        most <= INT32_MAX && contact_reserve( work, b->buffers + CONTACT_BOUND_LISTED,
                                              (size_t)most * sizeof( *b->listed ), (void**)&b->listed );
    b->listed_most = enough ? (int)most : b->listed_most;
    return enough;
}

// ---- active pairs ----

typedef struct active_loop
{
    const contact_work* work;
    bool missed_only;
} active_loop;

// Pairs without a bound are active, and so are those with NaN.
static void find_active( void* context, int begin, int end, int worker )
{
    (void)worker;
    const active_loop* loop = context;
    const contact_contact_mesh* s = loop->work->contact_mesh;
    const wisp_separation_args args = {
        .moved = loop->missed_only ? NULL : s->motion->gone->middle,
        .predicted = s->motion->ways->middle,
        .first = s->bounds->pairs.cluster,
        .second = s->bounds->pairs.other,
        .separation_bound = s->bounds->pairs.slack,
        .active = s->bounds->active,
    };
    s->bounds->active_count[begin / PAIRS_PER_BLOCK] =
        wisp_frame_kernels( loop->work->frame )->find_active_pairs( &args, begin, end );
}

// Compact the active pairs of all blocks, and select those to be searched.
static int gather_active( const contact_contact_mesh* s, bool missed_only )
{
    contact_cached_bounds* b = s->bounds;
    const contact_cluster_pairs* pairs = &b->pairs;
    const uint8_t* is_missed = s->motion->cluster_is_missed;
    int count = 0;
    b->searched_count = 0;
    for ( int first = 0; first < pairs->count; first += PAIRS_PER_BLOCK )
    {
        for ( int i = first; i < first + b->active_count[first / PAIRS_PER_BLOCK]; ++i )
        {
            const int32_t pair = b->active[i], one = pairs->cluster[pair], other = pairs->other[pair];
            if ( missed_only == false || ( is_missed[one] | is_missed[other] ) != 0 )
            {
                const float closing = contact_closing_of( s->motion->ways + one, s->motion->ways + other );
                const bool holds = pairs->slack[pair] + pairs->list[pair].beyond >= closing;
                b->active[count++] = pair;
                b->searched[b->searched_count] = pair;
                b->searched_count += holds ? 0 : 1;
                if ( holds == false )
                {
                    pairs->list[pair].points = pairs->list[pair].edges = 0; // makes room for the next list
                }
            }
        }
    }
    return count;
}

int contact_find_active_clusters( const contact_work* work, bool missed_only )
{
    active_loop loop = { work, missed_only };
    wisp_parallel_for( work->parallel, work->contact_mesh->bounds->pairs.count, PAIRS_PER_BLOCK, find_active, &loop );
    return gather_active( work->contact_mesh, missed_only );
}
