/// The C that makes the world of a scene, for a host of the library.
#pragma once

#include "world_from_scene.h"

#include <stdio.h>

/// Write a program that makes the world of a scene, steps it as `wisp run` does, and prints its hash.
/// @return WISP_BAD_INPUT the scene has what the program could not express; the message names its line
wisp_status host_source_write( FILE* out, const wisp_scene* scene, wisp_error* error );
