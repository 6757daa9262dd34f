/// What a reading of a scene keeps: its place in the text, the names so far, and memory that lives as long as the
/// scene. Private to this folder.
#pragma once

#include "scene.h"
#include "scene_text.h"

/// What has a name, in the order in which the lists are read.
typedef enum scene_named
{
    SCENE_STRANDS,
    SCENE_SURFACE,
    SCENE_COLLIDER,
    SCENE_SEAM,
} scene_named;

/// An entry that others may name.
typedef struct scene_name
{
    const char* text;
    int index; // in its own list
    int line, column;
    scene_named what;
} scene_name;

typedef struct scene_reader
{
    const scene_source* source;
    wisp_scene* scene;
    char path[128]; // of the value being read, such as strands[0].frozen_hair
    size_t path_length;
    scene_name* names; // [name_count] of the lists that were read, by text
    int name_count;
    const void* entry; // of the list that is read: what its values are numbered in
    int body_count;    // colliders, and surfaces that are some
} scene_reader;

/// Lengthen the path while a list's item is read. @return what scene_leave() takes
size_t scene_enter_index( scene_reader* reader, int index );
size_t scene_enter_key( scene_reader* reader, const char* key );
void scene_leave( scene_reader* reader, size_t path_length );

/// Refuse a value: the message begins with its place and the path.
wisp_status scene_refuse_node( const scene_reader* reader, const text_node* node, const char* format, ... )
    __attribute__( ( format( printf, 3, 4 ) ) );

/// Zeroed memory that lives as long as the scene. @return null if there is none, or if the count is 0
void* scene_take( wisp_scene* scene, size_t count, size_t size );
/// A text that lives as long as the scene. @return null without memory
const char* scene_print( wisp_scene* scene, const char* format, ... ) __attribute__( ( format( printf, 2, 3 ) ) );
wisp_status scene_no_memory( const scene_reader* reader );
