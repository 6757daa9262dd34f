// Worlds: life, steps, bodies, costs, values; what a user does to them; snapshots.
#include "binding_internal.h"

#include "wisp/module/definition.h"

#include <stdlib.h>
#include <string.h>

// ---- life ----

// The converged run of a scene: the finest value of every parameter, and a multiple of its substeps.
static wisp_status refine( wisp_scene* scene, int factor, wisp_error* error )
{
    tune_parameters parameters;
    int finest[TUNE_MAX_PARAMETERS];
    WISP_TRY( tune_parameters_find( scene, &parameters, error ) );
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
    WISP_TRY( binding_scene_again( scene, &w->scene, error ) );
    WISP_TRY( options->reference_factor > 0 ? refine( &w->scene, options->reference_factor, error ) : WISP_OK );
    WISP_TRY( scene_world_create( &w->scene, &world, &w->world, error ) );
    WISP_TRY( keep_hair( w, error ) );
    return scene_world_request_shown( &w->world, error );
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

// Keep the message of a world's call that failed.
static wisp_status fail_with_message( const binding_world* w, wisp_status status, wisp_error* error )
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

// @return whether there is such a body; the error is set if not
static bool find_body( const binding_world* w, int body, wisp_error* error )
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
    return fail_with_message( w, wisp_resume( w->world.world, moving_entity( w, body ) ), error );
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

// ---- values of bodies ----

// Values of bodies: where the engine keeps them, or copies where it keeps none.

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
    return find_body( w, body, error ) ? scene_world_request( &w->world, body, (scene_request)value, error )
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
    if ( !find_body( w, body, error ) )
    {
        return error->status;
    }
    if ( !binding_value_is_live( w, body, value ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: body %d: the engine has no memory of this value now",
                          w->scene.name, body );
    }
    wisp_view view;
    WISP_TRY( scene_world_view( &w->world, body, (scene_request)value, &view, error ) );
    WISP_ASSERT( view.stride == (size_t)binding_value_width( value ) * sizeof( float ) );
    *out = view.data;
    return WISP_OK;
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
    if ( !find_body( w, body, error ) )
    {
        return error->status;
    }
    if ( w->world.next_step == 0 || body >= scene_world_moving_count( &w->world ) )
    {
        return copy_start( w, body, value, out, error );
    }
    wisp_view view;
    WISP_TRY( scene_world_view( &w->world, body, (scene_request)value, &view, error ) );
    WISP_ASSERT( view.stride == (size_t)binding_value_width( value ) * sizeof( float ) );
    memcpy( out, view.data, (size_t)view.count * view.stride );
    return WISP_OK;
}

wisp_status binding_motion_stats( const binding_world* w, int body, wisp_motion_stats* out, wisp_error* error )
{
    return find_body( w, body, error ) ? scene_world_motion_stats( &w->world, body, out, error ) : error->status;
}

// ---- what a user does ----

// What a user does to a world: holds and pins vertices, moves colliders, changes gravity and wind.

// ---- single vertices, of surfaces and strands ----

static int find_hold( const binding_world* w, int body, int vertex )
{
    int k = 0;
    while ( k < w->hold_count && ( w->holds[k].body != body || w->holds[k].vertex != vertex ) )
    {
        ++k;
    }
    return k;
}

static scene_hold* held( binding_world* w, int body, int vertex, wisp_error* error )
{
    const int k = find_hold( w, body, vertex );
    if ( k == w->hold_count )
    {
        wisp_fail( error, WISP_CONFLICT, "vertex %d of body %d is not held", vertex, body );
    }
    return k < w->hold_count ? &w->holds[k] : NULL;
}

static bool make_room( binding_world* w )
{
    if ( w->hold_count == w->hold_capacity )
    {
        const int capacity = w->hold_capacity > 0 ? 2 * w->hold_capacity : 16;
        scene_hold* larger = realloc( w->holds, (size_t)capacity * sizeof *larger );
        if ( !larger )
        {
            return false;
        }
        w->holds = larger;
        w->hold_capacity = capacity;
    }
    return true;
}

wisp_status binding_grab( binding_world* w, int body, int vertex, wisp_error* error )
{
    if ( find_hold( w, body, vertex ) < w->hold_count )
    {
        return WISP_OK;
    }
    if ( !make_room( w ) )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for held vertices", w->scene.name );
    }
    const wisp_status status = scene_world_grab( &w->world, body, vertex, &w->holds[w->hold_count], error );
    w->hold_count += status == WISP_OK;
    return status;
}

wisp_status binding_drag( binding_world* w, int body, int vertex, float x, float y, float z, wisp_error* error )
{
    const scene_hold* hold = held( w, body, vertex, error );
    return hold ? scene_world_drag( &w->world, hold, ( wisp_vec3 ){ x, y, z }, error ) : error->status;
}

wisp_status binding_let_go( binding_world* w, int body, int vertex, wisp_error* error )
{
    scene_hold* hold = held( w, body, vertex, error );
    WISP_TRY( hold ? scene_world_let_go( &w->world, hold, error ) : error->status );
    *hold = w->holds[--w->hold_count];
    return WISP_OK;
}

// ---- pins of surfaces ----

static scene_world_surface* find_surface( binding_world* w, int body, wisp_error* error )
{
    if ( !find_body( w, body, error ) )
    {
        return NULL;
    }
    const int index = body - w->scene.strands_count;
    if ( index < 0 || index >= w->scene.surface_count )
    {
        wisp_fail( error, WISP_CONFLICT, "%s: '%s' is no surface, and has no vertices to pin", w->scene.name,
                   scene_world_body( &w->world, body ).name );
        return NULL;
    }
    return &w->world.surfaces[index];
}

// Keyframes of the scene place their pins in every step.
static wisp_status check_keyframes( const binding_world* w, int body, const scene_world_surface* s,
                                    const int32_t* vertices, int count, wisp_error* error )
{
    const wisp_scene_surface* entry = &w->scene.surfaces[body - w->scene.strands_count];
    for ( int i = 0; i < count; ++i )
    {
        const int group = scene_pins_holding( s, vertices[i] );
        if ( group >= 0 && ( s->groups[group].starts != NULL || entry->has_animation ) )
        {
            return wisp_fail( error, WISP_CONFLICT, "%s: vertex %d of '%s' follows the keyframes of its pins",
                              w->scene.name, vertices[i], entry->name );
        }
    }
    return WISP_OK;
}

wisp_status binding_pin( binding_world* w, int body, const int32_t* vertices, int count, wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    return s ? fail_with_message( w, wisp_pin( w->world.world, s->entity, vertices, count ), error ) : error->status;
}

wisp_status binding_unpin( binding_world* w, int body, const int32_t* vertices, int count, wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    wisp_status status = s ? check_keyframes( w, body, s, vertices, count, error ) : error->status;
    return status == WISP_OK ? fail_with_message( w, wisp_unpin( w->world.world, s->entity, vertices, count ), error )
                             : status;
}

wisp_status binding_move_pins( binding_world* w, int body, const int32_t* vertices, const float* targets, int count,
                               wisp_error* error )
{
    const scene_world_surface* s = find_surface( w, body, error );
    wisp_status status = s ? check_keyframes( w, body, s, vertices, count, error ) : error->status;
    const wisp_vec3* places = (const wisp_vec3*)(const void*)targets;
    return status == WISP_OK
               ? fail_with_message( w, wisp_move_pins( w->world.world, s->entity, vertices, places, count ), error )
               : status;
}

// ---- colliders, gravity, wind ----

wisp_status binding_move_collider( binding_world* w, int body, float x, float y, float z, wisp_error* error )
{
    return scene_world_move_collider( &w->world, body, ( wisp_vec3 ){ x, y, z }, error );
}

wisp_status binding_collider_place( const binding_world* w, int body, float* out, wisp_error* error )
{
    const int index = body - scene_world_moving_count( &w->world );
    if ( index < 0 || body >= scene_world_body_count( &w->world ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: body %d is no collider", w->scene.name, body );
    }
    const wisp_vec3 at = w->world.colliders[index].pose.translation;
    out[0] = at.x;
    out[1] = at.y;
    out[2] = at.z;
    return WISP_OK;
}

wisp_status binding_set_gravity( binding_world* w, float x, float y, float z, wisp_error* error )
{
    return scene_world_set_gravity( &w->world, ( wisp_vec3 ){ x, y, z }, error );
}

wisp_status binding_set_wind( binding_world* w, float x, float y, float z, int* felt, wisp_error* error )
{
    return scene_world_set_wind( &w->world, ( wisp_vec3 ){ x, y, z }, felt, error );
}

// ---- frozen hair under a brush ----

// Parameters of frozen hair that commands change, and which of the scene's lists of one value per strand are in use.
typedef struct hair_state
{
    float intensity, reach, stretch_stiffness, bend_stiffness, clump_radius;
    int32_t lists; // or-ed: 1 intensity, 2 stretch stiffness, 4 bend stiffness
} hair_state;

// Frozen hair under a brush: parameters, commands, and the stiffness that a climate gives.

static wisp_scene_strands* frozen( binding_world* w, int body, wisp_error* error )
{
    if ( body < 0 || body >= w->scene.strands_count || !w->scene.strands[body].has_frozen_hair )
    {
        wisp_fail( error, WISP_CONFLICT, "%s: body %d has no frozen hair", w->scene.name, body );
        return NULL;
    }
    return &w->scene.strands[body];
}

bool binding_hair_is_frozen( const binding_world* w, int body )
{
    return body >= 0 && body < w->scene.strands_count && w->scene.strands[body].has_frozen_hair;
}

// What the scene's own events have changed so far. They carry what they leave unchanged.
static void follow_events( binding_world* w, int body )
{
    for ( int k = 0; k < w->world.next_command && !w->is_combed; ++k )
    {
        const wisp_scene_hair_event* e = &w->scene.commands[k];
        if ( e->strands == body )
        {
            scene_hair_event_apply( e, &w->scene.strands[body].frozen_hair );
        }
    }
}

// As they are now; without frozen hair those of the scene.
static hair_state state_of_hair( const binding_world* w, int body )
{
    const wisp_frozen_hair_def* def = &w->scene.strands[body].frozen_hair;
    return ( hair_state ){ def->intensity,
                           def->reach,
                           def->stretch_stiffness,
                           def->bend_stiffness,
                           def->clump_radius,
                           ( def->strand_intensity ? 1 : 0 ) | ( def->strand_stretch_stiffness ? 2 : 0 ) |
                               ( def->strand_bend_stiffness ? 4 : 0 ) };
}

static void restore_hair( binding_world* w, int body, hair_state hair )
{
    wisp_frozen_hair_def* def = &w->scene.strands[body].frozen_hair;
    def->intensity = hair.intensity;
    def->reach = hair.reach;
    def->stretch_stiffness = hair.stretch_stiffness;
    def->bend_stiffness = hair.bend_stiffness;
    def->clump_radius = hair.clump_radius;
    def->strand_intensity = hair.lists & 1 ? w->hair[body].strand_intensity : NULL;
    def->strand_stretch_stiffness = hair.lists & 2 ? w->hair[body].strand_stretch_stiffness : NULL;
    def->strand_bend_stiffness = hair.lists & 4 ? w->hair[body].strand_bend_stiffness : NULL;
}

wisp_status binding_hair_read( binding_world* w, int body, binding_hair* out, wisp_error* error )
{
    *out = ( binding_hair ){ 0 };
    const wisp_scene_strands* entry = frozen( w, body, error );
    if ( !entry )
    {
        return error->status;
    }
    follow_events( w, body );
    const wisp_frozen_hair_def* def = &entry->frozen_hair;
    *out = ( binding_hair ){ .intensity = def->intensity,
                             .reach = def->reach,
                             .stretch_stiffness = def->stretch_stiffness,
                             .bend_stiffness = def->bend_stiffness,
                             .clump_radius = def->clump_radius,
                             .freezes = def->freeze,
                             .aligns = def->align,
                             .clumps = def->clump,
                             .temperature_celsius = entry->environment.temperature_celsius,
                             .wetness = entry->environment.wetness };
    return WISP_OK;
}

wisp_status binding_hair_set( binding_world* w, int body, const binding_hair* hair, wisp_error* error )
{
    wisp_scene_strands* entry = frozen( w, body, error );
    if ( !entry )
    {
        return error->status;
    }
    follow_events( w, body );
    wisp_frozen_hair_def def = entry->frozen_hair;
    def.strand_intensity = def.intensity == hair->intensity ? def.strand_intensity : NULL;
    def.strand_stretch_stiffness =
        def.stretch_stiffness == hair->stretch_stiffness ? def.strand_stretch_stiffness : NULL;
    def.strand_bend_stiffness = def.bend_stiffness == hair->bend_stiffness ? def.strand_bend_stiffness : NULL;
    def.intensity = hair->intensity;
    def.reach = hair->reach;
    def.stretch_stiffness = hair->stretch_stiffness;
    def.bend_stiffness = hair->bend_stiffness;
    def.clump_radius = hair->clump_radius;
    const wisp_status status = wisp_set_frozen_hair( w->world.world, w->world.entities[body], &def );
    if ( status == WISP_OK )
    {
        entry->frozen_hair = def;
    }
    return fail_with_message( w, status, error );
}

wisp_status binding_hair_command( binding_world* w, int body, float x, float y, float z, wisp_error* error )
{
    if ( !frozen( w, body, error ) )
    {
        return error->status;
    }
    follow_events( w, body );
    w->is_combed = true;
    w->world.next_command = w->scene.command_count;
    const wisp_entity strands = w->world.entities[body];
    return fail_with_message( w, wisp_command_frozen_hair( w->world.world, strands, ( wisp_vec3 ){ x, y, z } ),
                              error );
}

wisp_status binding_hair_begin_stroke( binding_world* w, int body, wisp_error* error )
{
    return frozen( w, body, error )
               ? fail_with_message( w, wisp_begin_frozen_hair_stroke( w->world.world, w->world.entities[body] ),
                                    error )
               : error->status;
}

wisp_status binding_hair_climate_stiffness( binding_world* w, int body, float temperature, float wetness, double* out,
                                            wisp_error* error )
{
    const wisp_scene_strands* entry = frozen( w, body, error );
    *out = entry ? (double)wisp_environment_stiffness( &entry->environment, temperature, wetness ) : 0.0;
    return entry ? WISP_OK : error->status;
}

// ---- snapshots ----

// Snapshots: where the scene stands, the parameters of strands, which pins are held, places of colliders, and the bytes of
// the world behind them.

typedef struct snapshot_place
{
    int32_t next_step, next_command, next_event, is_combed;
} snapshot_place;

static size_t front_size( const binding_world* w )
{
    return sizeof( snapshot_place ) + (size_t)w->scene.strands_count * sizeof( hair_state ) +
           scene_pins_state_size( &w->world ) + (size_t)w->scene.collider_count * sizeof( wisp_transform );
}

static char* put_bytes( char* at, const void* from, size_t size )
{
    memcpy( at, from, size );
    return at + size;
}

static const char* take_bytes( const char* at, void* to, size_t size )
{
    memcpy( to, at, size );
    return at + size;
}

// Columns that only steps fill exist once the plan is compiled. A snapshot of the start has them, so that it fits later.
static wisp_status compile( const binding_world* w, wisp_error* error )
{
    return wisp_world_plan_passes( w->world.world ) >= 0 ? WISP_OK : fail_with_message( w, WISP_CONFLICT, error );
}

wisp_status binding_snapshot_prepare( binding_world* w, size_t* size, wisp_error* error )
{
    const wisp_status status = compile( w, error );
    *size = status == WISP_OK ? front_size( w ) + wisp_world_snapshot_size( w->world.world ) : 0;
    return status;
}

wisp_status binding_snapshot( const binding_world* w, void* out, size_t size, wisp_error* error )
{
    const size_t front = front_size( w ), expected = front + wisp_world_snapshot_size( w->world.world );
    if ( size < expected )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got room for %zu bytes, expected %zu", w->scene.name, size,
                          expected );
    }
    const snapshot_place place = { w->world.next_step, w->world.next_command, w->world.next_event, w->is_combed };
    char* at = put_bytes( out, &place, sizeof place );
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        const hair_state hair = state_of_hair( w, i );
        at = put_bytes( at, &hair, sizeof hair );
    }
    scene_pins_save( &w->world, at );
    at += scene_pins_state_size( &w->world );
    for ( int i = 0; i < w->scene.collider_count; ++i )
    {
        at = put_bytes( at, &w->world.colliders[i].pose, sizeof( wisp_transform ) );
    }
    return fail_with_message( w, wisp_world_snapshot( w->world.world, at, size - front ), error );
}

static bool is_place( const binding_world* w, const snapshot_place* place )
{
    return place->next_step >= 0 && place->next_command >= 0 && place->next_command <= w->scene.command_count &&
           place->next_event >= 0 && place->next_event <= w->scene.event_count;
}

wisp_status binding_restore( binding_world* w, const void* bytes, size_t size, wisp_error* error )
{
    const size_t front = front_size( w );
    snapshot_place place = { .next_step = -1 };
    if ( size >= front )
    {
        memcpy( &place, bytes, sizeof place );
    }
    if ( !is_place( w, &place ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got %zu bytes, which are no snapshot of this world",
                          w->scene.name, size );
    }
    WISP_TRY( compile( w, error ) );
    wisp_status status = wisp_world_restore( w->world.world, (const char*)bytes + front, size - front );
    if ( status != WISP_OK )
    {
        return fail_with_message( w, status, error );
    }
    const char* at = (const char*)bytes + sizeof place;
    for ( int i = 0; i < w->scene.strands_count; ++i )
    {
        hair_state hair;
        at = take_bytes( at, &hair, sizeof hair );
        restore_hair( w, i, hair );
    }
    scene_pins_load( &w->world, at );
    at += scene_pins_state_size( &w->world );
    for ( int i = 0; i < w->scene.collider_count; ++i )
    {
        at = take_bytes( at, &w->world.colliders[i].pose,
                         sizeof( wisp_transform ) ); // the world's bytes have moved the collider itself
    }
    w->world.next_step = place.next_step;
    w->world.next_command = place.next_command;
    w->world.next_event = place.next_event;
    w->is_combed = place.is_combed != 0;
    w->is_between = false;
    return WISP_OK;
}
