/// A new folder for every test, and the files in it.
#pragma once

#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif

#include "files.h"

#include <dirent.h>

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

/// List the files in a folder, hidden ones too; or remove them and those one level below.
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

#define TEST_IN_FOLDER( name ) TEST_WITH( name, make_folder, remove_folder )
