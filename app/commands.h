/// The commands of the program, and code shared with wisp-bench: exit statuses, error lines, common options.
#pragma once

#include "wisp/base.h"

#include <argp.h>

/// Exit statuses, as in --help and README.md.
enum
{
    STATUS_GOOD = 0,
    STATUS_UNMET = 1,  ///< a check of the benchmark failed, or no tuned configuration meets the target
    STATUS_FAILED = 2, ///< bad input, or a run that failed
    STATUS_USAGE = 64, ///< EX_USAGE of sysexits.h, the status of argp's own exits
};

/// The end of every --help. Commands that only run and describe never end with STATUS_UNMET.
#define STATUS_HELP                                                                                                  \
    "Exit status:\n"                                                                                                 \
    "  0   success\n"                                                                                                \
    "  2   bad input, or a file could not be read or written\n"                                                      \
    "  64  wrong usage"
#define STATUS_HELP_UNMET( unmet )                                                                                   \
    "Exit status:\n"                                                                                                 \
    "  0   success\n"                                                                                                \
    "  1   " unmet "\n"                                                                                              \
    "  2   bad input, or a file could not be read or written\n"                                                      \
    "  64  wrong usage"

/// One command: argv[0] is "wisp <command>". @return exit status
typedef int command_fn( int argc, char** argv );

command_fn command_run;
command_fn command_plan;
command_fn command_bench;
command_fn command_info;
command_fn command_render;
command_fn command_view;
command_fn command_tune;
command_fn command_torture;
command_fn command_gate;
command_fn command_compare;

/// Print the message of a failure to stderr. @return STATUS_FAILED
int command_fail( const wisp_error* error );

/// Check that a file can be written, before the work that fills it. Changes nothing.
/// @param path may be null, for no file @return WISP_IO_ERROR the operating system would reject it
wisp_status command_check_writable( const char* path, wisp_error* error );

/// Read a whole number of an option. An invalid one is an argp_error(), which ends the program with STATUS_USAGE.
int option_whole( struct argp_state* state, const char* option, const char* text, int lower, int upper );
/// Read a number of an option, in (0, high].
double option_positive( struct argp_state* state, const char* option, const char* text, double upper );
/// Read one of the words of an option. The message for an unknown one suggests the nearest.
int option_word( struct argp_state* state, const char* option, const char* text, const char* const* words,
                 int count );

/// The one input of a command, such as its scene: keep it, or argp_error() if there are none or two.
/// @param key of a parser @param noun for messages @return whether the key was about it
bool option_input( struct argp_state* state, int key, const char* argument, const char* noun, const char** input );

/// Words accepted by --isa.
extern const char* const option_isa_words[3];
