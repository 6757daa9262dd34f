// Results in the formats of other programs.
#include "results_json.h"

#include <math.h>
#include <string.h>

// ---- google-benchmark ----

// The keys that google-benchmark's own tools and Bencher's reader insist on.
static json_t* context_object( const results* all )
{
    const machine_info* machine = &all->machine;
    json_t* object = json_object();
    json_object_set_new( object, "date", json_string( machine->date ) );
    json_object_set_new( object, "host_name", results_json_text( machine->host ) );
    json_object_set_new( object, "executable", json_string( "wisp" ) );
    json_object_set_new( object, "num_cpus", json_integer( machine->cores ) );
    json_object_set_new( object, "mhz_per_cpu", json_integer( (json_int_t)lrint( machine->mhz ) ) );
    json_object_set_new( object, "cpu_scaling_enabled", json_false() );
    json_object_set_new( object, "caches", json_array() );
    json_object_set_new( object, "load_avg", json_array() );
    json_object_set_new( object, "library_build_type",
                         json_string( strcmp( machine->build_type, "debug" ) == 0 ? "debug" : "release" ) );
    json_object_set_new( object, "cpu_model", results_json_text( machine->cpu ) );
    json_object_set_new( object, "wisp_version", results_json_text( machine->version ) );
    json_object_set_new( object, "wisp_commit", results_json_text( machine->commit ) );
    json_object_set_new( object, "wisp_isa", results_json_text( machine->isa ) );
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
        json_object_set_new( object, key, results_json_number( values->items[i].value ) );
    }
}

// Rows without samples, such as times printed in a paper, are not benchmark runs.
static bool is_timed( const results_row* row )
{
    return row->steps > 0 && isfinite( row->ms_median );
}

// Processor time is that of all threads. Where nobody measured it, it is the wall time.
static double cpu_time( const results_row* row, double ms )
{
    return isfinite( row->cpu_fraction ) ? row->cpu_fraction * ms : ms;
}

static int repetitions( const results_row* row )
{
    return row->sample_count > 0 ? row->sample_count : 1;
}

// A row without samples of its own has its median as the only one.
static double sample_ms( const results_row* row, int i )
{
    return row->sample_count > 0 ? row->samples_ms[i] : row->ms_median;
}

typedef struct statistics
{
    double mean, deviation, least, most; // ms
} statistics;

static statistics take_statistics( const results_row* row )
{
    const int count = repetitions( row );
    statistics s = { .least = sample_ms( row, 0 ), .most = sample_ms( row, 0 ) };
    for ( int i = 0; i < count; ++i )
    {
        s.mean += sample_ms( row, i ) / count;
        s.least = fmin( s.least, sample_ms( row, i ) );
        s.most = fmax( s.most, sample_ms( row, i ) );
    }
    for ( int i = 0; i < count && count > 1; ++i )
    {
        const double away = sample_ms( row, i ) - s.mean;
        s.deviation += away * away / ( count - 1 );
    }
    s.deviation = sqrt( s.deviation );
    return s;
}

static json_t* benchmark_head( const results_row* row, int family, const char* suffix, double ms )
{
    char run_name[320], name[340];
    benchmark_name( row, run_name, sizeof run_name );
    snprintf( name, sizeof name, "%s%s", run_name, suffix );
    json_t* object = json_object();
    json_object_set_new( object, "name", results_json_text( name ) );
    json_object_set_new( object, "family_index", json_integer( family ) );
    json_object_set_new( object, "per_family_instance_index", json_integer( 0 ) );
    json_object_set_new( object, "run_name", results_json_text( run_name ) );
    json_object_set_new( object, "repetitions", json_integer( repetitions( row ) ) );
    json_object_set_new( object, "threads", json_integer( row->workers > 0 ? row->workers : 1 ) );
    json_object_set_new( object, "real_time", results_json_number( 1e6 * ms ) );
    json_object_set_new( object, "cpu_time", results_json_number( 1e6 * cpu_time( row, ms ) ) );
    // compare.py prints whole numbers
    json_object_set_new( object, "time_unit", json_string( "ns" ) );
    return object;
}

static void add_samples( json_t* benchmarks, const results_row* row, int family )
{
    for ( int i = 0; i < repetitions( row ); ++i )
    {
        json_t* object = benchmark_head( row, family, "", sample_ms( row, i ) );
        json_object_set_new( object, "run_type", json_string( "iteration" ) );
        json_object_set_new( object, "repetition_index", json_integer( i ) );
        json_object_set_new( object, "iterations", json_integer( row->sample_count > 0 ? 1 : row->steps ) );
        if ( i == 0 ) // the same for all of them
        {
            add_counters( object, "size.", &row->size );
            add_counters( object, "ms.", &row->stages );
            add_counters( object, "error.", &row->error );
        }
        if ( row->has_hash )
        {
            json_object_set_new( object, "label", results_json_hash( row ) );
        }
        json_array_append_new( benchmarks, object );
    }
}

static void add_aggregates( json_t* benchmarks, const results_row* row, int family )
{
    const statistics s = take_statistics( row );
    const struct
    {
        const char* name;
        double value;
    } all[] = { { "mean", s.mean }, { "median", row->ms_median }, { "stddev", s.deviation } };
    for ( int i = 0; i < WISP_COUNT( all ) && row->sample_count > 1; ++i )
    {
        char suffix[16];
        snprintf( suffix, sizeof suffix, "_%s", all[i].name );
        json_t* object = benchmark_head( row, family, suffix, all[i].value );
        json_object_set_new( object, "run_type", json_string( "aggregate" ) );
        json_object_set_new( object, "aggregate_name", json_string( all[i].name ) );
        json_object_set_new( object, "aggregate_unit", json_string( "time" ) );
        json_object_set_new( object, "iterations", json_integer( row->sample_count ) );
        json_array_append_new( benchmarks, object );
    }
}

wisp_status results_write_gbench( const results* all, FILE* stream, wisp_error* error )
{
    json_t* benchmarks = json_array();
    for ( int i = 0, family = 0; i < all->row_count; ++i )
    {
        if ( is_timed( &all->rows[i] ) )
        {
            add_samples( benchmarks, &all->rows[i], family );
            add_aggregates( benchmarks, &all->rows[i], family++ );
        }
    }
    json_t* root = json_object();
    json_object_set_new( root, "context", context_object( all ) );
    json_object_set_new( root, "benchmarks", benchmarks );
    return results_json_dump( root, stream, error );
}

// ---- services that follow a number ----

static json_t* metric( double value, double lower, double upper )
{
    json_t* object = json_object();
    json_object_set_new( object, "value", results_json_number( value ) );
    if ( isfinite( lower ) && isfinite( upper ) )
    {
        json_object_set_new( object, "lower_value", results_json_number( lower ) );
        json_object_set_new( object, "upper_value", results_json_number( upper ) );
    }
    return object;
}

// A name is a key there, so a second row of the same name gets its number.
static void set_by_name( json_t* root, const results_row* row, json_t* value )
{
    char name[320], key[340];
    benchmark_name( row, name, sizeof name );
    snprintf( key, sizeof key, "%s", name );
    for ( int i = 2; json_object_get( root, key ); ++i )
    {
        snprintf( key, sizeof key, "%s (%d)", name, i );
    }
    json_object_set_new( root, key, value );
}

// Measures are slugs there: small letters, digits and dashes.
static void put_errors( json_t* measures, const results_values* errors )
{
    for ( int i = 0; i < errors->count; ++i )
    {
        char slug[80] = "error-";
        size_t used = strlen( slug );
        for ( const char* c = errors->items[i].name; *c && used + 1 < sizeof slug; ++c )
        {
            slug[used++] = strchr( "abcdefghijklmnopqrstuvwxyz0123456789", *c ) ? *c : '-';
        }
        slug[used] = '\0';
        if ( isfinite( errors->items[i].value ) )
        {
            json_object_set_new( measures, slug, metric( errors->items[i].value, NAN, NAN ) );
        }
    }
}

wisp_status results_write_bencher( const results* all, FILE* stream, wisp_error* error )
{
    json_t* root = json_object();
    for ( int i = 0; i < all->row_count; ++i )
    {
        const results_row* row = &all->rows[i];
        json_t* measures = json_object();
        if ( is_timed( row ) )
        {
            json_object_set_new( measures, "latency",
                                 metric( 1e6 * row->ms_median, 1e6 * row->ms_p10, 1e6 * row->ms_p90 ) );
        }
        put_errors( measures, &row->error );
        set_by_name( root, row, measures );
    }
    return results_json_dump( root, stream, error );
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

static json_t* seconds_array( const results_row* row )
{
    json_t* array = json_array();
    for ( int i = 0; i < repetitions( row ); ++i )
    {
        json_array_append_new( array, results_json_number( 1e-3 * sample_ms( row, i ) ) );
    }
    return array;
}

wisp_status results_write_hyperfine( const results* all, FILE* stream, wisp_error* error )
{
    json_t* list = json_array();
    for ( int i = 0; i < all->row_count; ++i )
    {
        const results_row* row = &all->rows[i];
        char name[320];
        if ( !is_timed( row ) )
        {
            continue;
        }
        benchmark_name( row, name, sizeof name );
        const statistics s = take_statistics( row );
        json_t* object = json_object();
        json_object_set_new( object, "command", results_json_text( name ) );
        json_object_set_new( object, "mean", results_json_number( 1e-3 * s.mean ) );
        json_object_set_new( object, "stddev", results_json_number( 1e-3 * s.deviation ) );
        json_object_set_new( object, "median", results_json_number( 1e-3 * row->ms_median ) );
        json_object_set_new( object, "user", results_json_number( 1e-3 * cpu_time( row, s.mean ) ) );
        json_object_set_new( object, "system", json_real( 0.0 ) ); // steps make no system calls to speak of
        json_object_set_new( object, "min", results_json_number( 1e-3 * s.least ) );
        json_object_set_new( object, "max", results_json_number( 1e-3 * s.most ) );
        json_object_set_new( object, "times", seconds_array( row ) );
        json_t* codes = json_array();
        for ( int k = 0; k < repetitions( row ); ++k )
        {
            json_array_append_new( codes, json_integer( 0 ) );
        }
        json_object_set_new( object, "exit_codes", codes );
        json_array_append_new( list, object );
    }
    json_t* root = json_object();
    json_object_set_new( root, "results", list );
    return results_json_dump( root, stream, error );
}
