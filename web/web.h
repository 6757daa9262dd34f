/// The C side of the WebAssembly module: what wisp.mjs calls. Each function hands its arguments to app/binding. Handles are pointers,
/// numbers are plain, texts belong to the module. A call that fails returns 0 or null, and web_message() then says why.
#pragma once

#include "binding.h"

#include <emscripten.h>

#define WEB_API EMSCRIPTEN_KEEPALIVE

/// A world and what a page reads of it.
typedef struct web_world
{
    binding_world* world;
    float* buffer; ///< of values that the engine has no memory of; grows
    size_t buffer_floats;
    char hash[20];
} web_world;

/// The message of the last failure.
extern wisp_error web_error;
