// The planes between pairs that may meet in this substep, found where nothing crossed yet. The closest points of two convex
// pieces have a plane between them that separates the pieces whole, so that whoever stays behind it has not crossed.
#include "contact_internal.h"

#include <string.h>

enum
{
    LANES = 8,
    GROUPS = CONTACT_BLOCK / LANES,
    WAY_GRAIN = 4096,
};

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

void contact_set_points( const contact_work* work, int candidate, bool is_edge, contact_row* row )
{
    const contact_soup* s = work->soup;
    const contact_candidate* c = s->candidates + candidate;
    if ( work->state->world.features == WISP_CONTACT_SAMPLES )
    {
        row->count = 6;
        row->split = 3;
        memcpy( row->point, s->sample_parents[c->a], 3 * sizeof( int32_t ) );
        memcpy( row->point + 3, s->sample_parents[c->b], 3 * sizeof( int32_t ) );
        return;
    }
    row->count = 4;
    row->split = is_edge ? 2 : 1;
    const int32_t* a = is_edge ? s->edges + 2 * (size_t)c->a : &c->a;
    const int32_t* b = is_edge ? s->edges + 2 * (size_t)c->b : s->triangles + 3 * (size_t)c->b;
    memcpy( row->point, a, (size_t)row->split * sizeof( int32_t ) );
    memcpy( row->point + row->split, b, (size_t)( 4 - row->split ) * sizeof( int32_t ) );
}

// Closest points of up to a block of pairs, eight at a time. Lanes without a pair repeat the last one.
static void measure_pieces( const contact_work* work, const float* quads, int count, bool are_edges,
                            contact_row* rows )
{
    _Alignas( 64 ) int32_t point4[GROUPS][4][LANES];
    _Alignas( 64 ) float distance[GROUPS][LANES], weight[GROUPS][4][LANES], normal[GROUPS][3][LANES];
    const int groups = ( count + LANES - 1 ) / LANES;
    for ( int i = 0; i < groups * LANES; ++i )
    {
        const contact_row* row = rows + ( i < count ? i : count - 1 );
        for ( int k = 0; k < 4; ++k )
        {
            point4[i / LANES][k][i % LANES] = row->point[k] * 4;
        }
    }
    const wisp_closest_job job = { quads, (const int32_t( * )[4][LANES])point4, distance, weight, normal };
    const wisp_kernels* kernels = wisp_frame_kernels( work->frame );
    ( are_edges ? kernels->closest_segments : kernels->closest_triangle )( &job, 0, groups );
    for ( int i = 0; i < count; ++i )
    {
        contact_row* row = rows + i;
        row->distance = distance[i / LANES][i % LANES];
        for ( int k = 0; k < 4; ++k )
        {
            row->weight[k] = weight[i / LANES][k][i % LANES];
        }
        for ( int k = 0; k < 3; ++k )
        {
            row->normal[k] = normal[i / LANES][k][i % LANES];
        }
    }
}

void contact_measure_pairs( const contact_work* work, const float* quads, const int32_t* candidates, int count,
                            bool are_edges, contact_row* rows )
{
    for ( int i = 0; i < count; ++i )
    {
        contact_set_points( work, candidates[i], are_edges, rows + i );
    }
    for ( int i = 0; i < count && work->state->world.features == WISP_CONTACT_SAMPLES; ++i )
    {
        contact_measure_samples( work->soup, quads, work->soup->candidates + candidates[i], rows + i );
    }
    if ( work->state->world.features == WISP_CONTACT_EXACT && count > 0 )
    {
        measure_pieces( work, quads, count, are_edges, rows );
    }
}

static void begin_row( const contact_work* work, const contact_candidate* c, contact_row* row )
{
    row->gap = contact_smaller( c->gap, row->distance );
    row->wanted = c->gap;
    row->friction = sqrtf( contact_guest_of( work, row->point[0] )->settings.friction *
                           contact_guest_of( work, row->point[row->split] )->settings.friction );
    row->pushed = row->rubbed[0] = row->rubbed[1] = row->rubbed[2] = 0.0f;
    row->cut = 1.0f;
}

// ---- who is due ----

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
        s->point_way[i] = s->searched[(size_t)i * 4 + 3] + s->closing[i];
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

// How far each piece has gone since it was searched, and may go in this substep, at most.
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

// The two lists of ways that candidates of a block look into.
static void ways_of_block( const contact_work* work, int block, const float* ways[2] )
{
    const contact_soup* s = work->soup;
    const bool are_edges = block >= s->blocks.first_edge_block;
    const bool are_samples = work->state->world.features == WISP_CONTACT_SAMPLES;
    ways[0] = are_edges || are_samples ? s->edge_way : s->point_way;
    ways[1] = are_edges || are_samples ? s->edge_way : s->triangle_way;
}

static int list_due( const contact_work* work, int block, int32_t* list )
{
    const contact_soup* s = work->soup;
    const float* ways[2];
    ways_of_block( work, block, ways );
    int count = 0;
    for ( int i = s->blocks.begin[block]; i < s->blocks.begin[block + 1]; ++i )
    {
        const contact_candidate* c = s->candidates + i;
        list[count] = i;
        count += ways[0][c->a] + ways[1][c->b] >= c->due ? 1 : 0;
    }
    return count;
}

// What the sides of a pair have gone already, each at least: whoever of a side has gone less may go so much more.
static float least_gone( const contact_soup* s, const contact_row* row )
{
    float sides[2] = { INFINITY, INFINITY };
    for ( int i = 0; i < row->count; ++i )
    {
        const float gone = s->searched[(size_t)row->point[i] * 4 + 3];
        sides[i >= row->split] = contact_smaller( sides[i >= row->split], gone );
    }
    return sides[0] + sides[1];
}

// How much nearer the sides may come in this substep.
static float closing_of( const contact_soup* s, const contact_row* row )
{
    return largest_of( s->closing, row->point, row->split ) +
           largest_of( s->closing, row->point + row->split, row->count - row->split );
}

static void find_rows( void* context, int begin, int end, int worker )
{
    (void)worker;
    const contact_work* work = context;
    contact_soup* s = work->soup;
    for ( int b = begin; b < end; ++b )
    {
        int32_t list[CONTACT_BLOCK];
        contact_row* rows = s->rows + s->blocks.begin[b];
        const int due = list_due( work, b, list );
        contact_measure_pairs( work, s->safe, list, due, b >= s->blocks.first_edge_block, rows );
        int count = 0;
        for ( int i = 0; i < due; ++i )
        {
            contact_candidate* c = s->candidates + list[i];
            contact_row* row = rows + count;
            *row = rows[i];
            c->due = least_gone( s, row ) + ( row->distance - c->gap );
            const bool meets = row->distance > 0.0f && row->distance < c->gap + closing_of( s, row );
            begin_row( work, c, row );
            count += meets && is_tangled( s, row ) == false ? 1 : 0;
        }
        s->blocks.rows[b] = count;
    }
}

void contact_find_rows( const contact_work* work )
{
    find_ways( work );
    wisp_parallel_for( work->parallel, work->soup->blocks.count, 1, find_rows, (void*)(uintptr_t)work );
}
