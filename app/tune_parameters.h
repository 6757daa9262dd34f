/// Parameters to tune in a scene: fields that determine the accuracy of its solution, not its material.
#pragma once

#include "scene.h"
#include "scene_edit.h"
#include "wisp/tune.h"

/// Parameters of a scene, for wisp_tune(). Must stay where it is: the parameters point into it.
typedef struct tune_parameters
{
    wisp_tune_parameter parameters[WISP_TUNE_MAX_PARAMETERS];
    int fields[WISP_TUNE_MAX_PARAMETERS]; // rows of the table in tune_fields.c
    double values[WISP_TUNE_MAX_PARAMETERS][WISP_TUNE_MAX_VALUES];
    int count;
} tune_parameters;

/// @return WISP_BAD_INPUT nothing of the scene moves in time
wisp_status tune_parameters_find( const wisp_scene* scene, tune_parameters* out, wisp_error* error );

/// Set the values of a configuration in the scene. A parameter of surfaces or strands is set on all of them that have
/// it.
void tune_parameters_set( const tune_parameters* parameters, const int* configuration, wisp_scene* scene );

/// The changes of a scene's file that give it the values of a configuration.
/// @param scene as it was read @param out receives a block for free(), null if nothing changes
wisp_status tune_parameters_edits( const tune_parameters* parameters, const int* configuration,
                                   const wisp_scene* scene, wisp_scene_edit** out, int* count, wisp_error* error );

/// Whether a scene has the values of a configuration.
bool tune_parameters_agree( const tune_parameters* parameters, const int* configuration, const wisp_scene* scene );

/// A value for reports, as in the scene's file.
void tune_parameters_text( const tune_parameters* parameters, int parameter, double value, char* out, size_t size );
