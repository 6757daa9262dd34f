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

static const char* const shell_words[] = { "bash", "zsh", "fish" };

const command_text completion_text = {
    .name = "completion",
    .operands = "SHELL",
    .noun = "shell",
    .summary = "print the completions of a shell: bash, zsh or fish",
    .about = "Print a script that makes a shell complete commands, options, their words and files.",
    .notes = "Packages install these scripts. For one user:\n"
             "  bash    wisp completion bash > ~/.local/share/bash-completion/completions/wisp\n"
             "  zsh     wisp completion zsh > a folder of $fpath/_wisp\n"
             "  fish    wisp completion fish > ~/.config/fish/completions/wisp.fish",
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
        options_fail( o, "expected a shell: bash, zsh or fish" );
    }
    return true;
}

int command_completion( int argc, char** argv )
{
    typedef void print_fn( const command_text* program, FILE* out );
    static print_fn* const prints[] = { options_print_bash, options_print_zsh, options_print_fish };
    int shell = -1;
    options_parse( &completion_text, take_completion, &shell, argc, argv );
    prints[shell]( &program_text, stdout );
    return flush();
}
