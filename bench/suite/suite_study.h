/// A suite as a scene of the driver of `accuracy`: its rows are the settings.
#pragma once

#include "accuracy/accuracy.h"
#include "suite.h"

/// Make or read the reference, if the suite has one, and the settings.
/// @param suite must outlive the scene
wisp_status suite_study_make( const wisp_suite* suite, const bench_options* options, accuracy_scene* out,
                              wisp_error* error );
