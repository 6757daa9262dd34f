// A world: its steps, bodies, values and costs.
#include "web.h"

#include "tune_parameters.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- life ----

// The converged run of a scene: the finest value of every setting, and a multiple of its substeps.
static bool refine( wisp_scene* scene, int factor )
{
    tune_parameters settings;
    int finest[WISP_TUNE_MAX_PARAMETERS];
    if ( tune_parameters_find( scene, &settings, &web_error ) != WISP_OK )
    {
        return false;
    }
    for ( int k = 0; k < settings.count; ++k )
    {
        finest[k] = settings.parameters[k].value_count - 1;
    }
    tune_parameters_set( &settings, finest, scene );
    wisp_scene_refine( scene, factor );
    return true;
}

WEB_API void web_world_close( web_world* w )
{
    scene_world_destroy( &w->world );
    wisp_scene_release( &w->scene );
    free( w->buffer );
    free( w->hair );
    free( w );
}

// The lists of the scene, which commands replace and a snapshot may bring back.
static bool keep_hair( web_world* w )
{
    w->hair = calloc( (size_t)w->scene.strands_count + 1, sizeof *w->hair );
    for ( int i = 0; w->hair && i < w->scene.strands_count; ++i )
    {
        w->hair[i] = w->scene.strands[i].frozen_hair;
    }
    if ( !w->hair )
    {
        wisp_fail( &web_error, WISP_NO_MEMORY, "%s: out of memory for the world", w->scene.name );
    }
    return w->hair != NULL;
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
    const scene_world_options options = { .workers = 1 };
    const bool is_made = web_scene_load( path, &w->scene ) &&
                         ( reference_factor == 0 || refine( &w->scene, reference_factor ) ) &&
                         scene_world_create( &w->scene, &options, &w->world, &web_error ) == WISP_OK;
    if ( !is_made )
    {
        wisp_scene_release( &w->scene );
        free( w );
        return NULL;
    }
    if ( !keep_hair( w ) )
    {
        web_world_close( w );
        return NULL;
    }
    if ( scene_world_request_shown( &w->world, &web_error ) != WISP_OK )
    {
        web_world_close( w );
        return NULL;
    }
    return w;
}

WEB_API int web_world_step( web_world* w )
{
    return scene_world_step( &w->world, &web_error ) == WISP_OK;
}

WEB_API int web_world_step_count( const web_world* w )
{
    return w->world.next_step;
}

WEB_API double web_world_time( const web_world* w )
{
    return scene_world_time( &w->world );
}

/// @return the hash of the state as `wisp run` prints it
WEB_API const char* web_world_hash( web_world* w )
{
    snprintf( w->hash, sizeof w->hash, "%016llx", (unsigned long long)wisp_world_hash( w->world.world ) );
    return w->hash;
}

// ---- bodies ----

WEB_API int web_body_count( const web_world* w )
{
    return scene_world_body_count( &w->world );
}

WEB_API const char* web_body_name( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).name;
}

/// @return a scene_body_kind
WEB_API int web_body_kind( const web_world* w, int body )
{
    return (int)scene_world_body( &w->world, body ).kind;
}

WEB_API int web_body_vertices( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).vertex_count;
}

WEB_API const int32_t* web_body_triangles( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).triangles;
}

WEB_API int web_body_triangle_count( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).triangle_count;
}

WEB_API const int32_t* web_body_offsets( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).offsets;
}

WEB_API int web_body_strands( const web_world* w, int body )
{
    return scene_world_body( &w->world, body ).strand_count;
}

/// Whether the points of a body can be read, because pictures show it.
WEB_API int web_body_is_shown( const web_world* w, int body )
{
    return scene_world_is_shown( &w->world, body );
}

// ---- values ----

WEB_API int web_body_has( const web_world* w, int body, int what )
{
    return scene_world_has( &w->world, body, (scene_request)what );
}

/// Whether the scene computes a value itself, so that requesting it changes nothing.
WEB_API int web_body_computes( const web_world* w, int body, int what )
{
    if ( body >= scene_world_moving_count( &w->world ) )
    {
        return 0;
    }
    const bool is_strands = body < w->scene.strands_count;
    const wisp_scene_strands* strands = is_strands ? &w->scene.strands[body] : NULL;
    const wisp_scene_surface* surface = is_strands ? NULL : &w->scene.surfaces[body - w->scene.strands_count];
    switch ( (scene_request)what )
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
    return 0;
}

/// What the scene does not compute becomes part of the hash. @param what a scene_request
WEB_API int web_request( web_world* w, int body, int what )
{
    return scene_world_request( &w->world, body, (scene_request)what, &web_error ) == WISP_OK;
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

// What no step has written: positions at the start and those of colliders. Other values are 0 then.
static const float* copy_values( web_world* w, int body, scene_request what, size_t per_vertex )
{
    const size_t floats = (size_t)scene_world_body( &w->world, body ).vertex_count * per_vertex;
    float* out = take_buffer( w, floats );
    if ( out && what == SCENE_REQUEST_POINTS )
    {
        return scene_world_points( &w->world, body, (wisp_vec3*)(void*)out, &web_error ) == WISP_OK ? out : NULL;
    }
    if ( out )
    {
        memset( out, 0, floats * sizeof *out );
    }
    return out;
}

/// @param what a scene_request with a value for each vertex
/// @return [vertices] vectors or numbers, where the engine keeps them; until the next call that changes the world
WEB_API const float* web_values( web_world* w, int body, int what )
{
    const bool is_vector =
        what == SCENE_REQUEST_POINTS || what == SCENE_REQUEST_NORMALS || what == SCENE_REQUEST_COLOUR;
    const size_t per_vertex = is_vector ? 3 : 1;
    if ( w->world.next_step == 0 || body >= scene_world_moving_count( &w->world ) )
    {
        return copy_values( w, body, (scene_request)what, per_vertex );
    }
    wisp_view view;
    if ( scene_world_view( &w->world, body, (scene_request)what, &view, &web_error ) != WISP_OK )
    {
        return NULL;
    }
    WISP_ASSERT( view.stride == per_vertex * sizeof( float ) );
    return view.data;
}

/// @param out [7] mass, kinetic and potential energy, volume, largest and mean strain, largest speed
WEB_API int web_motion_stats( const web_world* w, int body, double* out )
{
    wisp_motion_stats m;
    if ( scene_world_motion_stats( &w->world, body, &m, &web_error ) != WISP_OK )
    {
        return 0;
    }
    const double values[] = { m.mass,       m.kinetic_energy, m.potential_energy, m.volume,
                              m.strain_max, m.strain_mean,    m.speed_max };
    memcpy( out, values, sizeof values );
    return 1;
}

// ---- costs ----

WEB_API double web_step_seconds( const web_world* w )
{
    return wisp_world_profile( w->world.world ).seconds;
}

WEB_API int web_profile_count( const web_world* w )
{
    return wisp_world_profile( w->world.world ).count;
}

WEB_API const char* web_profile_pass( const web_world* w, int line )
{
    return wisp_world_profile( w->world.world ).lines[line].pass;
}

WEB_API double web_profile_seconds( const web_world* w, int line )
{
    return wisp_world_profile( w->world.world ).lines[line].seconds;
}

WEB_API int web_counter_count( void )
{
    return WISP_COUNTER_COUNT;
}

WEB_API const char* web_counter_name( int counter )
{
    return wisp_counter_name( (wisp_counter)counter );
}

WEB_API double web_counter( const web_world* w, int counter )
{
    return (double)wisp_world_counter( w->world.world, (wisp_counter)counter );
}

WEB_API double web_memory_bytes( const web_world* w )
{
    return (double)scene_world_bytes( &w->world );
}

// ---- snapshots ----

/// Where the scene stands. In front of the world's own bytes, with the parameters of each strands behind it.
typedef struct snapshot_place
{
    int32_t next_step, next_command, next_event, is_combed;
} snapshot_place;

static size_t front_size( const web_world* w )
{
    return sizeof( snapshot_place ) + (size_t)w->scene.strands_count * sizeof( web_hair );
}

/// @return bytes, -1 if they are more than a call can name
WEB_API int web_snapshot_size( const web_world* w )
{
    const size_t size = front_size( w ) + wisp_world_snapshot_size( w->world.world );
    return size < INT32_MAX ? (int)size : -1;
}

int web_report( const web_world* w, wisp_status status )
{
    if ( status != WISP_OK )
    {
        wisp_fail( &web_error, status, "%s", wisp_world_message( w->world.world ) );
    }
    return status == WISP_OK;
}

/// @param size at least web_snapshot_size()
WEB_API int web_snapshot( const web_world* w, void* out, int size )
{
    const snapshot_place place = { w->world.next_step, w->world.next_command, w->world.next_event, w->is_combed };
    memcpy( out, &place, sizeof place );
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        const web_hair hair = web_hair_state( w, i );
        memcpy( (char*)out + sizeof place + (size_t)i * sizeof hair, &hair, sizeof hair );
    }
    const size_t front = front_size( w );
    return web_report( w, wisp_world_snapshot( w->world.world, (char*)out + front, (size_t)size - front ) );
}

static bool is_place( const web_world* w, const snapshot_place* place )
{
    return place->next_step >= 0 && place->next_command >= 0 && place->next_command <= w->scene.command_count &&
           place->next_event >= 0 && place->next_event <= w->scene.event_count;
}

WEB_API int web_restore( web_world* w, const void* bytes, int size )
{
    const size_t front = front_size( w );
    snapshot_place place = { .next_step = -1 };
    if ( size >= 0 && (size_t)size >= front )
    {
        memcpy( &place, bytes, sizeof place );
    }
    if ( !is_place( w, &place ) )
    {
        wisp_fail( &web_error, WISP_BAD_INPUT, "got %d bytes, which are no snapshot of this world", size );
        return 0;
    }
    const wisp_status status = wisp_world_restore( w->world.world, (const char*)bytes + front, (size_t)size - front );
    for ( int i = 0; i < w->scene.strands_count && status == WISP_OK; ++i )
    {
        web_hair hair;
        memcpy( &hair, (const char*)bytes + sizeof place + (size_t)i * sizeof hair, sizeof hair );
        web_hair_restore( w, i, hair );
    }
    if ( status == WISP_OK )
    {
        w->world.next_step = place.next_step;
        w->world.next_command = place.next_command;
        w->world.next_event = place.next_event;
        w->is_combed = place.is_combed;
    }
    return web_report( w, status );
}
