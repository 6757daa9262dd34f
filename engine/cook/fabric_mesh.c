#include "fabric.h"

#include "alloc.h"

#include <math.h>
#include <string.h>

// ---- neighbours ----

// Converts counts at [v + 2] to first indices at [v + 1]. After filling the lists, [v] is the begin of the list of
// v.
static void counts_to_places( int32_t* begin, int count )
{
    for ( int v = 0; v < count; ++v )
    {
        begin[v + 2] += begin[v + 1];
    }
}

// Lists both other corners of every triangle at every vertex, so neighbours occur once per triangle.
static void list_pairs( const int32_t* triangles, int triangle_count, int32_t* begin, int32_t* pairs )
{
    for ( size_t t = 0; t < (size_t)triangle_count; ++t )
    {
        for ( int k = 0; k < 3; ++k )
        {
            int32_t* place = &begin[triangles[3 * t + (size_t)k] + 1];
            pairs[*place] = triangles[3 * t + (size_t)( ( k + 1 ) % 3 )];
            pairs[*place + 1] = triangles[3 * t + (size_t)( ( k + 2 ) % 3 )];
            *place += 2;
        }
    }
}

// Removes duplicates in place, keeping the first, and closes the gaps between lists.
static void drop_repeated( int32_t* begin, int32_t* pairs, int count, int32_t* met_at )
{
    int32_t from = 0, to = 0;
    for ( int v = 0; v < count; ++v )
    {
        int32_t end = begin[v + 1];
        begin[v] = to;
        for ( ; from < end; ++from )
        {
            if ( met_at[pairs[from]] != v + 1 )
            {
                met_at[pairs[from]] = v + 1;
                pairs[to++] = pairs[from];
            }
        }
    }
    begin[count] = to;
}

bool fabric_graph_make( fabric_pool* pool, const int32_t* triangles, int triangle_count, int vertex_count,
                        fabric_graph* out )
{
    int32_t* begin = fabric_pool_push_zeroed( pool, (size_t)vertex_count + 2, sizeof( int32_t ) );
    int32_t* pairs = fabric_pool_push( pool, 6 * (size_t)triangle_count, sizeof( int32_t ) );
    int32_t* met_at = fabric_pool_push_zeroed( pool, (size_t)vertex_count, sizeof( int32_t ) );
    if ( begin == NULL || pairs == NULL || met_at == NULL )
    {
        return false;
    }
    for ( size_t i = 0; i < 3 * (size_t)triangle_count; ++i )
    {
        begin[triangles[i] + 2] += 2;
    }
    counts_to_places( begin, vertex_count );
    list_pairs( triangles, triangle_count, begin, pairs );
    drop_repeated( begin, pairs, vertex_count, met_at );
    *out = ( fabric_graph ){ .count = vertex_count, .begin = begin, .neighbour = pairs };
    return true;
}

bool fabric_graph_relist( fabric_pool* pool, const fabric_graph* graph, const int32_t* sequence, const int32_t* name,
                          fabric_graph* out )
{
    int32_t* begin = fabric_pool_push_zeroed( pool, (size_t)graph->count + 2, sizeof( int32_t ) );
    int32_t* neighbour = fabric_pool_push( pool, (size_t)graph->begin[graph->count], sizeof( int32_t ) );
    if ( begin == NULL || neighbour == NULL )
    {
        return false;
    }
    for ( int v = 0; v < graph->count; ++v )
    {
        begin[name[v] + 2] = graph->begin[v + 1] - graph->begin[v];
    }
    counts_to_places( begin, graph->count );
    for ( int i = 0; i < graph->count; ++i )
    {
        int32_t v = sequence[i];
        for ( int32_t e = graph->begin[v]; e < graph->begin[v + 1]; ++e )
        {
            neighbour[begin[name[graph->neighbour[e]] + 1]++] = name[v];
        }
    }
    *out = ( fabric_graph ){ .count = graph->count, .begin = begin, .neighbour = neighbour };
    return true;
}

// ---- edges and hinges ----

// Triangles of an edge (a, b): the only corner whose triangle runs from a to b, and the only one from b to a.
typedef struct edge_use
{
    int32_t forward, backward; // triangle * 3 + index of the corner
} edge_use;

#define NO_CORNER ( -1 )
#define MANY_CORNERS ( -2 )

static bool list_edges( const fabric_graph* graph, fabric_pool* scratch, cook_fabric* cooked, int32_t** first_edge )
{
    wisp_fabric* f = &cooked->fabric;
    size_t count = (size_t)graph->begin[graph->count] / 2;
    int32_t* edges = fabric_pool_push( &cooked->edges, 2 * count, sizeof( int32_t ) );
    int32_t* first = fabric_pool_push( scratch, (size_t)graph->count + 1, sizeof( int32_t ) );
    if ( edges == NULL || first == NULL )
    {
        return false;
    }
    int32_t edge = 0;
    for ( int a = 0; a < graph->count; ++a )
    {
        first[a] = edge;
        for ( int32_t e = graph->begin[a]; e < graph->begin[a + 1]; ++e )
        {
            if ( graph->neighbour[e] > a )
            {
                edges[2 * (size_t)edge] = a;
                edges[2 * (size_t)edge + 1] = graph->neighbour[e];
                edge += 1;
            }
        }
    }
    first[graph->count] = edge;
    f->edge_count = edge;
    f->edges = edges;
    *first_edge = first;
    return true;
}

// Finds the edge between two neighbours; the second ends of a vertex's edges are in increasing order.
static int32_t find_edge( const int32_t* edges, const int32_t* first_edge, int32_t a, int32_t b )
{
    int32_t lower = first_edge[a], upper = first_edge[a + 1];
    while ( upper - lower > 1 )
    {
        int32_t middle = lower + ( upper - lower ) / 2;
        bool beyond = edges[2 * (size_t)middle + 1] > b;
        upper = beyond ? middle : upper;
        lower = beyond ? lower : middle;
    }
    return lower;
}

static edge_use* find_uses( const wisp_fabric* f, const int32_t* first_edge, fabric_pool* scratch )
{
    edge_use* uses = fabric_pool_push( scratch, (size_t)f->edge_count, sizeof( edge_use ) );
    for ( int e = 0; e < f->edge_count && uses != NULL; ++e )
    {
        uses[e] = ( edge_use ){ NO_CORNER, NO_CORNER };
    }
    for ( int32_t t = 0; t < f->triangle_count && uses != NULL; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        for ( int k = 0; k < 3; ++k )
        {
            int32_t from = v[k], to = v[( k + 1 ) % 3];
            bool forward = from < to;
            edge_use* use = &uses[find_edge( f->edges, first_edge, forward ? from : to, forward ? to : from )];
            int32_t* corner = forward ? &use->forward : &use->backward;
            *corner = *corner == NO_CORNER ? 3 * t + k : MANY_CORNERS;
        }
    }
    return uses;
}

// Returns the vertex of a corner's triangle that is opposite its edge.
static int32_t opposite( const wisp_fabric* f, int32_t corner )
{
    return f->triangles[3 * (size_t)( corner / 3 ) + (size_t)( ( corner % 3 + 2 ) % 3 )];
}

static bool is_hinge( edge_use use )
{
    return use.forward >= 0 && use.backward >= 0;
}

static bool list_hinges( const edge_use* uses, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        bool nonmanifold = uses[e].forward == MANY_CORNERS || uses[e].backward == MANY_CORNERS;
        f->nonmanifold_edge_count += nonmanifold ? 1 : 0;
        f->hinge_count += is_hinge( uses[e] ) ? 1 : 0;
        f->open_edge_count += nonmanifold == false && is_hinge( uses[e] ) == false ? 1 : 0;
    }
    int32_t* hinges = fabric_pool_push( &cooked->keep, 4 * (size_t)f->hinge_count, sizeof( int32_t ) );
    int32_t* next = hinges;
    for ( size_t e = 0; e < (size_t)f->edge_count && hinges != NULL; ++e )
    {
        if ( is_hinge( uses[e] ) )
        {
            next[0] = f->edges[2 * e];
            next[1] = f->edges[2 * e + 1];
            next[2] = opposite( f, uses[e].forward );
            next[3] = opposite( f, uses[e].backward );
            next += 4;
        }
    }
    f->hinges = hinges;
    return hinges != NULL;
}

bool fabric_mesh_list_corners( const wisp_fabric* f, fabric_pool* scratch, fabric_mesh* mesh )
{
    int32_t* begin = fabric_pool_push_zeroed( scratch, (size_t)f->vertex_count + 2, sizeof( int32_t ) );
    int32_t* corner = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( begin == NULL || corner == NULL )
    {
        return false;
    }
    for ( int32_t i = 0; i < 3 * f->triangle_count; ++i )
    {
        begin[f->triangles[i] + 2] += 1;
    }
    counts_to_places( begin, f->vertex_count );
    for ( int32_t i = 0; i < 3 * f->triangle_count; ++i )
    {
        corner[begin[f->triangles[i] + 1]++] = i;
    }
    mesh->corner_begin = begin;
    mesh->corner = corner;
    return true;
}

static double distance( wisp_vec3 p, wisp_vec3 q )
{
    double x = (double)p.x - (double)q.x, y = (double)p.y - (double)q.y, z = (double)p.z - (double)q.z;
    return sqrt( x * x + y * y + z * z );
}

// Computes lengths and adjacency for tethers and levels.
static bool measure_adjacency( const wisp_fabric* f, const edge_use* uses, fabric_pool* scratch, fabric_mesh* mesh )
{
    size_t neighbour_count = (size_t)mesh->neighbour_begin[f->vertex_count];
    float* length = fabric_pool_push( scratch, neighbour_count, sizeof( float ) );
    int32_t* across = fabric_pool_push( scratch, 3 * (size_t)f->triangle_count, sizeof( int32_t ) );
    if ( length == NULL || across == NULL )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        for ( int32_t e = mesh->neighbour_begin[v]; e < mesh->neighbour_begin[v + 1]; ++e )
        {
            length[e] = (float)distance( f->rest[v], f->rest[mesh->neighbour[e]] );
        }
    }
    memset( across, 0xff, 3 * (size_t)f->triangle_count * sizeof( int32_t ) );
    for ( int e = 0; e < f->edge_count; ++e )
    {
        if ( is_hinge( uses[e] ) )
        {
            across[uses[e].forward] = uses[e].backward / 3;
            across[uses[e].backward] = uses[e].forward / 3;
        }
    }
    mesh->neighbour_length = length;
    mesh->across = across;
    return true;
}

bool fabric_mesh_connect( const fabric_graph* graph, bool across, fabric_pool* scratch, cook_fabric* cooked,
                          fabric_mesh* out )
{
    wisp_fabric* f = &cooked->fabric;
    fabric_pool edges = { .allocator = scratch->allocator };
    int32_t* first_edge = NULL;
    edge_use* uses = NULL;
    *out = ( fabric_mesh ){
        .vertex_count = f->vertex_count,
        .triangle_count = f->triangle_count,
        .neighbour_begin = graph->begin,
        .neighbour = graph->neighbour,
    };
    bool done = list_edges( graph, &edges, cooked, &first_edge ) &&
                ( uses = find_uses( f, first_edge, &edges ) ) != NULL && list_hinges( uses, cooked ) &&
                fabric_mesh_list_corners( f, scratch, out ) &&
                ( across == false || measure_adjacency( f, uses, scratch, out ) );
    fabric_pool_release( &edges );
    return done;
}

// ---- areas ----

static double triangle_area( const wisp_fabric* f, int32_t triangle )
{
    const int32_t* v = f->triangles + 3 * (size_t)triangle;
    wisp_vec3 p = f->rest[v[0]], q = f->rest[v[1]], r = f->rest[v[2]];
    double ax = (double)q.x - (double)p.x, ay = (double)q.y - (double)p.y, az = (double)q.z - (double)p.z;
    double bx = (double)r.x - (double)p.x, by = (double)r.y - (double)p.y, bz = (double)r.z - (double)p.z;
    double x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
    return 0.5 * sqrt( x * x + y * y + z * z );
}

bool fabric_mesh_measure_areas( const fabric_mesh* mesh, fabric_pool* scratch, cook_fabric* cooked )
{
    wisp_fabric* f = &cooked->fabric;
    double* of_triangle = fabric_pool_push( scratch, (size_t)f->triangle_count, sizeof( double ) );
    float* area = fabric_pool_push_zeroed( &cooked->keep, (size_t)f->slot_count, sizeof( float ) );
    if ( of_triangle == NULL || area == NULL )
    {
        return false;
    }
    for ( int32_t t = 0; t < f->triangle_count; ++t )
    {
        of_triangle[t] = triangle_area( f, t );
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        double sum = 0.0;
        for ( int32_t c = mesh->corner_begin[v]; c < mesh->corner_begin[v + 1]; ++c )
        {
            sum += of_triangle[mesh->corner[c] / 3];
        }
        area[v] = (float)( sum / 3.0 );
    }
    f->area = area;
    return true;
}
