#include "fabric_geodesic.h"

#include <math.h>

// Relative tolerance at which a distance equals the straight one: float lengths have this error after a few
// roundings.
#define SETTLED 1e-6
// Minimum relative correction of a distance. Ignored corrections accumulate along a path.
#define CORRECTION 1e-7
// Maximum number of times that a node propagates its distance, including corrections. Without it, triangles around
// a node on a curved mesh could keep making smaller and smaller corrections.
#define MAX_VISITS 64

#define HEAP_ARITY 4

// ---- nets ----

typedef struct vec
{
    double x, y, z;
} vec;

static vec difference( wisp_vec3 a, wisp_vec3 b )
{
    return ( vec ){ (double)a.x - (double)b.x, (double)a.y - (double)b.y, (double)a.z - (double)b.z };
}

static double dot( vec a, vec b )
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static double length( vec a )
{
    return sqrt( dot( a, a ) );
}

static geodesic_corner corner_of_points( int32_t a, int32_t b, wisp_vec3 pv, wisp_vec3 pa, wisp_vec3 pb )
{
    vec va = difference( pa, pv ), vb = difference( pb, pv );
    vec normal = { va.y * vb.z - va.z * vb.y, va.z * vb.x - va.x * vb.z, va.x * vb.y - va.y * vb.x };
    return ( geodesic_corner ){
        .a = a,
        .b = b,
        .va = (float)length( va ),
        .vb = (float)length( vb ),
        .dot = (float)dot( va, vb ),
        .area = (float)length( normal ),
    };
}

geodesic_corner geodesic_corner_of_sides( int32_t a, int32_t b, double va, double vb, double ab )
{
    double product = 0.5 * ( va * va + vb * vb - ab * ab );
    double squared = va * va * vb * vb - product * product;
    return ( geodesic_corner ){
        .a = a,
        .b = b,
        .va = (float)va,
        .vb = (float)vb,
        .dot = (float)product,
        .area = squared > 0.0 ? (float)sqrt( squared ) : 0.0f,
    };
}

bool geodesic_net_of_mesh( const fabric_parts* parts, const wisp_fabric* fabric, fabric_pool* pool,
                           geodesic_net* out )
{
    const fabric_mesh* mesh = parts->mesh;
    size_t count = (size_t)mesh->corner_begin[mesh->vertex_count];
    geodesic_corner* corner = fabric_pool_push( pool, count, sizeof( geodesic_corner ) );
    if ( corner == NULL )
    {
        return false;
    }
    const wisp_vec3* p = fabric->rest;
    for ( int v = 0; v < mesh->vertex_count; ++v )
    {
        for ( int32_t i = mesh->corner_begin[v]; i < mesh->corner_begin[v + 1]; ++i )
        {
            int32_t place = mesh->corner[i] % 3;
            const int32_t* triangle = fabric->triangles + ( mesh->corner[i] - place );
            int32_t a = triangle[( place + 1 ) % 3], b = triangle[( place + 2 ) % 3];
            corner[i] = corner_of_points( a, b, p[v], p[a], p[b] );
        }
    }
    *out = ( geodesic_net ){
        .count = mesh->vertex_count,
        .point = fabric->rest,
        .begin = mesh->corner_begin,
        .corner = corner,
    };
    return true;
}

// ---- heap: nearest node first, ties by index; nodes store their heap position for decrease-key ----

static bool nearer( geodesic_entry a, geodesic_entry b )
{
    return a.distance < b.distance || ( a.distance == b.distance && a.node < b.node );
}

static void put( geodesic_march* m, int place, geodesic_entry entry )
{
    m->heap[place] = entry;
    m->node[entry.node].place = place;
}

static void rise( geodesic_march* m, int place, geodesic_entry entry )
{
    while ( place > 0 )
    {
        int parent = ( place - 1 ) / HEAP_ARITY;
        if ( nearer( entry, m->heap[parent] ) == false )
        {
            break;
        }
        put( m, place, m->heap[parent] );
        place = parent;
    }
    put( m, place, entry );
}

static void sink( geodesic_march* m, int place, geodesic_entry entry )
{
    for ( ;; )
    {
        int first = place * HEAP_ARITY + 1, best = first;
        int end = first + HEAP_ARITY < m->heap_count ? first + HEAP_ARITY : m->heap_count;
        for ( int child = first + 1; child < end; ++child )
        {
            best = nearer( m->heap[child], m->heap[best] ) ? child : best;
        }
        if ( first >= end || nearer( m->heap[best], entry ) == false )
        {
            break;
        }
        put( m, place, m->heap[best] );
        place = best;
    }
    put( m, place, entry );
}

static int32_t take_nearest( geodesic_march* m )
{
    int32_t nearest = m->heap[0].node;
    m->heap_count -= 1;
    if ( m->heap_count > 0 )
    {
        sink( m, 0, m->heap[m->heap_count] );
    }
    m->node[nearest].place = -1;
    m->node[nearest].visits += 1;
    return nearest;
}

// ---- fast marching ----

bool geodesic_march_init( geodesic_march* march, const geodesic_net* net, fabric_pool* pool )
{
    size_t count = (size_t)net->count;
    *march = ( geodesic_march ){
        .net = net,
        .node = fabric_pool_push_zeroed( pool, count, sizeof( geodesic_node ) ),
        .heap = fabric_pool_push( pool, count, sizeof( geodesic_entry ) ),
        .reached = fabric_pool_push( pool, count, sizeof( int32_t ) ),
    };
    return march->node != NULL && march->heap != NULL && march->reached != NULL;
}

static geodesic_node* visit( geodesic_march* m, int32_t v )
{
    geodesic_node* node = m->node + v;
    if ( node->march != m->number )
    {
        *node = ( geodesic_node ){
            .distance = INFINITY,
            .straight = length( difference( m->net->point[v], m->net->point[m->source] ) ),
            .march = m->number,
            .place = -1,
        };
    }
    return node;
}

// Tests whether a node is as near as the straight line, which no path can improve.
static bool is_settled( const geodesic_node* node )
{
    return node->distance <= node->straight * ( 1.0 + SETTLED );
}

static void offer( geodesic_march* m, int32_t v, geodesic_node* node, double distance )
{
    distance = distance > node->straight ? distance : node->straight;
    if ( distance > m->radius || ( m->bound != NULL && distance > (double)m->bound[v] ) ||
         ( distance < node->distance * ( 1.0 - CORRECTION ) ) == false )
    {
        return;
    }
    if ( node->distance == (double)INFINITY )
    {
        m->reached[m->reached_count++] = v;
    }
    node->distance = distance;
    if ( node->visits == MAX_VISITS )
    {
        return;
    }
    rise( m, node->place >= 0 ? node->place : m->heap_count++, ( geodesic_entry ){ distance, v } );
}

// Computes the distance of corner b from the source, given distances dv and da of its neighbours v and a. v is at
// the origin, a on the x axis, b above it and the source below. Infinite if the straight line to b misses the edge.
// @param va length of the edge; product, area as in geodesic_corner
static double unfold( double va, double product, double area, double dv, double da )
{
    if ( va <= 0.0 )
    {
        return INFINITY;
    }
    double scale = 1.0 / va;
    double x = 0.5 * scale * ( va * va + dv * dv - da * da );
    double squared = dv * dv - x * x;
    double y = squared > 0.0 ? sqrt( squared ) : 0.0;
    double bx = product * scale, by = area * scale;
    double height = y + by, intersection = x * by + bx * y;
    if ( height <= 0.0 || intersection < 0.0 || intersection > va * height )
    {
        return INFINITY;
    }
    return sqrt( ( bx - x ) * ( bx - x ) + height * height );
}

// Updates from a triangle. Neighbours whose distance may still decrease are skipped; they process the triangle when
// they leave the heap.
static bool has_left( const geodesic_node* node )
{
    return node->place < 0 && node->distance < (double)INFINITY;
}

static void spread_over( geodesic_march* m, double distance, const geodesic_corner* c )
{
    geodesic_node *a = visit( m, c->a ), *b = visit( m, c->b );
    bool know_a = has_left( a ), know_b = has_left( b );
    if ( is_settled( a ) == false )
    {
        offer( m, c->a, a, distance + (double)c->va );
    }
    if ( is_settled( b ) == false )
    {
        offer( m, c->b, b, distance + (double)c->vb );
    }
    if ( c->a == c->b )
    {
        return;
    }
    if ( know_a && is_settled( b ) == false )
    {
        offer( m, c->b, b, unfold( c->va, c->dot, c->area, distance, a->distance ) );
    }
    if ( know_b && is_settled( a ) == false )
    {
        offer( m, c->a, a, unfold( c->vb, c->dot, c->area, distance, b->distance ) );
    }
}

void geodesic_march_run( geodesic_march* m, int32_t source, double radius, const float* bound )
{
    m->number += 1;
    m->source = source;
    m->radius = radius;
    m->bound = bound;
    m->reached_count = 0;
    m->heap_count = 0;
    geodesic_node* start = visit( m, source );
    start->distance = 0.0;
    m->reached[m->reached_count++] = source;
    rise( m, m->heap_count++, ( geodesic_entry ){ 0.0, source } );
    while ( m->heap_count > 0 )
    {
        int32_t v = take_nearest( m );
        double distance = m->node[v].distance;
        for ( int32_t i = m->net->begin[v]; i < m->net->begin[v + 1]; ++i )
        {
            spread_over( m, distance, m->net->corner + i );
        }
    }
}

float geodesic_round_up( double distance )
{
    float rounded = (float)distance;
    return (double)rounded < distance ? nextafterf( rounded, INFINITY ) : rounded;
}
