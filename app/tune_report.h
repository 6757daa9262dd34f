/// The result of tuning, as results: a row and a line per setting, the reference, the verdict.
#pragma once

#include "results.h"
#include "tune_scene.h"

/// @param found its visits are sorted by time
void tune_report( results* out, const tune_scene_def* def, const tune_scene_info* info, wisp_tune_result* found );
