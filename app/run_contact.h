/// What touches what in the output of `wisp run`: boundary particles and contact (numbers of points, the resampled fraction, the smallest
/// gap, and files with the points); collision (the deepest penetration of each body whose collision_stats the scene computes, and the
/// forces on colliders whose reaction it computes); and intersections (edges through triangles, of each entity with itself and of each
/// two, where they are counted).
#pragma once

#include "results.h"
#include "world_from_scene.h"

typedef struct run_contact_def
{
    const char* file; ///< FILE.ply, of which each frame and surface with boundary particles is a file; or null
    int every;        ///< steps between two of them, >= 1
} run_contact_def;

typedef struct run_contact run_contact;

/// Request the contents of the files from the world. Call before the first step.
/// @param steps number of steps
/// @param out receives it, for run_contact_close(); null on failure
/// @return WISP_BAD_INPUT files are requested for a scene without boundary particles; WISP_NO_MEMORY
wisp_status run_contact_open( const run_contact_def* def, scene_world* world, int steps, run_contact** out,
                              wisp_error* error );

/// Read the world after a step, and write files if this step has some.
/// @return WISP_CONFLICT statistics cannot be read; WISP_IO_ERROR; WISP_NO_MEMORY
wisp_status run_contact_step( run_contact* contact, wisp_error* error );

/// Put numbers of the whole run, and of the last step, into the row of the run.
void run_contact_put( const run_contact* contact, results_values* values );

/// Describe the intersections of the run in a line; an empty text if they are not counted.
void run_contact_describe( const run_contact* contact, char* out, size_t size );

/// Add a table with a line for each body, and a note for each body that went below the surface of a collider; one with a line for
/// each collider; and one with a line for each two entities that ever intersected.
void run_contact_report( const run_contact* contact, results* out );

/// Add a row for each step, of a long run for 1000 of them at most, and the messages.
void run_contact_report_steps( const run_contact* contact, results* out );

/// Null is allowed.
void run_contact_close( run_contact* contact );
