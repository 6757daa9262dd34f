/// A folder of files, each of which must be rejected with a message, and which a generator writes.
#pragma once

#include "folder_fixture.h"

#include "../bad/bad_files.h"
#include "wisp/base.h"

/// Read one file, which must be rejected.
typedef void demand_refusal_fn( const char* path, const char* name, wisp_error* error );

/// Defined by the file that includes this one.
static const char* const bad_folder;

static inline void path_in_bad_folder( char* path, size_t size, const char* name )
{
    int length = snprintf( path, size, "%s/%s", bad_folder, name );
    assert_true( length > 0 && (size_t)length < size );
}

static inline void demand_named_refusal( const char* name, demand_refusal_fn* demand, wisp_error* error )
{
    char path[1024];
    path_in_bad_folder( path, sizeof path, name );
    *error = ( wisp_error ){ .status = WISP_OK };
    demand( path, name, error );
    assert_int_equal( error->status, WISP_BAD_INPUT );
    assert_contains( error->message, name );
    for ( const char* c = error->message; *c != 0; ++c )
    {
        assert_true( (unsigned char)*c >= 0x20 && *c != 0x7f );
    }
}

static inline void demand_refusal_of_folder( int min_files, demand_refusal_fn* demand )
{
    DIR* walk = opendir( bad_folder );
    assert_non_null( walk );
    int count = 0;
    for ( struct dirent* entry = readdir( walk ); entry != NULL; entry = readdir( walk ) )
    {
        if ( entry->d_name[0] != '.' )
        {
            wisp_error error;
            demand_named_refusal( entry->d_name, demand, &error );
            ++count;
        }
    }
    closedir( walk );
    assert_true( count >= min_files );
}

/// Every rejection has its own reason: a file that is rejected for another one tests nothing.
static inline void demand_words( const bad_file_list* list, demand_refusal_fn* demand )
{
    for ( int i = 0; i < list->count; ++i )
    {
        const bad_file* bad = list->files + i;
        wisp_error error;
        demand_named_refusal( bad->name, demand, &error );
        if ( strstr( error.message, bad->words ) == NULL )
        {
            fail_msg( "%s: expected \"%s\" in: %s", bad->name, bad->words, error.message );
        }
    }
}

/// The committed files equal the generator's output.
static inline void demand_bytes( const bad_file_list* list )
{
    for ( int i = 0; i < list->count; ++i )
    {
        unsigned char made[BAD_FILE_MAX];
        size_t size = bad_file_build( list, i, made ), length = 0;
        char path[1024];
        path_in_bad_folder( path, sizeof path, list->files[i].name );
        unsigned char* found = read_bytes( path, &length );
        if ( length != size || memcmp( found, made, size ) != 0 )
        {
            fail_msg( "%s: the file is not what make_bad_files writes", list->files[i].name );
        }
        free( found );
    }
}
