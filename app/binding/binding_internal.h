/// Shared by the files of this folder, and private to them.
#pragma once

#include "binding.h"

#include "tune_parameters.h"
#include "world_from_scene.h"

struct binding_scene
{
    char* text; // with a zero behind it
    size_t size;
    char* name;
    wisp_scene_arrays* arrays; // [array_count] with copies of everything
    int array_count;
    wisp_scene scene;
    tune_parameters parameters; // none if nothing moves in time
};

struct binding_world
{
    wisp_scene scene;
    scene_world world;
    scene_hold* holds; // [hold_count]
    int hold_count, hold_capacity;
    wisp_frozen_hair_def* hair; // [strands_count] as the scene has it, with its lists
    bool is_combed;             // a user has given a command: the scene's own hair events are over
    bool is_between;            // the last call was an advance: points are interpolated
};

/// Read the scene again, to be changed and released by the caller.
wisp_status binding_scene_again( const binding_scene* scene, wisp_scene* out, wisp_error* error );
