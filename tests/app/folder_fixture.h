/// A new folder for every test, and the files in it.
#pragma once

#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif

#include "unit.h"

#include <dirent.h>
#include <stdbool.h>
#include <unistd.h>

typedef struct folder
{
    char path[64];
} folder;

static inline int make_folder( void** state )
{
    folder* f = malloc( sizeof *f );
    if ( f == NULL )
    {
        return -1;
    }
    strcpy( f->path, "test-folder-XXXXXX" );
    *state = f;
    return mkdtemp( f->path ) != NULL ? 0 : -1;
}

/// @return static storage, overwritten by the fourth call after this one
static inline char* path_in( void** state, const char* name )
{
    static char paths[4][512];
    static int turn;
    char* path = paths[turn++ % 4];
    snprintf( path, sizeof paths[0], "%s/%s", ( (folder*)*state )->path, name );
    return path;
}

/// Files in a folder, hidden ones too; or remove them and what is one level below.
static inline int walk_folder( const char* path, bool removing )
{
    DIR* walk = opendir( path );
    int count = 0;
    for ( struct dirent* entry = walk != NULL ? readdir( walk ) : NULL; entry != NULL; entry = readdir( walk ) )
    {
        if ( strcmp( entry->d_name, "." ) != 0 && strcmp( entry->d_name, ".." ) != 0 )
        {
            char inner[1024];
            snprintf( inner, sizeof inner, "%s/%s", path, entry->d_name );
            if ( removing && remove( inner ) != 0 )
            {
                walk_folder( inner, true );
                remove( inner );
            }
            ++count;
        }
    }
    if ( walk != NULL )
    {
        closedir( walk );
    }
    return count;
}

static inline int count_files( void** state )
{
    return walk_folder( ( (folder*)*state )->path, false );
}

static inline int remove_folder( void** state )
{
    walk_folder( ( (folder*)*state )->path, true );
    int status = rmdir( ( (folder*)*state )->path );
    free( *state );
    return status;
}

static inline void put_file( const char* path, const void* bytes, size_t size )
{
    FILE* file = fopen( path, "wb" );
    assert_non_null( file );
    assert_int_equal( fwrite( bytes, 1, size, file ), size );
    fclose( file );
}

/// @return zero-terminated, for free()
static inline unsigned char* get_file( const char* path, size_t* size )
{
    FILE* file = fopen( path, "rb" );
    if ( file == NULL )
    {
        fail_msg( "%s: missing", path );
        return NULL;
    }
    fseek( file, 0, SEEK_END );
    *size = (size_t)ftell( file );
    rewind( file );
    unsigned char* bytes = checked_malloc( *size + 1 );
    assert_int_equal( fread( bytes, 1, *size, file ), *size );
    bytes[*size] = 0;
    fclose( file );
    return bytes;
}

#define TEST_IN_FOLDER( name ) cmocka_unit_test_setup_teardown( name, make_folder, remove_folder )
