/// The commands of the program, and what they share: exit statuses, error lines, common options.
#pragma once

#include "options.h"
#include "wisp/base.h"

/// Exit statuses, as in --help and README.md.
enum
{
    STATUS_GOOD = 0,
    STATUS_UNMET = 1,  ///< a check of the benchmark failed, or no tuned configuration meets the target
    STATUS_FAILED = 2, ///< bad input, or a run that failed
    STATUS_USAGE = 64, ///< EX_USAGE of sysexits.h
};

/// The row of --format, of commands that print results.
#define OPTION_RESULTS_FORMAT( type, member )                                                                        \
    {                                                                                                                \
        "format", 'f', "FORMAT", "text (default), markdown, csv, json or latex",                                     \
            OPTION_WORD( type, member, results_format_names )                                                        \
    }

/// One command: argv[0] is "wisp <command>". @return exit status
typedef int command_fn( int argc, char** argv );

command_fn command_run;
command_fn command_plan;
command_fn command_bench;
command_fn command_accuracy;
command_fn command_validate;
command_fn command_sweep;
command_fn command_merge;
command_fn command_gate;
command_fn command_torture;
command_fn command_info;
command_fn command_render;
command_fn command_view;
command_fn command_tune;
command_fn command_compare;
command_fn command_help;
command_fn command_completion;

extern const command_text run_text, plan_text, bench_text, info_text, render_text, view_text, tune_text, torture_text,
    gate_text, accuracy_text, validate_text, sweep_text, merge_text, compare_text, help_text, completion_text;

/// The program itself.
extern const command_text program_text;

/// End the program with STATUS_USAGE and the nearest command. @param word null: there was none
_Noreturn void command_unknown( const char* word );

/// Print the message of a failure to stderr. @return STATUS_FAILED, or the status of an interruption
int command_fail( const wisp_error* error );

/// End a command that prints: what does not arrive on standard output is its failure, with a message. @return its exit status
int command_end( wisp_status status, wisp_error* error );

/// Check that a file can be written, before the work that fills it. Changes nothing.
/// @param path may be null, for no file @return WISP_IO_ERROR the operating system would reject it
wisp_status command_check_writable( const char* path, wisp_error* error );

/// Words accepted by --isa.
extern const char* const option_isa_words[3];
