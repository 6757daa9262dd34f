/// What may be tuned in a scene: fields that decide how accurately it is solved, not what it is made of.
#pragma once

#include "scene.h"
#include "scene_edit.h"
#include "wisp/tune.h"

/// Knobs of a scene, for wisp_tune(). Must stay where it is: the knobs point into it.
typedef struct tune_knobs
{
    wisp_tune_knob knobs[WISP_TUNE_MAX_KNOBS];
    int fields[WISP_TUNE_MAX_KNOBS]; // rows of the table in tune_fields.c
    double values[WISP_TUNE_MAX_KNOBS][WISP_TUNE_MAX_VALUES];
    int level_passes; // that levels have where they are on
    int count;
} tune_knobs;

/// @return WISP_BAD_INPUT nothing of the scene moves in time
wisp_status tune_knobs_find( const wisp_scene* scene, tune_knobs* out, wisp_error* error );

/// Give the scene the values of a choice. A knob of surfaces or strands is set on all of them that have it.
void tune_knobs_set( const tune_knobs* knobs, const int* choice, wisp_scene* scene );

/// What must change in the file of a scene so that it has the values of a choice.
/// @param scene as it was read @param out receives a block for free(), null if nothing changes
wisp_status tune_knobs_edits( const tune_knobs* knobs, const int* choice, const wisp_scene* scene,
                              wisp_scene_edit** out, int* count, wisp_error* error );

/// Whether a scene has the values of a choice.
bool tune_knobs_agree( const tune_knobs* knobs, const int* choice, const wisp_scene* scene );

/// A value as reports have it: as the scene's file does, but for levels, which are `off` or begin with the finest of them.
void tune_knobs_text( const tune_knobs* knobs, int knob, double value, char* out, size_t size );
