// Worlds: life, steps, bodies, costs.
#include "binding_internal.h"

#include <stdlib.h>

// ---- life ----

// The converged run of a scene: the finest value of every parameter, and a multiple of its substeps.
static wisp_status refine( wisp_scene* scene, int factor, wisp_error* error )
{
    tune_parameters parameters;
    int finest[WISP_TUNE_MAX_PARAMETERS];
    const wisp_status status = tune_parameters_find( scene, &parameters, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    for ( int k = 0; k < parameters.count; ++k )
    {
        finest[k] = parameters.parameters[k].value_count - 1;
    }
    tune_parameters_set( &parameters, finest, scene );
    wisp_scene_refine( scene, factor );
    return WISP_OK;
}

void binding_world_close( binding_world* w )
{
    if ( !w )
    {
        return;
    }
    if ( w->world.scene )
    {
        scene_world_destroy( &w->world );
    }
    wisp_scene_release( &w->scene );
    free( w->holds );
    free( w->hair );
    free( w );
}

// The lists of the scene, which commands replace and a snapshot may bring back.
static wisp_status keep_hair( binding_world* w, wisp_error* error )
{
    w->hair = calloc( (size_t)w->scene.strands_count + 1, sizeof *w->hair );
    if ( !w->hair )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the world", w->scene.name );
    }
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        w->hair[i] = w->scene.strands[i].frozen_hair;
    }
    return WISP_OK;
}

static wisp_status make( const binding_scene* scene, const binding_options* options, binding_world* w,
                         wisp_error* error )
{
    const scene_world_options world = { .workers = options->workers,
                                        .isa = options->isa,
                                        .is_quiet = options->is_quiet,
                                        .log = options->log,
                                        .log_user = options->log_user };
    wisp_status status = binding_scene_again( scene, &w->scene, error );
    if ( status == WISP_OK && options->reference_factor > 0 )
    {
        status = refine( &w->scene, options->reference_factor, error );
    }
    status = status == WISP_OK ? scene_world_create( &w->scene, &world, &w->world, error ) : status;
    status = status == WISP_OK ? keep_hair( w, error ) : status;
    return status == WISP_OK ? scene_world_request_shown( &w->world, error ) : status;
}

wisp_status binding_world_open( const binding_scene* scene, const binding_options* options, binding_world** out,
                                wisp_error* error )
{
    *out = NULL;
    binding_world* w = calloc( 1, sizeof *w );
    if ( !w )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for the world", scene->name );
    }
    const wisp_status status = make( scene, options, w, error );
    if ( status != WISP_OK )
    {
        binding_world_close( w );
        return status;
    }
    *out = w;
    return WISP_OK;
}

wisp_status binding_fail( const binding_world* w, wisp_status status, wisp_error* error )
{
    return status == WISP_OK ? WISP_OK : wisp_fail( error, status, "%s", wisp_world_message( w->world.world ) );
}

// ---- steps ----

wisp_status binding_world_step( binding_world* w, wisp_error* error )
{
    w->is_between = false;
    return scene_world_step( &w->world, error );
}

wisp_status binding_world_advance( binding_world* w, float seconds, wisp_error* error )
{
    const wisp_status status = scene_world_advance( &w->world, seconds, error );
    w->is_between = w->is_between || status == WISP_OK;
    return status;
}

int binding_world_step_count( const binding_world* w )
{
    return w->world.next_step;
}

double binding_world_time( const binding_world* w )
{
    return scene_world_time( &w->world );
}

uint64_t binding_world_hash( const binding_world* w )
{
    return wisp_world_hash( w->world.world );
}

int binding_world_workers( const binding_world* w )
{
    return wisp_world_workers( w->world.world );
}

const char* binding_world_isa( const binding_world* w )
{
    return wisp_world_isa( w->world.world );
}

wisp_status binding_world_write_outputs( binding_world* w, wisp_error* error )
{
    return scene_world_write_outputs( &w->world, error );
}

// ---- bodies ----

bool binding_find_body( const binding_world* w, int body, wisp_error* error )
{
    const int count = scene_world_body_count( &w->world );
    if ( body < 0 || body >= count )
    {
        wisp_fail( error, WISP_BAD_INPUT, "%s: got body %d, but the scene has %d bodies, counted from 0",
                   w->scene.name, body, count );
        return false;
    }
    return true;
}

int binding_body_count( const binding_world* w )
{
    return scene_world_body_count( &w->world );
}

const char* binding_body_name( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).name;
}

int binding_body_kind( const binding_world* w, int body )
{
    return (int)scene_world_body( &w->world, body ).kind;
}

int binding_body_vertices( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).vertex_count;
}

const int32_t* binding_body_triangles( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).triangles;
}

bool binding_body_tears( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).tears;
}

int binding_body_triangle_count( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).triangle_count;
}

const int32_t* binding_body_offsets( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).offsets;
}

int binding_body_strands( const binding_world* w, int body )
{
    return scene_world_body( &w->world, body ).strand_count;
}

bool binding_body_is_shown( const binding_world* w, int body )
{
    return scene_world_is_shown( &w->world, body );
}

static wisp_entity moving_entity( const binding_world* w, int body )
{
    return body < w->scene.strands_count ? w->world.entities[body]
                                         : w->world.surfaces[body - w->scene.strands_count].entity;
}

bool binding_body_is_halted( const binding_world* w, int body )
{
    return body >= 0 && body < scene_world_moving_count( &w->world ) &&
           wisp_is_halted( w->world.world, moving_entity( w, body ) );
}

wisp_status binding_body_resume( binding_world* w, int body, wisp_error* error )
{
    if ( body < 0 || body >= scene_world_moving_count( &w->world ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: body %d does not move by itself", w->scene.name, body );
    }
    return binding_fail( w, wisp_resume( w->world.world, moving_entity( w, body ) ), error );
}

// ---- costs ----

double binding_step_seconds( const binding_world* w )
{
    return wisp_world_profile( w->world.world ).seconds;
}

int binding_profile_count( const binding_world* w )
{
    return wisp_world_profile( w->world.world ).count;
}

const char* binding_profile_pass( const binding_world* w, int line )
{
    return wisp_world_profile( w->world.world ).lines[line].pass;
}

double binding_profile_seconds( const binding_world* w, int line )
{
    return wisp_world_profile( w->world.world ).lines[line].seconds;
}

int binding_counter_count( void )
{
    return WISP_COUNTER_COUNT;
}

const char* binding_counter_name( int counter )
{
    return wisp_counter_name( (wisp_counter)counter );
}

uint64_t binding_counter( const binding_world* w, int counter )
{
    return wisp_world_counter( w->world.world, (wisp_counter)counter );
}

size_t binding_memory_bytes( const binding_world* w )
{
    return scene_world_bytes( &w->world );
}

int binding_memory_parts( const binding_world* w, wisp_memory_part* out, int capacity )
{
    return wisp_world_memory_parts( w->world.world, out, capacity );
}
