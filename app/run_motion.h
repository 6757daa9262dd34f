/// Motion of bodies at the end of a run: statistics that the scene requests, and stretch, which shows whether the
/// substeps suffice.
#pragma once

#include "results.h"
#include "world_from_scene.h"

/// One line per surface or groom whose motion_stats the scene computes: mass, energy, stretch and speed.
void run_motion_add_table( const scene_world* world, results* out );

/// One line per body whose level of detail the scene sets: where it is at the end, and its substeps there.
void run_motion_add_detail( const scene_world* world, results* out );

/// A note for each body whose segments or edges are longer than at rest by more than a tenth in the mean.
void run_motion_add_warnings( const scene_world* world, results* out );
