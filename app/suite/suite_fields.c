// Fields of a scene by path.
#include "suite_fields.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    char index[16] = "";
    if ( bracket )
    {
        snprintf( index, sizeof index, "%.*s", (int)strcspn( bracket + 1, "]" ), bracket + 1 );
        *bracket = '\0';
    }
    int count = 0;
    if ( next == NULL && bracket == NULL )
    {
        if ( value->kind == TEXT_SCALAR && strcmp( value->text, "null" ) == 0 )
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
            char number[16], own[64];
            snprintf( number, sizeof number, "%d", i );
            char* copy = text_alloc( strlen( next ) );
            strcpy( copy, next );
            snprintf( own, sizeof own, "%s", text_at( list->children[i], "name" ) );
            const bool is_meant =
                strcmp( index, "*" ) == 0 || strcmp( index, number ) == 0 || strcmp( index, own ) == 0;
            count += is_meant && list->children[i]->kind == TEXT_MAP ? set_path( list->children[i], copy, value ) : 0;
            free( copy );
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
