/// Shared by scenes in C: lists of settings, timed steps and surfaces.
#pragma once

#include "accuracy/accuracy.h"
#include "surfaces.h"

/// Reserve memory for settings; their count stays 0.
wisp_status accuracy_reserve_settings( accuracy_scene* scene, int count, wisp_error* error );
/// Give a scene a context of zeros, which is freed with it, and room for settings. After a failure the scene is empty.
wisp_status accuracy_begin_scene( accuracy_scene* scene, size_t context_size, int setting_count, wisp_error* error );
/// Add the next setting, outside any series. There must be room. @param name printf format
accuracy_setting* accuracy_put_setting( accuracy_scene* scene, const char* name, ... )
    __attribute__( ( format( printf, 2, 3 ) ) );
/// Put a setting into a series. @param order expected in theory, or NaN
void accuracy_join_series( accuracy_setting* setting, const char* series, const char* parameter_name,
                           double parameter, double order );
/// Free a scene that cannot be made. @return the given status
wisp_status accuracy_abandon( accuracy_scene* scene, wisp_status status );

/// Run one step of an implementation and keep its time.
wisp_status accuracy_time_step( wisp_status ( *step )( void* context, wisp_error* error ), void* context,
                                accuracy_run* out, wisp_error* error );

// ---- scenes of surfaces ----

// Shared by scenes of surfaces, in addition to scene_tools.h: timed steps up to a halt, and statistics where
// requested.

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
