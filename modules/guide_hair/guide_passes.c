// Passes of a step: tables of targets, ghosts, repaired lengths, and a copy for an appearance on top.
#include "guide_internal.h"

#include <math.h>
#include <string.h>

// ---- definition ----

// Definition of ghosts: defaults, ranges, which strands may follow which.

static const wisp_field GHOSTS_FIELDS[] = {
    WISP_WHOLE( wisp_ghosts_def, target_count, 1, 1, WISP_MAX_GHOST_TARGETS ),
    WISP_SWITCH( wisp_ghosts_def, resample, false ),
    WISP_CHOICE( wisp_ghosts_def, elastic, WISP_GHOST_ELASTIC_CHANGE, WISP_GHOST_ELASTIC_COUNT ),
    WISP_NUMBER( wisp_ghosts_def, tip_gain, 0.5, 0, 1e3, NULL ),
    WISP_NUMBER( wisp_ghosts_def, centre_gain, 0.5, 0, 1e3, NULL ),
    WISP_NUMBER( wisp_ghosts_def, time, 0, 0, 1e3, "s" ),
    WISP_NUMBER( wisp_ghosts_def, spread, 1, 1e-6, 1e6, NULL ),
    WISP_SWITCH( wisp_ghosts_def, repair_length, false ),
    WISP_SWITCH( wisp_ghosts_def, between, false ),
};
WISP_DEFINE( ghosts_def, "ghosts", GHOSTS_FIELDS )

// ---- checks ----

static wisp_status check_strands( wisp_world* world, wisp_entity entity, const char* what )
{
    if ( wisp_is_alive( world, entity ) == false )
    {
        return wisp_world_fail( world, entity.index == 0 ? WISP_CONFLICT : WISP_STALE_ID,
                                "ghosts: entity %u of %s does not exist or was removed", entity.index, what );
    }
    if ( wisp_world_strands( world, entity ) == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u of %s has no strands", entity.index, what );
    }
    return WISP_OK;
}

// Refuse ghosts of ghosts: tables are filled before ghosts are placed, so they would follow a step late.
static wisp_status check_roles( wisp_world* world, const guide_state* s, wisp_entity ghosts, wisp_entity targets )
{
    if ( wisp_entity_equal( ghosts, targets ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u cannot follow itself", ghosts.index );
    }
    if ( wisp_world_strands( world, targets )->vertex_count == 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: targets: entity %u has no vertices", targets.index );
    }
    if ( wisp_world_has( world, ghosts, WISP_STRAND_VELOCITY ) || wisp_world_has( world, ghosts, s->curves ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u has a solver of its own", ghosts.index );
    }
    if ( wisp_world_has( world, targets, s->settings ) || wisp_world_has( world, targets, s->curves ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: targets: entity %u are ghosts themselves",
                                targets.index );
    }
    if ( wisp_world_has( world, ghosts, s->before ) )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "ghosts: entity %u is the target of other ghosts",
                                ghosts.index );
    }
    return WISP_OK;
}

static wisp_status check( wisp_world* world, const guide_state* s, wisp_entity ghosts, const wisp_ghosts_def* def )
{
    wisp_status status = check_strands( world, ghosts, "the ghosts" );
    status = status == WISP_OK ? check_strands( world, def->targets, "the targets" ) : status;
    return status == WISP_OK ? check_roles( world, s, ghosts, def->targets ) : status;
}

// ---- following ----

// Passes that advance state are requested, even if no output is.
static wisp_status set_components( wisp_world* world, const guide_state* s, wisp_entity ghosts,
                                   const wisp_ghosts_def* def )
{
    const wisp_component_use followed[] = { { s->before, true }, { s->table, WISP_USED | WISP_REQUESTED } };
    const int between = def->between ? WISP_USED | WISP_REQUESTED : 0;
    const wisp_component_use uses[] = {
        { s->settings, true },   { s->table, true },       { s->repair, def->repair_length },
        { s->between, between }, { s->interval, between },
    };
    WISP_TRY( wisp_world_set_components( world, def->targets, followed, WISP_COUNT( followed ) ) );
    const wisp_status status = wisp_world_set_components( world, ghosts, uses, WISP_COUNT( uses ) );
    if ( status != WISP_OK )
    {
        guide_let_go( world, s, def->targets );
        return status;
    }
    wisp_world_tie( world, def->targets, ghosts );
    return WISP_OK;
}

// Replace the follower that the ghosts had.
static void install( wisp_world* world, const guide_state* s, guide_follower* follower )
{
    const guide_follower* old = wisp_find_object( s->followers, follower->ghosts );
    const wisp_entity targets = old != NULL ? old->targets : ( wisp_entity ){ 0, 0 };
    wisp_set_object( s->followers, follower->ghosts, follower );
    guide_let_go( world, s, targets );
}

wisp_status wisp_set_ghosts( wisp_world* world, wisp_entity ghosts, const wisp_ghosts_def* given )
{
    wisp_ghosts_def values;
    const wisp_ghosts_def* def = &values;
    WISP_TRY( wisp_world_begin_def( world, &ghosts, &wisp_ghosts_def_fields, &values, given ) );
    WISP_FIND_STATE( guide_state, s, world, "guide_hair", NULL, 0 );
    WISP_TRY( check( world, s, ghosts, def ) );
    if ( wisp_reserve_object( s->followers, ghosts ) == false )
    {
        return wisp_world_fail( world, WISP_NO_MEMORY, "out of memory for another entity of ghosts" );
    }
    guide_follower* follower;
    wisp_status status = guide_cook( world, ghosts, def, &follower );
    status = status == WISP_OK ? set_components( world, s, ghosts, def ) : status;
    if ( status != WISP_OK )
    {
        guide_follower_release( follower, wisp_world_allocator( world ) );
        return status;
    }
    install( world, s, follower );
    WISP_FILL( world, ghosts, s->settings, guide_settings, .time = def->time, .tip_gain = def->tip_gain,
               .is_elastic = def->elastic == WISP_GHOST_ELASTIC_CHANGE ? 1 : 0 );
    if ( def->between )
    {
        guide_begin_between( world, s, follower );
    }
    return wisp_world_has( world, ghosts, s->detail ) ? guide_prepare_detail( s, world, ghosts ) : WISP_OK;
}

// ---- detail ----

// Ghosts that are not computed: each goes along with the root of its first target as a rigid body, in the shape that it had last. When
// they are computed again they come back from there over the steps of the blend.

/// Columns of ghosts, and the roots of their targets.
typedef struct held_loop
{
    const wisp_strand_topology* topology;
    float *position, *local; // [row][3][16] m, in the world and relative to the root
    const int32_t* lane;     // [group][16] float of the roots' positions; -1: none
    const float *root, *rotation;
    float weight; // of the rigid motion
} held_loop;

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
static wisp_transform root_of( const held_loop* loop, int lane )
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

static void keep_lane( const held_loop* loop, int lane )
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

static void find_roots( const held_loop* loop, int group, root_lanes* out )
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

static void place_row( const root_lanes* roots, const float* local, float weight, float* row )
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

static void place_group( const held_loop* loop, int group )
{
    root_lanes roots;
    find_roots( loop, group, &roots );
    for ( int row = loop->topology->group_row[group]; row < loop->topology->group_row[group + 1]; ++row )
    {
        place_row( &roots, loop->local + (size_t)row * GUIDE_ROW, loop->weight,
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

bool guide_held_is_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    return guide_active_follower( user, entity ) != NULL && rigid_weight( frame, entity ) > 0.0f;
}

void guide_run_held( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const wisp_entity targets = guide_active_follower( state, span->entity )->targets;
    const bool has_roots = wisp_frame_has( frame, targets, WISP_STRAND_ROOT );
    const held_loop loop = {
        .topology = wisp_frame_strands( frame, span->entity ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .local = wisp_frame_column( frame, span->entity, state->held, 0 ),
        .lane = wisp_frame_column( frame, span->entity, state->carrier, 0 ),
        .root = has_roots ? wisp_frame_column( frame, targets, WISP_STRAND_ROOT, 0 ) : NULL,
        .rotation = has_roots ? wisp_frame_column( frame, targets, WISP_STRAND_ROOT, 1 ) : NULL,
        .weight = rigid_weight( frame, span->entity ),
    };
    for ( int group = span->begin; group < span->end; ++group )
    {
        place_group( &loop, group );
    }
}

// ---- between steps ----

// Keep the shape that ghosts have now.
static void keep_shape( const guide_state* state, wisp_world* world, const guide_follower* f )
{
    const bool has_roots = wisp_world_has( world, f->targets, WISP_STRAND_ROOT );
    const held_loop loop = {
        .topology = wisp_world_strands( world, f->ghosts ),
        .position = wisp_world_column( world, f->ghosts, WISP_STRAND_POSITION, 0 ),
        .local = wisp_world_column( world, f->ghosts, state->held, 0 ),
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
    if ( at == NULL || wisp_world_attach( world, entity, state->held ) != WISP_OK ||
         wisp_world_attach( world, entity, state->carrier ) != WISP_OK )
    {
        wisp_world_detach( world, entity, state->held );
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

// ---- passes ----

enum
{
    TARGET_GRAIN = 4, // groups a block
};

// ---- tables ----

typedef struct table_loop
{
    wisp_strand_target_args args;
    const guide_lanes* lanes;
    const wisp_kernels* kernels;
    const float *position, *velocity, *before, *root; // of the targets; null as in the job
    bool resampled;
} table_loop;

// Gather rows as weighted sums of four vertices of the targets.
static void gather_rows( const guide_lanes* l, const float* from, float* to, int group )
{
    for ( int row = l->group_row[group]; row < l->group_row[group + 1]; ++row )
    {
        const int32_t* source = l->source + (size_t)row * 4 * WISP_LANES;
        const float* weight = l->weight + (size_t)row * 4 * WISP_LANES;
        float* out = to + (size_t)row * GUIDE_ROW;
        for ( int axis = 0; axis < 3; ++axis )
        {
            for ( int lane = 0; lane < WISP_LANES; ++lane )
            {
                float sum = 0.0f;
                for ( int n = 0; n < 4; ++n )
                {
                    sum += weight[n * WISP_LANES + lane] * from[source[n * WISP_LANES + lane] + axis * WISP_LANES];
                }
                out[axis * WISP_LANES + lane] = sum;
            }
        }
    }
}

static void gather_roots( const guide_lanes* l, const float* from, int group )
{
    for ( int n = 0; n < 4 * WISP_LANES; ++n )
    {
        const int part = n / WISP_LANES, at = l->source_lane[group * WISP_LANES + n % WISP_LANES];
        const float otherwise = part == 3 ? 1.0f : 0.0f;
        l->root[(size_t)group * 4 * WISP_LANES + (size_t)n] = at >= 0 ? from[at + part * WISP_LANES] : otherwise;
    }
}

static void fill_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const table_loop* loop = context;
    const guide_lanes* l = loop->lanes;
    for ( int group = begin; group < end && loop->resampled; ++group )
    {
        gather_rows( l, loop->position, l->position, group );
        if ( loop->velocity != NULL )
        {
            gather_rows( l, loop->velocity, l->velocity, group );
        }
        if ( loop->before != NULL )
        {
            gather_rows( l, loop->before, l->before, group );
        }
        if ( loop->root != NULL )
        {
            gather_roots( l, loop->root, group );
        }
    }
    loop->kernels->strand_target( &loop->args, begin, end );
}

// Time of a step.
static float seconds_of( const wisp_frame* frame, wisp_entity entity )
{
    return wisp_frame_dt( frame, entity ) * (float)wisp_frame_substeps( frame, entity );
}

static void fill_table( wisp_frame* frame, const wisp_span* span, const guide_state* state, const guide_follower* f,
                        table_loop loop )
{
    const guide_settings* settings = wisp_frame_column( frame, f->ghosts, state->settings, 0 );
    const guide_lanes* l = &f->guides;
    loop.lanes = l;
    loop.resampled = f->resampled;
    loop.args = ( wisp_strand_target_args ){
        .group_row = l->group_row,
        .lane_count = l->lane_count,
        .lane_node = l->lane_node,
        .position = f->resampled ? l->position : loop.position,
        .rest = f->resampled ? l->rest : wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 ),
        .velocity = f->resampled && loop.velocity != NULL ? l->velocity : loop.velocity,
        .previous_velocity = f->resampled && loop.before != NULL ? l->before : loop.before,
        .max_sway = l->cap,
        .reach = l->reach,
        .root = f->resampled && loop.root != NULL ? l->root : loop.root,
        .table = f->table,
        .stride = f->stride,
        .is_blended = f->link_count > 1,
        .is_elastic = settings->is_elastic != 0,
        .sway_time = settings->time > 0.0f ? settings->time : seconds_of( frame, span->entity ),
        .tip_gain = settings->tip_gain,
    };
    wisp_parallel_for( wisp_frame_parallel( frame, span ), l->group_count, TARGET_GRAIN, fill_groups, &loop );
}

typedef struct copy_loop
{
    const wisp_strand_topology* topology;
    const float* from;
    float* to;
} copy_loop;

static void copy_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    const copy_loop* loop = context;
    const size_t first = (size_t)loop->topology->group_row[begin] * GUIDE_ROW;
    const size_t last = (size_t)loop->topology->group_row[end] * GUIDE_ROW;
    memcpy( loop->to + first, loop->from + first, ( last - first ) * sizeof( float ) );
}

void guide_run_targets( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const wisp_entity entity = span->entity;
    uint64_t* steps = wisp_frame_column( frame, entity, state->table, 0 );
    float* before = wisp_frame_column( frame, entity, state->before, 0 );
    const bool moves = wisp_frame_has( frame, entity, WISP_STRAND_VELOCITY );
    const table_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .position = wisp_frame_column( frame, entity, WISP_STRAND_POSITION, 0 ),
        .velocity = moves ? wisp_frame_column( frame, entity, WISP_STRAND_VELOCITY, 0 ) : NULL,
        .before = moves && *steps > 0 ? before : NULL, // the first step has no velocity before
        .root = wisp_frame_column( frame, entity, WISP_STRAND_ROOT, 1 ),
    };
    const guide_follower* f;
    for ( int place = 0; ( f = wisp_next_object( state->followers, &place ) ) != NULL; )
    {
        if ( wisp_entity_equal( f->targets, entity ) &&
             wisp_frame_detail( frame, f->ghosts ).level < WISP_DETAIL_COARSE )
        {
            fill_table( frame, span, state, f, loop );
        }
    }
    *steps += 1;
    if ( moves )
    {
        copy_loop copy = { wisp_frame_strands( frame, entity ), loop.velocity, before };
        wisp_parallel_for( wisp_frame_parallel( frame, span ), copy.topology->group_count, 16 * TARGET_GRAIN,
                           copy_groups, &copy );
    }
}

// ---- ghosts ----

// A pass with `is_due` also waits for the passes before it, so it is never fused with those of another entity.
bool guide_ghosts_are_due( wisp_frame* frame, wisp_entity entity, void* user )
{
    (void)frame;
    return guide_active_follower( user, entity ) != NULL;
}

void guide_run_ghosts( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_state* state = user;
    const guide_follower* f = guide_active_follower( state, span->entity );
    const guide_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const wisp_strand_ghost_args args = {
        .group_row = t->group_row,
        .lane_count = t->lane_count,
        .lane_node = f->lane_node,
        .lane_fraction = f->lane_fraction,
        .centre_scale = f->centre_scale,
        .offset = f->offset,
        .table = f->table,
        .target_count = f->link_count,
        .is_elastic = settings->is_elastic != 0,
        .sway_time = settings->time > 0.0f ? settings->time : seconds_of( frame, span->entity ),
        .points = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
    };
    if ( f->link_count > 1 )
    {
        kernels->strand_ghost_blend( &args, span->begin, span->end );
    }
    else
    {
        kernels->strand_ghost( &args, span->begin, span->end );
    }
}

// Repair one row of sixteen strands: move each vertex along the line to the repaired one before it. A segment without length has
// no direction and is left alone.
static void repair_row( float* row, const float* length )
{
    const float* last = row - GUIDE_ROW;
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const float x = row[lane] - last[lane], y = row[lane + WISP_LANES] - last[lane + WISP_LANES];
        const float z = row[lane + 2 * WISP_LANES] - last[lane + 2 * WISP_LANES];
        const float now = sqrtf( x * x + y * y + z * z ), fraction = length[lane] / ( now > 0.0f ? now : 1.0f );
        row[lane] = now > 0.0f ? last[lane] + fraction * x : row[lane];
        row[lane + WISP_LANES] = now > 0.0f ? last[lane + WISP_LANES] + fraction * y : row[lane + WISP_LANES];
        row[lane + 2 * WISP_LANES] =
            now > 0.0f ? last[lane + 2 * WISP_LANES] + fraction * z : row[lane + 2 * WISP_LANES];
    }
}

void guide_run_lengths( wisp_frame* frame, const wisp_span* span, void* user )
{
    const guide_follower* f = guide_active_follower( user, span->entity );
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    for ( int group = span->begin; group < span->end && f != NULL && f->length != NULL; ++group )
    {
        for ( int row = t->group_row[group] + 1; row < t->group_row[group + 1]; ++row )
        {
            repair_row( position + (size_t)row * GUIDE_ROW, f->length + (size_t)row * WISP_LANES );
        }
    }
}

// Stop once the targets are removed: the place no longer follows motion.
void guide_run_update_poses( wisp_frame* frame, const wisp_span* span, void* user )
{
    if ( guide_active_follower( user, span->entity ) != NULL )
    {
        copy_loop copy = { wisp_frame_strands( frame, span->entity ),
                           wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
                           wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 ) };
        copy_groups( &copy, span->begin, span->end, span->worker );
    }
}
