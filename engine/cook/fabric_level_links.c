// Links between neighbours of a coarse level, and the net of triangles over them.
#include "fabric.h"

#include "fabric_levels.h"

#include "wisp/module/double3.h"
#include "wisp/module/vec.h"
#include <math.h>
#include <string.h>

// ---- chains ----

// Chains of mesh edges along the links of a coarse level. How much a chain is shorter than at rest tells how much the cloth
// between the ends of a link is compressed: wrinkles bring the ends together and leave the chain as long as it was.

// The paths from one vertex, by Dijkstra's algorithm over the edges of the mesh.
typedef struct path_search
{
    const fabric_mesh* mesh;
    geodesic_net net; // of vertices alone
    geodesic_march march;
    int32_t* from; // [vertex_count] vertex before each on the path
} path_search;

static bool search_init( path_search* s, const level_maker* m, fabric_pool* pool )
{
    s->mesh = m->mesh;
    s->net = ( geodesic_net ){ .count = m->mesh->vertex_count, .point = m->fabric->rest };
    s->from = fabric_pool_push( pool, (size_t)s->net.count, sizeof( int32_t ) );
    return s->from != NULL && geodesic_march_init( &s->march, &s->net, pool );
}

// Searches until all wanted vertices have their final path.
// @param wanted [vertex_count] emptied
static void search_paths( path_search* s, int32_t source, bool* wanted, int wanted_count )
{
    const fabric_mesh* mesh = s->mesh;
    geodesic_march_begin( &s->march, source, INFINITY );
    s->from[source] = -1;
    while ( s->march.heap_count > 0 && wanted_count > 0 )
    {
        const int32_t vertex = geodesic_march_next( &s->march );
        const double distance = s->march.node[vertex].distance;
        wanted_count -= wanted[vertex] ? 1 : 0;
        wanted[vertex] = false;
        for ( int32_t n = mesh->neighbour_begin[vertex]; n < mesh->neighbour_begin[vertex + 1]; ++n )
        {
            if ( geodesic_march_reach( &s->march, mesh->neighbour[n], distance + (double)mesh->neighbour_length[n] ) )
            {
                s->from[mesh->neighbour[n]] = vertex;
            }
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
    for ( int32_t v = end; v >= 0; v = s->from[v] )
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
        out->rest[i] = (float)s->march.node[last].distance;
        int at = out->begin[i + 1];
        for ( int32_t v = last; v >= 0; v = s->from[v] )
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
    bool done = wanted != NULL && out->begin != NULL && out->rest != NULL && search_init( &s, m, scratch ) &&
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

// Find the chains of mesh edges along the scheduled links.
// @return false if out of memory
static bool level_make_chains( const level_maker* m, const level_link* links, fabric_pool* keep,
                               wisp_fabric_level* out )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    chain_list chains;
    const bool done = list_chains( m, links, out->link_count, &scratch, &chains ) &&
                      group_chains( &chains, 4 * m->fabric->vertex_count, keep, out );
    fabric_pool_release( &scratch );
    return done;
}

// ---- links ----

// Maximum circumradius of a triangle of the net, in spacings.
#define LARGEST_CIRCLE 1.5

static level_near* find( const level_maker* m, int32_t at, int32_t to )
{
    level_near* near = m->near + (size_t)at * LEVEL_NEAR;
    for ( int i = 0; i < m->near_count[at]; ++i )
    {
        if ( near[i].rank == to )
        {
            return near + i;
        }
    }
    return NULL;
}

// Return the distance between two chosen neighbours, infinite if they are not neighbours.
static double level_distance( const level_maker* m, int32_t rank_a, int32_t rank_b )
{
    const level_near* found = find( m, rank_a, rank_b );
    return found != NULL ? (double)found->distance : (double)INFINITY;
}

static void mark_mutual( level_maker* m, int32_t a )
{
    level_near* near = m->near + (size_t)a * LEVEL_NEAR;
    for ( int i = 0; i < m->near_count[a]; ++i )
    {
        level_near* back = find( m, near[i].rank, a );
        if ( back == NULL )
        {
            near[i].distance = INFINITY;
        }
        else if ( back->distance < near[i].distance )
        {
            near[i].distance = back->distance;
        }
        else
        {
            back->distance = near[i].distance;
        }
    }
}

static void remove_one_sided( level_maker* m, int32_t a )
{
    level_near* near = m->near + (size_t)a * LEVEL_NEAR;
    int count = 0;
    for ( int i = 0; i < m->near_count[a]; ++i )
    {
        if ( near[i].distance < INFINITY )
        {
            near[count++] = near[i];
        }
    }
    m->near_count[a] = (uint8_t)count;
}

void level_agree( level_maker* m )
{
    for ( int pass = 0; pass < 2; ++pass )
    {
        for ( int32_t a = 0; a < m->fine_count; ++a )
        {
            if ( m->chosen[a] && pass == 0 )
            {
                mark_mutual( m, a );
            }
            else if ( m->chosen[a] )
            {
                remove_one_sided( m, a );
            }
        }
    }
}

double level_distance_or_straight( const level_maker* m, int32_t rank_a, int32_t rank_b )
{
    const double distance = level_distance( m, rank_a, rank_b );
    const wisp_vec3* rest = m->fabric->rest;
    return distance < (double)INFINITY
               ? distance
               : double3_length( double3_between( rest[m->fine[rank_a]], rest[m->fine[rank_b]] ) );
}

// ---- links ----

// Half width of the range, in lengths of the link, within which a link turns from none to a whole one while its circle closes.
#define BLEND 0.2
// Minimum fraction of a link that is worth its time.
#define MIN_FRACTION 0.05

// The gap of a link: with a at the origin and b at (d, 0), circles through both have their centre at (d/2, t). The circle
// contains a point (x, y) unless t <= h for y > 0, or t >= h for y < 0, with h = (x^2 - x d + y^2) / (2 y). A Delaunay edge has
// an empty circle, so that the highest lower bound is below the lowest upper bound. Distances are those on the mesh.
typedef struct empty_circle
{
    double low, high;
} empty_circle;

static void exclude_point( empty_circle* circle, double d, double to_a, double to_b, bool left )
{
    const double x = ( d * d + to_a * to_a - to_b * to_b ) / ( 2.0 * d );
    const double y = sqrt( fmax( to_a * to_a - x * x, 0.0 ) );
    const double power = x * x - x * d + y * y;
    if ( y > 1e-6 * d )
    {
        const double h = power / ( 2.0 * y );
        circle->high = left ? fmin( circle->high, h ) : circle->high;
        circle->low = left ? circle->low : fmax( circle->low, -h );
    }
    else if ( power < 0.0 ) // between a and b
    {
        circle->high = -INFINITY;
    }
}

// Returns the fraction of a link. Of the two diagonals of a square, each has half of the stiffness: with one of them alone, chosen
// in one direction, a sheet would be soft in the other.
static double fraction_of( const level_maker* m, int32_t a, int32_t b, double d )
{
    const wisp_vec3* rest = m->fabric->rest;
    const wisp_vec3 at = rest[m->fine[a]], along = wisp_v3_sub( rest[m->fine[b]], at );
    const wisp_vec3 side = wisp_v3_cross( m->normal[m->fine[a]], along );
    empty_circle circle = { -INFINITY, INFINITY };
    for ( int end = 0; end < 2; ++end )
    {
        const int32_t from = end == 0 ? a : b, to = end == 0 ? b : a;
        const level_near* near = m->near + (size_t)from * LEVEL_NEAR;
        for ( int i = 0; i < m->near_count[from]; ++i )
        {
            const int32_t c = near[i].rank;
            if ( c != to )
            {
                const double here = (double)near[i].distance, there = level_distance_or_straight( m, to, c );
                const bool left = wisp_v3_dot( wisp_v3_sub( rest[m->fine[c]], at ), side ) > 0.0f;
                exclude_point( &circle, d, end == 0 ? here : there, end == 0 ? there : here, left );
            }
        }
    }
    const double gap = ( circle.high - circle.low ) / d;
    return fmin( 1.0, fmax( 0.0, 0.5 + 0.5 * gap / BLEND ) );
}

int level_list_links( const level_maker* m, level_link* out )
{
    int count = 0;
    for ( int32_t a = 0; a < m->fine_count; ++a )
    {
        const level_near* near = m->near + (size_t)a * LEVEL_NEAR;
        for ( int i = 0; i < m->near_count[a] && m->chosen[a]; ++i )
        {
            const int32_t b = near[i].rank;
            const double d = (double)near[i].distance;
            const double fraction = b > a && d > 0.0 ? fraction_of( m, a, b, d ) : 0.0;
            if ( fraction >= MIN_FRACTION )
            {
                out[count++] = ( level_link ){ a, b, near[i].distance, (float)fraction };
            }
        }
    }
    return count;
}

// Minimum links per tile that justify a synchronisation of workers. A level with fewer than four such tiles runs on
// one worker.
#define FEWEST_TILE_LINKS 512
#define FEWEST_TILES 4

static int choose_tile_size( int rows, int links )
{
    int tiles = links / FEWEST_TILE_LINKS;
    return tiles < FEWEST_TILES ? fabric_padded( rows ) : fabric_padded( ( rows + tiles - 1 ) / tiles );
}

static bool schedule_level_links( const level_maker* m, const level_link* links, int count, fabric_pool* scratch,
                                  fabric_pool* keep, wisp_fabric_level* out )
{
    int32_t* rows = fabric_pool_push( scratch, 2 * (size_t)count, sizeof( int32_t ) );
    float* rest = fabric_pool_push( scratch, (size_t)count, sizeof( float ) );
    if ( rows == NULL || rest == NULL )
    {
        return false;
    }
    for ( int i = 0; i < count; ++i )
    {
        rows[2 * i] = m->row[links[i].a];
        rows[2 * i + 1] = m->row[links[i].b];
        rest[i] = links[i].rest;
    }
    const fabric_constraints constraints = {
        .slots = rows,
        .count = count,
        .arity = 2,
        .vertex_count = out->vertex_count,
        .tile_size = out->tile_size,
        .solve_order = WISP_SOLVE_ORDER_COLOUR,
    };
    fabric_links lanes;
    if ( fabric_schedule_build( &constraints, keep, keep, &out->schedule ) == false ||
         fabric_schedule_links( &out->schedule, &constraints, rest, keep, &lanes ) == false )
    {
        return false;
    }
    float* fraction = fabric_pool_push_zeroed( keep, (size_t)out->schedule.slot_count, sizeof( float ) );
    double sum = 0.0;
    for ( int i = 0; i < out->schedule.slot_count && fraction != NULL; ++i )
    {
        const int32_t link = out->schedule.constraint[i];
        fraction[i] = link >= 0 ? links[link].fraction : 0.0f;
        sum += (double)lanes.rest[i];
    }
    out->mean_rest = (float)( sum / (double)count );
    out->link_count = count;
    out->a_x4 = lanes.a_x4;
    out->b_x4 = lanes.b_x4;
    out->rest = lanes.rest;
    out->fraction = fraction;
    return fraction != NULL;
}

// Lists the slots of the rows: those of the chosen vertices, in their order.
static bool list_rows( const level_maker* m, int link_count, fabric_pool* keep, wisp_fabric_level* out )
{
    out->tile_size = choose_tile_size( out->vertex_count, link_count );
    out->row_count = fabric_padded( out->vertex_count + fabric_tiles( out->vertex_count, out->tile_size ) );
    int32_t* slot_x4 = fabric_pool_push( keep, (size_t)out->row_count, sizeof( int32_t ) );
    for ( int32_t r = 0; r < m->fine_count && slot_x4 != NULL; ++r )
    {
        if ( m->chosen[r] )
        {
            slot_x4[m->row[r]] = 4 * m->fine[r];
        }
    }
    for ( int row = out->vertex_count; row < out->row_count && slot_x4 != NULL; ++row )
    {
        slot_x4[row] = 4 * m->fabric->vertex_count;
    }
    out->slot_x4 = slot_x4;
    return slot_x4 != NULL;
}

bool level_make_links( const level_maker* m, const level_link* links, int count, fabric_pool* keep,
                       wisp_fabric_level* out )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    const bool done = list_rows( m, count, keep, out ) &&
                      schedule_level_links( m, links, count, &scratch, keep, out ) &&
                      level_make_chains( m, links, keep, out );
    fabric_pool_release( &scratch );
    return done;
}

// ---- net of a level ----

// Tests whether the circumradius of a triangle is little more than the spacing. All Delaunay triangles pass, except
// some at open edges. Larger triangles cost time, and cut through a curved mesh.
static bool is_compact( double a, double b, double c, double spacing )
{
    double half = 0.5 * ( a + b + c );
    double squared_area = half * ( half - a ) * ( half - b ) * ( half - c );
    return a * a * b * b * c * c <= 16.0 * squared_area * LARGEST_CIRCLE * LARGEST_CIRCLE * spacing * spacing;
}

// Lists corners of a chosen vertex: every compact triangle of mutual neighbours, and edges without one. Triangles
// may overlap, since any path over them is a path on the mesh.
// @param corner null to count only
static int list_corners( const level_maker* m, int32_t a, geodesic_corner* corner )
{
    const level_near* near = m->near + (size_t)a * LEVEL_NEAR;
    bool has_triangle[LEVEL_NEAR] = { false };
    int count = 0, near_count = m->near_count[a];
    for ( int i = 0; i < near_count; ++i )
    {
        for ( int j = i + 1; j < near_count; ++j )
        {
            double across = level_distance( m, near[i].rank, near[j].rank );
            if ( across < (double)INFINITY && is_compact( near[i].distance, near[j].distance, across, m->spacing ) )
            {
                has_triangle[i] = has_triangle[j] = true;
                if ( corner != NULL )
                {
                    corner[count] = geodesic_corner_of_sides( m->row[near[i].rank], m->row[near[j].rank],
                                                              near[i].distance, near[j].distance, across );
                }
                count += 1;
            }
        }
        if ( has_triangle[i] == false )
        {
            if ( corner != NULL )
            {
                int32_t node = m->row[near[i].rank];
                corner[count] = geodesic_corner_of_sides( node, node, near[i].distance, near[i].distance, 0.0 );
            }
            count += 1;
        }
    }
    return count;
}

bool level_make_net( const level_maker* m, fabric_pool* pool, geodesic_net* out )
{
    const int count = m->member_count;
    int32_t* begin = fabric_pool_push( pool, (size_t)count + 1, sizeof( int32_t ) );
    wisp_vec3* point = fabric_pool_push( pool, (size_t)count, sizeof( wisp_vec3 ) );
    geodesic_corner* corner = NULL;
    if ( begin != NULL && point != NULL )
    {
        begin[0] = 0;
        for ( int32_t r = 0; r < m->fine_count; ++r )
        {
            const int node = m->row[r];
            if ( node >= 0 )
            {
                point[node] = m->fabric->rest[m->members[node]];
                begin[node + 1] = begin[node] + list_corners( m, r, NULL );
            }
        }
        corner = fabric_pool_push( pool, (size_t)begin[count], sizeof( geodesic_corner ) );
        for ( int32_t r = 0; r < m->fine_count && corner != NULL; ++r )
        {
            if ( m->chosen[r] )
            {
                list_corners( m, r, corner + begin[m->row[r]] );
            }
        }
    }
    *out = ( geodesic_net ){ .count = count, .point = point, .slot = m->members, .begin = begin, .corner = corner };
    return corner != NULL;
}
