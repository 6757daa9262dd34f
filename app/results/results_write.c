#include "results_write.h"

#include "io_file.h"
#include "results.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- text for a terminal ----

#define GAP 2            // blanks between two columns
#define CELL_WIDTH 44    // characters of a cell in one line
#define HEADING_WIDTH 12 // a heading of several words that is wider than this and than its cells is broken
#define KEYS_MAX 3
#define KEYS_WIDTH 72 // characters of all repeated columns, so that there is room for another one
#define TABLE_COLUMNS_MAX 64

/// Columns of a table that stand side by side.
typedef struct text_part
{
    int columns[RESULTS_TEXT_COLUMNS];
    int count, width;
} text_part;

static int least( int a, int b )
{
    return a < b ? a : b;
}

static int most( int a, int b )
{
    return a > b ? a : b;
}

// Count the characters of the first line of a text that is broken between words.
static int line_length( const char* text, int width )
{
    const int length = (int)strlen( text );
    if ( length <= width )
    {
        return length;
    }
    int end = width;
    while ( end > 0 && text[end] != ' ' )
    {
        --end;
    }
    return end > 0 ? end : width;
}

static int longest_word( const char* text )
{
    int longest = 0;
    for ( const char* c = text; *c; c += strspn( c, " " ) )
    {
        const int length = (int)strcspn( c, " " );
        longest = most( longest, length );
        c += length;
    }
    return longest;
}

static int column_width( const results_table* table, int column )
{
    int width = 0;
    for ( int row = 1; row < table->row_count; ++row )
    {
        width = most( width, (int)strlen( results_cell( table, row, column ) ) );
    }
    const char* heading = results_cell( table, 0, column );
    const int heading_width = least( (int)strlen( heading ), most( HEADING_WIDTH, longest_word( heading ) ) );
    return most( least( width, CELL_WIDTH ), least( heading_width, CELL_WIDTH ) );
}

// ---- which columns stand side by side ----

// Hashes and quantiles are for programs; rows for machines have them.
static bool is_for_programs( const char* heading )
{
    return strcmp( heading, "hash" ) == 0 || strstr( heading, "p10" ) != NULL;
}

static int find_shown( const results_table* table, int* shown )
{
    int count = 0;
    for ( int column = 0; column < least( table->column_count, TABLE_COLUMNS_MAX ); ++column )
    {
        if ( !is_for_programs( results_cell( table, 0, column ) ) )
        {
            shown[count++] = column;
        }
    }
    return count;
}

static bool are_distinct( const results_table* table, const int* columns, int count )
{
    for ( int a = 1; a < table->row_count; ++a )
    {
        for ( int b = a + 1; b < table->row_count; ++b )
        {
            bool same = true;
            for ( int i = 0; i < count && same; ++i )
            {
                same = strcmp( results_cell( table, a, columns[i] ), results_cell( table, b, columns[i] ) ) == 0;
            }
            if ( same )
            {
                return false;
            }
        }
    }
    return true;
}

// Count the first columns that tell all rows apart.
static int count_keys( const results_table* table, const int* shown, int shown_count )
{
    int count = 1, width = column_width( table, shown[0] );
    while ( count < least( KEYS_MAX, shown_count ) && !are_distinct( table, shown, count ) )
    {
        width += GAP + column_width( table, shown[count] );
        if ( width > KEYS_WIDTH )
        {
            break;
        }
        ++count;
    }
    return count;
}

static bool add_column( const results_table* table, int column, int count_max, text_part* part )
{
    const int width = part->width + ( part->count > 0 ? GAP : 0 ) + column_width( table, column );
    if ( part->count == count_max || width > RESULTS_TEXT_WIDTH )
    {
        return false;
    }
    part->columns[part->count++] = column;
    part->width = width;
    return true;
}

// Fill the next part: the keys again, then what follows. @return the first column of the part behind it
static int fill_part( const results_table* table, const int* shown, int shown_count, int key_count, int next,
                      int count_max, text_part* part )
{
    *part = ( text_part ){ .count = 0 };
    for ( int k = 0; k < key_count && next > 0; ++k )
    {
        add_column( table, shown[k], count_max, part );
    }
    while ( next < shown_count && add_column( table, shown[next], count_max, part ) )
    {
        ++next;
    }
    return next;
}

// Parts of about equal size look better than a last one with a single column.
static int balance( const results_table* table, const int* shown, int shown_count, int key_count )
{
    int parts = 0;
    text_part part;
    for ( int next = 0; next < shown_count; ++parts )
    {
        next = fill_part( table, shown, shown_count, key_count, next, RESULTS_TEXT_COLUMNS, &part );
    }
    const int others = shown_count - key_count;
    return parts > 0 ? least( key_count + most( ( others + parts - 1 ) / parts, 1 ), RESULTS_TEXT_COLUMNS ) : 0;
}

// ---- lines ----

static void write_row( const results_table* table, const text_part* part, int row, FILE* stream )
{
    const char* rest[RESULTS_TEXT_COLUMNS];
    for ( int i = 0; i < part->count; ++i )
    {
        rest[i] = results_cell( table, row, part->columns[i] );
    }
    for ( bool is_done = false; !is_done; )
    {
        is_done = true;
        int blanks = 0; // written only before further text, so that no line ends with any
        for ( int i = 0; i < part->count; ++i )
        {
            const int width = column_width( table, part->columns[i] ), length = line_length( rest[i], width );
            const bool is_right = results_is_numeric_column( table, part->columns[i] );
            blanks += ( i > 0 ? GAP : 0 ) + ( is_right ? width - length : 0 );
            if ( length > 0 )
            {
                fprintf( stream, "%*s%.*s", blanks, "", length, rest[i] );
                blanks = 0;
            }
            blanks += is_right ? 0 : width - length;
            rest[i] += length;
            rest[i] += strspn( rest[i], " " );
            is_done = is_done && rest[i][0] == '\0';
        }
        fputc( '\n', stream );
    }
}

static void write_part( const results_table* table, const text_part* part, FILE* stream )
{
    WISP_ASSERT( part->count <= RESULTS_TEXT_COLUMNS && part->width <= RESULTS_TEXT_WIDTH );
    for ( int row = 0; row < table->row_count; ++row )
    {
        write_row( table, part, row, stream );
        for ( int i = 0; row == 0 && i < part->width; ++i )
        {
            fputc( '-', stream );
        }
        fputs( row == 0 ? "\n" : "", stream );
    }
}

// A table without a title is a list of labels: it has no heading, and its last column takes the rest of the line.
static void write_labels( const results_table* table, FILE* stream )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        for ( int column = 0; column + 1 < table->column_count; ++column )
        {
            int width = 0;
            for ( int other = 1; other < table->row_count; ++other )
            {
                width = most( width, (int)strlen( results_cell( table, other, column ) ) );
            }
            fprintf( stream, "%-*s%*s", width, results_cell( table, row, column ), GAP, "" );
        }
        fprintf( stream, "%s\n", results_cell( table, row, table->column_count - 1 ) );
    }
}

// Write a text, broken between words; its further lines are indented.
static void write_text_lines( const char* text, FILE* stream )
{
    for ( int line = 0; line == 0 || *text; ++line )
    {
        const int indent = line > 0 ? 2 : 0;
        const int length = line_length( text, RESULTS_TEXT_WIDTH - indent );
        fprintf( stream, "%*s%.*s\n", indent, "", length, text );
        text += length;
        text += strspn( text, " " );
    }
}

void results_write_text_table( const results_table* table, FILE* stream )
{
    if ( table->title[0] == '\0' )
    {
        write_labels( table, stream );
        return;
    }
    int shown[TABLE_COLUMNS_MAX];
    const int shown_count = find_shown( table, shown );
    const int key_count = shown_count > 0 ? count_keys( table, shown, shown_count ) : 0;
    const int count_max = balance( table, shown, shown_count, key_count );
    for ( int next = 0; next < shown_count; )
    {
        text_part part;
        fputc( '\n', stream );
        write_text_lines( table->title, stream );
        fputs( next > 0 ? "(continued)\n\n" : "\n", stream );
        next = fill_part( table, shown, shown_count, key_count, next, count_max, &part );
        write_part( table, &part, stream );
    }
}

// ---- JSON ----

// JSON has no NaN: a number that nobody knows is null.
static json_t* json_number( double value )
{
    return isfinite( value ) ? json_real( value ) : json_null();
}

// Beyond 2^53 a double is no count any more.
json_t* results_json_count( double value )
{
    return value == floor( value ) && fabs( value ) < 0x1p53 ? json_integer( (json_int_t)value )
                                                             : json_number( value );
}

// Text of unknown origin, such as a file's name, may not be UTF-8, which JSON refuses.
json_t* results_json_text( const char* value )
{
    json_t* string = json_string( value );
    return string ? string : json_string( "(not UTF-8)" );
}

// A hash is 64 bits and a JSON integer 63, so it travels as sixteen hexadecimal digits.
json_t* results_json_hash( uint64_t hash )
{
    char digits[17];
    snprintf( digits, sizeof digits, "%016llx", (unsigned long long)hash );
    return json_string( digits );
}

bool results_json_take_hash( const json_t* value, uint64_t* out )
{
    const char* text = json_string_value( value );
    *out = text != NULL ? strtoull( text, NULL, 16 ) : 0;
    return text != NULL && strlen( text ) == 16 && strspn( text, "0123456789abcdef" ) == 16;
}

static json_t* values_object( const results_values* values )
{
    json_t* object = json_object();
    for ( int i = 0; i < values->count; ++i )
    {
        json_object_set_new( object, values->items[i].name, results_json_count( values->items[i].value ) );
    }
    return object;
}

static json_t* error_object( const results_row* row )
{
    if ( row->error_reference[0] == '\0' && row->error.count == 0 )
    {
        return json_null();
    }
    json_t* object = values_object( &row->error );
    if ( row->error_reference[0] != '\0' )
    {
        json_object_set_new( object, "against", results_json_text( row->error_reference ) );
    }
    return object;
}

static json_t* samples_array( const results_row* row )
{
    json_t* array = json_array();
    for ( int i = 0; i < row->sample_count; ++i )
    {
        json_array_append_new( array, json_number( round( row->samples_ms[i] * 1e6 ) / 1e6 ) ); // to a ns
    }
    return array;
}

static json_t* row_object( const results_row* row )
{
    json_t* object = json_object();
    json_object_set_new( object, "case", results_json_text( row->name ) );
    json_object_set_new( object, "variant", results_json_text( row->variant ) );
    json_object_set_new( object, "size", values_object( &row->size ) );
    json_object_set_new( object, "workers", json_integer( row->workers ) );
    json_object_set_new( object, "ms_median", json_number( row->ms_median ) );
    json_object_set_new( object, "ms_p10", json_number( row->ms_p10 ) );
    json_object_set_new( object, "ms_p90", json_number( row->ms_p90 ) );
    json_object_set_new( object, "fps", json_number( 1e3 / row->ms_median ) );
    json_object_set_new( object, "steps", json_integer( row->steps ) );
    json_object_set_new( object, "samples_ms", samples_array( row ) );
    json_object_set_new( object, "cpu_fraction", json_number( row->cpu_fraction ) );
    json_object_set_new( object, "stages", values_object( &row->stages ) );
    json_object_set_new( object, "error", error_object( row ) );
    json_object_set_new( object, "hash", row->has_hash ? results_json_hash( row->hash ) : json_null() );
    return object;
}

static json_t* machine_object( const machine_info* machine )
{
    json_t* object = json_object();
    json_object_set_new( object, "cpu", results_json_text( machine->cpu ) );
    json_object_set_new( object, "cores", json_integer( machine->cores ) );
    json_object_set_new( object, "memory_bytes", results_json_count( machine->memory_bytes ) );
    json_object_set_new( object, "os", results_json_text( machine->os ) );
    json_object_set_new( object, "isa", results_json_text( machine->isa ) );
    json_object_set_new( object, "cpu_flags", results_json_text( machine->cpu_flags ) );
    return object;
}

static json_t* build_object( const machine_info* machine )
{
    json_t* object = json_object();
    json_object_set_new( object, "version", results_json_text( machine->version ) );
    json_object_set_new( object, "commit", results_json_text( machine->commit ) );
    json_object_set_new( object, "compiler", results_json_text( machine->compiler ) );
    json_object_set_new( object, "flags", results_json_text( machine->flags ) );
    json_object_set_new( object, "type", results_json_text( machine->build_type ) );
    return object;
}

// Returns the length of a text's first token: a string, a list of numbers, or any other character.
static size_t token_length( const char* text )
{
    if ( *text == '"' )
    {
        size_t length = 1;
        while ( text[length] != '"' )
        {
            length += text[length] == '\\' ? 2 : 1;
        }
        return length + 1;
    }
    const size_t numbers = *text == '[' ? strspn( text + 1, "0123456789+-.eE, \n" ) : 0;
    return text[1 + numbers] == ']' && numbers > 0 ? 2 + numbers : 1;
}

// Puts lists of numbers on one line each: with a line for each number, samples of times are most of a file.
static void join_numbers( char* text )
{
    char* to = text;
    for ( const char* from = text; *from != '\0'; )
    {
        const char* end = from + token_length( from );
        const bool is_list = *from == '[' && end - from > 1;
        for ( ; from < end; ++from )
        {
            if ( is_list == false || ( *from != '\n' && *from != ' ' ) )
            {
                *to++ = *from;
            }
            if ( is_list && *from == ',' )
            {
                *to++ = ' ';
            }
        }
    }
    *to = '\0';
}

// jansson's constructors hand on the null of a failed allocation, so one look at the dump is enough.
static wisp_status dump_json( json_t* root, FILE* stream, wisp_error* error )
{
    char* text = json_dumps( root, JSON_INDENT( 2 ) | JSON_REAL_PRECISION( 9 ) );
    json_decref( root );
    if ( text != NULL )
    {
        join_numbers( text );
    }
    const bool failed = text == NULL || fputs( text, stream ) == EOF || fputc( '\n', stream ) == EOF;
    free( text );
    if ( failed )
    {
        return wisp_fail( error, WISP_IO_ERROR, "the results could not be written as JSON" );
    }
    return WISP_OK;
}

void results_json_put_script( const char* json, FILE* stream )
{
    for ( const char* at = json; *at; ++at )
    {
        if ( *at == '<' )
        {
            fputs( "\\u003c", stream );
        }
        else
        {
            fputc( *at, stream );
        }
    }
}

// A list of labels and values has a note for each line.
static void add_labels( json_t* notes, const results_table* table )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        char line[400];
        snprintf( line, sizeof( line ), "%s: %s", results_cell( table, row, 0 ), results_cell( table, row, 1 ) );
        json_array_append_new( notes, results_json_text( line ) );
    }
}

// Our own schema: {"wisp_results":2, "date":.., "options":.., "machine":{..}, "build":{..}, "rows":[..], "notes":[..]}.
static wisp_status write_json( const results* all, FILE* stream, wisp_error* error )
{
    json_t* rows = json_array();
    for ( int i = 0; i < all->row_count; ++i )
    {
        json_array_append_new( rows, row_object( &all->rows[i] ) );
    }
    json_t* notes = json_array();
    for ( int i = 0; i < all->headline_count; ++i )
    {
        json_array_append_new( notes, results_json_text( all->headlines[i] ) );
    }
    for ( int t = 0; t < all->table_count; ++t )
    {
        if ( all->tables[t].title[0] == '\0' )
        {
            add_labels( notes, &all->tables[t] );
        }
    }
    for ( int i = 0; i < all->note_count; ++i )
    {
        json_array_append_new( notes, results_json_text( all->notes[i] ) );
    }
    json_t* root = json_object();
    json_object_set_new( root, "wisp_results", json_integer( RESULTS_JSON_VERSION ) );
    json_object_set_new( root, "date", results_json_text( all->machine.date ) );
    json_object_set_new( root, "options", results_json_text( all->options ) );
    json_object_set_new( root, "machine", machine_object( &all->machine ) );
    json_object_set_new( root, "build", build_object( &all->machine ) );
    json_object_set_new( root, "rows", rows );
    json_object_set_new( root, "notes", notes );
    return dump_json( root, stream, error );
}

const char* const results_format_names[RESULTS_FORMAT_COUNT] = { "text", "markdown", "csv", "json", "latex" };

// ---- tables for people ----

static void write_machine( const results* all, FILE* stream, const char* begin, const char* end )
{
    const machine_info* machine = &all->machine;
    fprintf( stream, "%smachine: %s, %d cores, %.1f GB%s%s%s\n", begin, machine->cpu, machine->cores,
             machine->memory_bytes / 1e9, machine->isa[0] ? ", kernels for " : "", machine->isa, end );
    fprintf( stream, "%ssystem: %s%s\n", begin, machine->os, end );
    fprintf( stream, "%sbuild: wisp %s (%s), %s, %s%s\n", begin, machine->version, machine->commit, machine->compiler,
             machine->build_type, end );
    fprintf( stream, "%sflags: %s%s\n", begin, machine->flags, end );
}

// A bar ends a cell and a line ends a row, so neither may appear inside one.
static void write_markdown_cell( const char* text, FILE* stream )
{
    fputs( "| ", stream );
    for ( const char* c = text; *c; ++c )
    {
        if ( *c == '|' )
        {
            fputc( '\\', stream );
        }
        fputc( *c == '\n' ? ' ' : *c, stream );
    }
    fputc( ' ', stream );
}

static void write_markdown_table( const results_table* table, bool is_first, FILE* stream )
{
    fputs( is_first ? "" : "\n", stream );
    if ( table->title[0] != '\0' )
    {
        fprintf( stream, "### %s\n\n", table->title );
    }
    for ( int row = 0; row < table->row_count; ++row )
    {
        for ( int column = 0; column < table->column_count; ++column )
        {
            write_markdown_cell( results_cell( table, row, column ), stream );
        }
        fputs( "|\n", stream );
        for ( int column = 0; row == 0 && column < table->column_count; ++column )
        {
            fputs( results_is_numeric_column( table, column ) ? "|---:" : "|---", stream );
        }
        fputs( row == 0 ? "|\n" : "", stream );
    }
}

// Characters that LaTeX reads as commands.
static void write_latex_text( const char* text, FILE* stream )
{
    static const char* const spelled[][2] = { { "\\", "\\textbackslash{}" },  { "~", "\\textasciitilde{}" },
                                              { "^", "\\textasciicircum{}" }, { "<", "\\textless{}" },
                                              { ">", "\\textgreater{}" },     { "|", "\\textbar{}" } };
    bool is_quoted = false; // `like this`
    for ( const char* c = text; *c; ++c )
    {
        const char* whole = *c == '`' ? ( is_quoted ? "'" : "`" ) : NULL;
        is_quoted = is_quoted != ( *c == '`' );
        for ( int i = 0; i < WISP_COUNT( spelled ); ++i )
        {
            whole = *c == spelled[i][0][0] ? spelled[i][1] : whole;
        }
        if ( whole )
        {
            fputs( whole, stream );
            continue;
        }
        fputs( strchr( "&%$#_{}", *c ) ? "\\" : "", stream );
        fputc( *c == '\n' ? ' ' : *c, stream );
    }
}

static void write_latex_table( const results_table* table, bool is_first, FILE* stream )
{
    int shown[TABLE_COLUMNS_MAX];
    const int count = find_shown( table, shown );
    const bool is_wide = count > RESULTS_TEXT_COLUMNS;
    (void)is_first;
    if ( table->title[0] == '\0' )
    {
        return;
    }
    fputs( "\n\\begin{table}\n\\centering\n\\caption{", stream );
    write_latex_text( table->title, stream );
    fprintf( stream, "}\n%s\\begin{tabular}{", is_wide ? "\\resizebox{\\textwidth}{!}{" : "" );
    for ( int i = 0; i < count; ++i )
    {
        fputc( results_is_numeric_column( table, shown[i] ) ? 'r' : 'l', stream );
    }
    fputs( "}\n\\toprule\n", stream );
    for ( int row = 0; row < table->row_count; ++row )
    {
        for ( int i = 0; i < count; ++i )
        {
            fputs( i > 0 ? " & " : "", stream );
            write_latex_text( results_cell( table, row, shown[i] ), stream );
        }
        fputs( row == 0 ? " \\\\\n\\midrule\n" : " \\\\\n", stream );
    }
    fprintf( stream, "\\bottomrule\n\\end{tabular}%s\n\\end{table}\n", is_wide ? "}" : "" );
}

static void write_text_table( const results_table* table, bool is_first, FILE* stream )
{
    (void)is_first;
    results_write_text_table( table, stream );
}

// How a format for people writes its lines and tables.
typedef struct people_format
{
    const char *head, *begin, *end, *note; // of the file; of lines; of notes
    bool wraps;
    void ( *write_table )( const results_table* table, bool is_first, FILE* stream );
} people_format;

static const people_format people_formats[RESULTS_FORMAT_COUNT] = {
    [RESULTS_TEXT] = { "", "", "", "", true,
                       write_text_table }, // notes in one line each, so that programs find words in them
    [RESULTS_MARKDOWN] = { "", "", "  ", "- ", false, write_markdown_table },
    [RESULTS_LATEX] = { "% \\usepackage{booktabs, graphicx}\n", "% ", "", "% ", false, write_latex_table },
};

static void write_people( const results* all, const people_format* format, FILE* stream )
{
    const bool is_brief = all->is_brief && format->wraps;
    fputs( format->head, stream );
    for ( int i = 0; i < all->headline_count; ++i )
    {
        if ( format->wraps )
        {
            write_text_lines( all->headlines[i], stream );
        }
        else
        {
            fprintf( stream, "%s%s%s\n", format->begin, all->headlines[i], format->end );
        }
    }
    if ( !all->is_result_first )
    {
        write_machine( all, stream, format->begin, format->end );
    }
    for ( int t = 0; t < all->table_count; ++t )
    {
        if ( !is_brief || all->tables[t].title[0] == '\0' )
        {
            format->write_table( &all->tables[t], t == 0 && all->is_result_first, stream );
        }
    }
    fputs( all->note_count > 0 ? "\n" : "", stream );
    for ( int i = 0; i < all->note_count; ++i )
    {
        fprintf( stream, "%s%s\n", format->note, all->notes[i] );
    }
    if ( all->is_result_first && !is_brief )
    {
        fputc( '\n', stream );
        write_machine( all, stream, format->begin, format->end );
    }
}

// ---- one line a row for spreadsheets ----

// RFC 4180: fields with a comma, a quote or a line end are quoted, quotes inside are doubled.
static void write_csv_text( const char* text, FILE* stream )
{
    if ( !text[strcspn( text, ",\"\r\n" )] )
    {
        fputs( text, stream );
        return;
    }
    fputc( '"', stream );
    for ( const char* c = text; *c; ++c )
    {
        fputs( *c == '"' ? "\"" : "", stream );
        fputc( *c, stream );
    }
    fputc( '"', stream );
}

static const results_values* value_group( const results_row* row, int group )
{
    return group == 0 ? &row->size : group == 1 ? &row->stages : &row->error;
}

static const char* const value_group_names[3] = { "size", "stages", "error" };

static const results_value* find_value( const results_values* values, const char* name )
{
    for ( int i = 0; i < values->count; ++i )
    {
        if ( strcmp( values->items[i].name, name ) == 0 )
        {
            return &values->items[i];
        }
    }
    return NULL;
}

// Every name of a group over all rows, in order of first appearance: not every row has every pass.
typedef struct csv_columns
{
    const char** names;
    int count;
} csv_columns;

static bool gather_columns( const results* all, int group, csv_columns* columns )
{
    int most = 1;
    for ( int r = 0; r < all->row_count; ++r )
    {
        most += value_group( &all->rows[r], group )->count;
    }
    columns->names = malloc( (size_t)most * sizeof( char* ) );
    for ( int r = 0; columns->names && r < all->row_count; ++r )
    {
        const results_values* values = value_group( &all->rows[r], group );
        for ( int i = 0; i < values->count; ++i )
        {
            int known = 0;
            while ( known < columns->count && strcmp( columns->names[known], values->items[i].name ) != 0 )
            {
                ++known;
            }
            if ( known == columns->count )
            {
                columns->names[columns->count++] = values->items[i].name;
            }
        }
    }
    return columns->names != NULL;
}

static void write_csv_number( double value, FILE* stream )
{
    if ( isfinite( value ) )
    {
        fprintf( stream, ",%.9g", value );
    }
    else
    {
        fputc( ',', stream );
    }
}

static void write_csv_row( const results_row* row, const csv_columns* columns, FILE* stream )
{
    write_csv_text( row->name, stream );
    fputc( ',', stream );
    write_csv_text( row->variant, stream );
    fprintf( stream, ",%d", row->workers );
    write_csv_number( row->ms_median, stream );
    write_csv_number( row->ms_p10, stream );
    write_csv_number( row->ms_p90, stream );
    write_csv_number( 1e3 / row->ms_median, stream );
    fprintf( stream, ",%d,", row->steps );
    if ( row->has_hash )
    {
        fprintf( stream, "%016llx", (unsigned long long)row->hash );
    }
    fputc( ',', stream );
    write_csv_text( row->error_reference, stream );
    for ( int group = 0; group < 3; ++group )
    {
        for ( int i = 0; i < columns[group].count; ++i )
        {
            const results_value* value = find_value( value_group( row, group ), columns[group].names[i] );
            write_csv_number( value ? value->value : NAN, stream );
        }
    }
    fputs( "\r\n", stream );
}

static wisp_status write_csv( const results* all, FILE* stream, wisp_error* error )
{
    csv_columns columns[3] = { 0 };
    bool gathered = true;
    for ( int group = 0; group < 3; ++group )
    {
        gathered = gather_columns( all, group, &columns[group] ) && gathered;
    }
    if ( gathered )
    {
        fputs( "case,variant,workers,ms_median,ms_p10,ms_p90,fps,steps,hash,error.against", stream );
        for ( int group = 0; group < 3; ++group )
        {
            for ( int i = 0; i < columns[group].count; ++i )
            {
                char heading[100];
                snprintf( heading, sizeof( heading ), "%s.%s", value_group_names[group], columns[group].names[i] );
                fputc( ',', stream );
                write_csv_text( heading, stream );
            }
        }
        fputs( "\r\n", stream );
        for ( int r = 0; r < all->row_count; ++r )
        {
            write_csv_row( &all->rows[r], columns, stream );
        }
    }
    for ( int group = 0; group < 3; ++group )
    {
        free( columns[group].names );
    }
    return gathered ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "out of memory to write the results as CSV" );
}

// ---- any of them ----

wisp_status results_write( const results* all, results_format format, FILE* stream, wisp_error* error )
{
    if ( all->incomplete )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "out of memory to gather the results" );
    }
    wisp_status status = WISP_OK;
    switch ( format )
    {
        case RESULTS_CSV:
            status = write_csv( all, stream, error );
            break;
        case RESULTS_JSON:
            status = write_json( all, stream, error );
            break;
        default:
            write_people( all, &people_formats[format], stream );
            break;
    }
    // Streams keep their first error, so looking once at the end is enough.
    if ( status == WISP_OK && ( fflush( stream ) != 0 || ferror( stream ) ) )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "the results could not be written: %s", strerror( errno ) );
    }
    return status;
}

wisp_status results_write_file( const results* all, results_format format, const char* path, wisp_error* error )
{
    io_output output;
    if ( path == NULL || io_is_standard( path ) )
    {
        return results_write( all, format, stdout, error );
    }
    WISP_TRY( io_output_open( path, &output, error ) );
    wisp_error cause = { 0 };
    wisp_status status = results_write( all, format, output.stream, &cause );
    if ( status != WISP_OK )
    {
        wisp_fail( error, status, "%s: %s", path, cause.message );
    }
    return io_output_end( &output, status, error );
}
