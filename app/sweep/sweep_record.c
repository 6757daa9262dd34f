// Numbers have 17 digits, so that a record that is read is the one that was written, bit for bit.
#include "sweep_record.h"

#include "results_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- values ----

json_t* sweep_number( double value )
{
    return isnan( value )   ? json_null()
           : isinf( value ) ? json_string( value > 0.0 ? "inf" : "-inf" )
                            : json_real( value );
}

double sweep_number_of( const json_t* value )
{
    const char* text = json_string_value( value );
    return text != NULL              ? strcmp( text, "inf" ) == 0    ? INFINITY
                                       : strcmp( text, "-inf" ) == 0 ? -INFINITY
                                                                     : NAN
           : json_is_number( value ) ? json_number_value( value )
                                     : NAN;
}

int sweep_whole_of( const json_t* value, int least, int most )
{
    const json_int_t number = json_integer_value( value );
    return json_is_integer( value ) && number >= least && number <= most ? (int)number : -1;
}

json_t* sweep_hash( uint64_t hash )
{
    char text[24];
    snprintf( text, sizeof text, "%016llx", (unsigned long long)hash );
    return json_string( text );
}

bool sweep_hash_of( const json_t* value, uint64_t* out )
{
    const char* text = json_string_value( value );
    if ( text == NULL || strlen( text ) != 16 || strspn( text, "0123456789abcdef" ) != 16 )
    {
        return false;
    }
    *out = strtoull( text, NULL, 16 );
    return true;
}

bool sweep_text_of( const json_t* value, char* out, size_t size )
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
        json_object_set_new( out, comparison_names[i], sweep_number( *all[i] ) );
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
        json_object_set_new( one, "median", sweep_number( t->median ) );
        json_object_set_new( one, "p10", sweep_number( t->p10 ) );
        json_object_set_new( one, "p90", sweep_number( t->p90 ) );
        json_array_append_new( list, one );
    }
    return list;
}

char* sweep_record_write( const sweep_record* r )
{
    json_t* object = json_object();
    json_object_set_new( object, "item", json_integer( r->item ) );
    json_object_set_new( object, "key", sweep_hash( r->key ) );
    json_object_set_new( object, "case", results_json_text( r->name ) );
    json_object_set_new( object, "variant", results_json_text( r->variant ) );
    if ( r->series[0] != '\0' )
    {
        json_object_set_new( object, "series", results_json_text( r->series ) );
        json_object_set_new( object, "along", results_json_text( r->along ) );
        json_object_set_new( object, "along_value", sweep_number( r->along_value ) );
        json_object_set_new( object, "order", sweep_number( r->order ) );
    }
    json_object_set_new( object, "steps", json_integer( r->steps ) );
    json_object_set_new( object, "hash", sweep_hash( r->hash ) );
    json_t* values = json_object();
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        if ( !isnan( r->values[m] ) )
        {
            json_object_set_new( values, suite_measures[m].name, sweep_number( r->values[m] ) );
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
            .workers = sweep_whole_of( json_object_get( one, "workers" ), 1, 1 << 20 ),
            .steps = sweep_whole_of( json_object_get( one, "steps" ), 0, 1000000000 ),
            .median = sweep_number_of( json_object_get( one, "median" ) ),
            .p10 = sweep_number_of( json_object_get( one, "p10" ) ),
            .p90 = sweep_number_of( json_object_get( one, "p90" ) ),
        };
    }
    bool good = count <= SWEEP_MAX_TIMES;
    for ( int i = 0; i < out->time_count; ++i )
    {
        good = good && out->times[i].workers > 0 && out->times[i].steps >= 0;
    }
    if ( count > 0 )
    {
        out->vertices = sweep_whole_of( json_object_get( object, "vertices" ), 0, 1 << 30 );
        out->substeps = sweep_whole_of( json_object_get( object, "substeps" ), 1, 1 << 30 );
        good = good && out->vertices >= 0 && out->substeps > 0;
    }
    return good;
}

static bool read_texts( const json_t* object, sweep_record* out )
{
    const json_t *series = json_object_get( object, "series" ), *verdict = json_object_get( object, "verdict" ),
                 *failure = json_object_get( object, "failure" );
    out->along_value = sweep_number_of( json_object_get( object, "along_value" ) );
    out->order = sweep_number_of( json_object_get( object, "order" ) );
    out->is_known = json_is_true( json_object_get( object, "known" ) );
    return sweep_text_of( json_object_get( object, "case" ), out->name, sizeof out->name ) &&
           sweep_text_of( json_object_get( object, "variant" ), out->variant, sizeof out->variant ) &&
           ( series == NULL ||
             ( sweep_text_of( series, out->series, sizeof out->series ) &&
               sweep_text_of( json_object_get( object, "along" ), out->along, sizeof out->along ) ) ) &&
           ( verdict == NULL || sweep_text_of( verdict, out->verdict, sizeof out->verdict ) ) &&
           ( failure == NULL || sweep_text_of( failure, out->failure, sizeof out->failure ) );
}

static void read_values( const json_t* object, sweep_record* out )
{
    const json_t *values = json_object_get( object, "values" ), *compared = json_object_get( object, "compared" );
    double* all[WISP_COUNT( comparison_names )];
    for ( int m = 0; m < SUITE_MEASURE_COUNT; ++m )
    {
        out->values[m] = sweep_number_of( json_object_get( values, suite_measures[m].name ) );
    }
    list_comparison( &out->compared, all );
    for ( int i = 0; i < WISP_COUNT( comparison_names ); ++i )
    {
        *all[i] = sweep_number_of( json_object_get( compared, comparison_names[i] ) );
    }
}

bool sweep_record_read( const char* line, size_t size, sweep_record* out )
{
    *out = ( sweep_record ){ 0 };
    json_t* object = json_loadb( line, size, JSON_REJECT_DUPLICATES, NULL );
    out->item = sweep_whole_of( json_object_get( object, "item" ), 0, SUITE_MAX_ROWS - 1 );
    out->steps = sweep_whole_of( json_object_get( object, "steps" ), 0, 1000000000 );
    const bool good = out->item >= 0 && out->steps >= 0 &&
                      sweep_hash_of( json_object_get( object, "key" ), &out->key ) &&
                      sweep_hash_of( json_object_get( object, "hash" ), &out->hash ) && read_texts( object, out ) &&
                      read_times( object, out );
    if ( good )
    {
        read_values( object, out );
    }
    json_decref( object );
    return good;
}
