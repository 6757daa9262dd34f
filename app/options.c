// getopt_long() is in glibc, musl, the BSDs and macOS, unlike argp. It reads; messages are our own.
#include "options.h"

#include "commands.h"
#include "machine.h"
#include "nearest.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

// ---- help ----

// --help and --usage.

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
    const int used = row->key ? snprintf( left, sizeof left, "  -%c, %s", row->key, name )
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

// --usage.
static void print_usage( const command_text* command, FILE* out )
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
            const int length = row->key ? snprintf( word, sizeof word, "[-%c|%s]", row->key, text )
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

// ---- reading ----

#define ROWS_MAX 64

enum
{
    KEY_HELP = 'h',
    KEY_VERSION = 'V',
    KEY_ROW = 0x10000, // long options without a short one: and the row's number
};

const option_row options_common[3] = {
    { .name = "help", .key = KEY_HELP, .text = "Print this help" },
    { .name = "usage", .text = "Print the options in short" },
    { .name = "version", .key = KEY_VERSION, .text = "Print the version" },
};

// ---- messages ----

void command_name( const command_text* command, char* out )
{
    snprintf( out, 48, "wisp%s%s", command->name[0] ? " " : "", command->name );
}

void options_fail( const options_state* o, const char* format, ... )
{
    char name[48];
    command_name( o->command, name );
    fprintf( stderr, "%s: ", name );
    va_list arguments;
    va_start( arguments, format );
    vfprintf( stderr, format, arguments );
    va_end( arguments );
    fprintf( stderr, "\n" );
    exit( STATUS_USAGE );
}

// ---- tables ----

static bool takes_argument( const option_row* row )
{
    return row->argument != NULL;
}

static bool can_omit_argument( const option_row* row )
{
    return row->argument != NULL && row->argument[0] == '[';
}

/// All rows with a name, those of all commands last.
typedef struct row_list
{
    const option_row* rows[ROWS_MAX];
    int count;
} row_list;

static row_list list_rows( const command_text* command )
{
    row_list list = { .count = 0 };
    for ( int i = 0; i < command->row_count; ++i )
    {
        if ( command->rows[i].name )
        {
            WISP_ASSERT( list.count + WISP_COUNT( options_common ) < ROWS_MAX );
            list.rows[list.count++] = command->rows + i;
        }
    }
    for ( int i = 0; i < WISP_COUNT( options_common ); ++i )
    {
        list.rows[list.count++] = options_common + i;
    }
    return list;
}

static int key_of( const row_list* list, int i )
{
    return list->rows[i]->key ? list->rows[i]->key : KEY_ROW + i;
}

static const option_row* find_row( const row_list* list, int key )
{
    for ( int i = 0; i < list->count; ++i )
    {
        if ( key_of( list, i ) == key )
        {
            return list->rows[i];
        }
    }
    return NULL;
}

// ---- what getopt_long() refuses ----

// The name of a long option in an argument, without dashes and value.
static void long_name( const char* argument, char* out, size_t size )
{
    const char* name = argument + strspn( argument, "-" );
    snprintf( out, size, "%.*s", (int)strcspn( name, "=" ), name );
}

static int names_that_begin( const row_list* list, const char* begin, char* out, size_t size )
{
    int count = 0;
    out[0] = '\0';
    for ( int i = 0; i < list->count; ++i )
    {
        if ( strncmp( list->rows[i]->name, begin, strlen( begin ) ) == 0 && list->rows[i]->text )
        {
            const size_t used = strlen( out );
            snprintf( out + used, size - used, "%s--%s", count++ > 0 ? ", " : "", list->rows[i]->name );
        }
    }
    return count;
}

// Unknown, or an abbreviation of several.
static _Noreturn void refuse_long( const options_state* o, const row_list* list, const char* argument )
{
    char word[48], names[400], name[48];
    const char* all[ROWS_MAX];
    long_name( argument, word, sizeof word );
    for ( int i = 0; i < list->count; ++i )
    {
        all[i] = list->rows[i]->name;
    }
    if ( names_that_begin( list, word, names, sizeof names ) > 1 )
    {
        options_fail( o, "got option '--%s', which can be %s", word, names );
    }
    const char* nearest = nearest_word( word, all, list->count );
    if ( nearest )
    {
        options_fail( o, "got option '--%s'; did you mean '--%s'?", word, nearest );
    }
    command_name( o->command, name );
    options_fail( o, "got option '--%s', which does not exist; '%s --help' lists all", word, name );
}

// Only an unknown long option leaves no character behind.
static _Noreturn void refuse( const options_state* o, const row_list* list, int result, char** argv )
{
    const option_row* row = find_row( list, optopt );
    char name[48];
    if ( optopt == 0 )
    {
        refuse_long( o, list, argv[optind - 1] );
    }
    if ( row && result == ':' )
    {
        options_fail( o, "--%s: got no value, expected %s", row->name, row->argument );
    }
    if ( row )
    {
        options_fail( o, "--%s: got a value, expected none", row->name );
    }
    command_name( o->command, name );
    options_fail( o, "got option '-%c', which does not exist; '%s --help' lists all", optopt, name );
}

// ---- the command line ----

static _Noreturn void print_and_exit( const command_text* command, const option_row* row )
{
    if ( row == options_common )
    {
        options_print_help( command, stdout );
    }
    else if ( row == options_common + 1 )
    {
        print_usage( command, stdout );
    }
    else
    {
        printf( "wisp %s\nkernels: %s\n", WISP_VERSION_STRING, machine_kernels() );
    }
    exit( command_end( WISP_OK, &( wisp_error ){ 0 } ) );
}

static void make_tables( const row_list* list, struct option* longs, char* shorts )
{
    *shorts++ = ':'; // tells a missing argument from an unknown option
    for ( int i = 0; i < list->count; ++i )
    {
        const option_row* row = list->rows[i];
        const int argument = can_omit_argument( row ) ? optional_argument
                             : takes_argument( row )  ? required_argument
                                                      : no_argument;
        longs[i] = ( struct option ){ row->name, argument, NULL, key_of( list, i ) };
        if ( row->key )
        {
            *shorts++ = (char)row->key;
            *shorts = ':';
            shorts += argument != no_argument ? 1 : 0;
        }
    }
    *shorts = '\0';
    longs[list->count] = ( struct option ){ 0 };
}

// ---- values ----

int option_whole( const options_state* o, const char* text, int lower, int upper )
{
    char* end = NULL;
    errno = 0;
    long value = strtol( text, &end, 10 );
    if ( end == text || *end || errno || value < lower || value > upper )
    {
        options_fail( o, "%s: got '%s', expected a whole number from %d to %d", o->name, text, lower, upper );
    }
    return (int)value;
}

static double read_positive( const options_state* o, const char* text, double upper )
{
    char* end = NULL;
    double value = strtod( text, &end );
    if ( end == text || *end || !( value > 0.0 ) || !( value <= upper ) )
    {
        options_fail( o, "%s: got '%s', expected a number above 0 and at most %g", o->name, text, upper );
    }
    return value;
}

int option_word_of( const options_state* o, const char* text, const char* const* words, int count )
{
    for ( int i = 0; i < count; ++i )
    {
        if ( strcmp( text, words[i] ) == 0 )
        {
            return i;
        }
    }
    const char* nearest = nearest_word( text, words, count );
    if ( nearest )
    {
        options_fail( o, "%s: got '%s'; did you mean '%s'?", o->name, text, nearest );
    }
    char all[300] = "";
    for ( int i = 0; i < count; ++i )
    {
        strncat( all, i > 0 ? ", " : "", sizeof( all ) - strlen( all ) - 1 );
        strncat( all, words[i], sizeof( all ) - strlen( all ) - 1 );
    }
    options_fail( o, "%s: got '%s', expected one of %s", o->name, text, all );
}

int option_word( const options_state* o, const char* text )
{
    return option_word_of( o, text, o->values.words, o->values.word_count );
}

// ---- the whole line ----

static void keep_input( const options_state* o, const char* text, const char** input )
{
    if ( *input )
    {
        options_fail( o, "got a second %s '%s', expected one", o->command->noun, text );
    }
    *input = text;
}

// Put a value where it goes.
static void keep( const options_state* o, const char* text )
{
    const option_place* to = &o->values.to;
    void* at = (char*)o->input + to->offset;
    switch ( to->kind )
    {
        case OPTION_TO_FUNCTION:
            to->take( o, text );
            break;
        case OPTION_TO_FLAG:
            *(bool*)at = true;
            break;
        case OPTION_TO_FILE:
            if ( strcmp( text, "-" ) == 0 )
            {
                options_fail( o, "%s: got '-', expected a file: standard output has the results", o->name );
            }
            *(const char**)at = text;
            break;
        case OPTION_TO_TEXT:
            *(const char**)at = text;
            break;
        case OPTION_TO_WORD:
            *(int*)at = option_word( o, text );
            break;
        case OPTION_TO_NAME:
            *(const char**)at = o->values.words[option_word( o, text )];
            break;
        case OPTION_TO_WHOLE:
            *(int*)at = option_whole( o, text, (int)to->lower, (int)to->upper );
            break;
        case OPTION_TO_NUMBER:
            *(double*)at = read_positive( o, text, to->upper );
            break;
        case OPTION_TO_INPUT:
        case OPTION_TO_INPUT_IF_ANY:
            keep_input( o, text, at );
            break;
    }
}

static void take_options( options_state* o, const row_list* list, int argc, char** argv )
{
    struct option longs[ROWS_MAX + 1];
    char shorts[2 * ROWS_MAX + 2];
    make_tables( list, longs, shorts );
    opterr = 0;
    for ( ;; )
    {
        optopt = 0;
        const int key = getopt_long( argc, argv, shorts, longs, NULL );
        if ( key == -1 )
        {
            return;
        }
        const option_row* row = key == '?' && optopt == '?' ? options_common : find_row( list, key );
        if ( row == NULL )
        {
            refuse( o, list, key, argv );
        }
        if ( row >= options_common && row < options_common + WISP_COUNT( options_common ) )
        {
            print_and_exit( o->command, row );
        }
        snprintf( o->name, sizeof o->name, "--%s", row->name );
        o->values = row->values;
        keep( o, optarg );
    }
}

void options_parse( const command_text* command, options_fn* check, void* input, int argc, char** argv )
{
    options_state o = { .command = command, .input = input };
    const row_list list = list_rows( command );
    take_options( &o, &list, argc, argv );
    snprintf( o.name, sizeof o.name, "%s", command->noun );
    o.values = command->values;
    for ( int i = optind; i < argc; ++i )
    {
        keep( &o, argv[i] );
    }
    if ( o.values.to.kind == OPTION_TO_INPUT && *(const char**)( (char*)input + o.values.to.offset ) == NULL )
    {
        options_fail( &o, "expected a %s", command->noun );
    }
    if ( check )
    {
        check( &o );
    }
}
