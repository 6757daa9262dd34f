// Calls of the host on strands with a definition: wind, gravity, and what they read.
#include "strand_passes.h"

#include "strand_rows.h"

#include "wisp/module/components.h"
#include <string.h>

// ---- detail ----

// Strands come to rest relative to their roots. In and out: velocities. That of a root is what took it to where it is.

bool strands_slow_is_due( wisp_frame* frame, wisp_entity strands, void* user )
{
    (void)user;
    return wisp_frame_detail( frame, strands ).keep < 1.0f;
}

void strands_slow( wisp_frame* frame, const wisp_span* span, void* user )
{
    (void)user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    float* velocity = wisp_frame_column( frame, span->entity, WISP_STRAND_VELOCITY, 0 );
    const float keep = wisp_frame_detail( frame, span->entity ).keep;
    for ( int g = span->begin; g < span->end; ++g )
    {
        const float* root = velocity + strands_vector( t->group_row[g], 0 );
        for ( int row = t->group_row[g] + 1; row < t->group_row[g + 1]; ++row )
        {
            float* v = velocity + strands_vector( row, 0 );
            for ( int i = 0; i < 3 * WISP_LANES; ++i )
            {
                v[i] = root[i] + keep * ( v[i] - root[i] );
            }
        }
    }
}

// ---- sleep ----

// Strands at rest. In: the surface that they are rooted in. Out: whether they can rest; the history of substeps and the velocities of the
// last valid state, which become zero.

bool strands_surroundings( const void* memory, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                           uint64_t* hash )
{
    (void)bounds;
    (void)hash;
    const strands_state* state = memory;
    const wisp_entity* surface = wisp_world_rows( world, entity, state->surface, 0 );
    return surface == NULL || surface->index == 0 || wisp_is_asleep( world, *surface ) ||
           wisp_is_halted( world, *surface );
}

void strands_rested( const void* memory, wisp_world* world, wisp_entity entity )
{
    const strands_state* state = memory;
    const wisp_strand_topology* t = wisp_world_strands( world, entity );
    float* velocity = wisp_world_column( world, entity, state->good, 1 );
    if ( velocity != NULL && t != NULL )
    {
        memset( velocity, 0, strands_vector( t->row_count, 0 ) * sizeof( float ) );
    }
    // the next substep has none before it
    float* step = wisp_world_column( world, entity, state->history, 2 );
    for ( int i = 0; t != NULL && step != NULL && i < t->group_count * WISP_LANES; ++i )
    {
        step[strands_scalar( t->group_row[i / WISP_LANES], i % WISP_LANES )] = -1.0f;
    }
}

// ---- teleports ----

// Teleports of strands: with their head, or with the surface that they are rooted in. In: a rigid motion. Out: the head,
// frames of rods, last valid states and corners of triangles.

static wisp_status refuse( wisp_world* world, wisp_entity strands )
{
    return wisp_world_fail( world, WISP_CONFLICT,
                            "teleport: strands %u are rooted in a surface, which must be teleported instead",
                            strands.index );
}

static void turn_frames( float* frames, int row_count, wisp_quat turn )
{
    const wisp_teleport_motion rotation = { .motion.rotation = turn, .keep_velocity = true };
    for ( int i = 0; i < row_count * WISP_LANES && frames != NULL; ++i )
    {
        const int row = i / WISP_LANES, lane = i % WISP_LANES;
        const wisp_transform frame = { strands_get_quat( frames, row, lane ), { 0.0f, 0.0f, 0.0f } };
        const wisp_quat q = frame.rotation;
        if ( q.x != 0.0f || q.y != 0.0f || q.z != 0.0f || q.w != 0.0f ) // lanes without a strand hold zeros
        {
            strands_put_quat( frames, row, lane, wisp_teleport_pose( &rotation, frame ).rotation );
        }
    }
}

static void move_columns( const strands_state* state, wisp_world* world, wisp_entity strands,
                          const wisp_teleport_motion* teleport )
{
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const wisp_quat turn = teleport->motion.rotation;
    const wisp_teleport_motion low = { .motion = teleport->motion,
                                       .keep_velocity = true }; // low parts turn like velocities
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->good, 1 ), t->row_count );
    wisp_teleport_lanes( &low, NULL, wisp_world_column( world, strands, state->low, 0 ), t->row_count );
    wisp_teleport_lanes( &low, NULL, wisp_world_column( world, strands, WISP_STRAND_ROOT, 2 ), t->group_count );
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->history, 1 ), t->row_count );
    wisp_teleport_lanes( teleport, NULL, wisp_world_column( world, strands, state->history, 0 ), t->row_count );
    turn_frames( wisp_world_column( world, strands, state->curve, 0 ), t->row_count, turn );
    turn_frames( wisp_world_column( world, strands, WISP_STRAND_ROOT, 1 ), t->group_count, turn );
}

static void move_rooted( const strands_state* state, wisp_world* world, wisp_entity surface,
                         const wisp_teleport_motion* teleport )
{
    for ( wisp_entity strands = { 0, 0 }; wisp_next_entity( state->registry, state->surface, &strands ); )
    {
        const wisp_entity* on = wisp_world_column( world, strands, state->surface, 0 );
        if ( wisp_entity_equal( *on, surface ) )
        {
            move_columns( state, world, strands, teleport );
            wisp_world_move_columns( world, strands, teleport );
        }
    }
}

wisp_status strands_teleported( void* memory, wisp_world* world, wisp_entity entity,
                                const wisp_teleport_motion* teleport, bool* is_moved )
{
    const strands_state* state = memory;
    move_rooted( state, world, entity, teleport );
    if ( wisp_world_has( world, entity, state->settings ) == false )
    {
        return WISP_OK;
    }
    if ( wisp_world_has( world, entity, state->head ) == false )
    {
        return refuse( world, entity );
    }
    move_columns( state, world, entity, teleport );
    *is_moved = true;
    return WISP_OK;
}

// ---- frames that move ----

// Moving frames of strands: what they do not feel of the motion carries them. In: poses of the frame. Out: low parts of
// positions, velocities, frames of rods.
//
// In a substep a vertex moves from its position to position + low + dt v. So what carries it is added to low, as the shift of
// BDF2 is: previous positions stay those in the world, which collision and contact see, and velocities are without it. They
// turn with the frame, as do what BDF2 looks back on and the frames of rods.

// ---- what carries ----

static bool find_unfelt_motion( wisp_frame* frame, const wisp_span* span, const strands_state* state,
                                wisp_frame_motion_args* args, wisp_quat* turn )
{
    const bool has_head = wisp_frame_has( frame, span->entity, state->head );
    const strands_head* head = has_head ? wisp_frame_column( frame, span->entity, state->head, 0 ) : NULL;
    // a head that teleports takes its strands along
    return ( head == NULL || head->jumped == 0 ) && wisp_frame_find_motion( frame, span, args, turn );
}

static wisp_vec3 turned( const wisp_frame_motion_args* args, wisp_vec3 v )
{
    const float* r = args->turn;
    return ( wisp_vec3 ){ r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
                          r[6] * v.x + r[7] * v.y + r[8] * v.z };
}

// Return how far a point is carried.
static wisp_vec3 displacement_of( const wisp_frame_motion_args* args, wisp_vec3 place )
{
    return wisp_v3_add( turned( args, wisp_v3_sub( place, args->origin ) ), args->shift );
}

bool strands_find_frame_velocity( wisp_frame* frame, const wisp_span* span, wisp_vec3 place, wisp_vec3* linear,
                                  wisp_vec3* angular )
{
    wisp_frame_motion_args args;
    wisp_quat q;
    if ( wisp_frame_has( frame, span->entity, WISP_PARTICLE_FRAME ) == false ||
         wisp_frame_find_motion( frame, span, &args, &q ) == false )
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
    wisp_frame_update_pose( frame, span->entity );
}

static void turn_rows( const wisp_frame_motion_args* args, float* rows, int row, int lane )
{
    const wisp_vec3 v = strands_get( rows, row, lane );
    strands_put( rows, row, lane, wisp_v3_add( v, turned( args, v ) ) );
}

void strands_add_frame_motion( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_frame_motion_args args;
    wisp_quat turn;
    if ( find_unfelt_motion( frame, span, state, &args, &turn ) == false )
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
            const wisp_vec3 displacement = displacement_of( &args, strands_get( position, row, lane ) );
            strands_put( low, row, lane, wisp_v3_add( rest, displacement ) );
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

void strands_subtract_frame_motion( wisp_frame* frame, const wisp_span* span, void* user )
{
    const strands_state* state = user;
    const wisp_strand_topology* t = wisp_frame_strands( frame, span->entity );
    wisp_frame_motion_args args;
    wisp_quat turn;
    if ( find_unfelt_motion( frame, span, state, &args, &turn ) == false )
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
                const wisp_vec3 displacement = displacement_of( &args, start );
                strands_put( velocity, row, lane,
                             ( wisp_vec3 ){ v.x - inverse_dt * displacement.x, v.y - inverse_dt * displacement.y,
                                            v.z - inverse_dt * displacement.z } );
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
    float* step = wisp_frame_column( frame, span->entity, state->history, 2 );
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

// ---- calls ----

wisp_status wisp_set_strand_wind( wisp_world* world, wisp_entity strands, wisp_vec3 wind )
{
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    WISP_TRY( wisp_world_check_values( world, &wisp_strand_dynamics_def_fields, "wind", &wind, 1, NULL ) );
    if ( wisp_world_has( world, strands, s->air ) == false )
    {
        const wisp_strand_dynamics_def usual = wisp_default_strand_dynamics_def();
        const strands_air air = { .drag = 0.5f * usual.air_density * usual.diameter };
        WISP_TRY( wisp_world_set_row( world, strands, s->air, &air, sizeof( air ) ) );
    }
    strands_air* air = wisp_world_column( world, strands, s->air, 0 );
    air->wind = wind;
    return WISP_OK;
}

wisp_status wisp_set_strand_gravity( wisp_world* world, wisp_entity strands, wisp_vec3 gravity )
{
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    WISP_TRY( wisp_world_check_values( world, &wisp_strand_dynamics_def_fields, "gravity", &gravity, 1, NULL ) );
    strands_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    settings->gravity = gravity;
    return WISP_OK;
}

wisp_status wisp_read_strand_tension( wisp_world* world, wisp_entity strands, float* tensions )
{
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    WISP_TRY( wisp_world_check_pointer( world, "tensions", tensions ) );
    if ( wisp_world_has( world, strands, s->direct ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u does not stretch by the direct solve",
                                strands.index );
    }
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const float* tension = wisp_world_column( world, strands, s->tension, 0 );
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        for ( int v = 0; v < t->lane_count[i]; ++v )
        {
            const float value = tension[strands_scalar( t->group_row[i / WISP_LANES] + v, i % WISP_LANES )];
            tensions[t->offsets[t->lane_strand[i]] + v] = v + 1 < t->lane_count[i] ? value : 0.0f;
        }
    }
    return WISP_OK;
}

static double length_of( const wisp_strand_topology* t, const float* length, int lane )
{
    double sum = 0.0;
    for ( int v = 0; v + 1 < t->lane_count[lane]; ++v )
    {
        sum += (double)length[strands_scalar( t->group_row[lane / WISP_LANES] + v, lane % WISP_LANES )];
    }
    return sum;
}

wisp_status wisp_read_strand_hold( wisp_world* world, wisp_entity strands, wisp_strand_hold* out )
{
    WISP_TRY( wisp_world_begin_read( world, out, sizeof( *out ) ) );
    strands_state* s;
    WISP_TRY( strands_find( world, strands, &s ) );
    if ( wisp_world_has( world, strands, s->rod ) == false )
    {
        return wisp_world_fail( world, WISP_CONFLICT, "strands: entity %u does not bend as rods", strands.index );
    }
    const wisp_strand_topology* t = wisp_world_strands( world, strands );
    const strands_rows rows = strands_rows_of( world, strands );
    const float* balanced = wisp_world_column( world, strands, s->balance, 0 );
    const float* held = wisp_world_column( world, strands, s->balance, 2 );
    const strands_settings* settings = wisp_world_column( world, strands, s->settings, 0 );
    const strands_section* section = wisp_world_column( world, strands, s->section, 0 );
    const double flat = section != NULL ? (double)section->flatness : 0.0;
    const double rigidity = (double)settings->bend_rigidity * ( 1.0 - flat * flat );
    *out = ( wisp_strand_hold ){ .bend_rigidity = (float)rigidity };
    double least = 2.0;
    for ( int i = 0; i < t->group_count * WISP_LANES; ++i )
    {
        const bool is_known = balanced != NULL && balanced[i / WISP_LANES] != 0.0f;
        const double own = is_known ? (double)held[i] : 1.0;
        if ( t->lane_count[i] > 1 && own < least )
        {
            least = own;
            out->max_length = (float)( cbrt( own ) * length_of( t, rows.length, i ) );
            out->bend_rigidity = (float)( rigidity / own );
        }
        out->sagging += t->lane_count[i] > 1 && own < 1.0 ? 1 : 0;
    }
    return WISP_OK;
}
