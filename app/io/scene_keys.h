/// The reference of all keys of a scene, written from the tables that read them.
#pragma once

#include <stdbool.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C"
{
#endif

    /// Write type, unit, range, default and meaning of every key, as Markdown that also reads well on a terminal.
    /// @param block null for all keys, or a block such as "surfaces", "surfaces.cloth" or "cloth": its keys and those
    ///              of the blocks in it
    /// @return number of blocks that were written; 0 if no block has that name
    int wisp_scene_write_keys( FILE* out, const char* block );

#ifdef __cplusplus
}
#endif

// ---- scene removed ----

/// Find what to use in place of a key or word.
/// @param path of the block of a key, such as surfaces[0].balloon, or of the value that is the word
/// @return null if there was none there
const char* scene_find_removed( const char* path, const char* name, bool is_word );
