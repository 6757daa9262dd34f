/// Shared by the commands that measure.
#pragma once

#include "bench.h"
#include "options.h"
#include "report.h"
#include "results.h"
#include "wisp/base.h"

/// What a command writes.
typedef struct bench_files
{
    results_format format;
    const char *output, *report; ///< null: standard output; no page
} bench_files;

/// Take --format, --output and --report, and at the end refuse one file for both.
/// @return false: the key is none of them
bool bench_take_file( options_state* o, int key, const char* argument, bench_files* files );
/// Take --quick, --seconds and --workers. @return false: the key is none of them
bool bench_take_measurement( const options_state* o, int key, const char* argument, bench_options* options );
/// Check that the files can be written.
wisp_status bench_check_files( const bench_files* files, wisp_error* error );
/// Write the results, and the page if there is to be one.
wisp_status bench_write_files( const bench_files* files, const report_run* run, const results* out,
                               wisp_error* error );
/// For options of cases. @param user progress
void bench_show_progress( void* user, double fraction, const char* what );

/// @return WISP_OK in place of the status of an interruption, which becomes a note
wisp_status bench_keep_interrupted( results* out, wisp_status status );

/// The machine, with the instruction set of the engine's kernels.
wisp_status bench_describe_machine( machine_info* out, wisp_error* error );
