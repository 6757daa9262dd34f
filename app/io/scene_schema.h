/// What a mapping of a scene may hold, as tables: one row a key, with its type, its place in a struct and its range.
/// One reader walks all tables, so that every key is checked and refused in the same way. Private to this folder.
#pragma once

#include "scene_reader.h"

/// Reads a value that no type below describes.
/// @param at the field's place in the struct: the struct itself for a reader that fills several members
typedef wisp_status scene_read_fn( scene_reader* reader, const scene_node* node, void* at );

typedef enum scene_type
{
    SCENE_MEMBER,  // of the definition of the block, whose row says type, place, range and unit
    SCENE_NUMBER,  // float
    SCENE_NUMBERS, // float, or a list with one a strand: const float* at `list`, int at `list_count`
    SCENE_WHOLE,   // int
    SCENE_SEED,    // uint64_t
    SCENE_SWITCH,  // bool
    SCENE_CHOICE,  // an enum that counts from 0 in the order of the choices
    SCENE_EITHER,  // bool, false and true in the order of the two choices
    SCENE_VECTOR,  // wisp_vec3
    SCENE_TEXT,    // const char*, not empty
    SCENE_BLOCK,   // a mapping of its own over the same struct; its presence sets the bool at `at`, if that is not 0
    SCENE_USUAL,   // such a block that is there by default, and can be `false`
    SCENE_CUSTOM,
} scene_type;

/// Both ends belong to it.
typedef struct scene_range
{
    double lower, upper;
} scene_range;

/// A word that a value may be, and what it means.
typedef struct scene_choice
{
    const char* word;
    const char* help; // a phrase
} scene_choice;

struct scene_block;

/// Find the entries that values of this field and of those before it name. It follows the field, whether its key is there or not,
/// so that fields behind it see what is named. @param node of the block
typedef wisp_status scene_bind_fn( scene_reader* reader, const scene_node* node );

typedef struct scene_field
{
    const char* key;
    scene_type type;
    bool required;
    size_t at;                   // bytes from the start of the struct
    const char* member;          // its name there; null: the key
    scene_range range;           // of SCENE_MEMBER 0 .. 0: that of the definition
    const char* unit;            // symbol; null: the number has no unit
    const scene_choice* choices; // ends with null; of SCENE_CUSTOM too, where words are read
    const char* constants;       // what the constants of the choices begin with in C
    size_t list, list_count;     // of SCENE_NUMBERS
    size_t given;                // bytes from the start to a bool that is set if the key is there; 0: none
    const struct scene_block* block;
    scene_read_fn* read;
    scene_bind_fn* bind;
    wisp_component map; // of SCENE_NUMBER in a wisp_scene_surface: the value may be a map; 0: not

    // For the reference.
    const char* help;    // one message
    const char* form;    // of SCENE_CUSTOM: what the value looks like
    const char* initial; // default, if it is not the value in the struct
} scene_field;

#define SCENE_MAX_FIELDS 48
#define SCENE_MAX_CHOICES 16

typedef struct scene_block
{
    const scene_field* fields; // read in this order, whatever the order in the file
    int field_count;           // <= SCENE_MAX_FIELDS
    const wisp_fields* of;     // what fields of SCENE_MEMBER belong to; null: it has none
    size_t at;                 // of that definition, bytes from the start of the struct
} scene_block;

#define SCENE_BLOCK_ALONE( fields )                                                                                  \
    {                                                                                                                \
        fields, WISP_COUNT( fields ), NULL, 0                                                                        \
    }

/// A block whose fields are members of a definition, which is `member` of the struct `entry`.
#define SCENE_BLOCK_OF( fields, def, entry, member )                                                                 \
    {                                                                                                                \
        fields, WISP_COUNT( fields ), &wisp_##def##_fields, offsetof( entry, member )                                \
    }

/// A field of a block with all that its definition says of it. What the field says itself goes before: a narrower range, another unit.
scene_field scene_field_at( const scene_block* block, int i );

/// Read a mapping into a struct. Values that it does not name stay as they are.
wisp_status scene_read_block( scene_reader* reader, const scene_node* node, const scene_block* block, void* base );

/// The value of a key, for a reader that must see it before the others. @return null if the key is not there, or if the
/// node is no mapping
const scene_node* scene_child( const scene_reader* reader, const scene_node* node, const char* key );

/// Make sure that a value is a list.
wisp_status scene_expect_list( scene_reader* reader, const scene_node* node, const char* what );

/// scene_value.c: one scalar into one C value.
wisp_status scene_read_number( scene_reader* r, const scene_node* node, const scene_field* field, float* out );
wisp_status scene_read_whole( scene_reader* r, const scene_node* node, const scene_field* field, int* out );
wisp_status scene_read_seed( scene_reader* r, const scene_node* node, uint64_t* out );
wisp_status scene_read_switch( scene_reader* r, const scene_node* node, bool* out );
wisp_status scene_read_choice( scene_reader* r, const scene_node* node, const scene_choice* choices, int* out );
/// The key `shape`, which decides on the table and may stand anywhere in the mapping.
wisp_status scene_read_shape( scene_reader* r, const scene_node* node, const scene_choice* shapes, int* out );

/// Refuse a word that the entry cannot have, or return WISP_OK.
typedef wisp_status scene_word_fn( scene_reader* r, const scene_node* item, int word, const void* entry );
/// A list of words, each of which sets its switch. @param check null: the entry can have all
wisp_status scene_read_words( scene_reader* r, const scene_node* node, const scene_choice* words,
                              bool* const* switches, scene_word_fn* check, const void* entry );
wisp_status scene_read_text( scene_reader* r, const scene_node* node, const char** out );

/// Three numbers, each as the field says.
wisp_status scene_read_vector( scene_reader* r, const scene_node* node, const scene_field* field, wisp_vec3* out );

/// Make sure that a value is a list of two. @param wanted such as "a pair [time, gas_ratio]"
wisp_status scene_expect_pair( scene_reader* r, const scene_node* node, const char* requested );

/// Refuse a value of the wrong kind. @param wanted such as "a number"
wisp_status scene_refuse_kind( const scene_reader* r, const scene_node* node, const char* requested );
