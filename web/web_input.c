// What a user does to a world: holds vertices, moves colliders, changes gravity and wind.
#include "web.h"

WEB_API int web_grab( web_world* w, int body, int vertex )
{
    return binding_grab( w->world, body, vertex, &web_error ) == WISP_OK;
}

WEB_API int web_drag( web_world* w, int body, int vertex, float x, float y, float z )
{
    return binding_drag( w->world, body, vertex, x, y, z, &web_error ) == WISP_OK;
}

WEB_API int web_let_go( web_world* w, int body, int vertex )
{
    return binding_let_go( w->world, body, vertex, &web_error ) == WISP_OK;
}

WEB_API int web_move_collider( web_world* w, int body, float x, float y, float z )
{
    return binding_move_collider( w->world, body, x, y, z, &web_error ) == WISP_OK;
}

/// @param out [3] m, where a collider's own origin is
WEB_API int web_collider_place( const web_world* w, int body, float* out )
{
    return binding_collider_place( w->world, body, out, &web_error ) == WISP_OK;
}

WEB_API int web_set_gravity( web_world* w, float x, float y, float z )
{
    return binding_set_gravity( w->world, x, y, z, &web_error ) == WISP_OK;
}

/// @return how many entities feel it, -1 on failure
WEB_API int web_set_wind( web_world* w, float x, float y, float z )
{
    int felt;
    return binding_set_wind( w->world, x, y, z, &felt, &web_error ) == WISP_OK ? felt : -1;
}
