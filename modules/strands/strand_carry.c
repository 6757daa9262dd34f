// Moving frames of strands: what they do not feel of the motion carries them. In: poses of the frame. Out: low parts of
// positions, velocities, frames of rods.
//
// In a substep a vertex moves from its position to position + low + dt v. So what carries it is added to low, as the shift of
// BDF2 is: previous positions stay those in the world, which collision and contact see, and velocities are without it. They
// turn with the frame, as do what BDF2 looks back on and the frames of rods.
#include "strand_carry.h"

#include "head_roots.h"
#include "strand_rows.h"

#include "wisp/module/components.h"

// ---- what carries ----

static bool find_carry( wisp_frame* frame, const wisp_span* span, const strands_state* state, wisp_carry_args* args,
                        wisp_quat* turn )
{
    const bool has_head = wisp_frame_has( frame, span->entity, state->head );
    const strands_head* head = has_head ? wisp_frame_column( frame, span->entity, state->head, 0 ) : NULL;
    // a head that teleports takes its strands along
    return ( head == NULL || head->jumped == 0 ) && wisp_frame_find_carry( frame, span, args, turn );
}

static wisp_vec3 turned( const wisp_carry_args* args, wisp_vec3 v )
{
    const float* r = args->turn;
    return ( wisp_vec3 ){ r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
                          r[6] * v.x + r[7] * v.y + r[8] * v.z };
}

// Return how far a point is carried.
static wisp_vec3 way_of( const wisp_carry_args* args, wisp_vec3 place )
{
    return wisp_v3_add( turned( args, wisp_v3_sub( place, args->origin ) ), args->shift );
}

bool strands_find_carry_velocity( wisp_frame* frame, const wisp_span* span, wisp_vec3 place, wisp_vec3* linear,
                                  wisp_vec3* angular )
{
    wisp_carry_args args;
    wisp_quat q;
    if ( wisp_frame_has( frame, span->entity, WISP_PARTICLE_FRAME ) == false ||
         wisp_frame_find_carry( frame, span, &args, &q ) == false )
    {
        return false;
    }
    const float inverse_dt = 1.0f / wisp_frame_dt( frame, span->entity ), sign = q.w < 0.0f ? -1.0f : 1.0f;
    const float half_sine = sqrtf( q.x * q.x + q.y * q.y + q.z * q.z );
    const float rate =
        half_sine > 0.0f ? sign * 2.0f * atan2f( half_sine, sign * q.w ) * inverse_dt / half_sine : 0.0f;
    const wisp_vec3 w = { rate * q.x, rate * q.y, rate * q.z }, arm = wisp_v3_sub( place, args.origin ),
                    s = args.shift;
    *angular = w;
    *linear =
        ( wisp_vec3 ){ inverse_dt * s.x + w.y * arm.z - w.z * arm.y, inverse_dt * s.y + w.z * arm.x - w.x * arm.z,
                       inverse_dt * s.z + w.x * arm.y - w.y * arm.x };
    return true;
}

// ---- passes ----

void strands_move_frame( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    wisp_frame_move_carry( frame, span->entity );
}

static void turn_rows( const wisp_carry_args* args, float* rows, int row, int lane )
{
    const wisp_vec3 v = strands_get( rows, row, lane );
    strands_put( rows, row, lane, wisp_v3_add( v, turned( args, v ) ) );
}

void strands_carry( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_carry_args args;
    wisp_quat turn;
    if ( find_carry( frame, span, state, &args, &turn ) == false )
    {
        return;
    }
    const float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    const float* weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 );
    float* low = wisp_frame_column( frame, span->entity, state->low, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const bool looks_back = wisp_frame_has( frame, span->entity, state->history );
    float* shift = looks_back ? wisp_frame_column( frame, span->entity, state->history, 0 ) : NULL;
    float* before = looks_back ? wisp_frame_column( frame, span->entity, state->history, 1 ) : NULL;
    const bool has_frames = wisp_frame_has( frame, span->entity, state->curve );
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int first = t->group_row[i / WISP_LANES], lane = i % WISP_LANES;
        for ( int row = first; row < first + t->lane_count[i]; ++row )
        {
            if ( weight[strands_scalar( row, lane )] <= 0.0f )
            {
                continue;
            }
            const wisp_vec3 rest = strands_get( low, row, lane );
            const wisp_vec3 way = way_of( &args, strands_get( position, row, lane ) );
            strands_put( low, row, lane, wisp_v3_add( rest, way ) );
            turn_rows( &args, velocity, row, lane );
            if ( looks_back )
            {
                turn_rows( &args, shift, row, lane );
                turn_rows( &args, before, row, lane );
            }
        }
        if ( has_frames )
        {
            strands_turn_frames( frame, span->entity, state->curve, i / WISP_LANES, lane, turn );
        }
    }
}

void strands_carry_pins( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_carry_args args;
    wisp_quat turn;
    if ( find_carry( frame, span, state, &args, &turn ) == false )
    {
        return;
    }
    const float* position = wisp_frame_column( frame, span->entity, WISP_STRAND_POSITION, 0 );
    const float* weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const float dt = wisp_frame_dt( frame, span->entity ), inverse_dt = 1.0f / dt;
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int first = t->group_row[i / WISP_LANES], lane = i % WISP_LANES;
        for ( int row = first; row < first + t->lane_count[i]; ++row )
        {
            if ( weight[strands_scalar( row, lane )] <= 0.0f )
            {
                const wisp_vec3 v = strands_get( velocity, row, lane ), p = strands_get( position, row, lane );
                const wisp_vec3 start = { p.x - dt * v.x, p.y - dt * v.y, p.z - dt * v.z };
                const wisp_vec3 way = way_of( &args, start );
                strands_put(
                    velocity, row, lane,
                    ( wisp_vec3 ){ v.x - inverse_dt * way.x, v.y - inverse_dt * way.y, v.z - inverse_dt * way.z } );
            }
        }
    }
}

void strands_limit_speed( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    const float most = *(const float*)wisp_frame_column( frame, span->entity, WISP_PARTICLE_MAX_SPEED, 0 );
    const float* weight = wisp_frame_column( frame, span->entity, WISP_STRAND_INVERSE_MASS, 0 );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    float* step = wisp_frame_has( frame, span->entity, state->history )
                      ? wisp_frame_column( frame, span->entity, state->history, 2 )
                      : NULL;
    uint64_t limited = 0;
    for ( int i = span->begin * WISP_LANES; i < span->end * WISP_LANES; ++i )
    {
        const int first = t->group_row[i / WISP_LANES], lane = i % WISP_LANES;
        const uint64_t before = limited;
        for ( int row = first; row < first + t->lane_count[i]; ++row )
        {
            const wisp_vec3 v = strands_get( velocity, row, lane );
            const float speed = wisp_v3_length( v );
            if ( weight[strands_scalar( row, lane )] > 0.0f && speed > most )
            {
                const float scale = most / speed;
                strands_put( velocity, row, lane, ( wisp_vec3 ){ scale * v.x, scale * v.y, scale * v.z } );
                limited += 1;
            }
        }
        if ( limited > before && step != NULL )
        {
            step[strands_scalar( first, lane )] = -1.0f; // the next substep has none to look back on
        }
    }
    if ( limited > 0 )
    {
        wisp_frame_count( frame, WISP_COUNT_SPEED_LIMITED, limited );
    }
}
