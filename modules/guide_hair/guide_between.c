// Interpolation in time (Park and Kim 2024, section II.2.2). Keeps the last two places of ghosts and the velocities of their
// targets' nodes; a place between them lies on a cubic Hermite curve.
#include "guide_internal.h"

#include <string.h>

enum
{
    GROUP_GRAIN = 16, // groups a block
    // columns of guide_hair.between
    PLACE_BEFORE = 0,
    PLACE,
    VELOCITY_BEFORE,
    VELOCITY,
    COLUMN_COUNT,
};

// ---- cooking ----

bool guide_cook_sources( guide_follower* f, const guide_groups* g )
{
    const wisp_strand_topology* t = g->ghosts->topology;
    const size_t lanes = (size_t)t->group_count * WISP_LANES;
    f->sources.lane_from = guide_take( &f->memory, lanes * (size_t)g->links, sizeof( int32_t ) );
    if ( f->memory.failed )
    {
        return false;
    }
    for ( int n = 0; n < t->group_count * g->links * WISP_LANES; ++n )
    {
        const int link = n / WISP_LANES % g->links, lane = n % WISP_LANES;
        const int ghost = t->lane_strand[n / WISP_LANES / g->links * WISP_LANES + lane];
        const int group = ghost >= 0 ? g->group[(size_t)ghost * (size_t)g->links + (size_t)link] : -1;
        f->sources.lane_from[n] = -1;
        if ( group >= 0 )
        {
            const int from = g->groups[group].lane;
            f->sources.lane_from[n] = f->guides.group_row[from / WISP_LANES] * GUIDE_ROW + from % WISP_LANES;
        }
    }
    return true;
}

// ---- a step ----

typedef struct between_loop
{
    const guide_follower* follower;
    const wisp_strand_topology* topology;
    const float* from;     // m/s, the guides' rows; null: at rest
    const float* position; // m
    float* column[COLUMN_COUNT];
} between_loop;

// Blend the velocity of a vertex with the weights of its place.
static void blend_velocity( const between_loop* loop, int group, int lane, int i, float* to )
{
    const guide_follower* f = loop->follower;
    float sum[3] = { 0.0f, 0.0f, 0.0f };
    for ( int k = 0; k < f->link_count && loop->from != NULL; ++k )
    {
        const size_t at = (size_t)( group * f->link_count + k ) * WISP_LANES + (size_t)lane;
        if ( f->sources.lane_from[at] >= 0 )
        {
            const float* v = loop->from + f->sources.lane_from[at] + (size_t)i * GUIDE_ROW;
            for ( int axis = 0; axis < 3; ++axis )
            {
                sum[axis] += f->lane_fraction[at] * v[axis * WISP_LANES];
            }
        }
    }
    for ( int axis = 0; axis < 3; ++axis )
    {
        to[axis * WISP_LANES] = sum[axis];
    }
}

static void keep_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const between_loop* loop = context;
    const wisp_strand_topology* t = loop->topology;
    const size_t first = (size_t)t->group_row[begin] * GUIDE_ROW;
    const size_t bytes = ( (size_t)t->group_row[end] * GUIDE_ROW - first ) * sizeof( float );
    memcpy( loop->column[PLACE_BEFORE] + first, loop->column[PLACE] + first, bytes );
    memcpy( loop->column[VELOCITY_BEFORE] + first, loop->column[VELOCITY] + first, bytes );
    memcpy( loop->column[PLACE] + first, loop->position + first, bytes );
    for ( int lane = begin * WISP_LANES; lane < end * WISP_LANES; ++lane )
    {
        const int group = lane / WISP_LANES;
        float* velocity = loop->column[VELOCITY] + (size_t)t->group_row[group] * GUIDE_ROW + lane % WISP_LANES;
        for ( int i = 0; i < t->lane_count[lane]; ++i )
        {
            blend_velocity( loop, group, lane % WISP_LANES, i, velocity + (size_t)i * GUIDE_ROW );
        }
    }
}

bool guide_between_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)frame;
    return guide_active_follower( user, entity ) != NULL;
}

void guide_run_between( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const guide_follower* f = guide_active_follower( state, span->entity );
    between_loop loop = {
        .follower = f,
        .topology = wisp_frame_strands( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
    };
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        loop.column[c] = wisp_frame_column( frame, span->entity, state->between, c );
    }
    if ( wisp_frame_has( frame, f->targets, WISP_STRAND_VELOCITY ) )
    {
        loop.from =
            f->resampled ? f->guides.velocity : wisp_frame_column( frame, f->targets, WISP_STRAND_VELOCITY, 0 );
    }
    float* seconds = wisp_frame_column( frame, span->entity, state->interval, 0 );
    *seconds = wisp_frame_dt( frame, span->entity ) * (float)wisp_frame_substeps( frame, span->entity );
    wisp_parallel_for( wisp_frame_parallel( frame, span ), loop.topology->group_count, GROUP_GRAIN, keep_groups,
                       &loop );
}

// ---- the host ----

void guide_begin_between( wisp_world* world, const guide_state* state, const guide_follower* f )
{
    const size_t bytes = (size_t)wisp_world_strands( world, f->ghosts )->row_count * GUIDE_ROW * sizeof( float );
    const float* position = wisp_world_column( world, f->ghosts, WISP_STRAND_POSITION, 0 );
    float* seconds = wisp_world_column( world, f->ghosts, state->interval, 0 );
    *seconds = 0.0f;
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        float* column = wisp_world_column( world, f->ghosts, state->between, c );
        if ( c == PLACE_BEFORE || c == PLACE )
        {
            memcpy( column, position, bytes );
        }
        else
        {
            memset( column, 0, bytes );
        }
    }
}

// Weights of the place before, now, and of the velocities before and now, at a fraction of the interval.
static void hermite_weights( double u, double seconds, double weight[COLUMN_COUNT] )
{
    const double u2 = u * u, u3 = u2 * u;
    weight[PLACE] = 3.0 * u2 - 2.0 * u3;
    weight[PLACE_BEFORE] = 1.0 - weight[PLACE];
    weight[VELOCITY_BEFORE] = seconds * ( u3 - 2.0 * u2 + u );
    weight[VELOCITY] = seconds * ( u3 - u2 );
}

wisp_status wisp_ghosts_between( wisp_world* world, wisp_entity ghosts, float fraction, wisp_vec3* points )
{
    WISP_TRY( wisp_world_check_entity( world, ghosts ) );
    WISP_TRY( wisp_world_check_pointer( world, "points", points ) );
    const guide_state* state = wisp_world_module_state( world, "guide_hair" );
    const guide_follower* f;
    WISP_TRY( guide_find_ghosts( world, ghosts, &f ) );
    if ( f->is_between == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u does not store states between steps",
                                ghosts.index );
    }
    if ( !( fraction >= 0.0f && fraction <= 1.0f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "ghosts: fraction: got %g, expected 0 to 1",
                                (double)fraction );
    }
    const wisp_vec3 o = wisp_world_offset( world, ghosts );
    const double offset[3] = { (double)o.x, (double)o.y, (double)o.z };
    const wisp_strand_topology* t = wisp_world_strands( world, ghosts );
    const float* seconds = wisp_world_column( world, ghosts, state->interval, 0 );
    const float* column[COLUMN_COUNT];
    double weight[COLUMN_COUNT];
    hermite_weights( (double)fraction, (double)*seconds, weight );
    for ( int c = 0; c < COLUMN_COUNT; ++c )
    {
        column[c] = wisp_world_column( world, ghosts, state->between, c );
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        size_t at = (size_t)t->group_row[lane / WISP_LANES] * GUIDE_ROW + (size_t)( lane % WISP_LANES );
        for ( int i = 0; i < t->lane_count[lane]; ++i, at += GUIDE_ROW )
        {
            double sum[3] = { 0.0, 0.0, 0.0 };
            for ( int n = 0; n < 3 * COLUMN_COUNT; ++n )
            {
                sum[n % 3] += weight[n / 3] * (double)column[n / 3][at + (size_t)( n % 3 * WISP_LANES )];
            }
            points[t->offsets[t->lane_strand[lane]] + i] =
                ( wisp_vec3 ){ (float)( sum[0] - offset[0] ), (float)( sum[1] - offset[1] ),
                               (float)( sum[2] - offset[2] ) };
        }
    }
    return WISP_OK;
}
