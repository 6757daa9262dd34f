/// What the scenes of balloons and closed forms share: a surface that is stepped for an accuracy_run, and settings that are
/// listed one by one.
#pragma once

#include "accuracy.h"

#include "surface_entrant.h"

/// Whole steps of all scenes that differ in substeps alone.
#define ACCURACY_FRAME ( 1.0f / 60.0f )

/// So many steps, each with its time, and when the surface was halted. Stops at a halt: what follows means nothing.
wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error );

/// Figures of the last step; they must have been wanted before it.
wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error );
/// Ask for WISP_QUALITY if somebody looks. @param is_looked_at false: nothing happens
wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error );

/// Append a setting to a scene, whose list must have room. @param format its name
void accuracy_add_setting( accuracy_scene* scene, const char* series, const char* knob_name, double knob,
                           double order, const char* format, ... ) __attribute__( ( format( printf, 6, 7 ) ) );
