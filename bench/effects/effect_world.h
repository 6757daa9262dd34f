/// A world with the scenes of some effects, on one worker, for measurements and comparisons.
#pragma once

#include "effects/effect_scene.h"

#define EFFECT_SCENES_MAX EFFECT_MODULES_MAX
#define EFFECT_PLAN_MAX 4096

typedef struct effect_world_def
{
    const effect* const* effects; ///< [count]
    int count;
    bool is_on; ///< false: only their entities
    effect_registry registry;
    effect_size size;
    wisp_allocator allocator; ///< zero: the C library
} effect_world_def;

typedef struct effect_world
{
    wisp_world* world;
    effect_scene scenes[EFFECT_SCENES_MAX]; ///< [scene_count]
    int scene_count;
    int steps;
    int module_count;
    size_t registry_bytes; ///< of the empty world: modules' states and workspaces, and the world itself
} effect_world;

/// @param out to be closed; zero on failure
wisp_status effect_world_open( const effect_world_def* def, effect_world* out, wisp_error* error );
void effect_world_close( effect_world* world );
/// Run the commands of the effects, then step. @param context the world, as a bench_variant has it
wisp_status effect_world_step( void* context, wisp_error* error );

/// Bytes apart from those of the registry.
size_t effect_world_bytes( const effect_world* world );
/// Of the points of one scene.
wisp_status effect_world_hash( effect_world* world, int scene, uint64_t* hash, wisp_error* error );
/// The passes in plan order, separated by blanks. @param out [EFFECT_PLAN_MAX] @param count receives their number;
/// may be null
wisp_status effect_world_plan( effect_world* world, char* out, int* count, wisp_error* error );
