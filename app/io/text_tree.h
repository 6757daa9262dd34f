/// A file of YAML or JSON as a tree of texts with marks, which readers walk, and which can be changed: the generator builds one, the twins
/// scale and shift it, the shrinker cuts it. Comments and the layout of a file are not part of it. Memory that cannot be had while a tree
/// is changed ends the program; reading a text reports it.
#pragma once

#include "wisp/base.h"

#include <stdbool.h>

typedef enum text_kind
{
    TEXT_SCALAR,
    TEXT_LIST,
    TEXT_MAP,
} text_kind;

/// Lines and columns are those of the text that was read, from 1; columns count characters.
typedef struct text_node
{
    text_kind kind;
    bool plain;             ///< a scalar without quotes: only these are numbers
    char* key;              ///< of a child of a map, else null
    char* text;             ///< of a scalar, else null
    struct text_node* next; ///< behind it among the children of its parent
    struct text_node** children;
    int count, capacity;
    int line, column;         ///< where the value begins
    int key_line, key_column; ///< of the key
    size_t at, key_at;        ///< likewise in bytes, from 0
} text_node;

/// @return the first child, or null
static inline const text_node* text_first( const text_node* node )
{
    return node->count > 0 ? node->children[0] : NULL;
}

/// @return the text of a scalar, "" of anything else
static inline const char* text_value( const text_node* node )
{
    return node->kind == TEXT_SCALAR ? node->text : "";
}

/// The value at a path of keys such as "frame.pivot". @return null if a key is not there, or if the node is null or no map
const text_node* text_find_path( const text_node* map, const char* path );

/// @return null without memory
text_node* text_make( text_kind kind );
/// Append a child. @return false without memory
bool text_append( text_node* parent, text_node* child );

text_node* text_list( void );
text_node* text_map( void );
text_node* text_scalar( const char* format, ... ) __attribute__( ( format( printf, 1, 2 ) ) );
text_node* text_copy( const text_node* node );
/// Null is allowed.
void text_release( text_node* node );

/// Give a map a value, in place of one with the same key. @return the value, which belongs to the map now
text_node* text_put( text_node* map, const char* key, text_node* value );
/// Append to a list. @return the value, which belongs to the list now
text_node* text_add( text_node* list, text_node* value );
/// @return null if the node is null, no map, or has no such key
text_node* text_find( const text_node* map, const char* key );
/// @return the text of a scalar, "" of anything else
const char* text_at( const text_node* map, const char* key );
void text_remove_key( text_node* map, const char* key );

/// @return whether the node is a scalar that is a number @param value may be null
bool text_is_number( const text_node* node, double* value );
/// Replace the text by that of a number, with up to nine digits.
void text_set_number( text_node* scalar, double value );

/// A path is such as `substeps`, `surfaces[0].cloth.bending`, `surfaces[sheet].damping`, `strands[*].damping`.
/// Give every field that the path names a copy of a value. Blocks on the way that are absent are added, entries of lists are not. The
/// value `null` removes a field.
/// @return how many fields were set; 0: the path names nothing of the scene
int text_set_path( text_node* scene, const char* path, const text_node* value );

/// Number of nodes below and including this one.
int text_size( const text_node* node );

/// Read a scene's text.
/// @param name what messages call it @param out to be released; null on failure
wisp_status text_parse( const char* text, size_t size, const char* name, text_node** out, wisp_error* error );
/// Write YAML. @param comment lines of "# .." at the top, or null @return to be freed
char* text_write( const text_node* root, const char* comment );

/// Memory or the end of the program.
void* text_alloc( size_t size );
