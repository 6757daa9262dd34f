// Boundary particles within reach of each other, and which of them may meet in a substep: it is looked at those whose sides strayed
// enough for it.
#include "contact_internal.h"

#include <stdatomic.h>
#include <string.h>

enum
{
    GRAIN = 1024,
    MOST_PER_SAMPLE = 512, // pairs a particle, before reach is cut
};

// ---- which are listed ----

static float reach_of( const contact_soup* s, int sample )
{
    float reach = 0.0f;
    for ( int k = 0; k < 3; ++k )
    {
        reach = contact_larger( reach, s->courses[s->patch_of[s->sample_parents[sample][k]]].reach );
    }
    return reach;
}

static void box_samples( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int i = begin; i < end; ++i )
    {
        const contact_guest* guest = work->state->guests + (int)s->sample_rests[i][3];
        const float wide = 0.5f * guest->settings.thickness + reach_of( s, i );
        float* at = s->sample_places[i];
        contact_place_sample( s, s->safe, i, at );
        for ( int k = 0; k < 3; ++k )
        {
            s->sample_boxes[i].low[k] = at[k] - wide;
            s->sample_boxes[i].high[k] = at[k] + wide;
        }
    }
}

static int keep_pairs( const void* context, int asker, int32_t* items, int count )
{
    const contact_work* work = context;
    const contact_soup* s = work->soup;
    const float reach = reach_of( s, asker );
    int kept = 0;
    for ( int i = 0; i < count; ++i )
    {
        const int32_t item = items[i];
        const float gap = contact_sample_gap_of( work, asker, item );
        const float within = 1.001f * gap + reach + reach_of( s, item );
        items[kept] = item;
        kept +=
            gap > 0.0f && !( contact_distance( s->sample_places[asker], s->sample_places[item] ) > within ) ? 1 : 0;
    }
    return kept;
}

wisp_status contact_find_sample_pairs( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    wisp_parallel_for( work->parallel, s->sample_count, GRAIN, box_samples, (void*)(uintptr_t)work );
    const wisp_box_job job = {
        .boxes = s->sample_boxes,
        .box_count = s->sample_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = (size_t)s->sample_count * MOST_PER_SAMPLE,
        .filter = keep_pairs,
        .filter_context = work,
    };
    const wisp_status status = wisp_box_pairs_find( &s->overlaps, work->parallel, &job, error );
    s->candidate_count = 0;
    if ( status != WISP_OK )
    {
        return status;
    }
    if ( contact_reserve( work, CONTACT_CANDIDATES, s->overlaps.pair_count * sizeof( *s->candidates ),
                          (void**)&s->candidates ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %zu pairs", s->overlaps.pair_count );
    }
    for ( int a = 0; a < s->overlaps.asker_count; ++a )
    {
        for ( int i = s->overlaps.begin[a]; i < s->overlaps.begin[a + 1]; ++i )
        {
            const int32_t b = s->overlaps.item[i];
            s->candidates[s->candidate_count++] =
                ( contact_candidate ){ { a, b, contact_sample_gap_of( work, a, b ) }, -INFINITY };
        }
    }
    return WISP_OK;
}

// ---- which may meet ----

typedef struct sample_loop
{
    const contact_work* work;
    bool late_only;
    float* strays; // [patch] m, how far astray each may be
    _Atomic int total;
} sample_loop;

static void find_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const sample_loop* loop = context;
    contact_soup* s = loop->work->soup;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* parents = s->sample_parents[i];
        const float first = loop->strays[s->patch_of[parents[0]]], second = loop->strays[s->patch_of[parents[1]]],
                    third = loop->strays[s->patch_of[parents[2]]];
        s->sample_ways[i] = contact_larger( first, contact_larger( second, third ) );
    }
}

// What a side went astray already, at least: whoever of it went less may go so much more.
static float least_spent( const contact_soup* s, int sample )
{
    float least = INFINITY;
    for ( int k = 0; k < 3; ++k )
    {
        least = contact_smaller( least, s->courses[s->patch_of[s->sample_parents[sample][k]]].spent );
    }
    return least;
}

static bool is_late( const contact_soup* s, int sample )
{
    const int32_t* p = s->sample_parents[sample];
    return ( s->is_late[p[0]] | s->is_late[p[1]] | s->is_late[p[2]] ) != 0;
}

// How much nearer the sides may come in this substep: no more than two of their points.
static float closing_of( const contact_soup* s, const contact_pair* pair )
{
    float most = 0.0f;
    for ( int i = 0; i < 3; ++i )
    {
        for ( int k = 0; k < 3; ++k )
        {
            const float* p = s->ahead + (size_t)s->sample_parents[pair->a][i] * 4;
            const float* q = s->ahead + (size_t)s->sample_parents[pair->b][k] * 4;
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
    contact_soup* s = loop->work->soup;
    for ( int i = begin; i < end; ++i )
    {
        contact_candidate* c = s->candidates + i;
        const int32_t a = c->pair.a, b = c->pair.b;
        const bool is_asked = loop->late_only == false || is_late( s, a ) || is_late( s, b );
        if ( is_asked == false || s->sample_ways[a] + s->sample_ways[b] < c->due )
        {
            continue;
        }
        const float distance = contact_sample_distance( s, s->safe, a, b );
        // sums are rounded: a little earlier than that
        c->due = least_spent( s, a ) + least_spent( s, b ) + ( distance - 1.001f * c->pair.gap );
        if ( distance > 0.0f && distance < c->pair.gap + closing_of( s, &c->pair ) )
        {
            s->near[CONTACT_POINTS].items[atomic_fetch_add( &loop->total, 1 )] = c->pair;
        }
    }
}

wisp_status contact_find_near_samples( const contact_work* work, bool late_only, wisp_error* error )
{
    contact_soup* s = work->soup;
    sample_loop loop = { .work = work, .late_only = late_only };
    atomic_init( &loop.total, 0 );
    loop.strays =
        wisp_parallel_scratch( work->parallel, work->worker, (size_t)s->patch_count * sizeof( *loop.strays ) );
    if ( loop.strays == NULL || contact_reserve_near( work, CONTACT_POINTS, s->candidate_count ) == false )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "no memory for %d pairs that may meet", s->candidate_count );
    }
    for ( int p = 0; p < s->patch_count; ++p )
    {
        loop.strays[p] = s->courses[p].spent + contact_length_of_way( s, s->ways + p );
    }
    wisp_parallel_for( work->parallel, s->sample_count, GRAIN, find_ways, &loop );
    wisp_parallel_for( work->parallel, s->candidate_count, GRAIN, find_near, &loop );
    s->near[CONTACT_POINTS].count = atomic_load( &loop.total );
    s->near[CONTACT_EDGES].count = 0;
    return WISP_OK;
}
