/// What the scenes of balloons and closed forms share besides cloth_settings.h: steps up to a halt, and figures where asked for.
#pragma once

#include "cloth_settings.h"

/// Whole steps of all scenes that differ in substeps alone.
#define ACCURACY_FRAME ( 1.0f / 60.0f )

/// So many steps, each with its time, and when the surface was halted. Stops at a halt: what follows means nothing.
wisp_status accuracy_step_surface( surface_entrant* entrant, int steps, accuracy_run* out, wisp_error* error );

/// Figures of the last step; they must have been wanted before it.
wisp_status accuracy_read_quality( surface_entrant* entrant, wisp_quality* out, wisp_error* error );
/// Ask for WISP_QUALITY if somebody looks. @param is_looked_at false: nothing happens
wisp_status accuracy_want_quality( surface_entrant* entrant, bool is_looked_at, wisp_error* error );
