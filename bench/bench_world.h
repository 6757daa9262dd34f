/// Shared by all worlds of the benchmark: steps, hashes and points of an entity, and failures with the world's
/// message.
#pragma once

#include "wisp/module/module.h"

/// Settings of a world that cases vary.
typedef struct bench_world_def
{
    const wisp_module* const* modules;               ///< [module_count]
    int module_count, workers, substeps, iterations; ///< 0: one worker, one substep, one iteration
} bench_world_def;

wisp_status bench_world_create( const bench_world_def* def, wisp_world** out, wisp_error* error );
/// Fail with the last message of a world. @return the status
wisp_status bench_world_fail( const wisp_world* world, wisp_status status, wisp_error* error );
/// Make a step. @param steps counts it @param halted_at is set to the step that halts the entity, if it is 0
wisp_status bench_world_step( wisp_world* world, wisp_entity entity, float seconds, int* steps, int* halted_at,
                              wisp_error* error );
/// Hash a component in the user's order.
wisp_status bench_world_hash( wisp_world* world, wisp_entity entity, wisp_component component, uint64_t* hash,
                              wisp_error* error );
/// Read points in the user's order, valid until the next step. @param count expected number
wisp_status bench_world_points( wisp_world* world, wisp_entity entity, wisp_component component, int count,
                                const wisp_vec3** points, wisp_error* error );
