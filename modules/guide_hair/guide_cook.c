// From groups to the input of the kernels: lanes of guides, lanes of ghosts, offsets.
#include "guide_internal.h"

#include <math.h>
#include <string.h>

// ---- groups ----

// Groups of ghosts: those of the same target with the same number of vertices. Their means at rest, and the point of the target at
// each of their nodes.

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

// @return false without memory
static bool guide_find_groups( guide_groups* g, guide_memory* scratch )
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

// ---- targets ----

// Which targets a ghost follows (Park and Kim 2024, eq. 1). The result is that of all pairs; boxes around the targets rule out most
// of them.

// Bounds of a target.
typedef struct box
{
    guide_point lower, upper;
} box;

// The nearest targets found so far, nearest first; of equals the lowest number.
typedef struct ranking
{
    double distance[WISP_MAX_GHOST_TARGETS];
    int target[WISP_MAX_GHOST_TARGETS];
    int count, links;
} ranking;

static double worst( const ranking* r )
{
    return r->count < r->links ? HUGE_VAL : r->distance[r->links - 1];
}

static void enter( ranking* r, double distance, int target )
{
    int at = r->count;
    while ( at > 0 &&
            ( distance < r->distance[at - 1] || ( distance == r->distance[at - 1] && target < r->target[at - 1] ) ) )
    {
        at -= 1;
    }
    if ( at == r->links )
    {
        return;
    }
    r->count += r->count < r->links ? 1 : 0;
    for ( int k = r->count - 1; k > at; --k )
    {
        r->distance[k] = r->distance[k - 1];
        r->target[k] = r->target[k - 1];
    }
    r->distance[at] = distance;
    r->target[at] = target;
}

// In place of fmin() and fmax(), with which gcc 12 for 64-bit ARM ends with an internal error in the loops below.
static double lesser( double a, double b )
{
    return b < a ? b : a;
}

static double greater( double a, double b )
{
    return b > a ? b : a;
}

static box box_of( const wisp_vec3* points, int count )
{
    box b = { { HUGE_VAL, HUGE_VAL, HUGE_VAL }, { -HUGE_VAL, -HUGE_VAL, -HUGE_VAL } };
    for ( int i = 0; i < count; ++i )
    {
        const guide_point p = guide_widen( points[i] );
        b.lower = ( guide_point ){ lesser( b.lower.x, p.x ), lesser( b.lower.y, p.y ), lesser( b.lower.z, p.z ) };
        b.upper = ( guide_point ){ greater( b.upper.x, p.x ), greater( b.upper.y, p.y ), greater( b.upper.z, p.z ) };
    }
    return b;
}

static double outside( double lower, double p, double upper )
{
    return p < lower ? lower - p : p > upper ? p - upper : 0.0;
}

// Whether a strand is farther from the box than `limit`, as sums of squares, with a margin for rounding.
static bool is_beyond( const box* b, const wisp_vec3* points, int count, double limit )
{
    const double enough = limit * ( 1.0 + 1e-9 );
    double sum = 0.0;
    for ( int i = 0; i < count && sum <= enough; ++i )
    {
        const guide_point p = guide_widen( points[i] );
        const guide_point d = { outside( b->lower.x, p.x, b->upper.x ), outside( b->lower.y, p.y, b->upper.y ),
                                outside( b->lower.z, p.z, b->upper.z ) };
        sum += guide_dot( d, d );
    }
    return sum > enough;
}

// Sum over the ghost's vertices of the squared distance to the nearest vertex of the target. Stops above `limit`.
static double strand_distance( const wisp_vec3* ghost, int ghost_count, const wisp_vec3* target, int target_count,
                               double limit )
{
    double sum = 0.0;
    for ( int k = 0; k < ghost_count && sum <= limit; ++k )
    {
        const guide_point p = guide_widen( ghost[k] );
        double nearest = HUGE_VAL;
        for ( int i = 0; i < target_count; ++i )
        {
            const guide_point d = guide_sub( p, guide_widen( target[i] ) );
            nearest = lesser( nearest, guide_dot( d, d ) );
        }
        sum += nearest;
    }
    return sum;
}

// The target whose root is nearest: nearly always the answer, so that boxes rule out most others.
static int nearest_root( const guide_shape* targets, wisp_vec3 root )
{
    int best = -1;
    float least = HUGE_VALF;
    for ( int a = 0; a < targets->topology->strand_count; ++a )
    {
        if ( guide_vertices( targets, a ) == 0 )
        {
            continue;
        }
        const wisp_vec3 p = *guide_strand( targets, a );
        const float x = p.x - root.x, y = p.y - root.y, z = p.z - root.z, squared = x * x + y * y + z * z;
        best = best < 0 || squared < least ? a : best;
        least = squared < least ? squared : least;
    }
    return best;
}

static ranking rank_targets( const guide_shape* ghosts, int ghost, const guide_shape* targets, const box* boxes,
                             int links )
{
    const wisp_vec3* points = guide_strand( ghosts, ghost );
    const int count = guide_vertices( ghosts, ghost ), guess = nearest_root( targets, points[0] );
    ranking r = { .links = links };
    for ( int n = -1; n < targets->topology->strand_count; ++n )
    {
        const int a = n < 0 ? guess : n, vertices = guide_vertices( targets, a );
        if ( ( n >= 0 && a == guess ) || vertices == 0 || is_beyond( boxes + a, points, count, worst( &r ) ) )
        {
            continue;
        }
        const double limit = worst( &r );
        const double distance = strand_distance( points, count, guide_strand( targets, a ), vertices, limit );
        if ( distance <= limit )
        {
            enter( &r, distance, a );
        }
    }
    return r;
}

// (1/d_k) / sum (1/d_j), scaled by the smallest distance: no overflow, and targets at distance 0 share all of it.
static void share_out( const ranking* r, double* fraction )
{
    double sum = 0.0;
    for ( int k = 0; k < r->links; ++k )
    {
        fraction[k] = r->distance[k] == r->distance[0] ? 1.0 : r->distance[0] / r->distance[k];
        sum += fraction[k];
    }
    for ( int k = 0; k < r->links; ++k )
    {
        fraction[k] /= sum;
    }
}

// Eq. 1: for every ghost the targets with the least strand distances, nearest first, and their shares. Ghosts without
// vertices have -1. @param links at most the targets that have vertices @return false without memory
static bool guide_assign( const guide_shape* ghosts, const guide_shape* targets, int links, int32_t* target,
                          double* fraction, guide_memory* scratch )
{
    const int target_count = targets->topology->strand_count;
    box* boxes = guide_take( scratch, (size_t)target_count, sizeof( box ) );
    if ( boxes == NULL )
    {
        return false;
    }
    for ( int a = 0; a < target_count; ++a )
    {
        boxes[a] = box_of( guide_strand( targets, a ), guide_vertices( targets, a ) );
    }
    for ( int g = 0; g < ghosts->topology->strand_count; ++g )
    {
        int32_t* own = target + (size_t)g * (size_t)links;
        if ( guide_vertices( ghosts, g ) == 0 )
        {
            for ( int k = 0; k < links; ++k )
            {
                own[k] = -1;
            }
            continue;
        }
        const ranking r = rank_targets( ghosts, g, targets, boxes, links );
        share_out( &r, fraction + (size_t)g * (size_t)links );
        for ( int k = 0; k < links; ++k )
        {
            own[k] = r.target[k];
        }
    }
    return true;
}

// ---- cook ----

// ---- lanes of guides ----

static int row_total( const guide_groups* g, const int32_t* order, int count )
{
    int rows = 0;
    for ( int n = 0; n < count; n += WISP_LANES )
    {
        rows += g->groups[order[n]].node_count;
    }
    return rows;
}

// Groups by falling node count, stable, as strands are cooked.
static bool sort_groups( const guide_groups* g, int32_t* order, guide_memory* scratch )
{
    int longest = 0;
    for ( int n = 0; n < g->group_count; ++n )
    {
        longest = g->groups[n].node_count > longest ? g->groups[n].node_count : longest;
    }
    int32_t* place = guide_take( scratch, (size_t)longest + 2, sizeof( int32_t ) );
    if ( place == NULL )
    {
        return false;
    }
    for ( int n = 0; n < g->group_count; ++n )
    {
        place[longest - g->groups[n].node_count + 1] += 1;
    }
    for ( int i = 0; i < longest; ++i )
    {
        place[i + 1] += place[i];
    }
    for ( int n = 0; n < g->group_count; ++n )
    {
        order[place[longest - g->groups[n].node_count]++] = n;
    }
    return true;
}

// Offset in floats of each strand in the rows of an entity.
static bool find_strands( const wisp_strand_topology* t, guide_memory* scratch, int32_t** row, int32_t** lane_of )
{
    *row = guide_take( scratch, (size_t)t->strand_count, sizeof( int32_t ) );
    *lane_of = guide_take( scratch, (size_t)t->strand_count, sizeof( int32_t ) );
    for ( int lane = 0; lane < t->group_count * WISP_LANES && scratch->failed == false; ++lane )
    {
        if ( t->lane_strand[lane] >= 0 )
        {
            ( *row )[t->lane_strand[lane]] = t->group_row[lane / WISP_LANES] * GUIDE_ROW + lane % WISP_LANES;
            ( *lane_of )[t->lane_strand[lane]] = lane;
        }
    }
    return scratch->failed == false;
}

static void cook_stencils( guide_lanes* l, const guide_groups* g, const guide_group* group, int lane, int32_t begin )
{
    const int first = l->group_row[lane / WISP_LANES];
    for ( int i = 0; i < group->node_count; ++i )
    {
        const guide_node* node = g->nodes + group->first_node + i;
        const size_t row = (size_t)( first + i );
        for ( int n = 0; n < 4; ++n )
        {
            const size_t at = ( row * 4 + (size_t)n ) * WISP_LANES + (size_t)( lane % WISP_LANES );
            l->source[at] = begin + node->stencil.vertex[n] * GUIDE_ROW;
            l->weight[at] = (float)node->stencil.weight[n];
        }
        float* rest = l->rest + row * GUIDE_ROW + lane % WISP_LANES;
        rest[0] = (float)node->rest.x;
        rest[WISP_LANES] = (float)node->rest.y;
        rest[2 * WISP_LANES] = (float)node->rest.z;
    }
}

static bool take_resampled( guide_lanes* l, guide_memory* memory )
{
    const size_t groups = (size_t)l->group_count, rows = (size_t)l->row_count;
    l->source = guide_take( memory, rows * 4 * WISP_LANES, sizeof( int32_t ) );
    l->weight = guide_take( memory, rows * 4 * WISP_LANES, sizeof( float ) );
    l->source_lane = guide_take( memory, groups * WISP_LANES, sizeof( int32_t ) );
    l->rest = guide_take( memory, rows * GUIDE_ROW, sizeof( float ) );
    l->position = guide_take( memory, rows * GUIDE_ROW, sizeof( float ) );
    l->velocity = guide_take( memory, rows * GUIDE_ROW, sizeof( float ) );
    l->before = guide_take( memory, rows * GUIDE_ROW, sizeof( float ) );
    l->root = guide_take( memory, groups * 4 * WISP_LANES, sizeof( float ) );
    return memory->failed == false;
}

// Resampled lanes: one lane per group of ghosts.
static bool lay_out_groups( guide_follower* f, const guide_groups* g, int32_t* order, guide_memory* scratch )
{
    guide_lanes* l = &f->guides;
    l->group_count = ( g->group_count + WISP_LANES - 1 ) / WISP_LANES;
    int32_t* rows = guide_take( &f->memory, (size_t)l->group_count + 1, sizeof( int32_t ) );
    int32_t* counts = guide_take( &f->memory, (size_t)l->group_count * WISP_LANES, sizeof( int32_t ) );
    int32_t *begin, *lane_of;
    if ( f->memory.failed || sort_groups( g, order, scratch ) == false ||
         find_strands( g->targets->topology, scratch, &begin, &lane_of ) == false )
    {
        return false;
    }
    l->row_count = row_total( g, order, g->group_count );
    for ( int n = 0; n < g->group_count; ++n )
    {
        counts[n] = g->groups[order[n]].node_count;
        rows[n / WISP_LANES + 1] = n % WISP_LANES == 0 ? rows[n / WISP_LANES] + counts[n] : rows[n / WISP_LANES + 1];
    }
    l->group_row = rows;
    l->lane_count = counts;
    if ( take_resampled( l, &f->memory ) == false )
    {
        return false;
    }
    for ( int lane = 0; lane < l->group_count * WISP_LANES; ++lane )
    {
        const guide_group* group = lane < g->group_count ? g->groups + order[lane] : NULL;
        l->source_lane[lane] = -1;
        if ( group != NULL )
        {
            const int from = lane_of[group->target];
            l->source_lane[lane] = from / WISP_LANES * 4 * WISP_LANES + from % WISP_LANES;
            cook_stencils( l, g, group, lane, begin[group->target] );
        }
    }
    return true;
}

// Limits of the sway, and the place of each lane in the table. Group of a lane: through `order`, or the target of the lane.
static bool cook_guides( guide_follower* f, const guide_groups* g, guide_memory* scratch )
{
    const wisp_strand_topology* t = g->targets->topology;
    guide_lanes* l = &f->guides;
    int32_t* order = guide_take( scratch, (size_t)g->group_count, sizeof( int32_t ) );
    if ( order == NULL )
    {
        return false;
    }
    if ( f->resampled == false )
    {
        l->group_count = t->group_count;
        l->row_count = t->row_count;
        l->group_row = t->group_row;
        l->lane_count = t->lane_count;
    }
    else if ( lay_out_groups( f, g, order, scratch ) == false )
    {
        return false;
    }
    l->lane_node = guide_take( &f->memory, (size_t)l->group_count * WISP_LANES, sizeof( int32_t ) );
    l->cap = guide_take( &f->memory, (size_t)l->row_count * WISP_LANES, sizeof( float ) );
    l->reach = guide_take( &f->memory, (size_t)l->row_count * WISP_LANES, sizeof( float ) );
    for ( int lane = 0; lane < l->group_count * WISP_LANES && f->memory.failed == false; ++lane )
    {
        const int n = l->lane_count[lane] == 0 ? -1 : f->resampled ? order[lane] : t->lane_strand[lane];
        if ( n >= 0 )
        {
            g->groups[n].lane = lane;
        }
        l->lane_node[lane] = ( n >= 0 ? g->groups[n].first_node : g->node_count ) * f->stride;
        for ( int i = 0; i < l->lane_count[lane]; ++i )
        {
            const size_t at =
                (size_t)( l->group_row[lane / WISP_LANES] + i ) * WISP_LANES + (size_t)lane % WISP_LANES;
            const guide_group* group = g->groups + n;
            const guide_node* node = g->nodes + group->first_node + i;
            l->cap[at] = (float)node->cap;
            if ( group->size > 1 && group->largest > 0.0 )
            {
                l->reach[at] = (float)( (double)g->def->centre_gain * node->farthest / group->largest );
            }
        }
    }
    return f->memory.failed == false;
}

// ---- lanes of ghosts ----

// Eq. 2-3: the exact projection scales offsets from the centre. Before the sway nothing else moves the ghosts of a group against
// each other, so the factor is cooked into the offsets.
static double growth( const guide_groups* g, const guide_group* own )
{
    return own->size > 1 ? sqrt( (double)g->def->spread ) : 1.0;
}

static void cook_offsets( guide_follower* f, const guide_groups* g, int lane, int ghost )
{
    const wisp_strand_topology* t = g->ghosts->topology;
    const int links = g->links, count = t->lane_count[lane];
    const int32_t* link = g->group + (size_t)ghost * (size_t)links;
    const guide_group* own = g->groups + link[0];
    const double grown = growth( g, own ) - 1.0;
    for ( int n = 0; n < ( t->group_row[lane / WISP_LANES + 1] - t->group_row[lane / WISP_LANES] ) * links; ++n )
    {
        const int row = n / links, i = row < count ? row : count - 1;
        const guide_point p = guide_widen( guide_strand( g->ghosts, ghost )[i] );
        const guide_node* node = g->nodes + g->groups[link[n % links]].first_node + i;
        guide_point o = guide_sub( p, node->anchor );
        if ( i > 0 )
        {
            o = guide_mul_add( o, grown, guide_sub( p, g->nodes[own->first_node + i].centre ) );
        }
        const size_t first = (size_t)t->group_row[lane / WISP_LANES] * (size_t)links + (size_t)n;
        float* to = f->offset + first * GUIDE_ROW + lane % WISP_LANES;
        to[0] = (float)o.x;
        to[WISP_LANES] = (float)o.y;
        to[2 * WISP_LANES] = (float)o.z;
    }
}

static void cook_lengths( guide_follower* f, const guide_groups* g, int lane, int ghost )
{
    const wisp_strand_topology* t = g->ghosts->topology;
    const wisp_vec3* points = guide_strand( g->ghosts, ghost );
    for ( int i = 1; i < t->lane_count[lane]; ++i )
    {
        const guide_point d = guide_sub( guide_widen( points[i] ), guide_widen( points[i - 1] ) );
        const size_t row = (size_t)( t->group_row[lane / WISP_LANES] + i );
        f->length[row * WISP_LANES + (size_t)( lane % WISP_LANES )] = (float)sqrt( guide_dot( d, d ) );
    }
}

static void cook_ghost( guide_follower* f, const guide_groups* g, const double* fraction, int lane )
{
    const int links = g->links, ghost = g->ghosts->topology->lane_strand[lane];
    for ( int k = 0; k < links; ++k )
    {
        const size_t at = (size_t)( lane / WISP_LANES * links + k ) * WISP_LANES + (size_t)( lane % WISP_LANES );
        const size_t link = (size_t)( ghost >= 0 ? ghost : 0 ) * (size_t)links + (size_t)k;
        f->lane_node[at] = ( ghost >= 0 ? g->groups[g->group[link]].first_node : g->node_count ) * f->stride;
        f->lane_fraction[at] = ghost >= 0 ? (float)fraction[link] : 0.0f;
    }
    if ( ghost < 0 )
    {
        return;
    }
    // offsets are scaled already, the weight belongs to the unscaled offset
    const guide_group* own = g->groups + g->group[(size_t)ghost * (size_t)links];
    const double largest = own->largest * growth( g, own );
    f->centre_scale[lane] =
        own->size > 1 && own->largest > 0.0 ? (float)( (double)g->def->centre_gain / largest ) : 0.0f;
    cook_offsets( f, g, lane, ghost );
    if ( f->length != NULL )
    {
        cook_lengths( f, g, lane, ghost );
    }
}

static bool cook_ghosts( guide_follower* f, const guide_groups* g, const double* fraction )
{
    const wisp_strand_topology* t = g->ghosts->topology;
    const size_t lanes = (size_t)t->group_count * WISP_LANES, rows = (size_t)t->row_count, links = (size_t)g->links;
    f->lane_node = guide_take( &f->memory, lanes * links, sizeof( int32_t ) );
    f->lane_fraction = guide_take( &f->memory, lanes * links, sizeof( float ) );
    f->centre_scale = guide_take( &f->memory, lanes, sizeof( float ) );
    f->offset = guide_take( &f->memory, rows * links * GUIDE_ROW, sizeof( float ) );
    f->length = g->def->repair_length ? guide_take( &f->memory, rows * WISP_LANES, sizeof( float ) ) : NULL;
    f->target = guide_take( &f->memory, (size_t)t->strand_count, sizeof( int32_t ) );
    f->table = guide_take( &f->memory, ( (size_t)g->node_count + 1 ) * (size_t)f->stride, sizeof( float ) );
    for ( int lane = 0; lane < t->group_count * WISP_LANES && f->memory.failed == false; ++lane )
    {
        cook_ghost( f, g, fraction, lane );
    }
    for ( int ghost = 0; ghost < t->strand_count && f->memory.failed == false; ++ghost )
    {
        f->target[ghost] = g->target[(size_t)ghost * links];
    }
    return f->memory.failed == false;
}

// ---- entry point ----

static wisp_status check_counts( wisp_world* world, const guide_groups* g )
{
    for ( int n = 0; n < g->ghosts->topology->strand_count * g->links && g->def->resample == false; ++n )
    {
        const int ghost = n / g->links, target = g->target[n];
        if ( target >= 0 && guide_vertices( g->ghosts, ghost ) != guide_vertices( g->targets, target ) )
        {
            return wisp_world_fail(
                world, WISP_BAD_INPUT,
                "ghosts: ghost %d: got %d vertices, but its target %d has %d; unequal numbers need "
                "`resample`",
                ghost, guide_vertices( g->ghosts, ghost ), target, guide_vertices( g->targets, target ) );
        }
    }
    return WISP_OK;
}

static int targets_with_vertices( const guide_shape* targets )
{
    int count = 0;
    for ( int a = 0; a < targets->topology->strand_count; ++a )
    {
        count += guide_vertices( targets, a ) > 0 ? 1 : 0;
    }
    return count;
}

// Offsets in floats must fit 32 bits.
static bool is_addressable( const guide_groups* g )
{
    const int64_t most = INT32_MAX / 64;
    int64_t nodes = g->targets->topology->row_count;
    for ( int n = 0; n < g->ghosts->topology->strand_count * g->links && g->def->resample; ++n )
    {
        nodes += guide_vertices( g->ghosts, n / g->links );
    }
    return nodes < most && g->targets->topology->vertex_count < most;
}

static wisp_status cook( wisp_world* world, guide_follower* f, const guide_groups* start, guide_memory* scratch )
{
    guide_groups groups = *start;
    const size_t links = (size_t)groups.ghosts->topology->strand_count * (size_t)groups.links;
    int32_t* target = guide_take( scratch, links, sizeof( int32_t ) );
    double* fraction = guide_take( scratch, links, sizeof( double ) );
    const wisp_status no_memory = WISP_NO_MEMORY;
    if ( scratch->failed ||
         guide_assign( groups.ghosts, groups.targets, groups.links, target, fraction, scratch ) == false )
    {
        return no_memory;
    }
    groups.target = target;
    WISP_TRY( check_counts( world, &groups ) );
    if ( is_addressable( &groups ) == false )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "ghosts: got %d ghosts, which need more than 2^31 numbers",
                                groups.ghosts->topology->strand_count );
    }
    if ( guide_find_groups( &groups, scratch ) == false || cook_guides( f, &groups, scratch ) == false ||
         cook_ghosts( f, &groups, fraction ) == false ||
         ( f->is_between && guide_cook_sources( f, &groups ) == false ) )
    {
        return no_memory;
    }
    return WISP_OK;
}

void guide_follower_release( void* memory, const wisp_allocator* allocator )
{
    guide_follower* follower = memory;
    if ( follower != NULL )
    {
        guide_give_back( &follower->memory );
        allocator->release( allocator->user, follower, sizeof( *follower ) );
    }
}

wisp_status guide_cook( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* def, guide_follower** out )
{
    const wisp_allocator* allocator = wisp_world_allocator( world );
    guide_memory scratch = { .allocator = allocator };
    guide_shape ghost_shape, target_shape;
    guide_follower* f = allocator->allocate( allocator->user, sizeof( *f ), 64 );
    wisp_status status = WISP_NO_MEMORY;
    if ( f != NULL && guide_read_shape( world, ghosts, &scratch, &ghost_shape ) &&
         guide_read_shape( world, def->targets, &scratch, &target_shape ) )
    {
        const int with_vertices = targets_with_vertices( &target_shape );
        const int links = def->target_count < with_vertices ? def->target_count : with_vertices;
        *f = ( guide_follower ){
            .memory = { .allocator = allocator },
            .ghosts = ghosts,
            .targets = def->targets,
            .link_count = links,
            .stride = links > 1 ? 16 : 12,
            .resampled = def->resample,
            .is_between = def->between,
        };
        const guide_groups groups = { .ghosts = &ghost_shape, .targets = &target_shape, .def = def, .links = links };
        status = cook( world, f, &groups, &scratch );
    }
    else if ( f != NULL )
    {
        *f = ( guide_follower ){ .memory = { .allocator = allocator } };
    }
    guide_give_back( &scratch );
    if ( status != WISP_OK )
    {
        guide_follower_release( f, allocator );
        f = NULL;
    }
    *out = f;
    return status == WISP_NO_MEMORY ? wisp_world_fail( world, status, "out of memory to cook ghosts" ) : status;
}
