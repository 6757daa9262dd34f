// `wisp help` and `wisp completion`: what the tables of all commands say, for readers, man and shells.
#include "commands.h"

#include <string.h>

// ---- help ----

static const option_row help_rows[] = {
    { "man", 'm', NULL, "Print the page in the language of man(7), for 'man -l -'", OPTION_ANY },
};

const command_text help_text = {
    .name = "help",
    .operands = "[COMMAND]",
    .noun = "command",
    .summary = "describe the program or a command",
    .about = "Describe the program, or the arguments and options of a command.",
    .examples = "wisp help run\n"
                "wisp help run --man | man -l -",
    .rows = help_rows,
    .row_count = WISP_COUNT( help_rows ),
};

typedef struct help_options
{
    const char* word;
    bool is_manual;
} help_options;

static bool take_help( options_state* o, int key, const char* argument )
{
    help_options* given = o->input;
    given->is_manual = given->is_manual || key == 'm';
    return key == OPTIONS_OPERAND ? option_input( o, key, argument, &given->word ) : true;
}

static int flush( void )
{
    wisp_error error = { 0 };
    if ( fflush( stdout ) == 0 && !ferror( stdout ) )
    {
        return STATUS_GOOD;
    }
    wisp_fail( &error, WISP_IO_ERROR, "standard output: the text could not be written" );
    return command_fail( &error );
}

int command_help( int argc, char** argv )
{
    help_options given = { 0 };
    options_parse( &help_text, take_help, &given, argc, argv );
    int count;
    const command_text* const* all = program_text.commands( &count );
    const command_text* chosen = given.word ? NULL : &program_text;
    for ( int i = 0; i < count && given.word; ++i )
    {
        chosen = strcmp( all[i]->name, given.word ) == 0 ? all[i] : chosen;
    }
    if ( chosen == NULL )
    {
        command_unknown( given.word );
    }
    if ( given.is_manual )
    {
        options_print_manual( chosen, stdout );
    }
    else
    {
        options_print_help( chosen, stdout );
    }
    return flush();
}

// ---- completion ----

static const char* const shell_words[] = { "bash" };

const command_text completion_text = {
    .name = "completion",
    .operands = "SHELL",
    .noun = "shell",
    .summary = "print the completions of bash",
    .about = "Print a script that makes bash complete commands, options, their words and files.",
    .notes = "Packages install this script. For one user:\n"
             "  wisp completion bash > ~/.local/share/bash-completion/completions/wisp",
    .examples = "source <(wisp completion bash)",
    .values = OPTION_WORDS( shell_words ),
};

static bool take_completion( options_state* o, int key, const char* argument )
{
    int* shell = o->input;
    if ( key == OPTIONS_OPERAND && *shell >= 0 )
    {
        options_fail( o, "got a second shell '%s', expected one", argument );
    }
    if ( key == OPTIONS_OPERAND )
    {
        *shell = option_word( o, argument );
    }
    if ( key == OPTIONS_END && *shell < 0 )
    {
        options_fail( o, "expected a shell: bash" );
    }
    return true;
}

int command_completion( int argc, char** argv )
{
    int shell = -1;
    options_parse( &completion_text, take_completion, &shell, argc, argv );
    options_print_bash( &program_text, stdout );
    return flush();
}
