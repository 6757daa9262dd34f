// What a user does to a world: holds vertices, moves colliders, changes gravity and wind.
#include "web.h"

static int find_hold( const web_world* w, int body, int vertex )
{
    int k = 0;
    while ( k < w->hold_count && ( w->holds[k].body != body || w->holds[k].vertex != vertex ) )
    {
        ++k;
    }
    return k;
}

static scene_hold* held( web_world* w, int body, int vertex )
{
    const int k = find_hold( w, body, vertex );
    if ( k == w->hold_count )
    {
        wisp_fail( &web_error, WISP_CONFLICT, "vertex %d of body %d is not held", vertex, body );
    }
    return k < w->hold_count ? &w->holds[k] : NULL;
}

WEB_API int web_grab( web_world* w, int body, int vertex )
{
    if ( find_hold( w, body, vertex ) < w->hold_count )
    {
        return 1;
    }
    if ( w->hold_count == WEB_MAX_HOLDS )
    {
        wisp_fail( &web_error, WISP_CONFLICT, "%d vertices are held, which is the limit", WEB_MAX_HOLDS );
        return 0;
    }
    if ( scene_world_grab( &w->world, body, vertex, &w->holds[w->hold_count], &web_error ) != WISP_OK )
    {
        return 0;
    }
    ++w->hold_count;
    return 1;
}

WEB_API int web_drag( web_world* w, int body, int vertex, float x, float y, float z )
{
    const scene_hold* hold = held( w, body, vertex );
    return hold && scene_world_drag( &w->world, hold, ( wisp_vec3 ){ x, y, z }, &web_error ) == WISP_OK;
}

WEB_API int web_let_go( web_world* w, int body, int vertex )
{
    scene_hold* hold = held( w, body, vertex );
    if ( !hold || scene_world_let_go( &w->world, hold, &web_error ) != WISP_OK )
    {
        return 0;
    }
    *hold = w->holds[--w->hold_count];
    return 1;
}

WEB_API int web_move_collider( web_world* w, int body, float x, float y, float z )
{
    return scene_world_move_collider( &w->world, body, ( wisp_vec3 ){ x, y, z }, &web_error ) == WISP_OK;
}

/// @param out [3] m, where a collider's own origin is
WEB_API int web_collider_place( const web_world* w, int body, float* out )
{
    const int index = body - scene_world_moving_count( &w->world );
    if ( index < 0 || body >= scene_world_body_count( &w->world ) )
    {
        wisp_fail( &web_error, WISP_CONFLICT, "body %d is no collider", body );
        return 0;
    }
    const wisp_vec3 at = w->world.colliders[index].pose.translation;
    out[0] = at.x;
    out[1] = at.y;
    out[2] = at.z;
    return 1;
}

WEB_API int web_set_gravity( web_world* w, float x, float y, float z )
{
    return scene_world_set_gravity( &w->world, ( wisp_vec3 ){ x, y, z }, &web_error ) == WISP_OK;
}

/// @return how many entities feel it, -1 on failure
WEB_API int web_set_wind( web_world* w, float x, float y, float z )
{
    int felt;
    const wisp_status status = scene_world_set_wind( &w->world, ( wisp_vec3 ){ x, y, z }, &felt, &web_error );
    return status == WISP_OK ? felt : -1;
}
