/// The command line as tables. A row of a table is what getopt_long() reads, what --help and the manual page say, and
/// what shells complete, so that none of them can differ from another.
#pragma once

#include "wisp/base.h"

#include <stddef.h>
#include <stdio.h>

typedef struct options_state options_state;

/// Take what no other place can: into `input` of the state.
typedef void option_fn( const options_state* o, const char* argument );

typedef enum option_kind
{
    OPTION_TO_FUNCTION, ///< null: the argument is ignored
    OPTION_TO_FLAG,     ///< bool
    OPTION_TO_TEXT,
    OPTION_TO_FILE, ///< text; one that is written beside the results, which standard output has already: "-" is refused
    OPTION_TO_WORD,   ///< int or enum, the index of the word
    OPTION_TO_NAME,   ///< text, the word itself
    OPTION_TO_WHOLE,  ///< int in [lower, upper]
    OPTION_TO_NUMBER, ///< double in (0, upper]
    OPTION_TO_INPUT,  ///< text; the one operand, which must be there
    OPTION_TO_INPUT_IF_ANY,
} option_kind;

/// Where the value goes: a member of what the caller gives to options_parse(), or a function.
typedef struct option_place
{
    option_kind kind;
    size_t offset;
    double lower, upper;
    option_fn* take;
} option_place;

/// What an argument can be, for messages and for completion, and where it goes. All zero: any text.
typedef struct option_values
{
    const char* const* words; ///< [word_count] the only ones, or null
    int word_count;
    const char* files; ///< extensions such as ".yaml .json"; "*" is any file and "/" a folder; null: no file
    option_place to;
} option_values;

/// One option, or the title of a group of them.
typedef struct option_row
{
    const char* name;     ///< long name without dashes; null in a title
    int key;              ///< the short option, or 0
    const char* argument; ///< name of the argument, "[NAME]" if it can be left out; null: none
    const char* text;     ///< what it does, without a full stop; null: understood, but not described
    option_values values;
} option_row;

#define OPTION_TITLE( title )                                                                                        \
    {                                                                                                                \
        .text = ( title )                                                                                            \
    }
// Initialisers of option_values: `type` is that of the caller's struct.
#define OPTION_TO( kind_of, type, member ) .to = { .kind = ( kind_of ), .offset = offsetof( type, member ) }
#define OPTION_LIST( list ) .words = ( list ), .word_count = WISP_COUNT( list )
#define OPTION_FLAG( type, member )                                                                                  \
    {                                                                                                                \
        OPTION_TO( OPTION_TO_FLAG, type, member )                                                                    \
    }
#define OPTION_TEXT( type, member, extensions )                                                                      \
    {                                                                                                                \
        .files = ( extensions ), OPTION_TO( OPTION_TO_TEXT, type, member )                                           \
    }
#define OPTION_FILE( type, member, extensions )                                                                      \
    {                                                                                                                \
        .files = ( extensions ), OPTION_TO( OPTION_TO_FILE, type, member )                                           \
    }
#define OPTION_INPUT( kind_of, type, member, extensions )                                                            \
    {                                                                                                                \
        .files = ( extensions ), OPTION_TO( kind_of, type, member )                                                  \
    }
#define OPTION_WORD( type, member, list )                                                                            \
    {                                                                                                                \
        OPTION_LIST( list ), OPTION_TO( OPTION_TO_WORD, type, member )                                               \
    }
#define OPTION_NAME( type, member, list )                                                                            \
    {                                                                                                                \
        OPTION_LIST( list ), OPTION_TO( OPTION_TO_NAME, type, member )                                               \
    }
#define OPTION_WHOLE( type, member, least, most )                                                                    \
    {                                                                                                                \
        .to = { OPTION_TO_WHOLE, offsetof( type, member ), ( least ), ( most ), NULL }                               \
    }
#define OPTION_NUMBER( type, member, most )                                                                          \
    {                                                                                                                \
        .to = { OPTION_TO_NUMBER, offsetof( type, member ), 0.0, ( most ), NULL }                                    \
    }
#define OPTION_TAKEN( function )                                                                                     \
    {                                                                                                                \
        .to = {.take = ( function ) }                                                                                \
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
struct options_state
{
    const command_text* command;
    char name[48];        ///< what messages call the argument: "--steps", or the noun
    option_values values; ///< of the argument
    void* input;          ///< of the caller
};

/// Judge the whole, after everything else.
typedef void options_fn( const options_state* o );

/// Read a command line as getopt_long() does: long options can be abbreviated, operands may stand between options, and
/// "--" ends the options. Operands are taken after all options. --help, --usage and --version print and end the
/// program; what is wrong ends it with STATUS_USAGE and one line on standard error.
/// @param check may be null
void options_parse( const command_text* command, options_fn* check, void* input, int argc, char** argv );

/// End the program with STATUS_USAGE and a line that begins with the command's name.
_Noreturn void options_fail( const options_state* o, const char* format, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );

// ---- values; each ends the program as options_fail() does if the text is invalid ----

/// Read a whole number.
int option_whole( const options_state* o, const char* text, int lower, int upper );
/// Read one of the words of the argument. The message for an unknown one suggests the nearest. @return its index
int option_word( const options_state* o, const char* text );
/// The same, of another list.
int option_word_of( const options_state* o, const char* text, const char* const* words, int count );
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
