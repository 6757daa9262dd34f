/// Shared by the commands that measure.
#pragma once

#include "bench.h"
#include "commands.h"
#include "report.h"
#include "results.h"
#include "wisp/base.h"

/// What a command writes.
typedef struct bench_files
{
    results_format format;
    const char *output, *report; ///< null: standard output; no page
} bench_files;

/// Rows that several commands have, whose struct has `options` and `files`.
#define BENCH_SECONDS_ROW( type, text )                                                                              \
    {                                                                                                                \
        "seconds", 0, "S", ( text ), OPTION_NUMBER( type, options.seconds, 1e6 )                                     \
    }
#define BENCH_QUICK_ROW( type, text )                                                                                \
    {                                                                                                                \
        "quick", 'q', NULL, ( text ), OPTION_FLAG( type, options.quick )                                             \
    }
#define BENCH_WORKERS_ROW( type )                                                                                    \
    {                                                                                                                \
        "workers", 'w', "N", "Workers of the parallel variant, 1 to 64, default 2",                                  \
            OPTION_WHOLE( type, options.workers, 1, WISP_MAX_WORKERS )                                               \
    }
#define BENCH_FILE_ROWS( type )                                                                                      \
    OPTION_RESULTS_FORMAT( type, files.format ),                                                                     \
        { "output", 'o', "FILE", "Write the results to FILE; default: standard output",                              \
          OPTION_TEXT( type, files.output, "*" ) },                                                                  \
    {                                                                                                                \
        "report", 0, "FILE", "Also write an HTML page with charts", OPTION_TEXT( type, files.report, ".html" )       \
    }

/// Refuse one file for both results and page.
void bench_check_names( const options_state* o, const bench_files* files );
/// Check that the files can be written.
wisp_status bench_check_files( const bench_files* files, wisp_error* error );
/// Write the results, and the page if there is to be one.
wisp_status bench_write_files( const bench_files* files, const report_run* run, const results* out,
                               wisp_error* error );
/// What a command measures. @param page to be described; without a name nothing is written
typedef wisp_status bench_run_fn( void* arguments, results* out, report_run* page, wisp_error* error );

/// Measure, with a progress bar, and write results and page. After an interruption there is what was measured by then, and a note.
/// @param unmet line for standard error if a check failed, or null
/// @return exit status
int bench_measure( bench_options* options, const bench_files* files, bench_run_fn* run, void* arguments,
                   const char* unmet, int argc, char** argv );

/// The machine, with the instruction set of the engine's kernels.
wisp_status bench_describe_machine( machine_info* out, wisp_error* error );
