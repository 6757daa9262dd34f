// What a user does to a world: holds and pins vertices, moves colliders, changes gravity and wind.
#include "binding_internal.h"

#include <stdlib.h>

// ---- single vertices, of surfaces and strands ----

static int find_hold( const binding_world* w, int body, int vertex )
{
    int k = 0;
    while ( k < w->hold_count && ( w->holds[k].body != body || w->holds[k].vertex != vertex ) )
    {
        ++k;
    }
    return k;
}

static scene_hold* held( binding_world* w, int body, int vertex, wisp_error* error )
{
    const int k = find_hold( w, body, vertex );
    if ( k == w->hold_count )
    {
        wisp_fail( error, WISP_CONFLICT, "vertex %d of body %d is not held", vertex, body );
    }
    return k < w->hold_count ? &w->holds[k] : NULL;
}

static bool make_room( binding_world* w )
{
    if ( w->hold_count == w->hold_capacity )
    {
        const int capacity = w->hold_capacity > 0 ? 2 * w->hold_capacity : 16;
        scene_hold* larger = realloc( w->holds, (size_t)capacity * sizeof *larger );
        if ( !larger )
        {
            return false;
        }
        w->holds = larger;
        w->hold_capacity = capacity;
    }
    return true;
}

wisp_status binding_grab( binding_world* w, int body, int vertex, wisp_error* error )
{
    if ( find_hold( w, body, vertex ) < w->hold_count )
    {
        return WISP_OK;
    }
    if ( !make_room( w ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for held vertices", w->scene.name );
    }
    const wisp_status status = scene_world_grab( &w->world, body, vertex, &w->holds[w->hold_count], error );
    w->hold_count += status == WISP_OK;
    return status;
}

wisp_status binding_drag( binding_world* w, int body, int vertex, float x, float y, float z, wisp_error* error )
{
    const scene_hold* hold = held( w, body, vertex, error );
    return hold ? scene_world_drag( &w->world, hold, ( wisp_vec3 ){ x, y, z }, error ) : error->status;
}

wisp_status binding_let_go( binding_world* w, int body, int vertex, wisp_error* error )
{
    scene_hold* hold = held( w, body, vertex, error );
    const wisp_status status = hold ? scene_world_let_go( &w->world, hold, error ) : error->status;
    if ( status == WISP_OK )
    {
        *hold = w->holds[--w->hold_count];
    }
    return status;
}

// ---- pins of surfaces ----

static scene_world_surface* find_surface( binding_world* w, int body, wisp_error* error )
{
    if ( !binding_find_body( w, body, error ) )
    {
        return NULL;
    }
    const int index = body - w->scene.strands_count;
    if ( index < 0 || index >= w->scene.surface_count )
    {
        wisp_fail( error, WISP_CONFLICT, "%s: '%s' is no surface, and has no vertices to pin", w->scene.name,
                   scene_world_body( &w->world, body ).name );
        return NULL;
    }
    return &w->world.surfaces[index];
}

// Keyframes of the scene place their pins in every step.
static wisp_status check_keyframes( const binding_world* w, int body, const scene_world_surface* s,
                                    const int32_t* vertices, int count, wisp_error* error )
{
    const wisp_scene_surface* entry = &w->scene.surfaces[body - w->scene.strands_count];
    for ( int i = 0; i < count; ++i )
    {
        const int group = scene_pins_holding( s, vertices[i] );
        if ( group >= 0 && ( s->groups[group].starts != NULL || entry->has_animation ) )
        {
            return wisp_fail( error, WISP_CONFLICT, "%s: vertex %d of '%s' follows the keyframes of its pins",
                              w->scene.name, vertices[i], entry->name );
        }
    }
    return WISP_OK;
}

wisp_status binding_pin( binding_world* w, int body, const int32_t* vertices, int count, wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    return s ? binding_fail( w, wisp_pin( w->world.world, s->entity, vertices, count ), error ) : error->status;
}

wisp_status binding_unpin( binding_world* w, int body, const int32_t* vertices, int count, wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    wisp_status status = s ? check_keyframes( w, body, s, vertices, count, error ) : error->status;
    return status == WISP_OK ? binding_fail( w, wisp_unpin( w->world.world, s->entity, vertices, count ), error )
                             : status;
}

wisp_status binding_move_pins( binding_world* w, int body, const int32_t* vertices, const float* targets, int count,
                               wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    wisp_status status = s ? check_keyframes( w, body, s, vertices, count, error ) : error->status;
    const wisp_vec3* places = (const wisp_vec3*)(const void*)targets;
    return status == WISP_OK
               ? binding_fail( w, wisp_move_pins( w->world.world, s->entity, vertices, places, count ), error )
               : status;
}

// ---- colliders, gravity, wind ----

wisp_status binding_move_collider( binding_world* w, int body, float x, float y, float z, wisp_error* error )
{
    return scene_world_move_collider( &w->world, body, ( wisp_vec3 ){ x, y, z }, error );
}

wisp_status binding_collider_place( const binding_world* w, int body, float* out, wisp_error* error )
{
    const int index = body - scene_world_moving_count( &w->world );
    if ( index < 0 || body >= scene_world_body_count( &w->world ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: body %d is no collider", w->scene.name, body );
    }
    const wisp_vec3 at = w->world.colliders[index].pose.translation;
    out[0] = at.x;
    out[1] = at.y;
    out[2] = at.z;
    return WISP_OK;
}

wisp_status binding_set_gravity( binding_world* w, float x, float y, float z, wisp_error* error )
{
    return scene_world_set_gravity( &w->world, ( wisp_vec3 ){ x, y, z }, error );
}

wisp_status binding_set_wind( binding_world* w, float x, float y, float z, int* felt, wisp_error* error )
{
    return scene_world_set_wind( &w->world, ( wisp_vec3 ){ x, y, z }, felt, error );
}
