/// What a mapping of a scene may hold, as tables: one row a key, with its type, its place in a struct and its range.
/// One reader walks all tables, so that every key is checked and refused in the same way. Private to this folder.
#pragma once

#include "scene_reader.h"

/// Reads a value that no type below describes.
/// @param at the field's place in the struct: the struct itself for a reader that fills several members
typedef wisp_status scene_read_fn( scene_reader* reader, const text_node* node, void* at );

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
    SCENE_WORDS,   // a list of words of the choices, each of which sets its switch or its bit
    SCENE_ENTRIES, // a list of values that are alike: a pointer to them, and how many
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
struct scene_list;

/// Refuse a word that the entry cannot have, or return WISP_OK.
typedef wisp_status scene_word_fn( scene_reader* r, const text_node* item, int word, const void* entry );

/// Find the entries that values of this field and of those before it name. It follows the field, whether its key is there or not,
/// so that fields behind it see what is named. @param node of the block
typedef wisp_status scene_bind_fn( scene_reader* reader, const text_node* node );

typedef struct scene_field
{
    const char* key;
    scene_type type;
    bool required;
    size_t at;                   // bytes from the start of the struct
    const char* member;          // its name there; null: the key
    scene_range range;           // of SCENE_MEMBER 0 .. 0: that of the definition
    const char* unit;            // symbol; null: the number has no unit
    const scene_choice* choices; // ends with null
    const char* constants;       // what the constants of the choices begin with in C
    const size_t*
        switches;    // of SCENE_WORDS: the bool that each sets, bytes from `at`; null: it sets a bit of the int there
    const int* bits; // of SCENE_WORDS without switches
    scene_word_fn* check;        // of SCENE_WORDS; null: an entry can have all
    const struct scene_list* of; // of SCENE_ENTRIES
    size_t list, list_count;     // of SCENE_NUMBERS; the count of SCENE_ENTRIES, 0: it is right behind the pointer
    size_t given;                // bytes from the start to a bool that is set if the key is there; 0: none
    const struct scene_block* block;
    scene_read_fn* read;
    scene_bind_fn* bind;
    wisp_component map; // of SCENE_NUMBER in a wisp_scene_surface: the value may be a map; 0: not

    // For the reference.
    const char* help;    // one message
    const char* form;    // of SCENE_ENTRIES and SCENE_CUSTOM: what the value looks like
    const char* initial; // default, if it is not the value in the struct
} scene_field;

#define SCENE_MAX_FIELDS 48
#define SCENE_MAX_CHOICES 16

typedef struct scene_block
{
    const scene_field* fields; // read in this order, whatever the order in the file
    int field_count;           // <= SCENE_MAX_FIELDS
    const wisp_fields* of;     // what fields of SCENE_MEMBER belong to; null: it has none
    size_t at;                 // of that definition, or else of all fields, bytes from the start of the struct
} scene_block;

/// Read a value of a list. @param values those of the list, as in memory
typedef wisp_status scene_item_fn( scene_reader* reader, const text_node* item, int index, void* values );

/// Values that are alike.
typedef struct scene_list
{
    const char* what;        // such as "a list of clips", for messages
    size_t size;             // of a value in memory
    int most;                // 0: what a file can hold
    const scene_field* each; // how a value is read; null: `read` does
    scene_item_fn* read;
    scene_read_fn* finish; // once all are read; null: nothing
    const char* empty;     // refuses an empty list; null: it may be empty
    bool is_one_too;       // a value that is no list is a list of it
    bool is_named;         // values begin as scene_entry does: others may name them
    scene_named named;
} scene_list;

#define SCENE_BLOCK_ALONE( fields )                                                                                  \
    {                                                                                                                \
        fields, WISP_COUNT( fields ), NULL, 0                                                                        \
    }

/// A block whose fields are those of `member` of the struct `entry`.
#define SCENE_BLOCK_IN( fields, entry, member )                                                                      \
    {                                                                                                                \
        fields, WISP_COUNT( fields ), NULL, offsetof( entry, member )                                                \
    }

/// A block whose fields are members of a definition, which is `member` of the struct `entry`.
#define SCENE_BLOCK_OF( fields, def, entry, member )                                                                 \
    {                                                                                                                \
        fields, WISP_COUNT( fields ), &wisp_##def##_fields, offsetof( entry, member )                                \
    }

/// A field of a block with all that its definition says of it. What the field says itself goes before: a narrower range, another unit.
scene_field scene_field_at( const scene_block* block, int i );

/// Read a mapping into a struct. Values that it does not name stay as they are.
wisp_status scene_read_block( scene_reader* reader, const text_node* node, const scene_block* block, void* base );

/// What is wrong with an entry.
typedef struct scene_case
{
    bool is_wrong;
    const char* path; // of the key at whose place it is refused; null: at that of the entry
    const char* message;
} scene_case;

/// Refuse the first case that is wrong.
wisp_status scene_refuse_cases( scene_reader* reader, const text_node* node, const scene_case* cases, int count );

/// Refuse the first of these keys that is there: `'KEY' WHY`.
wisp_status scene_refuse_keys( scene_reader* reader, const text_node* node, const char* const* paths, int count,
                               const char* why );

/// Make sure that exactly one of two keys is there.
wisp_status scene_expect_one( scene_reader* reader, const text_node* node, const char* a, bool has_a, const char* b,
                              bool has_b );

/// Make sure that a value is a list.
wisp_status scene_expect_list( scene_reader* reader, const text_node* node, const char* what );

/// scene_value.c: one scalar into one C value.
wisp_status scene_read_number( scene_reader* r, const text_node* node, const scene_field* field, float* out );
wisp_status scene_read_whole( scene_reader* r, const text_node* node, const scene_field* field, int* out );
wisp_status scene_read_seed( scene_reader* r, const text_node* node, uint64_t* out );
wisp_status scene_read_switch( scene_reader* r, const text_node* node, bool* out );
wisp_status scene_read_choice( scene_reader* r, const text_node* node, const scene_choice* choices, int* out );
/// The key `shape`, which decides on the table and may stand anywhere in the mapping.
wisp_status scene_read_shape( scene_reader* r, const text_node* node, const scene_choice* shapes, int* out );

wisp_status scene_read_text( scene_reader* r, const text_node* node, const char** out );

/// Three numbers, each as the field says.
wisp_status scene_read_vector( scene_reader* r, const text_node* node, const scene_field* field, wisp_vec3* out );

/// Make sure that a value is a list of two. @param wanted such as "a pair of vertices"
wisp_status scene_expect_pair( scene_reader* r, const text_node* node, const char* requested );

/// Two numbers, each as its field says. @param wanted such as "a pair [time, gas_ratio]"
wisp_status scene_read_pair( scene_reader* r, const text_node* node, const char* requested,
                             const scene_field fields[2], float* first, float* second );

/// Refuse a value of the wrong kind. @param wanted such as "a number"
wisp_status scene_refuse_kind( const scene_reader* r, const text_node* node, const char* requested );
