// State check: an entity whose positions or velocities leave their bounds (or are NaN) is restored to its last valid
// state and halted. In: positions and velocities at the end of a step. Out: the copy of the last valid state, or the
// restored columns.
#include "strand_passes.h"

#include "rod_frames.h"
#include "strand_rows.h"

#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum
{
    CHECK_GRAIN = 16, // groups per block
};

typedef struct check_loop
{
    const wisp_kernels* kernels;
    const int32_t* group_row;
    int32_t* in_bounds;
    float *position, *velocity;
    float *good_position, *good_velocity;
    _Atomic int first_bad; // lowest row out of bounds, or the number of rows
} check_loop;

static void check_groups( void* context, int begin, int end, int worker )
{
    (void)worker;
    check_loop* loop = context;
    const wisp_strand_bound_args args = { loop->position, loop->velocity, STRANDS_BOUND };
    int bad = INT_MAX;
    for ( int g = begin; g < end; ++g )
    {
        const int last = loop->group_row[g + 1];
        const int row = loop->in_bounds[g] != 0
                            ? last
                            : loop->kernels->strand_find_out_of_bounds( &args, loop->group_row[g], last );
        bad = row < last && row < bad ? row : bad;
        loop->in_bounds[g] = 0; // until the next step is checked
    }
    int lowest = atomic_load_explicit( &loop->first_bad, memory_order_relaxed );
    while ( bad < lowest && atomic_compare_exchange_weak( &loop->first_bad, &lowest, bad ) == false )
    {
    }
}

static void save_state( void* context, int begin, int end, int worker )
{
    (void)worker;
    check_loop* loop = context;
    const size_t first = strands_vector( loop->group_row[begin], 0 );
    const size_t bytes = ( strands_vector( loop->group_row[end], 0 ) - first ) * sizeof( float );
    memcpy( loop->good_position + first, loop->position + first, bytes );
    memcpy( loop->good_velocity + first, loop->velocity + first, bytes );
}

static bool is_in_bounds( wisp_vec3 p )
{
    return fabsf( p.x ) <= STRANDS_BOUND && fabsf( p.y ) <= STRANDS_BOUND && fabsf( p.z ) <= STRANDS_BOUND;
}

static void restore_state( wisp_frame* frame, wisp_entity entity, check_loop* loop, float* low, int row )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    int group = 0, lane = 0;
    while ( t->group_row[group + 1] <= row )
    {
        group += 1;
    }
    while ( lane + 1 < WISP_LANES && is_in_bounds( strands_get( loop->position, row, lane ) ) &&
            is_in_bounds( strands_get( loop->velocity, row, lane ) ) )
    {
        lane += 1;
    }
    const wisp_vec3 p = strands_get( loop->position, row, lane );
    char message[300];
    snprintf(
        message, sizeof( message ),
        "entity %u: strand %d, vertex %d left its bounds in step %llu at (%g, %g, %g); the entity is put back to "
        "the step before and halted",
        entity.index, t->lane_strand[group * WISP_LANES + lane], row - t->group_row[group],
        (unsigned long long)wisp_frame_step( frame ), (double)p.x, (double)p.y, (double)p.z );
    const size_t bytes = strands_vector( t->row_count, 0 ) * sizeof( float );
    memcpy( loop->position, loop->good_position, bytes );
    memcpy( loop->velocity, loop->good_velocity, bytes );
    memset( low, 0, bytes ); // may be NaN
    wisp_frame_halt( frame, entity, message );
}

// Clear what may be NaN, so that restored strands can move again.
static void restore_tension( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    float* tension = wisp_frame_column( frame, entity, state->tension, 0 );
    memset( tension, 0, strands_scalar( wisp_frame_strands( frame, entity )->row_count, 0 ) * sizeof( float ) );
}

static void restore_frames( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    const float* position = wisp_frame_column( frame, entity, WISP_STRAND_POSITION, 0 );
    const float* clamp = wisp_frame_column( frame, entity, state->clamp, 0 );
    const float* root = wisp_frame_column( frame, entity, WISP_STRAND_ROOT, 1 );
    const float* length = wisp_frame_column( frame, entity, WISP_STRAND_LENGTH, 0 );
    const strands_section* section = wisp_frame_has( frame, entity, state->section )
                                         ? wisp_frame_column( frame, entity, state->section, 0 )
                                         : NULL;
    const float twist = section != NULL ? section->twist : 0.0f;
    float* frames = wisp_frame_column( frame, entity, state->curve, 0 );
    for ( int g = 0; g < t->group_count; ++g )
    {
        strands_lay_group( t, position, clamp, root, length, twist, frames, g );
    }
}

static void restore_history( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    for ( int k = 0; k < 2; ++k )
    {
        memset( wisp_frame_column( frame, entity, state->history, k ), 0,
                strands_vector( t->row_count, 0 ) * sizeof( float ) );
    }
    float* step = wisp_frame_column( frame, entity, state->history, 2 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        step[strands_scalar( t->group_row[i / WISP_LANES], i % WISP_LANES )] = -1.0f;
    }
}

// An entity that is halted is left out of later passes, so all is restored here.
static void restore( wisp_frame* frame, wisp_entity entity, const strands_state* state, check_loop* loop, int row )
{
    restore_state( frame, entity, loop, wisp_frame_column( frame, entity, state->low, 0 ), row );
    if ( wisp_frame_has( frame, entity, state->tension ) )
    {
        restore_tension( frame, entity, state );
    }
    if ( wisp_frame_has( frame, entity, state->curve ) )
    {
        restore_frames( frame, entity, state );
    }
    if ( wisp_frame_has( frame, entity, state->history ) )
    {
        restore_history( frame, entity, state );
    }
}

void strands_guard( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const wisp_parallel* parallel = wisp_frame_parallel( frame, span );
    check_loop loop = {
        .kernels = wisp_frame_kernels( frame ),
        .group_row = t->group_row,
        .in_bounds = wisp_frame_column( frame, span->entity, state->in_bounds, 0 ),
        .position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 ),
        .velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 ),
        .good_position = wisp_frame_column( frame, span->entity, state->good, 0 ),
        .good_velocity = wisp_frame_column( frame, span->entity, state->good, 1 ),
    };
    atomic_init( &loop.first_bad, t->row_count );
    wisp_parallel_for( parallel, t->group_count, CHECK_GRAIN, check_groups, &loop );
    const int bad = atomic_load( &loop.first_bad );
    if ( bad < t->row_count )
    {
        restore( frame, span->entity, state, &loop, bad );
    }
    else
    {
        wisp_parallel_for( parallel, t->group_count, CHECK_GRAIN, save_state, &loop );
    }
}
