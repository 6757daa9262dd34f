// Narrow phase: which primitives of two clusters may reach their gap in this substep. In: active pairs of clusters.
// Out: active pairs of primitives, and a new bound for each pair of clusters.
//
// - Two clusters that a plane separates widely enough need no more: a plane across the line between their boxes, or
//   across the normal of either.
// - Otherwise edges meet edges and points meet triangles, for eight pairs of clusters per kernel call. Planes across
//   the line between the centres of two primitives, and across each, cull most pairs. The rest is measured exactly.
// - With too many pairs, displacements are cut to the smallest thickness and the pairs are found again: a cloth that
//   collapsed, with all of it within the displacements of a substep, would have every pair of primitives.
// - The smallest distance or separation seen, less the gap, is the new bound (cached_bounds.c).
#include "narrow_phase.h"

#include "cached_bounds.h"
#include "clusters.h"
#include "predicted_motion.h"
#include "primitive_pairs.h"

#include <limits.h>
#include <stdatomic.h>
#include <string.h>

enum
{
    PAIRS_PER_TASK = 16, // pairs of clusters
    MAX_PER_POINT = 64,  // pairs of primitives before displacements are shortened; a stack of cloth has 10
    MIN_MAX_PAIRS = 1024,
};

// All in gaps beyond the gap itself. Clusters that a plane separates by APART are not split into primitives.
// Primitives nearer than MEASURED are measured: the wider, the longer a bound holds. Farther ones have a separating
// plane for a bound; beyond SEEN from the other cluster's box they are skipped.
static const float APART_GAPS = 0.5f, MEASURED_GAPS = 0.6f, SEEN_GAPS = 1.5f;

typedef struct near_loop
{
    const contact_work* work;
    contact_contact_mesh* contact_mesh;
    bool missed_only;
    int active_count, max_pairs;
    _Atomic int total[CONTACT_KIND_COUNT];
    _Atomic bool is_out_of_memory;
} near_loop;

// Place the clusters of active pairs, each once per substep.
static void place_active( near_loop* loop )
{
    contact_contact_mesh* s = loop->contact_mesh;
    if ( loop->missed_only == false )
    {
        memset( s->clusters->is_placed, 0, (size_t)s->clusters->count );
    }
    int count = 0;
    for ( int i = 0; i < loop->active_count; ++i )
    {
        const int32_t both[2] = { s->bounds->pairs[0].cluster[s->bounds->active[i]],
                                  s->bounds->pairs[0].other[s->bounds->active[i]] };
        for ( int k = 0; k < 2; ++k )
        {
            s->clusters->to_place[count] = both[k];
            count += s->clusters->is_placed[both[k]] == 0 ? 1 : 0;
            s->clusters->is_placed[both[k]] = 1;
        }
    }
    contact_place_clusters( loop->work, count );
}

// ---- primitives of two clusters ----

// A pair of clusters under test.
typedef struct cluster_test
{
    int cluster[2];
    float gap, closing, within;             // m
    float bound;                            // m, of measured pairs
    _Alignas( 32 ) float least[WISP_SLICE]; // m, separation of pairs that a plane culled
} cluster_test;

// Scratch memory of a task: its pairs of clusters, and the pairs of primitives to measure.
typedef struct narrow_task
{
    near_loop* loop;
    cluster_test tests[PAIRS_PER_TASK];
    contact_batch batches[CONTACT_KIND_COUNT];
} narrow_task;

// Measure the pairs of a batch, lower the bounds of their clusters and pass those within reach on.
static void measure( narrow_task* task, contact_kind kind )
{
    contact_batch* batch = task->batches + kind;
    contact_measure_batch( task->loop->work, kind, batch );
    int selected = 0;
    for ( int i = 0; i < batch->count; )
    {
        const int number = batch->of[i];
        cluster_test* test = task->tests + number;
        const float gap = test->gap, limit = gap + test->closing;
        float nearest = INFINITY;
        for ( ; i < batch->count && batch->of[i] == number; ++i )
        {
            const float distance = batch->distance[i];
            nearest = contact_smaller( distance, nearest );
            batch->gap[i] = gap;
            batch->selected[selected] = i;
            selected += distance < limit ? 1 : 0;
        }
        test->bound = contact_smaller( nearest - 1.001f * gap, test->bound );
    }
    contact_select_active( task->loop->work, kind, batch, selected, task->loop->total + kind );
    batch->count = 0;
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
        const int one = test->cluster[query], other = test->cluster[1 - query];
        const contact_cluster *a = s->clusters->items + one, *b = s->clusters->items + other;
        arg_list[job_count] = ( wisp_primitive_near_args ){
            .queries = s->clusters->primitives + a->kind_row[kinds[0]],
            .packs = s->clusters->primitives + b->kind_row[kinds[1]],
            .query_pack_count = a->rows[kinds[0]],
            .pack_count = b->rows[kinds[1]],
            .query_aabb = s->clusters->boxes + one,
            .box = s->clusters->boxes + other,
            .max_distance = test->within,
            .cull_distance = test->within + SEEN_GAPS * test->gap,
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
static float separation_of( const wisp_kernels* kernels, const contact_contact_mesh* s, int a, int b )
{
    const contact_cluster *pa = s->clusters->items + a, *pb = s->clusters->items + b;
    wisp_separating_axis_args args = {
        .xyzw = s->intersection_free,
        .point_x4 = { s->clusters->points + pa->first_point, s->clusters->points + pb->first_point },
        .count = { pa->point_count, pb->point_count },
    };
    memcpy( args.axis[0], s->clusters->normals + 3 * (size_t)a, sizeof( args.axis[0] ) );
    memcpy( args.axis[1], s->clusters->normals + 3 * (size_t)b, sizeof( args.axis[1] ) );
    const wisp_aabb *box = s->clusters->boxes + a, *other = s->clusters->boxes + b;
    for ( int k = 0; k < 3; ++k )
    {
        args.axis[2][k] = ( box->lower[k] + box->upper[k] ) - ( other->lower[k] + other->upper[k] );
    }
    return kernels->separation( &args );
}

// Test the pairs of clusters [first, first + count) of a task.
static void test_clusters( narrow_task* task, int first, int count )
{
    static const int EDGES[2] = { 1, 1 }, POINTS[2] = { 0, 2 };
    const contact_contact_mesh* s = task->loop->contact_mesh;
    const wisp_kernels* kernels = wisp_frame_kernels( task->loop->work->frame );
    int numbers[WISP_PRIMITIVE_BATCH], near_count = 0;
    for ( int i = first; i < first + count; ++i )
    {
        cluster_test* test = task->tests + i;
        const int a = test->cluster[0], b = test->cluster[1];
        const float apart = a == b ? 0.0f : separation_of( kernels, s, a, b );
        const bool is_apart = apart > 1.001f * test->gap + test->closing + APART_GAPS * test->gap;
        test->bound = is_apart ? apart - 1.001f * test->gap : test->bound;
        numbers[near_count] = i;
        near_count += is_apart ? 0 : 1;
    }
    find_pairs( task, numbers, near_count, 0, EDGES, CONTACT_EDGES );
    find_pairs( task, numbers, near_count, 0, POINTS, CONTACT_POINTS );
    find_pairs( task, numbers, near_count, 1, POINTS, CONTACT_POINTS );
}

static void begin_test( const near_loop* loop, int pair, cluster_test* test )
{
    const contact_contact_mesh* s = loop->contact_mesh;
    const contact_participant* participants = loop->work->participants;
    const int a = s->bounds->pairs[0].cluster[pair], b = s->bounds->pairs[0].other[pair];
    test->cluster[0] = a;
    test->cluster[1] = b;
    test->gap = contact_gap_between( participants + s->clusters->items[a].participant,
                                     participants + s->clusters->items[b].participant );
    test->closing = contact_closing_of( s->motion->ways + a, s->motion->ways + b );
    test->within = 1.001f * test->gap + test->closing + MEASURED_GAPS * test->gap;
    test->bound = test->within + SEEN_GAPS * test->gap - 1.001f * test->gap;
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        test->least[i] = INFINITY;
    }
}

static float bound_of_pair( const cluster_test* test )
{
    float least = test->least[0];
    for ( int i = 1; i < WISP_SLICE; ++i )
    {
        least = contact_smaller( least, test->least[i] );
    }
    return contact_smaller( test->bound, least - 1.001f * test->gap );
}

static bool is_too_long( near_loop* loop )
{
    return atomic_load( loop->total + CONTACT_POINTS ) > loop->max_pairs - atomic_load( loop->total + CONTACT_EDGES );
}

static void run_task( void* context, int begin, int end, int worker )
{
    near_loop* loop = context;
    contact_contact_mesh* s = loop->contact_mesh;
    if ( is_too_long( loop ) )
    {
        return;
    }
    narrow_task* task = wisp_parallel_scratch( loop->work->parallel, worker, sizeof( *task ) );
    if ( task == NULL )
    {
        atomic_store( &loop->is_out_of_memory, true );
        return;
    }
    task->loop = loop;
    task->batches[CONTACT_POINTS].count = task->batches[CONTACT_EDGES].count = 0;
    for ( int i = begin; i < end; ++i )
    {
        begin_test( loop, s->bounds->active[i], task->tests + ( i - begin ) );
    }
    for ( int first = 0; first < end - begin; first += WISP_PRIMITIVE_BATCH )
    {
        if ( contact_has_room( task->batches + CONTACT_POINTS ) == false ||
             contact_has_room( task->batches + CONTACT_EDGES ) == false )
        {
            measure( task, CONTACT_POINTS );
            measure( task, CONTACT_EDGES );
        }
        const int left = end - begin - first;
        test_clusters( task, first, left < WISP_PRIMITIVE_BATCH ? left : WISP_PRIMITIVE_BATCH );
    }
    measure( task, CONTACT_POINTS );
    measure( task, CONTACT_EDGES );
    for ( int i = begin; i < end && loop->missed_only == false; ++i )
    {
        s->bounds->pairs[0].slack[s->bounds->active[i]] = bound_of_pair( task->tests + ( i - begin ) );
    }
}

// @return whether `near` had room for all pairs
static bool run_tests( near_loop* loop )
{
    contact_near* near = loop->contact_mesh->primitives->near;
    bool fits = true;
    atomic_init( &loop->is_out_of_memory, false );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        atomic_init( loop->total + kind, 0 );
    }
    wisp_parallel_for( loop->work->parallel, loop->active_count, PAIRS_PER_TASK, run_task, loop );
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        near[kind].count = atomic_load( loop->total + kind );
        fits = fits && near[kind].count <= near[kind].most;
    }
    return fits && is_too_long( loop ) == false;
}

// Pairs that may be found before displacements are shortened. They are not where nothing limits them.
static int max_pairs_of( const contact_work* work )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const int most = s->point_count < INT_MAX / MAX_PER_POINT ? s->point_count * MAX_PER_POINT : INT_MAX;
    return s->motion->reach < INFINITY || work->settings->displacement_limit == false ? INT_MAX
           : most > MIN_MAX_PAIRS                                                     ? most
                                                                                      : MIN_MAX_PAIRS;
}

wisp_status contact_find_near( const contact_work* work, bool missed_only, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    near_loop loop = { .work = work, .contact_mesh = s, .missed_only = missed_only };
    loop.max_pairs = max_pairs_of( work );
    loop.active_count = contact_find_active_clusters( work, missed_only );
    place_active( &loop );
    bool enough = true;
    while ( enough && run_tests( &loop ) == false )
    {
        if ( is_too_long( &loop ) )
        {
            loop.max_pairs = INT_MAX;
            s->motion->reach = s->min_thickness;
            contact_shorten_ways( work );
            continue;
        }
        for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
        {
            const int count = s->primitives->near[kind].count;
            enough = enough && contact_reserve_near( work, (contact_kind)kind, count + count / 2 );
        }
    }
    return enough && atomic_load( &loop.is_out_of_memory ) == false
               ? WISP_OK
               : wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d pairs of clusters", loop.active_count );
}
