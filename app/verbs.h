/// The verbs of the program, and what they share with wisp-bench: exit statuses, error lines, options that mean the same everywhere.
#pragma once

#include "wisp/base.h"

#include <argp.h>

/// Exit statuses, as --help and README.md state them.
enum
{
    STATUS_GOOD = 0,
    STATUS_UNMET = 1,  ///< a check of the benchmark failed, or no setting that was tuned meets what was asked for
    STATUS_FAILED = 2, ///< a failed run, or input that is wrong
    STATUS_USAGE = 64, ///< EX_USAGE of sysexits.h, which is what argp exits with
};

#define STATUS_HELP                                                                                                  \
    "Exit status: 0 good, 1 a check that failed or a target that is not met, 2 a failed run or bad input, 64 wrong " \
    "usage."

/// One verb: argv[0] is "wisp <verb>". @return exit status
typedef int verb_fn( int argc, char** argv );

verb_fn verb_run;
verb_fn verb_plan;
verb_fn verb_bench;
verb_fn verb_info;
verb_fn verb_render;
verb_fn verb_tune;

/// Print the one sentence of a failure to stderr. @return STATUS_FAILED
int verb_fail( const wisp_error* error );

/// Learning that a file cannot be written is cheap before an hour of work. Leaves everything as it was.
/// @param path may be null, for no file @return WISP_IO_ERROR the operating system would refuse
wisp_status verb_check_writable( const char* path, wisp_error* error );

/// A whole number of an option, or argp_error(), which ends the program with STATUS_USAGE.
int option_whole( struct argp_state* state, const char* option, const char* text, int low, int high );
/// A number of an option, in (0, high].
double option_positive( struct argp_state* state, const char* option, const char* text, double high );
/// One of some words of an option; a wrong one is answered with the nearest.
int option_word( struct argp_state* state, const char* option, const char* text, const char* const* words,
                 int count );

/// Words that --isa takes.
extern const char* const option_isa_words[3];
