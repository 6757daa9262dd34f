#include "results.h"

#include "io_file.h"
#include "results_json.h"
#include "results_text.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char* const results_format_names[RESULTS_FORMAT_COUNT] = { "text", "markdown", "csv", "json", "github" };

// ---- tables for people ----

static void write_machine( const results* all, FILE* stream, const char* line_end )
{
    const machine_info* machine = &all->machine;
    fprintf( stream, "machine: %s, %d cores, %.1f GB%s%s%s\n", machine->cpu, machine->cores,
             machine->memory_bytes / 1e9, machine->isa[0] ? ", kernels for " : "", machine->isa, line_end );
    fprintf( stream, "system: %s%s\n", machine->os, line_end );
    fprintf( stream, "build: wisp %s (%s), %s, %s%s\n", machine->version, machine->commit, machine->compiler,
             machine->build_type, line_end );
    fprintf( stream, "flags: %s%s\n", machine->flags, line_end );
}

static void write_text( const results* all, FILE* stream )
{
    for ( int i = 0; i < all->headline_count; ++i )
    {
        results_write_text_lines( all->headlines[i], stream );
    }
    if ( !all->is_result_first )
    {
        write_machine( all, stream, "" );
    }
    for ( int t = 0; t < all->table_count; ++t )
    {
        results_write_text_table( &all->tables[t], stream );
    }
    fputs( all->note_count > 0 ? "\n" : "", stream );
    for ( int i = 0; i < all->note_count; ++i )
    {
        fprintf( stream, "%s\n", all->notes[i] ); // in one line each, so that programs find words in them
    }
    if ( all->is_result_first )
    {
        fputc( '\n', stream );
        write_machine( all, stream, "" );
    }
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

static void write_markdown( const results* all, FILE* stream )
{
    for ( int i = 0; i < all->headline_count; ++i )
    {
        fprintf( stream, "%s  \n", all->headlines[i] );
    }
    if ( !all->is_result_first )
    {
        write_machine( all, stream, "  " );
    }
    for ( int t = 0; t < all->table_count; ++t )
    {
        const results_table* table = &all->tables[t];
        fputs( t > 0 || !all->is_result_first ? "\n" : "", stream );
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
    fputs( all->note_count > 0 ? "\n" : "", stream );
    for ( int i = 0; i < all->note_count; ++i )
    {
        fprintf( stream, "- %s\n", all->notes[i] );
    }
    if ( all->is_result_first )
    {
        fputc( '\n', stream );
        write_machine( all, stream, "  " );
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
        fputs( "case,variant,workers,ms_median,ms_p10,ms_p90,steps,hash,error.against", stream );
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
        case RESULTS_MARKDOWN:
            write_markdown( all, stream );
            break;
        case RESULTS_CSV:
            status = write_csv( all, stream, error );
            break;
        case RESULTS_JSON:
            status = results_write_json( all, stream, error );
            break;
        case RESULTS_GITHUB:
            status = results_write_github( all, stream, error );
            break;
        case RESULTS_TEXT:
        case RESULTS_FORMAT_COUNT:
            write_text( all, stream );
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
    wisp_status status = io_output_open( path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    wisp_error cause = { 0 };
    status = results_write( all, format, output.stream, &cause );
    if ( status != WISP_OK )
    {
        wisp_fail( error, status, "%s: %s", path, cause.message );
    }
    return io_output_end( &output, status, error );
}
