// Scenes: what a page shows of one before it runs, and the parameters that it may change, which are those of `wisp tune`.
#include "web.h"

wisp_error web_error;

WEB_API const char* web_version( void )
{
    return WISP_VERSION_STRING;
}

WEB_API const char* web_message( void )
{
    return web_error.message;
}

WEB_API binding_scene* web_scene_open( const char* path )
{
    binding_scene* s = NULL;
    return binding_scene_read( path, &s, &web_error ) == WISP_OK ? s : NULL;
}

WEB_API void web_scene_close( binding_scene* s )
{
    binding_scene_close( s );
}

WEB_API double web_scene_dt( const binding_scene* s )
{
    return binding_scene_dt( s );
}

WEB_API int web_scene_steps( const binding_scene* s )
{
    return binding_scene_steps( s );
}

/// @param out [3] m/s^2
WEB_API void web_scene_gravity( const binding_scene* s, float* out )
{
    binding_scene_gravity( s, out );
}

// ---- parameters ----

WEB_API int web_scene_parameter_count( const binding_scene* s )
{
    return binding_parameter_count( s );
}

WEB_API const char* web_scene_parameter_name( const binding_scene* s, int parameter )
{
    return binding_parameter_name( s, parameter );
}

WEB_API int web_scene_parameter_is_unordered( const binding_scene* s, int parameter )
{
    return binding_parameter_is_unordered( s, parameter );
}

/// @param out [TUNE_MAX_VALUES] @return how many values there are
WEB_API int web_scene_parameter_values( const binding_scene* s, int parameter, double* out )
{
    return binding_parameter_values( s, parameter, out );
}

/// @return the scene's own value
WEB_API double web_scene_parameter_value( const binding_scene* s, int parameter )
{
    return binding_parameter_value( s, parameter );
}

/// Write the scene with other parameters; every other byte of its file stays.
/// @param configuration [parameter count] index of a value for each parameter
WEB_API int web_scene_write( const binding_scene* s, const char* from, const int* configuration, const char* to )
{
    return binding_scene_edit_file( s, from, configuration, to, &web_error ) == WISP_OK;
}
