/// What a page holds of a scene: its files, and the hashes of a native run.
#pragma once

#include "scene.h"

#include <jansson.h>

/// Steps between two hashes.
#define VIEW_HASH_EVERY 60

/// Add the scene's file and all files that it reads, under names relative to its folder.
wisp_status view_scene_files( const wisp_scene* scene, const char* path, json_t* files, wisp_error* error );

/// Simulate the scene, and hash its state after every VIEW_HASH_EVERY-th step.
/// @param steps to make; receives those that were made, fewer after an interruption
/// @param out receives an object for json_decref()
wisp_status view_scene_hashes( const wisp_scene* scene, int* steps, json_t** out, wisp_error* error );
