#include "sweep_row.h"

#include "results_write.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- what a row has ----

#define OF( member ) offsetof( suite_measurement, member )

const sweep_value sweep_values[SWEEP_VALUE_COUNT] = {
    { "error, mm", "RMS_distance_to_the_reference_mm", OF( values[SUITE_ERROR] ), 1e3, true, false },
    { "largest distance, mm", "largest_distance_mm", OF( compared.largest ), 1e3, false, false },
    { "error at 0.5 s, mm", "error_at_0_5_s_mm", OF( compared.at[0] ), 1e3, true, false },
    { "error at 1 s, mm", "error_at_1_s_mm", OF( compared.at[1] ), 1e3, true, false },
    { "error at 2 s, mm", "error_at_2_s_mm", OF( compared.at[2] ), 1e3, true, false },
    { "detail", "detail", OF( compared.detail ), 1.0, false, false },
    { "late height, mm", "late_height_mm", OF( compared.late_height ), 1e3, false, false },
    { "late energy, % of released", "late_energy_percent_of_released", OF( compared.late_energy ), 100.0, false,
      false },
    { "late stretch, %", "late_stretch_percent", OF( compared.late_stretch ), 100.0, false, false },
    { "late detail", "late_detail", OF( compared.late_detail ), 1.0, false, false },
    { "most stretch mean, %", "most_stretch_mean_percent", OF( values[SUITE_STRETCH] ), 100.0, false, false },
    { "energy risen, mJ", "energy_risen_mJ", OF( values[SUITE_ENERGY] ), 1e3, false, false },
    { "penetration, mm", "penetration_mm", OF( values[SUITE_PENETRATION] ), 1e3, false, true },
    { "intersections", "intersections", OF( values[SUITE_INTERSECTIONS] ), 1.0, false, false },
    { "linear iterations", "linear_iterations", OF( values[SUITE_SOLVER_ITERATIONS] ), 1.0, false, false },
    { "not converged", "not_converged", OF( values[SUITE_NOT_CONVERGED] ), 1.0, false, true },
    { "strand resets", "strand_resets", OF( values[SUITE_RESETS] ), 1.0, false, true },
    { "halted", "halted", OF( values[SUITE_HALTED] ), 1.0, false, true },
    { "memory, KiB", "memory_KiB", OF( values[SUITE_BYTES] ), 1.0 / 1024.0, false, false },
};

typedef enum field_kind
{
    TEXT,
    WHOLE, // from 0 on
    NUMBER,
    HASH,
    FLAG,
} field_kind;

typedef enum field_group
{
    OF_SWEEP,
    OF_MACHINE,
    OF_TIME,
    OF_ITEM,
} field_group;

typedef struct field
{
    const char* name; // in a line
    field_kind kind;
    size_t offset, size; // in a sweep_row
    field_group group;
    const char* said; // of a sweep: what another value is another of
} field;

#define AT( member ) offsetof( sweep_row, member ), sizeof( ( (sweep_row*)0 )->member )

static const field fields[] = {
    { "item", WHOLE, AT( item ), OF_ITEM, NULL },
    { "case", TEXT, AT( name ), OF_ITEM, NULL },
    { "variant", TEXT, AT( variant ), OF_ITEM, NULL },
    { "series", TEXT, AT( series ), OF_ITEM, NULL },
    { "along", TEXT, AT( along ), OF_ITEM, NULL },
    { "along_value", NUMBER, AT( along_value ), OF_ITEM, NULL },
    { "order", NUMBER, AT( order ), OF_ITEM, NULL },
    { "steps", WHOLE, AT( steps ), OF_ITEM, NULL },
    { "strands", WHOLE, AT( strands ), OF_ITEM, NULL },
    { "vertices", WHOLE, AT( vertices ), OF_ITEM, NULL },
    { "substeps", WHOLE, AT( substeps ), OF_ITEM, NULL },
    { "doubt", NUMBER, AT( doubt ), OF_ITEM, NULL },
    { "until", NUMBER, AT( until ), OF_ITEM, NULL },
    { "hash", HASH, AT( hash ), OF_ITEM, NULL },
    { "verdict", TEXT, AT( verdict ), OF_ITEM, NULL },
    { "known", FLAG, AT( is_known ), OF_ITEM, NULL },
    { "failure", TEXT, AT( failure ), OF_ITEM, NULL },
    { "workers", WHOLE, AT( workers ), OF_TIME, NULL },
    { "ms_1_worker", NUMBER, AT( alone.median ), OF_TIME, NULL },
    { "ms_1_worker_p10", NUMBER, AT( alone.p10 ), OF_TIME, NULL },
    { "ms_1_worker_p90", NUMBER, AT( alone.p90 ), OF_TIME, NULL },
    { "ms", NUMBER, AT( together.median ), OF_TIME, NULL },
    { "ms_p10", NUMBER, AT( together.p10 ), OF_TIME, NULL },
    { "ms_p90", NUMBER, AT( together.p90 ), OF_TIME, NULL },
    { "suite", TEXT, AT( suite ), OF_SWEEP, "suite" },
    { "sweep", HASH, AT( sweep ), OF_SWEEP, "suite" },
    { "items", WHOLE, AT( items ), OF_SWEEP, "suite" },
    { "shards", WHOLE, AT( shards ), OF_SWEEP, "number of shards" },
    { "version", TEXT, AT( machine.version ), OF_SWEEP, "version of Wisp" },
    { "commit", TEXT, AT( machine.commit ), OF_SWEEP, "version of Wisp" },
    { "reference", TEXT, AT( reference ), OF_SWEEP, "reference" },
    { "shard", WHOLE, AT( shard ), OF_ITEM, NULL },
    { "share", WHOLE, AT( share ), OF_ITEM, NULL },
    { "compiler", TEXT, AT( machine.compiler ), OF_MACHINE, NULL },
    { "flags", TEXT, AT( machine.flags ), OF_MACHINE, NULL },
    { "build_type", TEXT, AT( machine.build_type ), OF_MACHINE, NULL },
    { "cpu", TEXT, AT( machine.cpu ), OF_MACHINE, NULL },
    { "isa", TEXT, AT( machine.isa ), OF_MACHINE, NULL },
    { "os", TEXT, AT( machine.os ), OF_MACHINE, NULL },
    { "cores", WHOLE, AT( machine.cores ), OF_MACHINE, NULL },
    { "memory_bytes", NUMBER, AT( machine.memory_bytes ), OF_MACHINE, NULL },
};

enum
{
    FIELDS = WISP_COUNT( fields ),
};

// Behind the table come the values.
static field field_at( int i )
{
    return i < FIELDS ? fields[i]
                      : ( field ){ sweep_values[i - FIELDS].name,
                                   NUMBER,
                                   offsetof( sweep_row, values ) + (size_t)( i - FIELDS ) * sizeof( double ),
                                   sizeof( double ),
                                   OF_ITEM,
                                   NULL };
}

// ---- lines ----

// Numbers have 17 digits, so that a row that is read is the one that was written, bit for bit. Infinity is "inf". What is not there is left out.

// @return null: it is not there
static json_t* json_of( field_kind kind, const void* at )
{
    switch ( kind )
    {
        case TEXT:
            return *(const char*)at != '\0' ? results_json_text( at ) : NULL;
        case WHOLE:
            return *(const int*)at != 0 ? json_integer( *(const int*)at ) : NULL;
        case FLAG:
            return *(const bool*)at ? json_true() : NULL;
        case HASH:
            return *(const uint64_t*)at != 0 ? results_json_hash( *(const uint64_t*)at ) : NULL;
        default:
        {
            const double value = *(const double*)at;
            return isnan( value )   ? NULL
                   : isinf( value ) ? json_string( value > 0.0 ? "inf" : "-inf" )
                                    : json_real( value );
        }
    }
}

char* sweep_row_write( const sweep_row* row )
{
    json_t* object = json_object();
    for ( int i = 0; i < FIELDS + SWEEP_VALUE_COUNT; ++i )
    {
        const field f = field_at( i );
        json_t* value = json_of( f.kind, (const char*)row + f.offset );
        if ( value != NULL )
        {
            json_object_set_new( object, f.name, value );
        }
    }
    char* line = json_dumps( object, JSON_COMPACT | JSON_REAL_PRECISION( 17 ) );
    json_decref( object );
    return line;
}

static bool take_number( const json_t* value, double* out )
{
    const char* text = json_string_value( value );
    const bool is_infinite = text != NULL && ( strcmp( text, "inf" ) == 0 || strcmp( text, "-inf" ) == 0 );
    *out = is_infinite ? text[0] == '-' ? -INFINITY : INFINITY : value != NULL ? json_number_value( value ) : NAN;
    return value == NULL || is_infinite || json_is_number( value );
}

// @param value null: it is not there @return false: it is of another kind, or too large
static bool take( const field* f, const json_t* value, void* at )
{
    const json_int_t whole = json_integer_value( value );
    const char* text = json_string_value( value );
    switch ( f->kind )
    {
        case TEXT:
            return value == NULL || ( text != NULL && (size_t)snprintf( at, f->size, "%s", text ) < f->size );
        case WHOLE:
            *(int*)at = whole >= 0 && whole <= 1000000000 ? (int)whole : -1;
            return *(int*)at >= 0 && ( value == NULL || json_is_integer( value ) );
        case FLAG:
            *(bool*)at = json_is_true( value );
            return value == NULL || json_is_boolean( value );
        case HASH:
            return results_json_take_hash( value, at ) || value == NULL;
        default:
            return take_number( value, at );
    }
}

bool sweep_row_read( const char* line, size_t size, sweep_row* out )
{
    *out = ( sweep_row ){ 0 };
    json_t* object = json_loadb( line, size, JSON_REJECT_DUPLICATES, NULL );
    bool good = json_is_object( object );
    for ( int i = 0; i < FIELDS + SWEEP_VALUE_COUNT && good; ++i )
    {
        const field f = field_at( i );
        good = take( &f, json_object_get( object, f.name ), (char*)out + f.offset );
    }
    json_decref( object );
    return good && out->name[0] != '\0' && out->items <= SUITE_MAX_ROWS && out->item >= 1 &&
           out->item <= out->items && out->shards <= SWEEP_MAX_SHARDS && out->shard >= 1 && out->shard <= out->shards;
}

// ---- two rows ----

static bool is_same( const field* f, const sweep_row* a, const sweep_row* b )
{
    const void *p = (const char*)a + f->offset, *q = (const char*)b + f->offset;
    const double* numbers[] = { p, q };
    return f->kind == TEXT     ? strcmp( p, q ) == 0
           : f->kind == NUMBER ? *numbers[0] == *numbers[1] || ( isnan( *numbers[0] ) && isnan( *numbers[1] ) )
                               : memcmp( p, q, f->size ) == 0;
}

const char* sweep_row_difference( const sweep_row* a, const sweep_row* b )
{
    for ( int i = 0; i < FIELDS; ++i )
    {
        if ( fields[i].group == OF_SWEEP && !is_same( fields + i, a, b ) )
        {
            return fields[i].said;
        }
    }
    return a->workers > 0 && b->workers > 0 && a->workers != b->workers ? "number of workers" : NULL;
}

void sweep_row_take_times( sweep_row* to, const sweep_row* from )
{
    for ( int i = 0; i < FIELDS; ++i )
    {
        if ( fields[i].group == OF_MACHINE || fields[i].group == OF_TIME )
        {
            memcpy( (char*)to + fields[i].offset, (const char*)from + fields[i].offset, fields[i].size );
        }
    }
}

void sweep_row_join_machines( sweep_row* all, const sweep_row* row )
{
    for ( int i = 0; i < FIELDS; ++i )
    {
        char* at = (char*)all + fields[i].offset;
        if ( fields[i].group == OF_MACHINE && !is_same( fields + i, all, row ) )
        {
            memset( at, 0, fields[i].size );
            snprintf( at, fields[i].kind == TEXT ? fields[i].size : 0, "several" );
        }
    }
}
