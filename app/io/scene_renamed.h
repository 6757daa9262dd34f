/// Keys and words of a scene that had another name once. Private to this folder.
#pragma once

/// An old name and the name that replaced it.
typedef struct scene_renamed
{
    const char* where; // of a key: the block that holds it; of a word: its key; null: wherever the new name is known
    const char* old;
    const char* now;
} scene_renamed;

extern const scene_renamed SCENE_RENAMED_KEYS[];
extern const int SCENE_RENAMED_KEY_COUNT;
extern const scene_renamed SCENE_RENAMED_WORDS[];
extern const int SCENE_RENAMED_WORD_COUNT;

/// Find the new name of a key.
/// @param path of the block that holds it, such as surfaces[0].balloon
/// @param known [count] keys of that block; a name that is not among them is no answer
/// @return null if the key has no new name there
const char* scene_find_renamed_key( const char* path, const char* old, const char* const* known, int count );

/// Find the new name of a word. @param path of the value, such as surfaces[0].repair[1]
const char* scene_find_renamed_word( const char* path, const char* old, const char* const* known, int count );
