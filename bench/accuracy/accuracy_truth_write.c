// The truth of a scene as two files: the numbers, and the recipe that has their hash.
#include "accuracy_truth.h"

#include "truth_bytes.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum
{
    HEAD = TRUTH_MAGIC_SIZE + 2 * 4,
    TAIL = 8,
    PATH_SIZE = 1024,
};

static wisp_status write_numbers( const accuracy_truth* truth, const char* folder, uint64_t* hash, wisp_error* error )
{
    char path[PATH_SIZE];
    snprintf( path, sizeof( path ), "%s/%s.truth", folder, truth->scene );
    const size_t size = HEAD + 8 * (size_t)truth->number_count + TAIL;
    unsigned char* bytes = malloc( size );
    if ( !bytes )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the file", path );
    }
    unsigned char* at = bytes + TRUTH_MAGIC_SIZE;
    memcpy( bytes, TRUTH_MAGIC, TRUTH_MAGIC_SIZE );
    truth_put( &at, 4, ACCURACY_TRUTH_VERSION );
    truth_put( &at, 4, (uint64_t)truth->number_count );
    for ( int i = 0; i < truth->number_count; ++i )
    {
        truth_put_double( &at, truth->numbers[i] );
    }
    *hash = truth_checksum( bytes, size - TAIL );
    truth_put( &at, TAIL, *hash );
    const wisp_status status = truth_write_bytes( path, bytes, size, error );
    free( bytes );
    return status;
}

static json_t* recipe_of( const accuracy_truth* truth, uint64_t hash )
{
    char digits[17];
    snprintf( digits, sizeof( digits ), "%016llx", (unsigned long long)hash );
    json_t *root = json_object(), *facts = json_object();
    json_object_set_new( root, "wisp_truth", json_integer( ACCURACY_TRUTH_VERSION ) );
    json_object_set_new( root, "scene", json_string( truth->scene ) );
    json_object_set_new( root, "truth", json_string( truth->truth ) );
    json_object_set_new( root, "solver", json_string( truth->solver ) );
    json_object_set_new( root, "precision", json_string( truth->precision ) );
    json_object_set_new( root, "substeps", json_integer( truth->substeps ) );
    json_object_set_new( root, "converged", json_string( truth->converged ) );
    json_object_set_new( root, "doubt_m", json_real( truth->doubt ) );
    for ( int i = 0; i < truth->fact_count; ++i )
    {
        json_object_set_new( facts, truth->facts[i].name, json_real( truth->facts[i].value ) );
    }
    json_object_set_new( root, "facts", facts );
    json_object_set_new( root, "layout", json_string( truth->layout ) );
    json_object_set_new( root, "numbers", json_integer( truth->number_count ) );
    json_object_set_new( root, "hash", json_string( digits ) );
    return root;
}

// jansson's constructors hand on the null of a failed allocation, so one look at the text is enough.
static wisp_status write_recipe( const accuracy_truth* truth, const char* folder, uint64_t hash, wisp_error* error )
{
    char path[PATH_SIZE];
    snprintf( path, sizeof( path ), "%s/%s.json", folder, truth->scene );
    json_t* root = recipe_of( truth, hash );
    char* text = json_dumps( root, JSON_INDENT( 2 ) | JSON_REAL_PRECISION( 9 ) );
    json_decref( root );
    if ( !text )
    {
        return wisp_fail( error, WISP_NO_MEMORY, "%s: no memory for the recipe", path );
    }
    // a file of text ends with its last line; the byte behind the text is there, and is a zero
    const size_t length = strlen( text );
    text[length] = '\n';
    const wisp_status status = truth_write_bytes( path, text, length + 1, error );
    free( text );
    return status;
}

wisp_status accuracy_truth_write( const accuracy_truth* truth, const char* folder, wisp_error* error )
{
    uint64_t hash = 0;
    const wisp_status status = write_numbers( truth, folder, &hash, error );
    return status == WISP_OK ? write_recipe( truth, folder, hash, error ) : status;
}
