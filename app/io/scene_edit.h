/// Change single values of a scene's file, or take keys out, and leave every other byte as it was: comments, order,
/// spaces.
#pragma once

#include "wisp/base.h"

#ifdef __cplusplus
extern "C"
{
#endif

    /// One value and where it belongs: `list[index].block.key`, without what is null.
    typedef struct wisp_scene_edit
    {
        const char* list;  ///< "surfaces" or "strands"; null: the scene itself
        int index;         ///< in the list, in the order of the file
        const char* block; ///< a mapping of the entry that is there, such as "cloth"; null: the entry itself
        const char* key;
        char value[32]; ///< a number, true or false, as it is to be written; empty takes the key out
    } wisp_scene_edit;

    /// Change the text of a scene as wisp_scene_edit_file() does.
    /// @param name what messages call it, and whose folder relative files are in
    /// @param out receives a block for free() of `out_size` bytes and a zero behind them; null on failure
    WISP_API wisp_status wisp_scene_edit_text( const char* text, size_t size, const char* name,
                                               const wisp_scene_edit* edits, int count, char** out, size_t* out_size,
                                               wisp_error* error );

    /// Read a scene, set values, and write what is then a scene that reads as such. A value that is there is replaced in its
    /// place; a key that is not there is added to its mapping, as YAML or as JSON, whatever the file is. A key that is taken
    /// out goes with its comma, or with its line unless a comment is on it; one that is not there stays away.
    /// @param to written only if all went well, and may be `from`; null writes nothing and tells whether it would go well
    /// @return WISP_BAD_INPUT a value cannot be set or a key taken out safely, or the result is not a scene (the message
    ///         names file and line); WISP_IO_ERROR; WISP_NO_MEMORY
    WISP_API wisp_status wisp_scene_edit_file( const char* from, const wisp_scene_edit* edits, int count,
                                               const char* to, wisp_error* error );

#ifdef __cplusplus
}
#endif
