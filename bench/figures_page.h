/// The page of the case `figures`: what experiments share, and its rows.
#pragma once

#include "balloon_scene.h"
#include "results.h"

/// What the experiments share.
typedef struct figures_case
{
    results* out;
    int table;
    const char* pictures; ///< folder, or null
    bool quick;           ///< fewer and shorter runs
    wisp_mesh figure;     ///< an asymmetric closed body
    const char* figure_name;
} figures_case;

/// A row of the page. A check that is not met fails the run.
/// @param format what was measured
void figures_add( figures_case* page, const char* id, const char* experiment, const char* expected, bool meets_target,
                  const char* format, ... ) __attribute__( ( format( printf, 6, 7 ) ) );
