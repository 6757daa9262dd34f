// What sleep has to know of bodies.
#pragma once

#include "collision_state.h"

#include "wisp/module/sleep.h"

/// As wisp_sleep_hooks.surroundings: the bodies within reach of an entity's bounds.
bool collision_surroundings( const void* state, wisp_world* world, wisp_entity entity,
                             const wisp_sleep_bounds* bounds, uint64_t* hash );
