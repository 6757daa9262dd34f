/// Scene text to a bounded tree of nodes that know their line and column. Knows YAML, knows nothing of scenes.
///
/// Private to this folder. libyaml's document loader is quadratic on nested brackets and follows aliases, so the tree is
/// built from its events: what a scene has no use for (anchors, aliases, tags, directives, second documents) is refused
/// where it begins, and depth and size are capped before they cost anything.
#pragma once

#include "wisp/base.h"

#define SCENE_MAX_BYTES ( (size_t)16 << 20 )
#define SCENE_MAX_NODES ( 1 << 20 )
#define SCENE_MAX_DEPTH 32

typedef enum scene_kind
{
    SCENE_SCALAR,
    SCENE_LIST,
    SCENE_MAP,
} scene_kind;

/// A value. Children of a list or a map are chained in the order of the file; text lives in the tree's letters.
typedef struct scene_node
{
    int line, column;         // where the value begins, from 1; columns count characters
    int key_line, key_column; // of the key, if the parent is a map
    uint32_t key;             // into letters, if the parent is a map
    uint32_t text;            // into letters, of a scalar
    int first, next;          // first child and next sibling; -1 is none
    int count;                // children
    uint8_t kind;             // scene_kind
    bool plain;               // a scalar without quotes: only these are numbers
} scene_node;

typedef struct scene_tree
{
    scene_node* nodes; // [node_count], the root first
    char* letters;     // [letter_count], zero-terminated strings
    size_t letter_count, letter_capacity;
    int node_count, node_capacity;
} scene_tree;

/// The bytes, and where a refusal goes.
typedef struct scene_source
{
    const char* name; // how messages name the text, usually its path
    const char* text;
    size_t size;
    wisp_error* error; // may be null
} scene_source;

/// Build the tree. @param tree released with scene_tree_release(), also after a failure
wisp_status scene_tree_build( const scene_source* source, scene_tree* tree );
void scene_tree_release( scene_tree* tree );

static inline const char* scene_text_of( const scene_tree* tree, const scene_node* node )
{
    return tree->letters + node->text;
}

static inline const char* scene_key_of( const scene_tree* tree, const scene_node* node )
{
    return tree->letters + node->key;
}

static inline const scene_node* scene_first( const scene_tree* tree, const scene_node* node )
{
    return node->first < 0 ? NULL : &tree->nodes[node->first];
}

static inline const scene_node* scene_next( const scene_tree* tree, const scene_node* node )
{
    return node->next < 0 ? NULL : &tree->nodes[node->next];
}

/// The value at a path of keys such as "frame.pivot". @return null if a key is not there, or if the node is null or no mapping
const scene_node* scene_tree_find( const scene_tree* tree, const scene_node* node, const char* path );

/// Refuse with `name:line:column: path: message`; line 0 leaves out the place, an empty path itself.
/// Control characters that came from the file do not reach the message.
wisp_status scene_refuse( const scene_source* source, int line, int column, const char* path, const char* format,
                          ... ) __attribute__( ( format( printf, 5, 6 ) ) );

/// Text from the file as a message may show it: cut to a readable length between characters.
typedef struct scene_quote
{
    char text[48];
} scene_quote;

scene_quote scene_shorten( const char* text );
