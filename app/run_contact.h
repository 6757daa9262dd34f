/// What touches what in the output of `wisp run`.
#pragma once

#include "results.h"
#include "world_from_scene.h"

// ---- boundary particles and contact ----

// Numbers of points, the resampled fraction, the smallest gap, and files with the points.

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

// ---- collision ----

// The deepest penetration of each body whose collision_stats the scene computes, and the forces on colliders whose reaction it computes.

typedef struct run_collision run_collision;

/// @param out receives it, for run_collision_close(); null if the scene computes neither, and on failure
/// @return WISP_NO_MEMORY
wisp_status run_collision_open( scene_world* world, run_collision** out, wisp_error* error );

/// Read the statistics of the step that has ended. Null is allowed.
/// @return WISP_CONFLICT statistics cannot be read
wisp_status run_collision_step( run_collision* collision, wisp_error* error );

/// Put the deepest penetration of all bodies in the run, m, into the row of the run. Null is allowed.
void run_collision_put( const run_collision* collision, results_values* values );

/// Add a table with a line for each body, and a note for each body that went below the surface of a collider; and one with a line for
/// each collider. Null is allowed.
void run_collision_report( const run_collision* collision, results* out );

/// Null is allowed.
void run_collision_close( run_collision* collision );

// ---- intersections ----

// Edges through triangles, of each entity with itself and of each two, where they are counted.

typedef struct run_intersections run_intersections;

/// @param out receives it, for run_intersections_close(); null if intersections are not counted, and on failure
/// @return WISP_NO_MEMORY
wisp_status run_intersections_open( scene_world* world, run_intersections** out, wisp_error* error );

/// Read the statistics of the step that has ended. Null is allowed.
/// @return WISP_CONFLICT statistics cannot be read; WISP_NO_MEMORY
wisp_status run_intersections_step( run_intersections* intersections, wisp_error* error );

/// Put the most of a step, and how many steps have any, into the row of the run. Null is allowed.
void run_intersections_put( const run_intersections* intersections, results_values* values );

/// Describe the run in a line. Null gives an empty text.
void run_intersections_describe( const run_intersections* intersections, char* out, size_t size );

/// Add a table with a line for each two entities that ever intersected. Null is allowed.
void run_intersections_report( const run_intersections* intersections, results* out );

/// Null is allowed.
void run_intersections_close( run_intersections* intersections );
