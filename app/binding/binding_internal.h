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

/// @return whether there is such a body; the error is set if not
bool binding_find_body( const binding_world* world, int body, wisp_error* error );

/// Keep the message of a world's call that failed.
wisp_status binding_fail( const binding_world* world, wisp_status status, wisp_error* error );

/// Parameters of frozen hair that commands change, and which of the scene's lists of one value per strand are in use.
typedef struct hair_state
{
    float intensity, reach, stretch_stiffness, bend_stiffness, clump_radius;
    int32_t lists; // or-ed: 1 intensity, 2 stretch stiffness, 4 bend stiffness
} hair_state;

/// As they are now; without frozen hair those of the scene.
hair_state binding_hair_state( const binding_world* world, int body );
void binding_hair_restore( binding_world* world, int body, hair_state hair );
