// Links between neighbours of a coarse level, and the net of triangles over them.
#include "fabric.h"
#include "fabric_levels.h"

#include <math.h>

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

double level_distance( const level_maker* m, int32_t rank_a, int32_t rank_b )
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

// ---- links ----

// Tests whether a pair needs a link: two attachments do not, since neither moves.
static bool is_link( const level_maker* m, int32_t a, int32_t b )
{
    return m->turn[m->fine[a]] != LEVEL_ATTACHED || m->turn[m->fine[b]] != LEVEL_ATTACHED;
}

int level_list_links( const level_maker* m, int32_t* slots, float* rest, int* linked )
{
    int count = 0;
    *linked = 0;
    for ( int32_t a = 0; a < m->fine_count; ++a )
    {
        const level_near* near = m->near + (size_t)a * LEVEL_NEAR;
        bool any = false;
        for ( int i = 0; i < m->near_count[a] && m->chosen[a]; ++i )
        {
            int32_t b = near[i].rank;
            bool link = is_link( m, a, b );
            any = any || link;
            if ( b < a || link == false )
            {
                continue;
            }
            if ( slots != NULL )
            {
                slots[2 * count] = m->fine[a];
                slots[2 * count + 1] = m->fine[b];
                rest[count] = near[i].distance;
            }
            count += 1;
        }
        *linked += any ? 1 : 0;
    }
    return count;
}

// Minimum links per tile that justify a synchronisation of workers. A level with fewer than four such tiles runs on
// one worker.
#define FEWEST_TILE_LINKS 512
#define FEWEST_TILES 4

int fabric_level_tile_size( const wisp_fabric* f, int links )
{
    int64_t size = f->tile_size;
    while ( size < f->vertex_count && links * size < FEWEST_TILE_LINKS * (int64_t)f->vertex_count )
    {
        size *= 2;
    }
    bool has_tiles = fabric_tiles( f->vertex_count, (int)size ) >= FEWEST_TILES;
    return has_tiles ? (int)size : f->vertex_count;
}

bool level_make_links( const level_maker* m, int count, fabric_pool* keep, wisp_fabric_level* out )
{
    fabric_pool scratch = { .allocator = keep->allocator };
    int32_t* slots = fabric_pool_push( &scratch, 2 * (size_t)count, sizeof( int32_t ) );
    float* rest = fabric_pool_push( &scratch, (size_t)count, sizeof( float ) );
    bool done = slots != NULL && rest != NULL;
    if ( done )
    {
        int linked;
        level_list_links( m, slots, rest, &linked );
        fabric_constraints constraints = {
            .slots = slots,
            .count = count,
            .arity = 2,
            .vertex_count = m->fabric->vertex_count,
            .tile_size = fabric_level_tile_size( m->fabric, count ),
            .solve_order = WISP_SOLVE_ORDER_COLOUR,
        };
        fabric_links links;
        done = fabric_schedule_build( &constraints, keep, &out->schedule ) &&
               fabric_schedule_links( &out->schedule, &constraints, rest, keep, &links );
        if ( done )
        {
            out->link_count = count;
            out->a_x4 = links.a_x4;
            out->b_x4 = links.b_x4;
            out->rest = links.rest;
        }
    }
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
// @param node_of [fine_count]
// @param corner null to count only
static int list_corners( const level_maker* m, int32_t a, const int32_t* node_of, geodesic_corner* corner )
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
                    corner[count] = geodesic_corner_of_sides( node_of[near[i].rank], node_of[near[j].rank],
                                                              near[i].distance, near[j].distance, across );
                }
                count += 1;
            }
        }
        if ( has_triangle[i] == false )
        {
            if ( corner != NULL )
            {
                int32_t node = node_of[near[i].rank];
                corner[count] = geodesic_corner_of_sides( node, node, near[i].distance, near[i].distance, 0.0 );
            }
            count += 1;
        }
    }
    return count;
}

bool level_make_net( const level_maker* m, const int32_t* slots, int count, fabric_pool* pool, geodesic_net* out )
{
    fabric_pool scratch = { .allocator = pool->allocator };
    int32_t* node_of = fabric_pool_push( &scratch, (size_t)m->fine_count, sizeof( int32_t ) );
    int32_t* slot = fabric_pool_push( pool, (size_t)count, sizeof( int32_t ) );
    int32_t* begin = fabric_pool_push( pool, (size_t)count + 1, sizeof( int32_t ) );
    wisp_vec3* point = fabric_pool_push( pool, (size_t)count, sizeof( wisp_vec3 ) );
    geodesic_corner* corner = NULL;
    if ( node_of != NULL && slot != NULL && begin != NULL && point != NULL )
    {
        int node = 0;
        begin[0] = 0;
        for ( int32_t r = 0; r < m->fine_count; ++r )
        {
            if ( m->chosen[r] )
            {
                node_of[r] = node;
                slot[node] = slots[node];
                point[node] = m->fabric->rest[slots[node]];
                begin[node + 1] = begin[node] + list_corners( m, r, node_of, NULL );
                node += 1;
            }
        }
        corner = fabric_pool_push( pool, (size_t)begin[count], sizeof( geodesic_corner ) );
        for ( int32_t r = 0; r < m->fine_count && corner != NULL; ++r )
        {
            if ( m->chosen[r] )
            {
                list_corners( m, r, node_of, corner + begin[node_of[r]] );
            }
        }
    }
    fabric_pool_release( &scratch );
    *out = ( geodesic_net ){ .count = count, .point = point, .slot = slot, .begin = begin, .corner = corner };
    return corner != NULL;
}
