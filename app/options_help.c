// --help and --usage.
#include "options.h"

#include <string.h>

enum
{
    TEXT_COLUMN = 29,
    COLUMNS = 98,
};

const options_status options_statuses[6] = {
    { 0, "success" },
    { 1, NULL },
    { 2, "bad input, or a file could not be read or written" },
    { 64, "wrong usage" },
    { 130, "interrupted by Ctrl-C: files hold what was done until then" },
    { 143, "the same by the signal SIGTERM" },
};

// ---- options ----

// Words of a text, from `column` on, in lines that end before COLUMNS.
static void print_wrapped( const char* text, int indent, int column, FILE* out )
{
    while ( *text )
    {
        const int length = (int)strcspn( text, " " );
        if ( column > indent && column + 1 + length > COLUMNS )
        {
            fprintf( out, "\n%*s", indent, "" );
            column = indent;
        }
        column += fprintf( out, "%s%.*s", column > indent ? " " : "", length, text );
        text += length;
        text += strspn( text, " " );
    }
    fputc( '\n', out );
}

void options_put_long( const option_row* row, char* out )
{
    const bool is_optional = row->argument && row->argument[0] == '[';
    const char* before = is_optional ? "[=" : row->argument ? "=" : "";
    snprintf( out, 80, "--%s%s%s", row->name, before, row->argument ? row->argument + is_optional : "" );
}

static void print_row( const option_row* row, FILE* out )
{
    char left[100], name[80];
    options_put_long( row, name );
    const int used = row->key < OPTION_KEY ? snprintf( left, sizeof left, "  -%c, %s", row->key, name )
                                           : snprintf( left, sizeof left, "      %s", name );
    fprintf( out, "%s%*s", left, used < TEXT_COLUMN ? TEXT_COLUMN - used : 0, "" );
    if ( used >= TEXT_COLUMN )
    {
        fprintf( out, "\n%*s", TEXT_COLUMN, "" );
    }
    print_wrapped( row->text, TEXT_COLUMN, TEXT_COLUMN, out );
}

static void print_options( const command_text* command, FILE* out )
{
    for ( int i = 0; i < command->row_count; ++i )
    {
        const option_row* row = command->rows + i;
        if ( row->name == NULL )
        {
            fprintf( out, "%s %s\n", i > 0 ? "\n" : "", row->text );
        }
        else if ( row->text )
        {
            print_row( row, out );
        }
    }
    fputs( command->row_count > 0 ? "\n" : "", out );
    for ( int i = 0; i < WISP_COUNT( options_common ); ++i )
    {
        print_row( options_common + i, out );
    }
}

// ---- the whole ----

// A form of the operands after another, one of them a line.
static void print_usage_lines( const command_text* command, FILE* out )
{
    char name[48];
    command_name( command, name );
    const char* begin = "Usage: ";
    const char* form = command->operands;
    do
    {
        const int length = (int)strcspn( form, "\n" );
        fprintf( out, "%s%s [OPTION...]%s%.*s\n", begin, name, length > 0 ? " " : "", length, form );
        begin = "  or:  ";
        form += length;
        form += *form == '\n' ? 1 : 0;
    } while ( *form );
}

void options_print_help( const command_text* command, FILE* out )
{
    int count = 0;
    const command_text* const* list = command->commands ? command->commands( &count ) : NULL;
    print_usage_lines( command, out );
    fprintf( out, "%s\n\n", command->about );
    for ( int i = 0; i < count; ++i )
    {
        fprintf( out, "%s  %-12s%s\n", i == 0 ? "Commands:\n" : "", list[i]->name, list[i]->summary );
    }
    fputs( count > 0 ? "\n" : "", out );
    print_options( command, out );
    if ( command->notes )
    {
        fprintf( out, "\n%s\n", command->notes );
    }
    fputs( "\nExamples:\n", out );
    for ( const char* line = command->examples; *line; )
    {
        const int length = (int)strcspn( line, "\n" );
        fprintf( out, "  %.*s\n", length, line );
        line += length;
        line += *line == '\n' ? 1 : 0;
    }
    fputs( "\nExit status:\n", out );
    for ( int i = 0; i < WISP_COUNT( options_statuses ); ++i )
    {
        const options_status* row = options_statuses + i;
        const char* text = row->status == 1 ? command->unmet : row->text;
        if ( text )
        {
            fprintf( out, "  %-3d %s\n", row->status, text );
        }
    }
}

void options_print_usage( const command_text* command, FILE* out )
{
    char name[48];
    command_name( command, name );
    int column = fprintf( out, "Usage: %s", name );
    for ( int i = 0; i < command->row_count + WISP_COUNT( options_common ); ++i )
    {
        const option_row* row =
            i < command->row_count ? command->rows + i : options_common + ( i - command->row_count );
        char text[80], word[90];
        if ( row->name && row->text )
        {
            options_put_long( row, text );
            const bool is_short = row->key < OPTION_KEY;
            const int length = is_short ? snprintf( word, sizeof word, "[-%c|%s]", row->key, text )
                                        : snprintf( word, sizeof word, "[%s]", text );
            if ( column + 1 + length > COLUMNS )
            {
                column = fprintf( out, "\n%*s", 11, "" ) - 1;
            }
            column += fprintf( out, " %s", word );
        }
    }
    fprintf( out, "\n%*s%.*s\n", 12, "", (int)strcspn( command->operands, "\n" ), command->operands );
}
