/// Ways to solve strands.
#pragma once

#include "strands_scene.h"

typedef struct strands_setting
{
    const char* name;
    wisp_strand_stretch stretch;
    wisp_strand_bend bend;
    int passes; ///< Newton passes of the direct stretch
    int substeps;
} strands_setting;

/// Dynamics of a setting in the scene of the race.
wisp_strand_dynamics_def strands_setting_dynamics( const strands_setting* setting );

/// m/N of bends by distances: at ten substeps about a fifth of the error is taken away, as the stiffness 0.2 of the
/// other engines does; being a compliance it stays the same material at other substeps.
#define STRANDS_BEND_COMPLIANCE 68.0f

// ---- the comparison ----

extern const strands_setting strands_comparison_settings[];
extern const int strands_comparison_setting_count;
