// Chains of mesh edges along the links of a coarse level. How much a chain is shorter than at rest tells how much the cloth
// between the ends of a link is compressed: wrinkles bring the ends together and leave the chain as long as it was.
#include "fabric.h"
#include "fabric_levels.h"

#include <math.h>
#include <string.h>

enum
{
    PATH_HEAP_ARITY = 4,
};

// A vertex in the heap with its distance, which is compared more often than vertices are looked up.
typedef struct path_entry
{
    double distance; // m
    int32_t vertex;
} path_entry;

// State of a vertex in a search, in one struct because a search reads all of it at once.
typedef struct path_node
{
    double distance; // m
    int32_t from;    // vertex before it on the path
    int32_t visit;   // number of the search that wrote this
    int32_t place;   // in the heap, -1 behind it
} path_node;

// The paths from one vertex, by Dijkstra's algorithm over the edges of the mesh.
typedef struct path_search
{
    const fabric_mesh* mesh;
    path_node* node;  // [vertex_count]
    path_entry* heap; // [vertex_count]
    int heap_count;
    int32_t number;
} path_search;

static bool search_init( path_search* s, const fabric_mesh* mesh, fabric_pool* pool )
{
    const size_t count = (size_t)mesh->vertex_count;
    *s = ( path_search ){
        .mesh = mesh,
        .node = fabric_pool_push_zeroed( pool, count, sizeof( path_node ) ),
        .heap = fabric_pool_push( pool, count, sizeof( path_entry ) ),
    };
    return s->node != NULL && s->heap != NULL;
}

static bool is_nearer( path_entry a, path_entry b )
{
    return a.distance < b.distance || ( a.distance <= b.distance && a.vertex < b.vertex );
}

static void put_path( path_search* s, int at, path_entry entry )
{
    s->heap[at] = entry;
    s->node[entry.vertex].place = at;
}

static void raise_path( path_search* s, int at, path_entry entry )
{
    for ( ; at > 0 && is_nearer( entry, s->heap[( at - 1 ) / PATH_HEAP_ARITY] ); at = ( at - 1 ) / PATH_HEAP_ARITY )
    {
        put_path( s, at, s->heap[( at - 1 ) / PATH_HEAP_ARITY] );
    }
    put_path( s, at, entry );
}

static int32_t take_nearest_path( path_search* s )
{
    const path_entry nearest = s->heap[0], last = s->heap[--s->heap_count];
    int at = 0;
    for ( int first = 1; first < s->heap_count; first = PATH_HEAP_ARITY * at + 1 )
    {
        const int end = first + PATH_HEAP_ARITY < s->heap_count ? first + PATH_HEAP_ARITY : s->heap_count;
        int best = first;
        for ( int child = first + 1; child < end; ++child )
        {
            best = is_nearer( s->heap[child], s->heap[best] ) ? child : best;
        }
        if ( is_nearer( last, s->heap[best] ) )
        {
            break;
        }
        put_path( s, at, s->heap[best] );
        at = best;
    }
    if ( s->heap_count > 0 )
    {
        put_path( s, at, last );
    }
    s->node[nearest.vertex].place = -1;
    return nearest.vertex;
}

static void reach( path_search* s, int32_t vertex, int32_t from, double distance )
{
    path_node* node = s->node + vertex;
    const bool is_new = node->visit != s->number;
    if ( is_new || ( node->place >= 0 && distance < node->distance ) )
    {
        const int at = is_new ? s->heap_count++ : node->place;
        *node = ( path_node ){ distance, from, s->number, at };
        raise_path( s, at, ( path_entry ){ distance, vertex } );
    }
}

// Searches until all wanted vertices have their final path.
// @param wanted [vertex_count] emptied
static void search_paths( path_search* s, int32_t source, bool* wanted, int wanted_count )
{
    const fabric_mesh* mesh = s->mesh;
    s->number += 1;
    s->heap_count = 0;
    reach( s, source, -1, 0.0 );
    while ( s->heap_count > 0 && wanted_count > 0 )
    {
        const int32_t vertex = take_nearest_path( s );
        const double distance = s->node[vertex].distance;
        wanted_count -= wanted[vertex] ? 1 : 0;
        wanted[vertex] = false;
        for ( int32_t n = mesh->neighbour_begin[vertex]; n < mesh->neighbour_begin[vertex + 1]; ++n )
        {
            reach( s, mesh->neighbour[n], vertex, distance + (double)mesh->neighbour_length[n] );
        }
    }
}

// The chains of all links, one after another, before they are put in groups.
typedef struct chain_list
{
    int32_t* begin; // [link_count + 1]
    int32_t* vertex;
    size_t room; // for vertices
    float* rest; // [link_count] m
} chain_list;

static int count_path( const path_search* s, int32_t end )
{
    int count = 0;
    for ( int32_t v = end; v >= 0; v = s->node[v].from )
    {
        count += 1;
    }
    return count;
}

// Makes room for more vertices. What was there before stays in the pool until its end.
static bool reserve_vertices( chain_list* list, size_t used, size_t more, fabric_pool* pool )
{
    if ( used + more <= list->room )
    {
        return true;
    }
    const size_t room = 2 * list->room > used + more ? 2 * list->room : used + more;
    int32_t* grown = fabric_pool_push( pool, room, sizeof( int32_t ) );
    if ( grown == NULL )
    {
        return false;
    }
    if ( used > 0 )
    {
        memcpy( grown, list->vertex, used * sizeof( int32_t ) );
    }
    list->vertex = grown;
    list->room = room;
    return true;
}

// Finds the chains of the links that begin at one vertex.
static bool find_chains( const level_maker* m, const level_link* links, int begin, int end, path_search* s,
                         bool* wanted, fabric_pool* pool, chain_list* out )
{
    for ( int i = begin; i < end; ++i )
    {
        wanted[m->fine[links[i].b]] = true;
    }
    search_paths( s, m->fine[links[begin].a], wanted, end - begin );
    for ( int i = begin; i < end; ++i )
    {
        const int32_t last = m->fine[links[i].b];
        const int count = count_path( s, last );
        if ( reserve_vertices( out, (size_t)out->begin[i], (size_t)count, pool ) == false )
        {
            return false;
        }
        out->begin[i + 1] = out->begin[i] + count;
        out->rest[i] = (float)s->node[last].distance;
        int at = out->begin[i + 1];
        for ( int32_t v = last; v >= 0; v = s->node[v].from )
        {
            out->vertex[--at] = v;
        }
    }
    return true;
}

static bool list_chains( const level_maker* m, const level_link* links, int count, fabric_pool* scratch,
                         chain_list* out )
{
    path_search s;
    bool* wanted = fabric_pool_push_zeroed( scratch, (size_t)m->mesh->vertex_count, sizeof( bool ) );
    *out = ( chain_list ){
        .begin = fabric_pool_push_zeroed( scratch, (size_t)count + 1, sizeof( int32_t ) ),
        .rest = fabric_pool_push( scratch, (size_t)count, sizeof( float ) ),
    };
    bool done = wanted != NULL && out->begin != NULL && out->rest != NULL && search_init( &s, m->mesh, scratch ) &&
                reserve_vertices( out, 0, 8 * (size_t)count, scratch );
    for ( int begin = 0, end; begin < count && done; begin = end )
    {
        for ( end = begin + 1; end < count && links[end].a == links[begin].a; ++end )
        {
        }
        done = find_chains( m, links, begin, end, &s, wanted, scratch, out );
    }
    return done;
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
