// Feedback: the sway of Park and Kim 2024, eq. 5, is integrated from the last step's place, and the group's mean is tracked.
#include "guide_internal.h"

#include <math.h>
#include <stdio.h>

enum
{
    QUADS = 8,        // floats a node in the table: such ghosts have one target and no frames
    GROUP_GRAIN = 16, // groups a block
};

// Limit that keeps sums of squares finite; no hair is that long.
static const float LARGEST_APART = 1e6f; // m

// ---- cooking ----

static size_t root_of( const wisp_strand_topology* t, int lane )
{
    return (size_t)t->group_row[lane / WISP_LANES] * GUIDE_ROW + (size_t)( lane % WISP_LANES );
}

// List members in ascending order of ghosts, so that sums do not depend on the order of lanes.
static void list_members( guide_members* m, const guide_groups* g, const int32_t* lane_of, int32_t* next )
{
    const int ghosts = g->ghosts->topology->strand_count;
    for ( int n = 0; n < g->group_count; ++n )
    {
        m->node[n] = g->groups[n].first_node;
        m->begin[n + 1] = m->begin[n] + g->groups[n].size;
        next[n] = m->begin[n];
    }
    for ( int ghost = 0; ghost < ghosts; ++ghost )
    {
        if ( g->group[ghost] >= 0 )
        {
            m->lane[next[g->group[ghost]]++] = lane_of[ghost];
        }
    }
}

// Measure V of eq. 3 at rest.
static void measure_spread( guide_members* m, const guide_groups* g )
{
    for ( int ghost = 0; ghost < g->ghosts->topology->strand_count; ++ghost )
    {
        const wisp_vec3* points = guide_strand( g->ghosts, ghost );
        for ( int i = 0; i < guide_vertices( g->ghosts, ghost ); ++i )
        {
            const int n = g->groups[g->group[ghost]].first_node + i;
            const guide_point d = guide_sub( guide_widen( points[i] ), g->nodes[n].centre );
            m->requested[n] += (double)g->def->spread * guide_dot( d, d );
        }
    }
}

bool guide_cook_members( guide_follower* f, const guide_groups* g, guide_memory* scratch )
{
    guide_members* m = &f->members;
    const size_t ghosts = (size_t)g->ghosts->topology->strand_count, groups = (size_t)g->group_count;
    const wisp_strand_topology* t = g->ghosts->topology;
    int32_t* lane_of = guide_take( scratch, ghosts, sizeof( int32_t ) );
    int32_t* next = guide_take( scratch, groups, sizeof( int32_t ) );
    m->group_count = g->group_count;
    m->begin = guide_take( &f->memory, groups + 1, sizeof( int32_t ) );
    m->node = guide_take( &f->memory, groups, sizeof( int32_t ) );
    m->lane = guide_take( &f->memory, ghosts, sizeof( int32_t ) );
    const bool is_spread = g->def->spread != 1.0f;
    m->requested = is_spread ? guide_take( &f->memory, (size_t)g->node_count, sizeof( double ) ) : NULL;
    if ( scratch->failed || f->memory.failed )
    {
        return false;
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        if ( t->lane_strand[lane] >= 0 )
        {
            lane_of[t->lane_strand[lane]] = lane;
        }
    }
    list_members( m, g, lane_of, next );
    if ( is_spread )
    {
        measure_spread( m, g );
    }
    return true;
}

// ---- a step ----

typedef struct feedback_loop
{
    wisp_frame* frame;
    wisp_entity entity;
    const guide_follower* follower;
    const wisp_strand_topology* topology;
    float *apart, *position;
} feedback_loop;

// One node of a group: shared values, input and output.
typedef struct group_node
{
    const float* xyzw;
    const int32_t* lane;
    int size, i;
    double requested; // m^2, 0: the spread is not held
    float factor;     // of the sway of all members
} group_node;

static wisp_vec3 load( const float* from )
{
    return ( wisp_vec3 ){ from[0], from[WISP_LANES], from[2 * WISP_LANES] };
}

static void store( float* to, wisp_vec3 p )
{
    to[0] = p.x;
    to[WISP_LANES] = p.y;
    to[2 * WISP_LANES] = p.z;
}

static wisp_vec3 apart_of( const feedback_loop* loop, const group_node* node, int lane )
{
    return load( loop->apart + root_of( loop->topology, lane ) + (size_t)node->i * GUIDE_ROW );
}

static float centre_weight( const feedback_loop* loop, int lane, wisp_vec3 d )
{
    return loop->follower->centre_scale[lane] * sqrtf( d.x * d.x + d.y * d.y + d.z * d.z );
}

// Factor of the sway that keeps all members within the limit and the ratios between them, as kernels have it without feedback.
static float group_factor( const feedback_loop* loop, const group_node* node )
{
    const float shared = node->xyzw[3], limit = node->xyzw[7];
    float reach = 0.0f;
    for ( int k = 0; k < node->size; ++k )
    {
        reach = fmaxf( reach, centre_weight( loop, node->lane[k], apart_of( loop, node, node->lane[k] ) ) );
    }
    const float largest = fmaxf( fabsf( shared ), fabsf( shared + reach ) );
    return largest > limit ? limit / largest : 1.0f;
}

// Eq. 5 relative to the mean of the group, which the last step set to zero.
static wisp_vec3 swayed( const feedback_loop* loop, const group_node* node, int lane )
{
    const float* q = node->xyzw;
    const wisp_vec3 d = apart_of( loop, node, lane );
    const float w = ( q[3] + centre_weight( loop, lane, d ) ) * node->factor;
    return ( wisp_vec3 ){ d.x + w * q[4], d.y + w * q[5], d.z + w * q[6] };
}

static bool is_sound( wisp_vec3 d )
{
    // NaN fails every comparison
    return fabsf( d.x ) <= LARGEST_APART && fabsf( d.y ) <= LARGEST_APART && fabsf( d.z ) <= LARGEST_APART;
}

static void halt( const feedback_loop* loop, int lane, int i )
{
    char message[200];
    snprintf( message, sizeof( message ),
              "entity %u: feedback moved ghost %d, vertex %d, more than %g m from its group; the ghosts are "
              "halted",
              loop->entity.index, loop->topology->lane_strand[lane], i, (double)LARGEST_APART );
    wisp_frame_halt( loop->frame, loop->entity, message );
}

// Mean of the members, summed in their order. @return false when a member is not finite
static bool find_mean( const feedback_loop* loop, const group_node* node, guide_point* mean )
{
    guide_point sum = { 0.0, 0.0, 0.0 };
    for ( int k = 0; k < node->size; ++k )
    {
        const wisp_vec3 d = swayed( loop, node, node->lane[k] );
        if ( is_sound( d ) == false )
        {
            halt( loop, node->lane[k], node->i );
            return false;
        }
        sum = guide_mul_add( sum, 1.0, guide_widen( d ) );
    }
    *mean = guide_mul_add( ( guide_point ){ 0.0, 0.0, 0.0 }, 1.0 / node->size, sum );
    return true;
}

// Db = X - c. @return V of eq. 3, m^2
static double project( const feedback_loop* loop, const group_node* node, guide_point mean )
{
    double spread = 0.0;
    for ( int k = 0; k < node->size; ++k )
    {
        const guide_point d = guide_sub( guide_widen( swayed( loop, node, node->lane[k] ) ), mean );
        float* to = loop->apart + root_of( loop->topology, node->lane[k] ) + (size_t)node->i * GUIDE_ROW;
        store( to, ( wisp_vec3 ){ (float)d.x, (float)d.y, (float)d.z } );
        spread += guide_dot( d, d );
    }
    return spread;
}

// Apply the spread to the output, not to the state. Coincident ghosts have no direction to spread.
static void place( const feedback_loop* loop, const group_node* node, double spread )
{
    const bool grows = node->size > 1 && spread > 0.0 && node->requested > 0.0;
    const float scale = grows ? (float)sqrt( node->requested / spread ) : 1.0f;
    for ( int k = 0; k < node->size; ++k )
    {
        const size_t at = root_of( loop->topology, node->lane[k] ) + (size_t)node->i * GUIDE_ROW;
        // the root stays on the scalp, and a lone ghost at its offset from the target
        const bool keeps = node->i == 0 || node->size == 1;
        const wisp_vec3 d = load( ( keeps ? loop->follower->offset : loop->apart ) + at );
        store( loop->position + at, ( wisp_vec3 ){ node->xyzw[0] + scale * d.x, node->xyzw[1] + scale * d.y,
                                                   node->xyzw[2] + scale * d.z } );
    }
}

static void step_node( const feedback_loop* loop, const group_node* node )
{
    guide_point mean;
    double spread = 0.0;
    if ( node->i > 0 )
    {
        if ( find_mean( loop, node, &mean ) == false )
        {
            return;
        }
        spread = project( loop, node, mean );
    }
    place( loop, node, spread );
}

// Rows beyond the tip repeat it, as without feedback.
static void fill_behind( const feedback_loop* loop, int lane )
{
    const wisp_strand_topology* t = loop->topology;
    float* root = loop->position + root_of( t, lane );
    const int rows = t->group_row[lane / WISP_LANES + 1] - t->group_row[lane / WISP_LANES];
    for ( int i = t->lane_count[lane]; i < rows; ++i )
    {
        store( root + (size_t)i * GUIDE_ROW, load( root + (size_t)( i - 1 ) * GUIDE_ROW ) );
    }
}

// One worker runs a group, which writes only the lanes of its members.
static void step_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const feedback_loop* loop = context;
    const guide_members* m = &loop->follower->members;
    for ( int n = begin; n < end; ++n )
    {
        const int32_t* lanes = m->lane + m->begin[n];
        const int size = m->begin[n + 1] - m->begin[n];
        for ( int i = 0; size > 0 && i < loop->topology->lane_count[lanes[0]]; ++i )
        {
            group_node node = { .xyzw = loop->follower->table + (size_t)( m->node[n] + i ) * QUADS,
                                .lane = lanes,
                                .size = size,
                                .i = i,
                                .requested = m->requested != NULL && i > 0 ? m->requested[m->node[n] + i] : 0.0 };
            node.factor = group_factor( loop, &node );
            step_node( loop, &node );
        }
        for ( int k = 0; k < size; ++k )
        {
            fill_behind( loop, lanes[k] );
        }
    }
}

bool guide_feedback_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)frame;
    return guide_active_follower( user, entity ) != NULL;
}

void guide_run_feedback( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    feedback_loop loop = {
        .frame = frame,
        .entity = span->entity,
        .follower = guide_active_follower( state, span->entity ),
        .topology = wisp_frame_strands( frame, span->entity ),
        .apart = wisp_frame_column( frame, span->entity, state->feedback, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), loop.follower->members.group_count, GROUP_GRAIN,
                       step_groups, &loop );
}

// ---- the first step ----

void guide_begin_feedback( wisp_world* world, const guide_state* state, const guide_follower* f )
{
    const wisp_strand_topology* t = wisp_world_strands( world, f->ghosts );
    const guide_members* m = &f->members;
    float* apart = wisp_world_column( world, f->ghosts, state->feedback, 0 );
    for ( size_t at = 0; at < (size_t)t->row_count * GUIDE_ROW; ++at )
    {
        apart[at] = 0.0f;
    }
    for ( int n = 0; n < m->group_count; ++n )
    {
        // offsets of several are measured from their mean; one alone is its mean
        const bool several = m->begin[n + 1] - m->begin[n] > 1;
        for ( int k = m->begin[n]; k < m->begin[n + 1] && several; ++k )
        {
            const size_t root = root_of( t, m->lane[k] );
            for ( int i = 0; i < t->lane_count[m->lane[k]]; ++i )
            {
                store( apart + root + (size_t)i * GUIDE_ROW, load( f->offset + root + (size_t)i * GUIDE_ROW ) );
            }
        }
    }
}
