/// What scenes of surfaces share besides scene_tools.h: steps that are timed, up to a halt, and statistics where
/// requested.
#pragma once

#include "scene_tools.h"
#include "surface_implementation.h"

/// Whole steps of all scenes that differ in substeps alone.
#define ACCURACY_FRAME ( 1.0f / 60.0f )

/// A step whose time is kept. @param scale of the time, so that steps of several lengths can be compared
wisp_status accuracy_time_surface( surface_implementation* implementation, double scale, accuracy_run* out,
                                   wisp_error* error );
/// The end of a run: its hash, and when it was halted.
wisp_status accuracy_end_surface( surface_implementation* implementation, accuracy_run* out, wisp_error* error );
/// So many steps, each with its time, and when the surface was halted. Stops at a halt: what follows means nothing.
wisp_status accuracy_step_surface( surface_implementation* implementation, int steps, accuracy_run* out,
                                   wisp_error* error );

/// Figures of the last step; they must have been wanted before it.
wisp_status accuracy_read_motion_stats( surface_implementation* implementation, wisp_motion_stats* out,
                                        wisp_error* error );
/// Request WISP_MOTION_STATS if the run is sampled. @param is_looked_at false: nothing happens
wisp_status accuracy_request_motion_stats( surface_implementation* implementation, bool is_looked_at,
                                           wisp_error* error );
