/// Intersections in the output of `wisp run`: edges through triangles, of each entity with itself and of each two, where they are counted.
#pragma once

#include "results.h"
#include "world_from_scene.h"

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
