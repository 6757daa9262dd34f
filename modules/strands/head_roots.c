// Roots on a head: a rigid motion, interpolated over the substeps. In: poses of the head. Out: positions and
// rotations of roots, pinned vertices behind them; strands that teleport.
#include "strand_passes.h"

#include "strand_rows.h"

#include <string.h>

// ---- the head ----

// Move the head. Beyond the teleport distance, and where strands are not solved, it takes them along as rigid bodies. Those that
// are not solved get a velocity by that, so there is one more such motion when the head stops.
void strands_move_head( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    const int32_t jumped = head->jumped;
    head->from = jumped != 0 ? head->to : wisp_frame_reached( frame, head->from, head->to );
    head->to = head->target;
    const float displacement = wisp_v3_length( wisp_v3_sub( head->to.translation, head->from.translation ) );
    const bool moves = memcmp( &head->from, &head->to, sizeof( wisp_transform ) ) != 0;
    const int32_t posed = moves ? STRANDS_CARRIED : jumped == STRANDS_CARRIED ? STRANDS_STOPPED : 0;
    const bool is_solved = wisp_frame_detail( frame, span->entity ).level != WISP_DETAIL_NOTHING;
    head->jumped = is_solved ? ( displacement > settings->teleport ? STRANDS_JUMPED : 0 ) : posed;
    head->is_still = memcmp( &head->from, &head->to, sizeof( wisp_transform ) ) == 0 ? 1 : 0;
}

wisp_transform strands_head_pose( wisp_frame* frame, wisp_entity strands, const strands_head* head, int substeps )
{
    // a head that stands still keeps its pose exactly in every substep
    const bool is_still = head->jumped != 0 || head->is_still != 0;
    return wisp_transform_interpolate( is_still ? head->to : head->from, head->to,
                                       is_still ? 1.0f : wisp_frame_progress( frame, strands, substeps ) );
}

// Columns of strands that are turned.
typedef struct turned_columns
{
    float *position, *low, *velocity;
    float inverse_seconds; // of the step; 0: velocities turn
} turned_columns;

static void turn_vertex( const turned_columns* c, int row, int lane, wisp_vec3 from, wisp_vec3 to, wisp_quat turn )
{
    const wisp_vec3 old = strands_get( c->position, row, lane );
    const wisp_vec3 low = strands_get( c->low, row, lane );
    const wisp_vec3 arm = wisp_v3_add( wisp_v3_sub( strands_get( c->position, row, lane ), from ), low );
    const wisp_vec3 turned = wisp_quat_rotate( turn, arm ), put = wisp_v3_add( to, turned );
    strands_put( c->position, row, lane, put );
    const wisp_vec3 displacement = wisp_v3_sub( put, old );
    const wisp_vec3 speed = { c->inverse_seconds * displacement.x, c->inverse_seconds * displacement.y,
                              c->inverse_seconds * displacement.z };
    strands_put( c->velocity, row, lane,
                 c->inverse_seconds > 0.0f ? speed
                                           : wisp_quat_rotate( turn, strands_get( c->velocity, row, lane ) ) );
    strands_put( c->low, row, lane, strands_low_vector( to, turned, put ) );
}

void strands_turn( wisp_frame* frame, wisp_entity entity, const strands_state* state, int group, int lane,
                   wisp_vec3 from, wisp_vec3 to, wisp_quat turn )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    const bool is_posed = wisp_frame_detail( frame, entity ).level == WISP_DETAIL_NOTHING;
    const float seconds = wisp_frame_dt( frame, entity ) * (float)wisp_frame_substeps( frame, entity );
    const turned_columns c = {
        .position = wisp_frame_column( frame, entity, WISP_STRAND_POSITION, 0 ),
        .low = wisp_frame_column( frame, entity, state->low, 0 ),
        .velocity = wisp_frame_column( frame, entity, WISP_STRAND_VELOCITY, 0 ),
        .inverse_seconds = is_posed ? 1.0f / seconds : 0.0f,
    };
    for ( int v = 0; v < t->lane_count[group * WISP_LANES + lane]; ++v )
    {
        turn_vertex( &c, t->group_row[group] + v, lane, from, to, turn );
    }
    if ( wisp_frame_has( frame, entity, state->history ) )
    {
        float* step = wisp_frame_column( frame, entity, state->history, 2 );
        step[strands_scalar( t->group_row[group], lane )] = -1.0f;
    }
}

void strands_turn_frames( wisp_frame* frame, wisp_entity entity, wisp_component curve, int group, int lane,
                          wisp_quat turn )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    float* frames = wisp_frame_column( frame, entity, curve, 0 );
    for ( int v = 0; v < t->lane_count[group * WISP_LANES + lane]; ++v )
    {
        const int row = t->group_row[group] + v;
        strands_put_quat( frames, row, lane, wisp_quat_multiply( turn, strands_get_quat( frames, row, lane ) ) );
    }
}

static wisp_quat turn_of( const strands_head* head )
{
    return wisp_quat_multiply( head->to.rotation, strands_quat_inverse( head->from.rotation ) );
}

void strands_jump( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    const int end = head->jumped != 0 && span->substep == 0 ? span->end * WISP_LANES : 0;
    for ( int i = span->begin * WISP_LANES; i < end; ++i )
    {
        strands_turn( frame, span->entity, state, i / WISP_LANES, i % WISP_LANES, head->from.translation,
                      head->to.translation, turn_of( head ) );
    }
}

void strands_jump_frames( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    const int end = head->jumped != 0 && span->substep == 0 ? span->end * WISP_LANES : 0;
    for ( int i = span->begin * WISP_LANES; i < end; ++i )
    {
        strands_turn_frames( frame, span->entity, state->curve, i / WISP_LANES, i % WISP_LANES, turn_of( head ) );
    }
}

// One coordinate of a pose, for sixteen lanes at once.
typedef struct pose_row
{
    float x, y, z; // of the rotation
    float to;      // m, of the translation at the end of the step
    float before;  // m, from there to the translation of the pose
} pose_row;

static void make_pose_rows( const strands_head* head, wisp_transform pose, float left, pose_row rows[3] )
{
    const wisp_vec3 x = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 1.0f, 0.0f, 0.0f } );
    const wisp_vec3 y = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 0.0f, 1.0f, 0.0f } );
    const wisp_vec3 z = wisp_quat_rotate( pose.rotation, ( wisp_vec3 ){ 0.0f, 0.0f, 1.0f } );
    const wisp_vec3 to = head->to.translation, displacement = wisp_v3_sub( to, head->from.translation );
    rows[0] = ( pose_row ){ x.x, y.x, z.x, to.x, -left * displacement.x };
    rows[1] = ( pose_row ){ x.y, y.y, z.y, to.y, -left * displacement.y };
    rows[2] = ( pose_row ){ x.z, y.z, z.z, to.z, -left * displacement.z };
}

// The arm is added last, so that it keeps its digits in the low part.
static void transform_lanes( pose_row row, const float* rest, float* out, float* low )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        const float arm =
            row.x * rest[lane] + row.y * rest[WISP_LANES + lane] + row.z * rest[2 * WISP_LANES + lane] + row.before;
        out[lane] = row.to + arm;
        low[lane] = strands_low( row.to, arm, out[lane] );
    }
}

static void fill_lanes( float value, float* out )
{
    for ( int lane = 0; lane < WISP_LANES; ++lane )
    {
        out[lane] = value;
    }
}

void strands_root( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    if ( head->is_still != 0 )
    {
        return; // roots are in place
    }
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 0 );
    float* rotation = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 );
    float* low = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 2 );
    const wisp_transform pose = strands_head_pose( frame, span->entity, head, span->substep + 1 );
    const float left =
        head->jumped != 0 ? 0.0f : 1.0f - wisp_frame_progress( frame, span->entity, span->substep + 1 );
    pose_row rows[3];
    make_pose_rows( head, pose, left, rows );
    for ( int g = span->begin; g < span->end; ++g )
    {
        const float* from = rest + strands_vector( t->group_row[g], 0 );
        for ( int k = 0; k < 3; ++k )
        {
            const size_t at = strands_vector( g, 0 ) + (size_t)k * WISP_LANES;
            transform_lanes( rows[k], from, position + at, low + at );
        }
        float* turn = rotation + (size_t)g * 4 * WISP_LANES;
        fill_lanes( pose.rotation.x, turn );
        fill_lanes( pose.rotation.y, turn + WISP_LANES );
        fill_lanes( pose.rotation.z, turn + 2 * WISP_LANES );
        fill_lanes( pose.rotation.w, turn + 3 * WISP_LANES );
    }
}

// Move pinned vertices behind the root as at rest. They are put at the end of the substep, with the velocity that
// takes them there, before the prediction runs.
void strands_hold_pins( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float* rest = wisp_frame_column( frame, span->entity, WISP_STRAND_REST, 0 );
    const float* weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 );
    const float* root = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 0 );
    const float* rotation = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 1 );
    const float* root_low = wisp_frame_column( frame, span->entity, WISP_STRAND_ROOT, 2 );
    float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    float* low = wisp_frame_column( frame, span->entity, state->low, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const float inverse_dt = 1.0f / wisp_frame_dt( frame, span->entity );
    const int32_t* hold = wisp_frame_column( frame, span->entity, state->tips, 0 );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int group = i / WISP_LANES, lane = i % WISP_LANES, first = t->group_row[group];
        const wisp_vec3 from = strands_get( root, group, lane );
        const bool is_tip_held = hold != NULL && ( hold[i] & WISP_STRAND_TIP_PINNED ) != 0;
        for ( int row = first + 1; row < first + t->lane_count[i] - ( is_tip_held ? 1 : 0 ); ++row )
        {
            if ( weight[strands_scalar( row, lane )] > 0.0f )
            {
                continue;
            }
            const wisp_vec3 at_rest = wisp_v3_sub( strands_get( rest, row, lane ), strands_get( rest, first, lane ) );
            const wisp_vec3 arm = wisp_v3_add( wisp_quat_rotate( strands_get_quat( rotation, group, lane ), at_rest ),
                                               strands_get( root_low, group, lane ) );
            strands_put_held( position, low, velocity, row, lane, from, arm, inverse_dt );
        }
    }
}

// ---- bounds ----

// Return how far a root goes at most in a step, whose bounds before it are these: the displacement of the head, and the chord of
// its rotation.
static float root_displacement( const strands_head* head, const float lower[3], const float upper[3] )
{
    const wisp_vec3 from = head->from.translation;
    const wisp_vec3 arm = { fmaxf( fabsf( lower[0] - from.x ), fabsf( upper[0] - from.x ) ),
                            fmaxf( fabsf( lower[1] - from.y ), fabsf( upper[1] - from.y ) ),
                            fmaxf( fabsf( lower[2] - from.z ), fabsf( upper[2] - from.z ) ) };
    const wisp_quat turn = wisp_quat_multiply( head->to.rotation, strands_quat_inverse( head->from.rotation ) );
    const float half_sine = wisp_v3_length( ( wisp_vec3 ){ turn.x, turn.y, turn.z } );
    return wisp_v3_length( wisp_v3_sub( head->to.translation, from ) ) + 2.0f * half_sine * wisp_v3_length( arm );
}

// Find the bounds of the roots. @return m, length of the longest strand
static float measure_strands( wisp_frame* frame, wisp_entity entity, float lower[3], float upper[3] )
{
    const wisp_strand_topology* t = wisp_frame_strands( frame, entity );
    const float* root = wisp_frame_column( frame, entity, WISP_STRAND_ROOT, 0 );
    const float* length = wisp_frame_column( frame, entity, WISP_STRAND_LENGTH, 0 );
    float longest = 0.0f;
    for ( int g = 0; g < t->group_count; ++g )
    {
        float sum[WISP_LANES] = { 0 };
        for ( size_t i = strands_scalar( t->group_row[g], 0 ); i < strands_scalar( t->group_row[g + 1], 0 ); ++i )
        {
            sum[i % WISP_LANES] += length[i];
        }
        for ( int i = 0; i < 4 * WISP_LANES; ++i )
        {
            const int lane = i / 4, k = i % 4;
            const bool is_strand = t->lane_count[g * WISP_LANES + lane] > 0;
            if ( is_strand && k < 3 )
            {
                const float at = root[strands_vector( g, 0 ) + (size_t)( k * WISP_LANES + lane )];
                lower[k] = fminf( lower[k], at );
                upper[k] = fmaxf( upper[k], at );
            }
            longest = is_strand ? fmaxf( longest, sum[lane] ) : longest;
        }
    }
    return longest;
}

// Find bounds of a step: roots follow the head, and the direct solve leaves no strand longer than its tolerance allows. Pins and
// tips can pull it longer.
void strands_find_reach( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_component pulling[] = { state->pins, state->tips, state->closed, WISP_PARTICLE_FRAME };
    const strands_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const strands_head* head = wisp_frame_column( frame, span->entity, state->head, 0 );
    const strands_direct* direct = wisp_frame_column( frame, span->entity, state->direct, 0 );
    int32_t* known = wisp_frame_column( frame, span->entity, WISP_STRAND_REACH, 1 );
    *known = head != NULL && direct != NULL && settings->is_free == 0 ? 1 : 0;
    for ( int i = 0; i < WISP_COUNT( pulling ); ++i )
    {
        *known = wisp_frame_has( frame, span->entity, pulling[i] ) ? 0 : *known;
    }
    if ( *known == 0 )
    {
        return;
    }
    float lower[3] = { INFINITY, INFINITY, INFINITY }, upper[3] = { -INFINITY, -INFINITY, -INFINITY };
    const float longest = measure_strands( frame, span->entity, lower, upper );
    const float ROUNDING = 1.001f;
    const float out = ROUNDING * ( root_displacement( head, lower, upper ) + ( 1.0f + direct->tolerance ) * longest );
    float* bounds = wisp_frame_column( frame, span->entity, WISP_STRAND_REACH, 0 );
    for ( int k = 0; k < 3; ++k )
    {
        bounds[k] = lower[k] - out;
        bounds[3 + k] = upper[k] + out;
    }
}

wisp_status strands_check_pose( wisp_world* world, const char* what, wisp_transform pose )
{
    const wisp_vec3 p = pose.translation;
    const wisp_quat q = pose.rotation;
    if ( !( fabsf( p.x ) <= 1e6f && fabsf( p.y ) <= 1e6f && fabsf( p.z ) <= 1e6f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT,
                                "strands: the %s at (%g, %g, %g) is not within 1e6 m of the origin", what,
                                (double)p.x, (double)p.y, (double)p.z );
    }
    const float squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
    if ( !( squared >= 1e-12f && squared <= 1e12f ) )
    {
        return wisp_world_fail( world, WISP_BAD_INPUT, "strands: the quaternion (%g, %g, %g, %g) is not a rotation",
                                (double)q.x, (double)q.y, (double)q.z, (double)q.w );
    }
    return WISP_OK;
}

wisp_status wisp_move_strand_head( wisp_world* world, wisp_entity strands, wisp_transform pose )
{
    strands_state* state;
    WISP_TRY( strands_find( world, strands, &state ) );
    WISP_TRY( strands_check_pose( world, "head", pose ) );
    strands_head* head = wisp_world_column( world, strands, state->head, 0 );
    if ( head == NULL )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u is rooted in a surface, not in a head",
                                strands.index );
    }
    head->target = wisp_pose_to_rows( pose, wisp_world_offset( world, strands ) );
    return WISP_OK;
}
