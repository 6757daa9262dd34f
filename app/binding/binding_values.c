// Values of bodies: where the engine keeps them, or copies where it keeps none.
#include "binding_internal.h"

#include <string.h>

bool binding_body_has( const binding_world* w, int body, int value )
{
    return scene_world_has( &w->world, body, (scene_request)value );
}

bool binding_body_computes( const binding_world* w, int body, int value )
{
    if ( body >= scene_world_moving_count( &w->world ) )
    {
        return false;
    }
    const bool is_strands = body < w->scene.strands_count;
    const wisp_scene_strands* strands = is_strands ? &w->scene.strands[body] : NULL;
    const wisp_scene_surface* surface = is_strands ? NULL : &w->scene.surfaces[body - w->scene.strands_count];
    switch ( (scene_request)value )
    {
        case SCENE_REQUEST_POINTS:
            return is_strands ? strands->request_points : surface->request_points;
        case SCENE_REQUEST_STRAIN:
            return is_strands ? strands->request_strain : surface->request_strain;
        case SCENE_REQUEST_SPEED:
            return is_strands ? strands->request_speed : surface->request_speed;
        case SCENE_REQUEST_MOTION_STATS:
            return is_strands ? strands->request_motion_stats : surface->request_motion_stats;
        case SCENE_REQUEST_WIDTH:
            return is_strands && strands->request_width;
        case SCENE_REQUEST_COLOUR:
            return is_strands && strands->request_colour;
        case SCENE_REQUEST_NORMALS:
            return !is_strands && surface->request_normals;
    }
    return false;
}

wisp_status binding_request( binding_world* w, int body, int value, wisp_error* error )
{
    return binding_find_body( w, body, error ) ? scene_world_request( &w->world, body, (scene_request)value, error )
                                               : error->status;
}

int binding_value_width( int value )
{
    return value == SCENE_REQUEST_POINTS || value == SCENE_REQUEST_NORMALS || value == SCENE_REQUEST_COLOUR ? 3 : 1;
}

bool binding_value_is_live( const binding_world* w, int body, int value )
{
    const bool is_blended = value == SCENE_REQUEST_POINTS && w->is_between;
    return w->world.next_step > 0 && body < scene_world_moving_count( &w->world ) && !is_blended;
}

wisp_status binding_value_view( const binding_world* w, int body, int value, const float** out, wisp_error* error )
{
    *out = NULL;
    if ( !binding_find_body( w, body, error ) )
    {
        return error->status;
    }
    if ( !binding_value_is_live( w, body, value ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: body %d: the engine has no memory of this value now",
                          w->scene.name, body );
    }
    wisp_view view;
    const wisp_status status = scene_world_view( &w->world, body, (scene_request)value, &view, error );
    if ( status == WISP_OK )
    {
        WISP_ASSERT( view.stride == (size_t)binding_value_width( value ) * sizeof( float ) );
        *out = view.data;
    }
    return status;
}

static wisp_status copy_start( const binding_world* w, int body, int value, float* out, wisp_error* error )
{
    if ( value == SCENE_REQUEST_POINTS )
    {
        return scene_world_points( &w->world, body, (wisp_vec3*)(void*)out, error );
    }
    if ( !scene_world_has( &w->world, body, (scene_request)value ) )
    {
        wisp_view none;
        return scene_world_view( &w->world, body, (scene_request)value, &none, error );
    }
    const size_t floats =
        (size_t)scene_world_body( &w->world, body ).vertex_count * (size_t)binding_value_width( value );
    memset( out, 0, floats * sizeof *out );
    return WISP_OK;
}

wisp_status binding_value_copy( const binding_world* w, int body, int value, float* out, wisp_error* error )
{
    if ( !binding_find_body( w, body, error ) )
    {
        return error->status;
    }
    if ( w->world.next_step == 0 || body >= scene_world_moving_count( &w->world ) )
    {
        return copy_start( w, body, value, out, error );
    }
    wisp_view view;
    const wisp_status status = scene_world_view( &w->world, body, (scene_request)value, &view, error );
    if ( status == WISP_OK )
    {
        WISP_ASSERT( view.stride == (size_t)binding_value_width( value ) * sizeof( float ) );
        memcpy( out, view.data, (size_t)view.count * view.stride );
    }
    return status;
}

wisp_status binding_motion_stats( const binding_world* w, int body, wisp_motion_stats* out, wisp_error* error )
{
    return binding_find_body( w, body, error ) ? scene_world_motion_stats( &w->world, body, out, error )
                                               : error->status;
}
