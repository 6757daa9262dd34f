// Bodies: strands, surfaces and colliders under one numbering, for recordings and pictures.
#include "world_from_scene_parts.h"

#include "palette.h"
#include "world_from_scene.h"

#include "wisp/module/definition.h"

#include <stdlib.h>
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
    WISP_TRY( find_component( world, body, request, &component, error ) );
    wisp_status status = wisp_request( world->world, scene_world_entity( world, body ), component );
    return status == WISP_OK ? WISP_OK : fail_at_body( world, body, status, error );
}

bool scene_world_is_shown( const scene_world* world, int body )
{
    return body >= world->scene->strands_count || world->scene->strands[body].is_shown;
}

wisp_status scene_world_request_shown( scene_world* world, wisp_error* error )
{
    for ( int body = 0; body < scene_world_moving_count( world ); ++body )
    {
        WISP_TRY( scene_world_is_shown( world, body )
                      ? scene_world_request( world, body, SCENE_REQUEST_POINTS, error )
                      : WISP_OK );
    }
    return WISP_OK;
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
    WISP_TRY( view_column( world, body, component, &view, error ) );
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
    WISP_TRY( find_component( world, body, request, &component, error ) );
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
    WISP_TRY( find_component( world, body, SCENE_REQUEST_MOTION_STATS, &component, error ) );
    wisp_status status = wisp_read_motion_stats( world->world, scene_world_entity( world, body ), out );
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

// ---- colours ----

// Every other colour first and the rest afterwards, so that all eight occur before one repeats, and cloth and
// balloons of a small scene share none.
static int palette_place( int number )
{
    return 2 * number + number / 4 % 2;
}

// Cloth and balloons start at different ends, so that the first of each has the colour that suits it best.
wisp_vec3 scene_body_colour( scene_body_kind kind, int* cloths, int* balloons )
{
    switch ( kind )
    {
        case SCENE_BODY_CLOTH:
            return palette_body( 1 + palette_place( ( *cloths )++ ) );
        case SCENE_BODY_BALLOON:
            return palette_body( palette_place( ( *balloons )++ ) );
        case SCENE_BODY_STRANDS:
            return palette_hair();
        case SCENE_BODY_COLLIDER:
        case SCENE_BODY_PLANE:
            break;
    }
    return palette_solid();
}

// ---- what a user does ----

static wisp_status fail_world( const scene_world* world, wisp_status status, wisp_error* error )
{
    return status == WISP_OK
               ? WISP_OK
               : wisp_fail( error, status, "%s: %s", world->scene->name, wisp_world_message( world->world ) );
}

// ---- vertices ----

static bool is_of_surface( const scene_world* world, int body )
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
        world->head_offsets =
            io_get( &world->memory, (size_t)world->scene->strands_count * sizeof *world->head_offsets );
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
    WISP_TRY( scene_world_view( world, hold->body, SCENE_REQUEST_POINTS, &view, error ) );
    hold->from = *(const wisp_vec3*)(const void*)( (const char*)view.data + (size_t)hold->vertex * view.stride );
    return WISP_OK;
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
    return is_of_surface( world, body ) ? grab_surface( world, out, error ) : grab_strands( world, out, error );
}

wisp_status scene_world_drag( scene_world* world, const scene_hold* hold, wisp_vec3 target, wisp_error* error )
{
    if ( is_of_surface( world, hold->body ) )
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
    if ( !is_of_surface( world, hold->body ) || hold->was_pinned )
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

wisp_status scene_world_set_wind( scene_world* world, wisp_vec3 wind, int* felt, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    *felt = 0;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        if ( scene->strands[i].has_dynamics )
        {
            status = wisp_set_strand_wind( world->world, world->entities[i], wind );
            ++*felt;
        }
    }
    for ( int i = 0; i < scene->surface_count && status == WISP_OK; ++i )
    {
        if ( scene->surfaces[i].has_cloth )
        {
            status = wisp_set_cloth_wind( world->world, world->surfaces[i].entity, wind );
            ++*felt;
        }
    }
    return fail_world( world, status, error );
}
