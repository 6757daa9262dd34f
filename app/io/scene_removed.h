/// Keys and choice words of a scene that are gone. Private to this folder.
#pragma once

#include <stdbool.h>

/// Find what to use in place of a key or word.
/// @param path of the block of a key, such as surfaces[0].balloon, or of the value that is the word
/// @return null if there was none there
const char* scene_find_removed( const char* path, const char* name, bool is_word );
