// Manual pages, in the language of man(7), which mandoc and groff read.
#include "options.h"

#include <string.h>

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
    if ( row->key < OPTION_KEY )
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

static void put_commands( const command_text* command, FILE* out )
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

void options_print_manual( const command_text* command, FILE* out )
{
    put_head( command, out );
    fputs( ".SH DESCRIPTION\n", out );
    put_paragraphs( command->about, true, out );
    put_paragraphs( command->notes ? command->notes : "", false, out );
    put_commands( command, out );
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
