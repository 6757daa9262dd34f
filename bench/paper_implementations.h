/// The scene of Table 1 on the engine, with the double oracle as the reference.
#pragma once

#include "bench_world.h"
#include "stats.h"

#include "frozen_hair/frozen_hair.h"
#include "groom.h"

/// A flat wavy groom at a fixed density of strands, and the parameters of the command.
typedef struct paper_scene
{
    wisp_groom groom;
    wisp_frozen_hair_def def;
    double extent; ///< m, the farthest coordinate: float rounding grows with it
} paper_scene;

wisp_status paper_scene_make( int strand_count, paper_scene* out, wisp_error* error );
void paper_scene_free( paper_scene* scene );

/// The engine on the scene.
typedef struct paper_world
{
    const paper_scene* scene;
    wisp_world* world;
    wisp_entity hair;
    profile_samples profile; ///< of the timed steps
} paper_world;

wisp_status paper_world_create( const paper_scene* scene, int workers, paper_world* out, wisp_error* error );
/// One command and one step; points are in the user's order because they are requested.
wisp_status paper_world_step( void* context, wisp_error* error );
/// Keep the last step's profile.
wisp_status paper_world_after( void* context );
/// Run a given event. @param points receives [vertex_count], owned by the world, valid until its next step
wisp_status paper_world_replay( paper_world* world, uint64_t event, const wisp_vec3** points, uint64_t* hash,
                                wisp_error* error );
void paper_world_destroy( paper_world* world );

/// The scene in double precision, by brute force. @param out [vertex_count][3]
wisp_status paper_oracle_run( const paper_scene* scene, uint64_t event, double* out, wisp_error* error );
