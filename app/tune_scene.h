/// The search of bindings: worlds of a scene for wisp_tune_worlds().
#pragma once

#include "tune_parameters.h"
#include "world_from_scene.h"

/// Substeps of the reference, as a multiple of those of the finest setting.
#define TUNE_REFERENCE_FACTOR 16

typedef struct tune_scene_def
{
    wisp_scene* scene; ///< its fields change from run to run
    const tune_parameters* parameters;
    scene_world_options world;
    double error, budget_ms;         ///< m, ms; one of them
    double seconds;                  ///< of simulated time; 0: the scene, or 2 s if that is shorter
    double limit;                    ///< s of wall time
    wisp_tune_progress_fn* progress; ///< called after every run; null: not
    void* progress_user;
    /// Called before every step; false ends the search with WISP_CONFLICT; null: not. A host that keeps what was found so far
    /// ends the reference run alone: there is nothing to keep before its end.
    bool ( *go_on )( void* user, bool is_reference );
    void* go_on_user;
} tune_scene_def;

/// The measurements and their settings.
typedef struct tune_scene_info
{
    int steps;    ///< of each run
    int points;   ///< compared at each sample
    int workers;  ///< that the worlds had
    char isa[16]; ///< instruction set that they used
} tune_scene_info;

/// @param out to be released
wisp_status tune_scene_search( const tune_scene_def* def, wisp_tune_result* out, tune_scene_info* info,
                               wisp_error* error );
