/// The reference of all keys of a scene, written from the tables that read them.
#pragma once

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
