// Contact input of an external solver (a module that solves for velocities, such as implicit cloth). In: positions
// and velocities at the start of a substep, poses of the bodies. Out: component particle.contacts, up to two moving half
// spaces per particle. Nothing is moved here; the solver holds a particle within the margin, which is the thickness
// of participant and body.
//
// - Everything is computed in the frame of the body. The path goes from b0, seen from the old pose, to b1, where
//   gravity alone takes the particle, seen from the new one. The mesh of a surface is held as it is at the start of the
//   substep, and b1 is seen from the point of it that is closest to b0. A body counts if its surface is within margin and path
//   of b0.
// - The half space is the tangent plane where the path enters the body; else the plane of the closest point to b0, if
//   that is within the margin or inside; else, for a path that passes by, a plane between path and body. The solver
//   takes the half space for the body, so the plane of the closest point would stop a particle that only goes round a
//   corner.
// - The gap is the distance of b0 from the plane. The solver holds what is nearer than the margin, so a particle that
//   is not gets no gap below it: the plane where a flat path enters is turned until its gap is the margin.
// - The two nearest are kept, by the nearer end of the path less the margin; of equals the body that was added first.
//   A third is not answered for in this substep.
// - Rows keep the index and generation of the body, by which the solver recognises a contact of the step before.
#include "body_queries.h"
#include "collision_maps.h"
#include "near_bodies.h"

#include <float.h>
#include <math.h>
#include <string.h>

// A half space of a particle.
typedef struct input_touch
{
    float rank; // m, how near the path comes, less the margin: the lowest are kept
    int32_t body;
    float plane[4], motion[4], friction[3]; // as in the columns
} input_touch;

typedef struct input_loop
{
    const float *position, *velocity;
    wisp_vec3 gravity; // m/s^2
    float seconds, recovery;
    collision_maps maps;
    int32_t ( *body )[WISP_MAX_PARTICLE_CONTACTS];
    float ( *plane )[4 * WISP_MAX_PARTICLE_CONTACTS];
    float ( *motion )[4 * WISP_MAX_PARTICLE_CONTACTS];
    float ( *friction )[3 * WISP_MAX_PARTICLE_CONTACTS];
    // of the chunk
    int begin;
    wisp_vec3 lower, upper;                 // m, of all paths
    float longest;                          // m, of all paths
    int slots[COLLISION_CHUNK], slot_count; // of particles that move and are finite
    wisp_vec3 start[COLLISION_CHUNK];       // m, of each of them
    wisp_vec3 end[COLLISION_CHUNK];         // m, of each of them
    int count[COLLISION_CHUNK];             // touches of each particle of the chunk
    input_touch touch[COLLISION_CHUNK][WISP_MAX_PARTICLE_CONTACTS];
    // of one body
    int candidate_count;
    int candidates[COLLISION_CHUNK]; // particles of the chunk
    wisp_vec3 to[COLLISION_CHUNK];
    wisp_mesh_query queries[COLLISION_CHUNK]; // at the start of the path
    wisp_surface_point nearest[COLLISION_CHUNK];
    bool is_near[COLLISION_CHUNK];
    wisp_vec3 body_motion[COLLISION_CHUNK]; // m, displacement of the surface there
} input_loop;

static void begin_chunk( input_loop* loop, int begin, int end )
{
    loop->begin = begin;
    loop->slot_count = 0;
    loop->longest = 0.0f;
    loop->lower = ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY };
    loop->upper = ( wisp_vec3 ){ -INFINITY, -INFINITY, -INFINITY };
    memset( loop->count, 0, sizeof( loop->count ) );
    memset( loop->touch, 0, sizeof( loop->touch ) );
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* quad = loop->position + (size_t)slot * 4;
        const wisp_vec3 p = wisp_v3_load( quad );
        const wisp_vec3 v =
            wisp_v3_mul_add( wisp_v3_load( loop->velocity + (size_t)slot * 4 ), loop->seconds, loop->gravity );
        const wisp_vec3 after = wisp_v3_mul_add( p, loop->seconds, v );
        if ( quad[3] > 0.0f && collision_is_finite( p ) && collision_is_finite( after ) )
        {
            loop->start[loop->slot_count] = p;
            loop->end[loop->slot_count] = after;
            loop->slots[loop->slot_count++] = slot;
            loop->longest = collision_larger( loop->longest, wisp_v3_length( wisp_v3_sub( after, p ) ) );
            collision_widen( &loop->lower, &loop->upper, p );
            collision_widen( &loop->lower, &loop->upper, after );
        }
    }
}

// ---- culling ----

// Return whether the body is beyond the margin and path of every particle, in its own frame.
static bool is_far( const input_loop* loop, const collision_view* view )
{
    const wisp_vec3 body_motion = wisp_v3_sub( wisp_transform_to_world( view->after, view->body->centre ),
                                               wisp_transform_to_world( view->before, view->body->centre ) );
    const float reach =
        view->thickness + loop->longest + wisp_v3_length( body_motion ) + collision_surface_shift( view );
    return collision_ball_distance( view, loop->lower, loop->upper ) > reach;
}

static void query_candidates( input_loop* loop, const collision_view* view )
{
    loop->candidate_count = 0;
    for ( int i = 0; i < loop->slot_count; ++i )
    {
        const wisp_vec3 from = wisp_transform_to_local( view->before, loop->start[i] );
        const wisp_vec3 to = wisp_transform_to_local( view->after, loop->end[i] );
        const float reach =
            view->thickness + wisp_v3_length( wisp_v3_sub( to, from ) ) + collision_surface_shift( view );
        if ( collision_box_distance( view->body, from ) <= reach )
        {
            const int n = loop->candidate_count++;
            loop->candidates[n] = loop->slots[i] - loop->begin;
            loop->to[n] = to;
            loop->queries[n] = ( wisp_mesh_query ){ .point = from, .radius = reach, .time = view->begin };
        }
    }
    collision_closest( view, loop->queries, loop->candidate_count, loop->nearest, loop->is_near, loop->body_motion );
}

// ---- planes ----

// Return the signed distance of a point from a plane.
static float in_front( const wisp_surface_point* plane, wisp_vec3 p )
{
    return wisp_v3_dot( plane->normal, wisp_v3_sub( p, plane->point ) );
}

// Find a plane between a path and a body. The plane of the closest point to the place where the path is nearest to
// the body has both ends of the path in front, and a convex body behind it. The distance along the path falls and
// then rises, so bisection finds the place; most often an end is enough.
// @return false if there is none: the path is free, but winds through a body that is not convex
static bool pass_by( const collision_view* view, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* plane )
{
    enum
    {
        HALVINGS = 12, // closer than 2^-12 of the path is left to the next substep
    };
    const wisp_vec3 displacement = wisp_v3_sub( to, from );
    const float radius = plane->distance + wisp_v3_length( displacement );
    float before = 0.0f, behind = 1.0f;
    bool is_between = in_front( plane, to ) >= 0.0f;
    for ( int i = 0; i <= HALVINGS && is_between == false; ++i )
    {
        const float time = i == 0 ? 1.0f : 0.5f * ( before + behind );
        const wisp_mesh_query query = { .point = wisp_v3_mul_add( from, time, displacement ),
                                        .radius = radius,
                                        .time = view->begin };
        bool is_near;
        collision_closest( view, &query, 1, plane, &is_near, NULL );
        if ( is_near == false )
        {
            return false;
        }
        const bool falls = wisp_v3_dot( plane->normal, displacement ) < 0.0f;
        before = falls ? time : before;
        behind = falls ? behind : time;
        is_between = in_front( plane, from ) >= 0.0f && in_front( plane, to ) >= 0.0f;
    }
    plane->distance = collision_larger( view->thickness, in_front( plane, from ) );
    return is_between;
}

// Turn a plane about its point, by the smallest angle for which `from` is a margin in front. `from` is farther than
// the margin from that point.
static void tilt( wisp_surface_point* plane, wisp_vec3 from, float margin )
{
    const wisp_vec3 displacement = wisp_v3_sub( from, plane->point );
    const float length = wisp_v3_length( displacement ), fraction = collision_smaller( 1.0f, margin / length );
    const wisp_vec3 w = { displacement.x / length, displacement.y / length, displacement.z / length };
    const wisp_vec3 foreign = wisp_v3_mul_add( plane->normal, -wisp_v3_dot( plane->normal, w ), w );
    const float rest = sqrtf( 1.0f - fraction * fraction ) / collision_larger( wisp_v3_length( foreign ), FLT_MIN );
    plane->normal = ( wisp_vec3 ){ fraction * w.x + rest * foreign.x, fraction * w.y + rest * foreign.y,
                                   fraction * w.z + rest * foreign.z };
    plane->distance = margin;
}

// @param plane the closest point to `from`, with its distance; receives the plane, with the gap
static bool find_plane( const collision_view* view, wisp_vec3 from, wisp_vec3 to, wisp_surface_point* plane )
{
    const float path = wisp_v3_length( wisp_v3_sub( to, from ) );
    const bool touches = plane->distance < view->thickness;
    wisp_surface_point hit;
    wisp_vec3 motion;
    collision_view held = *view;
    held.end = held.begin;
    if ( fabsf( plane->distance ) <= path && collision_cast( &held, from, to, &hit, &motion ) )
    {
        *plane = hit;
        plane->distance = collision_larger( 0.0f, in_front( plane, from ) );
        if ( touches == false && plane->distance < view->thickness )
        {
            tilt( plane, from, view->thickness );
        }
        return true;
    }
    return touches || pass_by( view, from, to, plane );
}

// ---- one particle, one body ----

// Insert a half space in rising order of rank. Equal ones stay in the order of bodies.
static void insert( input_loop* loop, int particle, const input_touch* found )
{
    input_touch* all = loop->touch[particle];
    int place = loop->count[particle];
    while ( place > 0 && found->rank < all[place - 1].rank )
    {
        place -= 1;
    }
    if ( place == WISP_MAX_PARTICLE_CONTACTS )
    {
        return;
    }
    loop->count[particle] += loop->count[particle] < WISP_MAX_PARTICLE_CONTACTS ? 1 : 0;
    for ( int i = loop->count[particle] - 1; i > place; --i )
    {
        all[i] = all[i - 1];
    }
    all[place] = *found;
}

static void add_touch( input_loop* loop, const collision_view* of_all, int i )
{
    const int32_t slot = loop->begin + loop->candidates[i];
    const collision_view* view = of_all;
    collision_view of_this;
    if ( loop->maps.thickness != NULL || loop->maps.friction != NULL )
    {
        of_this = *of_all;
        collision_view_at( &loop->maps, &slot, 1, &of_this );
        view = &of_this;
    }
    const wisp_vec3 body_motion = loop->body_motion[i], from = loop->queries[i].point,
                    to = wisp_v3_mul_add( loop->to[i], -1.0f, body_motion );
    wisp_surface_point plane = loop->nearest[i];
    if ( find_plane( view, from, to, &plane ) == false )
    {
        return;
    }
    const float end = plane.distance + wisp_v3_dot( plane.normal, wisp_v3_sub( to, from ) );
    input_touch found = {
        .rank = collision_smaller( plane.distance, end ) - view->thickness,
        .body = collision_body_name( view->body->entity ),
        .friction = { view->static_friction, view->kinetic_friction, loop->recovery },
    };
    collision_store( found.plane, wisp_quat_rotate( view->before.rotation, plane.normal ) );
    found.plane[3] = plane.distance;
    const wisp_vec3 velocity = wisp_transform_velocity( view->before, view->after, loop->seconds, plane.point );
    const float rate = loop->seconds > 0.0f ? 1.0f / loop->seconds : 0.0f;
    collision_store( found.motion, wisp_v3_mul_add( velocity, rate, body_motion ) );
    found.motion[3] = view->thickness;
    insert( loop, loop->candidates[i], &found );
}

// ---- the pass ----

static void write_half_spaces( const input_loop* loop, int end )
{
    for ( int slot = loop->begin; slot < end; ++slot )
    {
        for ( int k = 0; k < WISP_MAX_PARTICLE_CONTACTS; ++k )
        {
            const input_touch* t = &loop->touch[slot - loop->begin][k];
            loop->body[slot][k] = t->body;
            memcpy( loop->plane[slot] + 4 * k, t->plane, sizeof( t->plane ) );
            memcpy( loop->motion[slot] + 4 * k, t->motion, sizeof( t->motion ) );
            memcpy( loop->friction[slot] + 3 * k, t->friction, sizeof( t->friction ) );
        }
    }
}

static void find_touches( wisp_frame* frame, const wisp_span* span, const collision_state* state, input_loop* loop )
{
    collision_view view;
    collision_walk walk = collision_begin_walk( state, span->entity, loop->lower, loop->upper );
    while ( loop->slot_count > 0 && collision_walk_on( frame, span, state, &walk, loop->longest, &view ) )
    {
        if ( is_far( loop, &view ) )
        {
            continue;
        }
        query_candidates( loop, &view );
        for ( int i = 0; i < loop->candidate_count; ++i )
        {
            if ( loop->is_near[i] )
            {
                add_touch( loop, &view, i );
            }
        }
    }
}

void collision_sense( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    const wisp_vec3* gravity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_GRAVITY, 0 );
    input_loop loop;
    loop.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    loop.velocity = wisp_frame_column( frame, span->entity, WISP_PARTICLE_VELOCITY, 0 );
    loop.gravity = gravity != NULL ? *gravity : ( wisp_vec3 ){ 0.0f, 0.0f, 0.0f };
    loop.seconds = wisp_frame_dt( frame, span->entity );
    loop.recovery = settings->max_push_out_speed;
    loop.maps = collision_maps_of( frame, span->entity, state );
    loop.body = wisp_frame_column( frame, span->entity, WISP_PARTICLE_CONTACTS, 0 );
    loop.plane = wisp_frame_column( frame, span->entity, WISP_PARTICLE_CONTACTS, 1 );
    loop.motion = wisp_frame_column( frame, span->entity, WISP_PARTICLE_CONTACTS, 2 );
    loop.friction = wisp_frame_column( frame, span->entity, WISP_PARTICLE_CONTACTS, 3 );
    const wisp_span particles = wisp_frame_particles( frame, span );
    for ( int begin = particles.begin; begin < particles.end; begin += COLLISION_CHUNK )
    {
        const int end = particles.end - begin < COLLISION_CHUNK ? particles.end : begin + COLLISION_CHUNK;
        begin_chunk( &loop, begin, end );
        find_touches( frame, span, state, &loop );
        write_half_spaces( &loop, end );
    }
}
