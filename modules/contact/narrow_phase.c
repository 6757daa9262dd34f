// Narrow phase: which primitives of two clusters may reach their gap in this substep. In: active pairs of clusters.
// Out: active pairs of primitives, and a new bound and list for each active pair of clusters.
//
// - Two clusters that a plane separates widely enough need no more: a plane across the line between their boxes, or
//   across the normal of either.
// - Otherwise edges meet edges and points meet triangles, for some pairs of clusters per kernel call. Planes across
//   the line between the centres of two primitives, and across each, cull most pairs. The rest is measured exactly,
//   and listed with its distance where it is near. A list holds until its bound is used up (broad_phase.c).
// - In each substep the listed pairs that may reach their gap are measured again (below).
// - With too many pairs, displacements are cut to the smallest thickness and the pairs are found again: a cloth that
//   collapsed, with all of it within the displacements of a substep, would have every pair of primitives.
#include "narrow_phase.h"

#include "broad_phase.h"
#include "clusters.h"
#include "predicted_motion.h"
#include "untangling.h"

#include <limits.h>
#include <stdatomic.h>
#include <string.h>

// ---- pairs of primitives ----

// Active pairs: the last test before a pair of primitives becomes a constraint. In: listed pairs that may reach their
// gap in this substep. Out: those that may come to it wherever their points go within their tolerance.
//
// A pair is active if its distance at the intersection-free positions is less than its gap and the most that two of
// its points may approach each other. The test looks at the state alone, so results do not depend on what found the
// pair. Within a participant the gap is at most 0.9 of the distance at rest, so that nothing presses at rest. Pairs
// around an intersection are dropped, because no side of their plane is right.
//
// Each closest point has one pair. On an edge or a corner it belongs to the triangle that owns this (clusters.h); the
// pairs of its neighbours, and of edges that meet in an end, repeat it. Repeats that the substep may bring within half
// the gap stay, so that nothing passes between the planes of the owners. All of them stay where something intersects,
// since an owner there may be dropped as tangled, and on surfaces that another module solves for: with one pair each,
// piles of implicit cloth tremble twice as much.

// ---- a batch ----

static void swap_where( bool swapped, int32_t* a, int32_t* b )
{
    const int32_t was = *a, other = *b;
    *a = swapped ? other : was;
    *b = swapped ? was : other;
}

// Put the edge with the smaller index first.
static void put_less_first( contact_batch* batch )
{
    for ( int i = 0; i < batch->count; ++i )
    {
        const bool swapped = batch->second[i] < batch->first[i];
        swap_where( swapped, batch->first + i, batch->second + i );
        swap_where( swapped, batch->point_x4[0] + i, batch->point_x4[2] + i );
        swap_where( swapped, batch->point_x4[1] + i, batch->point_x4[3] + i );
    }
}

// Repeat the last pair up to a multiple of eight.
static int pad_to_eight( int32_t* const point_x4[4], int count )
{
    for ( ; count % WISP_SLICE != 0; ++count )
    {
        for ( int k = 0; k < 4; ++k )
        {
            point_x4[k][count] = point_x4[k][count - 1];
        }
    }
    return count;
}

// Find the closest points of pairs of one kind, eight per kernel call (engine/kernels/closest.c).
static void find_closest( const contact_work* work, int32_t* const point_x4[4], int count, bool are_edges,
                          wisp_closest_args args )
{
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    const int groups = pad_to_eight( point_x4, count ) / WISP_SLICE;
    for ( int k = 0; k < 4; ++k )
    {
        args.point_x4[k] = point_x4[k];
    }
    ( are_edges ? kernels->closest_segments : kernels->closest_triangle )( &args, 0, groups );
}

static void measure_batch( const contact_work* work, contact_kind kind, contact_batch* batch )
{
    int32_t* const points[4] = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] };
    if ( kind == CONTACT_EDGES )
    {
        put_less_first( batch );
    }
    find_closest(
        work, points, batch->count, kind == CONTACT_EDGES,
        ( wisp_closest_args ){ .xyzw = work->contact_mesh->intersection_free, .distance = batch->distance } );
}

// Move the pairs in `selected` to the front.
static void compact( contact_batch* batch, int count )
{
    int same = 0;
    for ( ; same < count && batch->selected[same] == same; ++same )
    {
    }
    for ( int i = same; i < count; ++i )
    {
        const int from = batch->selected[i];
        batch->first[i] = batch->first[from];
        batch->second[i] = batch->second[from];
        batch->of[i] = batch->of[from];
        batch->gap[i] = batch->gap[from];
        batch->distance[i] = batch->distance[from];
        batch->closing[i] = batch->closing[from];
        for ( int k = 0; k < 4; ++k )
        {
            batch->point_x4[k][i] = batch->point_x4[k][from];
        }
    }
    batch->count = count;
}

// ---- the test ----

// Return whether both sides of a pair of one kind have a point of an intersection.
static bool is_tangled( const contact_work* work, contact_kind kind, const int32_t* const point_x4[4], int i )
{
    const int split = kind == CONTACT_EDGES ? 2 : 1;
    bool sides[2] = { false, false };
    for ( int k = 0; k < 4; ++k )
    {
        sides[k >= split] =
            sides[k >= split] || work->contact_mesh->intersections->is_tangled[point_x4[k][i] / 4] != 0;
    }
    return sides[0] && sides[1];
}

// Compute the most that the sides of each pair may approach each other in this substep.
static void find_closings( const contact_work* work, contact_kind kind, int32_t* const point_x4[4], int count,
                           float* closing )
{
    const wisp_approach_args args = {
        .predicted = work->contact_mesh->motion->ahead,
        .point_x4 = { point_x4[0], point_x4[1], point_x4[2], point_x4[3] },
        .are_edges = kind == CONTACT_EDGES,
        .max_approach = closing,
    };
    wisp_frame_kernels( work->frame )->max_approach( &args, 0, pad_to_eight( point_x4, count ) );
}

// Pairs at no distance have no plane between them; only contact_part_coincident() can use them.
static bool may_meet( const contact_contact_mesh* s, float distance, float gap, float closing )
{
    return gap > 0.0f && ( distance > 0.0f || s->is_parting ) && distance < gap + closing;
}

// ---- rest distances ----

// Return whether the boxes around the two sides of a pair are nearer than a distance.
static bool boxes_are_within( const float* xyzw, const contact_batch* batch, int i, int split, float distance )
{
    bool within = true;
    for ( int k = 0; k < 3 && within; ++k )
    {
        float lower[2] = { INFINITY, INFINITY }, upper[2] = { -INFINITY, -INFINITY };
        for ( int p = 0; p < 4; ++p )
        {
            const float x = xyzw[batch->point_x4[p][i] + k];
            lower[p >= split] = contact_smaller( lower[p >= split], x );
            upper[p >= split] = contact_larger( upper[p >= split], x );
        }
        within = lower[0] - upper[1] < distance && lower[1] - upper[0] < distance;
    }
    return within;
}

// Lower the gap of pairs within a participant that are closer at rest.
static void thin_gaps( const contact_work* work, contact_kind kind, contact_batch* batch )
{
    static const float REST_FRACTION = 0.9f; // of the rest distance
    const contact_contact_mesh* s = work->contact_mesh;
    contact_primitives primitives;
    primitives.are_edges = kind == CONTACT_EDGES;
    for ( int next = 0; next < batch->count; )
    {
        int thin[CONTACT_BATCH], thin_count = 0;
        for ( ; next < batch->count && thin_count < CONTACT_BATCH; ++next )
        {
            const bool is_own = s->rest[batch->point_x4[0][next] + 3] == s->rest[batch->point_x4[3][next] + 3];
            if ( is_own &&
                 boxes_are_within( s->rest, batch, next, kind == CONTACT_EDGES ? 2 : 1, 2.0f * batch->gap[next] ) )
            {
                for ( int k = 0; k < 4; ++k )
                {
                    primitives.point_x4[k][thin_count] = batch->point_x4[k][next];
                }
                thin[thin_count++] = next;
            }
        }
        const float* distance = contact_measure_primitives( work, s->rest, &primitives, thin_count, NULL, NULL );
        for ( int i = 0; i < thin_count; ++i )
        {
            batch->gap[thin[i]] = contact_smaller( batch->gap[thin[i]], REST_FRACTION * distance[i] );
        }
    }
}

// Keep the pairs in `selected`, with gaps lowered where they are nearer at rest: of brief lists those that are active now.
static void keep_near( const contact_work* work, contact_kind kind, contact_batch* batch, int selected,
                       const bool* is_brief )
{
    compact( batch, selected );
    int32_t* const points[4] = { batch->point_x4[0], batch->point_x4[1], batch->point_x4[2], batch->point_x4[3] };
    find_closings( work, kind, points, selected, batch->closing );
    for ( int pass = 0; pass < 2; ++pass )
    {
        const bool may_tangle = pass == 0 && work->memory->tangled != 0;
        int kept = 0;
        for ( int i = 0; i < batch->count; ++i )
        {
            const bool is_active =
                may_meet( work->contact_mesh, batch->distance[i], batch->gap[i], batch->closing[i] ) &&
                ( may_tangle && is_tangled( work, kind, (const int32_t* const*)points, i ) ) == false;
            batch->selected[kept] = i;
            kept += is_active || ( is_brief[batch->of[i]] == false && batch->gap[i] > 0.0f ) ? 1 : 0;
        }
        compact( batch, kept );
        if ( pass == 0 )
        {
            thin_gaps( work, kind, batch );
        }
    }
}

// ---- candidates ----

// What listed pairs of two clusters share.
typedef struct listed_source
{
    float slack, closing, gap; // m: bound of pairs that are not listed, of the clusters, of their participants
    float beyond;              // m, by how much listed pairs are below that bound
    bool has_owners;           // repeats are left out
} listed_source;

// Listed pairs of one kind that may reach their gap in this substep.
typedef struct candidates
{
    int count;
    contact_listed* listed[CONTACT_BATCH];
    listed_source* source[CONTACT_BATCH];
    contact_primitives primitives;
    float closing[CONTACT_BATCH]; // m
} candidates;

// Add a listed pair of primitives. @return whether there is room for more
static bool add_candidate( const contact_contact_mesh* s, candidates* c, contact_listed* listed,
                           listed_source* source )
{
    const bool is_edge = c->primitives.are_edges;
    const int32_t* a = is_edge ? s->edges + 2 * (size_t)listed->a : &listed->a;
    const int32_t* b = is_edge ? s->edges + 2 * (size_t)listed->b : s->triangles + 3 * (size_t)listed->b;
    const int32_t points[4] = { a[0], is_edge ? a[1] : b[0], is_edge ? b[0] : b[1], is_edge ? b[1] : b[2] };
    contact_put_primitives( &c->primitives, c->count, points );
    c->listed[c->count] = listed;
    c->source[c->count] = source;
    return ++c->count < CONTACT_BATCH;
}

// ---- owners ----

// Note which corners have no part in the closest points of each pair, within rounding. @param zeros [pair] out, bit k: corner k
static void note_zeros( float ( *weight )[4][WISP_SLICE], int groups, int32_t* zeros )
{
    for ( int g = 0; g < groups; ++g )
    {
        for ( int lane = 0; lane < WISP_SLICE; ++lane )
        {
            int32_t bits = 0;
            for ( int k = 0; k < 4; ++k )
            {
                bits |= fabsf( weight[g][k][lane] ) < 1e-6f ? 1 << k : 0;
            }
            zeros[g * WISP_SLICE + lane] = bits;
        }
    }
}

// Return whether a pair of edges repeats one of a point and a triangle, or another pair of edges.
static bool repeats_edges( const uint8_t* edge_owns, const contact_listed* listed, int32_t zeros )
{
    const uint8_t owns[2] = { edge_owns[listed->a], edge_owns[listed->b] };
    bool repeats = false;
    for ( int side = 0; side < 2; ++side )
    {
        const int32_t ends = zeros >> 2 * side & 3,
                      end = ends & 1; // the first has no part: the second is the closest
        repeats = repeats || ( ends != 0 &&
                               ( ( owns[1 - side] & CONTACT_HAS_TRIANGLE ) != 0 || ( owns[side] >> end & 1 ) == 0 ) );
    }
    return repeats;
}

// Return whether a triangle does not own the edge or corner that is nearest to a point.
static bool repeats_point( int owned, int32_t zeros )
{
    const int off = zeros >> 1, needed = ( off & ( off - 1 ) ) == 0 ? off : ( off ^ 7 ) << 3;
    return off != 0 && off != 7 && ( owned & needed ) == 0;
}

// Measure the candidates, and append the active ones to `near`, as far as it has room. Lists keep their distances.
// @param total counts all of them
static void select_active( const contact_work* work, candidates* c, _Atomic int* total, _Atomic int* stored )
{
    static const float REPEAT_FRACTION = 0.5f; // of the gap
    _Alignas( 64 ) float weight[CONTACT_BATCH / WISP_SLICE][4][WISP_SLICE];
    _Alignas( 64 ) float normal[CONTACT_BATCH / WISP_SLICE][3][WISP_SLICE];
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_kind kind = c->primitives.are_edges ? CONTACT_EDGES : CONTACT_POINTS;
    contact_near* near = s->primitives->near + kind;
    contact_active found[CONTACT_BATCH];
    int32_t zeros[CONTACT_BATCH];
    int count = 0, all = 0;
    if ( c->count == 0 )
    {
        return;
    }
    int32_t* const points[4] = { c->primitives.point_x4[0], c->primitives.point_x4[1], c->primitives.point_x4[2],
                                 c->primitives.point_x4[3] };
    const float* distance =
        contact_measure_primitives( work, s->intersection_free, &c->primitives, c->count, weight, normal );
    find_closings( work, kind, points, c->count, c->closing );
    note_zeros( weight, ( c->count + WISP_SLICE - 1 ) / WISP_SLICE, zeros );
    for ( int i = 0; i < c->count; ++i )
    {
        contact_listed* listed = c->listed[i];
        listed_source* source = c->source[i];
        const float d = distance[i], gap = listed->gap;
        listed->key = contact_key_of( d, gap, source->slack );
        source->beyond = contact_larger( -listed->key, source->beyond );
        if ( may_meet( s, d, gap, c->closing[i] ) == false ||
             ( work->memory->tangled != 0 && is_tangled( work, kind, (const int32_t* const*)points, i ) ) )
        {
            continue;
        }
        all += 1;
        // what is nearer at rest shares a corner with its owner, which may be no pair
        const bool is_far = source->has_owners && gap == source->gap && d >= REPEAT_FRACTION * gap + c->closing[i];
        if ( is_far && zeros[i] != 0 &&
             ( kind == CONTACT_EDGES ? repeats_edges( s->clusters->edge_owns, listed, zeros[i] )
                                     : repeats_point( s->clusters->triangle_owns[listed->b], zeros[i] ) ) )
        {
            continue;
        }
        contact_active* active = found + count++;
        *active = ( contact_active ){ { listed->a, listed->b, gap }, d, c->closing[i], { 0.0f }, { 0.0f } };
        for ( int k = 0; k < 4; ++k )
        {
            active->weight[k] = weight[i / WISP_SLICE][k][i % WISP_SLICE];
            active->normal[k % 3] = normal[i / WISP_SLICE][k % 3][i % WISP_SLICE];
        }
    }
    atomic_fetch_add( total, all );
    const int first = count > 0 ? atomic_fetch_add( stored, count ) : 0;
    if ( count > 0 && first + count <= near->most )
    {
        memcpy( near->items + first, found, (size_t)count * sizeof( *found ) );
    }
    c->count = 0;
}

// ---- output ----

static bool reserve_near( const contact_work* work, contact_kind kind, int count )
{
    contact_near* near = work->contact_mesh->primitives->near + kind;
    const bool enough =
        contact_reserve( work, &near->buffer, (size_t)count * sizeof( *near->items ), (void**)&near->items );
    near->most = enough ? count : 0;
    return enough;
}

const float* contact_measure_primitives( const contact_work* work, const float* xyzw, contact_primitives* primitives,
                                         int count, float ( *weight )[4][WISP_SLICE],
                                         float ( *normal )[3][WISP_SLICE] )
{
    int32_t( *p )[CONTACT_BATCH] = primitives->point_x4;
    find_closest(
        work, ( int32_t* const[4] ){ p[0], p[1], p[2], p[3] }, count, primitives->are_edges,
        ( wisp_closest_args ){ .xyzw = xyzw, .distance = primitives->distance, .weight = weight, .normal = normal } );
    return primitives->distance;
}

// ---- the search ----

enum
{
    SEARCH_GRAIN = 16,  // pairs of clusters
    PLACED_PACKS = 160, // of the clusters of a task, of which a usual one has four
    SELECT_GRAIN = 32,
    MAX_PER_POINT = 64, // pairs of primitives before displacements are shortened; a stack of cloth has 10
    MIN_MAX_PAIRS = 1024,
};

// All in gaps beyond the gap itself. Clusters that a plane separates by APART are not split into primitives.
// Primitives within MEASURED are measured, and listed where their clusters approach by less than SLOW in a substep, so
// that the list holds for some. Otherwise the list is brief: only what is active in this substep. Farther ones have a
// separating plane for a bound; beyond SEEN from the other cluster's box they are skipped. Clusters of two participants
// slide along each other: their lists hold at higher speeds, and of brief ones less is measured.
static const float APART_GAPS = 0.5f, MEASURED_GAPS = 0.6f, SLOW_GAPS = 0.3f, SEEN_GAPS = 1.5f;
static const float OTHERS_SLOW_GAPS = 0.5f, OTHERS_BRIEF_GAPS = 0.3f;

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
    int pack_count;
    _Alignas( 64 ) wisp_primitive_pack packs[PLACED_PACKS]; // of the placed ones
    cluster_test tests[CONTACT_TESTS];
    float measured[CONTACT_TESTS], listed[CONTACT_TESTS]; // m, distances up to which pairs are
    bool is_brief[CONTACT_TESTS];
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
        task->placed[i].packs = task->packs + task->pack_count;
        const int32_t* packs = task->loop->contact_mesh->clusters->items[cluster].rows;
        task->pack_count += packs[0] + packs[1] + packs[2];
        contact_place_cluster( task->loop->work, cluster, task->placed + i );
    }
    return task->placed + i;
}

// Measure the pairs of a batch, keep those to be listed, and lower the bounds of their clusters by the others.
static void measure( narrow_task* task, contact_kind kind )
{
    contact_batch* batch = task->batches + kind;
    int selected = 0;
    measure_batch( task->loop->work, kind, batch );
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
    keep_near( task->loop->work, kind, batch, selected, task->is_brief );
    for ( int i = 0; i < batch->count; ++i )
    {
        contact_list* list = &task->tests[batch->of[i]].list;
        ++*( kind == CONTACT_POINTS ? &list->points : &list->edges );
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
    wisp_primitive_near_args arg_list[CONTACT_TESTS];
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
    int numbers[CONTACT_TESTS] = { 0 }, near_count = 0;
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
    const int a = s->bounds->pairs.cluster[pair], b = s->bounds->pairs.other[pair];
    const contact_participant *of_a = task->loop->work->participants + s->clusters->items[a].participant,
                              *of_b = task->loop->work->participants + s->clusters->items[b].participant;
    cluster_test* test = task->tests + number;
    *test = ( cluster_test ){ .pair = pair, .cluster = { a, b }, .placed = { place( task, a ), place( task, b ) } };
    test->gap = contact_gap_between( of_a, of_b );
    test->closing = contact_closing_of( s->motion->ways + a, s->motion->ways + b );
    const float needed = 1.001f * test->gap + test->closing;
    const bool is_brief = test->closing >= ( of_a == of_b ? SLOW_GAPS : OTHERS_SLOW_GAPS ) * test->gap;
    const float measured = is_brief && of_a != of_b ? OTHERS_BRIEF_GAPS : MEASURED_GAPS;
    task->is_brief[number] = is_brief;
    task->measured[number] = needed + measured * test->gap;
    task->listed[number] = is_brief ? needed : task->measured[number];
    test->bound = test->closing + ( measured + SEEN_GAPS ) * test->gap;
    for ( int i = 0; i < WISP_SLICE; ++i )
    {
        test->least[i] = INFINITY;
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
    int length = 0, brief = 0, at[CONTACT_TESTS];
    for ( int i = 0; i < count; ++i )
    {
        cluster_test* test = task->tests + i;
        const int listed = test->list.points + test->list.edges;
        for ( int k = 0; k < WISP_SLICE; ++k ) // what planes culled
        {
            test->bound = contact_smaller( test->least[k] - 1.001f * test->gap, test->bound );
        }
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
        bounds->pairs.slack[test->pair] = test->bound;
        bounds->pairs.list[test->pair] = test->list;
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
    task->placed_count = task->pack_count = 0;
    for ( int first = begin; first < end && is_too_long( loop ) == false; first += CONTACT_TESTS )
    {
        const int left = end - first;
        if ( task->pack_count > PLACED_PACKS - 2 * CONTACT_TESTS * CONTACT_CLUSTER_MOST )
        {
            task->placed_count = task->pack_count = 0; // hardly ever: they are placed again
        }
        search_batch( task, loop->contact_mesh->bounds->searched + first,
                      left < CONTACT_TESTS ? left : CONTACT_TESTS );
    }
}

// ---- listed pairs ----

// Describe the listed pairs of two clusters.
static listed_source source_of( const contact_work* work, int pair )
{
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_cluster_pairs* pairs = &s->bounds->pairs;
    const int a = pairs->cluster[pair], b = pairs->other[pair];
    const contact_participant *of_a = work->participants + s->clusters->items[a].participant,
                              *of_b = work->participants + s->clusters->items[b].participant;
    return ( listed_source ){
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
    const contact_contact_mesh* s = loop->contact_mesh;
    const contact_cluster_pairs* pairs = &s->bounds->pairs;
    listed_source sources[SELECT_GRAIN];
    candidates of_kind[CONTACT_KIND_COUNT];
    int seen = 0;
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        of_kind[kind].primitives.are_edges = kind == CONTACT_EDGES;
        of_kind[kind].count = 0;
    }
    for ( ; seen < end - begin && is_too_long( loop ) == false; ++seen )
    {
        const int pair = s->bounds->active[begin + seen];
        const contact_list list = pairs->list[pair];
        listed_source* source = sources + seen;
        *source = source_of( loop->work, pair );
        float beyond = 0.0f;
        for ( int k = 0; k < list.points + list.edges; ++k )
        {
            contact_listed* listed = s->bounds->listed + list.first + k;
            const int kind = k < list.points ? CONTACT_POINTS : CONTACT_EDGES;
            if ( listed->key + source->slack >= source->closing )
            {
                beyond = contact_larger( -listed->key, beyond );
            }
            else if ( add_candidate( s, of_kind + kind, listed, source ) == false )
            {
                select_active( loop->work, of_kind + kind, loop->total + kind, loop->stored + kind );
            }
        }
        source->beyond = contact_larger( beyond, source->beyond );
    }
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        select_active( loop->work, of_kind + kind, loop->total + kind, loop->stored + kind );
    }
    for ( int i = 0; i < seen; ++i )
    {
        const int pair = s->bounds->active[begin + i];
        pairs->list[pair].beyond = sources[i].beyond;
        pairs->slack[pair] = sources[i].slack - sources[i].beyond;
    }
}

// Make the lists that do not hold, unless there are too many pairs. @return false without memory
static bool make_lists( near_loop* loop )
{
    contact_cached_bounds* bounds = loop->contact_mesh->bounds;
    if ( bounds->searched_count == 0 )
    {
        return true;
    }
    const bool is_first = bounds->listed_most == 0;
    const int likely = is_first ? bounds->searched_count : bounds->last_length;
    const bool is_full = likely > bounds->listed_most - bounds->listed_count;
    bool enough = is_full == false || contact_make_room_for_listed( loop->work, is_first ? likely : 0 ), fits = false;
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
    if ( enough && is_too_long( loop ) == false )
    {
        bounds->listed_count += bounds->last_length;
        bounds->searched_count = 0;
    }
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
            enough = enough && reserve_near( work, (contact_kind)kind, count + count / 2 );
        }
    }
    return enough ? WISP_OK
                  : wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d pairs of clusters", loop.active_count );
}
