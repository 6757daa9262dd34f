#include "layer_tree.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool add_path( layer_tree* tree, const char* path )
{
    if ( tree->count == tree->capacity )
    {
        int capacity = tree->capacity > 0 ? 2 * tree->capacity : 256;
        char** paths = realloc( tree->paths, (size_t)capacity * sizeof( char* ) );
        if ( !paths )
        {
            return false;
        }
        tree->paths = paths;
        tree->capacity = capacity;
    }
    tree->paths[tree->count] = strdup( path );
    return tree->paths[tree->count++] != NULL;
}

bool layer_tree_add( layer_tree* tree, const char* root, const char* folder )
{
    char place[PATH_MAX];
    snprintf( place, sizeof( place ), "%s/%s", root, folder );
    DIR* directory = opendir( place );
    if ( !directory )
    {
        return true;
    }
    bool good = true;
    for ( struct dirent* entry = readdir( directory ); entry && good; entry = readdir( directory ) )
    {
        char path[PATH_MAX], full[2 * PATH_MAX];
        struct stat info;
        if ( entry->d_name[0] == '.' ||
             snprintf( path, sizeof( path ), "%s/%s", folder, entry->d_name ) >= (int)sizeof( path ) )
        {
            continue;
        }
        snprintf( full, sizeof( full ), "%s/%s", root, path );
        if ( lstat( full, &info ) != 0 )
        {
            continue;
        }
        if ( S_ISDIR( info.st_mode ) )
        {
            good = layer_tree_add( tree, root, path );
        }
        else if ( S_ISREG( info.st_mode ) )
        {
            good = add_path( tree, path );
        }
    }
    closedir( directory );
    return good;
}

static int compare_paths( const void* a, const void* b )
{
    return strcmp( *(char* const*)a, *(char* const*)b );
}

void layer_tree_sort( layer_tree* tree )
{
    if ( tree->count > 0 )
    {
        qsort( tree->paths, (size_t)tree->count, sizeof( char* ), compare_paths );
    }
}

bool layer_tree_has( const layer_tree* tree, const char* path )
{
    return tree->count > 0 &&
           bsearch( &path, tree->paths, (size_t)tree->count, sizeof( char* ), compare_paths ) != NULL;
}

void layer_tree_release( layer_tree* tree )
{
    for ( int i = 0; i < tree->count; ++i )
    {
        free( tree->paths[i] );
    }
    free( tree->paths );
    *tree = ( layer_tree ){ 0 };
}

char* layer_text_read( const char* root, const char* path )
{
    char full[2 * PATH_MAX];
    snprintf( full, sizeof( full ), "%s/%s", root, path );
    FILE* file = fopen( full, "rb" );
    if ( !file )
    {
        return NULL;
    }
    char* text = NULL;
    if ( fseek( file, 0, SEEK_END ) == 0 )
    {
        long size = ftell( file );
        text = size >= 0 && fseek( file, 0, SEEK_SET ) == 0 ? malloc( (size_t)size + 1 ) : NULL;
        if ( text )
        {
            text[fread( text, 1, (size_t)size, file )] = 0;
        }
    }
    fclose( file );
    return text;
}

// The end of a string or character literal that begins at `at`; an open one ends with its line.
static char* skip_literal( char* at )
{
    char quote = *at++;
    while ( *at && *at != quote && *at != '\n' )
    {
        at += at[0] == '\\' && at[1] ? 2 : 1;
    }
    return *at == quote ? at + 1 : at;
}

// Blank up to the end mark, which is blanked too unless it is the line's end.
static char* blank_until( char* at, const char* end )
{
    char* stop = strstr( at, end );
    stop = stop ? stop + ( end[0] == '\n' ? 0 : strlen( end ) ) : at + strlen( at );
    for ( ; at < stop; ++at )
    {
        *at = *at == '\n' ? '\n' : ' ';
    }
    return stop;
}

void layer_text_blank_c( char* text )
{
    for ( char* at = text; *at; )
    {
        if ( at[0] == '/' && ( at[1] == '/' || at[1] == '*' ) )
        {
            bool is_line = at[1] == '/';
            at[0] = at[1] = ' ';
            at = blank_until( at + 2, is_line ? "\n" : "*/" );
        }
        else
        {
            at = *at == '"' || *at == '\'' ? skip_literal( at ) : at + 1;
        }
    }
}

void layer_text_blank_hash( char* text )
{
    for ( char* at = text; *at; )
    {
        at = *at == '#' ? blank_until( at, "\n" ) : *at == '\'' ? skip_literal( at ) : at + 1;
    }
}
