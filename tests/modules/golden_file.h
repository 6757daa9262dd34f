/// Hashes of cases in a file of data/golden, one per line: the name, then sixteen digits.
#pragma once

#include <inttypes.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/// The name of a case and its present hash.
typedef struct golden_hash
{
    const char* name;
    uint64_t hash;
} golden_hash;

typedef golden_hash golden_case_fn( int number, const void* context );

static inline void golden_write( const char* path, int count, golden_case_fn* run, const void* context )
{
    FILE* file = fopen( path, "w" );
    assert_non_null( file );
    for ( int n = 0; n < count; ++n )
    {
        const golden_hash now = run( n, context );
        fprintf( file, "%s %016" PRIx64 "\n", now.name, now.hash );
    }
    assert_int_equal( fclose( file ), 0 );
}

/// Fails unless all cases equal those of the file, in its order. WISP_GOLDEN=write in the environment writes it first.
/// @param are_distinct no two cases are equal either: a hash that left something out would let everything pass
static inline void golden_check( const char* path, int count, bool are_distinct, golden_case_fn* run,
                                 const void* context )
{
    const char* mode = getenv( "WISP_GOLDEN" );
    if ( mode != NULL && strcmp( mode, "write" ) == 0 )
    {
        golden_write( path, count, run, context );
    }
    FILE* file = fopen( path, "r" );
    if ( file == NULL )
    {
        fail_msg( "%s cannot be read; WISP_GOLDEN=write makes it", path );
    }
    char name[64];
    uint64_t hash, others[32];
    int lines = 0, wrong = 0;
    assert_in_range( count, 1, 32 );
    while ( fscanf( file, "%63s %" SCNx64, name, &hash ) == 2 )
    {
        assert_true( lines < count );
        const golden_hash now = run( lines, context );
        assert_string_equal( name, now.name );
        if ( now.hash != hash )
        {
            print_error( "           %s is %016" PRIx64 ", it was %016" PRIx64 "\n", name, now.hash, hash );
            wrong += 1;
        }
        for ( int k = 0; k < lines; ++k )
        {
            assert_true( hash != others[k] || !are_distinct );
        }
        others[lines] = hash;
        lines += 1;
    }
    fclose( file );
    assert_int_equal( lines, count );
    assert_int_equal( wrong, 0 );
}
