/// Collision in the output of `wisp run`: the deepest penetration of each body whose collision_stats the scene computes, and the forces
/// on colliders whose reaction it computes.
#pragma once

#include "results.h"
#include "world_from_scene.h"

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
