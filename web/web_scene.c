// Scenes: what a page shows of one before it runs, and the parameters that it may change, which are those of `wisp tune`.
#include "web.h"

#include "tune_parameters.h"
#include "tune_fields.h"

#include <stdlib.h>

wisp_error web_error;

/// A scene as read, and its parameters.
typedef struct web_scene
{
    wisp_scene scene;
    tune_parameters parameters; // none if nothing moves in time
} web_scene;

WEB_API const char* web_version( void )
{
    return WISP_VERSION_STRING;
}

WEB_API const char* web_message( void )
{
    return web_error.message;
}

bool web_scene_load( const char* path, wisp_scene* out )
{
    return wisp_scene_read( path, out, &web_error ) == WISP_OK;
}

WEB_API web_scene* web_scene_open( const char* path )
{
    web_scene* s = calloc( 1, sizeof *s );
    if ( !s )
    {
        wisp_fail( &web_error, WISP_NO_MEMORY, "%s: out of memory for the scene", path );
        return NULL;
    }
    if ( !web_scene_load( path, &s->scene ) )
    {
        free( s );
        return NULL;
    }
    wisp_error nothing_moves;
    if ( tune_parameters_find( &s->scene, &s->parameters, &nothing_moves ) != WISP_OK )
    {
        s->parameters.count = 0;
    }
    return s;
}

WEB_API void web_scene_close( web_scene* s )
{
    wisp_scene_release( &s->scene );
    free( s );
}

WEB_API double web_scene_dt( const web_scene* s )
{
    return (double)s->scene.dt;
}

WEB_API int web_scene_steps( const web_scene* s )
{
    return s->scene.steps;
}

/// @param out [3] m/s^2
WEB_API void web_scene_gravity( const web_scene* s, float* out )
{
    out[0] = s->scene.gravity.x;
    out[1] = s->scene.gravity.y;
    out[2] = s->scene.gravity.z;
}

// ---- parameters ----

WEB_API int web_scene_parameter_count( const web_scene* s )
{
    return s->parameters.count;
}

WEB_API const char* web_scene_parameter_name( const web_scene* s, int parameter )
{
    return s->parameters.parameters[parameter].name;
}

WEB_API int web_scene_parameter_is_unordered( const web_scene* s, int parameter )
{
    return s->parameters.parameters[parameter].is_unordered;
}

/// @param out [WISP_TUNE_MAX_VALUES] @return how many values there are
WEB_API int web_scene_parameter_values( const web_scene* s, int parameter, double* out )
{
    const wisp_tune_parameter* p = &s->parameters.parameters[parameter];
    for ( int i = 0; i < p->value_count; ++i )
    {
        out[i] = p->values[i];
    }
    return p->value_count;
}

/// @return the scene's own value
WEB_API double web_scene_parameter_value( const web_scene* s, int parameter )
{
    double own = 0.0;
    tune_field_own( &s->scene, s->parameters.fields[parameter], &own );
    return own;
}

/// Write the scene with other parameters; every other byte of its file stays.
/// @param configuration [parameter count] index of a value for each parameter
WEB_API int web_scene_write( const web_scene* s, const char* from, const int* configuration, const char* to )
{
    wisp_scene_edit* edits;
    int count;
    wisp_status status =
        tune_parameters_edits( &s->parameters, configuration, &s->scene, &edits, &count, &web_error );
    status = status == WISP_OK ? wisp_scene_edit_file( from, edits, count, to, &web_error ) : status;
    free( edits );
    return status == WISP_OK;
}
