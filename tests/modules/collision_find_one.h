/// Reference for contact generation: particle by particle and body by body, a closest point query after a test of the
/// body's box. The module works on blocks and must give the same bits.
#pragma once

#include "block_culling.h"
#include "body_queries.h"
#include "contact_generation.h"

typedef struct find_one
{
    const collision_find_args* args;
    const collision_view* view;
    int slot;
    wisp_vec3 from, to; // in the body's frame
    float path;
} find_one;

static inline void one_lowers_clear( const find_one* one, float clear )
{
    float* found = one->args->found + (size_t)one->slot * 4;
    found[3] = clear < found[3] ? clear : found[3];
}

static inline float one_gap( const collision_contact* c, wisp_vec3 p )
{
    return collision_dot( collision_load( c->normal ), collision_sub( p, collision_load( c->point ) ) ) - c->gap;
}

static inline void one_keeps( const find_one* one, const collision_contact* c )
{
    collision_contact* all = one->args->contact[one->slot];
    const wisp_vec3 p = collision_load( one->args->position + (size_t)one->slot * 4 );
    int place = one->args->count[one->slot]++;
    if ( place >= WISP_COLLISION_CONTACTS )
    {
        place = 0;
        for ( int i = 1; i < WISP_COLLISION_CONTACTS; ++i )
        {
            place = one_gap( all + i, p ) > one_gap( all + place, p ) ? i : place;
        }
        if ( one_gap( c, p ) >= one_gap( all + place, p ) )
        {
            return;
        }
    }
    all[place] = *c;
}

static inline void one_moves_out( const find_one* one, wisp_vec3 normal, float recovered, float absorbed )
{
    float *p = one->args->position + (size_t)one->slot * 4, *old = one->args->previous + (size_t)one->slot * 4;
    collision_store( p, collision_add_scaled( collision_load( p ), recovered, normal ) );
    collision_store( old, collision_add_scaled( collision_load( old ), recovered + absorbed, normal ) );
}

static inline void one_touches( const find_one* one, const wisp_surface_point* nearest )
{
    const collision_view* view = one->view;
    wisp_surface_point plane;
    wisp_vec3 motion = { 0.0f, 0.0f, 0.0f };
    bool swept =
        fabsf( nearest->distance ) <= one->path && collision_cast( view, one->from, one->to, &plane, &motion );
    plane = swept ? plane : *nearest;
    one_lowers_clear( one, swept ? 0.0f : ( nearest->distance > 0.0f ? nearest->distance : INFINITY ) );
    float now = swept ? collision_dot( plane.normal, collision_sub( one->to, plane.point ) ) : nearest->distance;
    if ( now > 2.0f * view->thickness + one->path )
    {
        return;
    }
    float start = collision_start_gap( view, &plane, one->from, motion, swept, -1 );
    float outward = fmaxf( 0.0f, now - view->thickness - start ), recovered = 0.0f;
    if ( start + outward < 0.0f )
    {
        recovered = fminf( -start - outward, fmaxf( 0.0f, one->args->recovery - outward ) );
    }
    const wisp_vec3 normal = wisp_quat_rotate( view->after.rotation, plane.normal );
    const wisp_vec3 point = wisp_transform_to_world( view->after, plane.point );
    collision_contact c = {
        .gap = start < 0.0f ? view->thickness + start + recovered : view->thickness,
        .static_friction = view->static_friction,
        .kinetic_friction = view->kinetic_friction,
    };
    collision_store( c.point, point );
    collision_store( c.normal, normal );
    collision_store( c.motion, collision_sub( point, wisp_transform_to_world( view->before, plane.point ) ) );
    one_moves_out( one, normal, recovered, start < -COLLISION_SHALLOW * view->thickness ? outward : 0.0f );
    one_keeps( one, &c );
}

static inline float one_box_distance( const collision_body* body, wisp_vec3 p )
{
    const wisp_vec3 d = collision_sub( p, body->centre );
    return collision_length( ( wisp_vec3 ){
        fmaxf( 0.0f, fabsf( d.x ) - body->half.x ),
        fmaxf( 0.0f, fabsf( d.y ) - body->half.y ),
        fmaxf( 0.0f, fabsf( d.z ) - body->half.z ),
    } );
}

static inline void one_meets( const collision_find_args* args, const collision_view* view, int slot )
{
    const wisp_vec3 old = collision_load( args->previous + (size_t)slot * 4 );
    const wisp_vec3 now = collision_load( args->position + (size_t)slot * 4 );
    find_one one = {
        args, view, slot, wisp_transform_to_local( view->before, old ), wisp_transform_to_local( view->after, now ),
        0.0f
    };
    one.path = collision_length( collision_sub( one.to, one.from ) );
    const wisp_mesh_query query = { .point = one.to, .radius = 2.0f * view->thickness + one.path };
    wisp_surface_point nearest;
    bool is_near = false;
    if ( one_box_distance( view->body, one.to ) <= query.radius )
    {
        collision_closest( view, &query, 1, &nearest, &is_near, NULL );
    }
    if ( is_near )
    {
        one_touches( &one, &nearest );
    }
    else
    {
        one_lowers_clear( &one, query.radius );
    }
}

static inline bool one_moves( const collision_find_args* args, int slot )
{
    const float *quad = args->position + (size_t)slot * 4, *old = args->previous + (size_t)slot * 4;
    return quad[3] > 0.0f && collision_is_finite( collision_load( quad ) ) &&
           collision_is_finite( collision_load( old ) );
}

/// All bodies for one block of slots, in their order. The block matters: if a body is beyond reach of the whole
/// block, its distance to each particle is taken as the distance to the block's box.
static inline void find_one_by_one( const collision_find_args* args, const collision_view* views, int view_count,
                                    int begin, int end )
{
    wisp_vec3 lower = { INFINITY, INFINITY, INFINITY }, upper = { -INFINITY, -INFINITY, -INFINITY };
    for ( int slot = begin; slot < end; ++slot )
    {
        args->count[slot] = 0;
        collision_store( args->found + (size_t)slot * 4, collision_load( args->position + (size_t)slot * 4 ) );
        args->found[(size_t)slot * 4 + 3] = INFINITY;
        if ( one_moves( args, slot ) )
        {
            collision_widen( &lower, &upper, collision_load( args->position + (size_t)slot * 4 ) );
            collision_widen( &lower, &upper, collision_load( args->previous + (size_t)slot * 4 ) );
        }
    }
    bool moves[COLLISION_BLOCK]; // before any body moved anything
    for ( int slot = begin; slot < end; ++slot )
    {
        moves[slot - begin] = one_moves( args, slot );
    }
    for ( int v = 0; v < view_count; ++v )
    {
        const float apart = collision_ball_distance( views + v, lower, upper );
        const bool is_far = apart > 2.0f * views[v].thickness;
        for ( int slot = begin; slot < end; ++slot )
        {
            const find_one one = { .args = args, .view = views + v, .slot = slot };
            if ( moves[slot - begin] && is_far )
            {
                one_lowers_clear( &one, apart );
            }
            else if ( moves[slot - begin] )
            {
                one_meets( args, views + v, slot );
            }
        }
    }
}
