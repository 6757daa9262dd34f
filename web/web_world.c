// A world: its steps, bodies, values and costs.
#include "web.h"

#include <stdio.h>
#include <stdlib.h>

// ---- life ----

WEB_API void web_world_close( web_world* w )
{
    binding_world_close( w->world );
    free( w->buffer );
    free( w );
}

static bool open_world( const char* path, int reference_factor, binding_world** out )
{
    const binding_options options = { .workers = 1, .reference_factor = reference_factor };
    binding_scene* scene = NULL;
    const bool is_open = binding_scene_read( path, &scene, &web_error ) == WISP_OK &&
                         binding_world_open( scene, &options, out, &web_error ) == WISP_OK;
    binding_scene_close( scene );
    return is_open;
}

/// @param reference_factor 0: the scene as it is; else its converged run with that multiple of the finest substeps
WEB_API web_world* web_world_open( const char* path, int reference_factor )
{
    web_world* w = calloc( 1, sizeof *w );
    if ( !w )
    {
        wisp_fail( &web_error, WISP_NO_MEMORY, "%s: out of memory for the world", path );
        return NULL;
    }
    if ( !open_world( path, reference_factor, &w->world ) )
    {
        free( w );
        return NULL;
    }
    return w;
}

WEB_API int web_world_step( web_world* w )
{
    return binding_world_step( w->world, &web_error ) == WISP_OK;
}

WEB_API int web_world_step_count( const web_world* w )
{
    return binding_world_step_count( w->world );
}

WEB_API double web_world_time( const web_world* w )
{
    return binding_world_time( w->world );
}

/// @return the hash of the state as `wisp run` prints it
WEB_API const char* web_world_hash( web_world* w )
{
    snprintf( w->hash, sizeof w->hash, "%016llx", (unsigned long long)binding_world_hash( w->world ) );
    return w->hash;
}

// ---- bodies ----

WEB_API int web_body_count( const web_world* w )
{
    return binding_body_count( w->world );
}

WEB_API const char* web_body_name( const web_world* w, int body )
{
    return binding_body_name( w->world, body );
}

/// @return a scene_body_kind
WEB_API int web_body_kind( const web_world* w, int body )
{
    return binding_body_kind( w->world, body );
}

WEB_API int web_body_vertices( const web_world* w, int body )
{
    return binding_body_vertices( w->world, body );
}

WEB_API const int32_t* web_body_triangles( const web_world* w, int body )
{
    return binding_body_triangles( w->world, body );
}

WEB_API int web_body_tears( const web_world* w, int body )
{
    return binding_body_tears( w->world, body );
}

WEB_API int web_body_triangle_count( const web_world* w, int body )
{
    return binding_body_triangle_count( w->world, body );
}

WEB_API const int32_t* web_body_offsets( const web_world* w, int body )
{
    return binding_body_offsets( w->world, body );
}

WEB_API int web_body_strands( const web_world* w, int body )
{
    return binding_body_strands( w->world, body );
}

/// Whether the points of a body can be read, because pictures show it.
WEB_API int web_body_is_shown( const web_world* w, int body )
{
    return binding_body_is_shown( w->world, body );
}

// ---- values ----

WEB_API int web_body_has( const web_world* w, int body, int what )
{
    return binding_body_has( w->world, body, what );
}

/// Whether the scene computes a value itself, so that requesting it changes nothing.
WEB_API int web_body_computes( const web_world* w, int body, int what )
{
    return binding_body_computes( w->world, body, what );
}

/// What the scene does not compute becomes part of the hash. @param what a scene_request
WEB_API int web_request( web_world* w, int body, int what )
{
    return binding_request( w->world, body, what, &web_error ) == WISP_OK;
}

static float* take_buffer( web_world* w, size_t floats )
{
    if ( floats > w->buffer_floats )
    {
        float* larger = realloc( w->buffer, floats * sizeof *larger );
        if ( !larger )
        {
            wisp_fail( &web_error, WISP_NO_MEMORY, "out of memory for values" );
            return NULL;
        }
        w->buffer = larger;
        w->buffer_floats = floats;
    }
    return w->buffer;
}

/// @param what a scene_request with a value for each vertex
/// @return [vertices] vectors or numbers, where the engine keeps them; until the next call that changes the world
WEB_API const float* web_values( web_world* w, int body, int what )
{
    const float* values = NULL;
    if ( binding_value_is_live( w->world, body, what ) )
    {
        return binding_value_view( w->world, body, what, &values, &web_error ) == WISP_OK ? values : NULL;
    }
    float* copy =
        take_buffer( w, (size_t)binding_body_vertices( w->world, body ) * (size_t)binding_value_width( what ) );
    return copy && binding_value_copy( w->world, body, what, copy, &web_error ) == WISP_OK ? copy : NULL;
}

/// @param out [7] mass, kinetic and potential energy, volume, largest and mean strain, largest speed
WEB_API int web_motion_stats( const web_world* w, int body, double* out )
{
    wisp_motion_stats m;
    if ( binding_motion_stats( w->world, body, &m, &web_error ) != WISP_OK )
    {
        return 0;
    }
    out[0] = m.mass;
    out[1] = m.kinetic_energy;
    out[2] = m.potential_energy;
    out[3] = m.volume;
    out[4] = m.strain_max;
    out[5] = m.strain_mean;
    out[6] = m.speed_max;
    return 1;
}

// ---- costs ----

WEB_API double web_step_seconds( const web_world* w )
{
    return binding_step_seconds( w->world );
}

WEB_API int web_profile_count( const web_world* w )
{
    return binding_profile_count( w->world );
}

WEB_API const char* web_profile_pass( const web_world* w, int line )
{
    return binding_profile_pass( w->world, line );
}

WEB_API double web_profile_seconds( const web_world* w, int line )
{
    return binding_profile_seconds( w->world, line );
}

WEB_API int web_counter_count( void )
{
    return binding_counter_count();
}

WEB_API const char* web_counter_name( int counter )
{
    return binding_counter_name( counter );
}

WEB_API double web_counter( const web_world* w, int counter )
{
    return (double)binding_counter( w->world, counter );
}

WEB_API double web_memory_bytes( const web_world* w )
{
    return (double)binding_memory_bytes( w->world );
}

// ---- snapshots ----

/// @return bytes, -1 if they are more than a call can name, or on failure
WEB_API int web_snapshot_size( web_world* w )
{
    size_t size;
    const wisp_status status = binding_snapshot_prepare( w->world, &size, &web_error );
    return status == WISP_OK && size < INT32_MAX ? (int)size : -1;
}

/// @param size at least web_snapshot_size()
WEB_API int web_snapshot( const web_world* w, void* out, int size )
{
    return binding_snapshot( w->world, out, (size_t)size, &web_error ) == WISP_OK;
}

WEB_API int web_restore( web_world* w, const void* bytes, int size )
{
    return binding_restore( w->world, bytes, size >= 0 ? (size_t)size : 0, &web_error ) == WISP_OK;
}
