#include "world_from_scene_input.h"

#include "world_from_scene_parts.h"

#include <stdlib.h>

// Of cloth whose scene has no air, once a user makes wind.
#define DRAG_OF_WIND 1.0f

static wisp_status fail_world( const scene_world* world, wisp_status status, wisp_error* error )
{
    return status == WISP_OK
               ? WISP_OK
               : wisp_fail( error, status, "%s: %s", world->scene->name, wisp_world_message( world->world ) );
}

// ---- vertices ----

static bool is_surface( const scene_world* world, int body )
{
    return body >= world->scene->strands_count;
}

static wisp_status grab_surface( scene_world* world, scene_hold* hold, wisp_error* error )
{
    const int index = hold->body - world->scene->strands_count;
    const wisp_scene_surface* entry = &world->scene->surfaces[index];
    const scene_world_surface* s = &world->surfaces[index];
    const int32_t vertex = hold->vertex;
    const int group = scene_pins_holding( s, vertex );
    hold->was_pinned = group >= 0;
    if ( hold->was_pinned && ( scene_pins_entry( entry, group )->path.count > 0 || entry->has_animation ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "vertex %d of '%s' follows the keyframes of its pins", hold->vertex,
                          entry->name );
    }
    return hold->was_pinned ? WISP_OK : fail_world( world, wisp_pin( world->world, s->entity, &vertex, 1 ), error );
}

static wisp_status grab_strands( scene_world* world, scene_hold* hold, wisp_error* error )
{
    const wisp_scene_strands* entry = &world->scene->strands[hold->body];
    const char* reason = !entry->has_dynamics     ? "do not move by themselves"
                         : entry->on_surface >= 0 ? "are rooted in a surface"
                         : entry->head.count > 0  ? "follow the keyframes of their head"
                                                  : NULL;
    if ( reason )
    {
        return wisp_fail( error, WISP_CONFLICT, "strands '%s' %s", entry->name, reason );
    }
    if ( !world->head_offsets )
    {
        world->head_offsets = calloc( (size_t)world->scene->strands_count, sizeof *world->head_offsets );
    }
    if ( !world->head_offsets )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for heads", world->scene->name );
    }
    hold->head = world->head_offsets[hold->body];
    hold->from = world->grooms[hold->body].points[hold->vertex];
    if ( world->next_step == 0 )
    {
        return WISP_OK;
    }
    wisp_view view;
    const wisp_status status = scene_world_view( world, hold->body, SCENE_REQUEST_POINTS, &view, error );
    if ( status == WISP_OK )
    {
        hold->from = *(const wisp_vec3*)(const void*)( (const char*)view.data + (size_t)hold->vertex * view.stride );
    }
    return status;
}

wisp_status scene_world_grab( scene_world* world, int body, int vertex, scene_hold* out, wisp_error* error )
{
    *out = ( scene_hold ){ .body = body, .vertex = vertex };
    if ( body < 0 || body >= scene_world_moving_count( world ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got body %d, expected one of the %d that move", body,
                          scene_world_moving_count( world ) );
    }
    const scene_body held = scene_world_body( world, body );
    if ( vertex < 0 || vertex >= held.vertex_count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got vertex %d, but '%s' has %d vertices, counted from 0", vertex,
                          held.name, held.vertex_count );
    }
    return is_surface( world, body ) ? grab_surface( world, out, error ) : grab_strands( world, out, error );
}

wisp_status scene_world_drag( scene_world* world, const scene_hold* hold, wisp_vec3 target, wisp_error* error )
{
    if ( is_surface( world, hold->body ) )
    {
        const int32_t vertex = hold->vertex;
        const wisp_entity entity = world->surfaces[hold->body - world->scene->strands_count].entity;
        return fail_world( world, wisp_move_pins( world->world, entity, &vertex, &target, 1 ), error );
    }
    const wisp_transform pose = { { 0.0f, 0.0f, 0.0f, 1.0f },
                                  { hold->head.x + target.x - hold->from.x, hold->head.y + target.y - hold->from.y,
                                    hold->head.z + target.z - hold->from.z } };
    const wisp_status status = wisp_move_strand_head( world->world, world->entities[hold->body], pose );
    if ( status == WISP_OK )
    {
        world->head_offsets[hold->body] = pose.translation;
    }
    return fail_world( world, status, error );
}

wisp_status scene_world_let_go( scene_world* world, const scene_hold* hold, wisp_error* error )
{
    if ( !is_surface( world, hold->body ) || hold->was_pinned )
    {
        return WISP_OK;
    }
    const int32_t vertex = hold->vertex;
    const wisp_entity entity = world->surfaces[hold->body - world->scene->strands_count].entity;
    return fail_world( world, wisp_unpin( world->world, entity, &vertex, 1 ), error );
}

// ---- colliders ----

wisp_status scene_world_move_collider( scene_world* world, int body, wisp_vec3 place, wisp_error* error )
{
    const int index = body - scene_world_moving_count( world );
    if ( body < 0 || body >= scene_world_body_count( world ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "got body %d, but the scene has %d bodies, counted from 0", body,
                          scene_world_body_count( world ) );
    }
    const char* name = scene_world_body( world, body ).name;
    if ( index < 0 )
    {
        return wisp_fail( error, WISP_CONFLICT, "'%s' is no collider", name );
    }
    if ( world->scene->colliders[index].path.count > 0 )
    {
        return wisp_fail( error, WISP_CONFLICT, "collider '%s' follows its keyframes", name );
    }
    scene_world_collider* c = &world->colliders[index];
    const wisp_transform pose = { c->pose.rotation, place };
    const wisp_status status = wisp_move_collider( world->world, c->entity, pose );
    if ( status == WISP_OK )
    {
        c->pose = pose;
    }
    return fail_world( world, status, error );
}

// ---- gravity and wind ----

wisp_status scene_world_set_gravity( scene_world* world, wisp_vec3 gravity, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        status = scene->strands[i].has_dynamics ? wisp_set_strand_gravity( world->world, world->entities[i], gravity )
                                                : WISP_OK;
    }
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        status = wisp_set_gravity( world->world, world->surfaces[i].entity, gravity );
    }
    return fail_world( world, status, error );
}

// Air is a part of the material: cloth without it is set again, which changes no vertex.
static wisp_status blow_on_cloth( scene_world* world, int surface, wisp_vec3 wind )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[surface];
    const wisp_entity entity = world->surfaces[surface].entity;
    if ( entry->cloth.drag_coefficient > 0.0f || entry->cloth.lift_coefficient > 0.0f )
    {
        return wisp_set_cloth_wind( world->world, entity, wind );
    }
    wisp_cloth_def def = entry->cloth;
    const bool blows = wind.x != 0.0f || wind.y != 0.0f || wind.z != 0.0f;
    def.wind = wind;
    def.drag_coefficient = blows ? DRAG_OF_WIND : 0.0f;
    return wisp_set_cloth( world->world, entity, &def );
}

wisp_status scene_world_set_wind( scene_world* world, wisp_vec3 wind, int* felt, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    *felt = 0;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        if ( scene->strands[i].has_dynamics && scene->strands[i].dynamics.drag_coefficient > 0.0f )
        {
            status = wisp_set_strand_wind( world->world, world->entities[i], wind );
            ++*felt;
        }
    }
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        if ( scene->surfaces[i].has_cloth )
        {
            status = blow_on_cloth( world, i, wind );
            ++*felt;
        }
    }
    return fail_world( world, status, error );
}
