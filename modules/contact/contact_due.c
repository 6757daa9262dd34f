// Which listed pairs may become rows in this substep: it is looked at those whose points strayed enough for it.
#include "contact_internal.h"

enum
{
    WAY_GRAIN = 4096,
    NEAR_GRAIN = 8, // batches
};

// ---- pieces ----

static void mark_late( void* context, int begin, int end, int worker )
{
    (void)worker;
    contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* e = s->edges + (size_t)i * 2;
        s->edge_late[i] = s->is_late[e[0]] | s->is_late[e[1]];
    }
}

static void mark_late_triangles( void* context, int begin, int end, int worker )
{
    (void)worker;
    contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        const int32_t* t = s->triangles + (size_t)i * 3;
        s->triangle_late[i] = s->is_late[t[0]] | s->is_late[t[1]] | s->is_late[t[2]];
    }
}

static float largest_of( const float* way, const int32_t* points, int count )
{
    float most = way[points[0]];
    for ( int i = 1; i < count; ++i )
    {
        most = contact_larger( most, way[points[i]] );
    }
    return most;
}

static void find_point_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->point_way[i] = s->spent[i] + s->astray[i];
    }
}

static void find_edge_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->edge_way[i] = largest_of( s->point_way, s->edges + 2 * (size_t)i, 2 );
    }
}

static void find_triangle_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->triangle_way[i] = largest_of( s->point_way, s->triangles + 3 * (size_t)i, 3 );
    }
}

static void find_sample_ways( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_soup* s = context;
    for ( int i = begin; i < end; ++i )
    {
        s->edge_way[i] = largest_of( s->point_way, s->sample_parents[i], 3 );
    }
}

static void mark_late_pieces( const contact_work* work )
{
    contact_soup* s = work->soup;
    wisp_parallel_for( work->parallel, s->edge_count, WAY_GRAIN, mark_late, s );
    wisp_parallel_for( work->parallel, s->triangle_count, WAY_GRAIN, mark_late_triangles, s );
}

// How far each piece went astray since it was searched, and may go in this substep, at most.
static void find_ways( const contact_work* work )
{
    contact_soup* s = work->soup;
    wisp_parallel_for( work->parallel, s->point_count, WAY_GRAIN, find_point_ways, s );
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        wisp_parallel_for( work->parallel, s->sample_count, WAY_GRAIN, find_sample_ways, s );
        return;
    }
    wisp_parallel_for( work->parallel, s->edge_count, WAY_GRAIN, find_edge_ways, s );
    wisp_parallel_for( work->parallel, s->triangle_count, WAY_GRAIN, find_triangle_ways, s );
}

// ---- pairs ----

// Where something is already crossed, the plane has no right side.
static bool is_tangled( const contact_soup* s, const contact_row* row )
{
    bool sides[2] = { false, false };
    for ( int i = 0; i < row->count; ++i )
    {
        sides[i >= row->split] = sides[i >= row->split] || s->is_tangled[row->point[i]] != 0;
    }
    return sides[0] && sides[1];
}

typedef struct near_loop
{
    const contact_work* work;
    const contact_list* list;
    const float* ways[2];   // of the pieces of either side
    const uint8_t* late[2]; // only of them, null: of all
} near_loop;

// What the sides of a pair went astray already, each at least: whoever of a side went less may go so much more.
static float least_spent( const contact_soup* s, const contact_row* row )
{
    float sides[2] = { INFINITY, INFINITY };
    for ( int i = 0; i < row->count; ++i )
    {
        sides[i >= row->split] = contact_smaller( sides[i >= row->split], s->spent[row->point[i]] );
    }
    return sides[0] + sides[1];
}

// How much nearer the sides may come in this substep: no more than two of their points.
static float closing_of( const contact_soup* s, const contact_row* row )
{
    float most = 0.0f;
    for ( int i = 0; i < row->split; ++i )
    {
        for ( int k = row->split; k < row->count; ++k )
        {
            const float *p = s->ahead + (size_t)row->point[i] * 4, *q = s->ahead + (size_t)row->point[k] * 4;
            const float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
            most = contact_larger( most, sqrtf( x * x + y * y + z * z ) + ( p[3] + q[3] ) );
        }
    }
    return most;
}

// Does a pair of which it is known how near it is come to its gap in this substep? Else it is known for how long it does not.
static bool may_meet( const contact_work* work, contact_candidate* c, const contact_row* row, float distance )
{
    const contact_soup* s = work->soup;
    // sums are rounded: a little earlier than that
    c->due = least_spent( s, row ) + (float)s->drifted * c->drift + ( distance - 1.001f * c->gap );
    return distance > 0.0f && distance < c->gap + closing_of( s, row ) && is_tangled( s, row ) == false;
}

static const float* measure_batch( const near_loop* loop, contact_candidate* const* due, int count,
                                   contact_pieces* pieces, contact_row* rows )
{
    const contact_work* work = loop->work;
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    for ( int i = 0; i < count; ++i )
    {
        contact_set_points( work, due[i], loop->list->are_edges, rows + i );
        if ( are_samples )
        {
            contact_measure_samples( work->soup, work->soup->safe, due[i], rows + i );
            pieces->distance[i / WISP_SLICE][i % WISP_SLICE] = rows[i].distance;
        }
        else
        {
            contact_put_pieces( pieces, i, rows[i].point );
        }
    }
    return are_samples ? pieces->distance[0] : contact_measure_distances( work, work->soup->safe, pieces, count );
}

static void find_near( void* context, int begin, int end, int worker )
{
    (void)worker;
    const near_loop* loop = context;
    // drift goes on for this substep too
    const int most = contact_drift_substeps( loop->work ), drifted = loop->work->soup->drifted;
    const float substeps = (float)( drifted < most ? drifted + 1 : most );
    contact_pieces pieces;
    pieces.are_edges = loop->list->are_edges;
    for ( int batch = begin; batch < end; ++batch )
    {
        contact_candidate* due[CONTACT_BATCH];
        contact_row rows[CONTACT_BATCH];
        const int first = batch * CONTACT_BATCH, rest = loop->list->count - first;
        int count = 0, met = 0;
        for ( int i = 0; i < rest && i < CONTACT_BATCH; ++i )
        {
            contact_candidate* c = loop->list->items + first + i;
            const bool is_asked = loop->late[0] == NULL || ( loop->late[0][c->a] | loop->late[1][c->b] ) != 0;
            due[count] = c;
            count += is_asked && loop->ways[0][c->a] + loop->ways[1][c->b] + substeps * c->drift >= c->due ? 1 : 0;
        }
        const float* distance = measure_batch( loop, due, count, &pieces, rows );
        for ( int i = 0; i < count; ++i )
        {
            loop->list->near[first + met] = (int32_t)( due[i] - loop->list->items );
            met += may_meet( loop->work, due[i], rows + i, distance[i] ) ? 1 : 0;
        }
        loop->list->near_count[batch] = met;
    }
}

static int search_list( const contact_work* work, contact_kind kind, bool late_only )
{
    const contact_soup* s = work->soup;
    const contact_list* list = s->lists + kind;
    const bool are_equal = list->are_edges || work->state->world.features == WISP_CONTACT_SAMPLES;
    near_loop loop = { .work = work, .list = list };
    loop.ways[0] = are_equal ? s->edge_way : s->point_way;
    loop.ways[1] = are_equal ? s->edge_way : s->triangle_way;
    if ( late_only )
    {
        loop.late[0] = list->are_edges ? s->edge_late : s->is_late;
        loop.late[1] = list->are_edges ? s->edge_late : s->triangle_late;
    }
    const int batches = ( list->count + CONTACT_BATCH - 1 ) / CONTACT_BATCH;
    wisp_parallel_for( work->parallel, batches, NEAR_GRAIN, find_near, &loop );
    int count = 0;
    for ( int batch = 0; batch < batches; ++batch )
    {
        count += list->near_count[batch];
    }
    return count;
}

int contact_search_lists( const contact_work* work, bool late_only )
{
    int count = 0;
    find_ways( work );
    if ( late_only )
    {
        mark_late_pieces( work );
    }
    for ( int kind = 0; kind < CONTACT_KIND_COUNT; ++kind )
    {
        count += search_list( work, (contact_kind)kind, late_only );
    }
    return count;
}
