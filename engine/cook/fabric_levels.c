// Coarse levels. Each is a subset of the next finer one with a minimum distance between vertices, chosen greedily,
// ties in the fabric's order. A single march from every chosen vertex finds its covered vertices, its neighbours
// and its children.
#include "fabric.h"
#include "fabric_levels.h"
#include "wisp/module/vec.h"

#include <math.h>
#include <string.h>

// The spacing of level l is 2^l times this number of mean edges. A regular grid with diagonals then keeps every
// second vertex, and an irregular mesh about as many.
#define SPACING_FACTOR 0.72
// Minimum number of vertices of a level. A coarser one does not resolve the motion: with 9 x 9 vertices, a hanging sheet is
// three times as far from its converged motion, whatever the number of passes.
#define FEWEST_VERTICES 150
// Margin in edges of the net by which marches exceed the reach: a triangle propagates a distance only if two
// corners have it.
#define MARGIN 0.75
// Approximate edge length of a level's net, in spacings.
#define NET_EDGE 1.3
// Maximum number of nodes of the net for marches. The finest net within it is used, or else that of the next finer
// level. Distances over a coarse net are less accurate on curved meshes.
#define NET_NODES 16384
#define COVERED ( 1.0 - 1e-6 )

// State of the level loop: vertices of a level become fine vertices of the next.
typedef struct level_state
{
    fabric_pool pools[2];   // of the current net, and of its replacement
    int pool;               // index of the pool that holds the net
    geodesic_net net;       // graph over which distances are computed
    fabric_pool members[2]; // of the current list of fine vertices, and of the next one
    wisp_fabric_level made[WISP_FABRIC_MAX_LEVELS];
    int made_count;
    double mean_edge; // m, of the mesh
    double net_edge;  // m, of the net
} level_state;

static double straight_distance( wisp_vec3 a, wisp_vec3 b )
{
    double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt( x * x + y * y + z * z );
}

// ---- selection ----

static void remember( level_maker* m, int32_t at, int32_t chosen, double distance )
{
    level_near* near = m->near + (size_t)at * LEVEL_NEAR;
    float rounded = geodesic_round_up( distance );
    int i = m->near_count[at];
    if ( i == LEVEL_NEAR )
    {
        if ( near[i - 1].distance <= rounded )
        {
            return;
        }
        i -= 1;
    }
    m->near_count[at] = (uint8_t)( i + 1 );
    for ( ; i > 0 && near[i - 1].distance > rounded; --i )
    {
        near[i] = near[i - 1];
    }
    near[i] = ( level_near ){ chosen, rounded };
}

// @param rank_of [march->net->count] -1 for nodes that are not in the finer level
static void choose( level_maker* m, int32_t rank, geodesic_march* march, const int32_t* rank_of, int32_t node )
{
    m->chosen[rank] = true;
    geodesic_march_run( march, node, m->reach + m->margin, NULL );
    for ( int i = 0; i < march->reached_count; ++i )
    {
        int32_t other = rank_of[march->reached[i]];
        double distance = march->node[march->reached[i]].distance;
        if ( other >= 0 && other != rank && distance <= m->reach )
        {
            remember( m, other, rank, distance );
            m->covered[other] = m->covered[other] || distance < COVERED * m->spacing;
        }
    }
}

static void choose_all( level_maker* m, geodesic_march* march, const int32_t* rank_of, const int32_t* node_of )
{
    for ( int turn = 0; turn < LEVEL_TURNS; ++turn )
    {
        for ( int32_t r = 0; r < m->fine_count; ++r )
        {
            if ( m->turn[m->fine[r]] == turn && m->covered[r] == false )
            {
                choose( m, r, march, rank_of, node_of[r] );
            }
        }
    }
}

static bool choose_level( level_maker* m, const geodesic_net* net, fabric_pool* scratch )
{
    fabric_pool own = { .allocator = scratch->allocator };
    size_t count = (size_t)m->fine_count;
    m->chosen = fabric_pool_push_zeroed( scratch, count, sizeof( bool ) );
    m->row = fabric_pool_push( scratch, count, sizeof( int32_t ) );
    m->covered = fabric_pool_push_zeroed( scratch, count, sizeof( bool ) );
    m->near = fabric_pool_push( scratch, count * LEVEL_NEAR, sizeof( level_near ) );
    m->near_count = fabric_pool_push_zeroed( scratch, count, sizeof( uint8_t ) );
    int32_t* rank_of = fabric_pool_push( &own, (size_t)net->count, sizeof( int32_t ) );
    int32_t* node_of = fabric_pool_push( &own, count, sizeof( int32_t ) );
    geodesic_march march;
    bool done = m->chosen != NULL && m->row != NULL && m->covered != NULL && m->near != NULL &&
                m->near_count != NULL && rank_of != NULL && node_of != NULL &&
                geodesic_march_init( &march, net, &own );
    if ( done )
    {
        int32_t rank = 0;
        for ( int32_t node = 0; node < net->count; ++node )
        {
            int32_t slot = net->slot == NULL ? node : net->slot[node];
            bool fine = rank < m->fine_count && m->fine[rank] == slot;
            rank_of[node] = fine ? rank : -1;
            if ( fine )
            {
                node_of[rank++] = node;
            }
        }
        choose_all( m, &march, rank_of, node_of );
    }
    fabric_pool_release( &own );
    return done;
}

// ---- levels ----

// Numbers the rows, and lists the slots of the chosen vertices.
static bool list_members( level_maker* m, fabric_pool* members, int32_t** chosen, int* count )
{
    *count = 0;
    for ( int32_t r = 0; r < m->fine_count; ++r )
    {
        m->row[r] = m->chosen[r] ? ( *count )++ : -1;
    }
    *chosen = fabric_pool_push( members, (size_t)*count, sizeof( int32_t ) );
    for ( int32_t r = 0; r < m->fine_count && *chosen != NULL; ++r )
    {
        if ( m->chosen[r] )
        {
            ( *chosen )[m->row[r]] = m->fine[r];
        }
    }
    return *chosen != NULL;
}

// Makes the level the fine one; its net replaces the previous net while that has too many nodes.
static bool step_up( level_state* s, level_maker* m, int32_t* chosen, int count )
{
    if ( s->net.count > NET_NODES )
    {
        geodesic_net net;
        if ( level_make_net( m, chosen, count, &s->pools[1 - s->pool], &net ) == false )
        {
            return false;
        }
        fabric_pool_release( &s->pools[s->pool] );
        s->pool = 1 - s->pool;
        s->net = net;
        s->net_edge = NET_EDGE * m->spacing;
    }
    m->fine = chosen;
    m->fine_count = count;
    return true;
}

static bool link_members( const level_maker* m, fabric_pool* keep, fabric_pool* scratch, wisp_fabric_level* level )
{
    size_t room = 1;
    for ( int32_t r = 0; r < m->fine_count; ++r )
    {
        room += m->chosen[r] ? m->near_count[r] : 0;
    }
    // every pair of neighbours is in two lists, and in at most one link
    level_link* links = fabric_pool_push( scratch, room / 2 + 1, sizeof( level_link ) );
    if ( links == NULL )
    {
        return false;
    }
    const int count = level_list_links( m, links );
    return level_make_links( m, links, count, keep, level ) && level_make_parents( m, keep, level );
}

// Builds a level.
// @param ended set if the level would be too small, no smaller than the finer one, or without links
static bool make_level( level_state* s, level_maker* m, fabric_pool* keep, fabric_pool* scratch, bool* ended )
{
    fabric_pool* members = s->members + s->made_count % 2;
    int32_t* chosen;
    int count;
    fabric_pool_release( members );
    if ( choose_level( m, &s->net, scratch ) == false || list_members( m, members, &chosen, &count ) == false )
    {
        return false;
    }
    if ( count < FEWEST_VERTICES || count > m->fine_count / 2 )
    {
        *ended = true;
        return true;
    }
    level_agree( m );
    wisp_fabric_level* level = s->made + s->made_count;
    *level = ( wisp_fabric_level ){ .vertex_count = count };
    if ( m->finer != NULL )
    {
        level->first_row = m->finer->first_row + m->finer->row_count;
        level->first_link = m->finer->first_link + m->finer->schedule.slot_count;
    }
    if ( link_members( m, keep, scratch, level ) == false )
    {
        return false;
    }
    *ended = level->link_count == 0;
    if ( *ended )
    {
        return true;
    }
    if ( step_up( s, m, chosen, count ) == false )
    {
        return false;
    }
    s->made_count += 1;
    m->finer = level;
    return true;
}

static double mean_edge( const wisp_fabric* f )
{
    double sum = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        sum += straight_distance( f->rest[f->edges[2 * e]], f->rest[f->edges[2 * e + 1]] );
    }
    return f->edge_count > 0 ? sum / f->edge_count : 0.0;
}

// Tests whether the angle between two open edges at a vertex is below about 135 degrees.
static bool is_corner( wisp_vec3 at, wisp_vec3 before, wisp_vec3 after )
{
    wisp_vec3 a = wisp_v3_sub( before, at ), b = wisp_v3_sub( after, at );
    return wisp_v3_dot( a, b ) > -0.7f * wisp_v3_length( a ) * wisp_v3_length( b );
}

// Assigns the order of selection. Attachments come first, so that a level has those that are not near another one. Corners and
// other vertices on open edges follow, so that coarse vertices surround the others.
static bool find_turns( const fabric_parts* parts, const wisp_fabric* f, uint8_t* turn )
{
    fabric_pool scratch = { .allocator = parts->allocator };
    size_t vertices = (size_t)f->vertex_count;
    int32_t* before = fabric_pool_push( &scratch, vertices, sizeof( int32_t ) );
    int32_t* after = fabric_pool_push( &scratch, vertices, sizeof( int32_t ) );
    bool done = before != NULL && after != NULL;
    if ( done )
    {
        memset( before, 0xff, vertices * sizeof( int32_t ) );
        memset( after, 0xff, vertices * sizeof( int32_t ) );
        for ( int i = 0; i < 3 * f->triangle_count; ++i )
        {
            if ( parts->mesh->across[i] < 0 )
            {
                int32_t a = f->triangles[i], b = f->triangles[i % 3 == 2 ? i - 2 : i + 1];
                after[a] = b;
                before[b] = a;
            }
        }
        for ( int v = 0; v < f->vertex_count; ++v )
        {
            bool open_edge = before[v] >= 0 && after[v] >= 0;
            bool corner = open_edge && is_corner( f->rest[v], f->rest[before[v]], f->rest[after[v]] );
            turn[v] = corner ? LEVEL_CORNER : open_edge ? LEVEL_BORDER : LEVEL_INSIDE;
        }
        for ( int i = 0; i < f->attachment_count; ++i )
        {
            turn[f->attachments[i]] = LEVEL_ATTACHED;
        }
    }
    fabric_pool_release( &scratch );
    return done;
}

// Sums the normals of the triangles at each vertex, weighted by area.
static void sum_normals( const wisp_fabric* f, wisp_vec3* normal )
{
    for ( int t = 0; t < f->triangle_count; ++t )
    {
        const int32_t* v = f->triangles + 3 * (size_t)t;
        const wisp_vec3 n =
            wisp_v3_cross( wisp_v3_sub( f->rest[v[1]], f->rest[v[0]] ), wisp_v3_sub( f->rest[v[2]], f->rest[v[0]] ) );
        for ( int k = 0; k < 3; ++k )
        {
            normal[v[k]] = wisp_v3_add( normal[v[k]], n );
        }
    }
}

// Lists all referenced vertices. Unreferenced ones cannot be reached, so no level has them.
static bool begin_levels( const fabric_parts* parts, const wisp_fabric* f, level_state* s, level_maker* m,
                          fabric_pool* scratch )
{
    size_t vertices = (size_t)f->vertex_count;
    m->turn = fabric_pool_push( scratch, vertices, sizeof( uint8_t ) );
    wisp_vec3* normal = fabric_pool_push_zeroed( scratch, vertices, sizeof( wisp_vec3 ) );
    int32_t* fine = fabric_pool_push( scratch, vertices, sizeof( int32_t ) );
    if ( m->turn == NULL || normal == NULL || fine == NULL || find_turns( parts, f, m->turn ) == false ||
         geodesic_net_of_mesh( parts, f, &s->pools[0], &s->net ) == false )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        if ( parts->mesh->corner_begin[v] != parts->mesh->corner_begin[v + 1] )
        {
            fine[m->fine_count++] = v;
        }
    }
    m->fine = fine;
    sum_normals( f, normal );
    m->normal = normal;
    return true;
}

static bool make_levels( const fabric_parts* parts, level_state* s, level_maker* m, fabric_pool* scratch )
{
    if ( begin_levels( parts, m->fabric, s, m, scratch ) == false )
    {
        return false;
    }
    bool done = true, ended = s->mean_edge <= 0.0;
    for ( int l = 1; l <= WISP_FABRIC_MAX_LEVELS && done && ended == false; ++l )
    {
        fabric_pool own = { .allocator = parts->allocator };
        m->spacing = SPACING_FACTOR * ldexp( s->mean_edge, l );
        m->reach = LEVEL_REACH * m->spacing;
        m->margin = MARGIN * s->net_edge;
        done = make_level( s, m, parts->keep, &own, &ended );
        fabric_pool_release( &own );
    }
    return done;
}

bool fabric_cook_levels( const fabric_parts* parts, wisp_fabric* fabric )
{
    const wisp_allocator* a = parts->allocator;
    fabric_pool scratch = { .allocator = a };
    level_state state = { .pools = { { .allocator = a }, { .allocator = a } },
                          .members = { { .allocator = a }, { .allocator = a } },
                          .mean_edge = mean_edge( fabric ) };
    level_maker maker = { .fabric = fabric, .mesh = parts->mesh };
    state.net_edge = state.mean_edge;
    bool done = make_levels( parts, &state, &maker, &scratch );
    for ( int i = 0; i < 2; ++i )
    {
        fabric_pool_release( state.pools + i );
        fabric_pool_release( state.members + i );
    }
    fabric_pool_release( &scratch );
    wisp_fabric_level* levels = NULL;
    if ( done )
    {
        levels = fabric_pool_push( parts->keep, (size_t)state.made_count, sizeof( wisp_fabric_level ) );
    }
    if ( levels != NULL )
    {
        memcpy( levels, state.made, (size_t)state.made_count * sizeof( wisp_fabric_level ) );
        fabric->level_count = state.made_count;
        fabric->levels = levels;
    }
    return levels != NULL;
}
