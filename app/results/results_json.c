#include "results_json.h"

#include <jansson.h>
#include <math.h>
#include <string.h>
#include <time.h>

// JSON has no NaN: a number that nobody knows is null.
static json_t* number_or_null( double value )
{
    return isfinite( value ) ? json_real( value ) : json_null();
}

// Counts read better as 20 than as 20.0. Beyond 2^53 a double is no count any more.
static json_t* count_or_real( double value )
{
    return value == floor( value ) && fabs( value ) < 0x1p53 ? json_integer( (json_int_t)value )
                                                             : number_or_null( value );
}

// Text of unknown origin, such as a file's name, may not be UTF-8, which JSON refuses.
static json_t* text( const char* value )
{
    json_t* string = json_string( value );
    return string ? string : json_string( "(not UTF-8)" );
}

static json_t* values_object( const results_values* values )
{
    json_t* object = json_object();
    for ( int i = 0; i < values->count; ++i )
    {
        json_object_set_new( object, values->items[i].name, count_or_real( values->items[i].value ) );
    }
    return object;
}

static json_t* error_object( const results_row* row )
{
    if ( !row->error_reference[0] )
    {
        return json_null();
    }
    json_t* object = values_object( &row->error );
    json_object_set_new( object, "against", text( row->error_reference ) );
    return object;
}

// A hash is 64 bits and a JSON integer 63, so it travels as sixteen hexadecimal digits.
static json_t* hash_string( const results_row* row )
{
    if ( !row->has_hash )
    {
        return json_null();
    }
    char digits[17];
    snprintf( digits, sizeof( digits ), "%016llx", (unsigned long long)row->hash );
    return json_string( digits );
}

static json_t* row_object( const results_row* row )
{
    json_t* object = json_object();
    json_object_set_new( object, "case", text( row->name ) );
    json_object_set_new( object, "variant", text( row->variant ) );
    json_object_set_new( object, "size", values_object( &row->size ) );
    json_object_set_new( object, "workers", json_integer( row->workers ) );
    json_object_set_new( object, "ms_median", number_or_null( row->ms_median ) );
    json_object_set_new( object, "ms_p10", number_or_null( row->ms_p10 ) );
    json_object_set_new( object, "ms_p90", number_or_null( row->ms_p90 ) );
    json_object_set_new( object, "steps", json_integer( row->steps ) );
    json_object_set_new( object, "stages", values_object( &row->stages ) );
    json_object_set_new( object, "error", error_object( row ) );
    json_object_set_new( object, "hash", hash_string( row ) );
    return object;
}

static json_t* machine_object( const machine_info* machine )
{
    json_t* object = json_object();
    json_object_set_new( object, "cpu", text( machine->cpu ) );
    json_object_set_new( object, "cores", json_integer( machine->cores ) );
    json_object_set_new( object, "memory_bytes", count_or_real( machine->memory_bytes ) );
    json_object_set_new( object, "os", text( machine->os ) );
    json_object_set_new( object, "isa", text( machine->isa ) );
    return object;
}

static json_t* build_object( const machine_info* machine )
{
    json_t* object = json_object();
    json_object_set_new( object, "version", text( machine->version ) );
    json_object_set_new( object, "commit", text( machine->commit ) );
    json_object_set_new( object, "compiler", text( machine->compiler ) );
    json_object_set_new( object, "flags", text( machine->flags ) );
    json_object_set_new( object, "type", text( machine->build_type ) );
    return object;
}

// jansson's constructors hand on the null of a failed allocation, so one look at the dump is enough.
static wisp_status dump( json_t* root, FILE* stream, wisp_error* error )
{
    int failed = json_dumpf( root, stream, JSON_INDENT( 2 ) | JSON_REAL_PRECISION( 9 ) );
    json_decref( root );
    if ( failed || fputc( '\n', stream ) == EOF )
    {
        return wisp_fail( error, WISP_IO_ERROR, "the results could not be written as JSON" );
    }
    return WISP_OK;
}

// A list of labels and values has a note for each line.
static void add_labels( json_t* notes, const results_table* table )
{
    for ( int row = 1; row < table->row_count; ++row )
    {
        char line[400];
        snprintf( line, sizeof( line ), "%s: %s", results_cell( table, row, 0 ), results_cell( table, row, 1 ) );
        json_array_append_new( notes, text( line ) );
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
    for ( int t = 0; t < all->table_count; ++t )
    {
        if ( all->tables[t].title[0] == '\0' )
        {
            add_labels( notes, &all->tables[t] );
        }
    }
    for ( int i = 0; i < all->note_count; ++i )
    {
        json_array_append_new( notes, text( all->notes[i] ) );
    }
    json_t* root = json_object();
    json_object_set_new( root, "wisp_results", json_integer( 1 ) );
    json_object_set_new( root, "machine", machine_object( &all->machine ) );
    json_object_set_new( root, "build", build_object( &all->machine ) );
    json_object_set_new( root, "rows", rows );
    json_object_set_new( root, "notes", notes );
    return dump( root, stream, error );
}

// The keys that google-benchmark's own tools and Bencher's reader insist on.
static json_t* context_object( const results* all )
{
    char date[40] = "";
    time_t now = time( NULL );
    struct tm utc;
    if ( gmtime_r( &now, &utc ) )
    {
        strftime( date, sizeof( date ), "%Y-%m-%dT%H:%M:%S+00:00", &utc );
    }
    const machine_info* machine = &all->machine;
    json_t* object = json_object();
    json_object_set_new( object, "date", json_string( date ) );
    json_object_set_new( object, "host_name", text( machine->host ) );
    json_object_set_new( object, "executable", json_string( "wisp" ) );
    json_object_set_new( object, "num_cpus", json_integer( machine->cores ) );
    json_object_set_new( object, "mhz_per_cpu", json_integer( (json_int_t)lrint( machine->mhz ) ) );
    json_object_set_new( object, "cpu_scaling_enabled", json_false() );
    json_object_set_new( object, "caches", json_array() );
    json_object_set_new( object, "load_avg", json_array() );
    json_object_set_new( object, "library_build_type",
                         json_string( strcmp( machine->build_type, "debug" ) == 0 ? "debug" : "release" ) );
    json_object_set_new( object, "cpu_model", text( machine->cpu ) );
    json_object_set_new( object, "wisp_version", text( machine->version ) );
    json_object_set_new( object, "wisp_commit", text( machine->commit ) );
    json_object_set_new( object, "wisp_isa", text( machine->isa ) );
    return object;
}

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

// In this format a counter is a key beside the times; the prefix keeps ours from meeting one of theirs.
static void add_counters( json_t* object, const char* prefix, const results_values* values )
{
    for ( int i = 0; i < values->count; ++i )
    {
        char key[100];
        snprintf( key, sizeof( key ), "%s%s", prefix, values->items[i].name );
        json_object_set_new( object, key, number_or_null( values->items[i].value ) );
    }
}

static json_t* benchmark_object( const results_row* row, int index )
{
    char name[320];
    benchmark_name( row, name, sizeof( name ) );
    json_t* object = json_object();
    json_object_set_new( object, "name", text( name ) );
    json_object_set_new( object, "family_index", json_integer( index ) );
    json_object_set_new( object, "per_family_instance_index", json_integer( 0 ) );
    json_object_set_new( object, "run_name", text( name ) );
    json_object_set_new( object, "run_type", json_string( "iteration" ) );
    json_object_set_new( object, "repetitions", json_integer( 1 ) );
    json_object_set_new( object, "repetition_index", json_integer( 0 ) );
    json_object_set_new( object, "threads", json_integer( row->workers > 0 ? row->workers : 1 ) );
    json_object_set_new( object, "iterations", json_integer( row->steps ) );
    json_object_set_new( object, "real_time", json_real( row->ms_median ) );
    json_object_set_new( object, "cpu_time", json_real( row->ms_median ) );
    json_object_set_new( object, "time_unit", json_string( "ms" ) );
    json_object_set_new( object, "ms_p10", number_or_null( row->ms_p10 ) );
    json_object_set_new( object, "ms_p90", number_or_null( row->ms_p90 ) );
    add_counters( object, "size.", &row->size );
    add_counters( object, "ms.", &row->stages );
    add_counters( object, "error.", &row->error );
    if ( row->has_hash )
    {
        json_object_set_new( object, "label", hash_string( row ) );
    }
    return object;
}

wisp_status results_write_gbench( const results* all, FILE* stream, wisp_error* error )
{
    json_t* benchmarks = json_array();
    for ( int i = 0; i < all->row_count; ++i )
    {
        // Rows without samples, such as times printed in a paper, are not benchmark runs.
        if ( all->rows[i].steps > 0 && isfinite( all->rows[i].ms_median ) )
        {
            int index = (int)json_array_size( benchmarks );
            json_array_append_new( benchmarks, benchmark_object( &all->rows[i], index ) );
        }
    }
    json_t* root = json_object();
    json_object_set_new( root, "context", context_object( all ) );
    json_object_set_new( root, "benchmarks", benchmarks );
    return dump( root, stream, error );
}
