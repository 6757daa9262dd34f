// Second stage: weights. Elements with unchanged counts keep their weights; the others get new ones. Weights of
// even spacing stay valid until counts change. Weights of exact spacing depend on lengths, so they are computed in
// every update.
#include "samples_parts.h"

#include <string.h>

static samples_extent made_from( const samples_update* u, int t, const samples_extent* now )
{
    const float* kept = u->memory->triangles.extent + 2 * (size_t)t;
    return u->args->hysteresis > 0.0f ? ( samples_extent ){ now->axis, (double)kept[0], (double)kept[1] } : *now;
}

// ---- weights ----

static void weigh_edge( const samples_update* u, int e, int begin, int end, float ( *weights )[4] )
{
    double length;
    samples_measure_edge( u->args, e, &length );
    for ( int p = begin; p < end; ++p )
    {
        const double fraction = samples_fraction( u->args, p - begin + 1, end - begin + 1, length );
        weights[p][0] = (float)( 1.0 - fraction );
        weights[p][1] = (float)fraction;
        weights[p][2] = weights[p][3] = 0.0f;
    }
}

static void weigh_line( const samples_lines* line, int axis, int first, float ( *weights )[4] )
{
    const int a = axis, b = ( axis + 1 ) % 3, c = ( axis + 2 ) % 3;
    const double q = line->fraction;
    for ( int j = 1; j <= (int)line->points; ++j )
    {
        const double r = samples_fraction( line->args, j, line->m, line->length );
        float* w = weights[first + j - 1];
        w[a] = (float)( ( 1.0 - q ) * ( 1.0 - r ) );
        w[b] = (float)( ( 1.0 - q ) * r );
        w[c] = (float)q;
        w[3] = 0.0f;
    }
}

static void weigh_triangle( const samples_update* u, int t, int begin )
{
    samples_extent now;
    samples_measure_triangle( u->args, t, &now );
    const samples_extent made = made_from( u, t, &now );
    samples_lines line = samples_lines_of( u->args, &made, &now );
    while ( samples_next_line( &line ) )
    {
        weigh_line( &line, now.axis, begin, u->to.weights );
        begin += (int)line.points;
    }
}

void samples_weigh_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const samples_update* u = context;
    const samples_memory* m = u->memory;
    for ( int element = begin; element < end; ++element )
    {
        const int first = m->begin[element], last = m->begin[element + 1], t = element - m->edges.count;
        if ( first == last )
        {
            continue;
        }
        if ( t >= 0 )
        {
            weigh_triangle( u, t, first );
        }
        else
        {
            weigh_edge( u, element, first, last, u->to.weights );
        }
    }
}

// ---- recipes: parents and weights of points ----

static void name_parents( const samples_update* u, int element, const int32_t slots[3], int begin, int end )
{
    static const float NOTHING[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
    const int32_t parents[4] = { 4 * slots[0], 4 * slots[1], 4 * slots[2], 0 }, name = element;
    for ( int p = begin; p < end; ++p )
    {
        memcpy( u->to.parents[p], parents, sizeof( parents ) );
        memcpy( u->to.xyzw + 4 * (size_t)p + 3, &name, sizeof( name ) );
        if ( u->to.normals != NULL )
        {
            memcpy( u->to.normals + 4 * (size_t)p, NOTHING, sizeof( NOTHING ) );
        }
    }
}

static void make_edge( const samples_update* u, int e, int begin, int end )
{
    samples_group* g = &u->memory->edges;
    const int32_t a = u->args->edges[2 * (size_t)e], b = u->args->edges[2 * (size_t)e + 1];
    name_parents( u, e, ( const int32_t[3] ){ a, b, a }, begin, end );
    weigh_edge( u, e, begin, end, u->to.weights );
    u->args->edge_length[e] = g->extent[e] = g->next_extent[e];
    u->args->edge_points[e] = g->points[e] = end - begin;
    samples_keep_edge( u, e );
}

static void make_triangle( const samples_update* u, int t, int begin, int end )
{
    samples_group* g = &u->memory->triangles;
    name_parents( u, g->first + t, u->args->triangles + 3 * (size_t)t, begin, end );
    memcpy( g->extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    memcpy( u->args->triangle_extent + 2 * (size_t)t, g->next_extent + 2 * (size_t)t, 2 * sizeof( float ) );
    u->args->triangle_axis[t] = g->axis[t] = g->next_axis[t];
    u->args->triangle_points[t] = g->points[t] = end - begin;
    samples_keep_triangle( u, t );
    if ( end > begin )
    {
        weigh_triangle( u, t, begin );
    }
}

// Copies a row of every array; each row has four components.
static void move_points( const samples_update* u, int from, int to, int count )
{
    const size_t bytes = (size_t)count * 4 * sizeof( float );
    if ( count > 0 )
    {
        memcpy( u->to.xyzw + 4 * (size_t)to, u->from.xyzw + 4 * (size_t)from, bytes );
        memcpy( u->to.parents + to, u->from.parents + from, bytes );
        memcpy( u->to.weights + to, u->from.weights + from, bytes );
        if ( u->to.normals != NULL )
        {
            memcpy( u->to.normals + 4 * (size_t)to, u->from.normals + 4 * (size_t)from, bytes );
        }
    }
}

// Converts counts to first points; runs of unchanged elements are copied together.
static void fill_group( const samples_update* u, samples_group* g, int begin, int end, int first_point )
{
    samples_memory* m = u->memory;
    int p = first_point, i = begin;
    while ( i < end )
    {
        const int run = g->first + i, to = p;
        for ( ; i < end && m->changed[g->first + i] == 0; ++i )
        {
            const int count = m->next[g->first + i];
            m->next[g->first + i] = p;
            p += count;
        }
        move_points( u, m->begin[run], to, p - to );
        if ( i < end )
        {
            const int count = m->next[g->first + i];
            m->next[g->first + i] = p;
            ( g == &m->edges ? make_edge : make_triangle )( u, i, p, p + count );
            p += count;
            ++i;
        }
    }
}

void samples_fill_block( void* context, int begin, int end, int worker )
{
    (void)worker;
    const samples_update* u = context;
    for ( int block = begin; block < end; ++block )
    {
        const bool edges = block < u->edge_blocks;
        samples_group* g = edges ? &u->memory->edges : &u->memory->triangles;
        const int first = ( edges ? block : block - u->edge_blocks ) * SAMPLES_BLOCK;
        const int last = first + SAMPLES_BLOCK < g->count ? first + SAMPLES_BLOCK : g->count;
        fill_group( u, g, first, last, (int)u->memory->block_begin[block] );
    }
}
