/// From a scene, which is data, to a world that runs: grooms read or made, effects attached, wishes and commands.
#pragma once

#include "groom.h"
#include "scene.h"
#include "wisp/wisp.h"

/// What the command line says over the scene.
typedef struct scene_world_options
{
    int workers;     ///< 0: as the scene says
    const char* isa; ///< null: the best there is
} scene_world_options;

typedef struct scene_world
{
    const wisp_scene* scene; ///< must outlive this
    wisp_world* world;
    wisp_entity* entities; ///< [strands_count]
    wisp_groom* grooms;    ///< [strands_count] the rest shape; an output's shape once outputs were written
    int next_step;
    int next_command;
    char late_error[500]; ///< logged as an error by a call that went on; printed once the call is over
} scene_world;

/// Every module of modules.inc, in its order.
const wisp_module* const* scene_world_modules( int* count );

/// @param out zero on failure
/// @return what went wrong; the sentence names the scene's line if the cause is there
wisp_status scene_world_create( const wisp_scene* scene, const scene_world_options* options, scene_world* out,
                                wisp_error* error );

/// The commands of the next step, then the step.
wisp_status scene_world_step( scene_world* world, wisp_error* error );

/// Write the files that the scene asks for, with width and colour where they are wanted.
wisp_status scene_world_write_outputs( scene_world* world, wisp_error* error );

/// A groom of the scene, read or made, and checked against what the scene says about it.
/// @param out to be released; empty on failure
wisp_status scene_groom( const wisp_scene* scene, int strands, wisp_groom* out, wisp_error* error );

int scene_world_vertices( const scene_world* world );
int scene_world_strands( const scene_world* world );

void scene_world_destroy( scene_world* world );
