// Once a substep: which half space each particle must stay in, for each body that is near.
//
// Everything is seen from the body: the particle goes from b0, where it was when the body was at its old pose, to b1. A
// path that enters the body gets the tangent plane where it enters; else the plane at the closest point counts. Within
// 2 h + |b1 - b0| of b1 nothing is missed, h the thickness: that is room for the constraints to move the particle in,
// and what it moves farther is looked after when the substep ends (collision_project.c).
//
// A particle that was nearer than h when the substep began is not thrown out: it must not come nearer, and is moved
// out at the recovery speed together with its previous position, so that the correction is never read as velocity. What
// it moves outward by itself is not kept as velocity either while it is deeper than shallow: links between particles
// that are moved out in different directions would pump it up.
#include "collision_internal.h"

#include <math.h>

enum
{
    CHUNK = WISP_PARTICLE_BLOCK,
};

typedef struct find_loop
{
    float *position, *previous;
    int32_t* count;
    float* found;
    collision_contact ( *contact )[WISP_COLLISION_CONTACTS];
    float recovery;      // m in this substep
    wisp_vec3 low, high; // m, of all paths of the chunk
    int slots[CHUNK];    // that move, and are finite
    int slot_count;
    // of one body
    int asked[CHUNK]; // slots
    wisp_vec3 from[CHUNK];
    wisp_mesh_query queries[CHUNK];
    wisp_surface_point nearest[CHUNK];
    bool is_near[CHUNK];
} find_loop;

static void begin_chunk( find_loop* loop, int begin, int end )
{
    loop->slot_count = 0;
    loop->low = ( wisp_vec3 ){ INFINITY, INFINITY, INFINITY };
    loop->high = ( wisp_vec3 ){ -INFINITY, -INFINITY, -INFINITY };
    for ( int slot = begin; slot < end; ++slot )
    {
        const float* quad = loop->position + (size_t)slot * 4;
        const wisp_vec3 p = collision_load( quad ), old = collision_load( loop->previous + (size_t)slot * 4 );
        float* found = loop->found + (size_t)slot * 4;
        loop->count[slot] = 0;
        collision_store( found, p );
        found[3] = INFINITY;
        if ( quad[3] > 0.0f && collision_is_finite( p ) && collision_is_finite( old ) )
        {
            loop->slots[loop->slot_count++] = slot;
            collision_widen( &loop->low, &loop->high, p );
            collision_widen( &loop->low, &loop->high, old );
        }
    }
}

static void lower_clear( find_loop* loop, int slot, float clear )
{
    float* found = loop->found + (size_t)slot * 4;
    found[3] = clear < found[3] ? clear : found[3];
}

// ---- what is too far away ----

static float reach_of( const collision_view* view, wisp_vec3 from, wisp_vec3 to )
{
    return 2.0f * view->thickness + collision_length( collision_sub( to, from ) );
}

static int ask( find_loop* loop, const collision_view* view )
{
    int n = 0;
    for ( int i = 0; i < loop->slot_count; ++i )
    {
        int slot = loop->slots[i];
        const wisp_vec3 from =
            wisp_rigid_to_body( view->before, collision_load( loop->previous + (size_t)slot * 4 ) );
        const wisp_vec3 to = wisp_rigid_to_body( view->after, collision_load( loop->position + (size_t)slot * 4 ) );
        float reach = reach_of( view, from, to );
        if ( collision_box_distance( view->body, to ) > reach )
        {
            lower_clear( loop, slot, reach );
            continue;
        }
        loop->asked[n] = slot;
        loop->from[n] = from;
        loop->queries[n++] = ( wisp_mesh_query ){ to, reach };
    }
    collision_closest( view->body, loop->queries, n, loop->nearest, loop->is_near );
    return n;
}

// ---- one particle, one body ----

static float contact_gap( const collision_contact* c, wisp_vec3 p )
{
    return collision_dot( collision_load( c->normal ), collision_sub( p, collision_load( c->point ) ) ) - c->gap;
}

// Room for one more, or the place of the farthest if it is farther than the new one.
static void keep( find_loop* loop, int slot, const collision_contact* c )
{
    collision_contact* all = loop->contact[slot];
    const wisp_vec3 p = collision_load( loop->position + (size_t)slot * 4 );
    int place = loop->count[slot]++;
    if ( place >= WISP_COLLISION_CONTACTS )
    {
        place = 0;
        for ( int i = 1; i < WISP_COLLISION_CONTACTS; ++i )
        {
            place = contact_gap( all + i, p ) > contact_gap( all + place, p ) ? i : place;
        }
        if ( contact_gap( c, p ) >= contact_gap( all + place, p ) )
        {
            return;
        }
    }
    all[place] = *c;
}

static void move_out( find_loop* loop, int slot, wisp_vec3 normal, float healed, float calmed )
{
    float *p = loop->position + (size_t)slot * 4, *old = loop->previous + (size_t)slot * 4;
    collision_store( p, collision_add_scaled( collision_load( p ), healed, normal ) );
    collision_store( old, collision_add_scaled( collision_load( old ), healed + calmed, normal ) );
}

static void touch( find_loop* loop, const collision_view* view, int slot, wisp_vec3 from, wisp_vec3 to,
                   const wisp_surface_point* nearest )
{
    float path = collision_length( collision_sub( to, from ) );
    wisp_surface_point plane;
    bool swept = fabsf( nearest->distance ) <= path && collision_sweep( view->body, from, to, &plane );
    plane = swept ? plane : *nearest;
    lower_clear( loop, slot, swept ? 0.0f : ( nearest->distance > 0.0f ? nearest->distance : INFINITY ) );
    float now = swept ? collision_dot( plane.normal, collision_sub( to, plane.point ) ) : nearest->distance;
    if ( now > 2.0f * view->thickness + path )
    {
        return;
    }
    float start = collision_start_gap( view, &plane, from, swept );
    float outward = fmaxf( 0.0f, now - view->thickness - start ), healed = 0.0f;
    if ( start + outward < 0.0f )
    {
        healed = fminf( -start - outward, fmaxf( 0.0f, loop->recovery - outward ) );
    }
    const wisp_vec3 normal = wisp_quat_turn( view->after.rotation, plane.normal );
    const wisp_vec3 point = wisp_rigid_to_world( view->after, plane.point );
    const wisp_vec3 was = wisp_rigid_to_world( view->before, plane.point );
    collision_contact c = {
        .gap = start < 0.0f ? view->thickness + start + healed : view->thickness,
        .static_friction = view->static_friction,
        .kinetic_friction = view->kinetic_friction,
    };
    collision_store( c.point, point );
    collision_store( c.normal, normal );
    collision_store( c.motion, collision_sub( point, was ) );
    move_out( loop, slot, normal, healed, start < -COLLISION_SHALLOW * view->thickness ? outward : 0.0f );
    keep( loop, slot, &c );
}

static void meet( find_loop* loop, const collision_view* view )
{
    float apart = collision_ball_distance( view, loop->low, loop->high );
    if ( apart > 2.0f * view->thickness )
    {
        for ( int i = 0; i < loop->slot_count; ++i )
        {
            lower_clear( loop, loop->slots[i], apart );
        }
        return;
    }
    int n = ask( loop, view );
    for ( int i = 0; i < n; ++i )
    {
        if ( loop->is_near[i] )
        {
            touch( loop, view, loop->asked[i], loop->from[i], loop->queries[i].point, loop->nearest + i );
        }
        else
        {
            lower_clear( loop, loop->asked[i], loop->queries[i].radius );
        }
    }
}

void collision_find( wisp_frame* frame, const wisp_span* span, void* user )
{
    const collision_state* state = user;
    const collision_settings* settings = wisp_frame_column( frame, span->entity, state->settings, 0 );
    find_loop loop;
    loop.position = wisp_frame_column( frame, span->entity, WISP_PARTICLE_POSITION, 0 );
    loop.previous = wisp_frame_column( frame, span->entity, WISP_PARTICLE_PREVIOUS, 0 );
    loop.count = wisp_frame_column( frame, span->entity, state->contact, 0 );
    loop.found = wisp_frame_column( frame, span->entity, state->contact, 1 );
    loop.contact = wisp_frame_column( frame, span->entity, state->contact, 2 );
    loop.recovery = settings->recovery_speed * wisp_frame_seconds( frame );
    const wisp_span particles = wisp_frame_particles( frame, span );
    for ( int begin = particles.begin; begin < particles.end; begin += CHUNK )
    {
        begin_chunk( &loop, begin, particles.end - begin < CHUNK ? particles.end : begin + CHUNK );
        collision_view view;
        for ( int next = 0; loop.slot_count > 0 && collision_next( frame, span, state, &next, &view ); )
        {
            meet( &loop, &view );
        }
    }
}
