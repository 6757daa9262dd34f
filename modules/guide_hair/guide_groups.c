// Groups of ghosts: those of the same target with the same number of vertices. Their means at rest, and the point of the target at
// each of their nodes.
#include "guide_internal.h"

#include <math.h>

// Find or add the group of a target and a node count. Without resampling group a is that of target a.
static int group_of( guide_groups* g, int target, int node_count )
{
    int last = -1;
    for ( int n = g->of_target[target]; n >= 0; n = g->groups[n].next )
    {
        if ( g->groups[n].node_count == node_count )
        {
            return n;
        }
        last = n;
    }
    const int n = g->group_count++;
    g->groups[n] =
        ( guide_group ){ .target = target, .node_count = node_count, .first_node = g->node_count, .next = -1 };
    g->node_count += node_count;
    if ( last < 0 )
    {
        g->of_target[target] = n;
    }
    else
    {
        g->groups[last].next = n;
    }
    return n;
}

static void enter_links( guide_groups* g )
{
    const int targets = g->targets->topology->strand_count, ghosts = g->ghosts->topology->strand_count;
    for ( int a = 0; a < targets; ++a )
    {
        g->of_target[a] = -1;
    }
    for ( int a = 0; a < targets && g->def->resample == false; ++a )
    {
        group_of( g, a, guide_vertices( g->targets, a ) );
    }
    for ( int n = 0; n < ghosts * g->links; ++n )
    {
        const int ghost = n / g->links;
        g->group[n] = g->target[n] >= 0 ? group_of( g, g->target[n], guide_vertices( g->ghosts, ghost ) ) : -1;
    }
}

static void add_ghost( guide_groups* g, int ghost, double* arc )
{
    guide_group* group = g->groups + g->group[(size_t)ghost * (size_t)g->links];
    const wisp_vec3* points = guide_strand( g->ghosts, ghost );
    if ( g->def->resample )
    {
        guide_arc( points, group->node_count, arc );
    }
    for ( int i = 0; i < group->node_count; ++i )
    {
        guide_node* node = g->nodes + group->first_node + i;
        const guide_point p = guide_widen( points[i] );
        node->first = group->size == 0 ? p : node->first;
        const guide_point d = guide_sub( p, node->first );
        node->sum = guide_mul_add( node->sum, 1.0, d );
        node->is_spread = node->is_spread || guide_dot( d, d ) > 0.0;
        node->arc += g->def->resample ? arc[i] : 0.0;
    }
    group->size += 1;
}

static double distance( wisp_vec3 a, wisp_vec3 b )
{
    const guide_point d = guide_sub( guide_widen( a ), guide_widen( b ) );
    return sqrt( guide_dot( d, d ) );
}

// Point of the target at a node, and the length of its segment there.
static void place_target( const guide_groups* g, const guide_group* group, int i )
{
    guide_node* node = g->nodes + group->first_node + i;
    const wisp_vec3* target = guide_strand( g->targets, group->target );
    const int count = guide_vertices( g->targets, group->target );
    int segment = i > 0 ? i - 1 : 0;
    node->rest = guide_widen( target[i < count ? i : 0] );
    if ( g->def->resample )
    {
        double arc = group->node_count > 1 ? (double)i / ( group->node_count - 1 ) : 0.0;
        arc = group->size > 0 ? node->arc / group->size : arc;
        node->stencil = guide_spline_stencil( target, count, arc );
        node->rest = guide_gather( &node->stencil, target );
        segment = node->stencil.vertex[1];
    }
    node->cap = count > 1 ? distance( target[segment + 1], target[segment] ) : 0.0;
}

static void settle_node( const guide_groups* g, const guide_group* group, int i )
{
    guide_node* node = g->nodes + group->first_node + i;
    place_target( g, group, i );
    const double fraction = group->size > 0 ? 1.0 / group->size : 0.0;
    node->centre = group->size > 0 ? guide_mul_add( node->first, fraction, node->sum ) : node->rest;
    node->anchor = group->size <= 1 ? node->rest : node->centre; // one alone keeps its offset
}

static void measure_ghost( const guide_groups* g, int ghost )
{
    guide_group* group = g->groups + g->group[(size_t)ghost * (size_t)g->links];
    const wisp_vec3* points = guide_strand( g->ghosts, ghost );
    for ( int i = 0; i < group->node_count; ++i )
    {
        guide_node* node = g->nodes + group->first_node + i;
        const guide_point d = guide_sub( guide_widen( points[i] ), node->centre );
        node->farthest = fmax( node->farthest, sqrt( guide_dot( d, d ) ) );
        group->largest = fmax( group->largest, node->farthest );
    }
}

static int longest( const guide_shape* shape )
{
    int most = 0;
    for ( int s = 0; s < shape->topology->strand_count; ++s )
    {
        const int count = guide_vertices( shape, s );
        most = count > most ? count : most;
    }
    return most;
}

bool guide_find_groups( guide_groups* g, guide_memory* scratch )
{
    const size_t targets = (size_t)g->targets->topology->strand_count;
    const size_t links = (size_t)g->ghosts->topology->strand_count * (size_t)g->links;
    g->groups = guide_take( scratch, g->def->resample ? links : targets, sizeof( guide_group ) );
    g->of_target = guide_take( scratch, targets, sizeof( int32_t ) );
    g->group = guide_take( scratch, links, sizeof( int32_t ) );
    double* arc = guide_take( scratch, (size_t)longest( g->ghosts ), sizeof( double ) );
    if ( scratch->failed )
    {
        return false;
    }
    enter_links( g );
    g->nodes = guide_take( scratch, (size_t)g->node_count, sizeof( guide_node ) );
    if ( scratch->failed )
    {
        return false;
    }
    const int ghosts = g->ghosts->topology->strand_count;
    for ( int ghost = 0; ghost < ghosts; ++ghost )
    {
        if ( guide_vertices( g->ghosts, ghost ) > 0 )
        {
            add_ghost( g, ghost, arc );
        }
    }
    for ( int n = 0; n < g->group_count; ++n )
    {
        for ( int i = 0; i < g->groups[n].node_count; ++i )
        {
            settle_node( g, g->groups + n, i );
        }
    }
    for ( int ghost = 0; ghost < ghosts; ++ghost )
    {
        if ( guide_vertices( g->ghosts, ghost ) > 0 )
        {
            measure_ghost( g, ghost );
        }
    }
    return true;
}
