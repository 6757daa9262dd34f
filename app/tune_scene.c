#include "tune_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define OBSERVATIONS 12
#define SECONDS_MAX 2.0
#define TUNE_STEPS_MAX 1000000

/// One world at a time.
typedef struct host
{
    const tune_scene_def* def;
    tune_scene_info* info;
    scene_world_options options;
    scene_world world;
    wisp_tune_points* points; // [points of the scene]
    bool is_reference;        // the world is that of the reference run
} host;

// ---- worlds ----

// Bodies that move by themselves; a follower would count the same error twice.
static int list_points( host* h )
{
    const wisp_scene* scene = h->def->scene;
    int count = 0;
    for ( int i = 0; i < scene->strands_count; ++i )
    {
        if ( scene->strands[i].has_dynamics )
        {
            h->points[count++] = ( wisp_tune_points ){ h->world.entities[i], WISP_STRAND_POINTS };
        }
    }
    for ( int i = 0; i < scene->surface_count; ++i )
    {
        h->points[count++] = ( wisp_tune_points ){ h->world.surfaces[i].entity, WISP_SURFACE_POINTS };
    }
    return count;
}

static void take_info( host* h )
{
    tune_scene_info* info = h->info;
    const wisp_scene* scene = h->def->scene;
    info->points = 0;
    for ( int i = 0; i < scene_world_moving_count( &h->world ); ++i )
    {
        if ( i >= scene->strands_count || scene->strands[i].has_dynamics )
        {
            info->points += scene_world_body( &h->world, i ).vertex_count;
        }
    }
    info->workers = wisp_world_workers( h->world.world );
    snprintf( info->isa, sizeof info->isa, "%s", wisp_world_isa( h->world.world ) );
}

static wisp_status build( void* user, const int* configuration, int substep_factor, wisp_tune_world* out,
                          wisp_error* error )
{
    host* h = user;
    wisp_scene* scene = h->def->scene;
    tune_parameters_set( h->def->parameters, configuration, scene );
    h->is_reference = substep_factor > 1;
    wisp_scene_refine( scene, substep_factor );
    wisp_status status = scene_world_create( scene, &h->options, &h->world, error );
    if ( status == WISP_OK )
    {
        h->options.is_quiet = true; // the reference run has printed the warnings
        take_info( h );
        *out = ( wisp_tune_world ){ .world = h->world.world, .points = h->points, .point_count = list_points( h ) };
    }
    return status;
}

static wisp_status step( void* user, wisp_tune_world* world, int number, wisp_error* error )
{
    (void)world;
    host* h = user;
    if ( h->def->go_on && !h->def->go_on( h->def->go_on_user, h->is_reference ) )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: the search was ended in step %d of a run", h->def->scene->name,
                          number );
    }
    return scene_world_step( &h->world, error );
}

static void destroy_world( void* user, wisp_tune_world* world )
{
    (void)world;
    scene_world_destroy( &( (host*)user )->world );
}

// ---- the search ----

static int steps_of( const tune_scene_def* def )
{
    const double dt = (double)def->scene->dt;
    const double whole = def->scene->steps * dt;
    const double requested = def->seconds > 0.0 ? def->seconds
                             : whole > 0.0      ? fmin( whole, SECONDS_MAX )
                                                : SECONDS_MAX;
    const double steps = round( requested / dt );
    return steps < 1.0 ? 1 : steps > TUNE_STEPS_MAX ? TUNE_STEPS_MAX : (int)steps;
}

static wisp_status search( host* h, wisp_tune_result* out, wisp_error* error )
{
    const tune_scene_def* def = h->def;
    wisp_tune_def job = tune_parameters_job( def->parameters, def->error, def->budget_ms, def->limit );
    job.progress = def->progress;
    job.progress_user = def->progress_user;
    wisp_tune_worlds_def worlds = wisp_default_tune_worlds_def();
    worlds.build = build;
    worlds.step = step;
    worlds.destroy = destroy_world;
    worlds.user = h;
    worlds.dt = def->scene->dt;
    worlds.step_count = h->info->steps;
    worlds.sample_count = h->info->steps < OBSERVATIONS ? h->info->steps : OBSERVATIONS;
    worlds.reference_factor = TUNE_REFERENCE_FACTOR;
    return wisp_tune_worlds( &job, &worlds, out, error );
}

wisp_status tune_scene_search( const tune_scene_def* def, wisp_tune_result* out, tune_scene_info* info,
                               wisp_error* error )
{
    *out = ( wisp_tune_result ){ 0 };
    if ( def->scene->dt_factor_count > 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got dt_factors, but tuning needs steps of one length",
                          def->scene->name );
    }
    *info = ( tune_scene_info ){ .steps = steps_of( def ) };
    host h = { .def = def, .info = info, .options = def->world };
    const size_t room = (size_t)def->scene->strands_count + (size_t)def->scene->surface_count;
    h.points = malloc( room * sizeof *h.points + 1 );
    wisp_status status =
        h.points ? search( &h, out, error )
                 : wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for its points", def->scene->name );
    free( h.points );
    return status;
}
