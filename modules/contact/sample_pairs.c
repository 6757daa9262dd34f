// Pairs of boundary particles. In: particles and the predicted motion of clusters. Out: candidate pairs after a
// search; active pairs each substep. The broad phase has a box per particle; the test of a pair is cached as the
// deviation at which it may become active.
#include "sample_pairs.h"

#include "boundary_samples.h"
#include "clusters.h"
#include "predicted_motion.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    MAX_PER_SAMPLE = 512, // pairs per particle before margins are halved
};

// ---- broad phase ----

static float margin_of( const contact_contact_mesh* s, int sample )
{
    float margin = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        margin = contact_larger( margin,
                                 s->motion->predicted[s->clusters->of_point[s->samples->parents[sample][k]]].margin );
    }
    return margin;
}

static void box_samples( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_contact_mesh* s = work->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const contact_participant* participant = work->participants + (int)s->samples->rest[i][3];
        const float margin = s->samples->deviation[i] = margin_of( s, i ); // which tests of pairs read again
        const float wide = 0.5f * participant->settings.thickness + margin;
        float* at = s->samples->position[i];
        contact_place_sample( s, s->intersection_free, i, at );
        for ( int k = 0; k < 3; ++k )
        {
            s->samples->boxes[i].lower[k] = at[k] - wide;
            s->samples->boxes[i].upper[k] = at[k] + wide;
        }
    }
}

static int keep_pairs( const void* context, int query, int32_t* items, int count )
{
    const contact_work* work = context;
    const contact_contact_mesh* s = work->contact_mesh;
    const contact_participant* participant = work->participants + (int)s->samples->rest[query][3];
    const float margin = s->samples->deviation[query];
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        const float gap = contact_gap_between( participant, work->participants + (int)s->samples->rest[item][3] );
        const float within = 1.001f * gap + margin + s->samples->deviation[item];
        items[kept] = item;
        // most overlaps are neighbours in a surface that are too far apart, so that is tested first
        kept += !( contact_distance( s->samples->position[query], s->samples->position[item] ) > within ) &&
                        contact_sample_gap_of( work, query, item ) > 0.0f
                    ? 1
                    : 0;
    }
    return kept;
}

wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    wisp_parallel_for( work->parallel, s->samples->count, CONTACT_POINT_GRAIN, box_samples, (void*)(uintptr_t)work );
    const wisp_aabb_args args = {
        .boxes = s->samples->boxes,
        .box_count = s->samples->count,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = (size_t)s->samples->count * MAX_PER_SAMPLE,
        .filter = keep_pairs,
        .filter_context = work,
    };
    const wisp_status status = wisp_aabb_pairs_find( &s->samples->overlaps, work->parallel, &args, error );
    s->samples->candidate_count = 0;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( contact_reserve( work, &s->samples->candidate_buffer,
                          s->samples->overlaps.pair_count * sizeof( *s->samples->candidates ),
                          (void**)&s->samples->candidates ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %zu pairs", s->samples->overlaps.pair_count );
    }
    for ( int a = 0; a < s->samples->overlaps.query_count; ++a )
    {
        for ( int i = s->samples->overlaps.begin[a]; i < s->samples->overlaps.begin[a + 1]; ++i )
        {
            const int32_t b = s->samples->overlaps.item[i];
            s->samples->candidates[s->samples->candidate_count++] =
                ( contact_candidate ){ { a, b, contact_sample_gap_of( work, a, b ) }, -INFINITY };
        }
    }
    return WISP_OK;
}

// ---- narrow phase ----

typedef struct sample_loop
{
    const contact_work* work;
    bool missed_only;
    float* deviation; // [cluster] m, after this substep at most
    _Atomic int total;
} sample_loop;

// Compute how far the clusters of each particle may deviate.
static void find_deviations( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sample_loop* loop = context;
    contact_contact_mesh* s = loop->work->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* parents = s->samples->parents[i];
        const float first = loop->deviation[s->clusters->of_point[parents[0]]],
                    second = loop->deviation[s->clusters->of_point[parents[1]]],
                    third = loop->deviation[s->clusters->of_point[parents[2]]];
        s->samples->deviation[i] = contact_larger( first, contact_larger( second, third ) );
    }
}

// Return the least deviation of a particle's clusters so far.
static float min_spent( const contact_contact_mesh* s, int sample )
{
    float least = INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        least = contact_smaller(
            least, s->motion->predicted[s->clusters->of_point[s->samples->parents[sample][k]]].deviation );
    }
    return least;
}

static bool is_missed( const contact_contact_mesh* s, int sample )
{
    const int32_t* p = s->samples->parents[sample];
    return ( s->motion->is_missed[p[0]] | s->motion->is_missed[p[1]] | s->motion->is_missed[p[2]] ) != 0;
}

// Return the most that two particles may approach each other: no more than two of their points.
static float closing_of( const contact_contact_mesh* s, const contact_pair* pair )
{
    float most = 0.0f;
    for ( int i = 0; i < 3; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float* p = s->motion->ahead + (size_t)s->samples->parents[pair->a][i] * 4;
            const float* q = s->motion->ahead + (size_t)s->samples->parents[pair->b][k] * 4;
            const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            most = contact_larger( most, sqrtf( x * x + y * y + z * z ) + ( p[3] + q[3] ) );
        }
    }
    return most;
}

static void find_near( void* context, int begin, int end, int worker )
{
    (void)worker;
    sample_loop* loop = context;
    contact_contact_mesh* s = loop->work->contact_mesh;
    for ( int i = begin; i < end; ++i )
    {
        contact_candidate* c = s->samples->candidates + i;
        const int32_t a = c->pair.a, b = c->pair.b;
        const bool is_tested = loop->missed_only == false || is_missed( s, a ) || is_missed( s, b );
        if ( is_tested == false || s->samples->deviation[a] + s->samples->deviation[b] < c->active_at )
        {
            continue;
        }
        const float distance = contact_sample_distance( s, s->intersection_free, a, b );
        // the factor covers rounding of the sums
        c->active_at = min_spent( s, a ) + min_spent( s, b ) + ( distance - 1.001f * c->pair.gap );
        if ( distance > 0.0f && distance < c->pair.gap + closing_of( s, &c->pair ) )
        {
            s->primitives->near[CONTACT_POINTS].items[atomic_fetch_add( &loop->total, 1 )].pair = c->pair;
        }
    }
}

wisp_status contact_find_near_samples( const contact_work* work, bool missed_only, wisp_error* error )
{
    contact_contact_mesh* s = work->contact_mesh;
    sample_loop loop = { .work = work, .missed_only = missed_only };
    atomic_init( &loop.total, 0 );
    loop.deviation =
        wisp_parallel_scratch( work->parallel, work->worker, (size_t)s->clusters->count * sizeof( *loop.deviation ) );
    if ( loop.deviation == NULL ||
         contact_reserve_near( work, CONTACT_POINTS, s->samples->candidate_count ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory for %d contact pairs", s->samples->candidate_count );
    }
    for ( int p = 0; p < s->clusters->count; ++p )
    {
        loop.deviation[p] = s->motion->predicted[p].deviation + contact_length_of_way( s, s->motion->ways + p );
    }
    wisp_parallel_for( work->parallel, s->samples->count, CONTACT_POINT_GRAIN, find_deviations, &loop );
    wisp_parallel_for( work->parallel, s->samples->candidate_count, CONTACT_POINT_GRAIN, find_near, &loop );
    s->primitives->near[CONTACT_POINTS].count = atomic_load( &loop.total );
    s->primitives->near[CONTACT_EDGES].count = 0;
    return WISP_OK;
}
