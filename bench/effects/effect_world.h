/// The smallest scene of every effect, from data/suites/effects.yaml, and worlds of some of them on one worker, for measurements and
/// comparisons. All can be in one world without touching each other.
#pragma once

#include "suite.h"
#include "world_from_scene.h"

#define EFFECT_SCENES_MAX SCENE_MAX_MODULES
#define EFFECT_PLAN_MAX 4096

/// Every module of modules.inc in its order, each with the row of its scene and the row without the effect.
typedef struct effects
{
    wisp_suite suite; ///< rows 2 i and 2 i + 1
    int count;
} effects;

/// @param out to be released, after a failure too
/// @return WISP_BAD_INPUT a module has no scene in the suite (the message names it)
wisp_status effects_read( effects* out, wisp_error* error );
void effects_release( effects* all );
const char* effects_name( const effects* all, int effect );
/// @return -1 if there is none
int effects_find( const effects* all, const char* name );

/// How large the bodies are.
typedef struct effect_size
{
    int side;    ///< vertices of a cloth's side
    int level;   ///< of a sphere: 10 * 4^level + 2 vertices
    int strands; ///< of 20 vertices; an eighth of them as guides
} effect_size;

typedef struct effect_world_def
{
    const effects* all;
    const int* chosen; ///< [count] effects
    int count;
    bool is_on;     ///< false: only their bodies
    bool only_used; ///< register the modules that act, not all
    effect_size size;
    const wisp_allocator* allocator; ///< null: the C library
} effect_world_def;

/// Bodies of one effect, as indices into the scene.
typedef struct effect_part
{
    int first_strands, end_strands, first_surface, end_surface;
} effect_part;

typedef struct effect_world
{
    wisp_scene scene;
    scene_world world;
    effect_part parts[EFFECT_SCENES_MAX]; ///< [part_count] in the order of the definition
    int part_count;
} effect_world;

/// @param out to be closed; null on failure
wisp_status effect_world_open( const effect_world_def* def, effect_world** out, wisp_error* error );
/// Null is allowed.
void effect_world_close( effect_world* world );
/// Give strands of effects that are driven by the host new values, then step. @param context the world, as a bench_variant has it
wisp_status effect_world_step( void* context, wisp_error* error );

/// Bytes apart from those of the registry.
size_t effect_world_bytes( const effect_world* world );
/// Of the points of one part. @return WISP_CONFLICT before the first step
wisp_status effect_world_hash( effect_world* world, int part, uint64_t* hash, wisp_error* error );
/// The passes in plan order, separated by blanks. @param out [EFFECT_PLAN_MAX] @param count receives their number;
/// may be null
wisp_status effect_world_plan( effect_world* world, char* out, int* count, wisp_error* error );
