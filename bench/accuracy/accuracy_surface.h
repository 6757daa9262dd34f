/// Shared by scenes of surfaces, in addition to scene_tools.h: timed steps up to a halt, and statistics where
/// requested.
#pragma once

#include "scene_tools.h"
#include "surface_implementation.h"

/// Whole steps of all scenes that differ in substeps alone.
#define ACCURACY_FRAME ( 1.0f / 60.0f )

/// Record the end of a run: its hash, and the step at which it halted.
wisp_status accuracy_end_surface( surface_implementation* implementation, accuracy_run* out, wisp_error* error );
/// Run timed steps and record a halt. Stops at a halt, because later steps mean nothing.
wisp_status accuracy_step_surface( surface_implementation* implementation, int steps, accuracy_run* out,
                                   wisp_error* error );

/// Read the statistics of the last step, which must have been requested before it.
wisp_status accuracy_read_motion_stats( surface_implementation* implementation, wisp_motion_stats* out,
                                        wisp_error* error );
/// Request WISP_MOTION_STATS if the run is sampled. @param is_observed false: does nothing
wisp_status accuracy_request_motion_stats( surface_implementation* implementation, bool is_observed,
                                           wisp_error* error );
