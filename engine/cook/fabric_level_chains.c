// Chains of mesh edges along the links of a coarse level. How much a chain is shorter than at rest tells how much the cloth
// between the ends of a link is compressed: wrinkles bring the ends together and leave the chain as long as it was.
#include "fabric.h"
#include "fabric_levels.h"

#include <math.h>
#include <string.h>

// The paths from one vertex, by Dijkstra's algorithm over the edges of the mesh.
typedef struct path_search
{
    const fabric_mesh* mesh;
    double* distance; // [vertex_count] m
    int32_t* from;    // [vertex_count] vertex before it on the path
    int32_t* visit;   // [vertex_count] number of the search that wrote the two
    int32_t* place;   // [vertex_count] in the heap, -1 behind it
    int32_t* heap;    // [vertex_count]
    int heap_count;
    int32_t number;
} path_search;

static bool search_init( path_search* s, const fabric_mesh* mesh, fabric_pool* pool )
{
    const size_t count = (size_t)mesh->vertex_count;
    *s = ( path_search ){
        .mesh = mesh,
        .distance = fabric_pool_push( pool, count, sizeof( double ) ),
        .from = fabric_pool_push( pool, count, sizeof( int32_t ) ),
        .visit = fabric_pool_push_zeroed( pool, count, sizeof( int32_t ) ),
        .place = fabric_pool_push( pool, count, sizeof( int32_t ) ),
        .heap = fabric_pool_push( pool, count, sizeof( int32_t ) ),
    };
    return s->distance != NULL && s->from != NULL && s->visit != NULL && s->place != NULL && s->heap != NULL;
}

static bool is_nearer( const path_search* s, int32_t a, int32_t b )
{
    return s->distance[a] < s->distance[b] || ( s->distance[a] <= s->distance[b] && a < b );
}

static void put( path_search* s, int at, int32_t vertex )
{
    s->heap[at] = vertex;
    s->place[vertex] = at;
}

static void rise( path_search* s, int at )
{
    const int32_t vertex = s->heap[at];
    for ( ; at > 0 && is_nearer( s, vertex, s->heap[( at - 1 ) / 2] ); at = ( at - 1 ) / 2 )
    {
        put( s, at, s->heap[( at - 1 ) / 2] );
    }
    put( s, at, vertex );
}

static int32_t take_nearest( path_search* s )
{
    const int32_t nearest = s->heap[0], last = s->heap[--s->heap_count];
    int at = 0;
    for ( int child = 1; child < s->heap_count; child = 2 * at + 1 )
    {
        child += child + 1 < s->heap_count && is_nearer( s, s->heap[child + 1], s->heap[child] ) ? 1 : 0;
        if ( is_nearer( s, last, s->heap[child] ) )
        {
            break;
        }
        put( s, at, s->heap[child] );
        at = child;
    }
    if ( s->heap_count > 0 )
    {
        put( s, at, last );
    }
    s->place[nearest] = -1;
    return nearest;
}

static void reach( path_search* s, int32_t vertex, int32_t from, double distance )
{
    if ( s->visit[vertex] != s->number )
    {
        s->visit[vertex] = s->number;
        s->distance[vertex] = distance;
        s->from[vertex] = from;
        put( s, s->heap_count++, vertex );
        rise( s, s->place[vertex] );
    }
    else if ( s->place[vertex] >= 0 && distance < s->distance[vertex] )
    {
        s->distance[vertex] = distance;
        s->from[vertex] = from;
        rise( s, s->place[vertex] );
    }
}

// Searches until all wanted vertices have their final path.
// @param wanted [vertex_count] emptied
static void search( path_search* s, int32_t source, bool* wanted, int wanted_count )
{
    const fabric_mesh* mesh = s->mesh;
    s->number += 1;
    s->heap_count = 0;
    reach( s, source, -1, 0.0 );
    while ( s->heap_count > 0 && wanted_count > 0 )
    {
        const int32_t vertex = take_nearest( s );
        wanted_count -= wanted[vertex] ? 1 : 0;
        wanted[vertex] = false;
        for ( int32_t n = mesh->neighbour_begin[vertex]; n < mesh->neighbour_begin[vertex + 1]; ++n )
        {
            reach( s, mesh->neighbour[n], vertex, s->distance[vertex] + (double)mesh->neighbour_length[n] );
        }
    }
}

// The chains of all links, one after another, before they are put in groups.
typedef struct chain_list
{
    int32_t* begin; // [link_count + 1]
    int32_t* vertex;
    float* rest; // [link_count] m
} chain_list;

static int count_path( const path_search* s, int32_t end )
{
    int count = 0;
    for ( int32_t v = end; v >= 0; v = s->from[v] )
    {
        count += 1;
    }
    return count;
}

// Finds the chains of the links that begin at one vertex.
// @param out vertices are null: only lengths and counts, the count of link i in begin[i + 1]
static void find_chains( const level_maker* m, const level_link* links, int begin, int end, path_search* s,
                         bool* wanted, chain_list* out )
{
    for ( int i = begin; i < end; ++i )
    {
        wanted[m->fine[links[i].b]] = true;
    }
    search( s, m->fine[links[begin].a], wanted, end - begin );
    for ( int i = begin; i < end; ++i )
    {
        const int32_t last = m->fine[links[i].b];
        const int count = count_path( s, last );
        if ( out->vertex == NULL )
        {
            out->begin[i + 1] = count;
            out->rest[i] = (float)s->distance[last];
            continue;
        }
        int at = out->begin[i + 1];
        for ( int32_t v = last; v >= 0; v = s->from[v] )
        {
            out->vertex[--at] = v;
        }
    }
}

static bool list_chains( const level_maker* m, const level_link* links, int count, fabric_pool* scratch,
                         chain_list* out )
{
    path_search s;
    bool* wanted = fabric_pool_push_zeroed( scratch, (size_t)m->mesh->vertex_count, sizeof( bool ) );
    out->begin = fabric_pool_push_zeroed( scratch, (size_t)count + 1, sizeof( int32_t ) );
    out->rest = fabric_pool_push( scratch, (size_t)count, sizeof( float ) );
    out->vertex = NULL;
    if ( wanted == NULL || out->begin == NULL || out->rest == NULL || search_init( &s, m->mesh, scratch ) == false )
    {
        return false;
    }
    for ( int turn = 0; turn < 2; ++turn )
    {
        for ( int begin = 0, end; begin < count; begin = end )
        {
            for ( end = begin + 1; end < count && links[end].a == links[begin].a; ++end )
            {
            }
            find_chains( m, links, begin, end, &s, wanted, out );
        }
        if ( turn == 0 )
        {
            for ( int i = 0; i < count; ++i )
            {
                out->begin[i + 1] += out->begin[i];
            }
            out->vertex = fabric_pool_push( scratch, (size_t)out->begin[count], sizeof( int32_t ) );
            if ( out->vertex == NULL )
            {
                return false;
            }
        }
    }
    return true;
}

// Puts the chains of eight links next to each other.
static bool group_chains( const chain_list* chains, int32_t dummy_x4, fabric_pool* keep, wisp_fabric_level* out )
{
    const int groups = out->schedule.slot_count / WISP_FABRIC_LANES;
    int32_t* begin = fabric_pool_push( keep, (size_t)groups + 1, sizeof( int32_t ) );
    float* rest = fabric_pool_push_zeroed( keep, (size_t)out->schedule.slot_count, sizeof( float ) );
    if ( begin == NULL || rest == NULL )
    {
        return false;
    }
    begin[0] = 0;
    for ( int g = 0; g < groups; ++g )
    {
        int longest = 1;
        for ( int lane = 0; lane < WISP_FABRIC_LANES; ++lane )
        {
            const int32_t link = out->schedule.constraint[g * WISP_FABRIC_LANES + lane];
            const int count = link >= 0 ? chains->begin[link + 1] - chains->begin[link] : 1;
            longest = count > longest ? count : longest;
        }
        begin[g + 1] = begin[g] + longest;
    }
    int32_t( *chain_x4 )[WISP_FABRIC_LANES] = fabric_pool_push( keep, (size_t)begin[groups], sizeof( *chain_x4 ) );
    for ( int i = 0; i < out->schedule.slot_count && chain_x4 != NULL; ++i )
    {
        const int32_t link = out->schedule.constraint[i], g = i / WISP_FABRIC_LANES;
        const int count = link >= 0 ? chains->begin[link + 1] - chains->begin[link] : 0;
        for ( int e = 0; e < begin[g + 1] - begin[g]; ++e )
        {
            const int last = e < count ? e : count - 1;
            chain_x4[begin[g] + e][i % WISP_FABRIC_LANES] =
                count > 0 ? 4 * chains->vertex[chains->begin[link] + last] : dummy_x4;
        }
        rest[i] = link >= 0 ? chains->rest[link] : 0.0f;
    }
    out->chain_group_count = groups;
    out->chain_begin = begin;
    out->chain_x4 = (const int32_t( * )[8])chain_x4;
    out->chain_rest = rest;
    return chain_x4 != NULL;
}

bool level_make_chains( const level_maker* m, const level_link* links, fabric_pool* keep, wisp_fabric_level* out )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    chain_list chains;
    const bool done = list_chains( m, links, out->link_count, &scratch, &chains ) &&
                      group_chains( &chains, 4 * m->fabric->vertex_count, keep, out );
    fabric_pool_release( &scratch );
    return done;
}
