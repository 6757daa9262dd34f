// Fused substeps: all substeps of two groups of strands in one pass, for direct lengths without contact. The
// columns of two groups stay in the first-level cache, the prediction of a substep ends the one before, and positions
// stay at the start of a substep while velocities are solved. A fifth less time than pass by pass (bench case
// "strands"), with the same bits.
#include "strand_passes.h"

#include "strand_rows.h"

enum
{
    PAIR = 2,                            // kernels interleave two groups
    PAIR_FLOATS = PAIR * 4 * WISP_LANES, // per row: segments and speeds
};

// Optional components of an entity.
typedef struct parts
{
    bool has_head, is_anchored, has_pins, has_links;
    bool has_damping, has_air, has_rod, has_frames, has_history;
    bool has_tips;
} parts;

// Arguments of kernels for one pair: columns start at its first row.
typedef struct pair_args
{
    int32_t group_row[PAIR + 1];
    wisp_strand_motion_args motion;
    wisp_strand_link_args link;
    wisp_strand_rod_args rod;
    wisp_strand_stretch_args stretch;
    float* tension; // of lengths, in the last substep; of rods in all
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
        .has_rod = wisp_frame_has( frame, entity, state->rod ),
        .has_frames = wisp_frame_has( frame, entity, state->curve ),
        .has_history = wisp_frame_has( frame, entity, state->history ),
        .has_tips = wisp_frame_has( frame, entity, state->tips ),
    };
}

// Run the passes of roots, in their order.
static void move_roots( wisp_frame* frame, const wisp_span* pair, const parts* has, strands_state* state )
{
    if ( has->has_head )
    {
        strands_jump( frame, pair, state );
        if ( has->has_frames )
        {
            strands_jump_frames( frame, pair, state );
        }
        strands_root( frame, pair, state );
    }
    if ( has->is_anchored )
    {
        strands_anchor( frame, pair, state );
        if ( has->has_frames )
        {
            strands_anchor_frames( frame, pair, state );
        }
    }
    if ( has->has_pins )
    {
        strands_hold_pins( frame, pair, state );
    }
    if ( has->has_tips )
    {
        strands_hold_tips( frame, pair, state );
        if ( has->has_frames )
        {
            strands_turn_tips( frame, pair, state );
        }
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
    batch->motion.low = batch->stretch.low = all->motion.low + vector;
    batch->link.low = batch->motion.low;
    batch->motion.velocity = batch->link.velocity = all->motion.velocity + vector;
    batch->motion.inverse_mass = batch->link.inverse_mass = batch->stretch.inverse_mass =
        all->motion.inverse_mass + scalar;
    batch->motion.root = all->motion.root + strands_vector( pair->begin, 0 );
    batch->motion.root_low = all->motion.root_low + strands_vector( pair->begin, 0 );
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
    batch->tension = all->tension + scalar;
}

// Point the history at a pair of groups.
static void select_history( pair_args* batch, const pair_args* all, const wisp_span* pair )
{
    const wisp_strand_history* h = &all->motion.history;
    const int first = all->motion.group_row[pair->begin];
    const size_t vector = strands_vector( first, 0 );
    batch->motion.history =
        ( wisp_strand_history ){ h->displacement + vector, h->before + vector, h->step + strands_scalar( first, 0 ) };
    batch->link.history = batch->rod.history = batch->stretch.history = batch->motion.history;
    if ( all->rod.first_order_factor != NULL )
    {
        batch->rod.first_order_factor = all->rod.first_order_factor + vector;
    }
}

// Point the arguments of rods at a pair of groups.
static void select_rods( pair_args* batch, const pair_args* all, const wisp_span* pair )
{
    const int first = all->motion.group_row[pair->begin];
    const size_t vector = strands_vector( first, 0 ), scalar = strands_scalar( first, 0 );
    const size_t quat = strands_quat( first, 0 ), group_quat = strands_quat( pair->begin, 0 );
    wisp_strand_rod_args* rod = &batch->rod;
    rod->velocity = batch->motion.velocity;
    rod->inverse_mass = batch->motion.inverse_mass;
    rod->acceleration_scale = batch->motion.acceleration_scale;
    rod->inverse_length = all->rod.inverse_length + scalar;
    rod->stiffness = all->rod.stiffness + scalar;
    rod->factor = all->rod.factor + vector;
    rod->tension = batch->tension;
    rod->max_tension = all->rod.max_tension + scalar;
    rod->root = all->rod.root + group_quat;
    rod->clamp = all->rod.clamp + group_quat;
    if ( all->rod.frame != NULL )
    {
        rod->frame = all->rod.frame + quat;
        rod->rest = all->rod.rest + vector;
        rod->rest_twist = all->rod.rest_twist + 2 * scalar;
        rod->twist_stiffness = all->rod.twist_stiffness + scalar;
    }
    if ( all->rod.response != NULL )
    {
        rod->response = all->rod.response + 2 * scalar;
    }
    if ( all->rod.tip != NULL )
    {
        rod->tip = all->rod.tip + vector;
    }
}

static void bend_pair( wisp_frame* frame, const wisp_span* pair, const parts* has, const pair_args* batch,
                       strands_state* state )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const int groups = pair->end - pair->begin;
    if ( has->has_links )
    {
        kernels->strand_link( &batch->link, 0, groups );
    }
    if ( has->has_frames )
    {
        strands_begin_with_rest_tension( frame, pair, state );
    }
    if ( has->has_rod )
    {
        kernels->strand_rod( &batch->rod, 0, groups );
    }
}

// Begin a substep whose predecessor has ended.
static void begin_pair( wisp_frame* frame, const wisp_span* pair, const parts* has, const pair_args* batch,
                        strands_state* state )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const int groups = pair->end - pair->begin;
    if ( has->has_history )
    {
        kernels->strand_extrapolate( &batch->motion, 0, groups );
    }
    apply_forces( frame, pair, has, state );
    kernels->strand_predict( &batch->motion, 0, groups );
}

// Forces need the substep before them ended. Without them the next prediction ends it.
static void run_pair( wisp_frame* frame, wisp_span pair, int substep_end, const parts* has, pair_args* batch,
                      strands_state* state )
{
    const wisp_kernels* kernels = wisp_frame_kernels( frame );
    const int groups = pair.end - pair.begin, last = wisp_frame_substeps( frame, pair.entity ) - 1;
    const bool has_forces = has->has_damping || has->has_air;
    bool is_end_pending = false;
    for ( ; pair.substep < substep_end; ++pair.substep )
    {
        move_roots( frame, &pair, has, state );
        if ( is_end_pending )
        {
            strands_count_first_order( frame, kernels->strand_advance( &batch->motion, 0, groups ) );
        }
        else
        {
            begin_pair( frame, &pair, has, batch, state );
        }
        bend_pair( frame, &pair, has, batch, state );
        batch->stretch.tension = has->has_rod || pair.substep == last ? batch->tension : NULL;
        strands_count_reset( frame, kernels->strand_stretch( &batch->stretch, 0, groups ) );
        is_end_pending = has_forces == false && pair.substep + 1 < substep_end;
        if ( is_end_pending == false )
        {
            strands_count_first_order( frame, kernels->strand_velocity( &batch->motion, 0, groups ) );
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
    all.stretch.accumulates_tension = all.stretch.accumulates_tension && has.has_rod; // fused loops take no turns
    if ( has.has_links )
    {
        all.link = strands_bend_link_args( frame, span, state );
    }
    if ( has.has_rod )
    {
        all.rod = strands_rod_args( frame, span, state, has.has_frames );
    }
    const int section_floats = all.rod.flatness > 0.0f || all.rod.response != NULL ? WISP_STRAND_SECTION_SCRATCH : 0;
    all.stretch.scratch = strands_scratch( frame, span, WISP_STRAND_SCRATCH + PAIR_FLOATS + section_floats );
    if ( all.stretch.scratch == NULL )
    {
        return;
    }
    const int32_t* group_row = all.motion.group_row;
    all.tension = wisp_frame_column( frame, span->entity, state->tension, 0 );
    int32_t* in_bounds = wisp_frame_column( frame, span->entity, state->in_bounds, 0 );
    pair_args batch = all;
    batch.motion.group_row = batch.link.group_row = batch.rod.group_row = batch.stretch.group_row = batch.group_row;
    float* behind = all.stretch.scratch + (size_t)( group_row[1] - group_row[0] ) * WISP_STRAND_SCRATCH;
    batch.motion.previous = batch.stretch.previous = NULL;
    batch.link.previous = batch.rod.previous = NULL;
    batch.motion.speed = behind + (size_t)( group_row[1] - group_row[0] ) * PAIR * 3 * WISP_LANES;
    batch.stretch.speed = batch.motion.speed;
    batch.motion.segment = batch.link.segment = batch.rod.segment = batch.stretch.segment = behind;
    batch.rod.scratch = all.stretch.scratch;
    batch.rod.section_scratch = behind + (size_t)( group_row[1] - group_row[0] ) * PAIR_FLOATS;
    for ( wisp_span pair = *span; pair.begin < span->end; pair.begin = pair.end )
    {
        pair.end = pair.begin + PAIR < span->end ? pair.begin + PAIR : span->end;
        select_pair( &batch, &all, &pair );
        if ( has.has_history )
        {
            select_history( &batch, &all, &pair );
        }
        if ( has.has_rod )
        {
            select_rods( &batch, &all, &pair );
        }
        run_pair( frame, pair, substep_end, &has, &batch, state );
        if ( substep_end == wisp_frame_substeps( frame, span->entity ) )
        {
            check_bounds( frame, &pair, &batch, in_bounds );
        }
    }
}
