/// Rows of entities whose level of detail was set, and what they do where nothing is solved.
#pragma once

#include "wisp/module/detail.h"
#include "wisp/module/module.h"

/// A row of the component "detail.state".
typedef struct passes_detail
{
    int32_t level, active, from; // that was set, at which the last step ran, and before the last change
    int32_t divisor, blend_steps;
    int32_t elapsed;               // steps since the last change, at most blend_steps
    int32_t substeps, of_substeps; // in a step of usual length, now and at the last change; 0: as many as it asks for
} passes_detail;

/// Declare the component and the passes.
/// @param out receives the component; must live as long as the registry
wisp_status passes_declare_detail( wisp_registry* registry, wisp_component* out );
