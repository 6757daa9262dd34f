// Narrow phase: which primitives of two clusters may reach their gap in this substep. In: active pairs of clusters.
// Out: active pairs of primitives, and a new bound and list for each active pair of clusters.
//
// - Two clusters that a plane separates widely enough need no more: a plane across the line between their boxes, or
//   across the normal of either.
// - Otherwise edges meet edges and points meet triangles, for eight pairs of clusters per kernel call. Planes across
//   the line between the centres of two primitives, and across each, cull most pairs. The rest is measured exactly,
//   and listed with its distance where it is near. A list holds until its bound is used up (broad_phase.c).
// - In each substep the listed pairs that may reach their gap are measured again (primitive_pairs.c).
// - With too many pairs, displacements are cut to the smallest thickness and the pairs are found again: a cloth that
//   collapsed, with all of it within the displacements of a substep, would have every pair of primitives.
#include "narrow_phase.h"

#include "broad_phase.h"
#include "clusters.h"
#include "predicted_motion.h"
#include "primitive_pairs.h"

#include <limits.h>
#include <stdatomic.h>
#include <string.h>

enum
{
    SEARCH_GRAIN = 16, // pairs of clusters
    SELECT_GRAIN = 32,
    MAX_PER_POINT = 64, // pairs of primitives before displacements are shortened; a stack of cloth has 10
    MIN_MAX_PAIRS = 1024,
};

// All in gaps beyond the gap itself. Clusters that a plane separates by APART are not split into primitives.
// Primitives within MEASURED are measured, and listed where their clusters approach by less than SLOW in a substep, so
// that the list holds for some. Otherwise the list is brief: only what is active in this substep. Farther ones have a
// separating plane for a bound; beyond SEEN from the other cluster's box they are skipped.
static const float APART_GAPS = 0.5f, MEASURED_GAPS = 0.6f, SLOW_GAPS = 0.3f, SEEN_GAPS = 1.5f;

typedef struct near_loop
{
    const contact_work* work;
    contact_contact_mesh* contact_mesh;
    int active_count, max_pairs;
    _Atomic int total[CONTACT_KIND_COUNT], stored[CONTACT_KIND_COUNT]; // active pairs, and those that repeat no other
    _Atomic int listed, brief;                                         // listed pairs, and those in brief lists
    _Atomic bool is_out_of_memory;
} near_loop;

// ---- primitives of two clusters ----

// A pair of clusters under test.
typedef struct cluster_test
{
    int pair, cluster[2];
    const contact_placed* placed[2];
    float gap, closing; // m
    float bound;        // m, of pairs that are not listed
    contact_list list;
    _Alignas( 32 ) float least[WISP_SLICE]; // m, separation of pairs that a plane culled
} cluster_test;

// Scratch memory of a task: its pairs of clusters, and the pairs of primitives to measure.
typedef struct narrow_task
{
    near_loop* loop;
    int placed_count, placed_cluster[2 * SEARCH_GRAIN];
    contact_placed placed[2 * SEARCH_GRAIN];
    cluster_test tests[WISP_PRIMITIVE_BATCH];
    float measured[WISP_PRIMITIVE_BATCH], listed[WISP_PRIMITIVE_BATCH]; // m, distances up to which pairs are
    bool is_brief[WISP_PRIMITIVE_BATCH];
    contact_batch batches[CONTACT_KIND_COUNT];
} narrow_task;

// Place a cluster, once in a task.
static const contact_placed* place( narrow_task* task, int cluster )
{
    int i = task->placed_count - 1;
    for ( ; i >= 0 && task->placed_cluster[i] != cluster; --i )
    {
    }
    if ( i < 0 )
    {
        i = task->placed_count++;
        task->placed_cluster[i] = cluster;
        contact_place_cluster( task->loop->work, cluster, task->placed + i );
    }
    return task->placed + i;
}

// Measure the pairs of a batch, keep those to be listed, and lower the bounds of their clusters by the others.
static void measure( narrow_task* task, contact_kind kind )
{
    contact_batch* batch = task->batches + kind;
    int selected = 0;
    contact_measure_batch( task->loop->work, kind, batch );
    for ( int i = 0; i < batch->count; )
    {
        const int number = batch->of[i];
        cluster_test* test = task->tests + number;
        const float listed = task->listed[number], gap = test->gap;
        float least = INFINITY;
        for ( ; i < batch->count && batch->of[i] == number; ++i )
        {
            const float distance = batch->distance[i];
            least = distance < listed && task->is_brief[number] == false ? least : contact_smaller( distance, least );
            batch->gap[i] = gap;
            batch->selected[selected] = i;
            selected += distance < listed ? 1 : 0;
        }
        test->bound = contact_smaller( least - 1.001f * gap, test->bound );
    }
    contact_keep_near( task->loop->work, kind, batch, selected, task->is_brief );
    for ( int i = 0; i < batch->count; ++i )
    {
        contact_list* list = &task->tests[batch->of[i]].list;
        *( kind == CONTACT_POINTS ? &list->points : &list->edges ) += 1;
    }
}

// List the pairs of a batch. @param at [test] where the next one is listed; moved on
static void list_pairs( const narrow_task* task, contact_kind kind, int* at )
{
    const contact_batch* batch = task->batches + kind;
    contact_listed* listed = task->loop->contact_mesh->bounds->listed;
    for ( int i = 0; i < batch->count; ++i )
    {
        listed[at[batch->of[i]]++] = ( contact_listed ){
            .a = batch->first[i],
            .b = batch->second[i],
            .gap = batch->gap[i],
            .key = contact_key_of( batch->distance[i], batch->gap[i], task->tests[batch->of[i]].bound ),
        };
    }
}

// Test primitives of one kind in one cluster against those of another kind in the other. @param query which of the
// two clusters
static void find_pairs( narrow_task* task, const int* numbers, int count, int query, const int kinds[2],
                        contact_kind kind )
{
    const contact_contact_mesh* s = task->loop->contact_mesh;
    const wisp_kernels* kernels = wisp_frame_kernels( task->loop->work->frame );
    contact_batch* batch = task->batches + kind;
    wisp_primitive_near_args arg_list[WISP_PRIMITIVE_BATCH];
    int job_count = 0;
    for ( int i = 0; i < count; ++i )
    {
        cluster_test* test = task->tests + numbers[i];
        const bool is_own = test->cluster[0] == test->cluster[1];
        const contact_cluster *a = s->clusters->items + test->cluster[query],
                              *b = s->clusters->items + test->cluster[1 - query];
        const contact_placed *one = test->placed[query], *other = test->placed[1 - query];
        arg_list[job_count] = ( wisp_primitive_near_args ){
            .queries = contact_packs_of( one, a, kinds[0] ),
            .packs = contact_packs_of( other, b, kinds[1] ),
            .query_pack_count = a->rows[kinds[0]],
            .pack_count = b->rows[kinds[1]],
            .query_aabb = &one->box,
            .box = &other->box,
            .max_distance = task->measured[numbers[i]],
            .cull_distance = task->measured[numbers[i]] + SEEN_GAPS * test->gap,
            .min_distance = test->least,
            .is_self = is_own,
            .cluster = numbers[i],
        };
        job_count += query == 0 || is_own == false ? 1 : 0;
    }
    wisp_primitive_pairs to;
    contact_take_room( batch, &to );
    batch->count +=
        ( kind == CONTACT_EDGES ? kernels->find_near_edges : kernels->find_near_points )( arg_list, job_count, &to );
}

// Return the separation of two clusters along the line between their boxes or across one of them, m.
static float separation_of( const wisp_kernels* kernels, const contact_contact_mesh* s, const cluster_test* test )
{
    const contact_cluster *a = s->clusters->items + test->cluster[0], *b = s->clusters->items + test->cluster[1];
    wisp_separating_axis_args args = {
        .xyzw = s->intersection_free,
        .point_x4 = { s->clusters->points + a->first_point, s->clusters->points + b->first_point },
        .count = { a->point_count, b->point_count },
    };
    const wisp_aabb *box = &test->placed[0]->box, *other = &test->placed[1]->box;
    for ( int k = 0; k < 3; ++k )
    {
        args.axis[0][k] = test->placed[0]->normal[k];
        args.axis[1][k] = test->placed[1]->normal[k];
        args.axis[2][k] = ( box->lower[k] + box->upper[k] ) - ( other->lower[k] + other->upper[k] );
    }
    return kernels->separation( &args );
}

// Test the pairs of clusters of a task.
static void test_clusters( narrow_task* task, int count )
{
    static const int EDGES[2] = { 1, 1 }, POINTS[2] = { 0, 2 };
    const contact_contact_mesh* s = task->loop->contact_mesh;
    const wisp_kernels* kernels = wisp_frame_kernels( task->loop->work->frame );
    int numbers[WISP_PRIMITIVE_BATCH] = { 0 }, near_count = 0;
    for ( int i = 0; i < count; ++i )
    {
        cluster_test* test = task->tests + i;
        const float apart = test->cluster[0] == test->cluster[1] ? 0.0f : separation_of( kernels, s, test );
        const bool is_apart = apart > 1.001f * test->gap + test->closing + APART_GAPS * test->gap;
        test->bound = is_apart ? apart - 1.001f * test->gap : test->bound;
        numbers[near_count] = i;
        near_count += is_apart ? 0 : 1;
    }
    find_pairs( task, numbers, near_count, 0, EDGES, CONTACT_EDGES );
    find_pairs( task, numbers, near_count, 0, POINTS, CONTACT_POINTS );
    find_pairs( task, numbers, near_count, 1, POINTS, CONTACT_POINTS );
}

static void begin_test( narrow_task* task, int number, int pair )
{
    const contact_contact_mesh* s = task->loop->contact_mesh;
    const contact_participant* participants = task->loop->work->participants;
    const int a = s->bounds->pairs[0].cluster[pair], b = s->bounds->pairs[0].other[pair];
    cluster_test* test = task->tests + number;
    *test = ( cluster_test ){ .pair = pair, .cluster = { a, b }, .placed = { place( task, a ), place( task, b ) } };
    test->gap = contact_gap_between( participants + s->clusters->items[a].participant,
                                     participants + s->clusters->items[b].participant );
    test->closing = contact_closing_of( s->motion->ways + a, s->motion->ways + b );
    const float needed = 1.001f * test->gap + test->closing;
    task->measured[number] = needed + MEASURED_GAPS * test->gap;
    task->is_brief[number] = test->closing >= SLOW_GAPS * test->gap;
    task->listed[number] = task->is_brief[number] ? needed : task->measured[number];
    test->bound = test->closing + ( MEASURED_GAPS + SEEN_GAPS ) * test->gap;
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        test->least[i] = INFINITY;
    }
}

// Lower the bound of a pair of clusters by what planes culled.
static void lower_bound( cluster_test* test )
{
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        test->bound = contact_smaller( test->least[i] - 1.001f * test->gap, test->bound );
    }
}

static bool is_too_long( near_loop* loop )
{
    return atomic_load( loop->total + CONTACT_POINTS ) >
               loop->max_pairs - atomic_load( loop->total + CONTACT_EDGES ) ||
           atomic_load( &loop->brief ) > loop->max_pairs;
}

// Search up to a batch of pairs of clusters.
static void search_batch( narrow_task* task, const int32_t* pairs, int count )
{
    near_loop* loop = task->loop;
    contact_cached_bounds* bounds = loop->contact_mesh->bounds;
    task->batches[CONTACT_POINTS].count = task->batches[CONTACT_EDGES].count = 0;
    for ( int i = 0; i < count; ++i )
    {
        begin_test( task, i, pairs[i] );
    }
    test_clusters( task, count );
    measure( task, CONTACT_POINTS );
    measure( task, CONTACT_EDGES );
    int length = 0, brief = 0, at[WISP_PRIMITIVE_BATCH];
    for ( int i = 0; i < count; ++i )
    {
        const int listed = task->tests[i].list.points + task->tests[i].list.edges;
        lower_bound( task->tests + i );
        length += listed > 0 ? listed + 1 : 0;
        brief += task->is_brief[i] ? listed : 0;
    }
    atomic_fetch_add( &loop->brief, brief );
    int next = bounds->listed_count + atomic_fetch_add( &loop->listed, length );
    if ( length > bounds->listed_most - next )
    {
        return;
    }
    for ( int i = 0; i < count; ++i )
    {
        cluster_test* test = task->tests + i;
        const int listed = test->list.points + test->list.edges;
        at[i] = test->list.first = next + 1;
        if ( listed > 0 )
        {
            bounds->listed[next] = ( contact_listed ){ .a = test->pair, .b = listed };
            next += listed + 1;
        }
        bounds->pairs[0].slack[test->pair] = test->bound;
        bounds->pairs[0].list[test->pair] = test->list;
    }
    list_pairs( task, CONTACT_POINTS, at );
    list_pairs( task, CONTACT_EDGES, at );
}

static void search_clusters( void* context, int begin, int end, int worker )
{
    near_loop* loop = context;
    narrow_task* task = wisp_parallel_scratch( loop->work->parallel, worker, sizeof( *task ) );
    if ( task == NULL )
    {
        atomic_store( &loop->is_out_of_memory, true );
        return;
    }
    task->loop = loop;
    task->placed_count = 0;
    for ( int first = begin; first < end && is_too_long( loop ) == false; first += WISP_PRIMITIVE_BATCH )
    {
        const int left = end - first;
        search_batch( task, loop->contact_mesh->bounds->searched + first,
                      left < WISP_PRIMITIVE_BATCH ? left : WISP_PRIMITIVE_BATCH );
    }
}

// ---- listed pairs ----

// Describe the listed pairs of two clusters.
static contact_listed_source source_of( const contact_work* work, int pair )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_cluster_pairs* pairs = s->bounds->pairs;
    const int a = pairs->cluster[pair], b = pairs->other[pair];
    const contact_participant *of_a = work->participants + s->clusters->items[a].participant,
                              *of_b = work->participants + s->clusters->items[b].participant;
    return ( contact_listed_source ){
        .list = pairs->list + pair,
        .slack = pairs->slack[pair] + pairs->list[pair].beyond,
        .closing = contact_closing_of( s->motion->ways + a, s->motion->ways + b ),
        .gap = contact_gap_between( of_a, of_b ),
        .has_owners = work->memory->tangled == 0 && ( of_a->is_corrected || of_b->is_corrected ) == false,
    };
}

static void select_listed( void* context, int begin, int end, int worker )
{
    (void)worker;
    near_loop* loop = context;
    const contact_work* work = loop->work;
    const contact_contact_mesh* s = loop->contact_mesh;
    const contact_cluster_pairs* pairs = s->bounds->pairs;
    contact_candidates candidates[CONTACT_KIND_COUNT];
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        candidates[kind].kind = (contact_kind)kind;
        candidates[kind].count = 0;
    }
    for ( int i = begin; i < end && is_too_long( loop ) == false; ++i )
    {
        contact_listed_source from = source_of( work, s->bounds->active[i] );
        contact_list* list = pairs->list + s->bounds->active[i];
        list->beyond = 0.0f;
        for ( int k = 0; k < list->points + list->edges; ++k )
        {
            contact_listed* listed = s->bounds->listed + list->first + k;
            const int kind = k < list->points ? CONTACT_POINTS : CONTACT_EDGES;
            if ( listed->key + from.slack >= from.closing )
            {
                list->beyond = contact_larger( -listed->key, list->beyond );
            }
            else if ( contact_add_candidate( work, candidates + kind, listed, &from ) == false )
            {
                contact_select_active( work, candidates + kind, loop->total + kind, loop->stored + kind );
            }
        }
        pairs->slack[s->bounds->active[i]] = from.slack;
    }
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        contact_select_active( work, candidates + kind, loop->total + kind, loop->stored + kind );
    }
    for ( int i = begin; i < end; ++i )
    {
        pairs->slack[s->bounds->active[i]] -= pairs->list[s->bounds->active[i]].beyond;
    }
}

// Make the lists that do not hold. @return false without memory
static bool make_lists( near_loop* loop )
{
    contact_cached_bounds* bounds = loop->contact_mesh->bounds;
    const bool is_full = bounds->last_length > bounds->listed_most - bounds->listed_count;
    bool enough = is_full == false || contact_make_room_for_listed( loop->work, 0 ), fits = false;
    atomic_init( &loop->is_out_of_memory, false );
    while ( enough && fits == false )
    {
        atomic_init( &loop->listed, 0 );
        atomic_init( &loop->brief, 0 );
        wisp_parallel_for( loop->work->parallel, bounds->searched_count, SEARCH_GRAIN, search_clusters, loop );
        const int length = atomic_load( &loop->listed );
        bounds->last_length = length;
        fits = is_too_long( loop ) || length <= bounds->listed_most - bounds->listed_count;
        enough = atomic_load( &loop->is_out_of_memory ) == false &&
                 ( fits || contact_make_room_for_listed( loop->work, length ) );
    }
    bounds->listed_count += is_too_long( loop ) ? 0 : atomic_load( &loop->listed );
    return enough;
}

// @return whether `near` had room for all pairs
static bool select_all( near_loop* loop )
{
    contact_near* near = loop->contact_mesh->primitives->near;
    bool fits = true;
    wisp_parallel_for( loop->work->parallel, loop->active_count, SELECT_GRAIN, select_listed, loop );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        near[kind].count = atomic_load( loop->stored + kind );
        fits = fits && near[kind].count <= near[kind].most;
    }
    return fits;
}

// Pairs that may be found before displacements are shortened. They are not where nothing limits them.
static int max_pairs_of( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const int most = s->point_count < INT_MAX / MAX_PER_POINT ? s->point_count * MAX_PER_POINT : INT_MAX;
    return s->motion->reach < INFINITY || work->settings->level != WISP_CONTACT_EXACT ? INT_MAX
           : most > MIN_MAX_PAIRS                                                     ? most
                                                                                      : MIN_MAX_PAIRS;
}

wisp_status contact_find_near( const contact_work* work, bool missed_only, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    near_loop loop = { .work = work, .contact_mesh = s };
    loop.max_pairs = max_pairs_of( work );
    loop.active_count = contact_find_active_clusters( work, missed_only );
    bool enough = true, is_done = false;
    while ( enough && is_done == false )
    {
        for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
        {
            atomic_init( loop.total + kind, 0 );
            atomic_init( loop.stored + kind, 0 );
        }
        enough = make_lists( &loop );
        is_done = enough && is_too_long( &loop ) == false && select_all( &loop );
        if ( enough && is_too_long( &loop ) )
        {
            is_done = false;
            loop.max_pairs = INT_MAX;
            s->motion->reach = s->min_thickness;
            contact_shorten_ways( work );
            continue;
        }
        for ( int kind = 0; kind < CONTACT_KIND_COUNT && enough && is_done == false; ++kind )
        {
            const int count = s->primitives->near[kind].count;
            enough = enough && contact_reserve_near( work, (contact_kind)kind, count + count / 2 );
        }
    }
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d pairs of clusters", loop.active_count );
}
