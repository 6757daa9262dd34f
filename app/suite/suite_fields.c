// Fields of a scene by path.
#include "suite_fields.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Whether an index, which is a number, a name or `*`, means an entry of a list.
static bool is_meant( const text_node* list, int i, const char* index )
{
    char number[16];
    snprintf( number, sizeof number, "%d", i );
    return strcmp( index, "*" ) == 0 || strcmp( index, number ) == 0 ||
           strcmp( index, text_at( list->children[i], "name" ) ) == 0;
}

// From the end, so that numbers stay. @return how many were removed
static int remove_entries( text_node* list, const char* index )
{
    int count = 0;
    for ( int i = list->count - 1; i >= 0; --i )
    {
        if ( is_meant( list, i, index ) )
        {
            text_remove( list, i );
            ++count;
        }
    }
    return count;
}

// Find the node that a path leads to and that is to be set: `dt`, `surfaces[0].cloth.bending`, `surfaces[*].damping`.
// @param rest the path, changed @return how many fields were set
static int set_path( text_node* at, char* rest, const text_node* value )
{
    char* dot = strchr( rest, '.' );
    char* next = dot ? dot + 1 : NULL;
    if ( dot )
    {
        *dot = '\0';
    }
    char* bracket = strchr( rest, '[' );
    char index[80] = "";
    if ( bracket )
    {
        snprintf( index, sizeof index, "%.*s", (int)strcspn( bracket + 1, "]" ), bracket + 1 );
        *bracket = '\0';
    }
    const bool is_removal = value->kind == TEXT_SCALAR && strcmp( value->text, "null" ) == 0;
    int count = 0;
    if ( next == NULL && bracket == NULL )
    {
        if ( is_removal )
        {
            text_remove_key( at, rest );
        }
        else
        {
            text_put( at, rest, text_copy( value ) );
        }
        count = 1;
    }
    else
    {
        text_node* list = text_find( at, rest );
        text_node* block = bracket ? NULL : list ? list : text_put( at, rest, text_map() );
        for ( int i = 0; bracket && next && list && list->kind == TEXT_LIST && i < list->count; ++i )
        {
            char* copy = text_alloc( strlen( next ) );
            strcpy( copy, next );
            count += is_meant( list, i, index ) && list->children[i]->kind == TEXT_MAP
                         ? set_path( list->children[i], copy, value )
                         : 0;
            free( copy );
        }
        if ( bracket && next == NULL && list && list->kind == TEXT_LIST && is_removal )
        {
            count += remove_entries( list, index );
        }
        count += block && next && block->kind == TEXT_MAP ? set_path( block, next, value ) : 0;
    }
    if ( bracket )
    {
        *bracket = '[';
    }
    if ( dot )
    {
        *dot = '.';
    }
    return count;
}

int suite_set_field( text_node* scene, const char* path, const text_node* value )
{
    char* copy = text_alloc( strlen( path ) );
    strcpy( copy, path );
    const int count = set_path( scene, copy, value );
    free( copy );
    return count;
}
