/// The smallest scene of every effect: its entity, the effect itself, and commands of the host before a step so that
/// the effect has work in each. All of them can be in one world without touching each other.
#pragma once

#include "wisp/module/module.h"

#define EFFECT_STEP ( 1.0f / 60.0f ) ///< s
#define EFFECT_SUBSTEPS 4
#define EFFECT_ENTITIES_MAX 2

/// How large the entities are.
typedef struct effect_size
{
    int side;    ///< vertices of a cloth's side
    int level;   ///< of a sphere: 10 * 4^level + 2 vertices
    int strands; ///< of 20 vertices
} effect_size;

typedef struct effect_scene effect_scene;
typedef struct effect_parts effect_parts;

/// A module and its scene; one for each row of app/world/modules.inc, in its order.
typedef struct effect
{
    const char* name; ///< of the module
    const wisp_module* module;
    const effect_parts* parts;
} effect;

const effect* effects_all( int* count );
/// @return null if there is none
const effect* effects_find( const char* name );

/// The entities of one effect in a world.
struct effect_scene
{
    const effect* effect;
    bool is_on; ///< false: the entity alone, without the effect
    wisp_entity entities[EFFECT_ENTITIES_MAX];
    wisp_component shown[EFFECT_ENTITIES_MAX]; ///< points, in the user's order
    int entity_count;
};

/// The modules of a world.
typedef enum effect_registry
{
    EFFECT_EVERY, ///< all modules
    EFFECT_USED,  ///< those that run in its scene; without its effect, the remaining ones
} effect_registry;

#define EFFECT_MODULES_MAX 32

/// The modules of a world for these effects. @param modules [EFFECT_MODULES_MAX] @return their number
int effects_modules( const effect* const* effects, int count, bool is_on, effect_registry registry,
                     const wisp_module** modules );

/// Add the entity of the effect and, if it is on, the effect.
wisp_status effect_scene_add( const effect* which, const effect_size* size, bool is_on, wisp_world* world,
                              effect_scene* out, wisp_error* error );
/// Commands of the host before a step. @param step from 0
wisp_status effect_scene_tell( const effect_scene* scene, wisp_world* world, int step );
/// Of all visible points. @return WISP_CONFLICT before the first step
wisp_status effect_scene_hash( const effect_scene* scene, wisp_world* world, uint64_t* hash );
/// Vertices of the scene, after a step.
int effect_scene_vertices( const effect_scene* scene, wisp_world* world );
