#include "sweep_part.h"

#include "io_file.h"
#include "results_write.h"
#include "wisp/wisp.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

// ---- shards ----

// @return -1: not a whole number from 0 on
static int whole_in( const char* text )
{
    char* end = NULL;
    const long value = text != NULL && text[0] >= '0' && text[0] <= '9' ? strtol( text, &end, 10 ) : -1;
    return end != NULL && *end == '\0' && value <= 1000000000 ? (int)value : -1;
}

static wisp_status check_shard( const sweep_shard* shard, wisp_error* error )
{
    if ( shard->count < 1 || shard->count > SWEEP_MAX_SHARDS )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got %d shards, expected 1 to %d", shard->count,
                          SWEEP_MAX_SHARDS );
    }
    if ( shard->index < 0 || shard->index >= shard->count )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "--shard: got shard %d of %d, expected 1 to %d", shard->index + 1,
                          shard->count, shard->count );
    }
    return WISP_OK;
}

wisp_status sweep_shard_parse( const char* text, sweep_shard* out, wisp_error* error )
{
    char first[16];
    const char* slash = strchr( text, '/' );
    snprintf( first, sizeof first, "%.*s", slash ? (int)( slash - text ) : 0, text );
    const int index = slash && slash - text < (int)sizeof first ? whole_in( first ) : -1;
    const int count = slash ? whole_in( slash + 1 ) : -1;
    *out = ( sweep_shard ){ .index = index - 1, .count = count };
    return index < 0 || count < 0
               ? wisp_fail( error, WISP_BAD_INPUT, "--shard: got '%.40s', expected a share such as 2/8", text )
               : check_shard( out, error );
}

// ---- records ----

// Numbers have 17 digits, so that a record that is read is the one that was written, bit for bit.

// ---- values ----

// A number of JSON, with infinity as "inf" and NaN as null.
static json_t* json_of( double value )
{
    return isnan( value )   ? json_null()
           : isinf( value ) ? json_string( value > 0.0 ? "inf" : "-inf" )
                            : json_real( value );
}

// @return NaN: it is none
static double number_of( const json_t* value )
{
    const char* text = json_string_value( value );
    return text != NULL              ? strcmp( text, "inf" ) == 0    ? INFINITY
                                       : strcmp( text, "-inf" ) == 0 ? -INFINITY
                                                                     : NAN
           : json_is_number( value ) ? json_number_value( value )
                                     : NAN;
}

// @return -1: it is no whole number in the range
static int whole_of( const json_t* value, int least, int most )
{
    const json_int_t number = json_integer_value( value );
    return json_is_integer( value ) && number >= least && number <= most ? (int)number : -1;
}

static json_t* json_of_hash( uint64_t hash )
{
    char text[24];
    snprintf( text, sizeof text, "%016llx", (unsigned long long)hash );
    return json_string( text );
}

// A hash of JSON, sixteen hexadecimal digits. @return false: it is none
static bool hash_of( const json_t* value, uint64_t* out )
{
    const char* text = json_string_value( value );
    if ( text == NULL || strlen( text ) != 16 || strspn( text, "0123456789abcdef" ) != 16 )
    {
        return false;
    }
    *out = strtoull( text, NULL, 16 );
    return true;
}

// Copy a text. @return false: it is none, or too long
static bool text_of( const json_t* value, char* out, size_t size )
{
    const char* text = json_string_value( value );
    return text != NULL && (size_t)snprintf( out, size, "%s", text ) < size;
}

// ---- the comparison ----

static const char* const comparison_names[] = { "distance", "largest", "at_0.5", "at_1", "at_2", "detail", "energy" };

static void list_comparison( suite_comparison* c, double* out[WISP_COUNT( comparison_names )] )
{
    double* const all[] = { &c->distance, &c->largest, c->at, c->at + 1, c->at + 2, &c->detail, &c->energy };
    memcpy( out, all, sizeof all );
}

static void put_comparison( json_t* object, const suite_comparison* compared )
{
    suite_comparison c = *compared;
    double* all[WISP_COUNT( comparison_names )];
    list_comparison( &c, all );
    json_t* out = json_object();
    bool any = false;
    for ( int i = 0; i < WISP_COUNT( comparison_names ); ++i )
    {
        any = any || !isnan( *all[i] );
        json_object_set_new( out, comparison_names[i], json_of( *all[i] ) );
    }
    if ( any )
    {
        json_object_set_new( object, "compared", out );
        return;
    }
    json_decref( out );
}

// ---- a line ----

static json_t* times_of( const sweep_record* r )
{
    json_t* list = json_array();
    for ( int i = 0; i < r->time_count; ++i )
    {
        const sweep_time* t = r->times + i;
        json_t* one = json_object();
        json_object_set_new( one, "workers", json_integer( t->workers ) );
        json_object_set_new( one, "steps", json_integer( t->steps ) );
        json_object_set_new( one, "median", json_of( t->median ) );
        json_object_set_new( one, "p10", json_of( t->p10 ) );
        json_object_set_new( one, "p90", json_of( t->p90 ) );
        json_array_append_new( list, one );
    }
    return list;
}

char* sweep_record_write( const sweep_record* r )
{
    json_t* object = json_object();
    json_object_set_new( object, "item", json_integer( r->item ) );
    json_object_set_new( object, "key", json_of_hash( r->key ) );
    json_object_set_new( object, "case", results_json_text( r->name ) );
    json_object_set_new( object, "variant", results_json_text( r->variant ) );
    if ( r->series[0] != '\0' )
    {
        json_object_set_new( object, "series", results_json_text( r->series ) );
        json_object_set_new( object, "along", results_json_text( r->along ) );
        json_object_set_new( object, "along_value", json_of( r->along_value ) );
        json_object_set_new( object, "order", json_of( r->order ) );
    }
    json_object_set_new( object, "steps", json_integer( r->steps ) );
    json_object_set_new( object, "hash", json_of_hash( r->hash ) );
    json_t* values = json_object();
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        if ( !isnan( r->values[m] ) )
        {
            json_object_set_new( values, suite_measures[m].name, json_of( r->values[m] ) );
        }
    }
    json_object_set_new( object, "values", values );
    put_comparison( object, &r->compared );
    if ( r->verdict[0] != '\0' )
    {
        json_object_set_new( object, "verdict", results_json_text( r->verdict ) );
        json_object_set_new( object, "known", json_boolean( r->is_known ) );
    }
    if ( r->failure[0] != '\0' )
    {
        json_object_set_new( object, "failure", results_json_text( r->failure ) );
    }
    if ( r->time_count > 0 )
    {
        json_object_set_new( object, "vertices", json_integer( r->vertices ) );
        json_object_set_new( object, "substeps", json_integer( r->substeps ) );
        json_object_set_new( object, "ms", times_of( r ) );
    }
    char* line = json_dumps( object, JSON_COMPACT | JSON_REAL_PRECISION( 17 ) );
    json_decref( object );
    return line;
}

static bool read_times( const json_t* object, sweep_record* out )
{
    const json_t* list = json_object_get( object, "ms" );
    const size_t count = json_array_size( list );
    for ( size_t i = 0; i < count && i < SWEEP_MAX_TIMES; ++i )
    {
        const json_t* one = json_array_get( list, i );
        out->times[out->time_count++] = ( sweep_time ){
            .workers = whole_of( json_object_get( one, "workers" ), 1, 1 << 20 ),
            .steps = whole_of( json_object_get( one, "steps" ), 0, 1000000000 ),
            .median = number_of( json_object_get( one, "median" ) ),
            .p10 = number_of( json_object_get( one, "p10" ) ),
            .p90 = number_of( json_object_get( one, "p90" ) ),
        };
    }
    bool good = count <= SWEEP_MAX_TIMES;
    for ( int i = 0; i < out->time_count; ++i )
    {
        good = good && out->times[i].workers > 0 && out->times[i].steps >= 0;
    }
    if ( count > 0 )
    {
        out->vertices = whole_of( json_object_get( object, "vertices" ), 0, 1 << 30 );
        out->substeps = whole_of( json_object_get( object, "substeps" ), 1, 1 << 30 );
        good = good && out->vertices >= 0 && out->substeps > 0;
    }
    return good;
}

static bool read_texts( const json_t* object, sweep_record* out )
{
    const json_t *series = json_object_get( object, "series" ), *verdict = json_object_get( object, "verdict" ),
                 *failure = json_object_get( object, "failure" );
    out->along_value = number_of( json_object_get( object, "along_value" ) );
    out->order = number_of( json_object_get( object, "order" ) );
    out->is_known = json_is_true( json_object_get( object, "known" ) );
    return text_of( json_object_get( object, "case" ), out->name, sizeof out->name ) &&
           text_of( json_object_get( object, "variant" ), out->variant, sizeof out->variant ) &&
           ( series == NULL || ( text_of( series, out->series, sizeof out->series ) &&
                                 text_of( json_object_get( object, "along" ), out->along, sizeof out->along ) ) ) &&
           ( verdict == NULL || text_of( verdict, out->verdict, sizeof out->verdict ) ) &&
           ( failure == NULL || text_of( failure, out->failure, sizeof out->failure ) );
}

static void read_values( const json_t* object, sweep_record* out )
{
    const json_t *values = json_object_get( object, "values" ), *compared = json_object_get( object, "compared" );
    double* all[WISP_COUNT( comparison_names )];
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        out->values[m] = number_of( json_object_get( values, suite_measures[m].name ) );
    }
    list_comparison( &out->compared, all );
    for ( int i = 0; i < WISP_COUNT( comparison_names ); ++i )
    {
        *all[i] = number_of( json_object_get( compared, comparison_names[i] ) );
    }
}

bool sweep_record_read( const char* line, size_t size, sweep_record* out )
{
    *out = ( sweep_record ){ 0 };
    json_t* object = json_loadb( line, size, JSON_REJECT_DUPLICATES, NULL );
    out->item = whole_of( json_object_get( object, "item" ), 0, SUITE_MAX_ROWS - 1 );
    out->steps = whole_of( json_object_get( object, "steps" ), 0, 1000000000 );
    const bool good = out->item >= 0 && out->steps >= 0 && hash_of( json_object_get( object, "key" ), &out->key ) &&
                      hash_of( json_object_get( object, "hash" ), &out->hash ) && read_texts( object, out ) &&
                      read_times( object, out );
    if ( good )
    {
        read_values( object, out );
    }
    json_decref( object );
    return good;
}

// ---- headers ----

// The first line of a part.

enum
{
    VERSION = 1, // of the format
};

void sweep_describe_machine( const char* isa, sweep_header* out )
{
    const machine_info machine = machine_describe( isa );
    snprintf( out->version, sizeof out->version, "%s", machine.version );
    snprintf( out->commit, sizeof out->commit, "%s", machine.commit );
    snprintf( out->compiler, sizeof out->compiler, "%s", machine.compiler );
    snprintf( out->flags, sizeof out->flags, "%s", machine.flags );
    snprintf( out->build_type, sizeof out->build_type, "%s", machine.build_type );
    snprintf( out->cpu, sizeof out->cpu, "%s", machine.cpu );
    snprintf( out->isa, sizeof out->isa, "%s", machine.isa );
    snprintf( out->os, sizeof out->os, "%s", machine.os );
    snprintf( out->host, sizeof out->host, "%s", machine.host );
    out->cores = machine.cores;
    out->memory_bytes = machine.memory_bytes;
}

// Texts of a header: where they are, and their room.
typedef struct text_field
{
    const char* name;
    char* text;
    size_t size;
} text_field;

enum
{
    TEXTS = 12,
};

static void list_texts( sweep_header* h, text_field out[TEXTS] )
{
    const text_field all[TEXTS] = {
        { "suite", h->suite, sizeof h->suite },
        { "title", h->title, sizeof h->title },
        { "reference", h->reference, sizeof h->reference },
        { "version", h->version, sizeof h->version },
        { "commit", h->commit, sizeof h->commit },
        { "compiler", h->compiler, sizeof h->compiler },
        { "flags", h->flags, sizeof h->flags },
        { "build_type", h->build_type, sizeof h->build_type },
        { "cpu", h->cpu, sizeof h->cpu },
        { "isa", h->isa, sizeof h->isa },
        { "os", h->os, sizeof h->os },
        { "host", h->host, sizeof h->host },
    };
    memcpy( out, all, sizeof all );
}

char* sweep_header_write( const sweep_header* header )
{
    sweep_header h = *header;
    text_field texts[TEXTS];
    list_texts( &h, texts );
    json_t* object = json_object();
    json_object_set_new( object, "wisp_sweep", json_integer( VERSION ) );
    for ( int i = 0; i < TEXTS; ++i )
    {
        json_object_set_new( object, texts[i].name, results_json_text( texts[i].text ) );
    }
    json_object_set_new( object, "key", json_of_hash( h.key ) );
    json_object_set_new( object, "items", json_integer( h.items ) );
    json_object_set_new( object, "shard", json_integer( h.shard + 1 ) );
    json_object_set_new( object, "shards", json_integer( h.shards ) );
    json_object_set_new( object, "exclusive", json_boolean( h.is_exclusive ) );
    json_object_set_new( object, "workers", json_integer( h.workers ) );
    json_object_set_new( object, "doubt", json_of( h.doubt ) );
    json_object_set_new( object, "parts_at", json_of( h.parts_at ) );
    json_object_set_new( object, "cores", json_integer( h.cores ) );
    json_object_set_new( object, "memory_bytes", json_of( h.memory_bytes ) );
    char* line = json_dumps( object, JSON_COMPACT | JSON_REAL_PRECISION( 17 ) );
    json_decref( object );
    return line;
}

bool sweep_header_read( const char* line, size_t size, sweep_header* out )
{
    *out = ( sweep_header ){ 0 };
    json_t* object = json_loadb( line, size, JSON_REJECT_DUPLICATES, NULL );
    text_field texts[TEXTS];
    list_texts( out, texts );
    bool good = whole_of( json_object_get( object, "wisp_sweep" ), VERSION, VERSION ) == VERSION;
    for ( int i = 0; i < TEXTS && good; ++i )
    {
        good = text_of( json_object_get( object, texts[i].name ), texts[i].text, texts[i].size );
    }
    out->items = whole_of( json_object_get( object, "items" ), 1, SUITE_MAX_ROWS );
    out->shards = whole_of( json_object_get( object, "shards" ), 1, SWEEP_MAX_SHARDS );
    out->shard = whole_of( json_object_get( object, "shard" ), 1, out->shards ) - 1;
    out->workers = whole_of( json_object_get( object, "workers" ), 0, 1 << 20 );
    out->workers = whole_of( json_object_get( object, "workers" ), 0, 1 << 20 );
    out->cores = whole_of( json_object_get( object, "cores" ), 0, 1 << 20 );
    out->is_exclusive = json_is_true( json_object_get( object, "exclusive" ) );
    out->doubt = number_of( json_object_get( object, "doubt" ) );
    out->parts_at = number_of( json_object_get( object, "parts_at" ) );
    out->memory_bytes = number_of( json_object_get( object, "memory_bytes" ) );
    good = good && out->items > 0 && out->shards > 0 && out->shard >= 0 && out->cores >= 0 && out->workers >= 0 &&
           hash_of( json_object_get( object, "key" ), &out->key );
    json_decref( object );
    return good;
}

static bool is_same_number( double a, double b )
{
    return a == b || ( isnan( a ) && isnan( b ) );
}

const char* sweep_difference( const sweep_header* a, const sweep_header* b )
{
    const bool is_suite = a->key == b->key && a->items == b->items;
    const bool is_version = strcmp( a->version, b->version ) == 0 && strcmp( a->commit, b->commit ) == 0;
    const bool is_reference = strcmp( a->reference, b->reference ) == 0 && is_same_number( a->doubt, b->doubt ) &&
                              is_same_number( a->parts_at, b->parts_at );
    return !is_suite                                                        ? "another suite"
           : !is_version                                                    ? "another version of Wisp"
           : a->shards != b->shards                                         ? "another number of shards"
           : !is_reference                                                  ? "another reference"
           : a->is_exclusive && b->is_exclusive && a->workers != b->workers ? "another number of workers"
                                                                            : NULL;
}

// ---- parts ----

enum
{
    MAX_BYTES = 1 << 28, // of a part
};

static const double SYNC_SECONDS = 1.0; // so often lines are brought to the disk

// ---- names ----

void sweep_part_path( const char* folder, int shard, int shards, bool is_done, char out[SWEEP_MAX_PATH] )
{
    snprintf( out, SWEEP_MAX_PATH, "%.900s/part-%04d-of-%04d.%s", folder, shard + 1, shards,
              is_done ? "jsonl" : "running" );
}

bool sweep_part_of_name( const char* name, int* shard, int* shards, bool* is_done )
{
    int used = 0;
    if ( sscanf( name, "part-%4d-of-%4d.%n", shard, shards, &used ) != 2 || used == 0 )
    {
        return false;
    }
    char exact[64];
    *is_done = strcmp( name + used, "jsonl" ) == 0;
    snprintf( exact, sizeof exact, "part-%04d-of-%04d.%s", *shard, *shards, *is_done ? "jsonl" : "running" );
    *shard -= 1;
    return strcmp( name, exact ) == 0 && *shards >= 1 && *shard >= 0 && *shard < *shards;
}

// ---- reading ----

static wisp_status add_record( const char* line, size_t size, const char* path, int number, sweep_part* out,
                               wisp_error* error )
{
    sweep_record record;
    if ( size > SWEEP_MAX_LINE || !sweep_record_read( line, size, &record ) || record.item >= out->header.items )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s:%d: expected a record of a sweep", io_short_name( path ),
                          number );
    }
    if ( ( out->count & ( out->count - 1 ) ) == 0 )
    {
        const size_t room = out->count > 0 ? 2 * (size_t)out->count : 1;
        sweep_record* records = realloc( out->records, room * sizeof *records );
        if ( records == NULL )
        {
            return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for its records", io_short_name( path ) );
        }
        out->records = records;
    }
    out->records[out->count++] = record;
    return WISP_OK;
}

wisp_status sweep_part_parse( const char* bytes, size_t size, const char* path, sweep_part* out, wisp_error* error )
{
    *out = ( sweep_part ){ 0 };
    wisp_status status = WISP_OK;
    int number = 1;
    for ( const char* end; status == WISP_OK && ( end = memchr( bytes + out->whole, '\n', size - out->whole ) );
          ++number )
    {
        const char* line = bytes + out->whole;
        const size_t length = (size_t)( end - line );
        if ( number == 1 && ( length > SWEEP_MAX_LINE || !sweep_header_read( line, length, &out->header ) ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s:1: expected the header of a part of a sweep",
                              io_short_name( path ) );
        }
        status = number > 1 ? add_record( line, length, path, number, out, error ) : WISP_OK;
        out->whole += status == WISP_OK ? length + 1 : 0;
    }
    return status;
}

wisp_status sweep_part_read( const char* path, sweep_part* out, wisp_error* error )
{
    unsigned char* bytes = NULL;
    size_t size = 0;
    *out = ( sweep_part ){ 0 };
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    if ( status == WISP_OK && size > 0 )
    {
        status = sweep_part_parse( (const char*)bytes, size, path, out, error );
    }
    free( bytes );
    return status;
}

void sweep_part_release( sweep_part* part )
{
    free( part->records );
    *part = ( sweep_part ){ 0 };
}

// ---- writing ----

static wisp_status fail_by_errno( const char* path, const char* what, int number, wisp_error* error )
{
    return wisp_fail( error, WISP_IO_ERROR, "%s: %s: %s", io_short_name( path ), what, strerror( number ) );
}

// A line that is not written whole is cut off again. Where even that fails, the next reader leaves out what has no end.
static wisp_status write_line( sweep_writer* w, char* line, wisp_error* error )
{
    if ( line == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for a line", io_short_name( w->running ) );
    }
    const size_t size = strlen( line ) + 1;
    const off_t before = lseek( w->file, 0, SEEK_END );
    size_t done = 0;
    line[size - 1] = '\n';
    while ( done < size )
    {
        const ssize_t count = write( w->file, line + done, size - done );
        if ( count <= 0 && errno != EINTR )
        {
            break;
        }
        done += count > 0 ? (size_t)count : 0;
    }
    const int number = errno;
    free( line );
    if ( done == size )
    {
        return WISP_OK;
    }
    const bool is_cut = before >= 0 && ftruncate( w->file, before ) == 0;
    return fail_by_errno( w->running, is_cut ? "cannot be written" : "cannot be written, and ends within a line",
                          number, error );
}

// @return WISP_CONFLICT: it is of another sweep
static wisp_status check_same( const char* path, const sweep_header* found, const sweep_header* wanted,
                               wisp_error* error )
{
    const char* difference = sweep_difference( found, wanted );
    difference = difference == NULL && found->is_exclusive != wanted->is_exclusive
                     ? found->is_exclusive ? "a run with --exclusive" : "a run without --exclusive"
                     : difference;
    return difference == NULL ? WISP_OK
                              : wisp_fail( error, WISP_CONFLICT, "%s: is of %s; choose another folder",
                                           io_short_name( path ), difference );
}

// A part that is done. @return WISP_OK also if there is none
static wisp_status look_for_done( const sweep_header* header, bool resume, sweep_writer* w, sweep_part* found,
                                  wisp_error* error )
{
    struct stat info;
    if ( stat( w->done, &info ) != 0 )
    {
        return WISP_OK;
    }
    if ( resume == false )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: exists, the shard is done; --resume accepts it, another folder begins again",
                          io_short_name( w->done ) );
    }
    const wisp_status status = sweep_part_read( w->done, found, error );
    w->is_done = status == WISP_OK;
    return status == WISP_OK ? check_same( w->done, &found->header, header, error ) : status;
}

// Read what a process before has written, and cut off the line in which it was stopped.
static wisp_status take_over( const sweep_header* header, bool resume, sweep_writer* w, sweep_part* found,
                              wisp_error* error )
{
    struct stat info;
    if ( fstat( w->file, &info ) != 0 || info.st_size == 0 )
    {
        return WISP_OK;
    }
    if ( resume == false )
    {
        return wisp_fail( error, WISP_CONFLICT,
                          "%s: exists, the shard was begun; --resume goes on with it, another folder begins again",
                          io_short_name( w->running ) );
    }
    wisp_status status = sweep_part_read( w->running, found, error );
    status = status == WISP_OK && found->whole > 0 ? check_same( w->running, &found->header, header, error ) : status;
    return status == WISP_OK && ftruncate( w->file, (off_t)found->whole ) != 0
               ? fail_by_errno( w->running, "cannot be cut", errno, error )
               : status;
}

static wisp_status open_running( sweep_writer* w, wisp_error* error )
{
    w->file = open( w->running, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666 );
    if ( w->file < 0 )
    {
        return fail_by_errno( w->running, "cannot be opened", errno, error );
    }
    if ( flock( w->file, LOCK_EX | LOCK_NB ) == 0 )
    {
        return WISP_OK;
    }
    if ( errno == EWOULDBLOCK )
    {
        return wisp_fail( error, WISP_CONFLICT, "%s: another process writes it", io_short_name( w->running ) );
    }
    fprintf( stderr, "wisp: %s: cannot be locked (%s), so no two processes may run this shard\n",
             io_short_name( w->running ), strerror( errno ) );
    return WISP_OK;
}

wisp_status sweep_writer_open( const char* folder, const sweep_header* header, bool resume, sweep_writer* out,
                               sweep_part* found, wisp_error* error )
{
    *out = ( sweep_writer ){ .file = -1 };
    *found = ( sweep_part ){ 0 };
    sweep_part_path( folder, header->shard, header->shards, false, out->running );
    sweep_part_path( folder, header->shard, header->shards, true, out->done );
    wisp_status status = look_for_done( header, resume, out, found, error );
    if ( status != WISP_OK || out->is_done )
    {
        return status;
    }
    status = open_running( out, error );
    // the process that held the lock may have finished since the first look
    status = status == WISP_OK ? look_for_done( header, resume, out, found, error ) : status;
    if ( status == WISP_OK && out->is_done )
    {
        unlink( out->running );
        sweep_writer_close( out );
        return WISP_OK;
    }
    status = status == WISP_OK ? take_over( header, resume, out, found, error ) : status;
    if ( status == WISP_OK && found->whole == 0 )
    {
        status = write_line( out, sweep_header_write( header ), error );
    }
    if ( status != WISP_OK )
    {
        sweep_writer_close( out );
    }
    return status;
}

wisp_status sweep_writer_add( sweep_writer* w, const sweep_record* record, wisp_error* error )
{
    const wisp_status status = write_line( w, sweep_record_write( record ), error );
    const double now = wisp_clock_seconds();
    if ( status != WISP_OK || now - w->synced < SYNC_SECONDS )
    {
        return status;
    }
    w->synced = now;
    return fdatasync( w->file ) == 0 ? WISP_OK
                                     : fail_by_errno( w->running, "cannot be brought to the disk", errno, error );
}

void sweep_writer_close( sweep_writer* w )
{
    if ( w->file >= 0 )
    {
        close( w->file );
        w->file = -1;
    }
}

wisp_status sweep_writer_finish( sweep_writer* w, wisp_error* error )
{
    wisp_status status =
        fsync( w->file ) == 0 ? WISP_OK : fail_by_errno( w->running, "cannot be brought to the disk", errno, error );
    if ( status == WISP_OK && rename( w->running, w->done ) != 0 )
    {
        status = fail_by_errno( w->done, "cannot be named so", errno, error );
    }
    sweep_writer_close( w );
    return status;
}
