#include "info_results.h"

#include "io_file.h"
#include "results_json.h"

#include <errno.h>
#include <jansson.h>
#include <string.h>

#define FILE_CAP ( (size_t)256 << 20 )

// ---- reading ----

bool info_is_results( const char* bytes, size_t size )
{
    static const char key[] = "\"wisp_results\"";
    size_t length = sizeof( key ) - 1;
    for ( size_t i = 0; i + length <= size; ++i )
    {
        if ( memcmp( bytes + i, key, length ) == 0 )
        {
            return true;
        }
    }
    return false;
}

/// Where jansson's reader gets its bytes from, so that no file can make it read for ever.
typedef struct capped_file
{
    FILE* file;
    size_t taken;
} capped_file;

static size_t read_capped( void* buffer, size_t size, void* user )
{
    capped_file* source = user;
    if ( source->taken >= FILE_CAP )
    {
        return (size_t)-1;
    }
    size_t count = fread( buffer, 1, size, source->file );
    source->taken += count;
    return ferror( source->file ) ? (size_t)-1 : count;
}

static json_t* parse( const char* path, wisp_error* error )
{
    const int descriptor = io_file_open( path, 0, FILE_CAP );
    capped_file source = { .file = descriptor >= 0 ? fdopen( descriptor, "rb" ) : NULL };
    if ( !source.file )
    {
        wisp_fail( error, WISP_IO_ERROR, "%s: %s", io_input_name( path ), strerror( errno ) );
        return NULL;
    }
    json_error_t cause;
    json_t* root = json_load_callback( read_capped, &source, JSON_REJECT_DUPLICATES, &cause );
    if ( !root )
    {
        wisp_fail( error, WISP_BAD_INPUT, "%s:%d:%d: %s", io_input_name( path ), cause.line, cause.column,
                   cause.text );
    }
    fclose( source.file );
    return root;
}

// ---- the schema ----

static wisp_status wrong( wisp_error* error, const char* path, size_t row, const char* key, const char* what )
{
    return wisp_fail( error, WISP_BAD_INPUT, "%s: rows[%zu].%s: %s", path, row, key, what );
}

static bool is_number_or_null( const json_t* value )
{
    return json_is_number( value ) || json_is_null( value );
}

static bool holds_numbers( json_t* object )
{
    const char* key;
    json_t* value;
    json_object_foreach( object, key, value )
    {
        if ( !is_number_or_null( value ) && strcmp( key, "against" ) != 0 )
        {
            return false;
        }
    }
    return json_is_object( object );
}

static bool is_hash( const json_t* value )
{
    const char* text = json_string_value( value );
    return json_is_null( value ) || ( text && strlen( text ) == 16 && strspn( text, "0123456789abcdef" ) == 16 );
}

static wisp_status check_row( const char* path, json_t* row, size_t number, wisp_error* error )
{
    static const char* const texts[] = { "case", "variant" };
    static const char* const times[] = { "ms_median", "ms_p10", "ms_p90" };
    static const char* const counts[] = { "workers", "steps" };
    if ( !json_is_object( row ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: rows[%zu]: expected an object", path, number );
    }
    for ( int i = 0; i < WISP_COUNT( texts ); ++i )
    {
        if ( !json_is_string( json_object_get( row, texts[i] ) ) )
        {
            return wrong( error, path, number, texts[i], "expected a string" );
        }
    }
    for ( int i = 0; i < WISP_COUNT( times ); ++i )
    {
        json_t* time = json_object_get( row, times[i] );
        if ( !is_number_or_null( time ) || ( json_is_number( time ) && json_number_value( time ) < 0.0 ) )
        {
            return wrong( error, path, number, times[i], "expected a time of at least 0, or null" );
        }
    }
    for ( int i = 0; i < WISP_COUNT( counts ); ++i )
    {
        json_t* count = json_object_get( row, counts[i] );
        if ( !json_is_integer( count ) || json_integer_value( count ) < 0 )
        {
            return wrong( error, path, number, counts[i], "expected a whole number of at least 0" );
        }
    }
    json_t* samples = json_object_get( row, "samples_ms" );
    bool are_times = samples == NULL || json_is_array( samples ); // version 1 has none
    for ( size_t i = 0; i < json_array_size( samples ) && are_times; ++i )
    {
        json_t* sample = json_array_get( samples, i );
        are_times = json_is_number( sample ) && json_number_value( sample ) >= 0.0;
    }
    if ( !are_times )
    {
        return wrong( error, path, number, "samples_ms", "expected a list of times of at least 0" );
    }
    json_t* errors = json_object_get( row, "error" );
    if ( !holds_numbers( json_object_get( row, "size" ) ) || !holds_numbers( json_object_get( row, "stages" ) ) ||
         ( !json_is_null( errors ) && !holds_numbers( errors ) ) )
    {
        return wrong( error, path, number, "size, stages or error", "expected an object of numbers" );
    }
    return is_hash( json_object_get( row, "hash" ) )
               ? WISP_OK
               : wrong( error, path, number, "hash", "expected sixteen hexadecimal digits, or null" );
}

static wisp_status check( const char* path, json_t* root, wisp_error* error )
{
    json_t* version = json_object_get( root, "wisp_results" );
    if ( !json_is_integer( version ) || json_integer_value( version ) < 1 ||
         json_integer_value( version ) > RESULTS_JSON_VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: wisp_results: expected version 1 or %d", path,
                          RESULTS_JSON_VERSION );
    }
    if ( !json_is_object( json_object_get( root, "machine" ) ) ||
         !json_is_object( json_object_get( root, "build" ) ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: machine, build: expected objects", path );
    }
    json_t* rows = json_object_get( root, "rows" );
    if ( !json_is_array( rows ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: rows: expected a list", path );
    }
    wisp_status status = WISP_OK;
    for ( size_t i = 0; i < json_array_size( rows ) && status == WISP_OK; ++i )
    {
        status = check_row( path, json_array_get( rows, i ), i, error );
    }
    return status;
}

json_t* results_json_load( const char* path, wisp_error* error )
{
    json_t* root = parse( path, error );
    if ( root && check( io_input_name( path ), root, error ) != WISP_OK )
    {
        json_decref( root );
        root = NULL;
    }
    return root;
}

// ---- printing ----

static void print_object( const char* title, json_t* object, FILE* out )
{
    const char* key;
    json_t* value;
    fprintf( out, "%s\n", title );
    json_object_foreach( object, key, value )
    {
        if ( json_is_string( value ) )
        {
            fprintf( out, "  %-14s %s\n", key, json_string_value( value ) );
        }
        else if ( json_is_number( value ) )
        {
            fprintf( out, "  %-14s %.15g\n", key, json_number_value( value ) );
        }
    }
}

static const char* time_text( json_t* value, char* text, size_t size )
{
    if ( json_is_number( value ) )
    {
        snprintf( text, size, "%.4f", json_number_value( value ) );
    }
    else
    {
        snprintf( text, size, "-" );
    }
    return text;
}

static void print_row( json_t* row, FILE* out )
{
    char median[32], lower[32], upper[32];
    json_t* hash = json_object_get( row, "hash" );
    fprintf( out, "  %s/%s", json_string_value( json_object_get( row, "case" ) ),
             json_string_value( json_object_get( row, "variant" ) ) );
    const char* key;
    json_t* value;
    json_object_foreach( json_object_get( row, "size" ), key, value )
    {
        fprintf( out, " %s=%.6g", key, json_number_value( value ) );
    }
    fprintf( out, ", %lld workers: %s ms (p10 %s, p90 %s), %lld steps, hash %s\n",
             (long long)json_integer_value( json_object_get( row, "workers" ) ),
             time_text( json_object_get( row, "ms_median" ), median, sizeof( median ) ),
             time_text( json_object_get( row, "ms_p10" ), lower, sizeof( lower ) ),
             time_text( json_object_get( row, "ms_p90" ), upper, sizeof( upper ) ),
             (long long)json_integer_value( json_object_get( row, "steps" ) ),
             json_is_string( hash ) ? json_string_value( hash ) : "-" );
}

wisp_status info_results( const char* path, FILE* out, wisp_error* error )
{
    json_t* root = results_json_load( path, error );
    if ( !root )
    {
        return error->status;
    }
    json_t* rows = json_object_get( root, "rows" );
    fprintf( out, "%s: results, %zu rows\n", io_input_name( path ), json_array_size( rows ) );
    print_object( "measurement", root, out );
    print_object( "machine", json_object_get( root, "machine" ), out );
    print_object( "build", json_object_get( root, "build" ), out );
    fputs( "rows\n", out );
    for ( size_t i = 0; i < json_array_size( rows ); ++i )
    {
        print_row( json_array_get( rows, i ), out );
    }
    json_decref( root );
    return WISP_OK;
}
