// Passes of a step: tables of targets, ghosts, repaired lengths, and a copy for an appearance on top.
#include "guide_internal.h"

#include <math.h>
#include <string.h>

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
        .root = wisp_frame_has( frame, entity, WISP_STRAND_ROOT )
                    ? wisp_frame_column( frame, entity, WISP_STRAND_ROOT, 1 )
                    : NULL,
    };
    for ( int i = 0; i < state->follower_count; ++i )
    {
        const bool is_computed = wisp_frame_detail( frame, state->followers[i]->ghosts ).level < WISP_DETAIL_COARSE;
        if ( is_computed && wisp_entity_equal( state->followers[i]->targets, entity ) )
        {
            fill_table( frame, span, state, state->followers[i], loop );
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
void guide_run_carry( wisp_frame* frame, const wisp_span* span, void* user )
{
    if ( guide_active_follower( user, span->entity ) != NULL )
    {
        copy_loop copy = { wisp_frame_strands( frame, span->entity ),
                           wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
                           wisp_frame_column( frame, span->entity, WISP_STRAND_POSED, 0 ) };
        copy_groups( &copy, span->begin, span->end, span->worker );
    }
}
