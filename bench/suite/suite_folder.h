/// The suites of a case, which are files in data/suites.
#pragma once

#include "bench_options.h"
#include "results.h"

/// Run suites of a folder by their names, without extension.
/// @param folder in data/suites @param seconds for all of them together
wisp_status suite_bench_names( const char* folder, const char* const* names, int count, double seconds,
                               const bench_options* options, results* out, wisp_error* error );
/// Run all suites of a folder, in the order of their names.
/// @return WISP_IO_ERROR the folder cannot be read
wisp_status suite_bench_folder( const char* folder, double seconds, const bench_options* options, results* out,
                                wisp_error* error );
