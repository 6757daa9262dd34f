// Fused substeps: all substeps of two groups of strands in one pass, for direct lengths without rod or contact. The
// columns of two groups stay in the first-level cache, the prediction of a substep computes the velocity of the one
// before, and previous positions live in scratch memory. A fifth less time than pass by pass (bench case "strands"),
// with the same bits.
#include "fused_substeps.h"

#include "head_roots.h"
#include "strand_rows.h"
#include "substep_passes.h"
#include "surface_roots.h"

enum
{
    PAIR = 2,                                // kernels interleave two groups
    PREVIOUS_FLOATS = PAIR * 3 * WISP_LANES, // per row
};

// Optional components of an entity.
typedef struct parts
{
    bool has_head, is_anchored, has_pins, has_links;
    bool has_damping, has_air;
} parts;

// Arguments of kernels for one pair: columns start at its first row.
typedef struct pair_args
{
    int32_t group_row[PAIR + 1];
    wisp_strand_motion_args motion;
    wisp_strand_link_args link;
    wisp_strand_stretch_args stretch;
} pair_args;

static parts parts_of( wisp_frame* frame, wisp_entity entity, const strands_state* state )
{
    return ( parts ){
        .has_head = wisp_frame_has( frame, entity, state->head ),
        .is_anchored = wisp_frame_has( frame, entity, state->anchor ),
        .has_pins = wisp_frame_has( frame, entity, state->pins ),
        .has_links = wisp_frame_has( frame, entity, state->bend_link ),
        .has_damping = wisp_frame_has( frame, entity, state->damping ),
        .has_air = wisp_frame_has( frame, entity, state->air ),
    };
}

// Run the passes of roots, in their order.
static void move_roots( wisp_frame* frame, const wisp_span* pair, const parts* has, strands_state* state )
{
    if ( has->has_head )
    {
        strands_jump( frame, pair, state );
        strands_root( frame, pair, state );
    }
    if ( has->is_anchored )
    {
        strands_anchor( frame, pair, state );
    }
    if ( has->has_pins )
    {
        strands_hold_pins( frame, pair, state );
    }
}

static void apply_forces( wisp_frame* frame, const wisp_span* pair, const parts* has, strands_state* state )
{
    if ( has->has_damping && has->has_head )
    {
        strands_damp( frame, pair, state );
    }
    if ( has->has_damping && has->is_anchored )
    {
        strands_damp_anchored( frame, pair, state );
    }
    if ( has->has_air )
    {
        strands_drag( frame, pair, state );
    }
}

// Point the arguments at a pair of groups.
static void select_pair( pair_args* batch, const pair_args* all, const wisp_span* pair )
{
    const int32_t* group_row = all->motion.group_row;
    const int first = group_row[pair->begin];
    const size_t vector = strands_vector( first, 0 ), scalar = strands_scalar( first, 0 );
    for ( int g = pair->begin; g <= pair->end; ++g )
    {
        batch->group_row[g - pair->begin] = group_row[g] - first;
    }
    batch->motion.position = batch->link.position = batch->stretch.position = all->motion.position + vector;
    batch->motion.velocity = all->motion.velocity + vector;
    batch->motion.inverse_mass = batch->link.inverse_mass = batch->stretch.inverse_mass =
        all->motion.inverse_mass + scalar;
    batch->motion.root = all->motion.root + strands_vector( pair->begin, 0 );
    batch->stretch.velocity = batch->motion.velocity;
    batch->stretch.length = all->stretch.length + scalar;
    if ( all->motion.acceleration_scale != NULL )
    {
        batch->motion.acceleration_scale = all->motion.acceleration_scale + strands_scalar( pair->begin, 0 );
    }
    if ( all->link.rest != NULL )
    {
        batch->link.rest = all->link.rest + scalar;
    }
}

// Forces need velocities before them. Without forces the next prediction computes the velocities.
static void run_pair( wisp_frame* frame, wisp_span pair, int substep_end, const parts* has, pair_args* batch,
                      float* tension, strands_state* state )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const int groups = pair.end - pair.begin, last = wisp_frame_substeps( frame ) - 1;
    const bool has_forces = has->has_damping || has->has_air;
    bool is_velocity_pending = false;
    for ( ; pair.substep < substep_end; ++pair.substep )
    {
        move_roots( frame, &pair, has, state );
        apply_forces( frame, &pair, has, state );
        ( is_velocity_pending ? kernels->strand_advance : kernels->strand_predict )( &batch->motion, 0, groups );
        if ( has->has_links )
        {
            kernels->strand_link( &batch->link, 0, groups );
        }
        batch->stretch.tension = pair.substep == last ? tension : NULL;
        strands_count_reset( frame, kernels->strand_stretch( &batch->stretch, 0, groups ) );
        is_velocity_pending = has_forces == false && pair.substep + 1 < substep_end;
        if ( is_velocity_pending == false )
        {
            kernels->strand_velocity( &batch->motion, 0, groups );
        }
    }
}

// Check bounds while the columns are in cache; the state check skips what is within bounds.
static void check_bounds( wisp_frame* frame, const wisp_span* pair, const pair_args* batch, int32_t* in_bounds )
{
    const wisp_strand_bound_args args = { batch->motion.position, batch->motion.velocity, STRANDS_BOUND };
    for ( int g = pair->begin; g < pair->end; ++g )
    {
        const int first = batch->group_row[g - pair->begin], last = batch->group_row[g - pair->begin + 1];
        in_bounds[g] = wisp_frame_kernels( frame )->strand_find_out_of_bounds( &args, first, last ) == last ? 1 : 0;
    }
}

void strands_substeps( wisp_frame* frame, const wisp_span* span, int substep_end, void* user )
{
    strands_state* state = user;
    const parts has = parts_of( frame, span->entity, state );
    pair_args all = { .motion = strands_motion_args( frame, span, state ),
                      .stretch = strands_stretch_args( frame, span, state ) };
    if ( has.has_links )
    {
        all.link = strands_bend_link_args( frame, span, state );
    }
    all.stretch.scratch = strands_scratch( frame, span, WISP_STRAND_SCRATCH + PREVIOUS_FLOATS );
    if ( all.stretch.scratch == NULL )
    {
        return;
    }
    const int32_t* group_row = all.motion.group_row;
    float* tension = wisp_frame_column( frame, span->entity, state->tension, 0 );
    int32_t* in_bounds = wisp_frame_column( frame, span->entity, state->in_bounds, 0 );
    pair_args batch = all;
    batch.motion.group_row = batch.link.group_row = batch.stretch.group_row = batch.group_row;
    batch.motion.previous = batch.stretch.previous =
        all.stretch.scratch + (size_t)( group_row[1] - group_row[0] ) * WISP_STRAND_SCRATCH;
    for ( wisp_span pair = *span; pair.begin < span->end; pair.begin = pair.end )
    {
        pair.end = pair.begin + PAIR < span->end ? pair.begin + PAIR : span->end;
        select_pair( &batch, &all, &pair );
        run_pair( frame, pair, substep_end, &has, &batch, tension + strands_scalar( group_row[pair.begin], 0 ),
                  state );
        if ( substep_end == wisp_frame_substeps( frame ) )
        {
            check_bounds( frame, &pair, &batch, in_bounds );
        }
    }
}
