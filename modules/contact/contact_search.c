// Which pairs are within reach: those that share no point and may come to their gap while all points keep to their courses.
#include "contact_internal.h"

#include <string.h>

enum
{
    BOX_GRAIN = 1024,
    MOST_PER_POINT = 512, // pairs a point, before reach is cut
};

// ---- courses of pieces, and boxes around them ----

void contact_take_course( const contact_soup* s, const int32_t* points, int count, float drift[4], float* reach )
{
    const float share = 1.0f / (float)count;
    float most = 0.0f;
    *reach = 0.0f;
    for ( size_t k = 0; k < 3; ++k )
    {
        float sum = 0.0f;
        for ( int i = 0; i < count; ++i )
        {
            sum += s->drift[(size_t)points[i] * 4 + k];
        }
        drift[k] = share * sum;
    }
    for ( int i = 0; i < count; ++i )
    {
        const float* u = s->drift + (size_t)points[i] * 4;
        const float x = u[0] - drift[0], y = u[1] - drift[1], z = u[2] - drift[2];
        most = contact_larger( most, x * x + y * y + z * z );
        *reach = contact_larger( *reach, s->reach[points[i]] );
    }
    drift[3] = sqrtf( most );
}

static float substeps_left( const contact_work* work )
{
    return (float)( contact_drift_substeps( work ) - work->soup->drifted );
}

// Rows are made of pairs that might come to their gap in a substep, wherever they go in it: its drift counts all around.
static float longest_drift( const contact_soup* s, const int32_t* points, int count )
{
    float most = 0.0f;
    for ( int i = 0; i < count; ++i )
    {
        const float* u = s->drift + (size_t)points[i] * 4;
        most = contact_larger( most, u[0] * u[0] + u[1] * u[1] + u[2] * u[2] );
    }
    return 1.001f * sqrtf( most );
}

wisp_box contact_box_around( const contact_work* work, const int32_t* points, int count, float reach )
{
    const contact_soup* s = work->soup;
    const float wide =
        0.5f * contact_guest_of( work, points[0] )->settings.thickness + reach + longest_drift( s, points, count );
    const float substeps = substeps_left( work );
    wisp_box box;
    for ( size_t k = 0; k < 3; ++k )
    {
        float low = INFINITY, high = -INFINITY;
        bool is_number = true;
        for ( int i = 0; i < count; ++i )
        {
            const size_t at = (size_t)points[i] * 4 + k;
            const float x = s->safe[at] - s->travelled[k], end = x + substeps * s->drift[at];
            is_number = is_number && x == x && end == end;
            low = contact_smaller( low, contact_smaller( x, end ) );
            high = contact_larger( high, contact_larger( x, end ) );
        }
        box.low[k] = is_number ? low - wide : INFINITY; // a box like this meets nothing
        box.high[k] = is_number ? high + wide : -INFINITY;
    }
    return box;
}

static void box_points( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int i = begin; i < end; ++i )
    {
        s->point_boxes[i] = contact_box_around( work, &i, 1, s->reach[i] );
    }
}

static void box_edges( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* points = s->edges + (size_t)i * 2;
        contact_take_course( s, points, 2, s->edge_drift + (size_t)i * 4, s->edge_reach + i );
        s->edge_boxes[i] = contact_box_around( work, points, 2, s->edge_reach[i] );
    }
}

static void box_triangles( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* points = s->triangles + (size_t)i * 3;
        contact_take_course( s, points, 3, s->triangle_drift + (size_t)i * 4, s->triangle_reach + i );
        s->triangle_boxes[i] = contact_box_around( work, points, 3, s->triangle_reach[i] );
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

float contact_gap_of( const contact_work* work, int a, int b )
{
    const contact_guest *ga = contact_guest_of( work, a ), *gb = contact_guest_of( work, b );
    return contact_may_meet( ga, gb ) ? 0.5f * ( ga->settings.thickness + gb->settings.thickness ) : 0.0f;
}

// Pieces of a kind, as they were searched.
typedef struct piece_kind
{
    const int32_t* points; // [piece][count], null: a piece is a point
    int count;
    const float *reach, *drift;
} piece_kind;

static piece_kind kind_of_points( const contact_soup* s )
{
    return ( piece_kind ){ NULL, 1, s->reach, s->drift };
}

static piece_kind kind_of_edges( const contact_soup* s )
{
    return ( piece_kind ){ s->edges, 2, s->edge_reach, s->edge_drift };
}

static piece_kind kind_of_triangles( const contact_soup* s )
{
    return ( piece_kind ){ s->triangles, 3, s->triangle_reach, s->triangle_drift };
}

static void points_of( const piece_kind* kind, int32_t piece, int32_t* out )
{
    for ( int i = 0; i < kind->count; ++i )
    {
        out[i] = kind->points != NULL ? kind->points[(size_t)piece * (size_t)kind->count + (size_t)i] : piece;
    }
}

static bool share_a_point( const int32_t points[4], int split )
{
    bool share = false;
    for ( int i = 0; i < split; ++i )
    {
        for ( int k = split; k < 4; ++k )
        {
            share = share || points[i] == points[k];
        }
    }
    return share;
}

// Those of a list that share no point with the asker, may meet it, and are so near that they may come to their gap. Most
// boxes that overlap belong to neighbours in the mesh, which are not, as they go where the asker goes.
static int keep_near( const contact_work* work, const piece_kind kinds[2], int asking, int asker, int32_t* items,
                      int count )
{
    const piece_kind *mine = kinds + asking, *theirs = kinds + 1 - asking;
    const int split = kinds[0].count;
    const float substeps = substeps_left( work ) + 1.0f; // and the one that they might come to their gap in
    contact_pieces pieces;
    pieces.are_edges = split == 2;
    int32_t points[4];
    points_of( mine, asker, points + ( asking == 0 ? 0 : split ) );
    const float* guest_of = work->soup->rest + 3; // [point * 4]
    const int own = asking == 0 ? 0 : 3, other = 3 - own;
    float guest = -1.0f, gap = 0.0f; // what is kept from this guest
    int kept = 0;
    for ( int from = 0; from < count; )
    {
        int32_t list[CONTACT_BATCH];
        float within[CONTACT_BATCH];
        int listed = 0;
        for ( ; from < count && listed < CONTACT_BATCH; ++from )
        {
            const int32_t item = items[from];
            points_of( theirs, item, points + ( asking == 0 ? split : 0 ) );
            if ( guest_of[(size_t)points[other] * 4] != guest )
            {
                guest = guest_of[(size_t)points[other] * 4];
                gap = contact_gap_of( work, points[own], points[other] );
            }
            if ( gap > 0.0f && share_a_point( points, split ) == false )
            {
                contact_put_pieces( &pieces, listed, points );
                within[listed] = 1.001f * gap + ( mine->reach[asker] + theirs->reach[item] ) +
                                 substeps * contact_drift_between( mine->drift + (size_t)asker * 4,
                                                                   theirs->drift + (size_t)item * 4 );
                list[listed++] = item;
            }
        }
        const float* distance = contact_measure_distances( work, work->soup->safe, &pieces, listed );
        for ( int i = 0; i < listed; ++i )
        {
            items[kept] = list[i];
            kept += distance[i] < within[i] ? 1 : 0;
        }
    }
    return kept;
}

int contact_keep_triangles( const contact_work* work, int point, int32_t* items, int count )
{
    const piece_kind kinds[2] = { kind_of_points( work->soup ), kind_of_triangles( work->soup ) };
    return keep_near( work, kinds, 0, point, items, count );
}

int contact_keep_points( const contact_work* work, int triangle, int32_t* items, int count )
{
    const piece_kind kinds[2] = { kind_of_points( work->soup ), kind_of_triangles( work->soup ) };
    return keep_near( work, kinds, 1, triangle, items, count );
}

int contact_keep_edges( const contact_work* work, int edge, int32_t* items, int count )
{
    const piece_kind kinds[2] = { kind_of_edges( work->soup ), kind_of_edges( work->soup ) };
    return keep_near( work, kinds, 0, edge, items, count );
}

// ---- searching ----

static int filter_triangles( const void* context, int asker, int32_t* items, int count )
{
    return contact_keep_triangles( context, asker, items, count );
}

static int filter_edges( const void* context, int asker, int32_t* items, int count )
{
    return contact_keep_edges( context, asker, items, count );
}

static wisp_status find_pairs( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        return contact_find_sample_pairs( work, error );
    }
    wisp_parallel_for( work->parallel, s->point_count, BOX_GRAIN, box_points, (void*)(uintptr_t)work );
    wisp_parallel_for( work->parallel, s->edge_count, BOX_GRAIN, box_edges, (void*)(uintptr_t)work );
    wisp_parallel_for( work->parallel, s->triangle_count, BOX_GRAIN, box_triangles, (void*)(uintptr_t)work );
    const size_t limit = (size_t)s->point_count * MOST_PER_POINT;
    const wisp_box_job points = {
        .askers = s->point_boxes,
        .asker_count = s->point_count,
        .boxes = s->triangle_boxes,
        .box_count = s->triangle_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = limit,
        .filter = filter_triangles,
        .filter_context = work,
    };
    const wisp_box_job edges = {
        .boxes = s->edge_boxes,
        .box_count = s->edge_count,
        .search = work->state->world.search,
        .kernels = wisp_frame_kernels( work->frame ),
        .limit = limit,
        .filter = filter_edges,
        .filter_context = work,
    };
    const wisp_status status = wisp_box_pairs_find( &s->point_pairs, work->parallel, &points, error );
    return status == WISP_OK ? wisp_box_pairs_find( &s->edge_pairs, work->parallel, &edges, error ) : status;
}

// Look less far, and let the guard cut what goes farther.
static void halve_reach( contact_soup* s )
{
    for ( int i = 0; i < s->point_count; ++i )
    {
        s->reach[i] *= 0.5f;
        for ( size_t k = 0; k < 3; ++k )
        {
            s->drift[(size_t)i * 4 + k] *= 0.5f;
        }
    }
}

static bool take_lists( const contact_work* work )
{
    contact_soup* s = work->soup;
    const size_t points = s->point_pairs.pair_count, edges = s->edge_pairs.pair_count;
    bool enough = contact_reserve_list( work, CONTACT_POINTS, points ) &&
                  contact_reserve_list( work, CONTACT_EDGES_LIST, edges ) &&
                  contact_reserve_list( work, CONTACT_LATE_POINTS, (size_t)s->point_count ) &&
                  contact_reserve_list( work, CONTACT_LATE_EDGES, (size_t)s->edge_count );
    if ( enough )
    {
        contact_fill_list( work, CONTACT_POINTS, &s->point_pairs, NULL, false );
        contact_fill_list( work, CONTACT_EDGES_LIST, &s->edge_pairs, NULL, false );
    }
    return enough;
}

wisp_status contact_search( const contact_work* work, wisp_error* error )
{
    contact_soup* s = work->soup;
    wisp_status status = WISP_BAD_INPUT;
    contact_set_courses( work );
    s->has_point_grid = s->is_short = false;
    s->renewed[0].count = s->renewed[1].count = s->renewed[2].count = 0;
    for ( int halvings = 0; status == WISP_BAD_INPUT && halvings < 40; ++halvings )
    {
        status = find_pairs( work, error );
        if ( status == WISP_BAD_INPUT ) // more than so many pairs are no list
        {
            halve_reach( s );
            s->is_short = true;
        }
    }
    if ( status == WISP_OK && take_lists( work ) == false )
    {
        status = wisp_fail( error, WISP_NO_MEMORY, "no memory for %zu pairs",
                            s->point_pairs.pair_count + s->edge_pairs.pair_count );
    }
    s->is_listed = status == WISP_OK;
    return status;
}
