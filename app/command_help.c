// `wisp help` and `wisp completion`: what the tables of all commands say, for readers, man and shells.
#include "commands.h"

#include "options.h"

#include <string.h>

// ---- manual pages ----

// Manual pages, in the language of man(7), which mandoc and groff read.

// ---- text ----

// A character that man(7) would read as something else. A dot or a quote is a request where it begins a line.
static void put_character( char c, bool is_first, FILE* out )
{
    if ( is_first && ( c == '.' || c == '\'' ) )
    {
        fputs( "\\&", out );
    }
    switch ( c )
    {
        case '\\':
            fputs( "\\e", out );
            break;
        case '-':
            fputs( "\\-", out );
            break;
        case '~':
            fputs( "\\(ti", out );
            break;
        case '^':
            fputs( "\\(ha", out );
            break;
        case '`':
            fputs( "\\(ga", out );
            break;
        case '\'':
            fputs( "\\(aq", out );
            break;
        default:
            fputc( c, out );
            break;
    }
}

static void put_text( const char* text, int length, FILE* out )
{
    for ( int i = 0; i < length; ++i )
    {
        put_character( text[i], i == 0, out );
    }
}

static void put_line( const char* text, int length, FILE* out )
{
    put_text( text, length, out );
    fputc( '\n', out );
}

// Paragraphs are divided by empty lines; lines that begin with blanks stay lines.
static void put_paragraphs( const char* text, bool is_first, FILE* out )
{
    bool is_kept = false, is_begun = is_first;
    while ( *text )
    {
        const int length = (int)strcspn( text, "\n" );
        const bool keeps = *text == ' ';
        if ( length > 0 )
        {
            fputs( is_kept && !keeps ? ".fi\n" : "", out );
            fputs( !is_begun || is_kept != keeps ? ".PP\n" : "", out );
            fputs( keeps && !is_kept ? ".nf\n" : "", out );
            put_line( text, length, out );
            is_kept = keeps;
        }
        is_begun = length > 0;
        text += length;
        text += *text == '\n' ? 1 : 0;
    }
    fputs( is_kept ? ".fi\n" : "", out );
}

// ---- options ----

static void put_option( const option_row* row, FILE* out )
{
    char name[80];
    fputs( ".TP\n", out );
    if ( row->key )
    {
        fprintf( out, "\\fB\\-%c\\fR, ", row->key );
    }
    options_put_long( row, name );
    const int bold = (int)( 2 + strlen( row->name ) );
    fputs( "\\fB", out );
    put_text( name, bold, out );
    fputs( "\\fR", out );
    if ( name[bold] )
    {
        fputs( name[bold] == '[' ? "[=\\fI" : "=\\fI", out );
        put_text( name + bold + ( name[bold] == '[' ? 2 : 1 ),
                  (int)strlen( name + bold ) - ( name[bold] == '[' ? 3 : 1 ), out );
        fputs( name[bold] == '[' ? "\\fR]" : "\\fR", out );
    }
    fputc( '\n', out );
    put_text( row->text, (int)strlen( row->text ), out );
    fputs( ".\n", out );
}

static void put_options( const command_text* command, FILE* out )
{
    fputs( ".SH OPTIONS\n", out );
    for ( int i = 0; i < command->row_count; ++i )
    {
        const option_row* row = command->rows + i;
        if ( row->name == NULL )
        {
            fputs( ".SS ", out );
            put_line( row->text, (int)strcspn( row->text, ":" ), out );
        }
        else if ( row->text )
        {
            put_option( row, out );
        }
    }
    fputs( command->row_count > 0 && command->rows[0].name == NULL ? ".SS Common\n" : "", out );
    for ( int i = 0; i < WISP_COUNT( options_common ); ++i )
    {
        put_option( options_common + i, out );
    }
}

// ---- sections ----

static void put_head( const command_text* command, FILE* out )
{
    char name[48];
    command_name( command, name );
    char* blank = strchr( name, ' ' );
    if ( blank )
    {
        *blank = '-';
    }
    fprintf( out, ".TH %s 1 \"\" \"wisp %s\" \"User Commands\"\n.SH NAME\n", name, WISP_VERSION_STRING );
    put_text( name, (int)strlen( name ), out );
    fputs( " \\- ", out );
    put_line( command->summary, (int)strlen( command->summary ), out );
    fputs( ".SH SYNOPSIS\n", out );
    command_name( command, name );
    for ( const char* form = command->operands; *form; )
    {
        const int length = (int)strcspn( form, "\n" );
        fprintf( out, "%s\\fB%s\\fR [\\fIOPTION\\fR...] ", form == command->operands ? "" : ".br\n", name );
        put_line( form, length, out );
        form += length;
        form += *form == '\n' ? 1 : 0;
    }
}

static void put_command_list( const command_text* command, FILE* out )
{
    int count = 0;
    const command_text* const* list = command->commands ? command->commands( &count ) : NULL;
    fputs( count > 0 ? ".SH COMMANDS\n" : "", out );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, ".TP\n\\fB%s\\fR\n", list[i]->name );
        put_line( list[i]->summary, (int)strlen( list[i]->summary ), out );
    }
}

static void put_statuses( const command_text* command, FILE* out )
{
    fputs( ".SH EXIT STATUS\n", out );
    for ( int i = 0; i < WISP_COUNT( options_statuses ); ++i )
    {
        const options_status* row = options_statuses + i;
        const char* text = row->status == 1 ? command->unmet : row->text;
        if ( text )
        {
            fprintf( out, ".TP\n%d\n", row->status );
            put_text( text, (int)strlen( text ), out );
            fputs( ".\n", out );
        }
    }
}

static const char environment[] =
    ".SH ENVIRONMENT\n"
    ".TP\n\\fBWISP_DATA\\fR\nfolder with suites, references, meshes and the page of 'wisp view', instead of those "
    "that are installed.\n"
    ".TP\n\\fBWISP_CACHE\\fR\nfolder of converged runs that errors are measured against; default ~/.cache/wisp.\n"
    ".TP\n\\fBWISP_ISA\\fR\nlargest instruction set of the kernels: baseline, avx2 or avx512.\n"
    ".TP\n\\fBNO_COLOR\\fR, \\fBTERM\\fR\nprogress has no colour with NO_COLOR, and is not drawn if TERM is dumb.\n";

static void put_see_also( const command_text* command, FILE* out )
{
    int count = 0;
    const command_text* const* list = command->commands ? command->commands( &count ) : NULL;
    fputs( ".SH SEE ALSO\n", out );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "\\fBwisp\\-%s\\fR(1)%s", list[i]->name, i + 1 < count ? ",\n" : "\n" );
    }
    fputs( count > 0 ? "" : "\\fBwisp\\fR(1)\n", out );
}

// A page in the language of man(7).
static void print_manual( const command_text* command, FILE* out )
{
    put_head( command, out );
    fputs( ".SH DESCRIPTION\n", out );
    put_paragraphs( command->about, true, out );
    put_paragraphs( command->notes ? command->notes : "", false, out );
    put_command_list( command, out );
    put_options( command, out );
    fputs( command->commands ? environment : "", out );
    put_statuses( command, out );
    fputs( ".SH EXAMPLES\n.nf\n", out );
    for ( const char* line = command->examples; *line; )
    {
        const int length = (int)strcspn( line, "\n" );
        put_line( line, length, out );
        line += length;
        line += *line == '\n' ? 1 : 0;
    }
    fputs( ".fi\n", out );
    put_see_also( command, out );
}

// ---- completion for bash ----

// The script for bash. What can be completed is in the tables: commands, options, words and files.

// ---- tables ----

static bool is_shown( const option_row* row )
{
    return row->name && row->text;
}

/// Rows of a command and those of all commands, by number. @return null after the last one
static const option_row* row_at( const command_text* command, int i )
{
    return i < command->row_count                                  ? command->rows + i
           : i < command->row_count + WISP_COUNT( options_common ) ? options_common + ( i - command->row_count )
                                                                   : NULL;
}

static bool needs_value( const option_row* row )
{
    return row->argument && row->argument[0] != '[';
}

// The operand of `help` is a command, so those are its words.
static bool wants_command( const command_text* command )
{
    return strcmp( command->noun, "command" ) == 0;
}

static void put_words( const option_values* values, FILE* out )
{
    for ( int i = 0; i < values->word_count; ++i )
    {
        fprintf( out, "%s%s", i > 0 ? " " : "", values->words[i] );
    }
}

static void put_command_cases( const command_text* program, FILE* out )
{
    int count;
    const command_text* const* list = program->commands( &count );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "%s%s", i > 0 ? " " : "", list[i]->name );
    }
}

// ---- the script ----

static const char bash_head[] = "# Files of some extensions, and folders; '*' is any file and '/' folders alone.\n"
                                "_wisp_files()\n"
                                "{\n"
                                "    local extension line\n"
                                "    local -a extensions\n"
                                "    read -ra extensions <<<\"$1\"\n"
                                "    compopt -o filenames 2>/dev/null || :\n"
                                "    while IFS= read -r line; do\n"
                                "        COMPREPLY+=(\"$line\")\n"
                                "    done < <(\n"
                                "        for extension in \"${extensions[@]}\"; do\n"
                                "            case $extension in\n"
                                "                '*') compgen -f -- \"$cur\" ;;\n"
                                "                /) ;;\n"
                                "                *) compgen -f -X \"!*$extension\" -- \"$cur\" ;;\n"
                                "            esac\n"
                                "        done\n"
                                "        [[ $1 == '*' ]] || compgen -d -- \"$cur\"\n"
                                "    )\n"
                                "}\n"
                                "\n"
                                "_wisp()\n"
                                "{\n"
                                "    local cur=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
                                "    local command='' options='' words='' files='' value='' i\n"
                                "    COMPREPLY=()\n"
                                "    # bash divides --format=json at the sign\n"
                                "    if [[ $cur == = ]]; then\n"
                                "        cur=''\n"
                                "    elif [[ $before == = ]]; then\n"
                                "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
                                "    fi\n"
                                "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
                                "        if [[ ${COMP_WORDS[i]} != -* ]]; then\n"
                                "            command=${COMP_WORDS[i]}\n"
                                "            break\n"
                                "        fi\n"
                                "    done\n"
                                "    case $command in\n";

static const char bash_tail[] = "    esac\n"
                                "    if [[ -z $value && $cur == -* ]]; then\n"
                                "        words=$options files=\n"
                                "    fi\n"
                                "    while IFS= read -r i; do\n"
                                "        COMPREPLY+=(\"$i\")\n"
                                "    done < <(compgen -W \"$words\" -- \"$cur\")\n"
                                "    if [[ -n $files ]]; then\n"
                                "        _wisp_files \"$files\"\n"
                                "    fi\n"
                                "}\n"
                                "\n"
                                "complete -F _wisp wisp\n";

static void put_bash_values( const option_values* values, FILE* out )
{
    if ( values->word_count > 0 )
    {
        fputs( " words='", out );
        put_words( values, out );
        fputs( "'", out );
    }
    if ( values->files )
    {
        fprintf( out, " files='%s'", values->files );
    }
}

static void put_bash_command( const command_text* program, const command_text* command, FILE* out )
{
    fprintf( out, "        %s)\n            options='", command->name[0] ? command->name : "''" );
    const option_row* row;
    for ( int i = 0, count = 0; ( row = row_at( command, i ) ) != NULL; ++i )
    {
        if ( is_shown( row ) )
        {
            fprintf( out, "%s--%s", count++ > 0 ? " " : "", row->name );
        }
    }
    fputs( "'\n            case $before in\n", out );
    for ( int i = 0; ( row = row_at( command, i ) ) != NULL; ++i )
    {
        if ( is_shown( row ) && needs_value( row ) )
        {
            fprintf( out, "                --%s", row->name );
            if ( row->key )
            {
                fprintf( out, " | -%c", row->key );
            }
            fputs( ") value=1", out );
            put_bash_values( &row->values, out );
            fputs( " ;;\n", out );
        }
    }
    fputs( "                *)", out );
    put_bash_values( &command->values, out );
    if ( wants_command( command ) )
    {
        fputs( " words='", out );
        put_command_cases( program, out );
        fputs( "'", out );
    }
    fputs( " ;;\n            esac\n            ;;\n", out );
}

// Scripts that make a shell complete the words of a command line. @param program with its commands
static void print_bash( const command_text* program, FILE* out )
{
    int count;
    const command_text* const* list = program->commands( &count );
    fprintf( out, "# Completions of wisp %s for bash, made by 'wisp completion bash'.\n\n%s", WISP_VERSION_STRING,
             bash_head );
    put_bash_command( program, program, out );
    for ( int i = 0; i < count; ++i )
    {
        put_bash_command( program, list[i], out );
    }
    fputs( bash_tail, out );
}

// ---- the commands ----

// `wisp help` and `wisp completion`: what the tables of all commands say, for readers, man and shells.

// ---- help ----

typedef struct help_options
{
    const char* word;
    bool is_manual;
} help_options;

static const option_row help_rows[] = {
    { "man", 'm', NULL, "Print the page in the language of man(7), for 'man -l -'",
      OPTION_FLAG( help_options, is_manual ) },
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
    .values = OPTION_INPUT( OPTION_TO_INPUT_IF_ANY, help_options, word, NULL ),
};

int command_help( int argc, char** argv )
{
    help_options given = { 0 };
    options_parse( &help_text, NULL, &given, argc, argv );
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
        print_manual( chosen, stdout );
    }
    else
    {
        options_print_help( chosen, stdout );
    }
    return command_end( WISP_OK, &( wisp_error ){ 0 } );
}

// ---- completion ----

static const char* const shell_words[] = { "bash" };

static void take_shell( const options_state* o, const char* argument )
{
    int* shell = o->input;
    if ( *shell >= 0 )
    {
        options_fail( o, "got a second shell '%s', expected one", argument );
    }
    *shell = option_word( o, argument );
}

static void check_shell( const options_state* o )
{
    if ( *(const int*)o->input < 0 )
    {
        options_fail( o, "expected a shell: bash" );
    }
}

const command_text completion_text = {
    .name = "completion",
    .operands = "SHELL",
    .noun = "shell",
    .summary = "print the completions of bash",
    .about = "Print a script that makes bash complete commands, options, their words and files.",
    .notes = "Packages install this script. For one user:\n"
             "  wisp completion bash > ~/.local/share/bash-completion/completions/wisp",
    .examples = "source <(wisp completion bash)",
    .values = { OPTION_LIST( shell_words ), .to = { .take = take_shell } },
};

int command_completion( int argc, char** argv )
{
    int shell = -1;
    options_parse( &completion_text, check_shell, &shell, argc, argv );
    print_bash( &program_text, stdout );
    return command_end( WISP_OK, &( wisp_error ){ 0 } );
}
