/// Rows of entities that can sleep.
#pragma once

#include "wisp/module/module.h"

/// A row of the component "sleep.state".
typedef struct passes_sleep
{
    uint64_t rows;              // hash of the entity's own rows when it fell asleep
    uint64_t surroundings;      // hash of what was around it
    float lower[3], upper[3];   // m, its bounds there
    float max_speed, seconds;   // of the definition
    float still;                // s for which no vertex was faster
    uint16_t phase, is_touched; // store_sleep, and store_entity.is_touched when a snapshot was taken
} passes_sleep;

typedef struct passes_sleep_components
{
    wisp_component state;              // passes_sleep
    wisp_component particles, strands; // positions at the end of the step before
    wisp_component moved;              // what the passes write: the largest displacement of a step, m
} passes_sleep_components;

/// Declare the components and the passes, behind those of all modules: states are checked first.
/// @param out receives the components; must live as long as the registry
wisp_status passes_declare_sleep( wisp_registry* registry, passes_sleep_components* out );
