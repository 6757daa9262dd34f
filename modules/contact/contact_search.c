// Which pairs are within reach, by their boxes: those that share no point and may meet.
#include "contact_internal.h"

enum
{
    BOX_GRAIN = 1024,
    PAIR_GRAIN = 512,     // askers
    MOST_PER_POINT = 512, // pairs of boxes a point, before reach is cut
};

typedef struct search_loop
{
    const contact_work* work;
    contact_soup* soup;
    const wisp_box_pairs* pairs;
    float* gaps; // [pair] 0: no candidate
} search_loop;

float contact_reach_of( const contact_soup* s, const int32_t* points, int count )
{
    float reach = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        reach = contact_larger( reach, s->safe[(size_t)points[i] * 4 + 3] );
    }
    return reach;
}

// ---- boxes ----

static wisp_box box_around( const search_loop* loop, const int32_t* points, int count )
{
    const contact_soup* s = loop->soup;
    const float wide =
        0.5f * contact_guest_of( loop->work, points[0] )->settings.thickness + contact_reach_of( s, points, count );
    wisp_box box;
    for ( int k = 0; k < 3; ++k )
    {
        float low = INFINITY, high = -INFINITY;
        bool is_number = true;
        for ( int i = 0; i < count; ++i )
        {
            const float x = s->searched[(size_t)points[i] * 4 + (size_t)k];
            is_number = is_number && x == x;
            low = contact_smaller( low, x );
            high = contact_larger( high, x );
        }
        box.low[k] = is_number ? low - wide : INFINITY; // a box like this meets nothing
        box.high[k] = is_number ? high + wide : -INFINITY;
    }
    return box;
}

static void box_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    const search_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        loop->soup->point_boxes[i] = box_around( loop, &i, 1 );
    }
}

static void box_edges( void* context, int begin, int end, int worker )
{
    (void)worker;
    const search_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        loop->soup->edge_boxes[i] = box_around( loop, loop->soup->edges + 2 * (size_t)i, 2 );
    }
}

static void box_triangles( void* context, int begin, int end, int worker )
{
    (void)worker;
    const search_loop* loop = context;
    for ( int i = begin; i < end; ++i )
    {
        loop->soup->triangle_boxes[i] = box_around( loop, loop->soup->triangles + 3 * (size_t)i, 3 );
    }
}

// ---- which pairs may meet ----

bool contact_may_meet( const contact_guest* a, const contact_guest* b )
{
    if ( a == b )
    {
        return a->settings.self != 0;
    }
    return ( a->settings.layers & b->settings.mask ) != 0 && ( b->settings.layers & a->settings.mask ) != 0 &&
           ( a->is_strands && b->is_strands ) == false;
}

// What a pair would keep, 0 if it is none. Its boxes overlap, so it is as near as pairs are looked for.
static float gap_of( const search_loop* loop, int a, int b )
{
    const contact_guest *ga = contact_guest_of( loop->work, a ), *gb = contact_guest_of( loop->work, b );
    return contact_may_meet( ga, gb ) ? 0.5f * ( ga->settings.thickness + gb->settings.thickness ) : 0.0f;
}

static void check_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    const search_loop* loop = context;
    for ( int p = begin; p < end; ++p )
    {
        for ( int k = loop->pairs->begin[p]; k < loop->pairs->begin[p + 1]; ++k )
        {
            const int32_t* t = loop->soup->triangles + (size_t)loop->pairs->item[k] * 3;
            const bool shares = p == t[0] || p == t[1] || p == t[2];
            loop->gaps[k] = shares ? 0.0f : gap_of( loop, p, t[0] );
        }
    }
}

static void check_edges( void* context, int begin, int end, int worker )
{
    (void)worker;
    const search_loop* loop = context;
    for ( int e = begin; e < end; ++e )
    {
        const int32_t* a = loop->soup->edges + (size_t)e * 2;
        for ( int k = loop->pairs->begin[e]; k < loop->pairs->begin[e + 1]; ++k )
        {
            const int32_t* b = loop->soup->edges + (size_t)loop->pairs->item[k] * 2;
            const bool shares = a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
            loop->gaps[k] = shares ? 0.0f : gap_of( loop, a[0], b[0] );
        }
    }
}

static void point_at( search_loop* loop, const wisp_box_pairs* pairs, size_t first )
{
    contact_soup* s = loop->soup;
    loop->pairs = pairs;
    loop->gaps = s->pair_gap + first;
}

static wisp_status find_pairs( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        return contact_find_sample_pairs( work, error );
    }
    const size_t limit = (size_t)s->point_count * MOST_PER_POINT;
    const wisp_box_job points = {
        .askers = s->point_boxes,
        .asker_count = s->point_count,
        .boxes = s->triangle_boxes,
        .box_count = s->triangle_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = limit,
    };
    const wisp_box_job edges = {
        .boxes = s->edge_boxes,
        .box_count = s->edge_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = limit,
    };
    const wisp_status status = wisp_box_pairs_find( &s->point_pairs, work->parallel, &points, error );
    return status == WISP_OK ? wisp_box_pairs_find( &s->edge_pairs, work->parallel, &edges, error ) : status;
}

static bool check_pairs( const contact_work* work, search_loop* loop )
{
    contact_soup* s = work->soup;
    const size_t pairs = s->point_pairs.pair_count + s->edge_pairs.pair_count;
    if ( contact_reserve( work, CONTACT_PAIR_GAP, pairs * sizeof( float ), (void**)&s->pair_gap ) == false )
    {
        return false;
    }
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        contact_check_samples( work, s->pair_gap );
        return contact_make_candidates( work );
    }
    point_at( loop, &s->point_pairs, 0 );
    wisp_parallel_for( work->parallel, s->point_count, PAIR_GRAIN, check_points, loop );
    point_at( loop, &s->edge_pairs, s->point_pairs.pair_count );
    wisp_parallel_for( work->parallel, s->edge_count, PAIR_GRAIN, check_edges, loop );
    return contact_make_candidates( work );
}

wisp_status contact_search( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    search_loop loop = { .work = work, .soup = s };
    wisp_status status = WISP_BAD_INPUT;
    for ( int halvings = 0; status == WISP_BAD_INPUT && halvings < 40; ++halvings )
    {
        wisp_parallel_for( work->parallel, s->point_count, BOX_GRAIN, box_points, &loop );
        wisp_parallel_for( work->parallel, s->edge_count, BOX_GRAIN, box_edges, &loop );
        wisp_parallel_for( work->parallel, s->triangle_count, BOX_GRAIN, box_triangles, &loop );
        status = find_pairs( work, error );
        // more than so many is no list of candidates: look less far, and let the guard cut what goes farther
        for ( int i = 0; i < s->point_count && status == WISP_BAD_INPUT; ++i )
        {
            s->safe[(size_t)i * 4 + 3] *= 0.5f;
        }
    }
    if ( status == WISP_OK && check_pairs( work, &loop ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for the candidates among %zu pairs",
                            s->point_pairs.pair_count + s->edge_pairs.pair_count );
    }
    s->candidate_count = status == WISP_OK ? s->candidate_count : -1;
    return status;
}
