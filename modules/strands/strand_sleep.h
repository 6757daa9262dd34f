// What sleep has to know of strands.
#pragma once

#include "strands_state.h"

#include "wisp/module/sleep.h"

/// As wisp_sleep_hooks.surroundings: the surface that strands are rooted in has to sleep.
bool strands_surroundings( const void* state, wisp_world* world, wisp_entity entity, const wisp_sleep_bounds* bounds,
                           uint64_t* hash );
/// As wisp_sleep_hooks.rested: strands forget how they moved.
void strands_rested( const void* state, wisp_world* world, wisp_entity entity );
