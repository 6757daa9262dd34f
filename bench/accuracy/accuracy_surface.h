/// What scenes of surfaces share besides scene_tools.h: steps that are timed, up to a halt, and figures where asked for.
#pragma once

#include "scene_tools.h"
#include "surface_entrant.h"

/// Whole steps of all scenes that differ in substeps alone.
#define ACCURACY_FRAME ( 1.0f / 60.0f )

/// A step whose time is kept. @param scale of the time, so that steps of several lengths can be compared
wisp_status accuracy_time_surface( surface_entrant* entrant, double scale, accuracy_run* out, wisp_error* error );
/// The end of a run: its hash, and when it was halted.
wisp_status accuracy_end_surface( surface_entrant* entrant, accuracy_run* out, wisp_error* error );
/// So many steps, each with its time, and when the surface was halted. Stops at a halt: what follows means nothing.
wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error );

/// Figures of the last step; they must have been wanted before it.
wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error );
/// Ask for WISP_QUALITY if somebody looks. @param is_looked_at false: nothing happens
wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error );
