// Coarse levels. Each is a subset of the next finer one with a minimum distance between vertices, chosen greedily,
// ties in the fabric's order. A single march from every chosen vertex finds its covered vertices, its neighbours
// and its children.
#include "fabric.h"

#include "fabric_levels.h"
#include "jobs.h"

#include "wisp/module/double3.h"
#include "wisp/module/vec.h"
#include <math.h>
#include <string.h>

// ---- parents ----

// Parents of a vertex in the coarse level, and their weights. Where three coarse vertices surround it, the weights
// are barycentric coordinates in the flat triangle with the same distances. So a linear displacement of a flat mesh
// is prolonged exactly.

// Number of nearest coarse vertices among which parents are searched.
#define CANDIDATES 7
// Minimum area of a triangle relative to its squared longest side; a thinner one gives no accurate coordinates.
#define FLATTEST 0.02
// Tolerance for coordinates that are negative only by rounding.
#define EDGE_TOLERANCE 1e-4

typedef struct coarse_parents
{
    int count;
    int32_t rank[3];
    double weight[3];
} coarse_parents;

static double square( double x )
{
    return x * x;
}

static double least( const double* w )
{
    double smaller = w[0] < w[1] ? w[0] : w[1];
    return smaller < w[2] ? smaller : w[2];
}

// Computes barycentric coordinates of a point in a triangle from distances: p at the origin, q on the x axis, r
// above it.
// @param side distances pq, pr, qr
// @param away distances to p, q, r
// @param radius output, squared circumradius
// @return false if the triangle is too thin
static bool locate( const double side[3], const double away[3], double weight[3], double* radius )
{
    double c = side[0], longest = fmax( c, fmax( side[1], side[2] ) );
    if ( c <= 0.0 )
    {
        return false;
    }
    double rx = ( square( c ) + square( side[1] ) - square( side[2] ) ) / ( 2.0 * c );
    double ry = sqrt( fmax( 0.0, square( side[1] ) - square( rx ) ) );
    if ( c * ry <= FLATTEST * square( longest ) )
    {
        return false;
    }
    double x = ( square( c ) + square( away[0] ) - square( away[1] ) ) / ( 2.0 * c );
    double y = ( square( away[0] ) - square( away[2] ) + square( side[1] ) - 2.0 * x * rx ) / ( 2.0 * ry );
    weight[2] = y / ry;
    weight[1] = ( x - weight[2] * rx ) / c;
    weight[0] = 1.0 - weight[1] - weight[2];
    *radius = square( side[0] * side[1] * side[2] / ( 2.0 * c * ry ) );
    return true;
}

// Tests whether a triangle with this minimum coordinate and radius is better than the best so far. A triangle that
// surrounds the vertex is preferred, then the smaller circumcircle, as in a Delaunay triangulation. Among triangles
// that do not surround it, the larger minimum coordinate is preferred.
static bool is_better( double inside, double radius, double best_inside, double best_radius )
{
    bool surrounds = inside >= -EDGE_TOLERANCE, did = best_inside >= -EDGE_TOLERANCE;
    if ( surrounds != did )
    {
        return surrounds;
    }
    return surrounds ? radius < best_radius * ( 1.0 - EDGE_TOLERANCE ) : inside > best_inside;
}

static bool find_triangle( const level_maker* m, const level_near* near, int count, coarse_parents* out )
{
    double between[CANDIDATES][CANDIDATES];
    for ( int j = 0; j < count; ++j )
    {
        for ( int k = j + 1; k < count; ++k )
        {
            between[j][k] = level_distance_or_straight( m, near[j].rank, near[k].rank );
        }
    }
    double best_inside = -INFINITY, best_radius = INFINITY;

    // the nearest vertex is nearly always a parent; others are searched only if no triangle with it surrounds the
    // child
    for ( int i = 0; i < count && best_inside < -EDGE_TOLERANCE; ++i )
    {
        for ( int j = i + 1; j < count; ++j )
        {
            for ( int k = j + 1; k < count; ++k )
            {
                double side[3] = { between[i][j], between[i][k], between[j][k] };
                double away[3] = { near[i].distance, near[j].distance, near[k].distance };
                double w[3], radius;
                if ( locate( side, away, w, &radius ) && is_better( least( w ), radius, best_inside, best_radius ) )
                {
                    *out =
                        ( coarse_parents ){ 3, { near[i].rank, near[j].rank, near[k].rank }, { w[0], w[1], w[2] } };
                    best_inside = least( w );
                    best_radius = radius;
                }
            }
        }
    }
    return best_inside > -(double)INFINITY;
}

// Sets the weights between the two nearest vertices where there is no triangle, as in a ribbon.
static void find_pair( const level_near* near, int count, coarse_parents* out )
{
    double both = count > 1 ? (double)near[0].distance + (double)near[1].distance : 0.0;
    *out = ( coarse_parents ){ 1, { near[0].rank }, { 1.0 } };
    if ( both > 0.0 )
    {
        double fraction = (double)near[0].distance / both;
        *out = ( coarse_parents ){ 2, { near[0].rank, near[1].rank }, { 1.0 - fraction, fraction } };
    }
}

// Outside the hull, projects onto the nearest edge or vertex of the triangle.
static void clamp_weights( coarse_parents* p )
{
    double sum = 0.0;
    for ( int i = 0; i < p->count; ++i )
    {
        p->weight[i] = p->weight[i] > EDGE_TOLERANCE ? p->weight[i] : 0.0;
        sum += p->weight[i];
    }
    for ( int i = 0; i < p->count; ++i )
    {
        p->weight[i] /= sum;
    }
}

// Finds what a vertex follows: itself if it is chosen, nothing if no coarse vertex is near.
static coarse_parents find_parents( const level_maker* m, int32_t rank )
{
    const level_near* near = m->near + (size_t)rank * LEVEL_NEAR;
    const int count = m->near_count[rank] < CANDIDATES ? m->near_count[rank] : CANDIDATES;
    coarse_parents p = { .count = 0 };
    if ( m->chosen[rank] )
    {
        return ( coarse_parents ){ 1, { rank }, { 1.0 } };
    }
    if ( count > 0 )
    {
        if ( find_triangle( m, near, count, &p ) == false )
        {
            find_pair( near, count, &p );
        }
        clamp_weights( &p );
    }
    return p;
}

// Compute parents and weights of the rows of the finer level.
// @return false if out of memory
static bool level_make_parents( const level_maker* m, fabric_pool* keep, wisp_fabric_level* out )
{
    const int rows = m->finer != NULL ? m->finer->row_count : m->fabric->slot_count;
    int32_t* parent_x4 = fabric_pool_push( keep, (size_t)rows * WISP_FABRIC_PARENTS, sizeof( int32_t ) );
    float* weight = fabric_pool_push_zeroed( keep, (size_t)rows * WISP_FABRIC_PARENTS, sizeof( float ) );
    if ( parent_x4 == NULL || weight == NULL )
    {
        return false;
    }
    for ( int i = 0; i < rows * WISP_FABRIC_PARENTS; ++i )
    {
        parent_x4[i] = 4 * out->vertex_count;
    }
    for ( int32_t rank = 0; rank < m->fine_count; ++rank )
    {
        const coarse_parents p = find_parents( m, rank );
        const int32_t row = m->finer != NULL ? rank : m->fine[rank];
        size_t at = (size_t)( row / WISP_FABRIC_LANES * WISP_FABRIC_PARENTS ) * WISP_FABRIC_LANES +
                    (size_t)( row % WISP_FABRIC_LANES );
        for ( int k = 0; k < p.count; ++k, at += WISP_FABRIC_LANES )
        {
            // a parent with weight 0 repeats the first, which is in cache
            const bool gives = p.weight[k] > 0.0;
            parent_x4[at] = 4 * m->row[p.rank[gives ? k : 0]];
            weight[at] = gives ? (float)p.weight[k] : 0.0f;
        }
        out->unlinked_count += p.count == 0 ? 1 : 0;
    }
    out->finer_row_count = rows;
    out->parent_x4 = parent_x4;
    out->weight = weight;
    return true;
}

// ---- levels ----

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
// Minimum number of vertices of a mesh that justify to start a worker.
#define FEWEST_TO_SHARE 4096
#define COVERED ( 1.0 - 1e-6 )

// State of the level loop: vertices of a level become fine vertices of the next. While the links of a level are found, the vertices of
// the next are chosen.
typedef struct level_state
{
    const fabric_parts* parts;
    jobs_pool* jobs;
    level_maker makers[2]; // of level l at l % 2
    fabric_pool own[2];    // of these makers
    fabric_pool scratch;   // of all levels
    fabric_pool pools[2];  // of the current net, and of its replacement
    int pool;              // index of the pool that holds the net
    geodesic_net net;      // graph over which distances are computed
    wisp_fabric_level made[WISP_FABRIC_MAX_LEVELS];
    int chosen_count, made_count; // levels that have their vertices, and their links
    bool has_chosen;              // the last level
    bool has_ended;               // a level has no links
    bool failed[2];               // out of memory: to choose, to make
    double mean_edge;             // m, of the mesh
    double net_edge;              // m, of the net
} level_state;

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
static bool list_members( level_maker* m, fabric_pool* scratch )
{
    m->member_count = 0;
    for ( int32_t r = 0; r < m->fine_count; ++r )
    {
        m->row[r] = m->chosen[r] ? m->member_count++ : -1;
    }
    m->members = fabric_pool_push( scratch, (size_t)m->member_count, sizeof( int32_t ) );
    for ( int32_t r = 0; r < m->fine_count && m->members != NULL; ++r )
    {
        if ( m->chosen[r] )
        {
            m->members[m->row[r]] = m->fine[r];
        }
    }
    return m->members != NULL;
}

// The net of the chosen vertices replaces the previous net while that has too many nodes.
static bool replace_net( level_state* s, const level_maker* m )
{
    geodesic_net net;
    if ( level_make_net( m, &s->pools[1 - s->pool], &net ) == false )
    {
        return false;
    }
    fabric_pool_release( &s->pools[s->pool] );
    s->pool = 1 - s->pool;
    s->net = net;
    s->net_edge = NET_EDGE * m->spacing;
    return true;
}

static bool link_members( const level_maker* m, fabric_pool* keep, wisp_fabric_level* level )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    size_t room = 1;
    for ( int32_t r = 0; r < m->fine_count; ++r )
    {
        room += m->chosen[r] ? m->near_count[r] : 0;
    }
    // every pair of neighbours is in two lists, and in at most one link
    level_link* links = fabric_pool_push( &scratch, room / 2 + 1, sizeof( level_link ) );
    const bool done = links != NULL && level_make_links( m, links, level_list_links( m, links ), keep, level ) &&
                      level_make_parents( m, keep, level );
    fabric_pool_release( &scratch );
    return done;
}

// Chooses the vertices of the next level, unless it would be too small, or no smaller than the finer one.
static bool choose_next( level_state* s )
{
    const int l = s->chosen_count;
    level_maker* m = s->makers + l % 2;
    if ( l > 0 )
    {
        const level_maker* last = s->makers + ( l - 1 ) % 2;
        fabric_pool_release( s->own + l % 2 );
        *m = *last;
        m->finer = s->made + l - 1;
        m->fine = last->members;
        m->fine_count = last->member_count;
    }
    s->has_chosen = l == WISP_FABRIC_MAX_LEVELS || m->fine_count / 2 < FEWEST_VERTICES || s->mean_edge <= 0.0;
    if ( s->has_chosen )
    {
        return true;
    }
    m->spacing = SPACING_FACTOR * ldexp( s->mean_edge, l + 1 );
    m->reach = LEVEL_REACH * m->spacing;
    m->margin = MARGIN * s->net_edge;
    if ( choose_level( m, &s->net, s->own + l % 2 ) == false || list_members( m, &s->scratch ) == false )
    {
        return false;
    }
    s->has_chosen = m->member_count < FEWEST_VERTICES || m->member_count > m->fine_count / 2;
    if ( s->has_chosen )
    {
        return true;
    }
    level_agree( m );
    s->chosen_count += 1;
    return s->net.count <= NET_NODES || replace_net( s, m );
}

// Makes the links and parents of a level whose vertices are chosen.
static bool make_next( level_state* s )
{
    const level_maker* m = s->makers + s->made_count % 2;
    wisp_fabric_level* level = s->made + s->made_count;
    *level = ( wisp_fabric_level ){ .vertex_count = m->member_count };
    if ( m->finer != NULL )
    {
        level->first_row = m->finer->first_row + m->finer->row_count;
        level->first_link = m->finer->first_link + m->finer->schedule.slot_count;
    }
    if ( link_members( m, s->parts->keep, level ) == false )
    {
        return false;
    }
    s->has_ended = level->link_count == 0;
    s->made_count += s->has_ended ? 0 : 1;
    return true;
}

static void run_part( void* context, int part, int worker )
{
    (void)worker;
    level_state* s = context;
    s->failed[part] = part == 0 ? s->has_chosen == false && choose_next( s ) == false : make_next( s ) == false;
}

static void make_levels( void* context )
{
    level_state* s = context;
    run_part( s, 0, 0 );
    while ( s->made_count < s->chosen_count && s->has_ended == false && s->failed[0] == false &&
            s->failed[1] == false )
    {
        jobs_run_wave( s->jobs, WISP_COUNT( s->failed ), run_part, s );
    }
}

static double mean_edge( const wisp_fabric* f )
{
    double sum = 0.0;
    for ( int e = 0; e < f->edge_count; ++e )
    {
        sum += double3_length( double3_between( f->rest[f->edges[2 * e]], f->rest[f->edges[2 * e + 1]] ) );
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
static bool begin_levels( level_state* s )
{
    const fabric_mesh* mesh = s->parts->mesh;
    level_maker* m = s->makers;
    const wisp_fabric* f = m->fabric;
    size_t vertices = (size_t)f->vertex_count;
    m->turn = fabric_pool_push( &s->scratch, vertices, sizeof( uint8_t ) );
    wisp_vec3* normal = fabric_pool_push_zeroed( &s->scratch, vertices, sizeof( wisp_vec3 ) );
    int32_t* fine = fabric_pool_push( &s->scratch, vertices, sizeof( int32_t ) );
    if ( m->turn == NULL || normal == NULL || fine == NULL || find_turns( s->parts, f, m->turn ) == false ||
         geodesic_net_of_mesh( s->parts, f, &s->pools[0], &s->net ) == false )
    {
        return false;
    }
    for ( int v = 0; v < f->vertex_count; ++v )
    {
        if ( mesh->corner_begin[v] != mesh->corner_begin[v + 1] )
        {
            fine[m->fine_count++] = v;
        }
    }
    m->fine = fine;
    sum_normals( f, normal );
    m->normal = normal;
    return true;
}

bool fabric_cook_levels( const fabric_parts* parts, wisp_fabric* fabric )
{
    const wisp_allocator* a = parts->allocator;
    const fabric_pool empty = { .allocator = a };
    level_state state = { .parts = parts,
                          .makers = { { .fabric = fabric, .mesh = parts->mesh } },
                          .own = { empty, empty },
                          .scratch = empty,
                          .pools = { empty, empty },
                          .mean_edge = mean_edge( fabric ) };
    state.net_edge = state.mean_edge;
    state.jobs = jobs_create( a, fabric->vertex_count < FEWEST_TO_SHARE ? 1 : parts->workers, NULL, NULL );
    bool done = state.jobs != NULL && begin_levels( &state );
    if ( done )
    {
        jobs_enter( state.jobs, make_levels, &state );
        done = state.failed[0] == false && state.failed[1] == false;
    }
    jobs_destroy( state.jobs );
    for ( int i = 0; i < 2; ++i )
    {
        fabric_pool_release( state.pools + i );
        fabric_pool_release( state.own + i );
    }
    fabric_pool_release( &state.scratch );
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
