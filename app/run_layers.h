/// Boundary particles and contact in the output of `wisp run`: numbers of points, the resampled fraction, the smallest
/// gap, and files with the points.
#pragma once

#include "results.h"
#include "world_from_scene.h"

typedef struct run_layers_def
{
    const char* file; ///< FILE.ply, of which each frame and surface is a file; or null
    int every;        ///< steps between two of them, >= 1
} run_layers_def;

typedef struct run_layers run_layers;

/// Request the contents of the files from the world. Call before the first step.
/// @param steps number of steps
/// @param out receives it, for run_layers_close(); null if there is nothing to report or to write, and on failure
/// @return WISP_BAD_INPUT files are requested for a scene without boundary particles; WISP_NO_MEMORY
wisp_status run_layers_open( const run_layers_def* def, scene_world* world, int steps, run_layers** out,
                             wisp_error* error );

/// Read the world after a step, and write files if this step has some. Null is allowed.
/// @return WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status run_layers_step( run_layers* layers, wisp_error* error );

/// Put numbers of the whole run, and of the last step, into the row of the run. Null is allowed.
void run_layers_put( const run_layers* layers, results_values* values );

/// Add a row for each step, of a long run for 1000 of them at most, and the messages. Null is allowed.
void run_layers_report( const run_layers* layers, results* out );

/// Null is allowed.
void run_layers_close( run_layers* layers );
