/// The suite that `wisp accuracy` makes of a scene: what accuracy costs, by substeps and by methods that the scene can do without being another.
#pragma once

#include "wisp/base.h"

typedef struct suite_of_scene_def
{
    const char* path; ///< of the scene
    const char* file; ///< the same as the suite is to name it
    double length;    ///< s of motion that is compared; 0: all of the scene, but at most 1 s
    double seconds;   ///< of wall time that the reference may take, about
} suite_of_scene_def;

/// Write the suite as YAML.
/// @param out receives a text to be freed
/// @return WISP_BAD_INPUT it is no scene, or nothing in it moves (the message names the cause); WISP_IO_ERROR
wisp_status suite_of_scene( const suite_of_scene_def* def, char** out, wisp_error* error );
