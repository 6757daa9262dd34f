// Writes the reference of a scene as two files: the numbers, and the recipe with their hash.
#include "accuracy_reference.h"

#include "reference_bytes.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum
{
    HEAD = REFERENCE_MAGIC_SIZE + 2 * 4,
    TAIL = 8,
    PATH_SIZE = 1024,
};

static wisp_status write_numbers( const accuracy_reference* reference, const char* folder, uint64_t* hash,
                                  wisp_error* error )
{
    char path[PATH_SIZE];
    snprintf( path, sizeof( path ), "%s/%s.reference", folder, reference->scene );
    const size_t size = HEAD + 8 * (size_t)reference->number_count + TAIL;
    unsigned char* bytes = malloc( size );
    if ( !bytes )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the file", path );
    }
    unsigned char* at = bytes + REFERENCE_MAGIC_SIZE;
    memcpy( bytes, REFERENCE_MAGIC, REFERENCE_MAGIC_SIZE );
    reference_put( &at, 4, ACCURACY_REFERENCE_VERSION );
    reference_put( &at, 4, (uint64_t)reference->number_count );
    for ( int i = 0; i < reference->number_count; ++i )
    {
        reference_put_double( &at, reference->numbers[i] );
    }
    *hash = reference_checksum( bytes, size - TAIL );
    reference_put( &at, TAIL, *hash );
    const wisp_status status = reference_write_bytes( path, bytes, size, error );
    free( bytes );
    return status;
}

static json_t* generator_of( const accuracy_reference* reference, uint64_t hash )
{
    char digits[17];
    snprintf( digits, sizeof( digits ), "%016llx", (unsigned long long)hash );
    json_t *root = json_object(), *info = json_object();
    json_object_set_new( root, "wisp_reference", json_integer( ACCURACY_REFERENCE_VERSION ) );
    json_object_set_new( root, "scene", json_string( reference->scene ) );
    json_object_set_new( root, "reference", json_string( reference->reference ) );
    json_object_set_new( root, "solver", json_string( reference->solver ) );
    json_object_set_new( root, "precision", json_string( reference->precision ) );
    json_object_set_new( root, "substeps", json_integer( reference->substeps ) );
    json_object_set_new( root, "converged", json_string( reference->converged ) );
    json_object_set_new( root, "uncertainty_m", json_real( reference->uncertainty ) );
    for ( int i = 0; i < reference->fact_count; ++i )
    {
        json_object_set_new( info, reference->info[i].name, json_real( reference->info[i].value ) );
    }
    json_object_set_new( root, "facts", info );
    json_object_set_new( root, "layout", json_string( reference->layout ) );
    json_object_set_new( root, "numbers", json_integer( reference->number_count ) );
    json_object_set_new( root, "hash", json_string( digits ) );
    return root;
}

// jansson's constructors pass on the null of a failed allocation, so one check of the text is enough.
static wisp_status write_generator( const accuracy_reference* reference, const char* folder, uint64_t hash,
                                    wisp_error* error )
{
    char path[PATH_SIZE];
    snprintf( path, sizeof( path ), "%s/%s.json", folder, reference->scene );
    json_t* root = generator_of( reference, hash );
    char* text = json_dumps( root, JSON_INDENT( 2 ) | JSON_REAL_PRECISION( 9 ) );
    json_decref( root );
    if ( !text )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the recipe", path );
    }
    // a text file ends with a newline, which replaces the terminating zero
    const size_t length = strlen( text );
    text[length] = '\n';
    const wisp_status status = reference_write_bytes( path, text, length + 1, error );
    free( text );
    return status;
}

wisp_status accuracy_reference_write( const accuracy_reference* reference, const char* folder, wisp_error* error )
{
    uint64_t hash = 0;
    const wisp_status status = write_numbers( reference, folder, &hash, error );
    return status == WISP_OK ? write_generator( reference, folder, hash, error ) : status;
}
