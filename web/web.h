/// The C side of the WebAssembly module: what wisp.mjs calls. Handles are pointers, numbers are plain, texts belong to the
/// module. A call that fails returns 0 or null, and web_message() then says why.
#pragma once

#include "world_from_scene_input.h"

#include <emscripten.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE
#define WEB_MAX_HOLDS 16

/// A world and the scene that it was made of.
typedef struct web_world
{
    wisp_scene scene;
    scene_world world;
    float* buffer; ///< of values that have no column to view; grows
    size_t buffer_floats;
    scene_hold holds[WEB_MAX_HOLDS];
    int hold_count;
    char hash[20];
} web_world;

/// The message of the last failure.
extern wisp_error web_error;

/// A scene is untrusted: its files are in the module's own memory, and its outputs stay there.
/// @return false with a message
bool web_scene_load( const char* path, wisp_scene* out );
