/// The kind of a file. Names decide, except that a groom, a recording and a point cache may have any name if their
/// first bytes identify them, and that scenes and results can both be JSON. Standard input, "-", has no name: its
/// first bytes decide.
#pragma once

#include "wisp/base.h"

typedef enum file_kind
{
    FILE_UNKNOWN,
    FILE_GROOM,       ///< .hair
    FILE_MESH,        ///< .obj, .ply; .glb, .gltf, maybe with # and the name of a mesh behind
    FILE_SCENE,       ///< .yaml, .yml, .json
    FILE_RECORDING,   ///< .wisp
    FILE_POINT_CACHE, ///< .pc2
    FILE_RESULTS,     ///< .json
} file_kind;

/// @param kind FILE_UNKNOWN is no failure: the caller reports the kinds that it accepts
/// @return WISP_IO_ERROR the file cannot be opened or read
wisp_status file_kind_find( const char* path, file_kind* kind, wisp_error* error );
