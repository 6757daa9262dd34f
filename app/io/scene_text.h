/// Text to a bounded tree of nodes that know their line and column. Knows YAML, knows nothing of scenes.
///
/// Private to this folder. libyaml's document loader is quadratic on nested brackets and follows aliases, so the tree is
/// built from its events: what a scene has no use for (anchors, aliases, tags, directives, second documents) is refused
/// where it begins, and depth and size are capped before they cost anything.
#pragma once

#include "text_tree.h"

#define SCENE_MAX_BYTES ( (size_t)16 << 20 )
#define SCENE_MAX_NODES ( 1 << 20 )
#define SCENE_MAX_DEPTH 32

/// The bytes, and where a refusal goes.
typedef struct scene_source
{
    const char* name; // how messages name the text, usually its path
    const char* text;
    size_t size;
    wisp_error* error; // may be null
} scene_source;

/// Build the tree. @param out released with text_release(); null on failure
wisp_status scene_read_tree( const scene_source* source, text_node** out );

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
