#include "scene_calls.h"
#include "world_from_scene_parts.h"

#include "create.h"

#include "wisp/module/definition.h"

#include <stdlib.h>
#include <string.h>

// ---- errors that name the scene's line ----

// Errors that name the scene's line.

wisp_status scene_fail_at( const wisp_scene* scene, int line, int column, const char* what, const char* name,
                           wisp_status status, const char* message, wisp_error* error )
{
    return wisp_fail( error, status, "%s:%d:%d: %s '%s': %s", scene->name, line, column, what, name, message );
}

wisp_status scene_fail_at_line( const scene_world* world, int line, int column, wisp_status status,
                                wisp_error* error )
{
    return wisp_fail( error, status, "%s:%d:%d: %s", world->scene->name, line, column,
                      wisp_world_message( world->world ) );
}

// ---- messages ----

void scene_tell( const scene_world* world, wisp_log_level level, const char* message )
{
    if ( world && world->log )
    {
        world->log( world->log_user, level, message );
    }
    else
    {
        fprintf( stderr, "wisp: %s%s\n", level == WISP_LOG_WARNING ? "warning: " : "", message );
    }
}

// An error that ends a call is returned as its status and would be printed twice. An error that a call survives, such
// as an entity restored to its last valid state, must be printed.
static void keep_log( void* user, wisp_log_level level, const char* message )
{
    scene_world* world = user;
    if ( level == WISP_LOG_WARNING )
    {
        scene_note_warning( world, message );
    }
    else if ( level == WISP_LOG_ERROR && !world->is_quiet )
    {
        snprintf( world->late_error, sizeof( world->late_error ), "%s", message );
    }
}

static void print_late_error( scene_world* world )
{
    if ( world->late_error[0] )
    {
        scene_tell( world, WISP_LOG_ERROR, world->late_error );
        world->late_error[0] = '\0';
    }
}

// ---- the world ----

static wisp_status create_world( const scene_world_options* options, scene_world* out, wisp_error* error )
{
    const wisp_scene* scene = out->scene;
    const wisp_module* used[SCENE_MAX_MODULES];
    wisp_world_def def = wisp_default_world_def();
    def.modules = wisp_all_modules( &def.module_count );
    if ( options->only_used_modules )
    {
        def.modules = used;
        def.module_count = scene_world_used_modules( scene, used );
    }
    def.workers = options->workers > 0 ? options->workers : scene->workers;
    def.isa = options->isa;
    def.substeps = scene->substeps;
    def.iterations = scene->iterations;
    def.longest_step = 1000; // the most, so that keyframes and recordings keep to the times of steps
    def.log = keep_log;
    def.log_user = out;
    def.allocator = options->allocator != NULL ? *options->allocator : def.allocator;
    const wisp_status status = wisp_world_create( &def, &out->world, error );
    out->module_count = def.module_count;
    out->empty_bytes = status == WISP_OK ? wisp_world_memory( out->world ) : 0;
    return status;
}

// The search for contacts is a setting of the world, not of a participant.
static wisp_status set_contact( scene_world* out, wisp_error* error )
{
    const wisp_scene* scene = out->scene;
    wisp_status status = scene->has_contact ? wisp_set_contact_settings( out->world, &scene->contact ) : WISP_OK;
    if ( status == WISP_OK && ( scene->request_contact_stats || scene->request_intersections ) )
    {
        status = wisp_request_contact_stats( out->world, true, scene->request_intersections );
    }
    return status == WISP_OK ? WISP_OK
                             : wisp_fail( error, status, "%s: %s", scene->name, wisp_world_message( out->world ) );
}

static wisp_status add_strands( scene_world* out, int strands, wisp_error* error )
{
    wisp_groom* groom = &out->grooms[strands];
    const int source = scene_groom_source( out->scene, strands );
    WISP_TRY( scene_groom_of( out->scene, strands, source >= 0 ? &out->grooms[source] : NULL, groom, error ) );
    wisp_strands_def def = wisp_default_strands_def();
    def.points = groom->points;
    def.offsets = groom->offsets;
    def.strand_count = groom->strand_count;
    def.dimension = groom->dimension;
    wisp_status status = wisp_add_strands( out->world, &def, &out->entities[strands] );
    status = status == WISP_OK ? scene_strands_dress( out, strands ) : status;
    return status == WISP_OK ? WISP_OK
                             : SCENE_FAIL_AT( out->scene, strands, strands, "strands", status,
                                              wisp_world_message( out->world ), error );
}

// All places of a scene are relative to its origin.
static wisp_status place( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    wisp_status status = WISP_OK;
    for ( int i = 0; i < scene_world_moving_count( world ) && status == WISP_OK; ++i )
    {
        status = wisp_set_origin( world->world, scene_world_entity( world, i ), scene->origin );
    }
    for ( int i = 0; i < scene->collider_count && status == WISP_OK; ++i )
    {
        status = wisp_set_origin( world->world, world->colliders[i].entity, scene->origin );
    }
    return status == WISP_OK ? WISP_OK
                             : wisp_fail( error, status, "%s: %s", scene->name, wisp_world_message( world->world ) );
}

wisp_status scene_world_create( const wisp_scene* scene, const scene_world_options* options, scene_world* out,
                                wisp_error* error )
{
    *out = ( scene_world ){ .scene = scene,
                            .last_call = -1,
                            .is_quiet = options->is_quiet,
                            .log = options->log,
                            .log_user = options->log_user };

    const size_t count = (size_t)scene->strands_count;
    out->entities = io_get( &out->memory, count * sizeof *out->entities );
    out->grooms = io_get( &out->memory, count * sizeof *out->grooms );
    wisp_status status = !out->memory.is_short
                             ? create_world( options, out, error )
                             : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its strands", scene->name );
    status = status == WISP_OK ? set_contact( out, error ) : status;
    for ( int i = 0; i < scene->strands_count && status == WISP_OK; ++i )
    {
        status = scene->strands[i].is_curves ? WISP_OK : add_strands( out, i, error );
    }
    status = status == WISP_OK ? scene_surfaces_add( out, error ) : status;
    status = status == WISP_OK ? scene_colliders_add( out, error ) : status;
    status = status == WISP_OK ? scene_seams_add( out, error ) : status;
    status = status == WISP_OK ? scene_motion_set( out, error ) : status;
    status = status == WISP_OK ? place( out, error ) : status;
    if ( status != WISP_OK )
    {
        scene_world_destroy( out );
    }
    else
    {
        scene_find_notes( out );
        print_late_error( out );
    }
    return status;
}

void scene_hair_event_apply( const wisp_scene_hair_event* e, wisp_frozen_hair_def* def )
{
    def->intensity = e->has_intensity ? e->intensity : def->intensity;
    def->strand_intensity = e->has_intensity ? NULL : def->strand_intensity;
    def->reach = e->has_reach ? e->reach : def->reach;
    def->stretch_stiffness = e->has_stretch_stiffness ? e->stretch_stiffness : def->stretch_stiffness;
    def->strand_stretch_stiffness = e->has_stretch_stiffness ? NULL : def->strand_stretch_stiffness;
    def->bend_stiffness = e->has_bend_stiffness ? e->bend_stiffness : def->bend_stiffness;
    def->strand_bend_stiffness = e->has_bend_stiffness ? NULL : def->strand_bend_stiffness;
    def->clump_radius = e->has_clump_radius ? e->clump_radius : def->clump_radius;
}

static wisp_status give_command( scene_world* world, const wisp_scene_hair_event* e )
{
    const wisp_entity strands = world->entities[e->strands];
    wisp_status status = WISP_OK;
    if ( e->changes )
    {
        wisp_frozen_hair_def def = world->scene->strands[e->strands].frozen_hair;
        scene_hair_event_apply( e, &def );
        status = wisp_set_frozen_hair( world->world, strands, &def );
    }
    if ( status == WISP_OK && e->begin_stroke )
    {
        scene_call_begin( world, "wisp_begin_frozen_hair_stroke", strands );
        scene_call_end( world, "" );
        status = wisp_begin_frozen_hair_stroke( world->world, strands );
    }
    return status == WISP_OK && e->has_cursor ? SCENE_CALL( world, wisp_command_frozen_hair, strands, e->cursor )
                                              : status;
}

static wisp_status give_commands( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    while ( world->next_command < scene->command_count &&
            scene->commands[world->next_command].step <= world->next_step )
    {
        const wisp_scene_hair_event* command = &scene->commands[world->next_command++];
        const wisp_status status = give_command( world, command );
        if ( status != WISP_OK )
        {
            return scene_fail_at_line( world, command->line, command->column, status, error );
        }
    }
    return WISP_OK;
}

wisp_status scene_world_step( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    WISP_TRY( give_commands( world, error ) );
    WISP_TRY( scene_events_play( world, error ) );
    wisp_status status = wisp_world_step( world->world, wisp_scene_step_length( scene, world->next_step ) );
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s: step %d: %s", scene->name, world->next_step,
                          wisp_world_message( world->world ) );
    }
    print_late_error( world );
    ++world->next_step;
    return scene_tearing_follow( world, error );
}

// ---- frames of any length ----

typedef struct advance_state
{
    scene_world* world;
    bool is_begun; // a step is being made, or has been made
    wisp_status status;
    wisp_error* error;
} advance_state;

// The step before, if any, is made by now. A step whose events fail cannot be stopped here: it is made without them.
static void before_step( void* user, wisp_world* world )
{
    (void)world;
    advance_state* state = user;
    scene_world* w = state->world;
    w->next_step += state->is_begun;
    state->is_begun = true;
    if ( state->status == WISP_OK )
    {
        state->status = give_commands( w, state->error );
    }
    if ( state->status == WISP_OK )
    {
        state->status = scene_events_play( w, state->error );
    }
}

wisp_status scene_world_advance( scene_world* world, float seconds, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    if ( scene->dt_factor_count > 0 )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: got dt_factors, but advancing needs steps of one length",
                          scene->name );
    }
    advance_state state = { .world = world, .error = error };
    const wisp_status status = wisp_world_advance( world->world, seconds, scene->dt, before_step, &state );
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s: step %d: %s", scene->name, world->next_step,
                          wisp_world_message( world->world ) );
    }
    world->next_step += state.is_begun;
    print_late_error( world );
    return state.status == WISP_OK ? scene_tearing_follow( world, error ) : state.status;
}

// ---- outputs ----

// A column of the world into an array of the groom, which may have to be allocated.
static wisp_status copy_to_groom( scene_world* world, int strands, wisp_component component, size_t size,
                                  void** array )
{
    wisp_view view;
    WISP_TRY( wisp_world_view( world->world, world->entities[strands], component, &view ) );
    if ( !*array )
    {
        *array = malloc( (size_t)view.count * size + 1 );
    }
    if ( !*array )
    {
        return WISP_NO_MEMORY;
    }
    for ( int i = 0; i < view.count; ++i )
    {
        memcpy( (char*)*array + (size_t)i * size, (const char*)view.data + (size_t)i * view.stride, size );
    }
    return WISP_OK;
}

static wisp_status copy_shape( scene_world* world, int strands )
{
    const wisp_scene_strands* entry = &world->scene->strands[strands];
    wisp_groom* groom = &world->grooms[strands];
    void* points = groom->points;
    void* thickness = groom->thickness;
    void* colour = groom->colour;
    wisp_status status = copy_to_groom( world, strands, WISP_STRAND_POINTS, sizeof( wisp_vec3 ), &points );
    if ( status == WISP_OK && entry->request_width )
    {
        status = copy_to_groom( world, strands, WISP_POINT_WIDTH, sizeof( float ), &thickness );
    }
    if ( status == WISP_OK && entry->request_colour )
    {
        status = copy_to_groom( world, strands, WISP_POINT_COLOUR, sizeof( wisp_vec3 ), &colour );
    }
    groom->points = points;
    groom->thickness = thickness;
    groom->colour = colour;
    return status;
}

// Files of a single shape hold places in the world. @param out [count], may be `points`
static void put_in_world( const wisp_scene* scene, const wisp_vec3* points, int count, wisp_vec3* out )
{
    const double* o = scene->origin;
    for ( int i = 0; i < count; ++i )
    {
        const wisp_vec3 p = points[i];
        out[i] = ( wisp_vec3 ){ (float)( (double)p.x + o[0] ), (float)( (double)p.y + o[1] ),
                                (float)( (double)p.z + o[2] ) };
    }
}

static wisp_status write_groom( const scene_world* world, const wisp_scene_output* output, wisp_error* error )
{
    wisp_groom groom = world->grooms[output->strands];
    wisp_vec3* points = malloc( (size_t)groom.vertex_count * sizeof *points + 1 );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to write it" );
    }
    put_in_world( world->scene, groom.points, groom.vertex_count, points );
    groom.points = points;
    const wisp_status status = wisp_groom_write( output->file, &groom, error );
    free( points );
    return status;
}

static wisp_status write_strands( scene_world* world, const wisp_scene_output* output, wisp_error* error )
{
    // Before the first step no pass has written anything, and only the rest shape exists.
    wisp_status status = world->next_step > 0 ? copy_shape( world, output->strands ) : WISP_OK;
    if ( status != WISP_OK )
    {
        return wisp_fail( error, status, "%s",
                          status == WISP_NO_MEMORY ? "out of memory to write it"
                                                   : wisp_world_message( world->world ) );
    }
    return write_groom( world, output, error );
}

static wisp_status write_surface( scene_world* world, const wisp_scene_output* output, wisp_error* error )
{
    const int body_number = world->scene->strands_count + output->surface;
    const scene_body body = scene_world_body( world, body_number );
    wisp_vec3* points = malloc( (size_t)body.vertex_count * sizeof *points + 1 );
    if ( !points )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to write it" );
    }
    wisp_status status = scene_world_points( world, body_number, points, error );
    if ( status == WISP_OK )
    {
        put_in_world( world->scene, points, body.vertex_count, points );
        // The writer changes neither mesh; there is no read-only type.
        const wisp_mesh mesh = { .points = points,
                                 .triangles = (int32_t*)(uintptr_t)body.triangles,
                                 .vertex_count = body.vertex_count,
                                 .triangle_count = body.triangle_count };
        status = wisp_mesh_write( output->file, &mesh, error );
    }
    free( points );
    return status;
}

wisp_status scene_world_write_outputs( scene_world* world, wisp_error* error )
{
    const wisp_scene* scene = world->scene;
    for ( int i = 0; i < scene->output_count; ++i )
    {
        const wisp_scene_output* output = &scene->outputs[i];
        wisp_error cause = { 0 };
        wisp_status status =
            output->strands >= 0 ? write_strands( world, output, &cause ) : write_surface( world, output, &cause );
        if ( status != WISP_OK )
        {
            return wisp_fail( error, status, "%s:%d:%d: %s", scene->name, output->line, output->column,
                              cause.message );
        }
    }
    return WISP_OK;
}

// ---- counts ----

int scene_world_vertices( const scene_world* world )
{
    int sum = 0;
    for ( int i = 0; i < world->scene->strands_count; ++i )
    {
        sum += world->grooms[i].vertex_count;
    }
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        sum += world->surfaces[i].mesh.vertex_count;
    }
    return sum;
}

int scene_world_strands( const scene_world* world )
{
    int sum = 0;
    for ( int i = 0; i < world->scene->strands_count; ++i )
    {
        sum += world->grooms[i].strand_count;
    }
    return sum;
}

size_t scene_world_bytes( const scene_world* world )
{
    size_t sum = wisp_world_memory( world->world );
    for ( int i = 0; i < world->scene->surface_count; ++i )
    {
        sum += world->scene->surfaces[i].instance_of < 0 ? wisp_fabric_bytes( world->surfaces[i].fabric ) : 0;
    }
    return sum;
}

void scene_world_destroy( scene_world* world )
{
    wisp_world_destroy( world->world );
    for ( int i = 0; world->grooms && i < world->scene->strands_count; ++i )
    {
        wisp_groom_release( &world->grooms[i] );
    }
    scene_surfaces_release( world );
    io_release( &world->memory );
    free( world->notes );
    *world = ( scene_world ){ 0 };
}
