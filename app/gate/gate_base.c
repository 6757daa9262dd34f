#include "gate_base.h"

#include "io_file.h"
#include "machine.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum
{
    MAX_BYTES = 16 << 20,
    MAX_REASONS = 1000,
};

void gate_compiler( char* out, size_t size )
{
    const machine_info machine = machine_describe( "" );
    snprintf( out, size, "%s, %s, %s", machine.compiler, machine.build_type, machine.flags );
}

void gate_today( char out[16] )
{
    const time_t now = time( NULL );
    struct tm parts;
    localtime_r( &now, &parts );
    strftime( out, 16, "%Y-%m-%d", &parts );
}

const gate_base_row* gate_base_find( const gate_base* base, const suite_row* row )
{
    for ( int i = 0; i < base->row_count; ++i )
    {
        if ( strcmp( base->rows[i].name, row->name ) == 0 && strcmp( base->rows[i].variant, row->variant ) == 0 )
        {
            return base->rows + i;
        }
    }
    return NULL;
}

void gate_base_release( gate_base* base )
{
    free( base->rows );
    free( base->accepted );
    *base = ( gate_base ){ 0 };
}

// ---- reading ----

static bool take_text( const json_t* object, const char* key, char* out, size_t size )
{
    const char* text = json_string_value( json_object_get( object, key ) );
    if ( text == NULL || strlen( text ) >= size )
    {
        return false;
    }
    strcpy( out, text );
    return true;
}

static bool take_hash( const json_t* row, uint64_t* out )
{
    const char* text = json_string_value( json_object_get( row, "hash" ) );
    char* end = NULL;
    *out = text ? strtoull( text, &end, 16 ) : 0;
    return text && strlen( text ) == 16 && *end == '\0';
}

// A value that is null was not measured; one that is not there is an error, since files may be cut.
static bool take_values( const json_t* row, suite_measurement* out )
{
    const json_t* values = json_object_get( row, "values" );
    bool is_whole = json_object_size( values ) == SUITE_MEASURE_COUNT;
    for ( int m = 0; m < SUITE_MEASURE_COUNT && is_whole; ++m )
    {
        const json_t* value = json_object_get( values, suite_measures[m].name );
        is_whole = json_is_null( value ) || json_is_number( value );
        out->values[m] = json_is_number( value ) ? json_number_value( value ) : NAN;
        is_whole = is_whole && !( out->values[m] < 0.0 );
    }
    return is_whole;
}

static bool take_passes( const json_t* row, suite_measurement* out )
{
    json_t* passes = json_object_get( row, "passes" );
    const char* name;
    json_t* value;
    bool is_whole = json_is_object( passes ) && json_object_size( passes ) <= SUITE_MAX_PASSES;
    if ( is_whole )
    {
        json_object_foreach( passes, name, value )
        {
            suite_pass* pass = &out->passes[out->pass_count++];
            is_whole = is_whole && strlen( name ) < sizeof pass->name && json_is_number( value ) &&
                       json_number_value( value ) >= 0.0;
            snprintf( pass->name, sizeof pass->name, "%s", name );
            pass->instructions = json_number_value( value );
        }
    }
    return is_whole;
}

static bool take_row( const json_t* row, gate_base_row* out )
{
    const json_t* steps = json_object_get( row, "steps" );
    out->measured.steps = (int)json_integer_value( steps );
    return take_text( row, "name", out->name, sizeof out->name ) &&
           take_text( row, "variant", out->variant, sizeof out->variant ) && json_is_integer( steps ) &&
           take_hash( row, &out->measured.hash ) && take_values( row, &out->measured ) &&
           take_passes( row, &out->measured );
}

static bool take_reason( const json_t* reason, gate_reason* out )
{
    return take_text( reason, "date", out->date, sizeof out->date ) &&
           take_text( reason, "reason", out->text, sizeof out->text );
}

static wisp_status take_base( const json_t* root, const char* path, gate_base* out, wisp_error* error )
{
    const json_t *version = json_object_get( root, "wisp_gate" ), *rows = json_object_get( root, "rows" ),
                 *accepted = json_object_get( root, "accepted" );
    if ( !json_is_integer( version ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: expected a base file of wisp gate, which has the key wisp_gate",
                          io_short_name( path ) );
    }
    if ( json_integer_value( version ) != GATE_VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: got a base file of version %lld, expected %d; record it again",
                          io_short_name( path ), (long long)json_integer_value( version ), (int)GATE_VERSION );
    }
    const size_t count = json_array_size( rows ), reasons = json_array_size( accepted );
    if ( !take_text( root, "suite", out->suite, sizeof out->suite ) ||
         !take_text( root, "date", out->date, sizeof out->date ) ||
         !take_text( root, "version", out->version, sizeof out->version ) ||
         !take_text( root, "compiler", out->compiler, sizeof out->compiler ) || count == 0 ||
         count > SUITE_MAX_ROWS || !json_is_array( accepted ) || reasons > MAX_REASONS )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: expected suite, date, version, compiler, rows and accepted; the file was edited",
                          io_short_name( path ) );
    }
    out->rows = calloc( count, sizeof *out->rows );
    out->accepted = calloc( reasons + 1, sizeof *out->accepted );
    if ( out->rows == NULL || out->accepted == NULL )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: out of memory for %zu rows", io_short_name( path ), count );
    }
    for ( size_t i = 0; i < count; ++i )
    {
        if ( !take_row( json_array_get( rows, i ), out->rows + i ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: row %zu is not as it was recorded; record the file again",
                              io_short_name( path ), i + 1 );
        }
        out->row_count += 1;
    }
    for ( size_t i = 0; i < reasons; ++i )
    {
        if ( !take_reason( json_array_get( accepted, i ), out->accepted + i ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: reason %zu has no date or no text", io_short_name( path ),
                              i + 1 );
        }
        out->accepted_count += 1;
    }
    return WISP_OK;
}

wisp_status gate_base_parse( const char* text, size_t size, const char* path, gate_base* out, wisp_error* error )
{
    *out = ( gate_base ){ 0 };
    json_error_t place = { 0 };
    json_t* root = json_loadb( text, size, JSON_REJECT_DUPLICATES, &place );
    const wisp_status status = root ? take_base( root, path, out, error )
                                    : wisp_fail( error, WISP_BAD_INPUT, "%s:%d:%d: no JSON: %.160s",
                                                 io_short_name( path ), place.line, place.column, place.text );
    json_decref( root );
    return status;
}

wisp_status gate_base_read( const char* path, gate_base* out, wisp_error* error )
{
    *out = ( gate_base ){ 0 };
    unsigned char* bytes = NULL;
    size_t size = 0;
    wisp_status status = io_file_read( path, MAX_BYTES, &bytes, &size, error );
    status = status == WISP_OK ? gate_base_parse( (const char*)bytes, size, path, out, error ) : status;
    free( bytes );
    return status;
}

// ---- writing ----

static json_t* value_of( double value )
{
    return !isfinite( value )                                  ? json_null()
           : value == floor( value ) && fabs( value ) < 0x1p53 ? json_integer( (json_int_t)value )
                                                               : json_real( value );
}

static json_t* row_of( const gate_base_row* row )
{
    char digits[17];
    snprintf( digits, sizeof digits, "%016llx", (unsigned long long)row->measured.hash );
    json_t *out = json_object(), *values = json_object();
    json_object_set_new( out, "name", json_string( row->name ) );
    json_object_set_new( out, "variant", json_string( row->variant ) );
    json_object_set_new( out, "steps", json_integer( row->measured.steps ) );
    json_object_set_new( out, "hash", json_string( digits ) );
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        json_object_set_new( values, suite_measures[m].name, value_of( row->measured.values[m] ) );
    }
    json_object_set_new( out, "values", values );
    json_t* passes = json_object();
    for ( int i = 0; i < row->measured.pass_count; ++i )
    {
        if ( isfinite( row->measured.passes[i].instructions ) )
        {
            json_object_set_new( passes, row->measured.passes[i].name,
                                 value_of( row->measured.passes[i].instructions ) );
        }
    }
    json_object_set_new( out, "passes", passes );
    return out;
}

static json_t* root_of( const gate_base* base )
{
    json_t *root = json_object(), *rows = json_array(), *accepted = json_array();
    json_object_set_new( root, "wisp_gate", json_integer( GATE_VERSION ) );
    json_object_set_new( root, "suite", json_string( base->suite ) );
    json_object_set_new( root, "date", json_string( base->date ) );
    json_object_set_new( root, "version", json_string( base->version ) );
    json_object_set_new( root, "compiler", json_string( base->compiler ) );
    for ( int i = 0; i < base->row_count; ++i )
    {
        json_array_append_new( rows, row_of( base->rows + i ) );
    }
    json_object_set_new( root, "rows", rows );
    for ( int i = 0; i < base->accepted_count; ++i )
    {
        json_t* reason = json_object();
        json_object_set_new( reason, "date", json_string( base->accepted[i].date ) );
        json_object_set_new( reason, "reason", json_string( base->accepted[i].text ) );
        json_array_append_new( accepted, reason );
    }
    json_object_set_new( root, "accepted", accepted );
    return root;
}

wisp_status gate_base_write( const gate_base* base, const char* path, wisp_error* error )
{
    io_output output;
    wisp_status status = io_output_open( path, &output, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    json_t* root = root_of( base );
    if ( json_dumpf( root, output.stream, JSON_INDENT( 1 ) | JSON_REAL_PRECISION( 9 ) ) != 0 ||
         fputc( '\n', output.stream ) == EOF )
    {
        status = wisp_fail( error, WISP_IO_ERROR, "%s: cannot be written", io_short_name( path ) );
    }
    json_decref( root );
    return io_output_end( &output, status, error );
}
