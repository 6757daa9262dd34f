#include "results_read.h"

#include "io_file.h"
#include "results_write.h"

#include "wisp/module/definition.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---- the output of `wisp info` ----

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
    const json_t* hash = json_object_get( row, "hash" );
    uint64_t bits;
    return json_is_null( hash ) || results_json_take_hash( hash, &bits )
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
    for ( size_t i = 0; i < json_array_size( rows ); ++i )
    {
        WISP_TRY( check_row( path, json_array_get( rows, i ), i, error ) );
    }
    return WISP_OK;
}

// Read a file of our own schema and check it.
// @return to be released; null: the error says where the file is wrong
static json_t* load_results( const char* path, wisp_error* error )
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
    json_t* root = load_results( path, error );
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

// ---- the comparison of two files ----

#define LEVEL 0.01         // of all tests of times together
#define LEAST_NUMBER 0.005 // errors and counts that differ by less are the same

typedef enum verdict
{
    SAME,
    SLOWER,
    FASTER,
    NOT_JUDGED,
    NOT_TIMED,
} verdict;

static const char* const verdict_names[] = { "same", "slower", "faster", "not judged", "-" };

typedef struct pair
{
    json_t *before, *after; // rows; `before` is null for a row that is new
    double ratio;           // of medians, after over before; NaN without both
    double p;               // of the test of ranks; NaN without samples on both sides
    verdict times;
    bool has_other_bits;
} pair;

typedef struct comparison
{
    json_t *before, *after; // files
    pair* pairs;            // [count] the rows of `after` in their order
    int count;
    int gone; // rows of `before` without a partner
    bool is_comparable;
    double least;
    int number_table; // -1: no number differs yet
    results* out;
} comparison;

// ---- rows ----

static const char* text_of( const json_t* object, const char* key )
{
    const char* text = json_string_value( json_object_get( object, key ) );
    return text ? text : "";
}

static double number_of( const json_t* object, const char* key )
{
    const json_t* value = json_object_get( object, key );
    return json_is_number( value ) ? json_number_value( value ) : NAN;
}

static void label( const json_t* row, char* out, size_t size )
{
    snprintf( out, size, "%s/%s", text_of( row, "case" ), text_of( row, "variant" ) );
}

static bool are_partners( json_t* a, json_t* b )
{
    const char* const texts[] = { "case", "variant" };
    for ( int i = 0; i < WISP_COUNT( texts ); ++i )
    {
        if ( strcmp( text_of( a, texts[i] ), text_of( b, texts[i] ) ) != 0 )
        {
            return false;
        }
    }
    void* first_a = json_object_iter( json_object_get( a, "size" ) );
    void* first_b = json_object_iter( json_object_get( b, "size" ) );
    const bool have_size = first_a && first_b;
    return json_equal( json_object_get( a, "workers" ), json_object_get( b, "workers" ) ) &&
           ( !have_size || json_equal( json_object_iter_value( first_a ), json_object_iter_value( first_b ) ) );
}

static wisp_status match_rows( comparison* c, wisp_error* error )
{
    json_t* old_rows = json_object_get( c->before, "rows" );
    json_t* new_rows = json_object_get( c->after, "rows" );
    const size_t old_count = json_array_size( old_rows ), new_count = json_array_size( new_rows );
    bool* is_taken = calloc( old_count + 1, sizeof *is_taken );
    c->pairs = calloc( new_count + 1, sizeof *c->pairs );
    if ( !is_taken || !c->pairs )
    {
        free( is_taken );
        return wisp_fail( error, WISP_NO_MEMORY, "compare: out of memory for %zu rows", new_count );
    }
    c->count = (int)new_count;
    c->gone = (int)old_count;
    for ( int i = 0; i < c->count; ++i )
    {
        pair* p = &c->pairs[i];
        *p = ( pair ){ .after = json_array_get( new_rows, (size_t)i ), .ratio = NAN, .p = NAN, .times = NOT_TIMED };
        for ( size_t k = 0; k < old_count && !p->before; ++k )
        {
            if ( !is_taken[k] && are_partners( json_array_get( old_rows, k ), p->after ) )
            {
                is_taken[k] = true;
                p->before = json_array_get( old_rows, k );
                c->gone -= 1;
            }
        }
    }
    free( is_taken );
    return WISP_OK;
}

// ---- times ----

static int samples_of( json_t* row, double samples[STATS_MAX_KEPT] )
{
    json_t* list = json_object_get( row, "samples_ms" );
    int count = 0;
    for ( ; count < STATS_MAX_KEPT && count < (int)json_array_size( list ); ++count )
    {
        samples[count] = json_number_value( json_array_get( list, (size_t)count ) );
    }
    return count;
}

static void test_times( pair* p )
{
    double before[STATS_MAX_KEPT], after[STATS_MAX_KEPT];
    p->ratio = number_of( p->after, "ms_median" ) / number_of( p->before, "ms_median" );
    const int before_count = samples_of( p->before, before ), after_count = samples_of( p->after, after );
    if ( isfinite( p->ratio ) && before_count >= 4 && after_count >= 4 )
    {
        p->p = stats_rank_sum( before, before_count, after, after_count );
    }
}

static void judge( const comparison* c, pair* p, bool is_significant )
{
    const bool is_large = fabs( log( p->ratio ) ) >= log1p( c->least );
    p->times = !isfinite( p->ratio )          ? NOT_TIMED
               : !c->is_comparable            ? NOT_JUDGED
               : !is_large || !is_significant ? SAME
               : p->ratio > 1.0               ? SLOWER
                                              : FASTER;
}

static wisp_status judge_times( comparison* c, wisp_error* error )
{
    double* p = malloc( ( (size_t)c->count + 1 ) * sizeof *p );
    bool* is_significant = malloc( (size_t)c->count + 1 );
    int tests = 0;
    for ( int i = 0; i < c->count && p && is_significant; ++i )
    {
        if ( c->pairs[i].before )
        {
            test_times( &c->pairs[i] );
        }
        p[i] = c->pairs[i].p;
        tests += isfinite( p[i] ) ? 1 : 0;
    }
    if ( p && is_significant )
    {
        stats_holm( p, c->count, tests, LEVEL, is_significant );
        for ( int i = 0; i < c->count; ++i )
        {
            judge( c, &c->pairs[i], is_significant[i] || isnan( p[i] ) );
        }
    }
    const bool is_done = p && is_significant;
    free( p );
    free( is_significant );
    return is_done ? WISP_OK : wisp_fail( error, WISP_NO_MEMORY, "compare: out of memory for %d rows", c->count );
}

// ---- numbers that do not depend on time ----

static void add_number( comparison* c, json_t* row, const char* group, const char* key, double before, double after )
{
    if ( c->number_table < 0 )
    {
        c->number_table = results_begin_table( c->out, "Numbers that differ", "row\tnumber\tbefore\tafter\tchange" );
    }
    char name[300];
    label( row, name, sizeof name );
    results_add_line( c->out, c->number_table,
                      before != 0.0 && isfinite( after / before ) ? "%s\t%s.%s\t%.6g\t%.6g\t%+.2f %%"
                                                                  : "%s\t%s.%s\t%.6g\t%.6g\t-",
                      name, group, key, before, after, 100.0 * ( after / before - 1.0 ) );
}

// Sizes may hold times and ratios of times, such as `ms_mean` and `ns_per_link`, which nobody can compare without samples.
static bool is_of_time( const char* key )
{
    static const char* const words[] = { "ms", "us", "ns", "ratio", "times", "rate", "seconds" };
    while ( *key )
    {
        const size_t length = strcspn( key, "_." );
        for ( int i = 0; i < WISP_COUNT( words ); ++i )
        {
            if ( length == strlen( words[i] ) && strncmp( key, words[i], length ) == 0 )
            {
                return true;
            }
        }
        key += length + ( key[length] != '\0' );
    }
    return false;
}

// @return how many differ
static int compare_numbers( comparison* c, const pair* p, const char* group )
{
    int count = 0;
    json_t* before = json_object_get( p->before, group );
    json_t* value;
    const char* key;
    json_object_foreach( json_object_get( p->after, group ), key, value )
    {
        const double a = number_of( before, key ), b = json_is_number( value ) ? json_number_value( value ) : NAN;
        const bool is_same = ( isnan( a ) && isnan( b ) ) || fabs( b - a ) <= LEAST_NUMBER * fabs( a );
        if ( !is_of_time( key ) && !is_same )
        {
            add_number( c, p->after, group, key, a, b );
            ++count;
        }
    }
    return count;
}

// ---- the report ----

static void add_time_line( comparison* c, int table, const pair* p )
{
    char name[300], count[12], change[40];
    const double before = number_of( p->before, "ms_median" ), after = number_of( p->after, "ms_median" );
    const int workers = (int)json_integer_value( json_object_get( p->after, "workers" ) );
    label( p->after, name, sizeof name );
    snprintf( count, sizeof count, workers > 0 ? "%d" : "-", workers );
    snprintf( change, sizeof change, isfinite( p->ratio ) ? "%+.1f %%" : "-", 100.0 * ( p->ratio - 1.0 ) );
    results_add_line( c->out, table, "%s\t%s\t%.4g\t%.4g\t%s\t%.2g\t%s\t%s", name, count, before, after, change, p->p,
                      p->before ? verdict_names[p->times] : "new",
                      !p->before          ? "-"
                      : p->has_other_bits ? "differ"
                                          : "same" );
}

static void add_row( comparison* c, const pair* p )
{
    results_row* row = results_add_row( c->out, text_of( p->after, "case" ), text_of( p->after, "variant" ) );
    if ( row )
    {
        row->workers = (int)json_integer_value( json_object_get( p->after, "workers" ) );
        results_put( &row->size, "ms_before", number_of( p->before, "ms_median" ) );
        results_put( &row->size, "ms_after", number_of( p->after, "ms_median" ) );
        results_put( &row->size, "ratio", p->ratio );
        results_put( &row->size, "p", p->p );
        results_put( &row->size, "is_slower", p->times == SLOWER );
        results_put( &row->size, "is_faster", p->times == FASTER );
        results_put( &row->size, "bits_differ", p->has_other_bits );
    }
}

static void add_difference( comparison* c, const char* what, const char* object, const char* key, bool prevents )
{
    const char* before = text_of( json_object_get( c->before, object ), key );
    const char* after = text_of( json_object_get( c->after, object ), key );
    if ( strcmp( before, after ) != 0 )
    {
        c->is_comparable = c->is_comparable && !prevents;
        results_add_note( c->out, "%s: %s before, %s after%s", what, before, after,
                          prevents ? "; times are not judged" : "" );
    }
}

static const char* date_of( const json_t* file )
{
    const char* date = text_of( file, "date" );
    return date[0] ? date : "no date";
}

static void add_head( comparison* c, const char* before, const char* after, int numbers )
{
    int slower = 0, faster = 0, bits = 0, fresh = 0;
    for ( int i = 0; i < c->count; ++i )
    {
        slower += c->pairs[i].times == SLOWER;
        faster += c->pairs[i].times == FASTER;
        bits += c->pairs[i].has_other_bits;
        fresh += c->pairs[i].before == NULL;
    }
    char line[200] = "";
    results_append_count( line, sizeof line, slower, "slower" );
    results_append_count( line, sizeof line, faster, "faster" );
    results_append_count( line, sizeof line, bits, "with other bits" );
    results_append_count( line, sizeof line, numbers, "numbers that differ" );
    results_append_count( line, sizeof line, fresh, "new" );
    results_append_count( line, sizeof line, c->gone, "gone" );
    results_add_headline( c->out, "rows: %d; %s.", c->count, line[0] ? line + 2 : "nothing differs" );
    results_add_headline( c->out, "before: %s, %s; after: %s, %s", before, date_of( c->before ), after,
                          date_of( c->after ) );
    results_add_note( c->out,
                      "A time differs if its median moved by %.3g %% or more and a test of ranks agrees at %.2g over "
                      "all rows; rows without samples are judged by their medians.",
                      100.0 * c->least, LEVEL );
}

static wisp_status compare( comparison* c, const char* before, const char* after, wisp_error* error )
{
    add_difference( c, "processor", "machine", "cpu", true );
    add_difference( c, "instruction set", "machine", "isa", true );
    add_difference( c, "compiler", "build", "compiler", false );
    add_difference( c, "flags", "build", "flags", false );
    add_difference( c, "build type", "build", "type", true );
    add_difference( c, "version", "build", "version", false );
    add_difference( c, "commit", "build", "commit", false );
    if ( strcmp( text_of( c->before, "options" ), text_of( c->after, "options" ) ) != 0 )
    {
        results_add_note( c->out, "options: %s before, %s after", text_of( c->before, "options" ),
                          text_of( c->after, "options" ) );
    }
    WISP_TRY( match_rows( c, error ) );
    WISP_TRY( judge_times( c, error ) );
    const int times =
        results_begin_table( c->out, "Times", "row\tworkers\tms before\tms after\tchange\tp\ttimes\tbits" );
    int numbers = 0;
    for ( int i = 0; i < c->count; ++i )
    {
        pair* p = &c->pairs[i];
        if ( p->before )
        {
            json_t *a = json_object_get( p->before, "hash" ), *b = json_object_get( p->after, "hash" );
            p->has_other_bits = json_is_string( a ) && json_is_string( b ) && !json_equal( a, b );
            numbers += compare_numbers( c, p, "error" ) + compare_numbers( c, p, "size" );
        }
        add_time_line( c, times, p );
        add_row( c, p );
    }
    add_head( c, before, after, numbers );
    return WISP_OK;
}

wisp_status results_compare( const char* before, const char* after, double least, results* out, wisp_error* error )
{
    comparison c = {
        .before = load_results( before, error ), .is_comparable = true, .least = least, .number_table = -1, .out = out
    };
    c.after = c.before ? load_results( after, error ) : NULL;
    wisp_status status = c.after ? compare( &c, before, after, error ) : error->status;
    free( c.pairs );
    json_decref( c.before );
    json_decref( c.after );
    return status;
}
