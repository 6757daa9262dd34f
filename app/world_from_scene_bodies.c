// Bodies: strands, surfaces and colliders under one number, for whoever records or paints them.
#include "world_from_scene_parts.h"

#include <string.h>

/// What a body's number means.
typedef struct body_place
{
    scene_body_kind kind;
    int index; // in the scene's list
} body_place;

static body_place place_of( const scene_world* world, int body )
{
    const wisp_scene* scene = world->scene;
    WISP_ASSERT( body >= 0 && body < scene_world_body_count( world ) );
    if ( body < scene->strands_count )
    {
        return ( body_place ){ SCENE_BODY_STRANDS, body };
    }
    body -= scene->strands_count;
    if ( body < scene->surface_count )
    {
        return ( body_place ){ scene->surfaces[body].has_balloon ? SCENE_BODY_BALLOON : SCENE_BODY_CLOTH, body };
    }
    body -= scene->surface_count;
    const bool plane = scene->colliders[body].def.kind == WISP_COLLIDER_PLANE;
    return ( body_place ){ plane ? SCENE_BODY_PLANE : SCENE_BODY_COLLIDER, body };
}

static bool is_surface( body_place place )
{
    return place.kind == SCENE_BODY_CLOTH || place.kind == SCENE_BODY_BALLOON;
}

int scene_world_moving_count( const scene_world* world )
{
    return world->scene->strands_count + world->scene->surface_count;
}

int scene_world_body_count( const scene_world* world )
{
    return scene_world_moving_count( world ) + world->scene->collider_count;
}

// An instance has the triangles of its source.
static scene_body surface_body( const scene_world* world, body_place place )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[place.index];
    const wisp_mesh* source = &world->surfaces[entry->instance_of >= 0 ? entry->instance_of : place.index].mesh;
    return ( scene_body ){ .name = entry->name,
                           .kind = place.kind,
                           .vertex_count = source->vertex_count,
                           .triangles = source->triangles,
                           .triangle_count = source->triangle_count };
}

scene_body scene_world_body( const scene_world* world, int body )
{
    const body_place place = place_of( world, body );
    if ( is_surface( place ) )
    {
        return surface_body( world, place );
    }
    if ( place.kind == SCENE_BODY_STRANDS )
    {
        const wisp_groom* groom = &world->grooms[place.index];
        return ( scene_body ){ .name = world->scene->strands[place.index].name,
                               .kind = place.kind,
                               .vertex_count = groom->vertex_count,
                               .offsets = groom->offsets,
                               .strand_count = groom->strand_count };
    }
    const wisp_mesh* mesh = &world->colliders[place.index].mesh;
    return ( scene_body ){ .name = world->scene->colliders[place.index].name,
                           .kind = place.kind,
                           .vertex_count = mesh->vertex_count,
                           .triangles = mesh->triangles,
                           .triangle_count = mesh->triangle_count };
}

// ---- wishes ----

// The component that answers a wish; 0 if this kind of body has none.
static wisp_component component_of( const scene_world* world, body_place place, scene_wish wish )
{
    if ( is_surface( place ) )
    {
        return wish == SCENE_WISH_POINTS    ? WISP_SURFACE_POINTS
               : wish == SCENE_WISH_STRAIN  ? WISP_POINT_STRAIN
               : wish == SCENE_WISH_SPEED   ? WISP_POINT_SPEED
               : wish == SCENE_WISH_QUALITY ? WISP_QUALITY
               : wish == SCENE_WISH_NORMALS ? WISP_SURFACE_NORMALS
                                            : 0;
    }
    if ( place.kind != SCENE_BODY_STRANDS )
    {
        return 0;
    }
    const bool look = world->scene->strands[place.index].has_look;
    const bool moves = world->scene->strands[place.index].has_dynamics;
    return wish == SCENE_WISH_POINTS             ? WISP_STRAND_POINTS
           : wish == SCENE_WISH_WIDTH && look    ? WISP_POINT_WIDTH
           : wish == SCENE_WISH_COLOUR && look   ? WISP_POINT_COLOUR
           : wish == SCENE_WISH_STRAIN && moves  ? WISP_POINT_STRAIN
           : wish == SCENE_WISH_SPEED && moves   ? WISP_POINT_SPEED
           : wish == SCENE_WISH_QUALITY && moves ? WISP_QUALITY
                                                 : 0;
}

static wisp_entity entity_of( const scene_world* world, body_place place )
{
    return is_surface( place ) ? world->surfaces[place.index].entity : world->entities[place.index];
}

static wisp_status find_component( const scene_world* world, int body, scene_wish wish, wisp_component* out,
                                   wisp_error* error )
{
    static const char* const words[] = {
        [SCENE_WISH_POINTS] = "points to request",
        [SCENE_WISH_STRAIN] = "strain",
        [SCENE_WISH_SPEED] = "speed",
        [SCENE_WISH_WIDTH] = "width",
        [SCENE_WISH_COLOUR] = "colour",
        [SCENE_WISH_QUALITY] = "quality",
        [SCENE_WISH_NORMALS] = "normals",
    };
    *out = component_of( world, place_of( world, body ), wish );
    return *out ? WISP_OK
                : wisp_fail( error, WISP_BAD_INPUT, "%s: '%s' has no %s", world->scene->name,
                             scene_world_body( world, body ).name, words[wish] );
}

static wisp_status fail_at_body( const scene_world* world, int body, wisp_status status, wisp_error* error )
{
    return wisp_fail( error, status, "%s: '%s': %s", world->scene->name, scene_world_body( world, body ).name,
                      wisp_world_message( world->world ) );
}

wisp_status scene_world_want( scene_world* world, int body, scene_wish wish, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, wish, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_want( world->world, entity_of( world, place_of( world, body ) ), component );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

// ---- columns ----

static wisp_status copy_column( const scene_world* world, int body, wisp_component component, size_t size, void* out,
                                wisp_error* error )
{
    wisp_view view;
    wisp_entity entity = entity_of( world, place_of( world, body ) );
    wisp_status status = wisp_world_view( world->world, entity, component, &view );
    if ( status != WISP_OK )
    {
        return fail_at_body( world, body, status, error );
    }
    WISP_ASSERT( view.count == scene_world_body( world, body ).vertex_count );
    for ( int i = 0; i < view.count; ++i )
    {
        memcpy( (char*)out + (size_t)i * size, (const char*)view.data + (size_t)i * view.stride, size );
    }
    return WISP_OK;
}

wisp_status scene_world_points( const scene_world* world, int body, wisp_vec3* out, wisp_error* error )
{
    const body_place place = place_of( world, body );
    const size_t size = (size_t)scene_world_body( world, body ).vertex_count * sizeof *out;
    if ( place.kind == SCENE_BODY_COLLIDER || place.kind == SCENE_BODY_PLANE )
    {
        const scene_world_collider* c = &world->colliders[place.index];
        for ( int v = 0; v < c->mesh.vertex_count; ++v )
        {
            out[v] = wisp_rigid_to_world( c->pose, c->mesh.points[v] );
        }
        return WISP_OK;
    }
    if ( world->next_step > 0 )
    {
        const wisp_component component = is_surface( place ) ? WISP_SURFACE_POINTS : WISP_STRAND_POINTS;
        return copy_column( world, body, component, sizeof *out, out, error );
    }
    // Before the first step no pass has written anything.
    memcpy( out, is_surface( place ) ? world->surfaces[place.index].mesh.points : world->grooms[place.index].points,
            size );
    return WISP_OK;
}

wisp_status scene_world_numbers( const scene_world* world, int body, scene_wish wish, float* out, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, wish, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    WISP_ASSERT( wish == SCENE_WISH_STRAIN || wish == SCENE_WISH_SPEED || wish == SCENE_WISH_WIDTH );
    if ( world->next_step == 0 && wish != SCENE_WISH_WIDTH )
    {
        memset( out, 0, (size_t)scene_world_body( world, body ).vertex_count * sizeof *out );
        return WISP_OK;
    }
    return copy_column( world, body, component, sizeof *out, out, error );
}

wisp_status scene_world_normals( const scene_world* world, int body, wisp_vec3* out, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, SCENE_WISH_NORMALS, &component, error );
    if ( status != WISP_OK || world->next_step > 0 )
    {
        return status == WISP_OK ? copy_column( world, body, component, sizeof *out, out, error ) : status;
    }
    memset( out, 0, (size_t)scene_world_body( world, body ).vertex_count * sizeof *out );
    return WISP_OK;
}

wisp_status scene_world_layer( const scene_world* world, int surface, wisp_boundary_view* out, wisp_error* error )
{
    wisp_status status = wisp_read_boundary( world->world, world->surfaces[surface].entity, out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, world->scene->strands_count + surface, status, error );
}

wisp_status scene_world_colours( const scene_world* world, int body, wisp_vec3* out, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, SCENE_WISH_COLOUR, &component, error );
    return status == WISP_OK ? copy_column( world, body, component, sizeof *out, out, error ) : status;
}

wisp_status scene_world_quality( const scene_world* world, int body, wisp_quality* out, wisp_error* error )
{
    *out = ( wisp_quality ){ 0 };
    wisp_component component;
    wisp_status status = find_component( world, body, SCENE_WISH_QUALITY, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_world_quality( world->world, entity_of( world, place_of( world, body ) ), out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

double scene_world_time( const scene_world* world )
{
    return (double)world->next_step * (double)world->scene->step_seconds;
}
