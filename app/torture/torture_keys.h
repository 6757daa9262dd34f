/// The keys of a scene from the tables that read them: which block a mapping is, and a random value for a key. A new
/// key of a table is tortured without another line here; a span below says where a value is sensible if its default
/// does not.
#pragma once

#include "torture_random.h"
#include "text_tree.h"

#include "scene_parts.h"

/// The table of a mapping, and the struct with its defaults.
typedef struct torture_block
{
    const scene_block* table; ///< null: no table describes it
    const void* base;
} torture_block;

/// The block of the scene itself.
torture_block torture_block_of_scene( void );

/// The block of a value of a mapping, or of the items of that value if it is a list.
/// @param block of the mapping @param value the value of a key, or an item of it
torture_block torture_block_below( torture_block block, const char* key, const text_node* value );

/// Draw a value for a key. @return false: no number, word or vector, or a key that the generator sets itself
bool torture_draw_key( torture_random* random, const scene_field* field, const void* base, text_node** value );

/// Give a mapping random values for some of its keys, those without one.
/// @param percent of the keys
void torture_draw_keys( torture_random* random, torture_block block, int percent, text_node* map );
