/// Suites: those of a case, what is sampled of their rows, and a suite as a scene of the driver of `accuracy`.
#pragma once

#include "accuracy/accuracy.h"
#include "bench.h"
#include "results.h"
#include "suite.h"
#include "suite_measure.h"

// ---- suites of a case ----

/// Run suites of a folder by their names, without extension.
/// @param folder in data/suites @param seconds for all of them together
wisp_status suite_bench_names( const char* folder, const char* const* names, int count, double seconds,
                               const bench_options* options, results* out, wisp_error* error );
/// Run all suites of a folder, in the order of their names.
/// @return WISP_IO_ERROR the folder cannot be read
wisp_status suite_bench_folder( const char* folder, double seconds, const bench_options* options, results* out,
                                wisp_error* error );

// ---- a scene of accuracy ----

/// Make or read the reference, if the suite has one, and the settings.
/// @param suite must outlive the scene
wisp_status suite_study_make( const wisp_suite* suite, const bench_options* options, accuracy_scene* out,
                              wisp_error* error );
