/// Rows of entities that can sleep.
#pragma once

#include "wisp/module/module.h"

enum
{
    PASSES_TOUCHED = 3, // more than any store_sleep
};

/// A row of the component "sleep.state".
typedef struct passes_sleep
{
    uint64_t rows;            // hash of the entity's own rows when it fell asleep
    uint64_t surroundings;    // hash of what was around it
    float lower[3], upper[3]; // m, its bounds there
    float max_speed, seconds; // of the definition
    float still;              // s for which no vertex was faster
    int32_t phase;            // store_sleep; in a snapshot PASSES_TOUCHED more if store_entity.is_touched
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
