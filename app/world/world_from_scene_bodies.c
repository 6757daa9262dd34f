// Bodies: strands, surfaces and colliders under one numbering, for recordings and pictures.
#include "world_from_scene_parts.h"

#include <string.h>

/// The entry of a body's number.
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

// An instance has the triangles of its source, unless it tears.
static scene_body surface_body( const scene_world* world, body_place place )
{
    const wisp_scene_surface* entry = &world->scene->surfaces[place.index];
    const bool has_own = entry->instance_of < 0 || entry->has_tearing;
    const wisp_mesh* source = &world->surfaces[has_own ? place.index : entry->instance_of].mesh;
    return ( scene_body ){ .name = entry->name,
                           .kind = place.kind,
                           .vertex_count = source->vertex_count,
                           .triangles = source->triangles,
                           .triangle_count = source->triangle_count,
                           .tears = entry->has_tearing,
                           .is_led = !entry->has_cloth && !entry->has_balloon && !entry->has_implicit &&
                                     !entry->has_membrane };
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

// ---- requests ----

// The component of a request; 0 if this kind of body has none.
static wisp_component component_of( const scene_world* world, body_place place, scene_request request )
{
    if ( is_surface( place ) )
    {
        return request == SCENE_REQUEST_POINTS         ? WISP_SURFACE_POINTS
               : request == SCENE_REQUEST_STRAIN       ? WISP_POINT_STRAIN
               : request == SCENE_REQUEST_SPEED        ? WISP_POINT_SPEED
               : request == SCENE_REQUEST_MOTION_STATS ? WISP_MOTION_STATS
               : request == SCENE_REQUEST_NORMALS      ? WISP_SURFACE_NORMALS
                                                       : 0;
    }
    if ( place.kind != SCENE_BODY_STRANDS )
    {
        return 0;
    }
    const bool appearance = world->scene->strands[place.index].has_appearance;
    const bool moves = world->scene->strands[place.index].has_dynamics;
    return request == SCENE_REQUEST_POINTS                  ? WISP_STRAND_POINTS
           : request == SCENE_REQUEST_WIDTH && appearance   ? WISP_POINT_WIDTH
           : request == SCENE_REQUEST_COLOUR && appearance  ? WISP_POINT_COLOUR
           : request == SCENE_REQUEST_STRAIN && moves       ? WISP_POINT_STRAIN
           : request == SCENE_REQUEST_SPEED && moves        ? WISP_POINT_SPEED
           : request == SCENE_REQUEST_MOTION_STATS && moves ? WISP_MOTION_STATS
                                                            : 0;
}

bool scene_world_has( const scene_world* world, int body, scene_request request )
{
    return component_of( world, place_of( world, body ), request ) != 0;
}

wisp_entity scene_world_entity( const scene_world* world, int body )
{
    const body_place place = place_of( world, body );
    return is_surface( place ) ? world->surfaces[place.index].entity : world->entities[place.index];
}

int scene_world_substeps( const scene_world* world, int body )
{
    int substeps = 0;
    const wisp_status status = wisp_read_substeps( world->world, scene_world_entity( world, body ), &substeps );
    return status == WISP_OK ? substeps : world->scene->substeps;
}

static wisp_status find_component( const scene_world* world, int body, scene_request request, wisp_component* out,
                                   wisp_error* error )
{
    static const char* const words[] = {
        [SCENE_REQUEST_POINTS] = "points to request",
        [SCENE_REQUEST_STRAIN] = "strain",
        [SCENE_REQUEST_SPEED] = "speed",
        [SCENE_REQUEST_WIDTH] = "width",
        [SCENE_REQUEST_COLOUR] = "colour",
        [SCENE_REQUEST_MOTION_STATS] = "motion stats",
        [SCENE_REQUEST_NORMALS] = "normals",
    };
    *out = component_of( world, place_of( world, body ), request );
    return *out ? WISP_OK
                : wisp_fail( error, WISP_BAD_INPUT, "%s: '%s' has no %s", world->scene->name,
                             scene_world_body( world, body ).name, words[request] );
}

static wisp_status fail_at_body( const scene_world* world, int body, wisp_status status, wisp_error* error )
{
    return wisp_fail( error, status, "%s: '%s': %s", world->scene->name, scene_world_body( world, body ).name,
                      wisp_world_message( world->world ) );
}

wisp_status scene_world_request( scene_world* world, int body, scene_request request, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, request, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_request( world->world, scene_world_entity( world, body ), component );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

bool scene_world_is_shown( const scene_world* world, int body )
{
    return body >= world->scene->strands_count || world->scene->strands[body].is_shown;
}

wisp_status scene_world_request_shown( scene_world* world, wisp_error* error )
{
    wisp_status status = WISP_OK;
    for ( int body = 0; body < scene_world_moving_count( world ) && status == WISP_OK; ++body )
    {
        status = scene_world_is_shown( world, body ) ? scene_world_request( world, body, SCENE_REQUEST_POINTS, error )
                                                     : WISP_OK;
    }
    return status;
}

// ---- columns ----

static wisp_status view_column( const scene_world* world, int body, wisp_component component, wisp_view* out,
                                wisp_error* error )
{
    const wisp_entity entity = scene_world_entity( world, body );
    const wisp_status status = wisp_world_view( world->world, entity, component, out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

wisp_status scene_world_view( const scene_world* world, int body, scene_request request, wisp_view* out,
                              wisp_error* error )
{
    wisp_component component;
    const wisp_status status = find_component( world, body, request, &component, error );
    return status == WISP_OK ? view_column( world, body, component, out, error ) : status;
}

static wisp_status copy_column( const scene_world* world, int body, wisp_component component, size_t size, void* out,
                                wisp_error* error )
{
    wisp_view view;
    const wisp_status status = view_column( world, body, component, &view, error );
    if ( status != WISP_OK )
    {
        return status;
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
            out[v] = wisp_transform_to_world( c->pose, c->mesh.points[v] );
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

wisp_status scene_world_numbers( const scene_world* world, int body, scene_request request, float* out,
                                 wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, request, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    WISP_ASSERT( request == SCENE_REQUEST_STRAIN || request == SCENE_REQUEST_SPEED ||
                 request == SCENE_REQUEST_WIDTH );
    if ( world->next_step == 0 && request != SCENE_REQUEST_WIDTH )
    {
        memset( out, 0, (size_t)scene_world_body( world, body ).vertex_count * sizeof *out );
        return WISP_OK;
    }
    return copy_column( world, body, component, sizeof *out, out, error );
}

wisp_status scene_world_normals( const scene_world* world, int body, wisp_vec3* out, wisp_error* error )
{
    wisp_component component;
    wisp_status status = find_component( world, body, SCENE_REQUEST_NORMALS, &component, error );
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
    wisp_status status = find_component( world, body, SCENE_REQUEST_COLOUR, &component, error );
    return status == WISP_OK ? copy_column( world, body, component, sizeof *out, out, error ) : status;
}

wisp_status scene_world_strand_hold( const scene_world* world, int body, wisp_strand_hold* out, wisp_error* error )
{
    *out = ( wisp_strand_hold ){ 0 };
    const bool is_rod = body < world->scene->strands_count && world->scene->strands[body].has_dynamics &&
                        world->scene->strands[body].dynamics.bending == WISP_STRAND_BEND_ROD;
    if ( is_rod == false )
    {
        return wisp_fail( error, WISP_CONFLICT, "body %d has no rods", body );
    }
    const wisp_status status = wisp_read_strand_hold( world->world, scene_world_entity( world, body ), out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

wisp_status scene_world_motion_stats( const scene_world* world, int body, wisp_motion_stats* out, wisp_error* error )
{
    *out = ( wisp_motion_stats ){ 0 };
    wisp_component component;
    wisp_status status = find_component( world, body, SCENE_REQUEST_MOTION_STATS, &component, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    status = wisp_read_motion_stats( world->world, scene_world_entity( world, body ), out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

wisp_status scene_world_collision_stats( const scene_world* world, int body, wisp_collision_stats* out,
                                         wisp_error* error )
{
    const wisp_status status = wisp_read_collision_stats( world->world, scene_world_entity( world, body ), out );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

double scene_world_time( const scene_world* world )
{
    return wisp_scene_step_time( world->scene, world->next_step );
}
