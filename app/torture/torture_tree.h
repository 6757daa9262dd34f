/// A scene as a tree of texts that can be changed: the generator builds one, the twins scale and shift it, the
/// shrinker cuts it. Comments and the layout of a file are not part of it. Memory that cannot be had ends the
/// program.
#pragma once

#include "wisp/base.h"

#include <stdbool.h>

typedef enum torture_kind
{
    TORTURE_SCALAR,
    TORTURE_LIST,
    TORTURE_MAP,
} torture_kind;

typedef struct torture_node
{
    torture_kind kind;
    char* key;  ///< of a child of a map, else null
    char* text; ///< of a scalar, else null
    struct torture_node** children;
    int count, capacity;
} torture_node;

torture_node* torture_list( void );
torture_node* torture_map( void );
torture_node* torture_scalar( const char* format, ... ) __attribute__( ( format( printf, 1, 2 ) ) );
torture_node* torture_copy( const torture_node* node );
/// Null is allowed.
void torture_release( torture_node* node );

/// Give a map a value, in place of one with the same key. @return the value, which belongs to the map now
torture_node* torture_put( torture_node* map, const char* key, torture_node* value );
/// Append to a list. @return the value, which belongs to the list now
torture_node* torture_add( torture_node* list, torture_node* value );
/// @return null if the node is null, no map, or has no such key
torture_node* torture_find( const torture_node* map, const char* key );
/// @return the text of a scalar, "" of anything else
const char* torture_text_at( const torture_node* map, const char* key );
void torture_remove( torture_node* parent, int child );
void torture_remove_key( torture_node* map, const char* key );
void torture_set( torture_node* scalar, const char* text );

/// @return whether the node is a scalar that is a number @param value may be null
bool torture_is_number( const torture_node* node, double* value );
/// Replace the text by that of a number, with up to nine digits.
void torture_set_number( torture_node* scalar, double value );

/// Number of nodes below and including this one.
int torture_size( const torture_node* node );

/// Read a scene's text.
/// @param name what messages call it @param out to be released; null on failure
wisp_status torture_parse( const char* text, size_t size, const char* name, torture_node** out, wisp_error* error );
/// Write YAML. @param comment lines of "# .." at the top, or null @return to be freed
char* torture_write( const torture_node* root, const char* comment );

/// Memory or the end of the program.
void* torture_alloc( size_t size );
