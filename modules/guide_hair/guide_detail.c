// Ghosts that are not computed: each goes along with the root of its first target as a rigid body, in the shape that it had last. When
// they are computed again they come back from there over the steps of the blend.
#include "guide_internal.h"

#include <string.h>

/// Columns of ghosts, and the roots of their targets.
typedef struct carried_loop
{
    const wisp_strand_topology* topology;
    float *position, *local; // [row][3][16] m, in the world and relative to the root
    const int32_t* lane;     // [group][16] float of the roots' positions; -1: none
    const float *root, *rotation;
    float weight; // of the rigid motion
} carried_loop;

static wisp_vec3 get( const float* rows, size_t at )
{
    return ( wisp_vec3 ){ rows[at], rows[at + WISP_LANES], rows[at + 2 * WISP_LANES] };
}

static void put( float* rows, size_t at, wisp_vec3 v )
{
    rows[at] = v.x;
    rows[at + WISP_LANES] = v.y;
    rows[at + 2 * WISP_LANES] = v.z;
}

// The pose of the root that a ghost goes along with; the identity without one.
static wisp_transform root_of( const carried_loop* loop, int lane )
{
    wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };
    const int32_t at = loop->lane[lane];
    if ( at >= 0 && loop->root != NULL )
    {
        const float* q = loop->rotation + (size_t)( at / GUIDE_ROW ) * 4 * WISP_LANES + at % GUIDE_ROW;
        pose.rotation = ( wisp_quat ){ q[0], q[WISP_LANES], q[2 * WISP_LANES], q[3 * WISP_LANES] };
        pose.translation = get( loop->root, (size_t)at );
    }
    return pose;
}

static void keep_lane( const carried_loop* loop, int lane )
{
    const wisp_transform pose = root_of( loop, lane );
    for ( int i = 0; i < loop->topology->lane_count[lane]; ++i )
    {
        const int row = loop->topology->group_row[lane / WISP_LANES] + i;
        const size_t at = (size_t)row * GUIDE_ROW + (size_t)( lane % WISP_LANES );
        put( loop->local, at, wisp_transform_to_local( pose, get( loop->position, at ) ) );
    }
}

// Rotations and places of the roots of a group, lane = strand.
typedef struct root_lanes
{
    float turn[9][WISP_LANES], place[3][WISP_LANES];
} root_lanes;

static void find_roots( const carried_loop* loop, int group, root_lanes* out )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const wisp_transform pose = root_of( loop, group * WISP_LANES + lane );
        const wisp_vec3 x = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
        const wisp_vec3 y = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
        const wisp_vec3 z = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
        const float turn[9] = { x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z };
        const float place[3] = { pose.translation.x, pose.translation.y, pose.translation.z };
        for ( int k = 0; k < 9; ++k )
        {
            out->turn[k][lane] = turn[k];
            out->place[k % 3][lane] = place[k % 3];
        }
    }
}

static void carry_row( const root_lanes* roots, const float* local, float weight, float* row )
{
    for ( int k = 0; k < 3; ++k )
    {
        const float *x = roots->turn[3 * k], *y = roots->turn[3 * k + 1], *z = roots->turn[3 * k + 2];
        float* out = row + k * WISP_LANES;
        for ( int lane = 0; lane < WISP_LANES; ++lane )
        {
            const float rigid = x[lane] * local[lane] + y[lane] * local[WISP_LANES + lane] +
                                z[lane] * local[2 * WISP_LANES + lane] + roots->place[k][lane];
            out[lane] = weight < 1.0f ? out[lane] + weight * ( rigid - out[lane] ) : rigid;
        }
    }
}

static void carry_group( const carried_loop* loop, int group )
{
    root_lanes roots;
    find_roots( loop, group, &roots );
    for ( int row = loop->topology->group_row[group]; row < loop->topology->group_row[group + 1]; ++row )
    {
        carry_row( &roots, loop->local + (size_t)row * GUIDE_ROW, loop->weight,
                   loop->position + (size_t)row * GUIDE_ROW );
    }
}

// ---- the pass ----

static float rigid_weight( wisp_frame* frame, wisp_entity ghosts )
{
    const wisp_detail_frame detail = wisp_frame_detail( frame, ghosts );
    const bool returns = detail.from >= WISP_DETAIL_COARSE;
    return detail.level >= WISP_DETAIL_COARSE ? 1.0f : returns ? 1.0f - detail.blend : 0.0f;
}

bool guide_carried_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    return guide_active_follower( user, entity ) != NULL && rigid_weight( frame, entity ) > 0.0f;
}

void guide_run_carried( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const wisp_entity targets = guide_active_follower( state, span->entity )->targets;
    const bool has_roots = wisp_frame_has( frame, targets, WISP_STRAND_ROOT );
    const carried_loop loop = {
        .topology = wisp_frame_strands( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .local = wisp_frame_column( frame, span->entity, state->carried, 0 ),
        .lane = wisp_frame_column( frame, span->entity, state->carrier, 0 ),
        .root = has_roots ? wisp_frame_column( frame, targets, WISP_STRAND_ROOT, 0 ) : NULL,
        .rotation = has_roots ? wisp_frame_column( frame, targets, WISP_STRAND_ROOT, 1 ) : NULL,
        .weight = rigid_weight( frame, span->entity ),
    };
    for ( int group = span->begin; group < span->end; ++group )
    {
        carry_group( &loop, group );
    }
}

// ---- between steps ----

// Keep the shape that ghosts have now.
static void keep_shape( const guide_state* state, wisp_world* world, const guide_follower* f )
{
    const bool has_roots = wisp_world_has( world, f->targets, WISP_STRAND_ROOT );
    const carried_loop loop = {
        .topology = wisp_world_strands( world, f->ghosts ),
        .position = wisp_world_column( world, f->ghosts, WISP_STRAND_POSITION, 0 ),
        .local = wisp_world_column( world, f->ghosts, state->carried, 0 ),
        .lane = wisp_world_column( world, f->ghosts, state->carrier, 0 ),
        .root = has_roots ? wisp_world_column( world, f->targets, WISP_STRAND_ROOT, 0 ) : NULL,
        .rotation = has_roots ? wisp_world_column( world, f->targets, WISP_STRAND_ROOT, 1 ) : NULL,
    };
    for ( int lane = 0; lane < loop.topology->group_count * WISP_LANES; ++lane )
    {
        keep_lane( &loop, lane );
    }
}

// Find where the roots of the first targets are. @param at [target strands] scratch
static void find_carriers( const guide_state* state, wisp_world* world, const guide_follower* f, int32_t* at )
{
    const wisp_strand_topology *from = wisp_world_strands( world, f->targets ),
                               *t = wisp_world_strands( world, f->ghosts );
    int32_t* lanes = wisp_world_column( world, f->ghosts, state->carrier, 0 );
    for ( int lane = 0; lane < from->group_count * WISP_LANES; ++lane )
    {
        if ( from->lane_strand[lane] >= 0 )
        {
            at[from->lane_strand[lane]] = lane / WISP_LANES * GUIDE_ROW + lane % WISP_LANES;
        }
    }
    for ( int lane = 0; lane < t->group_count * WISP_LANES; ++lane )
    {
        const int strand = t->lane_strand[lane], target = strand >= 0 ? f->target[strand] : -1;
        lanes[lane] = target >= 0 ? at[target] : -1;
    }
}

wisp_status guide_prepare_detail( const void* memory, wisp_world* world, wisp_entity entity )
{
    const guide_state* state = memory;
    const guide_follower* f = guide_active_follower( state, entity );
    if ( f == NULL )
    {
        return WISP_OK;
    }
    const wisp_allocator* allocator = wisp_world_allocator( world );
    const size_t bytes = (size_t)wisp_world_strands( world, f->targets )->strand_count * sizeof( int32_t );
    int32_t* at = allocator->allocate( allocator->user, bytes, sizeof( int32_t ) );
    if ( at == NULL || wisp_world_attach( world, entity, state->carried ) != WISP_OK ||
         wisp_world_attach( world, entity, state->carrier ) != WISP_OK )
    {
        wisp_world_detach( world, entity, state->carried );
        wisp_release( allocator, at, bytes );
        return wisp_world_fail( world, WISP_NO_MEMORY, "ghosts: out of memory for the detail of entity %u",
                                entity.index );
    }
    find_carriers( state, world, f, at );
    allocator->release( allocator->user, at, bytes );
    keep_shape( state, world, f );
    return WISP_OK;
}

bool guide_has_coarse( const void* memory, const wisp_world* world, wisp_entity entity )
{
    (void)world;
    return guide_active_follower( memory, entity ) != NULL;
}

void guide_detail_changed( const void* memory, wisp_world* world, wisp_entity entity, wisp_detail from,
                           wisp_detail to )
{
    const guide_state* state = memory;
    const guide_follower* f = guide_active_follower( state, entity );
    if ( f != NULL && from < WISP_DETAIL_COARSE && to >= WISP_DETAIL_COARSE )
    {
        keep_shape( state, world, f );
    }
}
