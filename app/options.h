/// The command line as tables. A row of a table is what getopt_long() reads, what --help and the manual page say, and
/// what shells complete, so that none of them can differ from another.
#pragma once

#include "wisp/base.h"

#include <stdio.h>

/// What an argument can be, for messages and for completion. All zero: any text.
typedef struct option_values
{
    const char* const* words; ///< [word_count] the only ones, or null
    int word_count;
    const char* files; ///< extensions such as ".yaml .json"; "*" is any file and "/" a folder; null: no file
} option_values;

/// One option, or the title of a group of them.
typedef struct option_row
{
    const char* name;     ///< long name without dashes; null in a title
    int key;              ///< the short option, or a number from OPTION_KEY on
    const char* argument; ///< name of the argument, "[NAME]" if it can be left out; null: none
    const char* text;     ///< what it does, without a full stop; null: understood, but not described
    option_values values;
} option_row;

#define OPTION_KEY 256 ///< the first key that is no character
#define OPTION_TITLE( title )                                                                                        \
    {                                                                                                                \
        .text = ( title )                                                                                            \
    }
#define OPTION_WORDS( list )                                                                                         \
    {                                                                                                                \
        ( list ), WISP_COUNT( list ), NULL                                                                           \
    }
#define OPTION_FILES( extensions )                                                                                   \
    {                                                                                                                \
        NULL, 0, ( extensions )                                                                                      \
    }
#define OPTION_ANY                                                                                                   \
    {                                                                                                                \
        NULL, 0, NULL                                                                                                \
    }

/// A command: its options, and what is said about it.
typedef struct command_text
{
    const char* name;     ///< "run"; "" is the program itself
    const char* operands; ///< "SCENE"; a line for each form
    const char* noun;     ///< what messages call an operand: "scene"
    const char* summary;  ///< a phrase for the list of commands
    const char* about;    ///< what it does, in lines, below the usage; null: the summary
    const char* notes;    ///< paragraphs below the options, or null; lines that begin with two blanks stay lines
    const char* examples; ///< a command per line
    const char* unmet;    ///< when the status is 1; null: never
    const option_row* rows;
    int row_count;
    option_values values; ///< of an operand
    const struct command_text* const* ( *commands )(
        int* count ); ///< commands of the program; null: it is one itself
} command_text;

/// The state of options_parse().
typedef struct options_state
{
    const command_text* command;
    char name[48];        ///< what messages call the argument: "--steps", or the noun
    option_values values; ///< of the argument
    void* input;          ///< of the caller
} options_state;

/// Keys besides those of the rows.
enum
{
    OPTIONS_OPERAND = -1,
    OPTIONS_END = -2, ///< after everything else, without an argument
};

/// Take one option or operand. @return false if it is none of them
typedef bool options_fn( options_state* o, int key, const char* argument );

/// Read a command line as getopt_long() does: long options can be abbreviated, operands may stand between options, and
/// "--" ends the options. Operands are delivered after all options. --help, --usage and --version print and end the
/// program; what is wrong ends it with STATUS_USAGE and one line on standard error.
void options_parse( const command_text* command, options_fn* take, void* input, int argc, char** argv );

/// End the program with STATUS_USAGE and a line that begins with the command's name.
_Noreturn void options_fail( const options_state* o, const char* format, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );

// ---- values; each ends the program as options_fail() does if the text is invalid ----

/// Read a whole number.
int option_whole( const options_state* o, const char* text, int lower, int upper );
/// Read a number in (0, upper].
double option_positive( const options_state* o, const char* text, double upper );
/// Read one of the words of the argument. The message for an unknown one suggests the nearest. @return its index
int option_word( const options_state* o, const char* text );
/// The same, of another list.
int option_word_of( const options_state* o, const char* text, const char* const* words, int count );
/// A file that is written beside the results, which standard output has already: "-" is refused.
const char* option_file( const options_state* o, const char* text );
/// The one operand of a command, such as its scene: keep it, or fail if there are none or two. @return whether the key was about it
bool option_input( const options_state* o, int key, const char* argument, const char** input );

// ---- what is said about commands ----

/// Name of a command as a user types it: "wisp run". @param out [48]
void command_name( const command_text* command, char* out );
/// The long option with its argument: "--steps=N". @param out [80]
void options_put_long( const option_row* row, char* out );
/// Rows that all commands have: help, usage, version.
extern const option_row options_common[3];

/// An exit status and its meaning; null where each command has its own.
typedef struct options_status
{
    int status;
    const char* text;
} options_status;

extern const options_status options_statuses[6];

/// --help.
void options_print_help( const command_text* command, FILE* out );
