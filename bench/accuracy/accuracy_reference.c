#include "accuracy_reference.h"

#include "program_data.h"
#include "reference_bytes.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
    HEAD = REFERENCE_MAGIC_SIZE + 2 * 4,
    TAIL = 8,
    PATH_SIZE = 1024,
};

// Recipes are written with nine digits.
#define FACT_TOLERANCE 1e-8
// Floats of a mesh from another mathematical library differ in their last bits, and so do values computed from them.
#define START_TOLERANCE 1e-6
#define START_NAME "weighted mean of the start, m"

// ---- facts ----

void accuracy_reference_put( accuracy_reference* reference, const char* name, double value )
{
    WISP_ASSERT( reference->fact_count < ACCURACY_INFO_MAX );
    accuracy_fact* fact = &reference->info[reference->fact_count++];
    snprintf( fact->name, sizeof( fact->name ), "%s", name );
    fact->value = value;
}

void accuracy_reference_put_start( accuracy_reference* reference, const wisp_vec3* points, int count )
{
    double sum = 0.0;
    for ( int i = 0; i < count; ++i )
    {
        const double weight = 1.0 + i % 13;
        sum += weight * ( (double)points[i].x + 2.0 * (double)points[i].y + 3.0 * (double)points[i].z );
    }
    accuracy_reference_put( reference, START_NAME, sum / count );
}

void accuracy_reference_free( accuracy_reference* reference )
{
    free( reference->numbers );
    *reference = ( accuracy_reference ){ .numbers = NULL };
}

const char* accuracy_reference_folder( void )
{
    static char path[1024];
    program_data_path( "reference", path, sizeof path );
    return path;
}

void accuracy_describe_reference( const accuracy_reference* reference, double unit, accuracy_scene* out )
{
    snprintf( out->reference, sizeof( out->reference ), "%s", reference->reference );
    out->uncertainty = unit * reference->uncertainty;
}

// ---- the recipe ----

// Texts go into tables unchanged, so they must be printable.
static wisp_status take_text( json_t* root, const char* key, char* to, size_t size, const char* name,
                              wisp_error* error )
{
    const char* text = json_string_value( json_object_get( root, key ) );
    bool good = text && text[0] != '\0' && strlen( text ) < size;
    for ( const char* c = text; good && *c != '\0'; ++c )
    {
        good = *c >= ' ' && *c <= '~';
    }
    if ( !good )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: `%s` must be a text of 1 to %zu printable characters", name,
                          key, size - 1 );
    }
    snprintf( to, size, "%s", text );
    return WISP_OK;
}

static wisp_status take_texts( json_t* root, const char* name, accuracy_reference* out, wisp_error* error )
{
    const struct
    {
        const char* key;
        char* to;
        size_t size;
    } texts[] = {
        { "scene", out->scene, sizeof( out->scene ) },
        { "reference", out->reference, sizeof( out->reference ) },
        { "solver", out->solver, sizeof( out->solver ) },
        { "precision", out->precision, sizeof( out->precision ) },
        { "converged", out->converged, sizeof( out->converged ) },
        { "layout", out->layout, sizeof( out->layout ) },
    };
    wisp_status status = WISP_OK;
    for ( int i = 0; i < WISP_COUNT( texts ) && status == WISP_OK; ++i )
    {
        status = take_text( root, texts[i].key, texts[i].to, texts[i].size, name, error );
    }
    if ( status == WISP_OK && strcmp( out->precision, "double" ) != 0 && strcmp( out->precision, "float" ) != 0 )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: `precision` is \"%s\", it must be \"double\" or \"float\"",
                            name, out->precision );
    }
    return status;
}

static wisp_status take_number( json_t* root, const char* key, double lower, double upper, const char* name,
                                double* out, wisp_error* error )
{
    const json_t* value = json_object_get( root, key );
    *out = json_number_value( value );
    return json_is_number( value ) && *out >= lower && *out <= upper
               ? WISP_OK
               : wisp_fail( error, WISP_BAD_INPUT, "%s: `%s` must be a number from %g to %g", name, key, lower,
                            upper );
}

static wisp_status take_info( json_t* root, const char* name, accuracy_reference* out, wisp_error* error )
{
    json_t* info = json_object_get( root, "facts" );
    if ( !json_is_object( info ) || json_object_size( info ) > ACCURACY_INFO_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: `facts` must be an object of at most %d numbers", name,
                          ACCURACY_INFO_MAX );
    }
    const char* key;
    json_t* value;
    json_object_foreach( info, key, value )
    {
        if ( !json_is_number( value ) || strlen( key ) >= sizeof( out->info[0].name ) )
        {
            return wisp_fail( error, WISP_BAD_INPUT, "%s: fact %d is no number of a name below %zu characters", name,
                              out->fact_count + 1, sizeof( out->info[0].name ) );
        }
        accuracy_reference_put( out, key, json_number_value( value ) );
    }
    return WISP_OK;
}

static wisp_status take_hash( json_t* root, const char* name, uint64_t* hash, wisp_error* error )
{
    const char* text = json_string_value( json_object_get( root, "hash" ) );
    if ( !text || strlen( text ) != 16 || strspn( text, "0123456789abcdef" ) != 16 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: `hash` must be a text of 16 hexadecimal digits", name );
    }
    *hash = strtoull( text, NULL, 16 );
    return WISP_OK;
}

static wisp_status take_generator( json_t* root, const char* name, accuracy_reference* out, uint64_t* hash,
                                   wisp_error* error )
{
    double version = 0.0, substeps = 0.0, numbers = 0.0;
    wisp_status status = take_number( root, "wisp_reference", 0.0, 1e9, name, &version, error );
    if ( status == WISP_OK && version != ACCURACY_REFERENCE_VERSION )
    {
        status = wisp_fail( error, WISP_BAD_INPUT, "%s: version %g, expected %d; `./dev reference` writes it again",
                            name, version, ACCURACY_REFERENCE_VERSION );
    }
    status = status == WISP_OK ? take_texts( root, name, out, error ) : status;
    status = status == WISP_OK ? take_number( root, "substeps", 1.0, 1e9, name, &substeps, error ) : status;
    status =
        status == WISP_OK ? take_number( root, "uncertainty_m", 0.0, 1e3, name, &out->uncertainty, error ) : status;
    status = status == WISP_OK
                 ? take_number( root, "numbers", 1.0, ACCURACY_REFERENCE_NUMBERS_MAX, name, &numbers, error )
                 : status;
    status = status == WISP_OK ? take_info( root, name, out, error ) : status;
    out->substeps = (int)substeps;
    out->number_count = (int)numbers;
    return status == WISP_OK ? take_hash( root, name, hash, error ) : status;
}

wisp_status accuracy_reference_parse_generator( const char* bytes, size_t size, const char* name,
                                                accuracy_reference* out, uint64_t* hash, wisp_error* error )
{
    json_error_t cause;
    *out = ( accuracy_reference ){ .numbers = NULL };
    *hash = 0;
    if ( size > ACCURACY_REFERENCE_GENERATOR_MAX )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: it is longer than the %zu bytes of the longest recipe", name,
                          ACCURACY_REFERENCE_GENERATOR_MAX );
    }
    json_t* root = json_loadb( size > 0 ? bytes : "", size, JSON_REJECT_DUPLICATES, &cause );
    if ( !root )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s:%d:%d: %s", name, cause.line, cause.column, cause.text );
    }
    const wisp_status status = take_generator( root, name, out, hash, error );
    json_decref( root );
    if ( status != WISP_OK )
    {
        *out = ( accuracy_reference ){ .numbers = NULL };
    }
    return status;
}

// ---- the numbers ----

static size_t file_size( int numbers )
{
    return HEAD + 8 * (size_t)numbers + TAIL;
}

static wisp_status check_frame( const unsigned char* bytes, size_t size, const char* name, int count, uint64_t hash,
                                wisp_error* error )
{
    const wisp_status status = reference_check_beginning( bytes, size, HEAD, TAIL, name, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    const unsigned char* at = bytes + REFERENCE_MAGIC_SIZE;
    const uint32_t version = (uint32_t)reference_take( &at, 4 ), numbers = (uint32_t)reference_take( &at, 4 );
    if ( version != ACCURACY_REFERENCE_VERSION )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte 8: version %u is not known, only %d", name, version,
                          ACCURACY_REFERENCE_VERSION );
    }
    if ( numbers != (uint32_t)count || size != file_size( count ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT,
                          "%s: byte 12: %u numbers in %zu bytes, its recipe has %d numbers, which take %zu", name,
                          numbers, size, count, file_size( count ) );
    }
    at = bytes + size - TAIL;
    const uint64_t said = reference_take( &at, TAIL );
    if ( said != reference_checksum( bytes, size - TAIL ) )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: byte %zu: the checksum is wrong, the file is broken", name,
                          size - TAIL );
    }
    return said == hash ? WISP_OK
                        : wisp_fail( error, WISP_BAD_INPUT, "%s: its hash is %016llx, its recipe has %016llx", name,
                                     (unsigned long long)said, (unsigned long long)hash );
}

wisp_status accuracy_reference_parse_numbers( const unsigned char* bytes, size_t size, const char* name, int count,
                                              uint64_t hash, double** out, wisp_error* error )
{
    *out = NULL;
    wisp_status status = check_frame( bytes, size, name, count, hash, error );
    if ( status != WISP_OK )
    {
        return status;
    }
    double* numbers = malloc( (size_t)count * sizeof( double ) );
    if ( !numbers )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for %d numbers", name, count );
    }
    const unsigned char* at = bytes + HEAD;
    for ( int i = 0; i < count; ++i )
    {
        numbers[i] = reference_take_double( &at );
        if ( !( fabs( numbers[i] ) < 1e6 ) )
        {
            free( numbers );
            return wisp_fail( error, WISP_BAD_INPUT, "%s: number %d is out of range", name, i );
        }
    }
    *out = numbers;
    return WISP_OK;
}

// ---- reading ----

static wisp_status check_fact( const accuracy_fact* requested, const accuracy_reference* reference, const char* name,
                               wisp_error* error )
{
    const double fraction = strcmp( requested->name, START_NAME ) == 0 ? START_TOLERANCE : FACT_TOLERANCE;
    for ( int i = 0; i < reference->fact_count; ++i )
    {
        const double value = reference->info[i].value;
        if ( strcmp( reference->info[i].name, requested->name ) == 0 )
        {
            return fabs( value - requested->value ) <= fraction * fabs( requested->value )
                       ? WISP_OK
                       : wisp_fail(
                             error, WISP_BAD_INPUT,
                             "%s: `%s` is %.9g, but %.9g in the scene; `./dev reference --scene %s` writes it again",
                             name, requested->name, value, requested->value, reference->scene );
        }
    }
    return wisp_fail( error, WISP_BAD_INPUT,
                      "%s: there is no fact `%s`; `./dev reference --scene %s` writes it again", name,
                      requested->name, reference->scene );
}

static wisp_status check_scene( const accuracy_reference* reference, const accuracy_reference* requested,
                                const char* name, wisp_error* error )
{
    if ( strcmp( reference->scene, requested->scene ) != 0 )
    {
        return wisp_fail( error, WISP_BAD_INPUT, "%s: it is the reference of `%s`, not of `%s`", name,
                          reference->scene, requested->scene );
    }
    wisp_status status = WISP_OK;
    for ( int i = 0; i < requested->fact_count && status == WISP_OK; ++i )
    {
        status = check_fact( &requested->info[i], reference, name, error );
    }
    if ( status == WISP_OK && reference->number_count != requested->number_count )
    {
        status = wisp_fail( error, WISP_BAD_INPUT,
                            "%s: it has %d numbers, the scene %d; `./dev reference --scene %s` writes it again", name,
                            reference->number_count, requested->number_count, reference->scene );
    }
    return status;
}

static wisp_status read_generator( const char* folder, const accuracy_reference* requested, accuracy_reference* out,
                                   uint64_t* hash, wisp_error* error )
{
    char path[PATH_SIZE];
    unsigned char* bytes = NULL;
    size_t size = 0;
    snprintf( path, sizeof( path ), "%s/%s.json", folder, requested->scene );
    wisp_status status = reference_read_bytes( path, ACCURACY_REFERENCE_GENERATOR_MAX + 1, &bytes, &size, error );
    status = status == WISP_OK
                 ? accuracy_reference_parse_generator( (const char*)bytes, size, path, out, hash, error )
                 : status;
    free( bytes );
    return status == WISP_OK ? check_scene( out, requested, path, error ) : status;
}

static wisp_status read_numbers( const char* folder, uint64_t hash, accuracy_reference* out, wisp_error* error )
{
    char path[PATH_SIZE];
    unsigned char* bytes = NULL;
    size_t size = 0;
    snprintf( path, sizeof( path ), "%s/%s.reference", folder, out->scene );
    // one byte more than expected, to detect a longer file
    wisp_status status = reference_read_bytes( path, file_size( out->number_count ) + 1, &bytes, &size, error );
    status = status == WISP_OK ? accuracy_reference_parse_numbers( bytes, size, path, out->number_count, hash,
                                                                   &out->numbers, error )
                               : status;
    free( bytes );
    return status;
}

wisp_status accuracy_reference_read( const char* folder, const accuracy_reference* requested, accuracy_reference* out,
                                     wisp_error* error )
{
    uint64_t hash = 0;
    *out = ( accuracy_reference ){ .numbers = NULL };
    wisp_status status = read_generator( folder, requested, out, &hash, error );
    status = status == WISP_OK ? read_numbers( folder, hash, out, error ) : status;
    if ( status != WISP_OK )
    {
        accuracy_reference_free( out );
    }
    return status;
}
