// The ghosts of a head of hair: creation, and one step in the order of the specification.
#include "guide_oracle.h"

#include "oracle_check.h"

#include <stdlib.h>
#include <string.h>

static const double3 zero = { 0.0, 0.0, 0.0 };

guide_oracle_options guide_oracle_default_options( void )
{
    return ( guide_oracle_options ){
        .link_count = 1,
        .keep_offset = true,
        .dt = 1.0 / 60.0,
        .tau = 1.0 / 60.0,
        .elastic_gain = 1.0,
        .tip_gain = 0.5,
        .centre_gain = 0.5,
        .spread = 1.0,
        .cap_offset = true,
        .spread_exact = true,
    };
}

// Creation.

static size_t at( int strand, int node_count, int node )
{
    return (size_t)strand * (size_t)node_count + (size_t)node;
}

static void* zeroed( size_t count, size_t size, bool* complete )
{
    void* block = calloc( count + 1, size );
    *complete = *complete && block != NULL;
    return block;
}

static bool allocate( guide_oracle* hair )
{
    size_t targets = (size_t)hair->target_count, ghosts = (size_t)hair->ghost_count;
    size_t paired = targets * (size_t)hair->node_count, nodes = ghosts * (size_t)hair->node_count;
    size_t links = ghosts * (size_t)hair->options.link_count;
    bool complete = true;
    hair->link = zeroed( links, sizeof( int ), &complete );
    hair->link_weight = zeroed( links, sizeof( double ), &complete );
    hair->group_size = zeroed( targets, sizeof( int ), &complete );
    hair->largest = zeroed( targets, sizeof( double ), &complete );
    hair->rest_spread = zeroed( paired, sizeof( double ), &complete );
    hair->centre = zeroed( paired, sizeof( double3 ), &complete );
    hair->anchor = zeroed( paired, sizeof( double3 ), &complete );
    hair->rest = zeroed( paired, sizeof( double3 ), &complete );
    hair->segment = zeroed( paired, sizeof( double ), &complete );
    hair->ghost_segment = zeroed( nodes, sizeof( double ), &complete );
    hair->offset = zeroed( links * (size_t)hair->node_count, sizeof( double3 ), &complete );
    hair->x = zeroed( paired, sizeof( double3 ), &complete );
    hair->v = zeroed( paired, sizeof( double3 ), &complete );
    hair->v0 = zeroed( paired, sizeof( double3 ), &complete );
    hair->b = zeroed( nodes, sizeof( double3 ), &complete );
    hair->y = zeroed( nodes, sizeof( double3 ), &complete );
    hair->elastic_weight = zeroed( nodes, sizeof( double ), &complete );
    hair->centre_weight = zeroed( nodes, sizeof( double ), &complete );
    hair->scratch = zeroed( ghosts, sizeof( double3 ), &complete );
    hair->stencil = zeroed( paired, sizeof( guide_oracle_stencil ), &complete );
    hair->rotation = zeroed( paired, sizeof( guide_oracle_rotation ), &complete );
    return complete;
}

void guide_oracle_destroy( guide_oracle* hair )
{
    void* const arrays[] = {
        hair->link,
        hair->link_weight,
        hair->group_size,
        hair->largest,
        hair->rest_spread,
        hair->centre,
        hair->anchor,
        hair->rest,
        hair->segment,
        hair->offset,
        hair->x,
        hair->v,
        hair->ghost_segment,
        hair->elastic_weight,
        hair->centre_weight,
        hair->v0,
        hair->b,
        hair->y,
        hair->scratch,
        hair->stencil,
        hair->rotation,
    };
    for ( size_t n = 0; n < sizeof( arrays ) / sizeof( arrays[0] ); ++n )
    {
        free( arrays[n] );
    }
    *hair = ( guide_oracle ){ 0 };
}

static int group_of( const guide_oracle* hair, int ghost )
{
    return hair->link[at( ghost, hair->options.link_count, 0 )];
}

// Copy one node of all ghosts of a group into the scratch buffer, in ascending order of ghosts.
static int collect( guide_oracle* hair, const double3* ghosts, int group, int node )
{
    int count = 0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( group_of( hair, g ) == group )
        {
            hair->scratch[count++] = ghosts[at( g, hair->node_count, node )];
        }
    }
    return count;
}

static void hand_back( guide_oracle* hair, double3* ghosts, int group, int node )
{
    int count = 0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( group_of( hair, g ) == group )
        {
            ghosts[at( g, hair->node_count, node )] = hair->scratch[count++];
        }
    }
}

static void set_links( guide_oracle* hair, const guide_oracle_def* def )
{
    int links = hair->options.link_count;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        int* link = hair->link + at( g, links, 0 );
        double* weight = hair->link_weight + at( g, links, 0 );
        if ( def->assignment != NULL )
        {
            link[0] = def->assignment[g];
            weight[0] = 1.0;
        }
        else
        {
            guide_oracle_links( def->ghosts + at( g, hair->node_count, 0 ), hair->node_count, def->targets,
                                hair->target_count, hair->target_nodes, links, link, weight );
        }
        hair->group_size[link[0]] += 1;
    }
    for ( int a = 0; a < hair->target_count; ++a )
    {
        hair->counters.empty_groups += hair->group_size[a] == 0 ? 1 : 0;
    }
}

// The mean of the members' normalised arc lengths at a node.
static double group_arc( const guide_oracle* hair, const double3* ghosts, int group, int node, double* arc )
{
    double sum = 0.0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( group_of( hair, g ) == group )
        {
            guide_oracle_arc( ghosts + at( g, hair->node_count, 0 ), hair->node_count, arc );
            sum += arc[node];
        }
    }
    if ( hair->group_size[group] > 0 )
    {
        return sum / hair->group_size[group];
    }
    return hair->node_count > 1 ? (double)node / ( hair->node_count - 1 ) : 0.0;
}

static void pair_node( guide_oracle* hair, const guide_oracle_def* def, int a, int i, double* arc )
{
    const double3* target = def->targets + at( a, hair->target_nodes, 0 );
    size_t n = at( a, hair->node_count, i );
    guide_oracle_stencil stencil = { { i, i, i, i }, { 1.0, 0.0, 0.0, 0.0 } };
    int begin = i - 1; // of the target's segment at the node
    if ( hair->options.pairing == GUIDE_ORACLE_PAIRING_NEAREST )
    {
        stencil = guide_oracle_nearest_stencil( target, hair->target_nodes, hair->centre[n] );
        begin = stencil.node[0] - 1;
    }
    if ( hair->options.pairing == GUIDE_ORACLE_PAIRING_SPLINE )
    {
        stencil =
            guide_oracle_spline_stencil( target, hair->target_nodes, group_arc( hair, def->ghosts, a, i, arc ) );
        begin = stencil.node[1];
    }
    hair->stencil[n] = stencil;
    hair->rest[n] = guide_oracle_gather( &stencil, target );
    begin = begin > 0 ? begin : 0;
    hair->segment[n] = hair->target_nodes > 1 ? double3_distance( target[begin], target[begin + 1] ) : 0.0;
}

// Mean, spread and largest offset of one node of a group, then the anchor of its offsets.
static void measure_group( guide_oracle* hair, const guide_oracle_def* def, int a, int i, double* arc )
{
    size_t n = at( a, hair->node_count, i );
    int count = collect( hair, def->ghosts, a, i );
    hair->centre[n] = guide_oracle_mean( hair->scratch, count );
    hair->rest_spread[n] = guide_oracle_spread( hair->scratch, count );
    for ( int k = 0; k < count; ++k )
    {
        hair->largest[a] = fmax( hair->largest[a], double3_distance( hair->scratch[k], hair->centre[n] ) );
    }

    // a group without ghosts has no node: use the position on its target at the same fraction of the node count
    if ( count == 0 )
    {
        double fraction = hair->node_count > 1 ? (double)i / ( hair->node_count - 1 ) : 0.0;
        const double3* target = def->targets + at( a, hair->target_nodes, 0 );
        guide_oracle_stencil point = guide_oracle_spline_stencil( target, hair->target_nodes, fraction );
        hair->centre[n] = guide_oracle_gather( &point, target );
    }
    pair_node( hair, def, a, i, arc );
    bool own = count == 0 || ( count == 1 && hair->options.keep_offset ) ||
               hair->options.pairing == GUIDE_ORACLE_PAIRING_NEAREST;
    hair->centre[n] = count == 0 ? hair->rest[n] : hair->centre[n];
    hair->anchor[n] = own ? hair->rest[n] : hair->centre[n];
}

static void measure_ghost( guide_oracle* hair, const double3* ghosts, int g )
{
    int links = hair->options.link_count;
    for ( int i = 0; i < hair->node_count; ++i )
    {
        size_t n = at( g, hair->node_count, i );
        hair->ghost_segment[n] = i > 0 ? double3_distance( ghosts[n], ghosts[n - 1] ) : 0.0;
        for ( int k = 0; k < links && hair->target_count > 0; ++k )
        {
            size_t row = at( g, links, k );
            hair->offset[row * (size_t)hair->node_count + (size_t)i] =
                double3_sub( ghosts[n], hair->anchor[at( hair->link[row], hair->node_count, i )] );
        }
    }
}

// Section 4.2: blend the positions that each target of a ghost gives.
static double3 base( const guide_oracle* hair, int g, int i )
{
    int links = hair->options.link_count;
    double3 sum = zero;
    for ( int k = 0; k < links; ++k )
    {
        size_t row = at( g, links, k ), n = at( hair->link[row], hair->node_count, i );
        double3 o = hair->offset[row * (size_t)hair->node_count + (size_t)i];
        double3 place = double3_add( hair->x[n], guide_oracle_rotate( &hair->rotation[n], o ) );
        sum = double3_add( sum, double3_scale( hair->link_weight[row], place ) );
    }
    return sum;
}

wisp_status guide_oracle_create( const guide_oracle_def* def, const guide_oracle_options* options, guide_oracle* out,
                                 wisp_error* error )
{
    guide_oracle hair = { .options = *options,
                          .target_count = def->target_count,
                          .target_nodes = def->target_nodes,
                          .ghost_count = def->ghost_count,
                          .node_count = def->ghost_nodes };
    double* arc = calloc( (size_t)def->ghost_nodes, sizeof( double ) );
    if ( !allocate( &hair ) || arc == NULL )
    {
        free( arc );
        guide_oracle_destroy( &hair );
        return refuse( error, WISP_NO_MEMORY, "out of memory for %d ghosts", def->ghost_count );
    }
    if ( def->target_count > 0 )
    {
        set_links( &hair, def );
    }
    for ( int n = 0; n < hair.target_count * hair.node_count; ++n )
    {
        measure_group( &hair, def, n / hair.node_count, n % hair.node_count, arc );
        hair.x[n] = hair.rest[n];
        hair.rotation[n] = guide_oracle_no_rotation();
    }
    for ( int g = 0; g < hair.ghost_count; ++g )
    {
        measure_ghost( &hair, def->ghosts, g );
        for ( int i = 0; i < hair.node_count; ++i )
        {
            size_t n = at( g, hair.node_count, i );
            hair.b[n] = hair.y[n] = hair.target_count > 0 ? base( &hair, g, i ) : def->ghosts[n];
        }
    }
    free( arc );
    *out = hair;
    return WISP_OK;
}

// The step.

static void pair_targets( guide_oracle* hair, const guide_oracle_motion* motion )
{
    for ( int a = 0; a < hair->target_count; ++a )
    {
        size_t first = at( a, hair->node_count, 0 ), raw = at( a, hair->target_nodes, 0 );
        for ( size_t n = first; n < first + (size_t)hair->node_count; ++n )
        {
            double3 v = guide_oracle_gather( &hair->stencil[n], motion->v + raw );
            hair->x[n] = guide_oracle_gather( &hair->stencil[n], motion->x + raw );
            hair->v0[n] = hair->has_previous ? hair->v[n] : v;
            hair->v[n] = v;
            hair->rotation[n] = hair->options.frame == GUIDE_ORACLE_FRAME_GIVEN && motion->rotation != NULL
                                    ? motion->rotation[n]
                                    : guide_oracle_no_rotation();
        }
        if ( hair->options.frame == GUIDE_ORACLE_FRAME_PARALLEL )
        {
            guide_oracle_rotation root = motion->rotation != NULL ? motion->rotation[a] : guide_oracle_no_rotation();
            hair->counters.reversed_tangents += guide_oracle_parallel_frames(
                hair->rest + first, hair->x + first, hair->node_count, &root, hair->rotation + first );
        }
    }
    hair->has_previous = true;
}

// Velocity of a ghost: that of its targets, blended.
static double3 ghost_velocity( const guide_oracle* hair, const double3* v, int g, int i )
{
    int links = hair->options.link_count;
    double3 sum = zero;
    for ( int k = 0; k < links; ++k )
    {
        size_t row = at( g, links, k );
        sum = double3_add( sum,
                           double3_scale( hair->link_weight[row], v[at( hair->link[row], hair->node_count, i )] ) );
    }
    return sum;
}

// Section 4.1-4.2. With feedback the roots still follow the head.
static void place( guide_oracle* hair )
{
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        for ( int i = 0; i < hair->node_count; ++i )
        {
            double3* b = &hair->b[at( g, hair->node_count, i )];
            *b = hair->options.feedback && i > 0
                     ? double3_add( *b, double3_scale( hair->options.dt, ghost_velocity( hair, hair->v, g, i ) ) )
                     : base( hair, g, i );
        }
    }
}

// Section 4.4, w_com of a ghost node about the mean c of its group. Returns it.
static double weigh_distance( guide_oracle* hair, int g, int i, double3 c )
{
    size_t n = at( g, hair->node_count, i );
    hair->centre_weight[n] =
        guide_oracle_centre_weight( hair->options.centre_gain, hair->b[n], c, hair->largest[group_of( hair, g )] );
    return hair->centre_weight[n];
}

// Section 4.3-4.5 for one ghost node of a group whose largest w_com is `reach`.
static void sway( guide_oracle* hair, int g, int i, double reach )
{
    const guide_oracle_options* o = &hair->options;
    int a = group_of( hair, g );
    size_t n = at( g, hair->node_count, i );
    double3 v = ghost_velocity( hair, hair->v, g, i ), v0 = ghost_velocity( hair, hair->v0, g, i );
    hair->elastic_weight[n] = o->elastic_gain * guide_oracle_elastic_weight( o->elastic, v, v0 );
    hair->y[n] = hair->b[n];
    hair->counters.node_updates += 1;

    if ( i == 0 )
    {
        return; // pinned
    }
    bool cut = false;
    double shared = hair->elastic_weight[n] + guide_oracle_tip_weight( o->tip_gain, i, hair->node_count );
    double largest = fmax( fabs( shared ), fabs( shared + reach ) );
    double longest = o->cap_offset ? hair->segment[at( a, hair->node_count, i )] : -1.0;
    hair->y[n] = double3_add(
        hair->b[n], guide_oracle_displacement( v, shared + hair->centre_weight[n], largest, o->tau, longest, &cut ) );
    hair->counters.cut_displacements += cut ? 1 : 0;
}

// pos* becomes pos, and the group's mean returns to the mean of X + o.
static void feed_back( guide_oracle* hair, int a, int i )
{
    int count = 0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( group_of( hair, g ) == a )
        {
            hair->scratch[count++] = base( hair, g, i );
        }
    }
    double3 goal = guide_oracle_mean( hair->scratch, count );
    collect( hair, hair->y, a, i );
    guide_oracle_track( hair->scratch, count, goal );
    hand_back( hair, hair->y, a, i );
    hand_back( hair, hair->b, a, i );
}

static void step_group_node( guide_oracle* hair, int a, int i )
{
    const guide_oracle_options* o = &hair->options;
    double3 c = guide_oracle_mean( hair->scratch, collect( hair, hair->b, a, i ) );
    double reach = 0.0;
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        reach = group_of( hair, g ) == a ? fmax( reach, weigh_distance( hair, g, i, c ) ) : reach;
    }
    for ( int g = 0; g < hair->ghost_count; ++g )
    {
        if ( group_of( hair, g ) == a )
        {
            sway( hair, g, i, reach );
        }
    }
    if ( o->feedback && i > 0 )
    {
        feed_back( hair, a, i );
    }
    if ( o->use_spread && i > 0 )
    {
        int count = collect( hair, hair->y, a, i );
        double requested = o->spread * hair->rest_spread[at( a, hair->node_count, i )];
        guide_oracle_spread_fault fault =
            guide_oracle_spread_project( hair->scratch, count, requested, o->spread_exact );
        bool lost = fault == GUIDE_ORACLE_SPREAD_COINCIDENT || fault == GUIDE_ORACLE_SPREAD_BAD_TARGET;
        hair->counters.coincident_spreads += lost ? 1 : 0;
        hand_back( hair, hair->y, a, i );
    }
}

void guide_oracle_step( guide_oracle* hair, const guide_oracle_motion* motion )
{
    if ( hair->target_count == 0 )
    {
        return;
    }
    pair_targets( hair, motion );
    place( hair );
    for ( int n = 0; n < hair->target_count * hair->node_count; ++n )
    {
        step_group_node( hair, n / hair->node_count, n % hair->node_count );
    }
    for ( int g = 0; hair->options.repair_lengths && g < hair->ghost_count; ++g )
    {
        size_t first = at( g, hair->node_count, 0 );
        hair->counters.zero_segments +=
            guide_oracle_repair_lengths( hair->y + first, hair->node_count, hair->ghost_segment + first );
    }
}
