// Tips that are held. In: how, and poses from rest relative to the root. Out: positions, inverse masses, frames.
//
// The tip is at x = x_root + R (x_tip0 - x_root0 + d), its frame is R q q_tip0: R the rotation of the root from rest, d and
// q of the pose. A loop, whose last vertex lies on its first, has the rest frame of its root in place of that of its last
// segment. As its root is held, the corner of the cyclic system of its lengths, -w_0 e_{n-1} . e_0, is 0, and what is left
// is the tridiagonal system of a strand between two ends.
#include "strand_passes.h"

#include "strand_rows.h"

#include <string.h>

static const wisp_transform AT_REST = { { 0.0f, 0.0f, 0.0f, 1.0f }, { 0.0f, 0.0f, 0.0f } };

enum
{
    HOLD = 0,
    FROM = 1,
    TO = 2,
    TARGET = 3,
    REST = 4,
    WEIGHT = 5,
    REACH = 6,
};

// ---- a step ----

void strands_move_tips( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_transform* from = wisp_frame_column( frame, span->entity, state->tips, FROM );
    wisp_transform* to = wisp_frame_column( frame, span->entity, state->tips, TO );
    const wisp_transform* target = wisp_frame_column( frame, span->entity, state->tips, TARGET );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        from[i] = wisp_frame_reached( frame, from[i], to[i] );
        to[i] = target[i];
    }
}

// Columns of a span with tips.
typedef struct tip_columns
{
    const wisp_strand_topology* topology;
    const int32_t* hold;
    const wisp_transform *from, *to;
    const float *root, *root_turn, *root_low;
    float progress;
} tip_columns;

static tip_columns columns_of( wisp_frame* frame, const wisp_span* span, const strands_state* state )
{
    return ( tip_columns ){
        .topology = wisp_frame_strands( frame, span->entity ),
        .hold = wisp_frame_column( frame, span->entity, state->tips, HOLD ),
        .from = wisp_frame_column( frame, span->entity, state->tips, FROM ),
        .to = wisp_frame_column( frame, span->entity, state->tips, TO ),
        .root = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 0 ),
        .root_turn = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 ),
        .root_low = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 2 ),
        .progress = wisp_frame_progress( frame, span->entity, span->substep + 1 ),
    };
}

static int tip_row( const wisp_strand_topology* t, int i )
{
    return t->group_row[i / WISP_LANES] + t->lane_count[i] - 1;
}

// Return the pose of a tip at the end of the substep. One that rests keeps its pose exactly.
static wisp_transform pose_of( const tip_columns* c, int i )
{
    const bool is_still = memcmp( &c->from[i], &c->to[i], sizeof( wisp_transform ) ) == 0;
    return is_still ? c->to[i] : wisp_transform_interpolate( c->from[i], c->to[i], c->progress );
}

void strands_hold_tips( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const tip_columns c = columns_of( frame, span, state );
    const float* rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
    const float* reach = wisp_frame_column( frame, span->entity, state->tips, REACH );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    float* low = wisp_frame_column( frame, span->entity, state->low, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const float inverse_dt = 1.0f / wisp_frame_dt( frame, span->entity );
    const bool is_last = span->substep + 1 == wisp_frame_substeps( frame, span->entity );
    uint64_t stretched = 0;
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        if ( ( c.hold[i] & WISP_STRAND_TIP_PINNED ) == 0 )
        {
            continue;
        }
        const int group = i / WISP_LANES, lane = i % WISP_LANES, row = tip_row( c.topology, i );
        const wisp_vec3 at_rest =
            wisp_v3_sub( strands_get( rest, row, lane ), strands_get( rest, c.topology->group_row[group], lane ) );
        const wisp_vec3 turned = wisp_quat_rotate( strands_get_quat( c.root_turn, group, lane ),
                                                   wisp_v3_add( at_rest, pose_of( &c, i ).translation ) );
        const wisp_vec3 from = strands_get( c.root, group, lane );
        const wisp_vec3 arm = wisp_v3_add( turned, strands_get( c.root_low, group, lane ) );
        strands_put_held( position, low, velocity, row, lane, from, arm, inverse_dt );
        stretched += is_last && wisp_v3_length( turned ) > 1.001f * reach[i] ? 1 : 0;
    }
    if ( stretched > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_STRETCHED, stretched );
    }
}

void strands_turn_tips( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const tip_columns c = columns_of( frame, span, state );
    const float* rest = wisp_frame_column( frame, span->entity, state->tips, REST );
    float* frames = wisp_frame_column( frame, span->entity, state->curve, 0 );
    float* direction = wisp_frame_column( frame, span->entity, state->tip_rows, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        if ( ( c.hold[i] & WISP_STRAND_TIP_GUIDED ) == 0 )
        {
            continue;
        }
        const int group = i / WISP_LANES, lane = i % WISP_LANES, row = tip_row( c.topology, i );
        const wisp_quat own = wisp_quat_multiply( pose_of( &c, i ).rotation, strands_get_quat( rest, group, lane ) );
        const wisp_quat q = wisp_quat_multiply( strands_get_quat( c.root_turn, group, lane ), own );
        strands_put_quat( frames, row, lane, q );
        strands_put( direction, row, lane, wisp_quat_rotate( q, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } ) );
    }
}

// ---- between steps ----

bool strands_guides_tips( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const int32_t* hold = wisp_world_column( world, strands, state->tips, HOLD );
    for ( int i = 0; hold != NULL && i < t->group_count * WISP_LANES; ++i )
    {
        if ( ( hold[i] & WISP_STRAND_TIP_GUIDED ) != 0 )
        {
            return true;
        }
    }
    return false;
}

static double natural_twist_at( wisp_world* world, wisp_entity strands, const strands_state* state, int i,
                                int vertex )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const strands_section* section = wisp_world_column( world, strands, state->section, 0 );
    const float* length = wisp_world_column( world, strands, WISP_STRAND_LENGTH, 0 );
    return strands_natural_twist( length, t->group_row[i / WISP_LANES], vertex, t->lane_count[i], i % WISP_LANES,
                                  section != NULL ? (double)section->twist : 0.0 );
}

// Return the frame of a tip at rest: that of the last segment with its natural twist, of a loop that of the root.
static wisp_quat rest_frame( wisp_world* world, wisp_entity strands, const strands_state* state, int i )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const float* clamp = wisp_world_column( world, strands, state->clamp, 0 );
    const int lane = i % WISP_LANES, first = rows.topology->group_row[i / WISP_LANES];
    if ( clamp == NULL )
    {
        return AT_REST.rotation;
    }
    wisp_quat q = strands_get_quat( clamp, i / WISP_LANES, lane );
    const bool is_loop = strands_is_loop( rows.rest, first, rows.topology->lane_count[i], lane );
    for ( int v = 0; v < rows.topology->lane_count[i] && is_loop == false; ++v )
    {
        if ( v + 1 < rows.topology->lane_count[i] )
        {
            q = strands_transport_frame( q, wisp_v3_sub( strands_get( rows.rest, first + v + 1, lane ),
                                                         strands_get( rows.rest, first + v, lane ) ) );
        }
        q = strands_twist_frame( q, natural_twist_at( world, strands, state, i, v ) );
    }
    return q;
}

void strands_cook_tips( wisp_world* world, wisp_entity strands, const strands_state* state )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const wisp_strand_topology* t = rows.topology;
    const int32_t* hold = wisp_world_column( world, strands, state->tips, HOLD );
    float* weight = wisp_world_column( world, strands, WISP_STRAND_INVERSE_MASS, 0 );
    float* released = wisp_world_column( world, strands, state->tips, WEIGHT );
    float* reach = wisp_world_column( world, strands, state->tips, REACH );
    float* rest = wisp_world_column( world, strands, state->tips, REST );
    for ( int i = 0; hold != NULL && i < t->group_count * WISP_LANES; ++i )
    {
        const int lane = i % WISP_LANES;
        reach[i] = 0.0f;
        for ( int row = t->group_row[i / WISP_LANES]; row < tip_row( t, i ); ++row )
        {
            reach[i] += rows.length[strands_scalar( row, lane )];
        }
        if ( t->lane_count[i] > 1 )
        {
            const size_t tip = strands_scalar( tip_row( t, i ), lane );
            released[i] = weight[tip];
            weight[tip] = ( hold[i] & WISP_STRAND_TIP_PINNED ) != 0 ? 0.0f : weight[tip];
            strands_put_quat( rest, i / WISP_LANES, lane, rest_frame( world, strands, state, i ) );
        }
    }
}

// Attach what tips need. Without memory nothing changes.
static wisp_status attach( wisp_world* world, wisp_entity strands, const strands_state* state, bool is_guided )
{
    const wisp_component_use uses[] = {
        { state->tips, true }, { state->tip_rows, true }, { state->curve, true }, { state->balance, true }
    };
    const bool had_tips = wisp_world_has( world, strands, state->tips );
    const bool had_frames = wisp_world_has( world, strands, state->curve );
    WISP_TRY( wisp_world_set_components( world, strands, uses, is_guided ? 4 : 2 ) );
    if ( had_tips == false )
    {
        const wisp_strand_topology* t = wisp_world_strands( world, strands );
        for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
        {
            for ( int k = FROM; k <= TARGET; ++k )
            {
                ( (wisp_transform*)wisp_world_column( world, strands, state->tips, k ) )[i] = AT_REST;
            }
        }
        strands_cook_tips( world, strands, state );
    }
    if ( had_frames == false && is_guided )
    {
        strands_make_frames( world, strands, state );
    }
    return WISP_OK;
}

// Return the pose in which a tip is at present.
static wisp_transform present_pose( wisp_world* world, wisp_entity strands, const strands_state* state, int i )
{
    const strands_rows rows = strands_rows_of( world, strands );
    const int lane = i % WISP_LANES, group = i / WISP_LANES;
    const int first = rows.topology->group_row[group], last = tip_row( rows.topology, i );
    const float* position = wisp_world_column( world, strands, WISP_STRAND_POSITION, 0 );
    const float* frames = wisp_world_column( world, strands, state->curve, 0 );
    const wisp_quat back = strands_quat_inverse(
        strands_get_quat( wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 ), group, lane ) );
    if ( strands_is_loop( rows.rest, first, rows.topology->lane_count[i], lane ) )
    {
        return AT_REST;
    }
    const wisp_vec3 at_rest =
        wisp_v3_sub( strands_get( rows.rest, last, lane ), strands_get( rows.rest, first, lane ) );
    const wisp_vec3 now =
        wisp_v3_sub( strands_get( position, last, lane ),
                     strands_get( wisp_world_column( world, strands, WISP_STRAND_ROOT, 0 ), group, lane ) );
    const wisp_vec3 displacement = wisp_v3_sub( wisp_quat_rotate( back, now ), at_rest );
    if ( frames == NULL )
    {
        return wisp_transform_make( AT_REST.rotation, displacement );
    }
    const wisp_quat rest = strands_get_quat( wisp_world_column( world, strands, state->tips, REST ), group, lane );
    const wisp_quat own =
        strands_twist_frame( strands_get_quat( frames, last - 1, lane ),
                             natural_twist_at( world, strands, state, i, rows.topology->lane_count[i] - 1 ) );
    const wisp_quat turn = wisp_quat_multiply( back, wisp_quat_multiply( own, strands_quat_inverse( rest ) ) );
    return wisp_transform_make( turn, displacement );
}

static wisp_status check_strand( wisp_world* world, const wisp_strand_topology* t, int strand )
{
    if ( strand < 0 || strand >= t->strand_count )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: got the tip of strand %d, expected 0 .. %d", strand,
                                t->strand_count - 1 );
    }
    if ( t->offsets[strand + 1] - t->offsets[strand] < 2 )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: strand %d has one vertex, its root, and no tip",
                                strand );
    }
    return WISP_OK;
}

// Give a strand its new hold, and have its masses and factors computed again.
static void set_hold( wisp_world* world, wisp_entity strands, const strands_state* state, int i,
                      wisp_strand_tip hold )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    int32_t* holds = wisp_world_column( world, strands, state->tips, HOLD );
    const float* released = wisp_world_column( world, strands, state->tips, WEIGHT );
    float* weight = wisp_world_column( world, strands, WISP_STRAND_INVERSE_MASS, 0 );
    float* step = wisp_world_column( world, strands, state->history, 2 );
    float* direction = wisp_world_column( world, strands, state->tip_rows, 0 );
    const int lane = i % WISP_LANES, row = tip_row( t, i );
    const int32_t before = holds[i];
    if ( before == (int32_t)hold )
    {
        return;
    }
    holds[i] = (int32_t)hold;
    if ( hold != WISP_STRAND_TIP_FREE && before == WISP_STRAND_TIP_FREE )
    {
        const wisp_transform pose = present_pose( world, strands, state, i );
        for ( int k = FROM; k <= TARGET; ++k )
        {
            ( (wisp_transform*)wisp_world_column( world, strands, state->tips, k ) )[i] = pose;
        }
    }
    weight[strands_scalar( row, lane )] = ( hold & WISP_STRAND_TIP_PINNED ) != 0 ? 0.0f : released[i];
    strands_put( direction, row, lane, ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f } );
    if ( step != NULL )
    {
        float* own = step + strands_scalar( t->group_row[i / WISP_LANES], lane );
        *own = *own != 0.0f ? -1.0f : 0.0f;
    }
    strands_refactor( world, strands, state, i );
    strands_reset_rest( world, strands, state );
}

wisp_status wisp_hold_strand_tip( wisp_world* world, wisp_entity strands, int strand, wisp_strand_tip hold )
{
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    WISP_TRY( check_strand( world, t, strand ) );
    const bool is_guided = hold == WISP_STRAND_TIP_GUIDED || hold == WISP_STRAND_TIP_CLAMPED;
    if ( is_guided == false && hold != WISP_STRAND_TIP_FREE && hold != WISP_STRAND_TIP_PINNED )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: got hold %d of the tip of strand %d, expected 0 .. %d", (int)hold, strand,
                                WISP_STRAND_TIP_COUNT - 1 );
    }
    if ( is_guided && wisp_world_has( world, strands, state->rod ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT,
                                "strands: entity %u does not bend as rods, so the tip of strand %d has no direction",
                                strands.index, strand );
    }
    const strands_settings* settings = wisp_world_column( world, strands, state->settings, 0 );
    if ( settings->is_free != 0 )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: the roots of entity %u are free, and so are the tips",
                                strands.index );
    }
    if ( hold == WISP_STRAND_TIP_FREE && wisp_world_has( world, strands, state->tips ) == false )
    {
        return WISP_OK;
    }
    WISP_TRY( attach( world, strands, state, is_guided ) );
    set_hold( world, strands, state, strands_lane_of( t, t->offsets[strand] ), hold );
    return WISP_OK;
}

wisp_status wisp_move_strand_tip( wisp_world* world, wisp_entity strands, int strand, wisp_transform pose )
{
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    WISP_TRY( check_strand( world, t, strand ) );
    WISP_TRY( strands_check_pose( world, "tip", pose ) );
    const int i = strands_lane_of( t, t->offsets[strand] );
    const int32_t* hold = wisp_world_column( world, strands, state->tips, HOLD );
    if ( hold == NULL || hold[i] == WISP_STRAND_TIP_FREE )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: the tip of strand %d of entity %u is free", strand,
                                strands.index );
    }
    wisp_transform* target = wisp_world_column( world, strands, state->tips, TARGET );
    target[i] = wisp_transform_make( pose.rotation, pose.translation );
    return WISP_OK;
}
