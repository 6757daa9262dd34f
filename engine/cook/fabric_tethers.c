// Tethers: geodesic distances to the attachments. A mesh component with few attachments has tethers to all, or to
// the nearest of them. Where many attachments are adjacent, as on a pinned edge, the four nearest would be nearly
// equal. Then a vertex is tethered to the nearest of all, and to the nearest of eight that are spread over the
// attachments of its component.
#include "fabric_geodesic.h"

#include "wisp/module/double3.h"

#include <math.h>
#include <string.h>

// ---- geodesics ----

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

static geodesic_corner corner_of_points( int32_t a, int32_t b, wisp_vec3 pv, wisp_vec3 pa, wisp_vec3 pb )
{
    const double3 v = double3_widen( pv ), va = double3_sub( double3_widen( pa ), v ),
                  vb = double3_sub( double3_widen( pb ), v );
    return ( geodesic_corner ){
        .a = a,
        .b = b,
        .va = (float)double3_length( va ),
        .vb = (float)double3_length( vb ),
        .dot = (float)double3_dot( va, vb ),
        .area = (float)double3_length( double3_cross( va, vb ) ),
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

// Removes the first entry. The hole goes down to the end, where the last entry nearly always belongs.
int32_t geodesic_march_next( geodesic_march* m )
{
    const int32_t nearest = m->heap[0].node;
    const int count = --m->heap_count;
    int place = 0;
    for ( int first = 1; first < count; first = place * HEAP_ARITY + 1 )
    {
        const int end = first + HEAP_ARITY < count ? first + HEAP_ARITY : count;
        int best = first;
        for ( int child = first + 1; child < end; ++child )
        {
            best = nearer( m->heap[child], m->heap[best] ) ? child : best;
        }
        put( m, place, m->heap[best] );
        place = best;
    }
    if ( count > 0 )
    {
        rise( m, place, m->heap[count] );
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

static geodesic_node* enter( geodesic_march* m, int32_t v, geodesic_node* node )
{
    *node = ( geodesic_node ){
        .distance = INFINITY,
        .straight = double3_length( double3_between( m->net->point[m->source], m->net->point[v] ) ),
        .march = m->number,
        .place = -1,
    };
    node->settled = node->straight > m->radius ? m->number : 0;
    return node;
}

static inline geodesic_node* visit( geodesic_march* m, int32_t v )
{
    geodesic_node* node = m->node + v;
    return node->march == m->number ? node : enter( m, v, node );
}

// Tests whether no path can improve a node: it is as near as the straight line, or that is beyond the radius.
static inline bool is_settled( const geodesic_march* m, const geodesic_node* node )
{
    return node->settled == m->number;
}

static void set_nearer( geodesic_march* m, int32_t v, geodesic_node* node, double distance )
{
    if ( node->distance == (double)INFINITY )
    {
        m->reached[m->reached_count++] = v;
    }
    node->distance = distance;
    node->settled = distance <= node->straight * ( 1.0 + SETTLED ) ? m->number : 0;
    if ( node->visits == MAX_VISITS )
    {
        return;
    }
    rise( m, node->place >= 0 ? node->place : m->heap_count++, ( geodesic_entry ){ distance, v } );
}

bool geodesic_march_reach( geodesic_march* m, int32_t v, double distance )
{
    geodesic_node* node = visit( m, v );
    const bool is_nearer = distance < node->distance;
    if ( is_nearer )
    {
        set_nearer( m, v, node, distance );
    }
    return is_nearer;
}

static inline void offer( geodesic_march* m, int32_t v, geodesic_node* node, double distance )
{
    distance = distance > node->straight ? distance : node->straight;
    if ( distance < node->distance * ( 1.0 - CORRECTION ) && distance <= m->radius &&
         ( m->bound == NULL || distance <= (double)m->bound[v] ) )
    {
        set_nearer( m, v, node, distance );
    }
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
    if ( is_settled( m, m->node + c->a ) && is_settled( m, m->node + c->b ) )
    {
        return;
    }
    geodesic_node *a = visit( m, c->a ), *b = visit( m, c->b );
    bool know_a = has_left( a ), know_b = has_left( b );
    if ( is_settled( m, a ) == false )
    {
        offer( m, c->a, a, distance + (double)c->va );
    }
    if ( is_settled( m, b ) == false )
    {
        offer( m, c->b, b, distance + (double)c->vb );
    }
    if ( c->a == c->b )
    {
        return;
    }
    if ( know_a && is_settled( m, b ) == false )
    {
        offer( m, c->b, b, unfold( c->va, c->dot, c->area, distance, a->distance ) );
    }
    if ( know_b && is_settled( m, a ) == false )
    {
        offer( m, c->a, a, unfold( c->vb, c->dot, c->area, distance, b->distance ) );
    }
}

void geodesic_march_begin( geodesic_march* m, int32_t source, double radius )
{
    m->number += 1;
    m->source = source;
    m->radius = radius;
    m->reached_count = m->heap_count = 0;
    set_nearer( m, source, visit( m, source ), 0.0 );
}

void geodesic_march_run( geodesic_march* m, int32_t source, double radius, const float* bound )
{
    m->bound = bound;
    geodesic_march_begin( m, source, radius );
    while ( m->heap_count > 0 )
    {
        const int32_t v = geodesic_march_next( m );
        const double distance = m->node[v].distance;
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

// ---- tethers ----

#define SPREAD 8
// Factor by which the nearest attachment must be closer than a spread one to be used. Far from a pinned open edge
// all distances are similar, and marching from each attachment would cost as much as the edge is long.
#define NEARER 0.98f

// An attachment and its distance.
typedef struct tether
{
    double distance;
    int32_t slot; // -1: none
} tether;

typedef struct tether_maker
{
    const fabric_parts* parts;
    const wisp_fabric* fabric;
    geodesic_net net;
    geodesic_march march;
    int count;              // tethers per vertex
    tether* spread;         // [vertex][count] to spread attachments, by increasing distance
    tether* nearest;        // [vertex] to the nearest of all attachments
    float* margin;          // [vertex] m, distance by which a march exceeds the last tether
    float* bound;           // [vertex] m
    int32_t* order;         // [attachment] grouped by component, spread ones first
    int32_t* component;     // [vertex]
    int32_t* component_end; // [component] end in `order`
    int component_count;
} tether_maker;

// ---- components and their attachments ----

// Numbers the components that have attachments; others have -1.
// @param queue [vertex_count]
static void label_tethered_parts( tether_maker* m, int32_t* queue )
{
    const fabric_mesh* mesh = m->parts->mesh;
    memset( m->component, 0xff, (size_t)mesh->vertex_count * sizeof( int32_t ) );
    for ( int i = 0; i < m->fabric->attachment_count; ++i )
    {
        int32_t from = m->fabric->attachments[i];
        if ( m->component[from] >= 0 )
        {
            continue;
        }
        int head = 0, end = 0;
        queue[end++] = from;
        m->component[from] = m->component_count;
        while ( head < end )
        {
            int32_t v = queue[head++];
            for ( int32_t e = mesh->neighbour_begin[v]; e < mesh->neighbour_begin[v + 1]; ++e )
            {
                int32_t u = mesh->neighbour[e];
                if ( m->component[u] < 0 )
                {
                    m->component[u] = m->component_count;
                    queue[end++] = u;
                }
            }
        }
        m->component_count += 1;
    }
}

static void gather_components( tether_maker* m )
{
    const wisp_fabric* f = m->fabric;
    memset( m->component_end, 0, (size_t)f->attachment_count * sizeof( int32_t ) );
    for ( int i = 0; i < f->attachment_count; ++i )
    {
        m->component_end[m->component[f->attachments[i]]] += 1;
    }
    for ( int s = 1; s < m->component_count; ++s )
    {
        m->component_end[s] += m->component_end[s - 1];
    }
    for ( int i = f->attachment_count - 1; i >= 0; --i )
    {
        m->order[--m->component_end[m->component[f->attachments[i]]]] = f->attachments[i];
    }
    for ( int s = 0; s < m->component_count; ++s )
    {
        m->component_end[s] = s + 1 < m->component_count ? m->component_end[s + 1] : f->attachment_count;
    }
}

static void swap( int32_t* a, int32_t* b )
{
    int32_t kept = *a;
    *a = *b;
    *b = kept;
}

// Moves spread attachments to the front (farthest-point sampling), beginning with the one farthest from the first.
// @param away [count] scratch
static void spread_out( const wisp_vec3* rest, int32_t* list, int count, double* away )
{
    for ( int i = 0; i < count; ++i )
    {
        const double3 d = double3_between( rest[list[i]], rest[list[0]] );
        away[i] = double3_dot( d, d );
    }
    for ( int front = 0; front < SPREAD; ++front )
    {
        int farthest = front;
        for ( int i = front + 1; i < count; ++i )
        {
            farthest = away[i] > away[farthest] ? i : farthest;
        }
        swap( list + front, list + farthest );
        away[farthest] = away[front];
        for ( int i = front + 1; i < count; ++i )
        {
            const double3 d = double3_between( rest[list[i]], rest[list[front]] );
            const double squared = double3_dot( d, d );
            away[i] = front == 0 || squared < away[i] ? squared : away[i];
        }
    }
}

// ---- marching ----

static void find_margins( tether_maker* m )
{
    for ( int v = 0; v < m->net.count; ++v )
    {
        float longest = 0.0f;
        for ( int32_t i = m->net.begin[v]; i < m->net.begin[v + 1]; ++i )
        {
            const geodesic_corner* c = m->net.corner + i;
            longest = fmaxf( longest, fmaxf( c->va, c->vb ) );
        }
        m->margin[v] = 2.0f * longest;
    }
}

// Returns the radius of a march. A triangle propagates a distance only if two corners have it, so a march exceeds
// the vertices that use it.
static float bound_of( const tether_maker* m, int v, const tether* last )
{
    return last->slot < 0 ? INFINITY : (float)last->distance + m->margin[v];
}

static void insert( tether* list, int count, tether t )
{
    int i = count - 1;
    if ( list[i].slot >= 0 && list[i].distance <= t.distance )
    {
        return;
    }
    for ( ; i > 0 && ( list[i - 1].slot < 0 || list[i - 1].distance > t.distance ); --i )
    {
        list[i] = list[i - 1];
    }
    list[i] = t;
}

static void march_spread( tether_maker* m, int32_t attachment )
{
    geodesic_march_run( &m->march, attachment, INFINITY, m->bound );
    for ( int i = 0; i < m->march.reached_count; ++i )
    {
        int32_t v = m->march.reached[i];
        tether* list = m->spread + (size_t)v * (size_t)m->count;
        insert( list, m->count, ( tether ){ m->march.node[v].distance, attachment } );
        m->bound[v] = bound_of( m, v, list + m->count - 1 );
    }
}

static float nearer_bound( const tether_maker* m, int v )
{
    const tether* t = m->nearest + v;
    return t->slot < 0 ? INFINITY : NEARER * (float)t->distance + 0.5f * m->margin[v];
}

static void march_nearest( tether_maker* m, int32_t attachment )
{
    geodesic_march_run( &m->march, attachment, INFINITY, m->bound );
    for ( int i = 0; i < m->march.reached_count; ++i )
    {
        int32_t v = m->march.reached[i];
        insert( m->nearest + v, 1, ( tether ){ m->march.node[v].distance, attachment } );
        m->bound[v] = nearer_bound( m, v );
    }
}

// Marches from the first attachment, the middle one, the quarters, and so on. The bounds shrink quickly, so that
// early marches do not extend far into regions of later ones.
static void march_halving( tether_maker* m, const int32_t* list, int count )
{
    int bits = 0;
    while ( ( 1 << bits ) < count )
    {
        bits += 1;
    }
    for ( int i = 0; i < 1 << bits; ++i )
    {
        int mirrored = 0;
        for ( int bit = 0; bit < bits; ++bit )
        {
            mirrored |= ( ( i >> bit ) & 1 ) << ( bits - 1 - bit );
        }
        if ( mirrored < count )
        {
            march_nearest( m, list[mirrored] );
        }
    }
}

static void march_all( tether_maker* m, double* away )
{
    for ( int v = 0; v < m->net.count; ++v )
    {
        m->bound[v] = INFINITY;
    }
    for ( int s = 0, begin = 0; s < m->component_count; begin = m->component_end[s++] )
    {
        int count = m->component_end[s] - begin;
        if ( count > SPREAD )
        {
            spread_out( m->fabric->rest, m->order + begin, count, away );
        }
        for ( int i = 0; i < count && i < SPREAD; ++i )
        {
            march_spread( m, m->order[begin + i] );
        }
    }
    for ( int v = 0; v < m->net.count; ++v )
    {
        m->nearest[v] = m->spread[(size_t)v * (size_t)m->count];
        m->bound[v] = nearer_bound( m, v );
    }
    for ( int s = 0, begin = 0; s < m->component_count; begin = m->component_end[s++] )
    {
        if ( m->component_end[s] - begin > SPREAD )
        {
            march_halving( m, m->order + begin + SPREAD, m->component_end[s] - begin - SPREAD );
        }
    }
}

// ---- result ----

static bool has( const tether* list, int count, int32_t slot )
{
    bool found = false;
    for ( int i = 0; i < count; ++i )
    {
        found = found || list[i].slot == slot;
    }
    return found;
}

static void write_tethers( tether_maker* m, int32_t* tether_x4, float* rest )
{
    size_t slots = (size_t)m->fabric->slot_count;
    for ( size_t i = 0; i < (size_t)m->count * slots; ++i )
    {
        tether_x4[i] = (int32_t)( i % slots ) * 4;
        rest[i] = 0.0f;
    }
    for ( int v = 0; v < m->net.count; ++v )
    {
        tether* list = m->spread + (size_t)v * (size_t)m->count;
        if ( has( list, m->count, m->nearest[v].slot ) == false )
        {
            list[m->count - 1].slot = -1;
            insert( list, m->count, m->nearest[v] );
        }
        for ( int k = 0; k < m->count && list[k].slot >= 0; ++k )
        {
            tether_x4[(size_t)k * slots + (size_t)v] = list[k].slot * 4;
            rest[(size_t)k * slots + (size_t)v] = geodesic_round_up( list[k].distance );
        }
    }
}

static bool make_room( tether_maker* m, fabric_pool* scratch, double** away )
{
    size_t vertices = (size_t)m->fabric->vertex_count, attachments = (size_t)m->fabric->attachment_count;
    if ( geodesic_net_of_mesh( m->parts, m->fabric, scratch, &m->net ) == false ||
         geodesic_march_init( &m->march, &m->net, scratch ) == false )
    {
        return false;
    }
    m->spread = fabric_pool_push( scratch, vertices * (size_t)m->count, sizeof( tether ) );
    m->nearest = fabric_pool_push( scratch, vertices, sizeof( tether ) );
    m->margin = fabric_pool_push( scratch, vertices, sizeof( float ) );
    m->bound = fabric_pool_push( scratch, vertices, sizeof( float ) );
    m->order = fabric_pool_push( scratch, attachments, sizeof( int32_t ) );
    m->component = fabric_pool_push( scratch, vertices, sizeof( int32_t ) );
    m->component_end = fabric_pool_push( scratch, attachments, sizeof( int32_t ) );
    *away = fabric_pool_push( scratch, attachments, sizeof( double ) );
    return m->spread != NULL && m->nearest != NULL && m->margin != NULL && m->bound != NULL && m->order != NULL &&
           m->component != NULL && m->component_end != NULL && *away != NULL;
}

static bool cook_tethers( tether_maker* m, fabric_pool* scratch, int32_t* tether_x4, float* rest )
{
    double* away;
    if ( make_room( m, scratch, &away ) == false )
    {
        return false;
    }
    for ( size_t i = 0; i < (size_t)m->net.count * (size_t)m->count; ++i )
    {
        m->spread[i] = ( tether ){ .slot = -1 };
    }
    find_margins( m );
    label_tethered_parts( m, m->march.reached ); // free until the first march
    gather_components( m );
    march_all( m, away );
    write_tethers( m, tether_x4, rest );
    return true;
}

bool fabric_cook_tethers( const fabric_parts* parts, wisp_fabric* fabric )
{
    int count =
        fabric->attachment_count < WISP_FABRIC_MAX_TETHERS ? fabric->attachment_count : WISP_FABRIC_MAX_TETHERS;
    size_t size = (size_t)count * (size_t)fabric->slot_count;
    int32_t* tether_x4 = fabric_pool_push( parts->keep, size, sizeof( int32_t ) );
    float* rest = fabric_pool_push( parts->keep, size, sizeof( float ) );
    bool done = tether_x4 != NULL && rest != NULL;
    if ( done && count > 0 )
    {
        fabric_pool scratch = { .allocator = parts->allocator };
        tether_maker maker = { .parts = parts, .fabric = fabric, .count = count };
        done = cook_tethers( &maker, &scratch, tether_x4, rest );
        fabric_pool_release( &scratch );
    }
    if ( done )
    {
        fabric->tether_count = count;
        fabric->tether_x4 = tether_x4;
        fabric->tether_rest = rest;
    }
    return done;
}
