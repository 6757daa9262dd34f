#include "results_json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// JSON has no NaN: a number that nobody knows is null.
json_t* results_json_number( double value )
{
    return isfinite( value ) ? json_real( value ) : json_null();
}

// Beyond 2^53 a double is no count any more.
json_t* results_json_count( double value )
{
    return value == floor( value ) && fabs( value ) < 0x1p53 ? json_integer( (json_int_t)value )
                                                             : results_json_number( value );
}

// Text of unknown origin, such as a file's name, may not be UTF-8, which JSON refuses.
json_t* results_json_text( const char* value )
{
    json_t* string = json_string( value );
    return string ? string : json_string( "(not UTF-8)" );
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

// A hash is 64 bits and a JSON integer 63, so it travels as sixteen hexadecimal digits.
json_t* results_json_hash( const results_row* row )
{
    if ( !row->has_hash )
    {
        return json_null();
    }
    char digits[17];
    snprintf( digits, sizeof( digits ), "%016llx", (unsigned long long)row->hash );
    return json_string( digits );
}

static json_t* samples_array( const results_row* row )
{
    json_t* array = json_array();
    for ( int i = 0; i < row->sample_count; ++i )
    {
        json_array_append_new( array, results_json_number( round( row->samples_ms[i] * 1e6 ) / 1e6 ) ); // to a ns
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
    json_object_set_new( object, "ms_median", results_json_number( row->ms_median ) );
    json_object_set_new( object, "ms_p10", results_json_number( row->ms_p10 ) );
    json_object_set_new( object, "ms_p90", results_json_number( row->ms_p90 ) );
    json_object_set_new( object, "steps", json_integer( row->steps ) );
    json_object_set_new( object, "samples_ms", samples_array( row ) );
    json_object_set_new( object, "cpu_fraction", results_json_number( row->cpu_fraction ) );
    json_object_set_new( object, "stages", values_object( &row->stages ) );
    json_object_set_new( object, "error", error_object( row ) );
    json_object_set_new( object, "hash", results_json_hash( row ) );
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
wisp_status results_json_dump( json_t* root, FILE* stream, wisp_error* error )
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

wisp_status results_write_json( const results* all, FILE* stream, wisp_error* error )
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
    return results_json_dump( root, stream, error );
}

// ---- github-action-benchmark ----

static void benchmark_name( const results_row* row, char* name, size_t size )
{
    int used = snprintf( name, size, "%s/%s", row->name, row->variant );
    if ( row->size.count > 0 )
    {
        const results_value* first = &row->size.items[0];
        used += snprintf( name + used, size - (size_t)used, "/%s:%.0f", first->name, first->value );
    }
    if ( row->workers > 0 )
    {
        snprintf( name + used, size - (size_t)used, "/workers:%d", row->workers );
    }
}

// Rows without samples, such as times printed in a paper, are not benchmark runs.
static bool is_timed( const results_row* row )
{
    return row->steps > 0 && isfinite( row->ms_median );
}

wisp_status results_write_github( const results* all, FILE* stream, wisp_error* error )
{
    json_t* root = json_array();
    for ( int i = 0; i < all->row_count; ++i )
    {
        const results_row* row = &all->rows[i];
        char name[320], range[64] = "";
        if ( !is_timed( row ) )
        {
            continue;
        }
        benchmark_name( row, name, sizeof name );
        if ( isfinite( row->ms_p10 ) && isfinite( row->ms_p90 ) )
        {
            snprintf( range, sizeof range, "%.4g .. %.4g", row->ms_p10, row->ms_p90 );
        }
        json_t* object = json_object();
        json_object_set_new( object, "name", results_json_text( name ) );
        json_object_set_new( object, "unit", json_string( "ms" ) );
        json_object_set_new( object, "value", results_json_number( row->ms_median ) );
        json_object_set_new( object, "range", results_json_text( range ) );
        json_object_set_new( object, "extra", results_json_text( all->machine.cpu ) );
        json_array_append_new( root, object );
    }
    return results_json_dump( root, stream, error );
}
