/// The C side of the WebAssembly module: what wisp.mjs calls. Handles are pointers, numbers are plain, texts belong to the
/// module. A call that fails returns 0 or null, and web_message() then says why.
#pragma once

#include "world_from_scene_input.h"

#include <emscripten.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE
#define WEB_MAX_HOLDS 16

/// Parameters of frozen hair that commands change, and which of the scene's lists of one value per strand are in use.
typedef struct web_hair
{
    float intensity, reach, stretch_stiffness, bend_stiffness, clump_radius;
    int32_t lists; ///< or-ed: 1 intensity, 2 stretch stiffness, 4 bend stiffness
} web_hair;

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
    wisp_frozen_hair_def* hair; ///< [strands_count] as the scene has it, with its lists
    int32_t is_combed;          ///< a user has given a command: the scene's own hair events are over
} web_world;

/// The message of the last failure.
extern wisp_error web_error;

/// Keep the message of a world's call that failed. @return whether it was WISP_OK
int web_report( const web_world* w, wisp_status status );

/// Parameters of strands as they are now; without frozen hair those of the scene.
web_hair web_hair_state( const web_world* w, int body );
void web_hair_restore( web_world* w, int body, web_hair hair );

/// A scene is untrusted: its files are in the module's own memory, and its outputs stay there.
/// @return false with a message
bool web_scene_load( const char* path, wisp_scene* out );
